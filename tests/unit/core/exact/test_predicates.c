// SPDX-License-Identifier: Apache-2.0
// Conventions, symmetry and degenerate answers of the predicates. Values on random
// input are compared with rational arithmetic in tests/property/core/exact.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "exact/predicates.h"

static uint64_t next_random(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return *state;
}

static uint32_t below(uint64_t *state, uint32_t n) {
  return (uint32_t)(next_random(state) % n);
}

static tet_points view(double *x, uint32_t n) {
  return (tet_points){.x = x, .n = n, .first_implicit = n, .implicit = 0, .max_abs = 0};
}

static void test_conventions(void **unused) {
  (void)unused;
  double x[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, .25, .25, .25, 1, 1, 1, 2, 2, 2};
  tet_points p = view(x, 7);
  assert_int_equal(tet_orient3d(&p, 0, 1, 2, 3), 1);
  assert_int_equal(tet_orient3d(&p, 1, 0, 2, 3), -1);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 3, 4), 1);
  assert_int_equal(tet_insphere(&p, 1, 0, 2, 3, 4), -1);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 3, 5), 0);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 3, 6), -1);
  assert_int_equal(tet_insphere_sos(&p, 0, 1, 2, 3, 4), 1);
  assert_int_equal(tet_insphere_sos(&p, 0, 1, 2, 3, 5), -1); /* the largest number leaves */
  for (int axis = 0; axis < 3; axis++) {                     /* cyclic unit vectors turn left */
    uint32_t i = 1 + (uint32_t)(axis + 1) % 3, j = 1 + (uint32_t)(axis + 2) % 3;
    assert_int_equal(tet_orient2d(&p, axis, 0, i, j), 1);
    assert_int_equal(tet_orient2d(&p, axis, 0, j, i), -1);
    assert_int_equal(tet_orient2d(&p, axis, 0, 1 + (uint32_t)axis, j), 0);
  }
  assert_int_equal(tet_collinear(&p, 0, 4, 5), 1);
  assert_int_equal(tet_collinear(&p, 0, 1, 5), 0);
  assert_int_equal(tet_collinear(&p, 3, 3, 1), 1);
  assert_int_equal(tet_dot_sign(&p, 1, 2, 0), 0);
  assert_int_equal(tet_dot_sign(&p, 0, 5, 4), -1); /* inside the ball of 0 5 */
  assert_int_equal(tet_dot_sign(&p, 0, 4, 6), 1);
  assert_int_equal(tet_compare_distance(&p, 0, 1, 2), 0);
  assert_int_equal(tet_compare_distance(&p, 0, 5, 4), 1);
  assert_int_equal(tet_in_diametric_ball3(&p, 0, 1, 2, 4), 1);
  assert_int_equal(tet_in_diametric_ball3(&p, 0, 1, 2, 3), -1);
  assert_int_equal(tet_in_diametric_ball3(&p, 0, 1, 2, 2), 0);
  assert_int_equal(tet_in_diametric_ball3(&p, 0, 4, 5, 1), 0); /* no triangle */
}

/* Sets with many ties: the corners of cubes, then the same with implicit points. */
typedef struct tied {
  double x[3 * 40];
  tet_segment_point implicit[13];
  tet_points p;
} tied;

static void make_tied(tied *t) {
  for (uint32_t i = 0; i < 27; i++) {
    t->x[3 * i] = i % 3;
    t->x[3 * i + 1] = i / 3 % 3;
    t->x[3 * i + 2] = i / 9;
  }
  t->p =
      (tet_points){.x = t->x, .n = 40, .first_implicit = 27, .implicit = t->implicit, .max_abs = 2};
  for (uint32_t i = 0; i < 13; i++) { /* through the centre; half of them at a third */
    t->implicit[i] = (tet_segment_point){i, 26 - i, i % 2 ? 1.0 / 3 : 0.25};
    tet_segment_point_round(&t->p, &t->implicit[i], t->x + 3 * (27 + i));
  }
}

static int parity(const int q[5]) {
  int sign = 1;
  for (int i = 0; i < 5; i++) {
    for (int j = i + 1; j < 5; j++) {
      if (q[i] > q[j])
        sign = -sign;
    }
  }
  return sign;
}

/* Calls check for all 120 permutations of five places. */
static void for_all_permutations(void (*check)(const int q[5], void *context), void *context) {
  for (int code = 0; code < 5 * 5 * 5 * 5 * 5; code++) {
    int q[5], used = 0;
    for (int i = 0, rest = code; i < 5; i++, rest /= 5) {
      q[i] = rest % 5;
      used |= 1 << q[i];
    }
    if (used == 31)
      check(q, context);
  }
}

