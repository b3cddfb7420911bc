// SPDX-License-Identifier: Apache-2.0
/* boxtree.h: all pairs of boxes that meet, by a tree of boxes against itself. */
#ifndef TET_BUILD_BOXTREE_H
#define TET_BUILD_BOXTREE_H

#include "base/context.h"

typedef struct tet_box {
  double lo[3], hi[3];
} tet_box;

typedef tet_status (*tet_box_pair_fn)(void *user, uint32_t i, uint32_t j);

/* The up to three corners of what box i is around, the last one again where there are fewer. */
typedef void (*tet_box_corners_fn)(void *user, uint32_t i, const double *ret_x[3]);

static inline int tet_boxes_meet(const tet_box *a, const tet_box *b) {
  int meet = 1;
  for (int k = 0; k < 3; k++) meet &= (a->lo[k] <= b->hi[k]) & (b->lo[k] <= a->hi[k]); /* no branches to guess */
  return meet;
}

/* Calls `pair` once for every two of the n boxes that touch or overlap, but for some whose corners'
 * hulls do not; stops at the first status that is not TET_OK. The order depends on the corners alone.
 * About n log n and the number of hulls that meet, or come close for their size, however they lie. */
tet_status tet_box_pairs(tet_ctx *ctx, const tet_box *box, uint32_t n, tet_box_corners_fn corners,
                         tet_box_pair_fn pair, void *user);

#endif
