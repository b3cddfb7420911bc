// SPDX-License-Identifier: Apache-2.0
/* renumber.c: slots in an order that depends on the tetrahedra alone.
 *
 * The tetrahedra of a Delaunay tetrahedralization are the same whatever made them; their slots, and so
 * all that later walks in their order, are not. After this they are, and lie in the order of
 * their last vertices, which is along a curve where vertices are numbered along one. */
#include "mesh/renumber.h"

#include <string.h>

#include "base/sort.h"

/* The finite vertices of t falling, then TET_GHOST if there is one. */
static void falling(const uint32_t *v, uint32_t out[4]) {
  int n = v[3] == TET_GHOST ? 3 : 4;
  memcpy(out, v, 4 * sizeof *out);
  for (int i = 1; i < n; i++)
    for (int j = i; j > 0 && out[j - 1] < out[j]; j--) {
      uint32_t swap = out[j];
      out[j] = out[j - 1];
      out[j - 1] = swap;
    }
}

/* All slots, the live ones by their vertices: what is in slot order[k] is to be in slot k. */
static tet_status find_order(tet_complex *c, uint32_t n_vertices, uint32_t *order, uint32_t *ret_n) {
  uint32_t w[4], n = 0;
  uint32_t *start = tet_calloc(c->ctx, (size_t)n_vertices + 1, sizeof *start);
  tet_keyed *item = NULL;
  size_t cap = 0;
  tet_status status = start ? TET_OK : tet_ctx_error(c->ctx)->status;
  for (uint32_t t = 0; t < c->n_slots && status == TET_OK; t++) {
    if (!tet_is_live(c, t)) continue;
    falling(c->v + 4 * (size_t)t, w);
    start[w[0] + 1]++;
  }
  for (uint32_t v = 0; v < n_vertices && status == TET_OK; v++) start[v + 1] += start[v];
  for (uint32_t t = 0; t < c->n_slots && status == TET_OK; t++) {
    if (!tet_is_live(c, t)) continue;
    falling(c->v + 4 * (size_t)t, w);
    order[start[w[0]]++] = t; /* then start[v] is where the next group begins */
  }
  for (uint32_t v = 0; v < n_vertices && status == TET_OK; v++) {
    uint32_t count = start[v] - n;
    status = tet_grow(c->ctx, &item, &cap, count, sizeof *item);
    for (uint32_t k = 0; k < count && status == TET_OK; k++) {
      falling(c->v + 4 * (size_t)order[n + k], w);
      item[k] = (tet_keyed){(uint64_t)w[1] << 32 | w[2], (uint64_t)w[3] << 32 | order[n + k]};
    }
    if (status == TET_OK) tet_sort_keyed(item, count);
    for (uint32_t k = 0; k < count && status == TET_OK; k++) order[n + k] = (uint32_t)item[k].value;
    n = start[v];
  }
  *ret_n = n;
  for (uint32_t t = 0; t < c->n_slots && status == TET_OK; t++)
    if (!tet_is_live(c, t)) order[n++] = t;
  tet_free(c->ctx, item);
  tet_free(c->ctx, start);
  return status;
}

/* The vertices of one tetrahedron, falling up to parity, and with them what is beyond its faces. */
static void turn(uint32_t v[4], uint32_t beyond[4]) {
  int n = v[3] == TET_GHOST ? 3 : 4, swaps = 0;
  for (int i = 1; i < n; i++)
    for (int j = i; j > 0 && v[j - 1] < v[j]; j--, swaps++) {
      uint32_t a = v[j], b = beyond[j];
      v[j] = v[j - 1];
      beyond[j] = beyond[j - 1];
      v[j - 1] = a;
      beyond[j - 1] = b;
    }
  if (swaps % 2 == 0) return;
  uint32_t a = v[1], b = beyond[1];
  v[1] = v[2];
  beyond[1] = beyond[2];
  v[2] = a;
  beyond[2] = b;
}

/* Moves rows of four so that row k becomes what row order[k] was; `moved` is of scratch. */
static void permute(uint32_t *rows, const uint32_t *order, uint32_t n, uint8_t *moved) {
  memset(moved, 0, n);
  for (uint32_t k = 0; k < n; k++) {
    uint32_t first[4], at = k;
    if (moved[k]) continue;
    memcpy(first, rows + 4 * (size_t)k, sizeof first);
    for (; order[at] != k; at = order[at]) {
      memcpy(rows + 4 * (size_t)at, rows + 4 * (size_t)order[at], sizeof first);
      moved[at] = 1;
    }
    memcpy(rows + 4 * (size_t)at, first, sizeof first);
    moved[at] = 1;
  }
}

/* Face handles again from the numbers of neighbours. */
static void find_faces(tet_complex *c, uint32_t n) {
  for (uint32_t t = 0; t < n; t++) {
    const uint32_t *v = c->v + 4 * (size_t)t;
    for (int i = 0; i < 4; i++) {
      uint32_t o = c->adj[4 * (size_t)t + i], j = 0;
      const uint32_t *w = c->v + 4 * (size_t)o;
      /* the vertex off the common face; v[i] may be it, where two tetrahedra share four vertices */
      while (j < 3 && ((w[j] == v[0] && i != 0) || (w[j] == v[1] && i != 1) || (w[j] == v[2] && i != 2) ||
                       (w[j] == v[3] && i != 3))) j++;
      c->adj[4 * (size_t)t + i] = 4 * o + j;
    }
  }
}

tet_status tet_complex_renumber(tet_complex *c, uint32_t n_vertices) {
  uint32_t slots = c->n_slots, n = 0;
  uint32_t *order = tet_alloc(c->ctx, slots, sizeof *order), *number = tet_alloc(c->ctx, slots, sizeof *number);
  tet_status status = order && number ? find_order(c, n_vertices, order, &n) : tet_ctx_error(c->ctx)->status;
  if (status == TET_OK) {
    for (uint32_t k = 0; k < slots; k++) number[order[k]] = k;
    for (uint32_t t = 0; t < slots; t++)
      for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4 && tet_is_live(c, t); h++) c->adj[h] = number[c->adj[h] >> 2];
    permute(c->v, order, slots, c->flag);
    permute(c->adj, order, slots, c->flag);
    memset(c->flag, 0, n);
    for (uint32_t t = 0; t < n; t++) turn(c->v + 4 * (size_t)t, c->adj + 4 * (size_t)t);
    find_faces(c, n);
    c->n_slots = n;
    c->n_free = 0;
    c->free_slot = TET_NONE;
    c->last = 0;
  }
  tet_free(c->ctx, order);
  tet_free(c->ctx, number);
  return status;
}
