// SPDX-License-Identifier: Apache-2.0
/* The dual of meshes made by hand: every volume, factor and share is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/context.h"
#include "box_mesh.h"
#include "dual/diagram.h"
#include "dual/dual.h"
#include "polyhedra.h"

static int close_to(double a, double b) { return fabs(a - b) < 1e-14; }

/* A half where the plane x_k = value bounds the box or a region, else 1. */
static double part_of(const double *p, int k, uint32_t n, uint32_t region) {
  double low = k == 0 && region == 1 ? n : 0, high = k == 0 && region == 0 ? n : k == 0 ? 2 * n : n;
  return p[k] == low || p[k] == high ? 0.5 : 1;
}

static void check_edges(const tet_mesh *m, uint32_t n) {
  uint32_t axial = 0;
  for (uint32_t row = 0; row < m->n_edges; row++) {
    const uint32_t *v = m->edge_vertices + 2 * row;
    assert_true(v[0] < v[1]);
    const double *p = m->points + 3 * v[0], *q = m->points + 3 * v[1];
    int along = -1, differ = 0;
    for (int k = 0; k < 3; k++)
      if (p[k] != q[k]) {
        along = k;
        differ++;
      }
    double wanted = 0; /* diagonals: all eight corners of a cube are cospherical */
    if (differ == 1) {
      uint32_t region = m->edge_regions[row];
      wanted = part_of(p, (along + 1) % 3, n, region) * part_of(p, (along + 2) % 3, n, region);
      axial++;
    }
    assert_true(close_to(m->edge_factors[row], wanted));
    if (row == 0) continue;
    const uint32_t *u = v - 2;
    uint32_t before[3] = {u[0], u[1], m->edge_regions[row - 1]}, now[3] = {v[0], v[1], m->edge_regions[row]};
    int k = 0;
    while (k < 3 && before[k] == now[k]) k++;
    assert_true(k < 3 && before[k] < now[k]);
  }
  assert_int_equal(axial, 2 * (n * (n + 1) * (n + 1) * 3)); /* of two boxes; the wall's twice */
}

