// SPDX-License-Identifier: Apache-2.0
/* delaunay.c: Delaunay tetrahedralization of a point set by incremental insertion.
 *
 * Rounds of growing size in a biased random order, each sorted along a
 * Hilbert curve. The result is unique (symbolic perturbation), so neither order
 * nor seed shows in it. Duplicates must be gone.
 *
 * Many vertices are copied in the order of their insertion and numbered by it while
 * they are inserted, so that those that are near in space are near in memory. */
#include "mesh/delaunay.h"

#include <string.h>

#include "base/hilbert.h"
#include "base/sort.h"
#include "exact/predicates.h"

enum {
  FEW = 256,       /* ordering fewer would cost more than it saves */
  FIRST_ROUND = 64, /* at most */
  ROUND_BITS = 3,   /* a round is about 2^3 times as large as the one before */
  KEYS = 256        /* at a time */
};

/* A hash of the vertex number decides its round: seven eighths go into the last, and so on. */
static uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

/* Sorts ids by round, and inside a round along the curve. */
static tet_status order_rounds(tet_complex *c, uint32_t *ids, uint32_t n) {
  uint32_t rounds = 1;
  for (uint32_t size = n; size > FIRST_ROUND; size >>= ROUND_BITS) rounds++;
  tet_keyed *item = tet_alloc(c->ctx, n, sizeof *item), *scratch = tet_alloc(c->ctx, n, sizeof *scratch);
  tet_status status = item && scratch ? TET_OK : tet_ctx_error(c->ctx)->status;
  if (status == TET_OK) {
    tet_hilbert_box box = tet_hilbert_bound(c->points->x, ids, n);
    uint32_t start[33] = {0};
    uint64_t key[KEYS];
    for (uint32_t i = 0; i < n; i++) {
      if (i % KEYS == 0) tet_hilbert_keys(&box, c->points->x, ids + i, n - i < KEYS ? n - i : KEYS, key);
      uint32_t h = mix(ids[i]), level = (h ? (uint32_t)__builtin_ctz(h) : 31) / ROUND_BITS;
      uint64_t round = level >= rounds ? 0 : rounds - 1 - level;
      item[i].key = key[i % KEYS];
      item[i].value = round << 32 | ids[i];
      start[round + 1]++;
    }
    tet_sort_radix(item, scratch, n);
    /* a stable counting sort by round */
    for (uint32_t r = 1; r < 33; r++) start[r] += start[r - 1];
    for (uint32_t i = 0; i < n; i++) ids[start[item[i].value >> 32]++] = (uint32_t)item[i].value;
  }
  tet_free(c->ctx, item);
  tet_free(c->ctx, scratch);
  return status;
}

static void swap(uint32_t *a, uint32_t *b) {
  uint32_t t = *a;
  *a = *b;
  *b = t;
}

/* Brings four vertices that are not in one plane to the front, the first positive. */
static tet_status first_four(tet_complex *c, uint32_t *ids, uint32_t n) {
  const tet_points *p = c->points;
  uint32_t i = 2;
  while (i < n && tet_collinear(p, ids[0], ids[1], ids[i])) i++;
  if (n < 4 || i >= n)
    return tet_fail(c->ctx, TET_E_DEGENERATE,
                    n < 4 ? "%u distinct points span no volume" : "all %u points lie on one line", n);
  swap(&ids[2], &ids[i]);
  i = 3;
  int side = 0;
  while (i < n && !(side = tet_orient3d(p, ids[0], ids[1], ids[2], ids[i]))) i++;
  if (i == n) return tet_fail(c->ctx, TET_E_DEGENERATE, "all %u points lie in one plane", n);
  swap(&ids[3], &ids[i]);
  if (side < 0) swap(&ids[0], &ids[1]);
  return TET_OK;
}

/* Inserts ids[from] and those after it. */
static tet_status insert_rest(tet_complex *c, const uint32_t *ids, uint32_t from, uint32_t n) {
  tet_status status = TET_OK;
  for (uint32_t i = from; i < n && status == TET_OK; i++) {
    status = tet_complex_insert(c, ids ? ids[i] : i, TET_NONE);
    if (status == TET_OK && (i & 63) == 0) status = tet_poll(c->ctx);
    if ((i & 1023) == 0) tet_progress_report(c->ctx, (double)i / n, i, c->n_live, i);
  }
  return status;
}

/* From numbers along the order of insertion back to those of the caller. */
static void rename_vertices(tet_complex *c, const uint32_t *ids) {
  for (uint32_t t = 0; t < c->n_slots; t++) {
    if (!tet_is_live(c, t)) continue;
    for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4; h++) {
      if (c->v[h] == TET_GHOST) continue;
      c->v[h] = ids[c->v[h]];
      c->at[c->v[h]] = t;
    }
  }
}

/* Slots for n vertices: about as many tetrahedra as evenly spread points have. */
static uint64_t usual_slots(uint32_t n) { return (uint64_t)n * 27 / 4 + 64; }

/* The whole of tet_delaunay for many explicit vertices, ordered, and an empty complex. */
static tet_status insert_renumbered(tet_complex *c, const uint32_t *ids, uint32_t n) {
  const tet_points *outer = c->points;
  double *x = tet_alloc(c->ctx, 3 * (size_t)n, sizeof *x);
  if (!x) return tet_ctx_error(c->ctx)->status;
  for (uint32_t i = 0; i < n; i++) memcpy(x + 3 * (size_t)i, outer->x + 3 * (size_t)ids[i], 3 * sizeof *x);
  tet_points points = tet_points_explicit(x, n);
  points.max_abs = outer->max_abs;
  points.rank = ids;
  tet_points_find_grain(&points);
  c->points = &points;
  uint32_t *at = c->at;
  c->at = NULL;
  tet_status status = tet_complex_reserve(c, usual_slots(n));
  if (status == TET_OK) status = tet_complex_first(c, 0, 1, 2, 3);
  if (status == TET_OK) status = insert_rest(c, NULL, 4, n);
  c->points = outer;
  c->at = at;
  tet_free(c->ctx, x);
  if (status == TET_OK) rename_vertices(c, ids);
  else tet_complex_clear(c);
  return status;
}

static int all_explicit(const tet_complex *c, const uint32_t *ids, uint32_t n) {
  int any = 0;
  for (uint32_t i = 0; i < n; i++) any |= tet_is_implicit(c->points, ids[i]);
  return !any;
}

tet_status tet_delaunay(tet_complex *c, uint32_t *ids, uint32_t n, uint32_t threads) {
  (void)threads;
  uint32_t most = 0;
  for (uint32_t i = 0; i < n; i++)
    if (ids[i] > most) most = ids[i];
  tet_status status = tet_complex_reserve_vertices(c, most + 1);
  if (status == TET_OK && n >= FEW) status = order_rounds(c, ids, n);
  if (status != TET_OK || c->n_live) return status == TET_OK ? insert_rest(c, ids, 0, n) : status;
  status = first_four(c, ids, n);
  if (status != TET_OK) return status;
  if (n >= FEW && all_explicit(c, ids, n)) return insert_renumbered(c, ids, n);
  status = tet_complex_first(c, ids[0], ids[1], ids[2], ids[3]);
  return status == TET_OK ? insert_rest(c, ids, 4, n) : status;
}
