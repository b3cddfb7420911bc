// SPDX-License-Identifier: Apache-2.0
/* Point clouds are refined in their convex hull. */
#include <tet/engine.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { INSIDE = 60, N = 8 + INSIDE + 2 };

/* A cube's corners, points in it, one of them twice, and a point far away. */
static double points[N][3];

static void place(void) {
  uint64_t random = 5;
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++) points[i][k] = i >> k & 1;
  for (int i = 8; i < 8 + INSIDE; i++)
    for (int k = 0; k < 3; k++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      points[i][k] = i % 4 ? 0.5 + ldexp((double)(random >> 11), -54) / (1 + i % 5) : (i % 3 == k ? 1 : 0.25 + 0.01 * i / 2);
    }
  memcpy(points[N - 2], points[20], sizeof points[0]);
  points[N - 1][0] = points[N - 1][1] = points[N - 1][2] = 50;
}

static tet_status mesh(tet_ctx *ctx, const tet_pls *pls, tet_mesh **ret) {
  tet_options o;
  tet_options_default(&o);
  return tet_mesh_pls(ctx, pls, &o, ret);
}

static void check_unit_cube(const tet_mesh *m) {
  assert_true(m->report.audit.passed && m->report.promised.delaunay && m->report.promised.gabriel);
  assert_true(m->report.promised.covered);
  assert_int_equal(m->n_exceptions, 0);
  assert_true(m->report.quality.radius_edge.max <= 2.0000001);
  assert_true(fabs(m->report.quality.volume - 1) < 1e-12);
  assert_true(m->n_points > N);
  for (uint32_t s = 0; s < m->n_subsegments; s++) { /* on the cube's edges alone: coplanar triangles are one facet */
    int sides = 0;
    for (int k = 0; k < 3; k++) {
      double x = m->points[3 * (size_t)m->subsegments[2 * s] + (size_t)k];
      sides += (x == 0 || x == 1) && x == m->points[3 * (size_t)m->subsegments[2 * s + 1] + (size_t)k];
    }
    assert_int_equal(sides, 2);
  }
}

