// SPDX-License-Identifier: Apache-2.0
/* hull.h: what a system without facets encloses. */
#ifndef TET_ENGINE_HULL_H
#define TET_ENGINE_HULL_H

#include "engine/skin.h"

#include <tet/pls.h>

#include <stdint.h>

/* The convex hull of the vertices that `pls`, which has no facets, uses, as its facets, of marker 0: see skin.h for
 * them and for `exact`. *ret_pls is `pls` with these, and refers to *ret_skin, the caller's (tet_skin_free). Cost: one
 * Delaunay tetrahedralization, by `threads`, which is gone before refinement needs the memory. Errors: limits,
 * TET_E_DEGENERATE where all are in one plane; outputs are untouched then. */
tet_status tet_close_by_hull(tet_ctx *ctx, const tet_pls *pls, uint32_t threads, int exact, tet_pls *ret_pls,
                             tet_skin *ret_skin);

#endif
