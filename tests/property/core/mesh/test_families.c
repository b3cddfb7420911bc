// SPDX-License-Identifier: Apache-2.0
/* Laws of bulk insertion and removal on families of points (tests/support/point_sets): Delaunay by exact
 * arithmetic; the same tetrahedra whatever the number of threads and the order; vertices removed
 * leave what the others alone would have made; the hull of a grid has the volume of its box. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "laws.h"
#include "point_sets.h"

typedef struct made {
  tet_ctx *ctx;
  tet_points points;
  tet_complex c;
  uint32_t *ids;
} made;

static made make(const char *family, uint32_t n, uint64_t seed) {
  made m = {.c = {.ctx = NULL}};
  double *x = point_set(family, n, seed, &n);
  assert_non_null(x);
  m.points = tet_points_explicit(x, n);
  tet_points_find_grain(&m.points);
  m.ids = malloc(((size_t)n + 1) * sizeof *m.ids);
  assert_non_null(m.ids);
  for (uint32_t i = 0; i < n; i++) m.ids[i] = i;
  assert_int_equal(tet_ctx_create(NULL, &m.ctx), TET_OK);
  return m;
}

static void triangulate(made *m, uint32_t threads) {
  tet_complex_init(&m->c, m->ctx, &m->points);
  assert_int_equal(tet_delaunay(&m->c, m->ids, m->points.n, threads), TET_OK);
}

static void unmake(made *m) {
  if (m->c.ctx) tet_complex_free(&m->c);
  assert_int_equal(tet_ctx_bytes(m->ctx), 0);
  tet_ctx_free(m->ctx);
  free(m->points.x);
  free(m->ids);
}

/* How many points of a family: enough for all paths, few enough for the sanitizers. */
static uint32_t size_of(const char *family) { return !strcmp(family, "circle") ? 300 : 2500; }

static void every_family_is_delaunay(void **state) {
  (void)state;
  for (const char *const *f = point_set_families; *f; f++) {
    print_message("%s\n", *f);
    made m = make(*f, size_of(*f), 7);
    triangulate(&m, 1);
    check_laws(&m.c, NULL);
    for (uint32_t v = 0; v < m.points.n; v++) assert_true(tet_index_of(&m.c, m.c.at[v], v) < 4);
    tet_complex_free(&m.c);
    unmake(&m);
  }
}

/* Six times the signed volume, exact for small integers. */
static int64_t six_volumes(const made *m) {
  int64_t sum = 0;
  for (uint32_t t = 0; t < m->c.n_slots; t++) {
    int64_t e[3][3];
    const uint32_t *v = m->c.v + 4 * (size_t)t;
    if (!tet_is_live(&m->c, t) || v[3] == TET_GHOST) continue;
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        e[i][k] = (int64_t)m->points.x[3 * (size_t)v[i + 1] + k] - (int64_t)m->points.x[3 * (size_t)v[0] + k];
    sum += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  }
  return sum;
}

static void a_grid_fills_its_box(void **state) {
  (void)state;
  for (int64_t side = 2; side <= 22; side += 5) {
    made m = make("grid", (uint32_t)(side * side * side), 1);
    triangulate(&m, 1);
    assert_int_equal(six_volumes(&m), 6 * (side - 1) * (side - 1) * (side - 1));
    unmake(&m);
  }
}

/* Rounds are large enough here that several threads do insert them. */
static void threads_make_the_same(void **state) {
  (void)state;
  static const char *const families[] = {"cube", "grid", "sphere", NULL};
  for (const char *const *f = families; *f; f++) {
    made m = make(*f, 62000, 3);
    rows first = {NULL, 0};
    uint32_t *slots = NULL;
    for (uint32_t threads = 1; threads <= 4; threads += 3) {
      print_message("%s, %u threads\n", *f, threads);
      tet_complex_init(&m.c, m.ctx, &m.points);
      m.c.is_canonical = 1;
      assert_int_equal(tet_delaunay(&m.c, m.ids, m.points.n, threads), TET_OK);
      rows r = sorted_rows(&m.c);
      size_t bytes = 4 * (size_t)m.c.n_slots * sizeof *slots;
      if (threads == 1) {
        first = r;
        slots = malloc(2 * bytes);
        assert_non_null(slots);
        memcpy(slots, m.c.v, bytes);
        memcpy((char *)slots + bytes, m.c.adj, bytes);
      } else {
        check_same(&first, &r);
        free(r.row);
        assert_int_equal(memcmp(slots, m.c.v, bytes), 0);
        assert_int_equal(memcmp((char *)slots + bytes, m.c.adj, bytes), 0);
      }
      tet_complex_free(&m.c);
    }
    free(first.row);
    free(slots);
    unmake(&m);
  }
}

