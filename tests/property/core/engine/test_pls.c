// SPDX-License-Identifier: Apache-2.0
/* Laws of tet_mesh_pls on generated input: every mesh passes its audit, fills the
 * volume, has the regions, keeps input bits, and comes out the same twice. The seed of a
 * failure is printed. TETRAD_RUNS sets how many seeds are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/context.h"
#include "exact/predicates.h"
#include "maker.h"
#include <tet/engine.h>

static uint64_t runs(uint64_t usual) {
  const char *given = getenv("TETRAD_RUNS");
  return given ? strtoull(given, NULL, 10) : usual;
}

/* Meshes, and asserts what must hold of every mesh. */
static tet_mesh *mesh_of(tet_ctx *ctx, const made_pls *made, const tet_options *options, uint64_t seed) {
  tet_mesh *m = NULL;
  if (tet_mesh_pls(ctx, &made->pls, options, &m) != TET_OK)
    fail_msg("seed %llu, stage %d: %s", (unsigned long long)seed, (int)options->stage, tet_ctx_error(ctx)->message);
  if (!m->report.audit.passed) fail_msg("seed %llu, stage %d: the audit did not pass", (unsigned long long)seed, (int)options->stage);
  assert_memory_equal(m->points, made->points, made->pls.n_points * sizeof made->points[0]);
  for (uint32_t i = 0; i < m->n_input_points; i++) {
    uint32_t same = m->point_same_as[i];
    assert_true(same <= i && m->point_same_as[same] == same);
    for (int k = 0; k < 3; k++) assert_true(made->points[i][k] == made->points[same][k]); /* 0 may be -0 */
  }
  return m;
}

static void assert_same(const tet_mesh *a, const tet_mesh *b) {
  assert_int_equal(a->n_points, b->n_points);
  assert_int_equal(a->n_tetrahedra, b->n_tetrahedra);
  assert_int_equal(a->n_subfaces, b->n_subfaces);
  assert_int_equal(a->n_subsegments, b->n_subsegments);
  assert_memory_equal(a->points, b->points, 3 * a->n_points * sizeof *a->points);
  assert_memory_equal(a->tetrahedra, b->tetrahedra, 4 * a->n_tetrahedra * sizeof *a->tetrahedra);
  assert_memory_equal(a->tetrahedron_regions, b->tetrahedron_regions, a->n_tetrahedra * sizeof(uint32_t));
  assert_memory_equal(a->subfaces, b->subfaces, 3 * a->n_subfaces * sizeof *a->subfaces);
  assert_memory_equal(a->subsegments, b->subsegments, 2 * a->n_subsegments * sizeof *a->subsegments);
}

/* Interpolated values stay in the range of the given ones. */
static void check_attributes(const made_pls *made, const tet_mesh *m) {
  double low = INFINITY, high = -INFINITY;
  for (uint32_t v = 0; v < made->pls.n_points; v++) {
    low = fmin(low, made->attributes[v]);
    high = fmax(high, made->attributes[v]);
  }
  double slack = 1e-9 * (1 + high - low);
  for (uint32_t v = 0; v < m->n_points; v++)
    assert_true(m->point_attributes[v] >= low - slack && m->point_attributes[v] <= high + slack);
}

/* Every seed's region has its marker; the others are numbered on, all different. */
static void check_regions(const made_pls *made, const tet_mesh *m) {
  assert_int_equal(m->n_regions, made->n_regions);
  for (uint32_t i = 0; i < made->pls.n_regions; i++) {
    uint32_t found = 0;
    for (uint32_t r = 0; r < m->n_regions; r++) found += m->region_markers[r] == made->region_markers[i];
    assert_int_equal(found, 1);
  }
  for (uint32_t r = 0; r < m->n_regions; r++)
    for (uint32_t q = 0; q < r; q++) assert_int_not_equal(m->region_markers[r], m->region_markers[q]);
}

static void check_solid(const made_pls *made, uint64_t seed) {
  tet_ctx *ctx;
  tet_options options;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_options_default(&options);
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    options.stage = (tet_stage)stage;
    options.seed = seed;
    tet_mesh *a = mesh_of(ctx, made, &options, seed);
    if (fabs(a->report.quality.volume - made->volume) > 1e-9 * made->volume)
      fail_msg("seed %llu, stage %d: volume %.17g, not %.17g", (unsigned long long)seed, stage,
               a->report.quality.volume, made->volume);
    check_regions(made, a);
    check_attributes(made, a);
    if (a->n_slivers) /* no angle excuses one */
      fail_msg("seed %llu: %u of %llu slivers are left", (unsigned long long)seed, a->n_slivers,
               (unsigned long long)a->report.counts.first_slivers);
    options.seed = seed + 1; /* the result does not depend on it */
    tet_mesh *b = mesh_of(ctx, made, &options, seed);
    assert_same(a, b);
    tet_mesh_free(a);
    tet_mesh_free(b);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void boxes(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(25); seed++) {
    make_boxes(seed, &made);
    check_solid(&made, seed);
  }
}

static void stacks(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(25); seed++) {
    make_stack(seed, &made);
    check_solid(&made, seed);
  }
}

static void check_oblique(uint64_t seed) {
  static made_pls made;
  if (seed % 2) make_boxes(seed, &made);
  else make_stack(seed, &made);
  make_oblique(seed, &made);
  check_solid(&made, seed);
}

static void oblique_boxes(void **state) {
  (void)state;
  check_oblique(1152); /* flat tetrahedra in a row at a side bent by rounding */
  for (uint64_t seed = 1; seed <= runs(25); seed++) check_oblique(seed);
}

