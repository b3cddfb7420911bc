// SPDX-License-Identifier: Apache-2.0
/* Laws of the Delaunay complex on generated points: adjacency is mutual, every
 * finite tetrahedron positive, no neighbour in conflict, every vertex, edge and face
 * found again, and the result the same for every order of insertion. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "mesh/delaunay.h"
#include "exact/predicates.h"
#include "rows.h"

enum { MOST = 400 };

typedef struct cloud {
  double x[3 * MOST];
  uint32_t ids[MOST], n;
  tet_points points;
} cloud;

static uint32_t next(uint32_t *random) { return *random = *random * 1664525u + 1013904223u; }

/* `kind` 0: uniform; 1: a small integer grid, distinct points; 2: on a sphere's
 * integer points and its axis, many cospherical; 3: two skew lines. */
static void make_cloud(cloud *c, int kind, uint32_t n, uint32_t seed) {
  c->n = 0;
  for (uint32_t tries = 0; tries < 50 * n && c->n < n; tries++) {
    double x[3];
    for (int j = 0; j < 3; j++)
      x[j] = kind == 0 ? next(&seed) / 4294967296.0 : (double)(next(&seed) >> 29) - (kind == 2 ? 3 : 0);
    if (kind == 2 && x[0] * x[0] + x[1] * x[1] + x[2] * x[2] != 9 && x[0] * x[0] + x[1] * x[1] > 0) continue;
    if (kind == 3) {
      int line = (int)(tries & 1);
      x[1] = line ? 5 : x[0] + tries;
      x[2] = line ? x[0] + tries * 2 : 1;
      x[0] = line;
    }
    int known = 0;
    for (uint32_t k = 0; k < c->n; k++) known |= !memcmp(c->x + 3 * k, x, sizeof x);
    if (known) continue;
    memcpy(c->x + 3 * (size_t)c->n, x, sizeof x);
    c->ids[c->n] = c->n;
    c->n++;
  }
  c->points = tet_points_explicit(c->x, c->n);
}

static void check_laws(tet_complex *c, const cloud *p) {
  for (uint32_t t = 0; t < c->n_slots; t++) {
    if (!tet_is_live(c, t)) continue;
    const uint32_t *v = c->v + 4 * (size_t)t;
    if (!tet_is_ghost(c, t)) assert_true(tet_orient3d(&p->points, v[0], v[1], v[2], v[3]) > 0);
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t g = c->adj[4 * (size_t)t + i], h;
      assert_int_equal(c->adj[g], 4 * t + i);
      if (c->v[g] != TET_GHOST) assert_false(tet_complex_conflict(c, t, c->v[g]));
      const uint8_t *f = tet_face[i];
      if (v[f[0]] == TET_GHOST || v[f[1]] == TET_GHOST || v[f[2]] == TET_GHOST) continue;
      assert_int_equal(tet_complex_find_face(c, v[f[0]], v[f[1]], v[f[2]], &h), TET_OK);
      assert_int_equal(h, 4 * t + i);
    }
  }
  for (uint32_t k = 0; k < p->n; k++) assert_true(tet_index_of(c, c->at[k], k) < 4);
}

static void build(tet_complex *c, tet_ctx *ctx, cloud *p, int expect_volume) {
  tet_complex_init(c, ctx, &p->points);
  assert_int_equal(tet_delaunay(c, p->ids, p->n, 1), expect_volume ? TET_OK : TET_E_DEGENERATE);
}

static void laws_hold_and_order_does_not_matter(void **state) {
  (void)state;
  static cloud p;
  for (int kind = 0; kind < 4; kind++)
    for (uint32_t seed = 1; seed <= 12; seed++) {
      rows made[2];
      print_message("kind %d seed %u\n", kind, seed);
      make_cloud(&p, kind, seed == 12 ? MOST : 8 * seed, seed);
      for (int round = 0; round < 2; round++) {
        tet_ctx *ctx;
        tet_complex c;
        assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
        for (uint32_t i = 0; round && i < p.n; i++) p.ids[i] = p.n - 1 - i;
        build(&c, ctx, &p, 1);
        check_laws(&c, &p);
        made[round] = sorted_rows(&c);
        tet_complex_free(&c);
        assert_int_equal(tet_ctx_bytes(ctx), 0);
        tet_ctx_free(ctx);
      }
      check_same(&made[0], &made[1]);
      for (int round = 0; round < 2; round++) free(made[round].row);
    }
}

