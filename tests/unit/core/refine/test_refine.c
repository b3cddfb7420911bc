// SPDX-License-Identifier: Apache-2.0
/* Refinement of small solids: bounds, promises, exceptions, limits. */
#include "refine/refine.h"
#include "solids.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double unturned[2] = {0, 0};

/* Builds and refines, and finds no fault; the result's arrays and the pieces are the caller's, to drop. */
static tet_ctx *mesh(const solid *s, const tet_refine_options *o, tet_build_result *built, tet_refine_result *ret) {
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(solid_build(ctx, s, built), TET_OK);
  tet_stage_begin(ctx, "refine");
  assert_int_equal(tet_refine(ctx, &built->pieces, o, ret), TET_OK);
  assert_null(pieces_fault(&built->pieces));
  return ctx;
}

static void drop(tet_ctx *ctx, tet_build_result *built, tet_refine_result *r) {
  tet_refine_result_free(ctx, r);
  tet_build_result_free(ctx, built);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void box_by_volume(void **state) {
  (void)state;
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  tet_refine_options_default(&o);
  o.max_volume = 0.01;
  solid_regular(&s, 4, 1, unturned);
  tet_ctx *ctx = mesh(&s, &o, &built, &r);
  assert_int_equal(r.n_sharp_segments, 0);
  assert_int_equal(r.n_exceptions, 0);
  assert_int_equal(r.rejected.protected_ball, 0);
  assert_true(r.gabriel && r.constrained_delaunay);
  assert_true(built.pieces.n_tets > 200);
  assert_float_equal(pieces_volume(&built.pieces), 2.0, 1e-12);
  assert_int_equal(r.segment_points + r.facet_points + r.volume_points, built.pieces.n_points - 8);
  drop(ctx, &built, &r);
}

static void input_keeps_its_bits(void **state) {
  (void)state;
  static const double turn[2] = {0.3, 1.1};
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  tet_refine_options_default(&o);
  o.max_volume = 0.05;
  solid_regular(&s, 6, 2, turn);
  tet_ctx *ctx = mesh(&s, &o, &built, &r);
  assert_memory_equal(built.pieces.points, s.points, 12 * 3 * sizeof(double));
  for (uint32_t v = built.pieces.n_input; v < built.pieces.n_points; v++) {
    uint32_t carrier = built.pieces.carrier[v];
    switch (built.pieces.origin[v]) {
      case TET_ORIGIN_SEGMENT: assert_true(carrier < built.pieces.n_segments); break;
      case TET_ORIGIN_FACET: assert_true(carrier < built.pieces.n_facets); break;
      default: assert_int_equal(built.pieces.origin[v], TET_ORIGIN_VOLUME);
    }
  }
  drop(ctx, &built, &r);
}

static void wedges_end(void **state) {
  (void)state;
  static const double degrees[] = {40, 10, 1, 0.01};
  for (size_t i = 0; i < sizeof degrees / sizeof *degrees; i++) {
    solid s;
    tet_build_result built;
    tet_refine_result r;
    tet_refine_options o;
    tet_refine_options_default(&o);
    solid_wedge(&s, degrees[i], 1);
    tet_ctx *ctx = mesh(&s, &o, &built, &r);
    assert_true(r.n_sharp_segments > 0);
    assert_true(built.pieces.n_points < 5000);
    for (uint32_t k = 0; k < r.n_exceptions; k++) {
      assert_true(r.exception_tet[k] < built.pieces.n_tets);
      assert_true(k == 0 || r.exception_tet[k] > r.exception_tet[k - 1]);
      assert_true(r.exception_value[k] > 2.0);
      assert_true(r.exception_segment[k] < built.pieces.n_subsegs);
    }
    assert_int_equal(r.trace.traced, r.n_exceptions); /* all are at the sharp segment */
    assert_true(r.trace.within <= r.trace.traced);
    assert_true(r.trace.farthest < 1);
    drop(ctx, &built, &r);
  }
}

/* A segment leaves a facet at 8.5 degrees, from a vertex amid it. Tetrahedra over the bound are forced there at
 * any size: circumcentres had the segment cut, and its points the facet, down to the floor, and what existing
 * vertices forced was rejected there as well. */
static void low_segments_end(void **state) {
  (void)state;
  static const uint32_t segment[2] = {8, 9}, facet_start[7] = {0, 1, 2, 3, 4, 5, 7};
  static const double bounds[] = {1.4143, 2};
  for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
    solid s;
    tet_build_result built;
    tet_refine_result r;
    tet_refine_options o;
    tet_refine_options_default(&o);
    o.radius_edge = bounds[i];
    solid_regular(&s, 4, 1, unturned);
    const double ends[2][3] = {{0.05, 0.1, 1}, {0.55, 0.1, 1 - 0.075}};
    memcpy(s.points[8], ends, sizeof ends);
    s.polygon_vertices[s.polygon_start[6]] = 8;
    s.polygon_start[7] = s.polygon_start[6] + 1;
    s.pls.n_points = 10;
    s.pls.n_polygons = 7;
    s.pls.facet_start = facet_start;
    s.pls.n_segments = 1;
    s.pls.segments = segment;
    tet_ctx *ctx = mesh(&s, &o, &built, &r);
    assert_int_equal(r.n_sharp_segments, 1);
    assert_true(r.gabriel && r.constrained_delaunay);
    assert_true(built.pieces.n_points < 400);
    assert_true(r.n_exceptions > 0 && r.n_exceptions < 40);
    assert_int_equal(r.trace.traced, r.n_exceptions);
    drop(ctx, &built, &r);
  }
}

