// SPDX-License-Identifier: Apache-2.0
/* thin.h: places on segments where Steiner points are wanted from the start. */
#ifndef TET_BUILD_THIN_H
#define TET_BUILD_THIN_H

#include "build/surface.h"

/* A place on a segment where a Steiner point is wanted from the start. */
typedef struct tet_break {
  uint32_t segment;
  double t;
} tet_break;

typedef struct tet_breaks {
  tet_break *at; /* sorted by segment and t */
  size_t n, cap;
} tet_breaks;

/* Keeps in *best the place on subsegment xy, number `sub`, that is nearest to line de, if they
 * cross as seen along their common normal, nearer than *gap, which it then lowers. points: [n][3]. */
void tet_break_consider(const tet_surface *surface, const tet_points *exact, const double *points, uint32_t sub,
                        uint32_t x, uint32_t y, uint32_t d, uint32_t e, tet_break *best, double *gap);

/* Appends; to be sorted before use, which leaves each place once. */
tet_status tet_breaks_add(tet_ctx *ctx, tet_breaks *breaks, const tet_break *b);
void tet_breaks_sort(tet_breaks *breaks);

/* Looks for tetrahedra flatter than `least` (at a crease: than its facet is out of plane) between
 * a subsegment of one of their subfaces and the opposite edge, and adds the place on it where that
 * passes; least 0 finds none. tri: the surface's triangle at each face of `p`. *ret_found: how
 * many were added. */
tet_status tet_find_thin(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, const tet_pieces *p,
                         const uint32_t *tri, double least, tet_breaks *breaks, size_t *ret_found);

#endif
