// SPDX-License-Identifier: Apache-2.0
/* The first look of the hot loops never contradicts exact arithmetic: on points spread, on few
 * values, on a sphere, in a plane, nearly so, with scales far apart, near overflow and underflow; in
 * plain code and, where the processor has it, on AVX2; knowing the grain of coordinates or not; also
 * of implicit points as they are rounded. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "exact/exact_stage.h"
#include "exact/predicates.h"
#include "exact/quick.h"
#include "point_sets.h"

enum { ROUNDS = 60000, KINDS = 9 };

static double between(uint64_t *s, double low, double high) { return low + (high - low) * point_set_uniform(s); }

/* Five points of a kind. */
static void draw(uint64_t *s, int kind, double x[15]) {
  double scale = kind == 5 ? ldexp(1, (int)(point_set_next(s) % 400) - 200) : 1;
  for (int i = 0; i < 5; i++) {
    double *p = x + 3 * i;
    for (int k = 0; k < 3; k++) p[k] = kind == 1 ? (double)(point_set_next(s) % 5) : between(s, -1, 1);
    if (kind == 2 || kind == 6) {
      double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
      for (int k = 0; k < 3; k++) p[k] /= kind == 2 ? r : r * (1 + 1e-13 * between(s, -1, 1));
    }
    if (kind == 3) p[2] = 0.1 * p[0] + 0.3 * p[1];
    if (kind == 4) p[2] = 1e-15 * p[2] + p[0];
    if (kind == 7) /* one near, the others far */
      for (int k = 0; k < 3; k++) p[k] *= ldexp(1, -10 * i);
    if (kind == 8) /* magnitudes all over the accepted range, so that partial products underflow */
      for (int k = 0; k < 3; k++) p[k] = ldexp(round(4 * p[k]), (int)(point_set_next(s) % 1080) - 600);
    for (int k = 0; k < 3; k++) p[k] *= scale;
  }
}

static int exact_insphere(const double x[15]) {
  const tet_point_ref ref[5] = {tet_ref_xyz(x), tet_ref_xyz(x + 3), tet_ref_xyz(x + 6), tet_ref_xyz(x + 9),
                                tet_ref_xyz(x + 12)};
  return tet_exact_insphere(ref);
}

static int exact_orient3d(const double x[15]) {
  const tet_point_ref ref[4] = {tet_ref_xyz(x), tet_ref_xyz(x + 3), tet_ref_xyz(x + 6), tet_ref_xyz(x + 9)};
  return tet_exact_orient3d(ref);
}

static int exact_dot(const double x[15]) {
  const tet_point_ref ref[3] = {tet_ref_xyz(x), tet_ref_xyz(x + 3), tet_ref_xyz(x + 6)};
  return tet_exact_dot_sign(ref);
}

/* Counts what is unsure; fails on what is wrong. */
static void check(int sign, int exact, uint32_t *unsure) {
  if (sign == TET_UNSURE) ++*unsure;
  else assert_int_equal(sign, exact);
}

static void quick_signs_are_right(void **state) {
  (void)state;
  uint64_t s = 4711;
  print_message("seed 4711\n");
  for (int kind = 0; kind < KINDS; kind++) {
    uint32_t unsure[5] = {0};
    for (int round = 0; round < ROUNDS; round++) {
      double x[15];
      draw(&s, kind, x);
      tet_points points = tet_points_explicit(x, 5);
      if (round & 1) tet_points_find_grain(&points);
      int inside = exact_insphere(x), side = exact_orient3d(x);
      check(tet_quick_insphere(x, x + 3, x + 6, x + 9, x + 12, points.grain5), inside, &unsure[0]);
      check(tet_quick_orient3d(x, x + 3, x + 6, x + 9, points.grain3), side, &unsure[1]);
      tet_quick_plane plane = tet_quick_plane_of(x, x + 3, x + 6);
      check(tet_quick_side(&plane, x + 9), side, &unsure[2]);
      check(tet_quick_dot(x, x + 3, x + 6), exact_dot(x), &unsure[4]);
#if TET_HAVE_AVX2
      if (tet_has_avx2())
        check(tet_quick_insphere_avx2(x, x + 3, x + 6, x + 9, x + 12, points.grain5), inside, &unsure[3]);
#endif
    }
    print_message("kind %d: unsure of insphere %u, orient3d %u, side %u, insphere on AVX2 %u, dot %u of %d\n", kind, unsure[0],
                  unsure[1], unsure[2], unsure[3], unsure[4], ROUNDS);
    if (kind == 0 || kind == 7)
      assert_true(unsure[0] + unsure[1] + unsure[2] + unsure[3] + unsure[4] < ROUNDS / 1000);
    if (kind == 1) assert_true(unsure[0] < ROUNDS / 2); /* with the grain ties are known */
  }
}

/* Five points nearly on a sphere or in a plane, `far` from the origin, off it by 1 to 2^10 times what rounding moves
 * them; those from `first` on implicit: between ends beside them. */
