// SPDX-License-Identifier: Apache-2.0
/* laws.c: see the header. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "exact/exact_stage.h"
#include "laws.h"

static int orient3d(const tet_points *p, const uint32_t *v, uint32_t d) {
  const tet_point_ref ref[4] = {tet_ref(p, v[0]), tet_ref(p, v[1]), tet_ref(p, v[2]), tet_ref(p, d)};
  return tet_exact_orient3d(ref);
}

static int insphere(const tet_points *p, const uint32_t *v, uint32_t e) {
  const tet_point_ref ref[5] = {tet_ref(p, v[0]), tet_ref(p, v[1]), tet_ref(p, v[2]), tet_ref(p, v[3]), tet_ref(p, e)};
  return tet_exact_insphere(ref);
}

/* The vertex beyond face i of t is not inside: not in the sphere, or not beyond the hull's plane. */
static void check_neighbour(const tet_complex *c, uint32_t t, uint32_t i) {
  const uint32_t *v = c->v + 4 * (size_t)t;
  uint32_t g = c->adj[4 * (size_t)t + i], beyond = c->v[g], shared = 0;
  assert_int_equal(c->adj[g], 4 * t + i);
  for (uint32_t j = 0; j < 4; j++) {
    if (j == i) continue;
    int at = tet_index_of(c, g >> 2, v[j]);
    assert_true(at < 4 && (uint32_t)at != (g & 3));
    shared++;
  }
  assert_int_equal(shared, 3);
  if (beyond == TET_GHOST) return;
  if (v[3] == TET_GHOST) assert_true(orient3d(c->points, v, beyond) <= 0);
  else assert_true(insphere(c->points, v, beyond) <= 0);
}

void check_laws(const tet_complex *c, const uint8_t *gone) {
  uint32_t live = 0;
  for (uint32_t t = 0; t < c->n_slots; t++) {
    const uint32_t *v = c->v + 4 * (size_t)t;
    if (!tet_is_live(c, t)) continue;
    live++;
    assert_int_equal(c->flag[t], 0);
    for (int i = 0; i < 4; i++) assert_true(v[i] == TET_GHOST || v[i] < c->points->n);
    for (int i = 0; gone && i < 4; i++) assert_true(v[i] == TET_GHOST || !gone[v[i]]);
    if (v[3] != TET_GHOST) assert_true(orient3d(c->points, v, v[3]) > 0);
    for (uint32_t i = 0; i < 4; i++) check_neighbour(c, t, i);
  }
  assert_int_equal(live, c->n_live);
  assert_int_equal(live + c->n_free, c->n_slots);
}

rows rows_without(tet_points *points, const uint8_t *gone) {
  uint32_t n = 0, *ids = malloc(((size_t)points->n + 1) * sizeof *ids);
  tet_complex c;
  tet_ctx *ctx;
  assert_non_null(ids);
  for (uint32_t v = 0; v < points->n; v++)
    if (!gone[v]) ids[n++] = v;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_complex_init(&c, ctx, points);
  assert_int_equal(tet_delaunay(&c, ids, n, 1), TET_OK);
  rows r = sorted_rows(&c);
  tet_complex_free(&c);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  free(ids);
  return r;
}
