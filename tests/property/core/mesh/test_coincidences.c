// SPDX-License-Identifier: Apache-2.0
/* Ten thousand small sets of points full of coincidences: few values of coordinates, points in
 * one plane, on one line, on one sphere, all equal, repeated. Duplicates are merged into the lowest
 * and counted; sets without volume are refused as such; the others are Delaunay by exact
 * arithmetic, and emptied vertex by vertex they stay so down to the last volume. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <tet/engine.h>

#include "exact/exact_stage.h"
#include "laws.h"
#include "point_sets.h"

enum { SETS = 10000, MOST = 40 };

static uint32_t below(uint64_t *s, uint32_t n) { return (uint32_t)(point_set_next(s) % n); }

/* Returns how many of up to MOST points. */
static uint32_t draw(uint64_t *s, double x[3 * MOST]) {
  static const double scales[] = {1, 0.1, 1e-9, 1e6, 0x1p-300};
  uint32_t n = 1 + below(s, MOST), kind = below(s, 7), values = 1 + below(s, 4);
  double scale = scales[below(s, 5)], shift = below(s, 2) ? 0 : 3 * scale;
  for (uint32_t i = 0; i < n; i++) {
    double *p = x + 3 * (size_t)i;
    for (int k = 0; k < 3; k++) p[k] = below(s, values + 1);
    if (kind == 1) p[2] = 1;                                        /* a plane */
    if (kind == 2) p[2] = p[0] + 2 * p[1];                          /* a slanted one */
    if (kind == 3) p[1] = p[2] = 2 * p[0];                          /* a line */
    if (kind == 4) p[0] = p[1] = p[2] = 1;                          /* a point */
    if (kind == 5 && below(s, 2)) memcpy(p, x + 3 * (size_t)below(s, i + 1), 3 * sizeof *p);
    if (kind == 6) { /* integer points of a sphere of radius 3 */
      static const int8_t on[][3] = {{1, 2, 2}, {2, 1, 2}, {2, 2, 1}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
      const int8_t *q = on[below(s, 6)];
      for (int k = 0; k < 3; k++) p[k] = below(s, 2) ? q[k] : -q[k];
    }
    for (int k = 0; k < 3; k++) p[k] = p[k] * scale + shift;
  }
  return n;
}

static int has_volume(const double *x, uint32_t n) {
  for (uint32_t b = 1; b < n; b++)
    for (uint32_t c = b + 1; c < n; c++)
      for (uint32_t d = c + 1; d < n; d++) {
        const tet_point_ref ref[4] = {tet_ref_xyz(x), tet_ref_xyz(x + 3 * (size_t)b), tet_ref_xyz(x + 3 * (size_t)c),
                                      tet_ref_xyz(x + 3 * (size_t)d)};
        if (tet_exact_orient3d(ref)) return 1;
      }
  return 0;
}

/* Moves the distinct points to the front; returns how many. first[i]: the first equal to i. */
static uint32_t distinct(const double *x, uint32_t n, double *ret, uint32_t *first) {
  uint32_t m = 0;
  for (uint32_t i = 0; i < n; i++) {
    const double *p = x + 3 * (size_t)i;
    for (first[i] = 0; first[i] < i; first[i]++) {
      const double *q = x + 3 * (size_t)first[i];
      if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
    }
    if (first[i] == i) memcpy(ret + 3 * (size_t)m++, p, 3 * sizeof *p);
  }
  return m;
}

/* Through the whole engine: duplicates, and sets without volume. */
static void check_engine(tet_ctx *ctx, const double *x, uint32_t n, uint32_t m, const uint32_t *first, int volume) {
  tet_pls pls = {.n_points = n, .points = x, .n_loose_points = TET_LOOSE_ALL_UNUSED};
  tet_options options;
  tet_mesh *mesh = NULL;
  tet_options_default(&options);
  options.stage = TET_STAGE_DELAUNAY;
  tet_status status = tet_mesh_pls(ctx, &pls, &options, &mesh);
  assert_int_equal(status, volume ? TET_OK : TET_E_DEGENERATE);
  if (!volume) {
    assert_true(strlen(tet_ctx_error(ctx)->message) > 0);
    return;
  }
  assert_int_equal(mesh->report.audit.passed, 1);
  assert_int_equal(mesh->report.counts.duplicate_vertices, n - m);
  for (uint32_t i = 0; i < n; i++) assert_int_equal(mesh->point_same_as[i], first[i]);
  tet_mesh_free(mesh);
}

/* Removes vertices in a random order: to the end or until the others span no volume. */
static void check_removal(tet_complex *c, tet_points *points, uint64_t *s) {
  uint32_t order[MOST], n = points->n;
  uint8_t gone[MOST] = {0};
  for (uint32_t i = 0; i < n; i++) order[i] = i;
  for (uint32_t i = n; i > 1; i--) {
    uint32_t j = below(s, i), swap = order[j];
    order[j] = order[i - 1];
    order[i - 1] = swap;
  }
  for (uint32_t k = 0; k < n; k++) {
    tet_status status = tet_complex_remove(c, order[k]);
    if (status == TET_E_DEGENERATE) {
      double left[3 * MOST];
      uint32_t m = 0;
      for (uint32_t v = 0; v < n; v++)
        if (!gone[v] && v != order[k]) memcpy(left + 3 * (size_t)m++, points->x + 3 * (size_t)v, 3 * sizeof *left);
      assert_false(has_volume(left, m));
      check_laws(c, gone);
      return;
    }
    assert_int_equal(status, TET_OK);
    gone[order[k]] = 1;
    rows r = sorted_rows(c), alone = rows_without(points, gone);
    check_same(&alone, &r);
    free(r.row);
    free(alone.row);
  }
}

static void coincidences(void **state) {
  (void)state;
  uint64_t s = 2024;
  uint32_t with_volume = 0;
  print_message("seed 2024\n");
  for (int set = 0; set < SETS; set++) {
    double x[3 * MOST], y[3 * MOST];
    uint32_t first[MOST], ids[MOST], n = draw(&s, x), m = distinct(x, n, y, first);
    int volume = has_volume(y, m);
    tet_ctx *ctx;
    tet_complex c;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    check_engine(ctx, x, n, m, first, volume);
    tet_points points = tet_points_explicit(y, m);
    if (set & 1) tet_points_find_grain(&points);
    for (uint32_t i = 0; i < m; i++) ids[i] = i;
    tet_complex_init(&c, ctx, &points);
    assert_int_equal(tet_delaunay(&c, ids, m, 1), volume ? TET_OK : TET_E_DEGENERATE);
    if (volume) {
      check_laws(&c, NULL);
      if (set % 4 == 0) check_removal(&c, &points, &s);
      with_volume++;
    }
    tet_complex_free(&c);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
  assert_true(with_volume > SETS / 4 && with_volume < SETS);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(coincidences)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
