// SPDX-License-Identifier: Apache-2.0
/* A good mesh passes; each single fault is found, and counted as what it is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "audit/audit.h"
#include "audit/quality.h"
#include "box_mesh.h"
#include <tet/engine.h>

static tet_ctx *ctx;
static tet_mesh *mesh;

static int set_up(void **state) {
  (void)state;
  if (tet_ctx_create(NULL, &ctx) != TET_OK) return 1;
  mesh = box_mesh(ctx, 3);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  tet_mesh_free(mesh);
  uint64_t left = tet_ctx_bytes(ctx);
  tet_ctx_free(ctx);
  return left != 0;
}

static tet_audit audit(void) {
  tet_audit a;
  memset(&a, 0xff, sizeof a);
  assert_int_equal(tet_audit_mesh(ctx, NULL, mesh, &a), TET_OK);
  return a;
}

/* Asserts that nothing but `expected` was found (passed aside). */
static void expect(tet_audit expected) {
  tet_audit a = audit();
  assert_false(a.passed);
  /* All counts, which stand before `passed`; what pads the end is anybody's. */
  assert_memory_equal(&a, &expected, offsetof(tet_audit, passed));
}

static uint32_t subface_of(int32_t marker) {
  for (uint32_t s = 0; s < mesh->n_subfaces; s++)
    if (mesh->subface_markers[s] == marker) return s;
  fail();
  return 0;
}

static void drop_subface(uint32_t s) {
  uint32_t last = --mesh->n_subfaces;
  memmove(mesh->subfaces + 3 * s, mesh->subfaces + 3 * last, 3 * sizeof *mesh->subfaces);
  mesh->subface_markers[s] = mesh->subface_markers[last];
}

static void passes_a_good_mesh(void **state) {
  (void)state;
  tet_audit a = audit();
  assert_true(a.passed);
  assert_int_equal(a.facet, TET_NONE);
  assert_memory_equal(&a, &(tet_audit){0}, offsetof(tet_audit, passed));
}

static void finds_inverted(void **state) {
  (void)state;
  uint32_t *v = mesh->tetrahedra + 4 * 100, t = v[0];
  v[0] = v[1];
  v[1] = t;
  t = mesh->neighbours[400];
  mesh->neighbours[400] = mesh->neighbours[401];
  mesh->neighbours[401] = t;
  tet_audit a = audit();
  assert_int_equal(a.flat_or_inverted, 1);
  assert_true(a.adjacency > 0);
  assert_false(a.passed);
}

static void finds_flat(void **state) {
  (void)state;
  mesh->tetrahedra[3] = mesh->tetrahedra[2];
  tet_audit a = audit();
  assert_int_equal(a.flat_or_inverted, 1);
  assert_false(a.passed);
}

static void finds_repeated_tetrahedron(void **state) {
  (void)state;
  uint32_t n = mesh->n_tetrahedra++;
  memcpy(mesh->tetrahedra + 4 * n, mesh->tetrahedra, 4 * sizeof *mesh->tetrahedra);
  memcpy(mesh->neighbours + 4 * n, mesh->neighbours, 4 * sizeof *mesh->neighbours);
  mesh->tetrahedron_regions[n] = mesh->tetrahedron_regions[0];
  tet_audit a = audit();
  assert_true(a.adjacency > 0);
  assert_false(a.passed);
}

static void finds_missing_tetrahedron(void **state) {
  (void)state;
  mesh->n_tetrahedra--;
  for (uint32_t i = 0; i < 4 * mesh->n_tetrahedra; i++)
    if (mesh->neighbours[i] == mesh->n_tetrahedra) mesh->neighbours[i] = TET_NONE;
  tet_audit a = audit();
  assert_true(a.uncovered > 0);
  assert_false(a.passed);
}

static void finds_wrong_neighbour(void **state) {
  (void)state;
  uint32_t i = 0;
  while (mesh->neighbours[i] == TET_NONE) i++;
  mesh->neighbours[i] = TET_NONE;
  expect((tet_audit){.adjacency = 1});
}

static void finds_bad_index(void **state) {
  (void)state;
  mesh->subsegments[1] = mesh->n_points;
  expect((tet_audit){.bad_indices = 1});
}

static void finds_dropped_boundary_subface(void **state) {
  (void)state;
  drop_subface(subface_of(10));
  expect((tet_audit){.uncovered = 1});
}

static void finds_dropped_wall_subface(void **state) {
  (void)state;
  drop_subface(subface_of(16));
  expect((tet_audit){.region_leaks = 1});
}

static void finds_foreign_subface(void **state) {
  (void)state;
  uint32_t *v = mesh->subfaces + 3 * mesh->n_subfaces++;
  v[0] = 0;
  v[1] = 1;
  v[2] = mesh->n_points - 1;
  expect((tet_audit){.subfaces_missing = 1});
}

