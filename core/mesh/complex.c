// SPDX-License-Identifier: Apache-2.0
/* complex.c: storage of the complex, and finding vertices, edges and faces in it.
 *
 * Insertion is in insertion.c. Nothing here decides by geometry. */
#include "mesh/complex.h"

#include "mesh/hole.h"

#include <string.h>

void tet_complex_init(tet_complex *c, tet_ctx *ctx, const tet_points *points) {
  memset(c, 0, sizeof *c);
  c->ctx = ctx;
  c->points = points;
  c->mine[0] = 1;
  tet_complex_clear(c);
}

void tet_complex_free(tet_complex *c) {
  void *all[] = {c->v,   c->adj,    c->flag, c->wall,  c->at, c->cavity, c->old,
                 c->border, c->made, c->place, c->map.key, c->map.handle};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(c->ctx, all[i]);
  tet_hole_free(c);
  memset(c, 0, sizeof *c);
}

void tet_complex_clear(tet_complex *c) {
  c->n_slots = c->n_live = c->n_free = 0;
  c->free_slot = c->last = TET_NONE;
  c->random = 2463534242u;
}

tet_status tet_complex_reserve_vertices(tet_complex *c, uint32_t n) {
  size_t before = c->cap_at;
  tet_status status = tet_grow(c->ctx, &c->at, &c->cap_at, n, sizeof *c->at);
  if (status != TET_OK) return status;
  for (size_t i = before; i < c->cap_at; i++) c->at[i] = TET_NONE;
  return tet_complex_reserve_places(c, n);
}

tet_status tet_complex_reserve_places(tet_complex *c, uint32_t n) {
  size_t before = c->cap_place;
  tet_status status = tet_grow(c->ctx, &c->place, &c->cap_place, (size_t)n + 1, sizeof *c->place);
  if (status == TET_OK) memset(c->place + before, 0, c->cap_place - before);
  return status;
}

tet_status tet_complex_reserve(tet_complex *c, uint64_t n) {
  if (n > TET_MOST_TETRAHEDRA) return tet_fail(c->ctx, TET_E_TOO_LARGE, "more than 2^30 - 1 tetrahedra");
  if (n <= c->cap_slots) return TET_OK;
  tet_status status = tet_grow(c->ctx, &c->v, &c->cap_v, 4 * (size_t)n, sizeof *c->v);
  if (status == TET_OK) status = tet_grow(c->ctx, &c->adj, &c->cap_adj, 4 * (size_t)n, sizeof *c->adj);
  if (status == TET_OK) status = tet_grow(c->ctx, &c->flag, &c->cap_flag, (size_t)n, sizeof *c->flag);
  if (status == TET_OK && c->is_walled) status = tet_grow(c->ctx, &c->wall, &c->cap_wall, (size_t)n, sizeof *c->wall);
  size_t least = c->cap_v / 4 < c->cap_flag ? c->cap_v / 4 : c->cap_flag;
  if (c->is_walled && c->cap_wall < least) least = c->cap_wall;
  if (c->cap_adj / 4 < least) least = c->cap_adj / 4;
  if (status == TET_OK) c->cap_slots = least < TET_MOST_TETRAHEDRA ? least : TET_MOST_TETRAHEDRA;
  return status;
}

tet_status tet_complex_new(tet_complex *c, uint32_t *ret_t) {
  uint32_t t = c->free_slot;
  if (t != TET_NONE) {
    c->free_slot = c->v[4 * (size_t)t];
    c->n_free--;
  } else {
    tet_status status = tet_complex_reserve(c, (uint64_t)c->n_slots + 1);
    if (status != TET_OK) return status;
    t = c->n_slots++;
  }
  tet_set_flag(c, t, c->owner);
  c->n_live++;
  *ret_t = t;
  return TET_OK;
}

void tet_complex_delete(tet_complex *c, uint32_t t) {
  tet_set_flag(c, t, TET_FLAG_FREE);
  c->v[4 * (size_t)t] = c->free_slot;
  c->free_slot = t;
  c->n_free++;
  c->n_live--;
}

int tet_complex_take_block(tet_complex *c, size_t n) {
  if (!c->pool || n > c->pool->block) return 0;
  uint32_t block = c->pool->block, next = atomic_fetch_add_explicit(&c->pool->next, block, memory_order_relaxed);
  if (next > c->pool->end || c->pool->end - next < block) {
    atomic_fetch_sub_explicit(&c->pool->next, block, memory_order_relaxed);
    return 0;
  }
  tet_complex_give_up(c);
  c->n_slots = next;
  c->cap_slots = next + block;
  return 1;
}

