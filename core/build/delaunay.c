// SPDX-License-Identifier: Apache-2.0
/* delaunay.c: Delaunay tetrahedralization of a point set by incremental insertion.
 *
 * Rounds of about doubling size in a biased random order, each sorted along a
 * Hilbert curve. The result is unique (symbolic perturbation), so neither order
 * nor seed shows in it. Duplicates must be gone. */
#include "build/delaunay.h"

#include "base/hilbert.h"
#include "base/sort.h"
#include "exact/predicates.h"

/* A hash of the vertex number decides its round: half go into the last, a quarter
 * into the one before, and so on. */
static uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

/* Sorts ids by round, and inside a round along the curve. */
static tet_status order_rounds(tet_complex *c, uint32_t *ids, uint32_t n) {
  uint32_t rounds = 1, size = n;
  if (n < 256) return TET_OK; /* a cavity: ordering would cost more than it saves */
  while (size > 64 && rounds < 24) {
    size /= 2;
    rounds++;
  }
  tet_keyed *item = tet_alloc(c->ctx, n, sizeof *item);
  if (!item) return tet_ctx_error(c->ctx)->status;
  tet_hilbert_box box = tet_hilbert_bound(c->points->x, c->points->n);
  for (uint32_t i = 0; i < n; i++) {
    uint32_t h = mix(ids[i]), level = h ? (uint32_t)__builtin_ctz(h) : 31;
    uint64_t round = level >= rounds ? 0 : rounds - 1 - level;
    item[i].key = tet_hilbert_key(&box, c->points->x + 3 * (size_t)ids[i]);
    item[i].value = round << 32 | ids[i];
  }
  tet_sort_keyed(item, n);
  /* a stable counting sort by round */
  uint32_t start[32] = {0};
  for (uint32_t i = 0; i < n; i++) start[(item[i].value >> 32) + 1]++;
  for (uint32_t r = 1; r < 32; r++) start[r] += start[r - 1];
  for (uint32_t i = 0; i < n; i++) ids[start[item[i].value >> 32]++] = (uint32_t)item[i].value;
  tet_free(c->ctx, item);
  return TET_OK;
}

static void swap(uint32_t *a, uint32_t *b) {
  uint32_t t = *a;
  *a = *b;
  *b = t;
}

/* Brings four vertices that are not in one plane to the front. */
static tet_status first_four(tet_complex *c, uint32_t *ids, uint32_t n) {
  const tet_points *p = c->points;
  uint32_t i = 2;
  while (i < n && tet_collinear(p, ids[0], ids[1], ids[i])) i++;
  if (n < 4 || i == n)
    return tet_fail(c->ctx, TET_E_DEGENERATE,
                    n < 4 ? "%u distinct points span no volume" : "all %u points lie on one line", n);
  swap(&ids[2], &ids[i]);
  i = 3;
  int side = 0;
  while (i < n && !(side = tet_orient3d(p, ids[0], ids[1], ids[2], ids[i]))) i++;
  if (i == n) return tet_fail(c->ctx, TET_E_DEGENERATE, "all %u points lie in one plane", n);
  swap(&ids[3], &ids[i]);
  if (side < 0) swap(&ids[0], &ids[1]);
  return tet_complex_first(c, ids[0], ids[1], ids[2], ids[3]);
}

tet_status tet_delaunay(tet_complex *c, uint32_t *ids, uint32_t n) {
  uint32_t most = 0;
  for (uint32_t i = 0; i < n; i++)
    if (ids[i] > most) most = ids[i];
  tet_status status = tet_complex_reserve_vertices(c, most + 1);
  if (status == TET_OK) status = order_rounds(c, ids, n);
  if (status == TET_OK) status = first_four(c, ids, n);
  for (uint32_t i = 4; i < n && status == TET_OK; i++) {
    status = tet_complex_insert(c, ids[i], TET_NONE);
    if (status == TET_OK && (i & 63) == 0) status = tet_poll(c->ctx);
    if ((i & 1023) == 0) tet_progress_report(c->ctx, (double)i / n, i, c->n_live, i);
  }
  return status;
}