static void finds_repeated_subface(void **state) {
  (void)state;
  memcpy(mesh->subfaces + 3 * mesh->n_subfaces++, mesh->subfaces, 3 * sizeof *mesh->subfaces);
  expect((tet_audit){.subfaces_missing = 1});
}

static void finds_wrong_region(void **state) {
  (void)state;
  uint32_t inner = 0; /* of the first tetrahedron with four neighbours, the faces off subfaces */
  for (uint32_t t = 0; !inner && t < mesh->n_tetrahedra; t++) {
    const uint32_t *n = mesh->neighbours + 4 * t;
    if (n[0] == TET_NONE || n[1] == TET_NONE || n[2] == TET_NONE || n[3] == TET_NONE) continue;
    for (int i = 0; i < 4; i++) inner += mesh->tetrahedron_regions[n[i]] == mesh->tetrahedron_regions[t];
    mesh->tetrahedron_regions[t] ^= 1;
  }
  expect((tet_audit){.region_leaks = inner, .wrong_regions = 1}); /* which is in two parts now */
}

static void finds_missing_subsegment(void **state) {
  (void)state;
  uint32_t n = mesh->n_subsegments++;
  mesh->subsegments[2 * n] = 0;
  mesh->subsegments[2 * n + 1] = mesh->n_points - 1;
  mesh->subsegment_segments[n] = 1000;
  expect((tet_audit){.subsegments_missing = 1});
}

static void finds_broken_chain(void **state) {
  (void)state;
  uint32_t n = --mesh->n_subsegments; /* the middle one of the first segment's three goes */
  memcpy(mesh->subsegments + 2, mesh->subsegments + 2 * n, 2 * sizeof *mesh->subsegments);
  mesh->subsegment_segments[1] = mesh->subsegment_segments[n];
  expect((tet_audit){.broken_segments = 1});
}

static void finds_ring(void **state) {
  (void)state;
  uint32_t square[] = {0, 1, 1, 8, 8, 7, 7, 0}; /* one chain closed to a ring, none open */
  mesh->n_subsegments = 4;
  memcpy(mesh->subsegments, square, sizeof square);
  memset(mesh->subsegment_segments, 0, 4 * sizeof *mesh->subsegment_segments);
  tet_audit a = audit();
  assert_int_equal(a.broken_segments, 1);
  assert_false(a.passed);
}

static void finds_over_bounds(void **state) {
  (void)state;
  mesh->report.promised.radius_edge = 0.8; /* these have sqrt(3)/2 */
  expect((tet_audit){.over_radius_edge = mesh->n_tetrahedra});
  mesh->report.promised.radius_edge = 0;
  mesh->report.promised.max_volume = 0.1; /* and a sixth */
  expect((tet_audit){.over_volume = mesh->n_tetrahedra});
  mesh->report.promised.max_volume = 0;
  mesh->region_max_volumes[1] = 0.1;
  expect((tet_audit){.over_volume = mesh->n_tetrahedra / 2});
}

static void finds_unlisted_slivers(void **state) {
  (void)state;
  mesh->report.promised.min_dihedral = 44; /* these have 45 */
  assert_true(audit().passed);
  mesh->report.promised.min_dihedral = 46;
  expect((tet_audit){.under_dihedral = mesh->n_tetrahedra});
  mesh->sliver_tetrahedra[0] = 3;
  mesh->n_slivers = 1;
  expect((tet_audit){.under_dihedral = mesh->n_tetrahedra - 1});
  mesh->n_slivers = 0;
}

static void accepts_listed_exceptions(void **state) {
  (void)state;
  mesh->report.promised.radius_edge = 0.8;
  for (uint32_t t = 0; t < mesh->n_tetrahedra; t++) mesh->exception_tetrahedra[t] = t;
  mesh->n_exceptions = mesh->n_tetrahedra;
  assert_true(audit().passed);
  mesh->n_exceptions--;
  expect((tet_audit){.over_radius_edge = 1});
}

static void finds_dents(void **state) {
  (void)state;
  mesh->report.promised = (tet_promise){.convex = 1};
  assert_true(audit().passed); /* a box, with many edges between coplanar faces */
  uint32_t n = mesh->n_tetrahedra - 1; /* the last one goes: at a corner of the box */
  for (uint32_t i = 0; i < 4 * n; i++)
    if (mesh->neighbours[i] == n) mesh->neighbours[i] = TET_NONE;
  mesh->n_tetrahedra = n;
  tet_audit a = audit();
  assert_true(a.reflex > 0);
  assert_false(a.passed);
}

