// SPDX-License-Identifier: Apache-2.0
/* Laws of refinement on pyramids, and on prisms from a seed: without a sharp angle there is no
 * exception, and the mesh is boundary conforming Delaunay; with one it is an exact
 * CDT; and twice the same. */
#include "refine/refine.h"
#include "solids.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double unit(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static void refine(tet_ctx *ctx, const solid *s, double volume, tet_build_result *built, tet_refine_result *r) {
  tet_refine_options o;
  tet_refine_options_default(&o);
  o.max_volume = volume;
  assert_int_equal(solid_build(ctx, s, built), TET_OK);
  tet_stage_begin(ctx, "refine");
  assert_int_equal(tet_refine(ctx, &built->pieces, &o, r), TET_OK);
  const char *fault = pieces_fault(&built->pieces);
  if (fault) print_error("%s\n", fault);
  assert_null(fault);
  assert_true(r->constrained_delaunay);
}

static void without_sharp_angles(void **state) {
  uint64_t random = *(uint64_t *)*state;
  for (int i = 0; i < 12; i++) {
    tet_ctx *ctx;
    solid s;
    tet_build_result built;
    tet_refine_result r;
    uint32_t n = 4 + (uint32_t)(unit(&random) * 5);
    double turn[2] = {6 * unit(&random), 6 * unit(&random)}, height = 0.2 + 3 * unit(&random);
    solid_regular(&s, n, height, turn);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    refine(ctx, &s, 0.02 + 0.1 * unit(&random), &built, &r);
    assert_int_equal(r.n_sharp_segments, 0);
    assert_int_equal(r.n_exceptions, 0);
    assert_true(r.gabriel);
    double volume = n * height * sin(2 * M_PI / n) / 2;
    assert_true(fabs(pieces_volume(&built.pieces) - volume) < 1e-12 * volume);
    tet_refine_result_free(ctx, &r);
    tet_build_result_free(ctx, &built);
    tet_ctx_free(ctx);
  }
}

static double shortest_edge(const tet_pieces *p) {
  double least = INFINITY;
  for (uint32_t t = 0; t < p->n_tets; t++)
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < i; j++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) {
          double d = p->points[3 * p->tets[4 * t + (uint32_t)i] + (uint32_t)k] - p->points[3 * p->tets[4 * t + (uint32_t)j] + (uint32_t)k];
          sum += d * d;
        }
        least = fmin(least, sqrt(sum));
      }
  return least;
}

/* Where segments meet at a tip, what one is cut for forces cuts of the next, all around it: they
 * do not come closer to it for that. */
static void around_a_tip(void **state) {
  (void)state;
  for (uint32_t n = 5; n < 11; n++)
    for (double degrees = 25; degrees < 345. / n; degrees += 2) {
      tet_ctx *ctx;
      solid s;
      tet_build_result built;
      tet_refine_result r;
      solid_pyramid(&s, n, degrees);
      assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
      assert_int_equal(solid_build(ctx, &s, &built), TET_OK);
      double before = shortest_edge(&built.pieces);
      tet_build_result_free(ctx, &built);
      refine(ctx, &s, 0, &built, &r);
      assert_true(shortest_edge(&built.pieces) > before / 4);
      tet_refine_result_free(ctx, &r);
      tet_build_result_free(ctx, &built);
      tet_ctx_free(ctx);
    }
}

static void with_sharp_angles(void **state) {
  uint64_t random = *(uint64_t *)*state;
  for (int i = 0; i < 12; i++) {
    tet_ctx *ctx[2];
    tet_build_result built[2];
    tet_refine_result r[2];
    solid s;
    solid_wedge(&s, 60 * unit(&random) * unit(&random) + 0.1, 0.2 + unit(&random));
    for (int k = 0; k < 2; k++) {
      assert_int_equal(tet_ctx_create(NULL, &ctx[k]), TET_OK);
      refine(ctx[k], &s, 0, &built[k], &r[k]);
    }
    const tet_pieces *p = &built[0].pieces, *q = &built[1].pieces;
    assert_int_equal(p->n_points, q->n_points);
    assert_int_equal(p->n_tets, q->n_tets);
    assert_memory_equal(p->points, q->points, 3 * sizeof(double) * p->n_points);
    assert_memory_equal(p->tets, q->tets, 4 * sizeof(uint32_t) * p->n_tets);
    assert_int_equal(r[0].n_exceptions, r[1].n_exceptions);
    for (int k = 0; k < 2; k++) {
      tet_refine_result_free(ctx[k], &r[k]);
      tet_build_result_free(ctx[k], &built[k]);
      tet_ctx_free(ctx[k]);
    }
  }
}

int main(void) {
  const char *given = getenv("TETRAD_SEED");
  uint64_t seed = given ? strtoull(given, NULL, 10) : 20260101;
  print_message("seed %llu\n", (unsigned long long)seed);
  const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(without_sharp_angles, &seed),
                                     cmocka_unit_test_prestate(with_sharp_angles, &seed),
                                     cmocka_unit_test(around_a_tip)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