static void late_vertices_make_the_same(void **state) {
  (void)state;
  for (const char *const *f = point_set_families; *f; f++) {
    made m = make(*f, size_of(*f), 11);
    triangulate(&m, 1);
    rows whole = sorted_rows(&m.c);
    tet_complex_clear(&m.c);
    uint32_t half = m.points.n / 2;
    for (uint32_t i = 0; i < m.points.n; i++) m.ids[i] = i;
    assert_int_equal(tet_delaunay(&m.c, m.ids, half, 1), TET_OK);
    assert_int_equal(tet_delaunay(&m.c, m.ids + half, m.points.n - half, 1), TET_OK);
    rows r = sorted_rows(&m.c);
    check_same(&whole, &r);
    free(r.row);
    free(whole.row);
    unmake(&m);
  }
}

static void removal_leaves_the_others(void **state) {
  (void)state;
  for (const char *const *f = point_set_families; *f; f++) {
    made m = make(*f, size_of(*f), 5);
    uint64_t s = 99;
    uint8_t *gone = calloc(m.points.n, 1);
    assert_non_null(gone);
    print_message("%s\n", *f);
    triangulate(&m, 1);
    for (uint32_t k = 0; k < m.points.n / 2;) {
      uint32_t v = (uint32_t)(point_set_next(&s) % m.points.n);
      if (gone[v]) continue;
      gone[v] = 1;
      k++;
      assert_int_equal(tet_complex_remove(&m.c, v), TET_OK);
      assert_int_equal(m.c.at[v], TET_NONE);
    }
    check_laws(&m.c, gone);
    rows r = sorted_rows(&m.c), alone = rows_without(&m.points, gone);
    check_same(&alone, &r);
    for (uint32_t v = 0; v < m.points.n; v++) /* and back */
      if (gone[v]) assert_int_equal(tet_complex_insert(&m.c, v, TET_NONE), TET_OK);
    memset(gone, 0, m.points.n);
    rows again = sorted_rows(&m.c), whole = rows_without(&m.points, gone);
    check_same(&whole, &again);
    free(r.row);
    free(alone.row);
    free(again.row);
    free(whole.row);
    free(gone);
    unmake(&m);
  }
}

/* Under every budget the run ends in time, says so, and gives all back. */
static void budgets_end_cleanly(void **state) {
  (void)state;
  made m = make("cube", 62000, 9);
  for (uint32_t threads = 1; threads <= 3; threads += 2) {
    tet_status status = TET_E_MEMORY;
    int runs = 0;
    for (uint64_t bytes = 20000; status != TET_OK; bytes *= 2, runs++) {
      const tet_limits limits = {.memory_bytes = bytes};
      tet_ctx *ctx;
      tet_complex c;
      assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
      tet_complex_init(&c, ctx, &m.points);
      status = tet_delaunay(&c, m.ids, m.points.n, threads);
      assert_true(status == TET_OK || status == TET_E_MEMORY);
      assert_true(tet_ctx_peak_bytes(ctx) <= bytes);
      tet_complex_free(&c);
      assert_int_equal(tet_ctx_bytes(ctx), 0);
      tet_ctx_free(ctx);
    }
    assert_true(runs > 6);
  }
  unmake(&m);
}

/* After an error the complex is empty and can be filled again. */
static void errors_leave_nothing(void **state) {
  (void)state;
  for (uint32_t n = 5; n <= 320; n *= 4) {
    made m = make("cube", n, 2);
    for (uint64_t bytes = 100; bytes < 100000; bytes += 24 + bytes / 64) {
      const tet_limits limits = {.memory_bytes = bytes};
      tet_ctx *ctx;
      tet_complex c;
      assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
      tet_complex_init(&c, ctx, &m.points);
      tet_status status = tet_delaunay(&c, m.ids, n, 1);
      if (status != TET_OK) {
        assert_int_equal(c.n_live, 0);
        assert_int_equal(tet_delaunay(&c, m.ids, n, 1), TET_E_MEMORY);
      }
      tet_complex_free(&c);
      assert_int_equal(tet_ctx_bytes(ctx), 0);
      tet_ctx_free(ctx);
      if (status == TET_OK) break;
    }
    unmake(&m);
  }
}

/* Vertices chosen so that all rounds but the last are empty, or nearly so: rounds go by a hash of the
 * numbers, which nobody promises to be all there. */
static void empty_rounds_are_no_matter(void **state) {
  (void)state;
  made m = make("cube", 64000, 4);
  for (uint32_t few = 0; few < 6; few += 3) {
    uint32_t n = 0, early = 0;
    for (uint32_t i = 0; i < m.points.n; i++) {
      uint32_t x = i; /* the hash of delaunay.c */
      x ^= x >> 16;
      x *= 0x7feb352du;
      x ^= x >> 15;
      x *= 0x846ca68bu;
      x ^= x >> 16;
      if (x & 7 || early++ < few) m.ids[n++] = i;
    }
    tet_complex_init(&m.c, m.ctx, &m.points);
    assert_int_equal(tet_delaunay(&m.c, m.ids, n, 2), TET_OK);
    rows two = sorted_rows(&m.c);
    tet_complex_clear(&m.c);
    assert_int_equal(tet_delaunay(&m.c, m.ids, n, 1), TET_OK);
    rows one = sorted_rows(&m.c);
    check_same(&one, &two);
    free(one.row);
    free(two.row);
    tet_complex_free(&m.c);
  }
  unmake(&m);
}

