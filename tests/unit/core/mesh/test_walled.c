// SPDX-License-Identifier: Apache-2.0
/* Walled complexes: insertion makes of them what it makes of the whole of space, no cavity
 * crosses a wall, a cavity that is given up leaves no trace, and faces that are not locally
 * Delaunay are counted unless they are walls. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "mesh/delaunay.h"
#include "rows.h"

enum { BOX = 8, BASE = 48, MOST = 128 };

static uint32_t next(uint32_t *random) { return *random = *random * 1664525u + 1013904223u; }

/* The corners of a box and distinct points inside it, of an integer grid if `ties`. */
static tet_points make_points(double *x, int ties, uint32_t seed) {
  uint32_t n = BOX;
  for (uint32_t i = 0; i < 3 * BOX; i++) x[i] = i / 3 >> i % 3 & 1 ? 9 : -2;
  while (n < MOST) {
    double y[3];
    for (int j = 0; j < 3; j++) y[j] = ties ? next(&seed) >> 29 : next(&seed) * 0x7p-32;
    int known = 0;
    for (uint32_t k = 0; k < n; k++) known |= !memcmp(x + 3 * k, y, sizeof y);
    if (!known) memcpy(x + 3 * (size_t)n++, y, sizeof y);
  }
  return tet_points_explicit(x, n);
}

/* The finite tetrahedra of `whole` alone; the hull becomes walls. */
static void make_walled(tet_complex *w, const tet_complex *whole) {
  uint32_t *slot = calloc(whole->n_slots, sizeof *slot), n = 0;
  for (uint32_t t = 0; t < whole->n_slots; t++)
    if (tet_is_live(whole, t) && !tet_is_ghost(whole, t)) slot[t] = n++;
  tet_complex_init(w, whole->ctx, whole->points);
  w->is_walled = 1;
  assert_int_equal(tet_complex_reserve(w, n), TET_OK);
  assert_int_equal(tet_complex_reserve_places(w, whole->points->n), TET_OK);
  for (uint32_t t = 0; t < whole->n_slots; t++) {
    uint32_t to;
    if (!tet_is_live(whole, t) || tet_is_ghost(whole, t)) continue;
    assert_int_equal(tet_complex_new(w, &to), TET_OK);
    assert_int_equal(to, slot[t]);
    w->wall[to] = 0;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t g = whole->adj[4 * (size_t)t + i];
      w->v[4 * (size_t)to + i] = whole->v[4 * (size_t)t + i];
      w->adj[4 * (size_t)to + i] = tet_is_ghost(whole, g >> 2) ? TET_NONE : 4 * slot[g >> 2] + (g & 3);
      if (tet_is_ghost(whole, g >> 2)) w->wall[to] |= (uint8_t)(1 << i);
    }
  }
  free(slot);
}

/* Some tetrahedron in conflict with p. */
static uint32_t find_conflict(const tet_complex *w, uint32_t p) {
  uint32_t t = 0;
  while (!tet_is_live(w, t) || !tet_complex_conflict(w, t, p)) t++;
  return t;
}

static void begin(tet_complex *w, uint32_t t) {
  assert_int_equal(tet_grow(w->ctx, &w->cavity, &w->cap_cavity, 1, sizeof *w->cavity), TET_OK);
  w->cavity[0] = t;
  w->n_cavity = 1;
  w->flag[t] |= TET_FLAG_CAVITY;
}

/* Inserts p, as who keeps walls has to: new tetrahedra have the walls of the border. */
static void insert(tet_complex *w, uint32_t p) {
  begin(w, find_conflict(w, p));
  assert_int_equal(tet_complex_grow(w, p), TET_OK);
  size_t n = w->n_border;
  uint8_t *wall = malloc(n);
  for (size_t k = 0; k < n; k++) wall[k] = w->wall[w->border[k].inner >> 2] & (uint8_t)(1 << (w->border[k].inner & 3));
  assert_int_equal(tet_complex_fill(w), TET_OK);
  for (size_t k = 0; k < n; k++) w->wall[w->cavity[k]] = wall[k];
  free(wall);
}

/* Adjacency is mutual, and nothing beyond but at walls. */
static void check_walled(const tet_complex *w) {
  for (uint32_t h = 0; h < 4 * w->n_slots; h++) {
    if (!tet_is_live(w, h >> 2)) continue;
    assert_int_equal(w->flag[h >> 2], 0);
    if (w->adj[h] != TET_NONE) assert_int_equal(w->adj[w->adj[h]], h);
    else assert_true(w->wall[h >> 2] >> (h & 3) & 1);
  }
}

/* The tetrahedralization of the first points, and its walled copy. */
static void begin_both(tet_complex *whole, tet_complex *w, tet_ctx **ret_ctx, const tet_points *points) {
  uint32_t ids[BASE];
  for (uint32_t i = 0; i < BASE; i++) ids[i] = i;
  assert_int_equal(tet_ctx_create(NULL, ret_ctx), TET_OK);
  tet_complex_init(whole, *ret_ctx, points);
  assert_int_equal(tet_delaunay(whole, ids, BASE, 1), TET_OK);
  make_walled(w, whole);
}