static void draw_implicit(uint64_t *s, int flat, double far, uint32_t first, double x[45], tet_segment_point at[5]) {
  for (uint32_t i = 0; i < 5; i++) {
    double p[3], v[3], r = 0, noise = far * ldexp(between(s, -1, 1), (int)(point_set_next(s) % 11) - 53);
    for (int k = 0; k < 3; k++) {
      p[k] = between(s, -1, 1);
      v[k] = between(s, -1, 1);
      r += p[k] * p[k];
    }
    for (int k = 0; k < 3; k++) p[k] = far + (flat ? p[k] : p[k] / sqrt(r) * (1 + noise));
    if (flat) p[2] = far + 0.5 * (p[0] - far) - 0.25 * (p[1] - far) + noise;
    for (int k = 0; k < 3; k++) {
      x[3 * i + (uint32_t)k] = p[k];
      x[15 + 6 * i + (uint32_t)k] = p[k] - v[k];
      x[18 + 6 * i + (uint32_t)k] = p[k] + v[k];
    }
    at[i] = (tet_segment_point){5 + 2 * i, 6 + 2 * i, 0.5 + 0x1p-40 * between(s, -1, 1)};
    if (i < first) continue;
    const tet_points ends = tet_points_explicit(x, 15);
    tet_segment_point_round(&ends, &at[i], x + 3 * i);
  }
}

static void rounded_implicit_points_do_not_mislead(void **state) {
  (void)state;
  uint64_t s = 815;
  print_message("seed 815\n");
  for (int flat = 0; flat < 2; flat++)
    for (int power = 0; power <= 50; power += 5) {
      uint32_t unsure[2] = {0};
      for (int round = 0; round < ROUNDS / 10; round++) {
        double x[45];
        tet_segment_point at[5];
        uint32_t first = (uint32_t)(point_set_next(&s) % 5);
        draw_implicit(&s, flat, ldexp(1, power), first, x, at);
        const double *const rounded[5] = {x, x + 3, x + 6, x + 9, x + 12};
        tet_point_ref ref[5];
        for (uint32_t i = 0; i < 5; i++)
          ref[i] = i < first ? tet_ref_xyz(rounded[i])
                             : (tet_point_ref){x + 3 * (size_t)at[i].a, x + 3 * (size_t)at[i].b, at[i].t};
        check(tet_quick_insphere_moved(rounded), tet_exact_insphere(ref), &unsure[0]);
        check(tet_quick_orient3d_moved(rounded), tet_exact_orient3d(ref), &unsure[1]);
      }
      print_message("%s, 2^%d away: unsure of insphere %u, orient3d %u of %d\n", flat ? "flat" : "round", power, unsure[0],
                    unsure[1], ROUNDS / 10);
      if (power <= 40) assert_true(unsure[flat] > ROUNDS / 100 && unsure[flat] < ROUNDS * 99 / 1000); /* at the brink */
    }
}

/* Products of very short rows and very long ones: the bound must not vanish before the value. */
static void short_rows_are_unsure(void **state) {
  (void)state;
  const double plane[15] = {-0x1p-299,  0x1.8p-299,  0, -0x1.4p-538, 0x1.8p-538, -0x1p-539,
                            -0x1p-539, -0x1.8p-539, -0x1.8p-539, -0x1.8p+481, 0, -0x1p+480};
  const double sphere[15] = {-0x1.8p201, 0x1p200,   -0x1p202,  -0x1p-537, 0x1p-538, 0, -0x1p482, 0x1.8p482, -0x1p480,
                             0x1p-600,   -0x1p-599, -0x1p-597, 0,         0,        0};
  const double *x = plane;
  assert_int_equal(tet_orient3d_xyz(x, x + 3, x + 6, x + 9), exact_orient3d(x));
  x = sphere;
  assert_int_equal(tet_insphere_xyz(x, x + 3, x + 6, x + 9, x + 12), exact_insphere(x));
}

/* Where nothing can be known nothing is claimed. */
static void extremes_are_unsure(void **state) {
  (void)state;
  static const double scales[] = {0x1p400, 0x1p250, 0x1p-400, 0x1p-1000, 0};
  const double unit[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.3, 0.3, 0.3};
  for (int i = 0; i < 5; i++) {
    double x[15];
    for (int k = 0; k < 15; k++) x[k] = unit[k] * scales[i];
    int exact = exact_insphere(x), sign = tet_quick_insphere(x, x + 3, x + 6, x + 9, x + 12, 0);
    assert_true(sign == TET_UNSURE || sign == exact);
    sign = tet_quick_orient3d(x, x + 3, x + 6, x + 9, 0);
    assert_true(sign == TET_UNSURE || sign == exact_orient3d(x));
    sign = tet_quick_dot(x + 3, x + 6, x);
    assert_true(sign == TET_UNSURE || sign == exact_dot((const double[15]){scales[i], 0, 0, 0, scales[i]}));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(quick_signs_are_right),
                                     cmocka_unit_test(rounded_implicit_points_do_not_mislead),
                                     cmocka_unit_test(short_rows_are_unsure),
                                     cmocka_unit_test(extremes_are_unsure)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
