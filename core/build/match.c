// SPDX-License-Identifier: Apache-2.0
/* match.c: which triangles of the surface are faces of the complex, all at once (thesis 5.3 and 5.4
 * look for the missing ones).
 *
 * One pass over the tetrahedra as they lie, which is far faster than a search for each triangle
 * from its vertices. */
#include "build/state.h"

#include <string.h>

/* A triangle at its lowest corner: the other two, the lower in the upper half. */
typedef struct entry {
  uint64_t others;
  uint32_t tri;
} entry;

/* Triangles by their lowest corner. */
typedef struct corner_list {
  uint32_t *start; /* [points + 2] into entry */
  entry *entry;
  uint64_t *mask;  /* [points] the bits of the other corners: most faces are none of the triangles, and end here */
} corner_list;

static inline void order(uint64_t *a, uint64_t *b) {
  uint64_t lower = *a < *b ? *a : *b, higher = *a < *b ? *b : *a;
  *a = lower;
  *b = higher;
}

static inline uint64_t bit_of(uint32_t v) { return UINT64_C(1) << (v * 0x9E3779B1u >> 26); }

static tet_status list_corners(tet_state *st, corner_list *l) {
  const tet_surface *s = &st->surface;
  size_t n = st->points.n;
  l->start = tet_calloc(st->ctx, n + 2, sizeof *l->start);
  l->entry = tet_alloc(st->ctx, s->n_tris, sizeof *l->entry);
  l->mask = tet_calloc(st->ctx, n, sizeof *l->mask);
  if (!l->start || !l->entry || !l->mask) return tet_ctx_error(st->ctx)->status;
  for (int fill = 0; fill < 2; fill++) {
    for (uint32_t t = 0; t < s->n_tris; t++) {
      const uint32_t *v = s->tri + 3 * (size_t)t;
      uint64_t w[3] = {v[0], v[1], v[2]};
      order(&w[0], &w[1]);
      order(&w[1], &w[2]);
      order(&w[0], &w[1]);
      if (fill) l->entry[l->start[w[0] + 1]++] = (entry){w[1] << 32 | w[2], t};
      else l->start[w[0] + 2]++;
      l->mask[w[0]] |= bit_of((uint32_t)w[1]) | bit_of((uint32_t)w[2]);
    }
    for (size_t v = 2; v < n + 2 && !fill; v++) l->start[v] += l->start[v - 1];
  }
  return TET_OK;
}

/* The triangle with these corners, rising, or TET_NONE. */
static inline uint32_t find(const corner_list *l, uint32_t a, uint32_t b, uint32_t c) {
  uint64_t others = (uint64_t)b << 32 | c;
  for (uint32_t k = l->start[a]; k < l->start[a + 1]; k++)
    if (l->entry[k].others == others) return l->entry[k].tri;
  return TET_NONE;
}

static void match(const tet_complex *c, const corner_list *l, uint32_t t, uint32_t *face) {
  uint64_t w[4], mask[4]; /* w: the vertices, rising, each with its place in t */
  uint32_t v[4];
  for (size_t i = 0; i < 4; i++) w[i] = (uint64_t)c->v[4 * (size_t)t + i] << 2 | i;
  order(&w[0], &w[1]);
  order(&w[2], &w[3]);
  order(&w[0], &w[2]);
  order(&w[1], &w[3]);
  order(&w[1], &w[2]);
  for (int i = 0; i < 4; i++) v[i] = (uint32_t)(w[i] >> 2);
  mask[0] = l->mask[v[1]]; /* that of the lowest corner of the face without v[i] */
  mask[1] = mask[2] = mask[3] = l->mask[v[0]];
  int last = v[3] == TET_GHOST ? 3 : 0;
  for (int i = 3; i >= last; i--) { /* a ghost's only face is the one without v[3] */
    uint32_t h = 4 * t + (uint32_t)(w[i] & 3), b = v[1 + (i < 2)], d = v[2 + (i < 3)], tri;
    uint64_t bits = bit_of(b) | bit_of(d);
    if ((mask[i] & bits) != bits || c->adj[h] < h) continue; /* once for both its sides */
    tri = find(l, v[i < 1], b, d);
    if (tri != TET_NONE) face[tri] = h;
  }
}

tet_status tet_match_triangles(tet_state *st, uint32_t **ret_face) {
  const tet_complex *c = &st->complex;
  corner_list l = {NULL, NULL, NULL};
  size_t n = st->surface.n_tris;
  uint32_t *face = tet_alloc(st->ctx, n, sizeof *face);
  tet_status status = face ? list_corners(st, &l) : tet_ctx_error(st->ctx)->status;
  if (status == TET_OK && n) memset(face, 0xff, n * sizeof *face);
  for (uint32_t t = 0; t < c->n_slots && n && status == TET_OK; t++) {
    if (tet_is_live(c, t)) match(c, &l, t, face);
    if (t % 4096 == 0) status = tet_poll(st->ctx);
  }
  tet_free(st->ctx, l.start);
  tet_free(st->ctx, l.entry);
  tet_free(st->ctx, l.mask);
  if (status == TET_OK) *ret_face = face;
  else tet_free(st->ctx, face);
  return status;
}