/* The hull of points on the moment curve: needles all along nearly parallel segments. A circumcentre's cavity has most
 * of the mesh there, and what it encroaches upon is protected: each was searched for to the end, in vain, so that 25 points
 * took most of a minute, and 100 no end that was waited for. */
static void wide_cavities_are_not_searched_in_vain_for_long(void **state) {
  (void)state;
  enum { N = 16, FACETS = 2 * N - 4 };
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  double points[N][3];
  uint32_t start[FACETS + 1], corners[3 * FACETS], n = 0;
  for (uint32_t i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) points[i][k] = pow(i + 1, k + 1);
  for (uint32_t i = 1; i < 2 * N - 3; i++) { /* Gale's evenness */
    const uint32_t at = i < N - 1 ? i : i - (N - 1), end = i < N - 1 ? 0 : N - 1;
    const uint32_t facet[3] = {end ? at : 0, end ? at + 1 : at, end ? end : at + 1};
    memcpy(corners + 3 * n++, facet, sizeof facet);
  }
  assert_int_equal(n, FACETS);
  for (uint32_t i = 0; i <= FACETS; i++) start[i] = 3 * i;
  solid_regular(&s, 4, 1, unturned);
  s.pls.n_points = N;
  s.pls.points = points[0];
  s.pls.n_facets = s.pls.n_polygons = FACETS;
  s.pls.polygon_start = start;
  s.pls.polygon_vertices = corners;
  tet_refine_options_default(&o);
  tet_ctx *ctx = mesh(&s, &o, &built, &r);
  assert_true(r.constrained_delaunay);
  assert_true(r.rejected.given_up > 0);
  assert_true(built.pieces.n_points < 10000);
  assert_int_equal(r.trace.traced, r.n_exceptions);
  drop(ctx, &built, &r);
}

/* Its ends, bent by rounding, have creases, and a Steiner point of one of these beside another: subfaces
 * whose circumcentres are far beyond a subsegment, which was halved for them down to a thousandth of the
 * local feature size. */
