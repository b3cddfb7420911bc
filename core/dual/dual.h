// SPDX-License-Identifier: Apache-2.0
/* dual.h: Voronoi cells of a finished mesh, cut to the domain and its regions, as finite
 * volume schemes want them (thesis 1.1, (1.3)). */
#ifndef TET_DUAL_DUAL_H
#define TET_DUAL_DUAL_H

#include "base/context.h"

#include <tet/mesh.h>

/* Fills the arrays cell_*, edge_* and subface_shares of `mesh` and report.voronoi from its
 * points, tetrahedra, regions and subfaces, all rows ascending. Each factor is a sum of signed
 * parts (shares.h), never cut off at 0: one below 0 by more than rounding is counted, and the
 * worst is named. On failure nothing of the mesh has changed. Errors: TET_E_MEMORY,
 * TET_E_TOO_LARGE (more than 2^32 - 2 rows), TET_E_NOT_FINITE (an extent beyond 2^300, or
 * below 2^-300, so that volumes do not fit doubles), cancel, deadline. Cost: 200 to 500 ns a
 * tetrahedron, the more the farther apart its vertices' rows are, and 70 bytes, half of them for a while. */
tet_status tet_voronoi_factors(tet_ctx *ctx, tet_mesh *mesh);

#endif
