// SPDX-License-Identifier: Apache-2.0
/* What makes no sense by itself is refused before any stage runs, by its name. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "engine/check.h"

static tet_ctx *ctx;

static int set_up(void **state) {
  (void)state;
  return tet_ctx_create(NULL, &ctx) != TET_OK;
}

static int tear_down(void **state) {
  (void)state;
  tet_ctx_free(ctx);
  return 0;
}

static double points[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 2, 2};
static uint32_t polygon_start[3] = {0, 3, 7}, polygon_vertices[7] = {0, 1, 2, 0, 1, 3, 4};
static uint32_t facet_start[2] = {0, 2}, hole_start[2] = {0, 1}, segments[2] = {0, 4}, loose[1] = {4};
static double facet_hole[3] = {0.1, 0.1, 0}, hole[3] = {9, 9, 9}, seed[3] = {0.1, 0.1, 0.1}, volume[1] = {0};

static tet_pls good(void) {
  return (tet_pls){.n_points = 5, .points = points, .n_facets = 1, .facet_start = facet_start, .n_polygons = 2,
                   .polygon_start = polygon_start, .polygon_vertices = polygon_vertices, .n_facet_holes = 1,
                   .facet_hole_start = hole_start, .facet_holes = facet_hole, .n_segments = 1, .segments = segments,
                   .n_loose_points = 1, .loose_points = loose, .n_holes = 1, .holes = hole, .n_regions = 1,
                   .region_seeds = seed, .region_max_volumes = volume};
}

/* Asserts that `pls` is refused with a message that has `word`. */
static void refused(const tet_pls *pls, tet_status status, const char *word) {
  assert_int_equal(tet_check_arrays(ctx, pls), status);
  const tet_error *e = tet_ctx_error(ctx);
  assert_int_equal(e->status, status);
  if (!strstr(e->message, word)) fail_msg("\"%s\" is not in \"%s\"", word, e->message);
}

static void arrays(void **state) {
  (void)state;
  tet_pls p = good();
  assert_int_equal(tet_check_arrays(ctx, &p), TET_OK);
  p.n_points = 3;
  refused(&p, TET_E_DEGENERATE, "3 vertices");
  p = good();
  p.points = NULL;
  refused(&p, TET_E_ARGUMENT, "vertices");
  p = good();
  p.n_attributes = 2;
  refused(&p, TET_E_ARGUMENT, "attributes");
  p = good();
  p.facet_start = NULL;
  refused(&p, TET_E_ARGUMENT, "polygons");
  p = good();
  p.polygon_vertices = NULL;
  refused(&p, TET_E_ARGUMENT, "polygon vertices");
  p = good();
  p.holes = NULL;
  refused(&p, TET_E_ARGUMENT, "holes");
  p = good();
  p.n_points = 4;
  refused(&p, TET_E_INDEX, "polygon_vertices[6] is 4");
  p = good();
  p.n_polygons = 1;
  refused(&p, TET_E_INDEX, "facet_start[1]");
  uint32_t down[3] = {0, 5, 3}, late[3] = {1, 3, 7};
  p = good();
  p.polygon_start = down;
  refused(&p, TET_E_INDEX, "polygon_start");
  p.polygon_start = late;
  refused(&p, TET_E_INDEX, "polygon_start[0]");
  uint32_t beyond[2] = {0, 5};
  p = good();
  p.segments = beyond;
  refused(&p, TET_E_INDEX, "segments[1] is 5");
  p = good();
  p.loose_points = beyond + 1;
  refused(&p, TET_E_INDEX, "loose_points");
  p.n_loose_points = TET_LOOSE_ALL_UNUSED;
  assert_int_equal(tet_check_arrays(ctx, &p), TET_OK);
}

static void coordinates(void **state) {
  (void)state;
  static const double wrong[] = {NAN, INFINITY, -INFINITY, 1e200};
  for (size_t k = 0; k < 4; k++) {
    double bad[15];
    memcpy(bad, points, sizeof bad);
    bad[7] = bad[12] = wrong[k];
    tet_pls p = good();
    p.points = bad;
    refused(&p, TET_E_NOT_FINITE, "vertex 2");
    assert_int_equal(tet_ctx_error(ctx)->n_offences, 2);
    assert_int_equal(tet_ctx_error(ctx)->offences[1].index[0], 4);
    p = good();
    p.region_seeds = bad + 12;
    refused(&p, TET_E_NOT_FINITE, "region seed 0");
  }
}

static void options(void **state) {
  (void)state;
  tet_options o;
  tet_options_default(&o);
  assert_int_equal(tet_check_options(ctx, &o), TET_OK);
  static const double wrong[] = {0.99, -2, NAN, INFINITY};
  for (size_t k = 0; k < 4; k++) {
    tet_options_default(&o);
    o.radius_edge = wrong[k];
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
    assert_non_null(strstr(tet_ctx_error(ctx)->message, "radius-edge"));
    tet_options_default(&o);
    o.max_volume = k == 0 ? -1e-9 : wrong[k];
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
    o.max_volume = 0;
    o.min_dihedral = k == 0 ? 30.1 : wrong[k];
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
    assert_non_null(strstr(tet_ctx_error(ctx)->message, "dihedral"));
    o.min_dihedral = 0;
    o.merge_angle = k == 0 ? 45.1 : wrong[k];
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
    assert_non_null(strstr(tet_ctx_error(ctx)->message, "merge angle"));
    o.merge_angle = 0;
    o.order = k == 0 ? -2 : k == 1 ? 7 : k == 2 ? -1 : 99;
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
    assert_non_null(strstr(tet_ctx_error(ctx)->message, "insertion order"));
    o.order = (tet_insertion)(TET_INSERT_O2_O1 + 2 * (int)k);
    assert_int_equal(tet_check_options(ctx, &o), TET_OK);
    o.planarity_tolerance = k == 0 ? -1e-9 : wrong[k];
    assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  }
  tet_options_default(&o);
  o.break_points = 1; /* there are no facets to break */
  assert_int_equal(tet_check_options(ctx, &o), TET_OK);
  o.stage = TET_STAGE_DELAUNAY;
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  assert_non_null(strstr(tet_ctx_error(ctx)->message, "break points"));
  tet_options_default(&o);
  o.keep_hull = 1; /* there are no facets on the hull that refinement could split */
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  o.stage = TET_STAGE_CDT;
  assert_int_equal(tet_check_options(ctx, &o), TET_OK);
  o.voronoi = TET_VORONOI_FACTORS; /* nor facets that cells could be cut to */
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  o.keep_hull = 0;
  assert_int_equal(tet_check_options(ctx, &o), TET_OK);
  o.stage = TET_STAGE_DELAUNAY;
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  tet_options_default(&o);
  o.voronoi = (tet_voronoi)3;
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  tet_options_default(&o);
  o.stage = (tet_stage)3;
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
  tet_options_default(&o);
  o.point_order = (tet_point_order)2;
  assert_int_equal(tet_check_options(ctx, &o), TET_E_ARGUMENT);
}

static void vertex_limit(void **state) {
  (void)state;
  tet_ctx *small;
  tet_limits limits = {.max_vertices = 4};
  assert_int_equal(tet_ctx_create(&limits, &small), TET_OK);
  tet_pls p = good();
  assert_int_equal(tet_check_arrays(small, &p), TET_E_VERTEX_LIMIT);
  tet_ctx_free(small);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {TEST(arrays), TEST(coordinates), TEST(options), TEST(vertex_limit)};
  return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
