// SPDX-License-Identifier: Apache-2.0
/* hull.h: what a system without facets encloses. */
#ifndef TET_ENGINE_HULL_H
#define TET_ENGINE_HULL_H

#include "build/build.h"
#include "engine/skin.h"

#include <tet/pls.h>

#include <stdint.h>

/* A cloud and its Delaunay tetrahedralization. */
typedef struct tet_hull {
  tet_build_result built;
  uint32_t *used; /* [points of the pieces] the cloud's vertices in use */
} tet_hull;

/* Of the vertices that `pls`, which has no facets, uses; by `threads`. Errors: limits, TET_E_DEGENERATE where all are
 * in one plane; *ret is untouched then. */
tet_status tet_hull_build(tet_ctx *ctx, const tet_pls *pls, uint32_t threads, tet_hull *ret);

/* *ret_pls is the hull's cloud `pls` closed by its facets, of marker 0: see skin.h. They are as flat as the points
 * were written: where some are below the hull's faces by what a double's last bits are, or a float's, or the sixth
 * digit, and hardly any by ten times that, these are on it. exact: none is, and the facets are the faces. *ret_pls refers to
 * *ret_skin, the caller's (tet_skin_free). */
tet_status tet_hull_close(tet_ctx *ctx, const tet_pls *pls, const tet_hull *hull, int exact, tet_pls *ret_pls,
                          tet_skin *ret_skin);

void tet_hull_free(tet_ctx *ctx, tet_hull *hull);

#endif