void tet_complex_give_up(tet_complex *c) {
  for (; c->n_slots < c->cap_slots; c->n_slots++) {
    c->n_live++;
    tet_complex_delete(c, c->n_slots);
  }
}

/* The tetrahedra of a, into made: all, or up to the first that also has vertex b, or no more than
 * about `most`. */
static tet_status flood_star(tet_complex *c, uint32_t a, uint32_t b, size_t most, uint32_t *ret_t) {
  *ret_t = TET_NONE;
  c->n_made = 0;
  uint32_t first = c->at[a];
  if (first == TET_NONE) return TET_OK;
  tet_status status = tet_grow(c->ctx, &c->made, &c->cap_made, 64, sizeof *c->made);
  if (status != TET_OK) return status;
  c->made[c->n_made++] = first;
  c->flag[first] |= TET_FLAG_MARK;
  if (b != TET_NONE && tet_index_of(c, first, b) < 4) *ret_t = first;
  for (size_t k = 0; k < c->n_made && k < most && *ret_t == TET_NONE && status == TET_OK; k++) {
    const size_t h = 4 * (size_t)c->made[k];
    if (c->cap_made - c->n_made < 3) status = tet_grow(c->ctx, &c->made, &c->cap_made, c->n_made + 3, sizeof *c->made);
    for (size_t i = h; i < h + 4 && *ret_t == TET_NONE && status == TET_OK; i++) {
      uint32_t o = c->adj[i] >> 2;
      if (c->v[i] == a || c->flag[o] & TET_FLAG_MARK) continue;
      c->flag[o] |= TET_FLAG_MARK;
      c->made[c->n_made++] = o;
      if (b != TET_NONE && c->v[c->adj[i]] == b) *ret_t = o; /* no other vertex of it is new */
    }
  }
  for (size_t k = 0; k < c->n_made; k++) c->flag[c->made[k]] &= (uint8_t)~TET_FLAG_MARK;
  return status;
}

tet_status tet_complex_star(tet_complex *c, uint32_t a) {
  uint32_t t;
  return flood_star(c, a, TET_NONE, SIZE_MAX, &t);
}

/* Looks for an edge from a vertex of v to the next one of it, in cyclic order, by turns from all of them and
 * each time farther, so that the smallest star is what it costs. *ret_from: the one whose star was
 * looked through, or has the edge: then *ret_t has it, too. */
static tet_status find_from_any(tet_complex *c, const uint32_t *v, int n, int *ret_from, uint32_t *ret_t) {
  for (size_t most = 32;; most *= 4)
    for (int k = 0; k < n; k++) {
      tet_status status = flood_star(c, v[k], v[(k + 1) % n], most, ret_t);
      *ret_from = k;
      if (status != TET_OK || *ret_t != TET_NONE || c->n_made <= most) return status;
    }
}

tet_status tet_complex_find_edge(tet_complex *c, uint32_t a, uint32_t b, uint32_t *ret_t) {
  const uint32_t v[2] = {a, b};
  int from;
  return find_from_any(c, v, 2, &from, ret_t);
}

uint32_t tet_complex_face_at_edge(const tet_complex *c, uint32_t t, uint32_t a, uint32_t b, uint32_t d) {
  /* turn around ab from t; `w` is the vertex left behind */
  uint32_t from = t, w = TET_NONE;
  const uint32_t *v = c->v + 4 * (size_t)t;
  for (int i = 0; i < 4; i++)
    if (v[i] != a && v[i] != b) w = v[i];
  do {
    v = c->v + 4 * (size_t)t;
    int i = 0;
    while (v[i] == a || v[i] == b || v[i] == w) i++; /* the fourth vertex */
    if (v[i] == d || w == d) {
      int k = tet_index_of(c, t, v[i] == d ? w : v[i]);
      uint32_t h = 4 * t + (uint32_t)k;
      const uint8_t *f = tet_face[k];
      for (int j = 0; j < 3; j++)
        if (v[f[j]] == a && v[f[(j + 1) % 3]] == b) return h;
      return c->adj[h];
    }
    uint32_t next = v[i];
    t = c->adj[4 * (size_t)t + (size_t)tet_index_of(c, t, w)] >> 2;
    w = next;
  } while (t != from);
  return TET_NONE;
}

tet_status tet_complex_find_face(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t *ret_handle) {
  const uint32_t v[3] = {a, b, d};
  uint32_t t;
  int k;
  *ret_handle = TET_NONE;
  tet_status status = find_from_any(c, v, 3, &k, &t);
  if (status == TET_OK && t != TET_NONE)
    *ret_handle = tet_complex_face_at_edge(c, t, v[k], v[(k + 1) % 3], v[(k + 2) % 3]);
  return status;
}