static void the_hull_is_refined(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_mesh *m = NULL;
  place();
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  const tet_pls cloud = {.n_points = N - 1, .points = points[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
  assert_int_equal(mesh(ctx, &cloud, &m), TET_OK);
  check_unit_cube(m);
  assert_int_equal(m->point_same_as[N - 2], 20);
  tet_mesh_free(m);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void points_that_are_not_listed_stay_out(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_mesh *m = NULL;
  uint32_t listed[N - 1];
  place();
  for (uint32_t i = 0; i < N - 1; i++) listed[i] = i;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  const tet_pls cloud = {.n_points = N, .points = points[0], .n_loose_points = N - 1, .loose_points = listed};
  assert_int_equal(mesh(ctx, &cloud, &m), TET_OK);
  check_unit_cube(m);
  tet_mesh_free(m);
  m = NULL;
  const uint32_t segment[2] = {0, N - 1}; /* its end is in use */
  const tet_pls spike = {.n_points = N, .points = points[0], .n_loose_points = N - 1, .loose_points = listed,
                         .n_segments = 1, .segments = segment};
  assert_int_equal(mesh(ctx, &spike, &m), TET_OK);
  assert_true(m->report.audit.passed && m->report.quality.volume > 10);
  tet_mesh_free(m);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

enum { SIDE = 4, LATTICE = SIDE * SIDE * SIDE };

/* A lattice turned by angles of 1, 2 and 3 radians, and each coordinate then moved by up to `noise`. */
static void place_lattice(double x[LATTICE][3], double noise) {
  uint64_t random = 9;
  for (int i = 0; i < LATTICE; i++) {
    double *p = x[i];
    for (int k = 0, rest = i; k < 3; k++, rest /= SIDE) p[k] = rest % SIDE;
    for (int k = 0; k < 3; k++) {
      double *u = &p[k], *v = &p[(k + 1) % 3], c = cos(k + 1.0), s = sin(k + 1.0), old = *u;
      *u = c * old - s * *v;
      *v = s * old + c * *v;
    }
    for (int k = 0; k < 3; k++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      p[k] += noise * (ldexp((double)(random >> 11), -52) - 1);
    }
  }
}

/* Its hull's facets are six squares, whatever rounding has left below or above their planes. */
static void turned_lattices_are_refined(void **state) {
  (void)state;
  for (int digits = 0; digits < 3; digits++) {
    tet_ctx *ctx;
    tet_mesh *m = NULL;
    double x[LATTICE][3];
    place_lattice(x, 0);
    for (int i = 0; i < 3 * LATTICE; i++) {
      char text[32];
      snprintf(text, sizeof text, "%.*g", digits == 0 ? 17 : digits == 1 ? 7 : 6, x[i / 3][i % 3]);
      x[i / 3][i % 3] = strtod(text, NULL);
    }
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    const tet_pls cloud = {.n_points = LATTICE, .points = x[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
    assert_int_equal(mesh(ctx, &cloud, &m), TET_OK);
    assert_true(m->report.audit.passed && m->report.promised.delaunay && m->report.promised.gabriel);
    assert_int_equal(m->n_exceptions, 0);
    assert_int_equal(m->n_slivers, 0);
    assert_int_equal(m->report.counts.facets, 6);
    assert_true(m->n_points < 500 && fabs(m->report.quality.volume - 27) < 1e-3);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

/* However far its points are off the planes, none of it is refined without end, nor refused. */
static void uneven_lattices_are_refined(void **state) {
  (void)state;
  for (int size = -50; size < -4; size += 3) {
    tet_ctx *ctx;
    tet_mesh *m = NULL;
    double x[LATTICE][3];
    place_lattice(x, ldexp(1, size));
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    const tet_pls cloud = {.n_points = LATTICE, .points = x[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
    assert_int_equal(mesh(ctx, &cloud, &m), TET_OK);
    assert_true(m->report.audit.passed && m->n_points < 8000);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

/* A cube of nine points, whose edges' squares and volume no double holds. */
static void the_smallest_clouds_are_meshed(void **state) {
  (void)state;
  for (int side = 1; side < 20; side += 6) {
    tet_ctx *ctx;
    tet_mesh *m = NULL;
    place();
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) points[i][k] *= ldexp(side, -1074);
    for (int k = 0; k < 3; k++) points[8][k] = ldexp(k + side / 2, -1074);
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    const tet_pls cloud = {.n_points = 9, .points = points[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
    assert_int_equal(mesh(ctx, &cloud, &m), TET_OK);
    assert_true(m->report.audit.passed);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

/* Needles of lengths whose squares and products are no doubles: no plane is missed for that, and no segment cut that
 * rounding would lay beyond its facet, and the angles found are those of the audit. Most points of each are the
 * origin again. */
static void clouds_of_all_lengths_are_meshed(void **state) {
  (void)state;
  static const double cloud[11][30][3] = {
      {{5.964211928238371e-212, 5.964208835435795e-212, 5.964208835435795e-212},
       {5.964208835435795e-212, 5.964208835435795e-212, 5.964208835435795e-212},
       {4.66779395490141e-62, -41250583897702.4, -41255400998277.516},
       {-41255383303557.516, -41255400998277.516, 3.786691255695006e-270},
       {2.72933834019424e-310, 1.112553905478963e-308, 0}},
      {{2.3349729481794273e-59, -82463372083.2, -41255400998277.516},
       {-40095759828357.516, -41255400998277.516, -41255400998277.516},
       {-2.8864965499847887e-161, 1.3064616502410113e-279, 2.8470541962973472e-260},
       {3.30115e-319, 1.0655986769483542e-255, 6.865110951530485e-246},
       {6.627904904939275e-270, 1.112536929512761e-308, 9.776309415465995e-150},
       {1.112545417243119e-308, 2.590366e-318, 0}},
      {{-41255400998277.516, 7.880400340385734e+115, -41255400998277.516},
       {2.15272832314e-312, 2.0546950501119772e-81, 1.113852418563315e-100},
       {2.0546950501119882e-81, 3.9571987235949102e-115, 2.0546950501119882e-81},
       {1.112553905349468e-308, 4e-323, 0}},
      {{1.1278055289660776e45, 8.741346026407978e-251, 1.152348299761205e-308},
       {1.1278055297264741e45, 1.1278055297264741e45, 1.7369343988727114e98},
       {1.1278055297269221e45, 1.1278068908559418e45, 9.269e-320}},
      {{1.0696049119985664e16, -1.0568121266025976e87, 6.7e-322},
       {1.0843961455707782e16, 1.0843961455707782e16, 1.0843961455707782e16},
       {1.0843961447450246e16, 1.12715261048105e-307, 5.562684648340265e-308}},
      {{-41255400998277.516, -41255375470592.031, -11963117691233.379},
       {3.5295369653592868e30, 3.28972729885111e33, -41251223932044.547},
       {6.6206854515385807e-309, -41255400997888, -50050520941957.516},
       {3.5295369653413445e30, 3.5299189859003427e30, 1.4518608827610419e-231},
       {7.2494442857168362e-299, 1.1125539052200628e-308, 3.9525251667299724e-323}},
      {{-41255400998277.516, 3.4376331821591868e-312, 1.3792972650562704e-312},
       {-41255400998277.516, -12219635796.720097, -8589934592},
       {-41255389070725.516, -45653447509381.516, -2.6433883080450235e-162},
       {1.7030785300259235e-271, 5.7757250607732037e-312, 4.3459136932974485e-311}},
      {{-41255400998277.516, -41255400998277.516, 3.1498375022140761e-315},
       {-41252347544965.516, -41255400998277.516, -1.4640006110706721e-183},
       {-1.3705455086547891e-43, 1.4785007357263361e-309, 3.3419567014540793e-308},
       {1.2304052743023735e-317, 4.8062706027436464e-320, 2.6941033237584822e-289},
       {2.0537774522026764e-289, 1.1205904586446837e-294, 3.7227837282531531e-265},
       {4.9406564584124654e-323, 0, 0}},
      {{-41255400998277.516, -41255400998277.516, 2.0526495856117777e-289},
       {-11544874975232.164, -41255400932741.547, 5.7586214160535777e-310},
       {8.1747074104349303e-317, 0, 0}},
      {{1.1170419926565923e-308, 5.678679377152975e-270, 3.131513167506177e-294},
       {4.816834316685646e-299, -3.7206610497508114e-103, -3.7206620809969885e-103},
       {-3.7206620809969885e-103, -1.507885511341553e-105, -3.7206620809969885e-103},
       {-3.7206620809969885e-103, -3.7206620809969885e-103, -2.5870228531932186e-104},
       {-3.7206620809969885e-103, 3.943507287222582e-270, -3.7203136684437065e-103},
       {6.63338727e-316, 0, 0}},
      {{-41255400998277.516, 1.058000805270577e-309, 0},
       {0, 0, -41248865910784},
       {-163200691077.29498, -17995264176.690193, -8.185497289678899e-36},
       {3.785773352849559e-270, 6.271641025578824e-299, 8.613979e-317},
       {1.1818212630765842e-125, 1.5037550191138125e-290, 1.997103436119296e-284},
       {5.645257411286e-312, 0, 0}}};
  for (int i = 0; i < 11; i++) {
    tet_ctx *ctx;
    tet_mesh *m = NULL;
    const tet_limits limits = {.max_vertices = i == 10 ? 200 : 600};
    assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
    const tet_pls pls = {.n_points = 30, .points = cloud[i][0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
    tet_options o;
    tet_options_default(&o);
    o.break_points = 1;
    tet_status status = tet_mesh_pls(ctx, &pls, &o, &m);
    assert_true(status == TET_OK || (i == 10 && status == TET_E_VERTEX_LIMIT)); /* the last is finer than that */
    if (status == TET_OK) assert_true(m->report.audit.passed);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

static void flat_clouds_are_refused(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_mesh *m = NULL;
  place();
  for (int i = 0; i < N; i++) points[i][1] = 3;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  const tet_pls cloud = {.n_points = N, .points = points[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
  assert_int_equal(mesh(ctx, &cloud, &m), TET_E_DEGENERATE);
  const tet_pls none = {.n_points = N, .points = points[0]};
  assert_int_not_equal(mesh(ctx, &none, &m), TET_OK);
  assert_null(m);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_hull_is_refined),
                                     cmocka_unit_test(points_that_are_not_listed_stay_out),
                                     cmocka_unit_test(the_smallest_clouds_are_meshed),
                                     cmocka_unit_test(clouds_of_all_lengths_are_meshed),
                                     cmocka_unit_test(turned_lattices_are_refined),
                                     cmocka_unit_test(uneven_lattices_are_refined),
                                     cmocka_unit_test(flat_clouds_are_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