/* Two tetrahedra on the triangle 0 1 2, apexes 3 above and 4 below. */
static void two_tetrahedra(double above, double below) {
  static const double corners[9] = {0, 0, 0, 4, 0, 0, 1, 3, 0};
  static const uint32_t v[8] = {0, 1, 2, 3, 0, 2, 1, 4};
  static const uint32_t neighbours[8] = {TET_NONE, TET_NONE, TET_NONE, 1, TET_NONE, TET_NONE, TET_NONE, 0};
  static const uint32_t faces[18] = {0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 1, 4, 1, 2, 4, 2, 0, 4};
  static const uint32_t edges[18] = {0, 1, 1, 2, 2, 0, 0, 3, 1, 3, 2, 3, 0, 4, 1, 4, 2, 4};
  memcpy(mesh->points, corners, sizeof corners);
  for (int k = 0; k < 2; k++) {
    double *p = mesh->points + 9 + 3 * k;
    p[0] = 1.5;
    p[1] = 1;
    p[2] = k ? -below : above;
  }
  memcpy(mesh->tetrahedra, v, sizeof v);
  memcpy(mesh->neighbours, neighbours, sizeof neighbours);
  memcpy(mesh->subfaces, faces, sizeof faces);
  memcpy(mesh->subsegments, edges, sizeof edges);
  for (uint32_t s = 0; s < 9; s++) mesh->subsegment_segments[s] = s;
  memset(mesh->tetrahedron_regions, 0, 2 * sizeof *mesh->tetrahedron_regions);
  mesh->n_points = mesh->n_input_points = 5;
  mesh->n_tetrahedra = 2;
  mesh->n_subfaces = 6;
  mesh->n_subsegments = 9;
  mesh->n_regions = 1;
  mesh->report.promised = (tet_promise){.delaunay = 1, .constrained_delaunay = 1, .covered = 1};
}

static void finds_not_delaunay(void **state) {
  (void)state;
  two_tetrahedra(3, 3);
  assert_true(audit().passed);
  two_tetrahedra(0.5, 0.5);
  tet_audit a = audit();
  assert_int_equal(a.not_delaunay, 1);
  assert_int_equal(a.not_constrained_delaunay, 1);
  assert_false(a.passed);
  uint32_t wall[3] = {2, 0, 1}; /* a subface need not be locally Delaunay */
  memcpy(mesh->subfaces + 18, wall, sizeof wall);
  mesh->n_subfaces = 7;
  mesh->n_regions = 2;
  mesh->tetrahedron_regions[1] = 1;
  a = audit();
  assert_int_equal(a.not_delaunay, 1);
  assert_int_equal(a.not_constrained_delaunay, 0);
  assert_false(a.passed);
  mesh->report.promised.delaunay = 0;
  assert_true(audit().passed);
}

static void finds_encroached(void **state) {
  (void)state;
  two_tetrahedra(3, 3);
  uint32_t wall[3] = {2, 0, 1};
  memcpy(mesh->subfaces + 18, wall, sizeof wall);
  mesh->n_subfaces = 7;
  tet_audit before = audit();
  mesh->points[11] = 0.25; /* apex 3 sinks into the balls of the triangle and of the edge */
  tet_audit a = audit();
  assert_true(a.subfaces_encroached > before.subfaces_encroached);
  assert_true(a.subsegments_encroached > before.subsegments_encroached);
  mesh->report.promised = (tet_promise){.gabriel = 1};
  assert_false(audit().passed);
}

/* Two of the sides of a tetrahedron on one facet: that the edge between them is no
 * subsegment tells so. */
static void finds_facet_sliver(void **state) {
  (void)state;
  two_tetrahedra(3, 3);
  assert_int_equal(audit().facet_slivers, 0); /* all edges there are subsegments */
  mesh->n_subsegments--;
  tet_audit a = audit();
  assert_int_equal(a.facet_slivers, 1);
  assert_false(a.passed);
}

/* The edge 0 1 inside one facet of two triangles that are not quite coplanar. */
static void excuses_creases(void **state) {
  (void)state;
  two_tetrahedra(0.25, 3);
  uint32_t faces[6] = {0, 1, 2, 0, 3, 1};
  memcpy(mesh->subfaces, faces, sizeof faces);
  memset(mesh->subface_facets, 0, 2 * sizeof *mesh->subface_facets);
  mesh->n_subfaces = 2;
  mesh->n_subsegments = 1;
  assert_int_equal(audit().subsegments_encroached, 0);
  mesh->subface_facets[1] = 1;
  assert_int_equal(audit().subsegments_encroached, 1);
  mesh->subface_markers[0] = mesh->subface_markers[1] = 5; /* they meet at atan(1/4), 14.04 degrees, off a fold */
  mesh->report.promised.merge_angle = 20;
  assert_int_equal(audit().subsegments_encroached, 1);
  uint32_t beyond[3] = {0, 4, 1}; /* nearly flat now */
  memcpy(mesh->subfaces + 3, beyond, sizeof beyond);
  double *x = mesh->points + 12;
  x[1] = -1, x[2] = -0.25;
  assert_int_equal(audit().subsegments_encroached, 0);
  mesh->report.promised.merge_angle = 14;
  assert_int_equal(audit().subsegments_encroached, 1);
  mesh->report.promised.merge_angle = 20;
  mesh->subface_markers[1] = 6;
  assert_int_equal(audit().subsegments_encroached, 1);
}