static void boxes(void **state) {
  (void)state;
  for (uint32_t n = 1; n < 4; n++) {
    tet_ctx *ctx;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_mesh *m = box_mesh(ctx, n);
    assert_int_equal(tet_voronoi_factors(ctx, m), TET_OK);
    assert_int_equal(m->n_cells, 2 * (n + 1) * (n + 1) * (n + 1));
    for (uint32_t c = 0; c < m->n_cells; c++) {
      const double *p = m->points + 3 * m->cell_vertices[c];
      double wanted = 1;
      for (int k = 0; k < 3; k++) wanted *= part_of(p, k, n, m->cell_regions[c]);
      assert_true(close_to(m->cell_volumes[c], wanted));
      if (c == 0) continue;
      assert_true(m->cell_vertices[c - 1] < m->cell_vertices[c] ||
                  (m->cell_vertices[c - 1] == m->cell_vertices[c] && m->cell_regions[c - 1] < m->cell_regions[c]));
    }
    check_edges(m, n);
    for (uint32_t i = 0; i < 3 * m->n_subfaces; i++) { /* the right angle is at the first corner */
      const double *p = m->points + 3 * m->subfaces[i], *a = m->points + 3 * m->subfaces[i / 3 * 3 + (i + 1) % 3],
                   *b = m->points + 3 * m->subfaces[i / 3 * 3 + (i + 2) % 3];
      double dot = 0;
      for (int k = 0; k < 3; k++) dot += (a[k] - p[k]) * (b[k] - p[k]);
      assert_true(close_to(m->subface_shares[i], dot == 0 ? 0.25 : 0.125));
    }
    assert_int_equal(tet_voronoi_diagram(ctx, m), TET_OK);
    check_polyhedra(m, 1e-14);
    assert_true(m->report.voronoi.made);
    assert_int_equal(m->report.voronoi.negative_factors, 0);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

/* A mesh of given points and tetrahedra, which it does not own. */
static void dual_of(tet_ctx *ctx, double *points, uint32_t n_points, uint32_t *tets, uint32_t *regions, uint32_t n,
                    tet_mesh *ret) {
  *ret = (tet_mesh){.ctx = ctx, .n_points = n_points, .points = points, .n_tetrahedra = n, .tetrahedra = tets,
                    .tetrahedron_regions = regions};
  assert_int_equal(tet_voronoi_factors(ctx, ret), TET_OK);
}

static void forget(tet_mesh *m) {
  void *made[] = {m->cell_vertices, m->cell_regions, m->cell_volumes, m->edge_vertices, m->edge_regions,
                  m->edge_factors, m->subface_shares, m->voronoi_points, m->voronoi_face_start,
                  m->voronoi_face_points, m->voronoi_face_cells};
  for (size_t i = 0; i < sizeof made / sizeof *made; i++) tet_free(m->ctx, made[i]);
}

/* A regular tetrahedron in a cube and the four corners around it; vertex 8 is of no tetrahedron. */
static void cube_of_five(void **state) {
  (void)state;
  double points[27];
  uint32_t tets[20] = {0, 3, 6, 5, 1, 0, 3, 5, 2, 3, 0, 6, 4, 6, 0, 5, 7, 3, 5, 6};
  uint32_t regions[5] = {0, 0, 0, 0, 0};
  for (int i = 0; i < 27; i++) points[i] = i < 24 ? i / 3 >> i % 3 & 1 : 9;
  for (int t = 0; t < 5; t++) { /* whichever way round they are given */
    double d[3][3];
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) d[i][k] = points[3 * tets[4 * t + i + 1] + k] - points[3 * tets[4 * t] + k];
    double det = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                 d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    if (det > 0) continue;
    uint32_t v = tets[4 * t];
    tets[4 * t] = tets[4 * t + 1];
    tets[4 * t + 1] = v;
  }
  tet_ctx *ctx;
  tet_mesh m;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  dual_of(ctx, points, 9, tets, regions, 5, &m);
  assert_int_equal(m.n_cells, 8);
  assert_int_equal(m.n_edges, 18);
  for (uint32_t c = 0; c < 8; c++) {
    assert_int_equal(m.cell_vertices[c], c);
    assert_true(close_to(m.cell_volumes[c], 0.125));
  }
  for (uint32_t row = 0; row < 18; row++) {
    uint32_t bits = m.edge_vertices[2 * row] ^ m.edge_vertices[2 * row + 1];
    assert_true(close_to(m.edge_factors[row], (bits & (bits - 1)) == 0 ? 0.25 : 0));
  }
  assert_int_equal(m.report.voronoi.negative_factors, 0);
  forget(&m);
  tet_ctx_free(ctx);
}

/* Two flat tetrahedra on a triangle, each with the other's tip in its sphere: the triangle's edges have
 * negative factors, which are told and kept, and the volumes still add up. */
static void negative_factors_are_told(void **state) {
  (void)state;
  double points[15] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0.5, 1, 1, -0.5};
  uint32_t tets[8] = {0, 1, 2, 3, 0, 2, 1, 4}, regions[2] = {0, 0};
  tet_ctx *ctx;
  tet_mesh m;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  dual_of(ctx, points, 5, tets, regions, 2, &m);
  double sum = 0, least = 0;
  uint32_t below = 0;
  for (uint32_t c = 0; c < m.n_cells; c++) sum += m.cell_volumes[c];
  for (uint32_t row = 0; row < m.n_edges; row++) {
    if (m.edge_factors[row] < -1e-12) below++;
    if (m.edge_factors[row] < least) {
      least = m.edge_factors[row];
      assert_true(least < 0);
    }
  }
  assert_true(fabs(sum - 8.0 / 3) < 1e-13);
  assert_true(below > 0);
  assert_int_equal(m.report.voronoi.negative_factors, below);
  assert_true(m.report.voronoi.worst_factor == least);
  uint32_t row = 0;
  while (m.edge_factors[row] != least) row++;
  assert_memory_equal(m.report.voronoi.worst_edge, m.edge_vertices + 2 * row, 2 * sizeof(uint32_t));
  forget(&m);
  tet_ctx_free(ctx);
}

static void extents_out_of_range_are_refused(void **state) {
  (void)state;
  static const int exponents[] = {-400, -200, 200, 400};
  for (int i = 0; i < 4; i++) {
    double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, unit = ldexp(1, exponents[i]);
    for (int k = 0; k < 12; k++) points[k] *= unit;
    uint32_t tets[4] = {0, 1, 2, 3}, regions[1] = {0};
    tet_ctx *ctx;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_mesh m = {.ctx = ctx, .n_points = 4, .points = points, .n_tetrahedra = 1, .tetrahedra = tets,
                  .tetrahedron_regions = regions};
    if (i == 0 || i == 3) {
      assert_int_equal(tet_voronoi_factors(ctx, &m), TET_E_NOT_FINITE);
      assert_null(m.cell_volumes);
    } else {
      assert_int_equal(tet_voronoi_factors(ctx, &m), TET_OK);
      assert_true(fabs(m.cell_volumes[0] / unit / unit / unit - 0.125) < 1e-15);
    }
    forget(&m);
    tet_ctx_free(ctx);
  }
}

