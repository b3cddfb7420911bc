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
#include "base/threads.h"
#include "exact/predicates.h"
#include "mesh/parallel.h"
#include "mesh/renumber.h"

enum {
  FEW = 256,        /* ordering fewer would cost more than it saves */
  FIRST_ROUND = 64, /* at most */
  ROUND_BITS = 3,   /* a round is about 2^3 times as large as the one before */
  KEYS = 256,       /* at a time */
  MANY = 50000,     /* vertices of a round worth several threads */
  ENOUGH = 1000     /* vertices before it, that there is something to share */
};

/* A hash of the vertex number decides its round: seven eighths go into the last, and so on. */
static uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

typedef struct ordering {
  const double *x;
  uint32_t *ids;
  tet_hilbert_box box;
  tet_keyed *item;
  uint32_t n, threads, rounds;
  uint32_t at[TET_MOST_THREADS][33]; /* of each thread's share, the vertices in a round; then where they go */
} ordering;

static uint32_t round_of(const ordering *o, uint32_t id) {
  uint32_t h = mix(id), level = (h ? (uint32_t)__builtin_ctz(h) : 31) / ROUND_BITS;
  return level >= o->rounds ? 0 : o->rounds - 1 - level;
}

static void count_rounds(void *arg, uint32_t share) {
  ordering *o = arg;
  uint32_t end = tet_part(o->n, o->threads, share + 1);
  for (uint32_t i = tet_part(o->n, o->threads, share); i < end; i++) o->at[share][round_of(o, o->ids[i])]++;
}

/* Keys, in the places of their rounds. */
static void set_keys(void *arg, uint32_t share) {
  ordering *o = arg;
  uint64_t key[KEYS];
  for (uint32_t i = tet_part(o->n, o->threads, share), end = tet_part(o->n, o->threads, share + 1); i < end;) {
    uint32_t count = end - i < KEYS ? end - i : KEYS;
    tet_hilbert_keys(&o->box, o->x, o->ids + i, count, key);
    for (uint32_t k = 0; k < count; k++, i++) o->item[o->at[share][round_of(o, o->ids[i])]++] = (tet_keyed){key[k], o->ids[i]};
  }
}

static void set_ids(void *arg, uint32_t share) {
  ordering *o = arg;
  uint32_t end = tet_part(o->n, o->threads, share + 1);
  for (uint32_t i = tet_part(o->n, o->threads, share); i < end; i++) o->ids[i] = (uint32_t)o->item[i].value;
}

/* Sorts ids by round, and inside a round along the curve. */
static tet_status order_rounds(tet_complex *c, uint32_t *ids, uint32_t n, uint32_t threads, tet_rounds *rounds) {
  ordering o = {.x = c->points->x, .ids = ids, .n = n, .threads = threads, .rounds = 1};
  for (uint32_t size = n; size > FIRST_ROUND; size >>= ROUND_BITS) o.rounds++;
  o.item = tet_alloc(c->ctx, n, sizeof *o.item);
  tet_keyed *scratch = tet_alloc(c->ctx, n, sizeof *scratch);
  tet_status status = o.item && scratch ? TET_OK : tet_ctx_error(c->ctx)->status;
  if (status == TET_OK) {
    uint32_t sum = 0;
    o.box = tet_hilbert_bound(o.x, ids, n);
    tet_run_threads(threads, count_rounds, &o);
    rounds->n = o.rounds;
    rounds->box = o.box;
    for (uint32_t r = 0; r < o.rounds; r++) {
      rounds->start[r] = sum;
      for (uint32_t i = 0; i < threads; i++) {
        uint32_t count = o.at[i][r];
        o.at[i][r] = sum;
        sum += count;
      }
    }
    rounds->start[o.rounds] = n;
    tet_run_threads(threads, set_keys, &o);
    for (uint32_t r = 0; r < o.rounds; r++)
      tet_sort_radix(o.item + rounds->start[r], scratch, rounds->start[r + 1] - rounds->start[r], threads);
    tet_run_threads(threads, set_ids, &o);
  }
  tet_free(c->ctx, o.item);
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

/* To numbers along the order of insertion, and back. */
typedef struct renaming {
  tet_complex *c;
  const uint32_t *ids;
  const double *from;
  double *to;
  uint32_t *at; /* [n] by inner numbers: near each other where vertices are */
  uint32_t n, threads;
} renaming;

static void copy_points(void *arg, uint32_t share) {
  const renaming *r = arg;
  for (uint32_t i = tet_part(r->n, r->threads, share), end = tet_part(r->n, r->threads, share + 1); i < end; i++)
    memcpy(r->to + 3 * (size_t)i, r->from + 3 * (size_t)r->ids[i], 3 * sizeof *r->to);
}

static void rename_vertices(void *arg, uint32_t share) {
  const renaming *r = arg;
  tet_complex *c = r->c;
  uint32_t t = tet_part(c->n_slots, r->threads, share), end = tet_part(c->n_slots, r->threads, share + 1);
  for (; t < end; t++) {
    if (!tet_is_live(c, t)) continue;
    for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4; h++) {
      if (c->v[h] == TET_GHOST) continue;
      __atomic_store_n(&r->at[c->v[h]], t, __ATOMIC_RELAXED); /* one of many, whichever thread's */
      c->v[h] = r->ids[c->v[h]];
    }
  }
}

