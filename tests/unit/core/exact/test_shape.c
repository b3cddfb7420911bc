// SPDX-License-Identifier: Apache-2.0
/* Circumcentres and normals of tetrahedra that are noise in doubles. */
#include "exact/shape.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Positive: as (0, 1, 2, 3). */
static const int even[12][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2}, {1, 3, 2, 0}, {1, 2, 0, 3},
                                {2, 0, 1, 3}, {2, 1, 3, 0}, {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 2, 1, 0}, {3, 1, 0, 2}};

static void known_ones_are_found(void **state) {
  (void)state;
  const double low = 0x1p-70, x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, low}};
  const double *const v[4] = {x[0], x[1], x[2], x[3]};
  tet_exact_shape s = tet_shape_exactly(v);
  assert_true(ldexp(s.volume6, -s.scale) == low);
  assert_true(s.to_centre[0] == s.volume6 && s.to_centre[1] == s.volume6);
  assert_true(s.to_centre[2] == s.volume6 * low); /* (1/2, 1/2, low / 2): the ball through the corners of a square */
  double n[4][3];
  tet_normals_exactly(v, n); /* (-low, -low, 1) from face 0, towards the origin; up from face 3 */
  assert_true(n[0][0] == -low * n[0][2] && n[0][1] == n[0][0] && n[0][2] > 0);
  assert_true(n[3][0] == 0 && n[3][1] == 0 && n[3][2] > 0 && fabs(n[3][2]) <= 1 && fabs(n[3][2]) >= 0.5);

  const double flat[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 1}};
  const double *const w[4] = {flat[0], flat[1], flat[2], flat[3]};
  assert_true(tet_shape_exactly(w).volume6 == 0);
  tet_normals_exactly(w, n);
  assert_true(n[3][0] == 0 && n[3][1] == 0 && n[3][2] == 0);
}

/* A needle between points near the origin and one far off: from there, its sides are the same in doubles. */
static void a_triangle_is_seen_along_one_axis(void **state) {
  (void)state;
  static const double needle[3][3] = {
      {-41255400998277.516, -41255400998277.516, 2.0526495856117777e-289}, {8.1747074104349303e-317, 0, 0}, {0, 0, 0}};
  static const double diagonal[3][3] = {{0, 0, 0}, {0, 0, 1}, {3, 3, 0}}; /* as large along x as along y */
  static const double steep[3][3] = {{0, 0, 0}, {1, 0, 0.75}, {0, 1, 0.5}};
  for (int k = 0; k < 3; k++)
    for (int way = 1; way < 3; way++) {
      int l = (k + way) % 3, m = (k + 3 - way) % 3;
      assert_int_equal(tet_widest_axis(needle[k], needle[l], needle[m]), 2);
      assert_int_equal(tet_widest_axis(diagonal[k], diagonal[l], diagonal[m]), 0);
      assert_int_equal(tet_widest_axis(steep[k], steep[l], steep[m]), 2);
    }
}

static double random_length(int spread) { return ldexp((double)rand() / RAND_MAX - 0.5, rand() % (2 * spread + 1) - spread); }

/* Of a tetrahedron of any lengths, the circumradius and the angles do not depend on which vertex one begins with. */
static void the_order_of_vertices_does_not_count(void **state) {
  (void)state;
  srand(1);
  for (int run = 0; run < 3000; run++) {
    double x[4][3], radius[12], cosine[12][16];
    for (int i = 0; i < 12; i++) x[i / 3][i % 3] = random_length(1 + run % 120);
    for (int k = 0; k < 12; k++) {
      const double *v[4];
      double n[4][3];
      for (int i = 0; i < 4; i++) v[i] = x[even[k][i]];
      tet_exact_shape s = tet_shape_exactly(v);
      const double *t = s.to_centre;
      radius[k] = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]) / fabs(s.volume6);
      tet_normals_exactly(v, n);
      for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
          double ij = n[i][0] * n[j][0] + n[i][1] * n[j][1] + n[i][2] * n[j][2];
          double ii = n[i][0] * n[i][0] + n[i][1] * n[i][1] + n[i][2] * n[i][2];
          double jj = n[j][0] * n[j][0] + n[j][1] * n[j][1] + n[j][2] * n[j][2];
          cosine[k][4 * even[k][i] + even[k][j]] = ij / sqrt(ii * jj);
        }
    }
    for (int k = 1; k < 12; k++) {
      assert_true(fabs(radius[k] - radius[0]) <= 1e-14 * radius[0]);
      for (int i = 0; i < 16; i++) assert_true(fabs(cosine[k][i] - cosine[0][i]) <= 1e-14);
    }
  }
}

/* Of two sides nearly along one line, one of them so short that its square is no double. */
static void a_unit_normal_does_not_know_lengths(void **unused) {
  (void)unused;
  const double a[3] = {0, 0, 0}, c[3] = {0x1.3p500, 0x1.7p499, 0x1.1p500};
  double b[3], short_b[3], n[3], of_short[3];
  for (int k = 0; k < 3; k++) b[k] = c[k] * (1 + (k - 1) * 0x1p-50) / 3;
  for (int k = 0; k < 3; k++) short_b[k] = b[k] * 0x1p-1050;
  tet_unit_normal(a, b, c, n);
  tet_unit_normal(a, short_b, c, of_short);
  for (int k = 0; k < 3; k++) assert_true(fabs(n[k] - of_short[k]) <= 1e-14);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(known_ones_are_found),
                                     cmocka_unit_test(a_triangle_is_seen_along_one_axis),
                                     cmocka_unit_test(a_unit_normal_does_not_know_lengths),
                                     cmocka_unit_test(the_order_of_vertices_does_not_count)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