/* A positive tetrahedron whose volume is no double beside its longest edge; and a negative one, a bug. */
static void lengths_too_unlike_are_refused(void **state) {
  (void)state;
  const double small = ldexp(1, -1000);
  double points[12] = {0, 0, 0, ldexp(1, 250), 0, 0, 0, small, 0, 0, 0, small};
  uint32_t tets[4] = {0, 1, 2, 3}, regions[1] = {0};
  for (int turned = 0; turned < 2; turned++) {
    tet_ctx *ctx;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    tet_mesh m = {.ctx = ctx, .n_points = 4, .points = points, .n_tetrahedra = 1, .tetrahedra = tets,
                  .tetrahedron_regions = regions};
    tets[0] = (uint32_t)turned;
    tets[1] = (uint32_t)!turned;
    assert_int_equal(tet_voronoi_factors(ctx, &m), turned ? TET_E_INTERNAL : TET_E_NOT_FINITE);
    assert_null(m.cell_volumes);
    forget(&m);
    tet_ctx_free(ctx);
  }
}

/* A vertex with more tetrahedra than are sorted by insertion: a fan around an axis. */
static void many_at_a_vertex(void **state) {
  (void)state;
  enum { N = 500 };
  static double points[3 * (N + 2)] = {0, 0, 0, 0, 0, 1};
  static uint32_t tets[4 * N], regions[N];
  for (uint32_t i = 0; i < N; i++) {
    double angle = 6.283185307179586 * i / N;
    points[3 * (i + 2)] = cos(angle);
    points[3 * (i + 2) + 1] = sin(angle);
    uint32_t v[4] = {0, 1, i + 2, (i + 1) % N + 2};
    memcpy(tets + 4 * i, v, sizeof v);
    regions[i] = i % 2;
  }
  tet_ctx *ctx;
  tet_mesh m;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  dual_of(ctx, points, N + 2, tets, regions, N, &m);
  assert_int_equal(m.n_cells, 4 + 2 * N); /* every vertex in both regions */
  assert_int_equal(m.n_edges, 2 + 4 * N + N);
  double sum = 0, wanted = N * sin(6.283185307179586 / N) / 6;
  for (uint32_t c = 0; c < m.n_cells; c++) sum += m.cell_volumes[c];
  assert_true(fabs(sum - wanted) < 1e-12);
  forget(&m);
  tet_ctx_free(ctx);
}

/* Two corners of cubes that share an edge alone, all of whose faces are subfaces: the edge has two
 * Voronoi faces, one after those of the rows. */
static void region_touching_itself(void **state) {
  (void)state;
  double points[18] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0};
  uint32_t tets[8] = {0, 1, 2, 3, 0, 1, 4, 5}, regions[2] = {0, 0}, neighbours[8];
  uint32_t subfaces[24] = {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3, 0, 1, 4, 0, 1, 5, 0, 4, 5, 1, 4, 5};
  uint32_t subsegments[22] = {0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 1, 2, 1, 3, 1, 4, 1, 5, 2, 3, 4, 5};
  memset(neighbours, 0xFF, sizeof neighbours);
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_mesh m = {.ctx = ctx, .n_points = 6, .points = points, .n_tetrahedra = 2, .tetrahedra = tets,
                .tetrahedron_regions = regions, .neighbours = neighbours, .n_subfaces = 8, .subfaces = subfaces,
                .n_subsegments = 11, .subsegments = subsegments};
  assert_int_equal(tet_voronoi_factors(ctx, &m), TET_OK);
  assert_int_equal(tet_voronoi_diagram(ctx, &m), TET_OK);
  check_polyhedra(&m, 1e-14);
  assert_int_equal(m.n_edges, 11);
  assert_int_equal(m.n_voronoi_faces, 12 + 24);
  assert_true(close_to(m.edge_factors[0], 0.5));
  assert_int_equal(m.voronoi_face_cells[2 * 11], m.voronoi_face_cells[0]);
  m.n_subfaces = 7; /* a border that is no subface */
  void *before = m.voronoi_points;
  assert_int_equal(tet_voronoi_diagram(ctx, &m), TET_E_INTERNAL);
  assert_ptr_equal(before, m.voronoi_points);
  forget(&m);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(boxes), cmocka_unit_test(cube_of_five),
                                     cmocka_unit_test(negative_factors_are_told),
                                     cmocka_unit_test(extents_out_of_range_are_refused),
                                     cmocka_unit_test(lengths_too_unlike_are_refused),
                                     cmocka_unit_test(many_at_a_vertex),
                                     cmocka_unit_test(region_touching_itself)};
  return cmocka_run_group_tests_name("factors", tests, NULL, NULL);
}
