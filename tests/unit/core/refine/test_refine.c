// SPDX-License-Identifier: Apache-2.0
/* Refinement of small solids: bounds, promises, exceptions, limits. */
#include "refine/refine.h"
#include "solids.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double unturned[2] = {0, 0};

/* Builds and refines; the result's arrays and the pieces are the caller's. */
static tet_status mesh(tet_ctx *ctx, const solid *s, const tet_refine_options *o, tet_build_result *built,
                       tet_refine_result *ret) {
  assert_int_equal(solid_build(ctx, s, built), TET_OK);
  tet_stage_begin(ctx, "refine");
  return tet_refine(ctx, &built->pieces, o, ret);
}

static void box_by_volume(void **state) {
  (void)state;
  tet_ctx *ctx;
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  tet_refine_options_default(&o);
  o.max_volume = 0.01;
  solid_regular(&s, 4, 1, unturned);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(mesh(ctx, &s, &o, &built, &r), TET_OK);
  assert_null(pieces_fault(&built.pieces));
  assert_int_equal(r.n_sharp_segments, 0);
  assert_int_equal(r.n_exceptions, 0);
  assert_int_equal(r.rejected.protected_ball, 0);
  assert_true(r.gabriel && r.constrained_delaunay);
  assert_true(built.pieces.n_tets > 200);
  assert_float_equal(pieces_volume(&built.pieces), 2.0, 1e-12);
  assert_int_equal(r.segment_points + r.facet_points + r.volume_points, built.pieces.n_points - 8);
  tet_refine_result_free(ctx, &r);
  tet_build_result_free(ctx, &built);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void input_keeps_its_bits(void **state) {
  (void)state;
  static const double turn[2] = {0.3, 1.1};
  tet_ctx *ctx;
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  tet_refine_options_default(&o);
  o.max_volume = 0.05;
  solid_regular(&s, 6, 2, turn);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(mesh(ctx, &s, &o, &built, &r), TET_OK);
  assert_memory_equal(built.pieces.points, s.points, 12 * 3 * sizeof(double));
  for (uint32_t v = built.pieces.n_input; v < built.pieces.n_points; v++) {
    uint32_t carrier = built.pieces.carrier[v];
    switch (built.pieces.origin[v]) {
      case TET_ORIGIN_SEGMENT: assert_true(carrier < built.pieces.n_segments); break;
      case TET_ORIGIN_FACET: assert_true(carrier < built.pieces.n_facets); break;
      default: assert_int_equal(built.pieces.origin[v], TET_ORIGIN_VOLUME);
    }
  }
  tet_refine_result_free(ctx, &r);
  tet_build_result_free(ctx, &built);
  tet_ctx_free(ctx);
}

static void wedges_end(void **state) {
  (void)state;
  static const double degrees[] = {40, 10, 1, 0.01};
  for (size_t i = 0; i < sizeof degrees / sizeof *degrees; i++) {
    tet_ctx *ctx;
    solid s;
    tet_build_result built;
    tet_refine_result r;
    tet_refine_options o;
    tet_refine_options_default(&o);
    solid_wedge(&s, degrees[i], 1);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    assert_int_equal(mesh(ctx, &s, &o, &built, &r), TET_OK);
    assert_null(pieces_fault(&built.pieces));
    assert_true(r.n_sharp_segments > 0);
    assert_true(built.pieces.n_points < 5000);
    for (uint32_t k = 0; k < r.n_exceptions; k++) {
      assert_true(r.exception_tet[k] < built.pieces.n_tets);
      assert_true(k == 0 || r.exception_tet[k] > r.exception_tet[k - 1]);
      assert_true(r.exception_value[k] > 2.0);
      assert_true(r.exception_segment[k] < built.pieces.n_subsegs);
    }
    tet_refine_result_free(ctx, &r);
    tet_build_result_free(ctx, &built);
    tet_ctx_free(ctx);
  }
}

static void limits_leave_nothing(void **state) {
  (void)state;
  static const struct {
    tet_limits limits;
    int cancel;
    tet_status status;
  } cases[] = {{{.max_vertices = 200}, 0, TET_E_VERTEX_LIMIT},
               {{.memory_bytes = 200000}, 0, TET_E_MEMORY},
               {{.max_vertices = 0}, 1, TET_E_CANCELLED}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    tet_ctx *ctx;
    solid s;
    tet_build_result built;
    tet_refine_result r = {.n_exceptions = 77};
    tet_refine_options o;
    tet_refine_options_default(&o);
    o.max_volume = 1e-4;
    solid_regular(&s, 5, 1, unturned);
    assert_int_equal(tet_ctx_create(&cases[i].limits, &ctx), TET_OK);
    assert_int_equal(solid_build(ctx, &s, &built), TET_OK);
    if (cases[i].cancel) tet_cancel(ctx);
    tet_stage_begin(ctx, "refine");
    assert_int_equal(tet_refine(ctx, &built.pieces, &o, &r), cases[i].status);
    assert_int_equal(r.n_exceptions, 77);
    tet_build_result_free(ctx, &built);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

static void nonsense_is_refused(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_pieces none;
  tet_refine_result r;
  tet_refine_options o;
  memset(&none, 0, sizeof none);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_refine_options_default(&o);
  o.radius_edge = 0.5;
  assert_int_equal(tet_refine(ctx, &none, &o, &r), TET_E_ARGUMENT);
  tet_refine_options_default(&o);
  o.max_volume = -1;
  assert_int_equal(tet_refine(ctx, &none, &o, &r), TET_E_ARGUMENT);
  tet_refine_options_default(&o);
  o.order = TET_INSERT_RELATIVELY_SHORT + 1;
  assert_int_equal(tet_refine(ctx, &none, &o, &r), TET_E_ARGUMENT);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(box_by_volume), cmocka_unit_test(input_keeps_its_bits), cmocka_unit_test(wedges_end),
      cmocka_unit_test(limits_leave_nothing), cmocka_unit_test(nonsense_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
