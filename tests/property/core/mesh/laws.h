// SPDX-License-Identifier: Apache-2.0
/* laws.h: what holds of every Delaunay complex, checked by the last, filterless stage of the
 * predicates. Failures are cmocka's. */
#ifndef TETRAD_PROPERTY_MESH_LAWS_H
#define TETRAD_PROPERTY_MESH_LAWS_H

#include "mesh/delaunay.h"
#include "rows.h"

/* Adjacency is mutual and over equal faces, tetrahedra are positive, no vertex beyond a face is inside
 * the sphere, hull faces are seen by nobody next to them, and no tetrahedron holds a vertex that
 * gone[] (NULL: none) says is not there. */
void check_laws(const tet_complex *c, const uint8_t *gone);

/* The rows of the vertices with !gone[v] alone. */
rows rows_without(tet_points *points, const uint8_t *gone);

#endif
