// SPDX-License-Identifier: Apache-2.0
/* In which order tetrahedra over the radius-edge bound leave the queue. */
#include "refine/refiner.h"
#include "solids.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 300, MOST = 8 * N };

/* A box with N points in it, of which many are close to others; ready to be refined. */
typedef struct fixture {
  tet_ctx *ctx;
  double points[8 + N][3];
  solid box;
  tet_build_result built;
  refiner r;
} fixture;

static double unit(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static fixture *start(tet_insertion order) {
  static const double unturned[2] = {0, 0};
  fixture *f = calloc(1, sizeof *f);
  uint64_t random = 1;
  assert_non_null(f);
  solid_regular(&f->box, 4, 1, unturned);
  memcpy(f->points, f->box.points, 8 * sizeof *f->points);
  for (int i = 8; i < 8 + N; i++)
    for (int k = 0; k < 3; k++) {
      double at = i % 3 && i > 8 ? f->points[i - 1][k] + 1e-3 * i / N * (unit(&random) - 0.5) : 0.1 + 0.3 * unit(&random);
      f->points[i][k] = at;
    }
  f->box.pls.n_points = 8 + N;
  f->box.pls.points = f->points[0];
  f->box.pls.n_loose_points = TET_LOOSE_ALL_UNUSED;
  assert_int_equal(tet_ctx_create(NULL, &f->ctx), TET_OK);
  assert_int_equal(solid_build(f->ctx, &f->box, &f->built), TET_OK);
  tet_stage_begin(f->ctx, "refine");
  refiner *r = &f->r;
  *r = (refiner){.ctx = f->ctx, .out = &f->built.pieces};
  tet_refine_options_default(&r->o);
  r->o.order = order;
  assert_int_equal(refine_load(r), TET_OK);
  assert_int_equal(refine_open_queue(r), TET_OK);
  assert_int_equal(refine_set_bounds(r), TET_OK);
  return f;
}

static void end(fixture *f) {
  assert_int_equal(refine_unload(&f->r), TET_OK);
  refine_release(&f->r);
  tet_build_result_free(f->ctx, &f->built);
  assert_int_equal(tet_ctx_bytes(f->ctx), 0);
  tet_ctx_free(f->ctx);
  free(f);
}

/* Queues all that is over the bound and takes it out again: the tetrahedra in order. */
static uint32_t drain(refiner *r, uint32_t tet[MOST], refine_shape shape[MOST]) {
  uint32_t n = 0, over = 0;
  int sliver;
  r->watch_tets = 1;
  for (uint32_t t = 0; t < r->mesh.n_slots; t++) {
    if (!refine_alive(r, t)) continue;
    refine_measure(r, t, &shape[0]);
    over += (uint32_t)refine_over_ratio(r, &shape[0]);
    assert_int_equal(refine_queue_tet(r, t), TET_OK);
  }
  while (n < MOST && refine_next_tet(r, &tet[n], &shape[n], &sliver)) {
    assert_false(sliver);
    n++;
  }
  assert_true(over > 100);
  assert_int_equal(n, over);
  return n;
}

static double value(tet_insertion order, const refine_shape *s) {
  if (order == TET_INSERT_O2) return sqrt(s->shortest2);
  return refine_radius_edge(s) * (order == TET_INSERT_O1 ? 1 : sqrt(s->shortest2));
}

static void each_order_sorts_by_its_own_measure(void **state) {
  (void)state;
  static const struct { tet_insertion order; int descends; } sorted[] = {
      {TET_INSERT_O1, 1}, {TET_INSERT_O2, 0}, {TET_INSERT_O3, 0}, {TET_INSERT_O4, 1}};
  static const double alike = 1 + 1.0 / 64; /* within a 32nd of a power of two, of squares */
  uint32_t tet[MOST];
  refine_shape shape[MOST];
  for (size_t i = 0; i < sizeof sorted / sizeof *sorted; i++) {
    fixture *f = start(sorted[i].order);
    uint32_t n = drain(&f->r, tet, shape);
    double furthest = sorted[i].descends ? INFINITY : 0;
    for (uint32_t k = 0; k < n; k++) {
      double x = value(sorted[i].order, &shape[k]);
      if (sorted[i].descends) assert_true(x <= furthest * alike);
      else assert_true(x * alike >= furthest);
      furthest = sorted[i].descends ? fmin(furthest, x) : fmax(furthest, x);
    }
    end(f);
  }
}

/* The number of quarters of powers of two below x. */
static int quarters(double x) {
  int power;
  double part = frexp(x, &power);
  return 4 * power + (int)floor(8 * part - 4);
}

static void the_usual_order_sorts_by_lengths_then_ratios(void **state) {
  (void)state;
  uint32_t tet[MOST], changes = 0;
  refine_shape shape[MOST];
  fixture *f = start(TET_INSERT_O2_O1);
  uint32_t n = drain(&f->r, tet, shape);
  for (uint32_t k = 1; k < n; k++) {
    int before = quarters(shape[k - 1].shortest2), now = quarters(shape[k].shortest2);
    assert_true(now >= before);
    changes += now > before;
    if (now > before) continue;
    double bound = f->r.o.radius_edge;
    double x = refine_radius_edge(&shape[k - 1]) / bound, y = refine_radius_edge(&shape[k]) / bound;
    if (y < 1.8) assert_true(y * y <= x * x * 1.2500001); /* beyond, all are alike */
  }
  assert_true(changes > 5 && changes < n / 3);
  end(f);
}

static void random_is_sorted_by_none(void **state) {
  (void)state;
  uint32_t tet[MOST];
  refine_shape shape[MOST];
  fixture *f = start(TET_INSERT_O5);
  uint32_t n = drain(&f->r, tet, shape);
  for (tet_insertion by = TET_INSERT_O1; by <= TET_INSERT_O3; by++) {
    uint32_t up = 0;
    for (uint32_t k = 1; k < n; k++) up += value(by, &shape[k]) > value(by, &shape[k - 1]);
    assert_true(up > n / 3 && up < 2 * n / 3);
  }
  end(f);
}

/* Of the shortest edge of t. */
static uint32_t younger_end(const refiner *r, uint32_t t) {
  double least = INFINITY;
  uint32_t young = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      uint32_t a = r->mesh.v[4 * (size_t)t + (size_t)i], b = r->mesh.v[4 * (size_t)t + (size_t)j];
      const double *x = refine_x(r, a), *y = refine_x(r, b);
      double d = hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]);
      if (d < least) {
        least = d;
        young = a > b ? a : b;
      }
    }
  return young;
}