static void segments_are_not_cut_for_centres_far_beyond(void **state) {
  (void)state;
  static const double points[17][3] = {
      {0.78088056415985452, 0.41215023592726036, 0.46942275993233551},
      {0.97526583536210365, -0.14583410639780436, -0.16609925883823876},
      {0.43525604073916591, -0.59400239213168537, -0.67654514789620734},
      {-0.43251043016554463, -0.59487476114979221, -0.67753874158234917},
      {-0.97458772555066808, -0.14779430178840536, -0.16833184358538167},
      {-0.78278058562953512, 0.41057828127398671, 0.46763236597521923},
      {-0.0015236989153762925, 0.65977704426644002, 0.75145986599462211},
      {0.78088056415985452, 1.070560289151371, -0.10865713293931123},
      {0.97526583536210365, 0.51257594682630625, -0.74417915170988547},
      {0.43525604073916591, 0.064407661092425239, -1.2546250407678541},
      {-0.43251043016554463, 0.063535292074318406, -1.2556186344539959},
      {-0.97458772555066808, 0.51061575143570526, -0.74641173645702841},
      {-0.78278058562953512, 1.0689883344980973, -0.11044752689642751},
      {-0.0015236989153762925, 1.3181870974905507, 0.17337997312297537},
      {-0.1046443620244029, 0.21525017150406517, -0.24490616220041853},
      {-0.21446358018331618, 0.22006813527358834, -0.07535945041296481},
      {0.21736225330420242, 0.23655393954453141, -0.7032872971278834}};
  tet_ctx *ctx;
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  double shortest2 = 1;
  solid_regular(&s, 7, 1, unturned);
  s.pls.n_points = 17;
  s.pls.points = points[0];
  s.pls.n_loose_points = TET_LOOSE_ALL_UNUSED;
  tet_refine_options_default(&o);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(solid_build(ctx, &s, &built), TET_OK);
  tet_stage_begin(ctx, "refine");
  assert_int_equal(tet_refine(ctx, &built.pieces, &o, &r), TET_OK);
  assert_null(pieces_fault(&built.pieces));
  assert_int_equal(r.n_exceptions, 0);
  assert_true(r.gabriel && r.constrained_delaunay);
  for (size_t k = 0; k < 16 * (size_t)built.pieces.n_tets; k++) {
    const uint32_t *v = built.pieces.tets + (k / 16) * 4;
    const double *x = built.pieces.points + 3 * (size_t)v[k / 4 % 4], *y = built.pieces.points + 3 * (size_t)v[k % 4];
    double d2 = 0;
    for (int i = 0; i < 3; i++) d2 += (x[i] - y[i]) * (x[i] - y[i]);
    if (d2 > 0 && d2 < shortest2) shortest2 = d2;
  }
  assert_true(shortest2 > 0.01 * 0.01);
  drop(ctx, &built, &r);
}

/* Its ends are bent by rounding: tetrahedra of nothing span their creases, which are no bounds to
 * refinement. They go with the first subface beside them. */
static void creases_leave_nothing_flat(void **state) {
  (void)state;
  static const double points[18][3] = {
      {0.5492481791648522, -0.8120119862361025, -0.19739040476424913},
      {0.9466987469516879, -0.2552865023264677, -0.19644409955512104},
      {0.901178449655228, 0.42089037321516104, -0.10357941693117445},
      {0.4339867402822384, 0.9001279654539616, 0.03775122603186107},
      {-0.23627218809417233, 0.9581856788488363, 0.16141765077644582},
      {-0.7959767337884438, 0.567897664062712, 0.20955496276537117},
      {-0.9832349194470905, -0.08811597921785863, 0.1596391787323881},
      {-0.7104265588575157, -0.7028991765223683, 0.03502644877867526},
      {-0.10520171586678445, -0.988788037277873, -0.10597554583419669},
      {0.7190147642616944, -0.9348716737474776, 0.780405485884287},
      {1.11646533204853, -0.3781461898378428, 0.7813517910934151},
      {1.0709450347520701, 0.29803068570378594, 0.8742164737173617},
      {0.6037533253790806, 0.7772682779425865, 1.015547116680397},
      {-0.06650560299733022, 0.8353259913374612, 1.139213541424982},
      {-0.6262101486916016, 0.4450379765513369, 1.1873508534139072},
      {-0.8134683343502485, -0.21097566672923374, 1.137435069380924},
      {-0.5406599737606737, -0.8257588640337434, 1.0128223394272113},
      {0.06456486923005766, -1.111647724789248, 0.8718203448143395}};
  solid s;
  tet_build_result built;
  tet_refine_result r;
  tet_refine_options o;
  solid_regular(&s, 9, 1, unturned);
  s.pls.points = points[0];
  tet_refine_options_default(&o);
  tet_ctx *ctx = mesh(&s, &o, &built, &r);
  assert_int_equal(r.n_exceptions, 0);
  assert_int_equal(r.rejected.lost_subface, 0);
  assert_true(r.gabriel && r.constrained_delaunay);
  drop(ctx, &built, &r);
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
      cmocka_unit_test(low_segments_end),
      cmocka_unit_test(wide_cavities_are_not_searched_in_vain_for_long),
      cmocka_unit_test(segments_are_not_cut_for_centres_far_beyond),
      cmocka_unit_test(creases_leave_nothing_flat),
      cmocka_unit_test(limits_leave_nothing), cmocka_unit_test(nonsense_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