typedef struct five {
  const tet_points *p;
  uint32_t v[5];
  int plain, perturbed;
} five;

static void check_permutation(const int q[5], void *context) {
  const five *f = context;
  const uint32_t *v = f->v;
  int s = parity(q);
  assert_int_equal(tet_insphere(f->p, v[q[0]], v[q[1]], v[q[2]], v[q[3]], v[q[4]]), s * f->plain);
  assert_int_equal(tet_insphere_sos(f->p, v[q[0]], v[q[1]], v[q[2]], v[q[3]], v[q[4]]),
                   s * f->perturbed);
}

static void test_antisymmetry(void **unused) {
  (void)unused;
  static tied t;
  make_tied(&t);
  uint64_t state = 11;
  int ties = 0, zeros = 0;
  for (int i = 0; i < 400; i++) {
    five f = {.p = &t.p};
    uint32_t n = i % 2 ? 40 : 27;
    for (int k = 0; k < 5; k++)
      f.v[k] = below(&state, n);
    const uint32_t *v = f.v;
    f.plain = tet_insphere(&t.p, v[0], v[1], v[2], v[3], v[4]);
    f.perturbed = tet_insphere_sos(&t.p, v[0], v[1], v[2], v[3], v[4]);
    if (f.plain)
      assert_int_equal(f.plain, f.perturbed);
    ties += !f.plain;
    zeros += !f.perturbed;
    for_all_permutations(check_permutation, &f);
  }
  assert_true(ties > 50 && zeros > 5 && zeros < ties); /* the cases were worth it */
}

/* 0 exactly where all five are coplanar or a number repeats. */
static void test_perturbation_is_decisive(void **unused) {
  (void)unused;
  static tied t;
  make_tied(&t);
  uint64_t state = 12;
  for (int i = 0; i < 20000; i++) {
    uint32_t v[5];
    int repeats = 0, coplanar = 1;
    for (int k = 0; k < 5; k++) {
      v[k] = below(&state, 40);
      for (int j = 0; j < k; j++)
        repeats |= v[j] == v[k];
    }
    for (int k = 0; k < 5; k++) {
      if (tet_orient3d(&t.p, v[k], v[(k + 1) % 5], v[(k + 2) % 5], v[(k + 3) % 5]))
        coplanar = 0;
    }
    int sign = tet_insphere_sos(&t.p, v[0], v[1], v[2], v[3], v[4]);
    assert_int_equal(sign == 0, repeats || coplanar);
  }
}

/* The perturbed weights behave as real ones: of the two triangulations of five points
 * with ties, insphere_sos calls exactly one Delaunay. With d and e on opposite sides
 * of abc, e in the sphere of abcd is equivalent to d in the sphere of abce. */
static void test_perturbation_is_consistent(void **unused) {
  (void)unused;
  static tied t;
  make_tied(&t);
  uint64_t state = 13;
  int checked = 0;
  for (int i = 0; i < 20000; i++) {
    uint32_t v[5];
    for (int k = 0; k < 5; k++)
      v[k] = below(&state, 40);
    if (tet_orient3d(&t.p, v[0], v[1], v[2], v[3]) <= 0)
      continue;
    if (tet_orient3d(&t.p, v[0], v[1], v[2], v[4]) >= 0)
      continue;
    int e_in = tet_insphere_sos(&t.p, v[0], v[1], v[2], v[3], v[4]);
    int d_in = tet_insphere_sos(&t.p, v[1], v[0], v[2], v[4], v[3]);
    assert_int_equal(e_in, d_in);
    checked++;
  }
  assert_true(checked > 1000);
}

/* Implicit points between vertices of one skew plane are in it, not merely near it,
 * though their rounded coordinates are not. */