static void a_rounds_edges_wait_for_those_of_the_round_before(void **state) {
  (void)state;
  static const uint32_t begun[] = {8 + N / 3, 8 + 2 * N / 3}; /* as if the later vertices had come in rounds */
  uint32_t tet[MOST];
  refine_shape shape[MOST];
  fixture *f = start(TET_INSERT_RELATIVELY_SHORT);
  refiner *r = &f->r;
  memcpy(r->round_start, begun, sizeof begun);
  r->n_rounds = 2;
  uint32_t n = drain(r, tet, shape), round = 0;
  for (uint32_t k = 0; k < n; k++) {
    uint32_t young = younger_end(r, tet[k]), is = (young >= begun[0]) + (uint32_t)(young >= begun[1]);
    assert_true(is >= round);
    round = is;
  }
  assert_int_equal(round, 2);
  assert_int_equal(r->n_rounds, 3); /* the third has begun */
  assert_int_equal(r->round_start[2], r->points.n);
  end(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(each_order_sorts_by_its_own_measure),
                                     cmocka_unit_test(the_usual_order_sorts_by_lengths_then_ratios),
                                     cmocka_unit_test(random_is_sorted_by_none),
                                     cmocka_unit_test(a_rounds_edges_wait_for_those_of_the_round_before)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
