// SPDX-License-Identifier: Apache-2.0
/* pack.h: from the form between stages to the mesh that leaves. */
#ifndef TET_ENGINE_PACK_H
#define TET_ENGINE_PACK_H

#include "build/build.h"
#include "refine/refine.h"

#include <tet/engine.h>

/* Fills the arrays of `mesh` (all zero but ctx) from `built` and, where not NULL,
 * `refined`. What can be taken over is: it is gone from there then, and the rest
 * still has to be freed by its owner. Attributes and markers come from `pls`; new
 * points on segments and facets carry the marker of these. Rows are in the stages'
 * order. On failure `mesh` can only be freed. */
tet_status tet_pack_mesh(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_build_result *built,
                         tet_refine_result *refined, tet_mesh *mesh);

/* Fills the attributes of `pieces`'s new vertices into values [n_points][n_attributes],
 * whose input rows are filled. On a segment: linear between its ends. Elsewhere: the
 * mean of the neighbours, weighted by the inverse squared distance (after (4.5)),
 * settled by a few sweeps: on a facet neighbours are those in its subfaces. */
tet_status tet_interpolate_attributes(tet_ctx *ctx, const tet_pieces *pieces, uint32_t n_attributes, double *values);

#endif
