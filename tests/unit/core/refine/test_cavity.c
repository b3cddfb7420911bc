// SPDX-License-Identifier: Apache-2.0
/* Cavities of single points, through the refiner's own functions. */
#include "exact/predicates.h"
#include "refine/refiner.h"
#include "solids.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static uint32_t count_border_vertices(const refiner *r) {
  const tet_complex *m = &r->mesh;
  uint32_t n = 0;
  for (uint32_t v = 0; v < r->points.n; v++) {
    int found = 0;
    for (size_t k = 0; k < 4 * m->n_border; k++) found |= m->border[k / 4].v[k % 4] == v;
    n += found && v != r->cavity.p;
  }
  return n;
}

/* Trims the cavity of the centre of each subface of a bipyramid, and calls `check`. */
static void each_facet_cavity(void (*check)(const refiner *r)) {
  static const double unturned[2] = {0, 0};
  tet_ctx *ctx;
  solid s;
  tet_build_result built;
  solid_regular(&s, 4, 1, unturned);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(solid_build(ctx, &s, &built), TET_OK);
  tet_stage_begin(ctx, "refine");
  refiner r = {.ctx = ctx, .out = &built.pieces};
  tet_refine_options_default(&r.o);
  assert_int_equal(refine_load(&r), TET_OK);
  uint32_t subfaces = r.n_subs;
  for (uint32_t sub = 0; sub < subfaces; sub++) {
    double x[3] = {0, 0, 0};
    int ok;
    for (int j = 0; j < 9; j++) x[j % 3] += refine_x(&r, r.sub_v[3 * (size_t)sub + (size_t)(j / 3)])[j % 3] / 3;
    assert_int_equal(refine_add_point(&r, x, TET_ORIGIN_FACET, r.patch[r.sub_patch[sub]].facet), TET_OK);
    assert_int_equal(refine_cavity_of_sub(&r, r.points.n - 1, sub, 0), TET_OK);
    assert_int_equal(refine_push(&r, &r.cavity.vertices, r.sub_v[3 * (size_t)sub]), TET_OK);
    r.cavity.loses_vertex = 1; /* of some cavity before */
    assert_int_equal(refine_cavity_trim(&r, &ok), TET_OK);
    assert_true(ok);
    check(&r);
    refine_cavity_clear(&r);
    refine_drop_point(&r);
  }
  assert_int_equal(refine_unload(&r), TET_OK);
  refine_release(&r);
  tet_build_result_free(ctx, &built);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void check_vertices(const refiner *r) { assert_int_equal(r->cavity.vertices.n, count_border_vertices(r)); }

/* What the rules looked at before, as the facet's vertices alone, does not stay in the list. */
static void a_facet_points_cavity_lists_all_its_vertices(void **state) {
  (void)state;
  each_facet_cavity(check_vertices);
}

static void check_lanes(const refiner *r) {
  for (size_t k = 0; k < r->mesh.n_border; k++) {
    const uint32_t *v = r->mesh.border[k].v;
    const refine_shapes *of = &r->cavity.shapes[k / 4];
    size_t lane = k % 4;
    refine_shape s;
    refine_measure_corners(r, v, &s);
    for (int i = 0; i < 3; i++) assert_memory_equal(&of->to_centre[i][lane], &s.to_centre[i], sizeof s.volume6);
    assert_memory_equal(&of->volume6[lane], &s.volume6, sizeof s.volume6);
    assert_memory_equal(&of->shortest2[lane], &s.shortest2, sizeof s.shortest2);
    assert_int_equal(of->is_over >> lane & 1, refine_over_ratio(r, &s));
    if (of->is_positive >> lane & 1) assert_true(tet_orient3d(&r->points, v[0], v[1], v[2], v[3]) > 0);
  }
}

static void four_at_a_time_are_measured_as_one(void **state) {
  (void)state;
  each_facet_cavity(check_lanes);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_facet_points_cavity_lists_all_its_vertices),
                                     cmocka_unit_test(four_at_a_time_are_measured_as_one)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