/* Magnitudes from 2^-1074 to 2^480 in one set, in many orders. */
static void magnitudes_may_differ(void **state) {
  (void)state;
  double x[3 * 14] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1e100, 3, 4, -1e100, 0, 0,
                      0, 0x1p480, 0, 1e-100, 1e-300, 5e-324, 0x1p-600, 0, 0x1p-700, 0x1p-300, -0x1p-300, 0x1p-310};
  tet_points points = tet_points_explicit(x, 14);
  uint64_t s = 1;
  tet_ctx *ctx;
  tet_complex c;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_complex_init(&c, ctx, &points);
  for (int round = 0; round < 400; round++) {
    uint32_t ids[14];
    for (uint32_t i = 0; i < 14; i++) ids[i] = i;
    for (uint32_t i = 14; i > 1; i--) {
      uint32_t j = (uint32_t)(point_set_next(&s) % i), swap = ids[j];
      ids[j] = ids[i - 1];
      ids[i - 1] = swap;
    }
    tet_complex_clear(&c);
    assert_int_equal(tet_delaunay(&c, ids, 14, 1), TET_OK);
    check_laws(&c, NULL);
    assert_int_equal(tet_complex_remove(&c, ids[3]), TET_OK);
    check_laws(&c, NULL);
  }
  tet_complex_free(&c);
  tet_ctx_free(ctx);
}

static void a_taken_place_is_refused(void **state) {
  (void)state;
  double x[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1, 1, 0, 0};
  tet_points points = tet_points_explicit(x, 6);
  uint32_t ids[6] = {0, 1, 2, 3, 4, 5};
  tet_ctx *ctx;
  tet_complex c;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_complex_init(&c, ctx, &points);
  assert_int_equal(tet_delaunay(&c, ids, 6, 1), TET_E_INTERNAL);
  assert_int_equal(c.n_live, 0);
  tet_complex_free(&c);
  tet_ctx_free(ctx);
}

static void cancelled_runs_end(void **state) {
  (void)state;
  made m = make("cube", 70000, 9);
  for (uint32_t threads = 1; threads <= 2; threads++) {
    const tet_limits limits = {.deadline_seconds = 0.03};
    for (int late = 0; late < 2; late++) {
      tet_ctx *ctx;
      tet_complex c;
      assert_int_equal(tet_ctx_create(late ? &limits : NULL, &ctx), TET_OK);
      tet_complex_init(&c, ctx, &m.points);
      if (!late) tet_cancel(ctx);
      assert_int_equal(tet_delaunay(&c, m.ids, m.points.n, threads), late ? TET_E_DEADLINE : TET_E_CANCELLED);
      tet_complex_free(&c);
      assert_int_equal(tet_ctx_bytes(ctx), 0);
      tet_ctx_free(ctx);
    }
  }
  unmake(&m);
}

/* A removal that does not get its memory changes nothing. */
static void starved_removals_change_nothing(void **state) {
  (void)state;
  made m = make("circle", 200, 9);
  uint32_t starved = 0;
  for (uint64_t bytes = 10000; bytes < 20000000; bytes += bytes / 4) {
    const tet_limits limits = {.memory_bytes = bytes};
    tet_ctx *ctx;
    tet_complex c;
    assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
    tet_complex_init(&c, ctx, &m.points);
    if (tet_delaunay(&c, m.ids, m.points.n, 1) == TET_OK) {
      rows before = sorted_rows(&c);
      tet_status status = TET_OK;
      for (uint32_t v = 0; v < 4 && status == TET_OK; v++) {
        status = tet_complex_remove(&c, v);
        rows after = sorted_rows(&c);
        if (status == TET_E_MEMORY) check_same(&before, &after);
        else assert_int_equal(status, TET_OK);
        free(before.row);
        before = after;
      }
      starved += status == TET_E_MEMORY;
      check_laws(&c, NULL);
      free(before.row);
    }
    tet_complex_free(&c);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
  assert_true(starved > 0);
  unmake(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_family_is_delaunay),   cmocka_unit_test(a_grid_fills_its_box),
      cmocka_unit_test(threads_make_the_same),      cmocka_unit_test(late_vertices_make_the_same),
      cmocka_unit_test(removal_leaves_the_others),  cmocka_unit_test(budgets_end_cleanly),
      cmocka_unit_test(cancelled_runs_end),         cmocka_unit_test(starved_removals_change_nothing),
      cmocka_unit_test(errors_leave_nothing),       cmocka_unit_test(empty_rounds_are_no_matter),
      cmocka_unit_test(magnitudes_may_differ),      cmocka_unit_test(a_taken_place_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
