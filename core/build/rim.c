// SPDX-License-Identifier: Apache-2.0
/* rim.c: a bit for each pair of vertices of a cavity's border. All vertices of a cavity are on its
 * border, and an edge of it that is not lies inside, and is gone once the cavity is filled. */
#include "build/rim.h"

#include <string.h>

tet_status tet_rim_reserve(tet_ctx *ctx, tet_rim *l, uint32_t n) {
  size_t before = l->cap_place;
  tet_status status = tet_grow(ctx, &l->place, &l->cap_place, n, 1);
  if (status == TET_OK && l->cap_place > before) memset(l->place + before, 0, l->cap_place - before);
  return status;
}

void tet_rim_free(tet_ctx *ctx, tet_rim *l) { tet_free(ctx, l->place); }

/* Where the bit of the pair at two places, counted from 1, is. */
static size_t row_of(uint32_t i, uint32_t j) { return (i < j ? i : j) - 1; }
static uint32_t bit_of(uint32_t i, uint32_t j) { return (i < j ? j : i) - 1; }

int tet_rim_has(const tet_rim *l, uint32_t v, uint32_t w) {
  uint32_t i = l->place[v], j = l->place[w], bit = bit_of(i, j);
  return i && j && l->edge[row_of(i, j)][bit / 64] >> bit % 64 & 1;
}

static void add_edge(tet_rim *l, uint32_t v, uint32_t w) {
  uint32_t i = l->place[v], j = l->place[w], bit = bit_of(i, j);
  l->edge[row_of(i, j)][bit / 64] |= UINT64_C(1) << bit % 64;
}

int tet_rim_find(tet_rim *l, const tet_complex *c) {
  for (; l->n; l->n--) l->place[l->vertex[l->n - 1]] = 0;
  for (size_t k = 0; k < c->n_border; k++) {
    const uint32_t *v = c->border[k].v;
    const uint8_t *f = tet_face[c->border[k].inner & 3];
    for (int i = 0; i < 3; i++) {
      uint32_t w = v[f[i]];
      if (w == TET_GHOST || l->place[w]) continue;
      if (l->n == TET_MOST_RIM) return 0;
      memset(l->edge[l->n], 0, sizeof l->edge[l->n]);
      l->vertex[l->n++] = w;
      l->place[w] = (uint8_t)l->n;
    }
    for (int i = 0; i < 3; i++)
      if (v[f[i]] != TET_GHOST && v[f[(i + 1) % 3]] != TET_GHOST) add_edge(l, v[f[i]], v[f[(i + 1) % 3]]);
  }
  return 1;
}
