// SPDX-License-Identifier: Apache-2.0
/* match.c: which triangles of the surface are faces of the complex, all at once (thesis 5.3 and 5.4
 * look for the missing ones).
 *
 * One pass over the tetrahedra as they lie, which is far faster than a search for each triangle
 * from its vertices, where triangles are not rare. */
#include "build/state.h"

#include <string.h>

#include "base/sort.h"

enum { FEW = 8, RARE = 32 }; /* triangles of a corner that are gone through; tetrahedra for each triangle */

/* Triangles by their lowest corner. */
typedef struct corner_list {
  uint32_t *start;  /* [points + 2] into entry */
  tet_keyed *entry; /* the other two corners, the lower in the upper half; the triangle. Many of one rise */
  uint64_t *mask;   /* [points] the bits of the other corners: most faces are none of the triangles, and end here */
} corner_list;

static inline void order(uint64_t *a, uint64_t *b) {
  uint64_t lower = *a < *b ? *a : *b, higher = *a < *b ? *b : *a;
  *a = lower;
  *b = higher;
}

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
      uint32_t w[3] = {v[0], v[1], v[2]};
      tet_sort3(w);
      if (fill) {
        l->entry[l->start[w[0] + 1]++] = (tet_keyed){(uint64_t)w[1] << 32 | w[2], t};
        l->mask[w[0]] |= tet_vertex_bit(w[1]) | tet_vertex_bit(w[2]);
      } else {
        l->start[w[0] + 2]++;
      }
    }
    for (size_t v = 2; v < n + 2 && !fill; v++) l->start[v] += l->start[v - 1];
  }
  for (size_t v = 0; v < n; v++)
    if (l->start[v + 1] - l->start[v] > FEW) tet_sort_keyed(l->entry + l->start[v], l->start[v + 1] - l->start[v]);
  return TET_OK;
}

/* The triangle with these corners, rising, or TET_NONE. */
static inline uint32_t find(const corner_list *l, uint32_t a, uint32_t b, uint32_t c) {
  uint64_t others = (uint64_t)b << 32 | c;
  uint32_t from = l->start[a], to = l->start[a + 1];
  while (to - from > FEW) {
    uint32_t middle = from + (to - from) / 2;
    if (l->entry[middle].key <= others) from = middle;
    else to = middle;
  }
  for (; from < to; from++)
    if (l->entry[from].key == others) return (uint32_t)l->entry[from].value;
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
    uint64_t bits = tet_vertex_bit(b) | tet_vertex_bit(d);
    if ((mask[i] & bits) != bits || c->adj[h] < h) continue; /* once for both its sides */
    tri = find(l, v[i < 1], b, d);
    if (tri != TET_NONE) face[tri] = h;
  }
}

static tet_status match_all(tet_state *st, uint32_t *face) {
  const tet_complex *c = &st->complex;
  corner_list l = {NULL, NULL, NULL};
  tet_status status = list_corners(st, &l);
  for (uint32_t t = 0; t < c->n_slots && status == TET_OK; t++) {
    if (tet_is_live(c, t)) match(c, &l, t, face);
    if (t % 4096 == 0) status = tet_poll(st->ctx);
  }
  tet_free(st->ctx, l.start);
  tet_free(st->ctx, l.entry);
  tet_free(st->ctx, l.mask);
  return status;
}

/* Each by a search from its vertices. */
static tet_status match_each(tet_state *st, uint32_t *face) {
  tet_status status = TET_OK;
  for (uint32_t tri = 0; tri < st->surface.n_tris && status == TET_OK; tri++) {
    const uint32_t *v = st->surface.tri + 3 * (size_t)tri;
    status = tet_complex_find_face(&st->complex, v[0], v[1], v[2], &face[tri]);
    if (status == TET_OK && tri % 256 == 0) status = tet_poll(st->ctx);
  }
  return status;
}

tet_status tet_match_triangles(tet_state *st, uint32_t **ret_face) {
  size_t n = st->surface.n_tris;
  uint32_t *face = tet_alloc(st->ctx, n, sizeof *face);
  if (!face) return tet_ctx_error(st->ctx)->status;
  memset(face, 0xff, n * sizeof *face);
  tet_status status = RARE * n < st->complex.n_live ? match_each(st, face) : match_all(st, face);
  if (status == TET_OK) *ret_face = face;
  else tet_free(st->ctx, face);
  return status;
}
