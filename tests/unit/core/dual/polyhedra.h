// SPDX-License-Identifier: Apache-2.0
/* polyhedra.h: laws of the Voronoi cells as polyhedra. */
#ifndef TESTS_POLYHEDRA_H
#define TESTS_POLYHEDRA_H

#include <tet/mesh.h>

/* Asserts, for a mesh with factors and diagram: every cell is a closed surface (each side of a
 * polygon is met once the other way round), whose volume is the cell's; the polygon of an edge
 * is orthogonal to it and has the factor's area; indices are in range and points in use.
 * `slack`: of lengths, relative to the mesh's extent. */
void check_polyhedra(const tet_mesh *mesh, double slack);

/* Of these only that the cells are closed, which needs no mesh of any quality. */
void check_polyhedra_closed(const tet_mesh *mesh);

#endif
