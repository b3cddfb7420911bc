// SPDX-License-Identifier: Apache-2.0
/* Shares of one tetrahedron and of one triangle: known ones, the two sums that hold for
 * every shape, and almost flat ones, whose circumcentres are lost in doubles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "base/vector.h"
#include "dual/shares.h"

static const uint32_t four[4] = {0, 1, 2, 3};
static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}; /* outward */

static double unit_random(uint64_t *state) { /* splitmix64 */
  uint64_t x = *state += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static double volume6(const double *x) {
  double a[3], b[3], c[3], bc[3];
  tet_minus(x + 3, x, a);
  tet_minus(x + 6, x, b);
  tet_minus(x + 9, x, c);
  tet_cross(b, c, bc);
  return tet_dot(a, bc);
}

/* Both sums of shares.h, to `slack` of what cancels in them. */
static void check_sums(const double *x, double slack) {
  tet_shares s;
  double volume = 0, flux[4][3] = {{0}}, size = 0, largest = 0;
  assert_true(tet_shares_of(x, four, &s));
  for (int e = 0; e < 6; e++) {
    int i = tet_edge[e][0], j = tet_edge[e][1];
    double d[3];
    tet_minus(x + 3 * j, x + 3 * i, d);
    volume += tet_dot(d, d) * s.edge[e] / 3;
    size = fmax(size, sqrt(tet_dot(d, d)));
    largest = fmax(largest, fabs(s.edge[e]));
    for (int k = 0; k < 3; k++) {
      flux[i][k] += s.edge[e] * d[k];
      flux[j][k] -= s.edge[e] * d[k];
    }
  }
  for (int f = 0; f < 4; f++) {
    const double *p[3] = {x + 3 * face[f][0], x + 3 * face[f][1], x + 3 * face[f][2]};
    double share[3], u[3], w[3], n[3];
    tet_corner_shares(p[0], p[1], p[2], share, NULL);
    tet_minus(p[1], p[0], u);
    tet_minus(p[2], p[0], w);
    tet_cross(u, w, n);
    double area2 = sqrt(tet_dot(n, n));
    assert_true(fabs(share[0] + share[1] + share[2] - area2 / 2) <= slack * size * size);
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 3; k++) flux[face[f][c]][k] += share[c] * n[k] / area2;
  }
  assert_true(fabs(volume - volume6(x) / 6) <= slack * size * size * (size + largest));
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) assert_true(fabs(flux[i][k]) <= slack * size * (size + largest));
}

static void known_shapes(void **state) {
  (void)state;
  /* The corner of a cube: its circumcentre is the cube's; the face opposite the corner cuts a part
   * off, which is the negative share of its edges. */
  const double corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double regular[12] = {1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1};
  tet_shares s;
  assert_true(tet_shares_of(corner, four, &s));
  for (int e = 0; e < 3; e++) assert_true(fabs(s.edge[e] - 0.25) < 1e-15);
  for (int e = 3; e < 6; e++) assert_true(fabs(s.edge[e] + 1.0 / 24) < 1e-15);
  for (int k = 0; k < 3; k++) assert_true(fabs(s.centre[k] - 0.5) < 1e-15);
  assert_true(tet_shares_of(regular, four, &s));
  for (int e = 0; e < 6; e++) assert_true(fabs(s.edge[e] - 1.0 / 6) < 1e-15);
  const uint32_t reversed[4] = {1, 0, 2, 3};
  s.bound = -7;
  assert_false(tet_shares_of(corner, reversed, &s));
  assert_true(s.bound == -7);
}

static void triangles(void **state) {
  (void)state;
  double a[3] = {5, 5, 5}, b[3] = {7, 5, 5}, c[3] = {5, 7, 5}, share[3], centre[3];
  tet_corner_shares(a, b, c, share, centre);
  assert_true(fabs(share[0] - 1) < 1e-15 && fabs(share[1] - 0.5) < 1e-15 && fabs(share[2] - 0.5) < 1e-15);
  assert_true(centre[0] == 6 && centre[1] == 6 && centre[2] == 5);
  double d[3] = {6, 5.5, 5}; /* blunt: what lies beyond ab counts against a and b's neighbour */
  tet_corner_shares(a, b, d, share, centre);
  assert_true(fabs(share[0] + share[1] + share[2] - 0.5) < 1e-15);
  assert_true(share[2] > 0.5 && share[0] < 0);
  assert_true(fabs(centre[0] - 6) < 1e-15 && fabs(centre[1] - 4.25) < 1e-15);
}

static void sums_hold(void **state) {
  (void)state;
  uint64_t seed = 11;
  for (int i = 0; i < 20000; i++) {
    double x[12], flatness = i % 4 ? ldexp(1, -(i % 50)) : 1, offset = i % 3 ? 0 : 1000;
    for (int k = 0; k < 12; k++) x[k] = unit_random(&seed) * (k % 3 == 2 ? flatness : 1) + offset;
    if (volume6(x) < 0)
      for (int k = 0; k < 3; k++) {
        double t = x[k];
        x[k] = x[3 + k];
        x[3 + k] = t;
      }
    if (volume6(x) > 0x1p-40 * flatness) check_sums(x, 1e-12);
  }
}

/* Four points of a circle, one of them lifted off the plane by units in the last place: the centre is on
 * the circle's axis, half as high. A power of two changes no bit of the shares. */
static void almost_flat(void **state) {
  (void)state;
  for (int lift = 1; lift < 4; lift++) {
    double z = lift * 0x1p-52, x[12] = {3, 4, 1, -3, 4, 1, -4, -3, 1, 4, -3, 1 + z}, scaled[12];
    if (volume6(x) < 0)
      for (int k = 0; k < 3; k++) {
        double t = x[k];
        x[k] = x[3 + k];
        x[3 + k] = t;
      }
    tet_shares s, t;
    check_sums(x, 1e-15);
    assert_true(tet_shares_of(x, four, &s));
    assert_true(fabs(s.centre[0] + x[0]) < 1e-14 && fabs(s.centre[1] + x[1]) < 1e-14);
    assert_true(fabs(s.centre[2] - z / 2) <= 0x1p-100);
    for (int e = -400; e <= 400; e += 50) {
      for (int k = 0; k < 12; k++) scaled[k] = ldexp(x[k], e);
      assert_true(tet_shares_of(scaled, four, &t));
      for (int k = 0; k < 6; k++) assert_true(t.edge[k] == ldexp(s.edge[k], e));
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(known_shapes), cmocka_unit_test(triangles),
                                     cmocka_unit_test(sums_hold), cmocka_unit_test(almost_flat)};
  return cmocka_run_group_tests_name("shares", tests, NULL, NULL);
}