static void rename_at(void *arg, uint32_t share) {
  const renaming *r = arg;
  for (uint32_t i = tet_part(r->n, r->threads, share), end = tet_part(r->n, r->threads, share + 1); i < end; i++)
    r->c->at[r->ids[i]] = r->at[i];
}

/* Inserts round after round: the large ones by several threads, but for what these leave. */
static tet_status insert_rounds(tet_complex *c, const tet_rounds *all, uint32_t threads) {
  tet_rounds r = {.n = 0, .box = all->box};
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < all->n && status == TET_OK; k++) {
    uint32_t from = all->start[k], end = all->start[k + 1];
    r.start[k] = from;
    r.start[k + 1] = end;
    r.n = k + 1;
    if (threads > 1 && end - from >= MANY && from >= ENOUGH) status = tet_insert_round(c, &r, threads);
    else status = insert_rest(c, NULL, from < 4 ? 4 : from, end);
    tet_progress_report(c->ctx, (double)end / c->points->n, end, c->n_live, end);
  }
  return status;
}

/* The whole of tet_delaunay for many explicit vertices, ordered, and an empty complex. */
static tet_status insert_renumbered(tet_complex *c, const uint32_t *ids, uint32_t n, const tet_rounds *rounds,
                                    uint32_t threads) {
  const tet_points *outer = c->points;
  double *x = tet_alloc(c->ctx, 3 * (size_t)n, sizeof *x);
  if (!x) return tet_ctx_error(c->ctx)->status;
  renaming r = {.c = c, .ids = ids, .from = outer->x, .to = x, .n = n, .threads = threads};
  tet_run_threads(threads, copy_points, &r);
  tet_points points = tet_points_explicit(x, n);
  points.max_abs = outer->max_abs;
  points.rank = ids;
  points.tally = outer->tally;
  tet_points_find_grain(&points);
  c->points = &points;
  uint32_t *at = c->at;
  c->at = NULL;
  tet_status status = tet_complex_first(c, 0, 1, 2, 3);
  if (status == TET_OK) status = insert_rounds(c, rounds, threads);
  if (status == TET_OK && c->is_canonical && n >= MANY) status = tet_complex_renumber(c, n);
  c->points = outer;
  c->at = at;
  tet_free(c->ctx, x);
  if (status == TET_OK && !(r.at = tet_alloc(c->ctx, n, sizeof *r.at))) status = tet_ctx_error(c->ctx)->status;
  if (status == TET_OK) {
    tet_run_threads(threads, rename_vertices, &r);
    tet_run_threads(threads, rename_at, &r);
  } else {
    tet_complex_clear(c);
  }
  tet_free(c->ctx, r.at);
  return status;
}

/* 1 if the vertices can be numbered otherwise: nothing but their own numbers and places counts. */
static int can_renumber(const tet_complex *c, const uint32_t *ids, uint32_t n) {
  int any = c->points->rank != NULL;
  for (uint32_t i = 0; i < n; i++) any |= tet_is_implicit(c->points, ids[i]);
  return !any;
}

tet_status tet_delaunay(tet_complex *c, uint32_t *ids, uint32_t n, uint32_t threads) {
  uint32_t most = 0;
  tet_rounds rounds = {0};
  threads = threads < 1 ? 1 : threads > TET_MOST_THREADS ? TET_MOST_THREADS : threads;
  for (uint32_t i = 0; i < n; i++)
    if (ids[i] > most) most = ids[i];
  tet_status status = tet_complex_reserve_vertices(c, most + 1);
  if (status == TET_OK && n >= FEW) status = order_rounds(c, ids, n, threads, &rounds);
  if (status != TET_OK || c->n_live) return status == TET_OK ? insert_rest(c, ids, 0, n) : status;
  status = first_four(c, ids, n);
  if (status != TET_OK) return status;
  if (n >= FEW && can_renumber(c, ids, n)) return insert_renumbered(c, ids, n, &rounds, threads);
  status = tet_complex_first(c, ids[0], ids[1], ids[2], ids[3]);
  if (status == TET_OK) status = insert_rest(c, ids, 4, n);
  if (status != TET_OK) tet_complex_clear(c);
  return status;
}