static void end_both(tet_complex *whole, tet_complex *w, tet_ctx *ctx) {
  tet_complex_free(whole);
  tet_complex_free(w);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void insertion_is_that_of_the_whole(void **state) {
  (void)state;
  static double x[3 * MOST];
  for (uint32_t seed = 1; seed <= 10; seed++)
    for (int ties = 0; ties < 2; ties++) {
      print_message("seed %u ties %d\n", seed, ties);
      tet_points points = make_points(x, ties, seed);
      tet_ctx *ctx;
      tet_complex whole, w;
      begin_both(&whole, &w, &ctx, &points);
      assert_int_equal(tet_complex_reserve_vertices(&whole, MOST), TET_OK);
      for (uint32_t p = BASE; p < MOST; p++) {
        uint64_t broken;
        assert_int_equal(tet_complex_insert(&whole, p, TET_NONE), TET_OK);
        insert(&w, p);
        check_walled(&w);
        rows expected = finite_rows(&whole), made = finite_rows(&w);
        check_same(&expected, &made);
        free(expected.row);
        free(made.row);
        assert_int_equal(tet_complex_count_broken(&w, &broken), TET_OK);
        assert_int_equal(broken, 0);
      }
      end_both(&whole, &w, ctx);
    }
}

/* Walls between the tetrahedra of low and of high vertices. */
static void no_cavity_crosses_a_wall(void **state) {
  (void)state;
  static double x[3 * MOST];
  uint32_t stopped = 0;
  for (uint32_t seed = 1; seed <= 10; seed++) {
    tet_points points = make_points(x, 0, seed);
    tet_ctx *ctx;
    tet_complex whole, w;
    begin_both(&whole, &w, &ctx, &points);
    uint8_t *high = calloc(w.n_slots, 1);
    for (uint32_t t = 0; t < w.n_slots; t++) {
      double sum = 0;
      for (int i = 0; i < 4; i++) sum += x[3 * (size_t)w.v[4 * (size_t)t + (size_t)i]];
      high[t] = sum > 14;
    }
    for (uint32_t h = 0; h < 4 * w.n_slots; h++)
      if (w.adj[h] != TET_NONE && high[h >> 2] != high[w.adj[h] >> 2]) w.wall[h >> 2] |= (uint8_t)(1 << (h & 3));
    for (uint32_t p = BASE; p < MOST; p++) {
      uint32_t t = find_conflict(&w, p), n = 0;
      begin(&w, t);
      assert_int_equal(tet_complex_grow(&w, p), TET_OK);
      for (size_t k = 0; k < w.n_cavity; k++) assert_int_equal(high[w.cavity[k]], high[t]);
      for (size_t k = 0; k < w.n_border; k++) {
        uint32_t g = w.border[k].outer;
        n += g != TET_NONE && high[g >> 2] != high[t] && tet_complex_conflict(&w, g >> 2, p);
      }
      stopped += n > 0;
      tet_complex_forget(&w);
      for (uint32_t k = 0; k < w.n_slots; k++) assert_int_equal(w.flag[k], 0);
    }
    free(high);
    end_both(&whole, &w, ctx);
  }
  assert_true(stopped > 10);
}

static void broken_faces_are_counted(void **state) {
  (void)state;
  double x[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, 1, 0.3, 0.3, -0.1};
  tet_points points = tet_points_explicit(x, 5);
  const uint32_t v[8] = {0, 1, 2, 3, 0, 2, 1, 4};
  tet_ctx *ctx;
  tet_complex w;
  uint64_t n;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_complex_init(&w, ctx, &points);
  w.is_walled = 1;
  assert_int_equal(tet_complex_reserve(&w, 2), TET_OK);
  for (uint32_t t = 0; t < 2; t++) {
    uint32_t made;
    assert_int_equal(tet_complex_new(&w, &made), TET_OK);
    memcpy(w.v + 4 * t, v + 4 * t, 4 * sizeof *v);
    for (int i = 0; i < 3; i++) w.adj[4 * t + (uint32_t)i] = TET_NONE;
    w.adj[4 * t + 3] = 4 * (1 - t) + 3;
    w.wall[t] = 7;
  }
  assert_int_equal(tet_complex_count_broken(&w, &n), TET_OK);
  assert_int_equal(n, 1);
  w.wall[0] = w.wall[1] = 15;
  assert_int_equal(tet_complex_count_broken(&w, &n), TET_OK);
  assert_int_equal(n, 0);
  tet_complex_free(&w);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(insertion_is_that_of_the_whole),
      cmocka_unit_test(no_cavity_crosses_a_wall),
      cmocka_unit_test(broken_faces_are_counted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
