// SPDX-License-Identifier: Apache-2.0
/* The first look of the hot loops never contradicts exact arithmetic: on points spread, on few
 * values, on a sphere, in a plane, nearly so, with scales far apart, near overflow and underflow; in
 * plain code and, where the processor has it, on AVX2; knowing the grain of coordinates or not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "exact/exact_stage.h"
#include "exact/quick.h"
#include "point_sets.h"

enum { ROUNDS = 60000, KINDS = 8 };

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
    uint32_t unsure[4] = {0};
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
#if TET_HAVE_AVX2
      if (tet_has_avx2())
        check(tet_quick_insphere_avx2(x, x + 3, x + 6, x + 9, x + 12, points.grain5), inside, &unsure[3]);
#endif
    }
    print_message("kind %d: unsure of insphere %u, orient3d %u, side %u, insphere on AVX2 %u of %d\n", kind, unsure[0],
                  unsure[1], unsure[2], unsure[3], ROUNDS);
    if (kind == 0 || kind == 7) assert_true(unsure[0] + unsure[1] + unsure[2] + unsure[3] < ROUNDS / 1000);
    if (kind == 1) assert_true(unsure[0] < ROUNDS / 2); /* with the grain ties are known */
  }
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
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(quick_signs_are_right), cmocka_unit_test(extremes_are_unsure)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