static void can_be_cancelled(void **state) {
  (void)state;
  tet_audit a = {.passed = 7};
  tet_cancel(ctx);
  assert_int_equal(tet_audit_mesh(ctx, NULL, mesh, &a), TET_E_CANCELLED);
  assert_int_equal(a.passed, 7);
}

static void measures_shapes(void **state) {
  (void)state;
  const double h = sqrt(0.5), degrees = 180 / acos(-1.0);
  double regular[12] = {1, 0, -h, -1, 0, -h, 0, 1, h, 0, -1, h};
  const uint32_t v[4] = {0, 1, 2, 3}, w[4] = {1, 0, 2, 3};
  tet_shape s = tet_shape_of(regular, v);
  if (s.volume < 0) s = tet_shape_of(regular, w);
  assert_true(fabs(s.volume - 8 / (6 * sqrt(2.0))) < 1e-12);
  assert_true(fabs(s.radius_edge - sqrt(6.0) / 4) < 1e-12);
  assert_true(fabs(s.aspect - sqrt(1.5)) < 1e-12);
  assert_true(fabs(degrees * acos(s.cos_smallest) - 70.528779365509308) < 1e-9);
  assert_true(fabs(degrees * acos(s.cos_largest) - 70.528779365509308) < 1e-9);
  /* a needle of a face: in doubles the angles at it depend on the vertex that one begins with */
  const double far[12] = {1.1278055297264741e45, 1.1278055297264741e45, 1.7369343988727114e98,
                          1.1278055297269221e45, 1.1278068908559418e45, 0,
                          1.1278055293234235e45, 5.296973214732405e44,  0,
                          5.6390276089619764e44, 5.6390344146070275e44, 0};
  const tet_shape first = tet_shape_of(far, v);
  for (uint32_t k = 1; k < 4; k++) {
    const uint32_t turned[4] = {k, k ^ 1U, k ^ 2U, k ^ 3U};
    s = tet_shape_of(far, turned);
    assert_true(fabs(s.cos_smallest - first.cos_smallest) < 1e-9 && fabs(s.cos_largest - first.cos_largest) < 1e-9);
    assert_true(fabs(s.radius_edge / first.radius_edge - 1) < 1e-9 && fabs(s.volume / first.volume - 1) < 1e-9);
  }

  tet_quality q;
  assert_int_equal(tet_measure_quality(ctx, mesh, &q), TET_OK);
  assert_true(fabs(q.volume - 54) < 1e-9);
  assert_true(fabs(q.radius_edge.min - sqrt(0.75)) < 1e-12 && fabs(q.radius_edge.max - sqrt(0.75)) < 1e-12);
  assert_int_equal(q.radius_edge.bins[1], mesh->n_tetrahedra); /* 0.8 to 1 */
  assert_true(fabs(q.dihedral_min.min - 45) < 1e-9 && fabs(q.dihedral_max.max - 90) < 1e-9);
  uint64_t sum = 0;
  for (uint32_t i = 0; i < q.aspect.n_bins; i++) sum += q.aspect.bins[i];
  assert_int_equal(sum, mesh->n_tetrahedra);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(passes_a_good_mesh), TEST(finds_inverted), TEST(finds_flat), TEST(finds_repeated_tetrahedron),
      TEST(finds_missing_tetrahedron), TEST(finds_wrong_neighbour), TEST(finds_bad_index),
      TEST(finds_dropped_boundary_subface), TEST(finds_dropped_wall_subface), TEST(finds_foreign_subface),
      TEST(finds_repeated_subface), TEST(finds_wrong_region), TEST(finds_missing_subsegment), TEST(finds_broken_chain),
      TEST(finds_ring), TEST(finds_over_bounds), TEST(accepts_listed_exceptions), TEST(finds_unlisted_slivers), TEST(finds_dents), TEST(finds_not_delaunay),
      TEST(finds_encroached), TEST(finds_facet_sliver), TEST(excuses_creases), TEST(can_be_cancelled), TEST(measures_shapes)};
  return cmocka_run_group_tests_name("audit", tests, NULL, NULL);
}
