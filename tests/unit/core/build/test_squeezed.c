// SPDX-License-Identifier: Apache-2.0
/* Flat roofs over needles: no interior face of the CDT lies on the facets within a thousand millionth of the
 * box's diagonal, points in the volume come only where they are needed for that, and loose segments stay. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/triangle.h"
#include "pls_builder.h"
#include <tet/engine.h>

static const double NEAR = 1e-9;

/* A box whose top is a fan from the middle of one of its edges: outside needles as wide as `half` there is a
 * plane, and the edge between the two needles is `high` above it on the other side. is_one: what is coplanar there is
 * one facet. */
static pls_builder *roof(double half, double high, int is_one) {
  pls_builder *b = pls_new();
  const double x[][3] = {{-1, -1, 0}, {1, -1, 0}, {1, -half, 0}, {1, 0, high}, {1, half, 0}, {1, 1, 0}, {-1, 1, 0},
                         {-1, 0, 0},  {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},   {-1, 1, -1}};
  for (size_t i = 0; i < sizeof x / sizeof *x; i++) pls_point(b, x[i][0], x[i][1], x[i][2]);
  for (uint32_t i = 0; i < 6; i++) pls_triangle(b, is_one ? 1 : 1 + (int32_t)i, 7, i, i + 1);
  pls_facet(b, 7);
  pls_polygon(b, 5, (const uint32_t[]){0, 7, 6, 11, 8});
  pls_quad(b, 8, 0, 8, 9, 1);
  pls_quad(b, 9, 8, 11, 10, 9);
  pls_quad(b, 10, 6, 5, 10, 11);
  pls_facet(b, 11);
  pls_polygon(b, 7, (const uint32_t[]){1, 9, 10, 5, 4, 3, 2});
  return b;
}

static const double *at(const tet_mesh *m, uint32_t v) { return m->points + 3 * (size_t)v; }

static int is_near_facet(const tet_mesh *m, const double x[3], double least) {
  for (size_t s = 0; s < m->n_subfaces; s++) {
    const uint32_t *v = m->subfaces + 3 * s;
    if (tet_triangle_distance2(at(m, v[0]), at(m, v[1]), at(m, v[2]), x) <= least * least) return 1;
  }
  return 0;
}

static int is_subface(const tet_mesh *m, const uint32_t v[3]) {
  for (size_t s = 0; s < m->n_subfaces; s++) {
    int n = 0;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) n += m->subfaces[3 * s + (size_t)i] == v[j];
    if (n == 3) return 1;
  }
  return 0;
}

/* How many faces of tetrahedra, off the subfaces, lie on facets; interior ones count twice. */
static size_t count_flat(const tet_mesh *m, double least) {
  size_t n = 0;
  for (size_t h = 0; h < 4 * (size_t)m->n_tetrahedra; h++) {
    uint32_t v[3];
    double centre[3] = {0, 0, 0};
    for (size_t i = 0, k = 0; i < 4; i++)
      if (i != h % 4) v[k++] = m->tetrahedra[h - h % 4 + i];
    int flat = !is_subface(m, v);
    for (int i = 0; i < 3 && flat; i++) {
      const double *a = at(m, v[i]), *b = at(m, v[(i + 1) % 3]);
      double middle[3];
      for (int k = 0; k < 3; k++) {
        middle[k] = (a[k] + b[k]) / 2;
        centre[k] += a[k] / 3;
      }
      flat = is_near_facet(m, a, least) && is_near_facet(m, middle, least);
    }
    n += flat && is_near_facet(m, centre, least);
  }
  return n;
}

/* wants_points: 1: points in the volume are wanted, 0: none are, -1: who knows. */
static void check(pls_builder *b, int wants_points) {
  tet_ctx *ctx;
  tet_mesh *m;
  tet_options options;
  tet_options_default(&options);
  options.stage = TET_STAGE_CDT;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(tet_mesh_pls(ctx, &b->pls, &options, &m), TET_OK);
  assert_true(m->report.audit.passed && m->report.promised.constrained_delaunay);
  if (wants_points >= 0) assert_int_equal(m->report.counts.squeezed_points > 0, wants_points);
  size_t in_volume = 0;
  for (size_t v = 0; v < m->n_points; v++) in_volume += m->point_origin[v] == TET_ORIGIN_VOLUME;
  assert_int_equal(in_volume, m->report.counts.squeezed_points);
  assert_int_equal(count_flat(m, NEAR * 3), 0);
  tet_mesh_free(m);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void flat_roofs_have_no_second_skin(void **state) {
  (void)state;
  const double half[] = {1e-3, 1e-4, 3e-5, 1e-5, 1e-6};
  for (size_t i = 0; i < sizeof half / sizeof *half; i++)
    for (double high = 1e-9; high > 1e-12; high /= 8) {
      pls_builder *b = roof(half[i], high, 1);
      /* a sphere through both needles' sides has a radius of about half^2 / (2 high): it need not be empty */
      check(b, half[i] * half[i] < 2 * high);
      pls_free(b);
      b = roof(half[i], high, 0); /* more segments, and Steiner points on them */
      check(b, -1);
      pls_free(b);
    }
}

static void loose_segments_stay(void **state) {
  (void)state;
  const double depth[] = {0.5, 0.1, 1e-2, 1e-4};
  for (size_t i = 0; i < sizeof depth / sizeof *depth; i++) {
    pls_builder *b = roof(1e-5, 1e-9, 1);
    uint32_t p = pls_point(b, -0.5, 0.01, -depth[i]), q = pls_point(b, 0.5, -0.02, -depth[i] / 2);
    pls_segment(b, 12, p, q);
    check(b, -1); /* the audit looks for the segment */
    pls_free(b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(flat_roofs_have_no_second_skin), cmocka_unit_test(loose_segments_stay)};
  return cmocka_run_group_tests_name("squeezed", tests, NULL, NULL);
}
