// SPDX-License-Identifier: Apache-2.0
/* hull.h: what a system without facets encloses. */
#ifndef TET_ENGINE_HULL_H
#define TET_ENGINE_HULL_H

#include "base/context.h"

#include <tet/pls.h>

#include <stdint.h>

/* The convex hull of the vertices that `pls`, which has no facets, uses, as its facets: triangles
 * with marker 0, of which coplanar neighbours become one in the surface stage. *ret_pls is `pls` with
 * these, and refers to *ret_triangles ([n][3]) and *ret_starts ([n + 1]), both the caller's
 * (tet_free). Cost: one Delaunay tetrahedralization, by `threads`. Errors: limits, TET_E_DEGENERATE
 * where all are in one plane; outputs are untouched then. */
tet_status tet_close_by_hull(tet_ctx *ctx, const tet_pls *pls, uint32_t threads, tet_pls *ret_pls,
                             uint32_t **ret_triangles, uint32_t **ret_starts);

#endif
