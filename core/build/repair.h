// SPDX-License-Identifier: Apache-2.0
/* repair.h: flips after rounding. */
#ifndef TET_BUILD_REPAIR_H
#define TET_BUILD_REPAIR_H

#include "build/surface.h"
#include "build/thin.h"

/* Makes every tetrahedron of `p` positive and every interior face that is no subface
 * locally Delaunay, by flips; `exact` knows the implicit points (its x may be gone:
 * the coordinates are those of p); *tri ([n_tets][4], may move) is kept. Only tetrahedra
 * with a Steiner point are looked at first. Errors: TET_E_ROUNDING, with a place,
 * where neither flips nor moving Steiner points along their segments get there; `breaks` then
 * has more places where a subsegment is in the way, if there are any. Fills rounding_flips and
 * _moves. */
tet_status tet_repair(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, tet_pieces *p,
                      uint32_t **tri, tet_breaks *breaks, tet_counts *counts);

/* Drops the tetrahedra whose first vertex is TET_NONE: the last ones take their places. */
void tet_close_gaps(tet_pieces *p, uint32_t *tri);

#endif