/* Edges and faces that are there are found from all ends, others are not; also where all stars
 * but one are large. */
static void edges_and_faces_are_found(void **state) {
  (void)state;
  enum { N = 150 };
  static cloud p;
  static uint8_t joined[N][N], face[N][N][N];
  tet_ctx *ctx;
  tet_complex c;
  p.n = N; /* a shallow bowl between two hubs */
  for (uint32_t i = 0; i < N; i++) {
    double x = cos(2.4 * i) * sqrt(i), y = sin(2.4 * i) * sqrt(i);
    double at[3] = {x, y, 0.001 * (x * x + y * y)}, hub[3] = {0, 0, i ? 3000 : -3000};
    memcpy(p.x + 3 * (size_t)i, i < 2 ? hub : at, sizeof at);
    p.ids[i] = i;
  }
  p.points = tet_points_explicit(p.x, p.n);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  build(&c, ctx, &p, 1);
  memset(joined, 0, sizeof joined);
  memset(face, 0, sizeof face);
  uint32_t largest = 0;
  for (uint32_t t = 0; t < c.n_slots; t++) {
    if (!tet_is_live(&c, t) || tet_is_ghost(&c, t)) continue;
    const uint32_t *v = c.v + 4 * (size_t)t;
    largest += tet_index_of(&c, t, 0) < 4;
    for (int i = 0; i < 64; i++) joined[v[i & 3]][v[i >> 2 & 3]] = face[v[i & 3]][v[i >> 2 & 3]][v[i >> 4]] = 1;
  }
  assert_true(largest > 130);
  for (uint32_t a = 0; a < N; a++)
    for (uint32_t b = 0; b < N; b++) {
      uint32_t t, h;
      if (a == b) continue;
      assert_int_equal(tet_complex_find_edge(&c, a, b, &t), TET_OK);
      assert_int_equal(t != TET_NONE, joined[a][b]);
      if (t != TET_NONE) assert_true(tet_index_of(&c, t, a) < 4 && tet_index_of(&c, t, b) < 4);
      for (uint32_t d = (a + b) % 7; d < N; d += 7) {
        if (d == a || d == b) continue;
        assert_int_equal(tet_complex_find_face(&c, a, b, d, &h), TET_OK);
        assert_int_equal(h != TET_NONE, face[a][b][d]);
        if (h == TET_NONE) continue;
        const uint8_t *f = tet_face[h & 3];
        const uint32_t *v = c.v + (h & ~(size_t)3);
        int k = 0;
        while (v[f[k]] != a) k++;
        assert_true(v[f[(k + 1) % 3]] == b && v[f[(k + 2) % 3]] == d);
      }
    }
  tet_complex_free(&c);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void points_without_volume_are_refused(void **state) {
  (void)state;
  static cloud p;
  for (int kind = 0; kind < 3; kind++) { /* all on a line; all in a plane; three points */
    tet_ctx *ctx;
    tet_complex c;
    p.n = kind == 2 ? 3 : 50;
    for (uint32_t i = 0; i < p.n; i++) {
      p.ids[i] = i;
      p.x[3 * i] = i;
      p.x[3 * i + 1] = kind == 0 ? 2.0 * i : i * i % 7;
      p.x[3 * i + 2] = 5;
    }
    p.points = tet_points_explicit(p.x, p.n);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    build(&c, ctx, &p, 0);
    tet_complex_free(&c);
    tet_ctx_free(ctx);
  }
}

static void a_budget_ends_the_run_cleanly(void **state) {
  (void)state;
  static cloud p;
  make_cloud(&p, 0, MOST, 5);
  int refused = 0;
  for (uint64_t budget = 1000; budget < 300000; budget += 3001) {
    tet_limits limits = {.memory_bytes = budget};
    tet_ctx *ctx;
    tet_complex c;
    assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
    tet_complex_init(&c, ctx, &p.points);
    tet_status status = tet_delaunay(&c, p.ids, p.n, 1);
    assert_true(status == TET_OK || status == TET_E_MEMORY);
    assert_true(tet_ctx_peak_bytes(ctx) <= budget);
    refused += status == TET_E_MEMORY;
    tet_complex_free(&c);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
  assert_true(refused > 0 && refused < 99);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(laws_hold_and_order_does_not_matter),
      cmocka_unit_test(edges_and_faces_are_found), cmocka_unit_test(points_without_volume_are_refused),
      cmocka_unit_test(a_budget_ends_the_run_cleanly),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