/* With break points: no facet is degenerate before rounding, and what holds of solids holds. */
static void solids_with_break_points(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(25); seed++) {
    tet_ctx *ctx;
    tet_options options;
    if (seed % 2) make_boxes(seed, &made);
    else make_stack(seed, &made);
    if (seed % 3 == 0) make_oblique(seed, &made);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_options_default(&options);
    for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
      options.stage = (tet_stage)stage;
      options.break_points = 0;
      tet_mesh *plain = mesh_of(ctx, &made, &options, seed);
      assert_true(plain->report.counts.break_points == 0 && plain->report.counts.degeneracies_left == 0);
      options.break_points = 1;
      options.threads = 1;
      tet_mesh *a = mesh_of(ctx, &made, &options, seed);
      options.threads = 2;
      tet_mesh *b = mesh_of(ctx, &made, &options, seed);
      assert_same(a, b);
      if (a->report.counts.degeneracies_left)
        fail_msg("seed %llu, stage %d: %llu of %llu", (unsigned long long)seed, stage,
                 (unsigned long long)a->report.counts.degeneracies_left, (unsigned long long)a->report.counts.break_points);
      if (seed % 3) assert_true(a->report.counts.break_points > 0); /* rectangles */
      assert_true(fabs(a->report.quality.volume - made.volume) <= 1e-9 * made.volume);
      check_regions(&made, a);
      check_attributes(&made, a);
      tet_mesh_free(plain);
      tet_mesh_free(a);
      tet_mesh_free(b);
    }
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

/* Whether all points lie in one plane: by trying every plane through the first two
 * that differ and the first off their line. */
static int coplanar(const made_pls *p) {
  const double(*x)[3] = p->points;
  uint32_t n = p->pls.n_points, a = 0, b = 0, c = 0;
  while (b < n && x[a][0] == x[b][0] && x[a][1] == x[b][1] && x[a][2] == x[b][2]) b++;
  if (b == n) return 1;
  while (c < n && tet_collinear_xyz(x[a], x[b], x[c])) c++;
  if (c == n) return 1;
  for (uint32_t d = 0; d < n; d++)
    if (tet_orient3d_xyz(x[a], x[b], x[c], x[d]) != 0) return 0;
  return 1;
}

static void point_sets(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(40); seed++)
    for (int kind = 0; kind < MAKER_POINT_KINDS; kind++) {
      tet_ctx *ctx;
      tet_options options;
      make_points(seed, kind, &made);
      assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
      tet_options_default(&options);
      options.stage = TET_STAGE_DELAUNAY;
      options.neighbours = 1;
      if (coplanar(&made)) {
        tet_mesh *none = NULL;
        assert_int_equal(tet_mesh_pls(ctx, &made.pls, &options, &none), TET_E_DEGENERATE);
        assert_null(none);
      } else {
        tet_mesh *m = mesh_of(ctx, &made, &options, seed);
        assert_true(m->report.promised.delaunay);
        uint8_t *used = calloc(m->n_points, 1); /* every point, or its double, is a vertex */
        for (uint32_t i = 0; i < 4 * m->n_tetrahedra; i++) used[m->tetrahedra[i]] = 1;
        for (uint32_t v = 0; v < m->n_points; v++) assert_true(used[m->point_same_as[v]]);
        free(used);
        tet_mesh_free(m);
      }
      assert_int_equal(tet_ctx_bytes(ctx), 0);
      tet_ctx_free(ctx);
    }
}

/* The bound is met, so by as many tetrahedra as it takes at least. Not: by no fewer than a larger bound. */
static void volume_bounds(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(8); seed++) {
    tet_ctx *ctx;
    tet_options options;
    make_stack(seed, &made);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_options_default(&options);
    options.min_dihedral = 0; /* slivers in a thin layer can ask for more than a finer bound does */
    for (double part = 20; part <= 500; part *= 5) {
      options.max_volume = made.volume / part;
      tet_mesh *m = mesh_of(ctx, &made, &options, seed);
      assert_int_equal(m->n_exceptions, 0); /* right angles only: nothing excuses one */
      if (m->n_tetrahedra < part) fail_msg("seed %llu: %u tetrahedra", (unsigned long long)seed, m->n_tetrahedra);
      tet_mesh_free(m);
    }
    tet_ctx_free(ctx);
  }
}

/* With the hull kept, what was outside or a hole is there too: the mesh is convex. */
static void kept_hulls(void **state) {
  (void)state;
  static made_pls made;
  for (uint64_t seed = 1; seed <= runs(10); seed++) {
    tet_ctx *ctx;
    tet_options options;
    make_boxes(seed, &made);
    double side = made.points[7][0];
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_options_default(&options);
    options.stage = TET_STAGE_CDT;
    options.keep_hull = 1;
    tet_mesh *m = mesh_of(ctx, &made, &options, seed);
    assert_true(fabs(m->report.quality.volume - side * side * side) < 1e-9 * side * side * side);
    tet_mesh_free(m);
    tet_ctx_free(ctx);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(point_sets),    cmocka_unit_test(boxes),
                                     cmocka_unit_test(stacks),        cmocka_unit_test(oblique_boxes),
                                     cmocka_unit_test(solids_with_break_points),
                                     cmocka_unit_test(volume_bounds), cmocka_unit_test(kept_hulls)};
  return cmocka_run_group_tests_name("pls", tests, NULL, NULL);
}
