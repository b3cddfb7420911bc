// SPDX-License-Identifier: Apache-2.0
/* rim.h: the border of the cavity that an insertion filled, to tell the edges that are left of it. */
#ifndef TET_BUILD_RIM_H
#define TET_BUILD_RIM_H

#include "mesh/complex.h"

enum { TET_MOST_RIM = 255, TET_RIM_WORDS = 4 };

/* Vertices, the ghost aside, and which pairs have an edge there. All zero: of nothing yet. */
typedef struct tet_rim {
  uint8_t *place; /* [vertices] in `vertex`, counted from 1; 0: not there */
  size_t cap_place;
  uint32_t n, vertex[TET_MOST_RIM];
  uint64_t edge[TET_MOST_RIM][TET_RIM_WORDS]; /* by the lower place */
} tet_rim;

/* Makes room for `n` vertices. */
tet_status tet_rim_reserve(tet_ctx *ctx, tet_rim *l, uint32_t n);
void tet_rim_free(tet_ctx *ctx, tet_rim *l);

/* Forgets the last cavity for the one that c has just filled. 0: that has too many vertices, and nothing is
 * known of it. */
int tet_rim_find(tet_rim *l, const tet_complex *c);

/* 1: v is on the border, and so has an edge with the vertex just inserted. */
static inline int tet_rim_holds(const tet_rim *l, uint32_t v) { return l->place[v] != 0; }

/* 1: v and w have an edge on the border. */
int tet_rim_has(const tet_rim *l, uint32_t v, uint32_t w);

#endif
