// SPDX-License-Identifier: Apache-2.0
/* diagram.h: the Voronoi cells themselves, as polyhedra, for those who want to see them. */
#ifndef TET_DUAL_DIAGRAM_H
#define TET_DUAL_DIAGRAM_H

#include "base/context.h"

#include <tet/mesh.h>

/* Fills the arrays voronoi_* of `mesh`, which has its factors (dual.h) and its neighbours, and
 * every face between regions and to the outside as a subface. The cells are closed, whatever
 * the mesh; they are convex and lie in their regions where it is boundary conforming Delaunay.
 * On failure nothing of the mesh has changed. Errors: TET_E_MEMORY, TET_E_TOO_LARGE (2^32 - 1
 * points or corners of faces), cancel, deadline. Cost: 1 to 2 us and 80 bytes a tetrahedron. */
tet_status tet_voronoi_diagram(tet_ctx *ctx, tet_mesh *mesh);

#endif