static void test_implicit_on_facet(void **unused) {
  (void)unused;
  enum { N = 20, M = 40 };
  static double x[3 * (N + M)];
  static tet_segment_point implicit[M];
  uint64_t state = 14;
  tet_points p = {.x = x, .n = N + M, .first_implicit = N, .implicit = implicit, .max_abs = 0};
  for (uint32_t i = 0; i < N; i++) {
    double u = ldexp(below(&state, 1u << 24), -20), v = ldexp(below(&state, 1u << 24), -20);
    x[3 * i] = u;
    x[3 * i + 1] = v;
    x[3 * i + 2] = 3 * u - 5 * v + 0.125;
  }
  for (uint32_t i = 0; i < M; i++) {
    double s = ldexp((double)(next_random(&state) >> 11 | 1), -53);
    implicit[i] = (tet_segment_point){below(&state, N), below(&state, N), s};
    tet_segment_point_round(&p, &implicit[i], x + 3 * (N + i));
  }
  int rounded_off = 0;
  for (int i = 0; i < 5000; i++) {
    uint32_t v[4];
    for (int k = 0; k < 4; k++)
      v[k] = below(&state, N + M);
    assert_int_equal(tet_orient3d(&p, v[0], v[1], v[2], v[3]), 0);
    rounded_off += tet_orient3d_xyz(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]) != 0;
  }
  assert_true(rounded_off > 1000);
}

/* An implicit point lies on its segment, between the ends, in the order of t. */
static void test_implicit_on_segment(void **unused) {
  (void)unused;
  double x[3 * 6] = {0.1, 0.7, -0.3, 1e3, -1.0 / 3, 1e-7, 5, 5, 5};
  tet_segment_point implicit[3] = {{0, 1, 0.1}, {0, 1, 0.9}, {1, 0, 0.9}};
  tet_points p = {.x = x, .n = 6, .first_implicit = 3, .implicit = implicit, .max_abs = 1e3};
  for (uint32_t i = 0; i < 3; i++)
    tet_segment_point_round(&p, &implicit[i], x + 9 + 3 * i);
  assert_int_equal(tet_collinear(&p, 0, 1, 3), 1);
  assert_int_equal(tet_collinear(&p, 3, 4, 5), 1);
  assert_int_equal(tet_collinear(&p, 2, 3, 4), 0);
  assert_int_equal(tet_dot_sign(&p, 0, 1, 3), -1);
  assert_int_equal(tet_dot_sign(&p, 0, 3, 4), 1);
  assert_int_equal(tet_compare_distance(&p, 0, 3, 4), -1);
  /* 0.9 back from 1 is not 0.1 from 0, since 0.9 and 0.1 are rounded. */
  assert_int_not_equal(tet_compare_distance(&p, 0, 3, 5), 0);
  assert_int_equal(tet_compare_distance(&p, 0, 3, 3), 0);
}

/* What is known to be coplanar: of one plane, implicit points by both their ends, or three of one
 * segment. Here all of it is so, and nothing else. */
static void test_known_planes(void **unused) {
  (void)unused;
  /* a prism over triangle 0 1 2: planes 0 (bottom), 1 (top), 2, 3, 4 (sides) */
  double x[3 * 11] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  static const uint32_t start[7] = {0, 3, 6, 9, 12, 15, 18};
  static const uint32_t of[18] = {0, 2, 4, 0, 2, 3, 0, 3, 4, 1, 2, 4, 1, 2, 3, 1, 3, 4};
  static const tet_planes planes = {start, of};
  tet_segment_point implicit[5] = {{0, 1, 0.1}, {0, 1, 0.7}, {1, 4, 0.3}, {3, 5, 0.9}, {2, 5, 0.2}};
  tet_points p = {.x = x, .n = 11, .first_implicit = 6, .implicit = implicit, .max_abs = 1, .planes = &planes};
  for (uint32_t i = 0; i < 5; i++)
    tet_segment_point_round(&p, &implicit[i], x + 18 + 3 * i);
  tet_points unknowing = p;
  unknowing.planes = 0;
  int flat = 0;
  for (uint32_t i = 0; i < 11 * 11 * 11 * 11; i++) {
    const uint32_t v[4] = {i % 11, i / 11 % 11, i / 121 % 11, i / 1331};
    if (v[0] >= v[1] || v[1] >= v[2] || v[2] >= v[3])
      continue;
    int is_flat = tet_orient3d(&unknowing, v[0], v[1], v[2], v[3]) == 0;
    int is_known = tet_are_in_one_plane(&p, v), is_on_line = tet_are_in_one_plane(&unknowing, v);
    assert_true(is_flat || !is_known);
    assert_true(is_known || !is_on_line);
    assert_true(is_known || !is_flat || v[0] < 6); /* what is flat by chance has explicit vertices */
    flat += is_known;
  }
  assert_true(flat > 50);
  assert_true(tet_are_in_one_plane(&unknowing, (const uint32_t[4]){0, 6, 7, 5}));
  assert_true(tet_are_in_one_plane(&p, (const uint32_t[4]){2, 6, 7, 1}));
  assert_true(tet_are_in_one_plane(&p, (const uint32_t[4]){6, 8, 0, 4}));
  assert_false(tet_are_in_one_plane(&p, (const uint32_t[4]){6, 8, 9, 10}));
}

/* Products of differences underflow here; answers must not. */
static void test_underflow(void **unused) {
  (void)unused;
  for (int e = -1073; e <= -100; e += 7) {
    double s = ldexp(1, e);
    double x[] = {0, 0, 0, s, 0, 0, 0, s, 0, 0, 0, s, s, s, s, 3 * s, s, s};
    tet_points p = view(x, 6);
    assert_int_equal(tet_orient3d(&p, 0, 1, 2, 3), 1);
    assert_int_equal(tet_insphere(&p, 0, 1, 2, 3, 4), 0);
    assert_int_equal(tet_insphere(&p, 0, 1, 2, 3, 5), -1);
    assert_int_equal(tet_orient2d(&p, 2, 0, 1, 2), 1);
    assert_int_equal(tet_dot_sign(&p, 4, 5, 0), 1);
    assert_int_equal(tet_compare_distance(&p, 0, 5, 4), 1);
    assert_int_equal(tet_in_diametric_ball3(&p, 0, 1, 2, 5), -1);
  }
}

/* The least denormal decides beside coordinates whose grid cannot hold it. */
static void test_least_denormal(void **unused) {
  (void)unused;
  const double s = 0x1p100, tiny = 0x1p-1074;
  double x[] = {0, 0, 0, s, 0, 0, 0, s, 0, s, s, 0, s, s, tiny, s, s, -tiny, s, -s, s};
  tet_points p = view(x, 7);
  assert_int_equal(tet_orient3d(&p, 0, 1, 2, 3), 0);
  assert_int_equal(tet_orient3d(&p, 0, 1, 2, 4), 1);
  assert_int_equal(tet_orient3d(&p, 0, 1, 2, 5), -1);
  /* On the circle of the others but for the height, and so on or off the sphere that
   * hangs below them. */
  assert_int_equal(tet_orient3d(&p, 0, 1, 2, 6), 1);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 6, 3), 0);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 6, 4), 1);
  assert_int_equal(tet_insphere(&p, 0, 1, 2, 6, 5), -1);
}

/* One unit in the last place beside the least denormals: the longest numbers. */
static void test_extremes(void **unused) {
  (void)unused;
  const double big = TET_COORDINATE_LIMIT, tiny = 0x1p-1074;
  double x[3 * 10] = {big, tiny, -big, tiny, big, tiny, -big, -tiny, tiny, big, big, big};
  for (int k = 0; k < 3; k++)
    x[12 + k] = k == 1 ? nextafter(big, 0) : tiny;
  tet_segment_point implicit[5];
  tet_points p = {.x = x, .n = 10, .first_implicit = 5, .implicit = implicit, .max_abs = big};
  for (uint32_t i = 0; i < 5; i++) {
    implicit[i] = (tet_segment_point){i, (i + 1) % 5, i % 2 ? 0x1.fffffffffffffp-1 : tiny};
    tet_segment_point_round(&p, &implicit[i], x + 15 + 3 * i);
  }
  /* Antisymmetry is a check on values here: each call evaluates anew. */
  for (uint32_t base = 0; base <= 5; base += 5) {
    uint32_t a = base, b = base + 1, c = base + 2, d = base + 3, e = base + 4;
    int o = tet_orient3d(&p, a, b, c, d), s = tet_insphere(&p, a, b, c, d, e);
    assert_int_not_equal(o, 0);
    assert_int_not_equal(s, 0);
    assert_int_equal(tet_orient3d(&p, b, a, c, d), -o);
    assert_int_equal(tet_orient3d(&p, c, d, a, b), o);
    assert_int_equal(tet_insphere(&p, b, c, d, e, a), s);
    assert_int_equal(tet_insphere(&p, a, b, c, e, d), -s);
    assert_int_equal(tet_in_diametric_ball3(&p, a, b, c, d),
                     tet_in_diametric_ball3(&p, c, a, b, d));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_conventions),
      cmocka_unit_test(test_antisymmetry),
      cmocka_unit_test(test_perturbation_is_decisive),
      cmocka_unit_test(test_perturbation_is_consistent),
      cmocka_unit_test(test_implicit_on_facet),
      cmocka_unit_test(test_implicit_on_segment),
      cmocka_unit_test(test_known_planes),
      cmocka_unit_test(test_underflow),
      cmocka_unit_test(test_least_denormal),
      cmocka_unit_test(test_extremes),
  };
  return cmocka_run_group_tests(tests, 0, 0);
}
