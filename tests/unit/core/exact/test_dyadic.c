// SPDX-License-Identifier: Apache-2.0
// Dyadic arithmetic: against 128-bit integers, against identities on long numbers,
// and conversions from and to doubles at both ends of their range.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "exact/dyadic.h"

__extension__ typedef __int128 int128;

static uint64_t next_random(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return *state;
}

/* Any finite double: all exponents, denormals and zeros included. */
static double any_double(uint64_t *state) {
  for (;;) {
    uint64_t bits = next_random(state);
    if (next_random(state) % 8 == 0)
      bits &= ~(UINT64_C(0x7ff) << 52); /* denormal */
    if (next_random(state) % 16 == 0)
      bits &= UINT64_C(1) << 63; /* zero */
    double x;
    memcpy(&x, &bits, sizeof x);
    if (isfinite(x))
      return x;
  }
}

static double small_integer(uint64_t *state) {
  int64_t x = (int64_t)(next_random(state) % (UINT64_C(1) << 53)) - (INT64_C(1) << 52);
  return (double)(x >> next_random(state) % 53);
}

static int128 to_int128(const tet_dyadic *a) {
  assert_true(a->n <= 2 && a->exp == 0);
  tet_uint128 m = 0;
  for (uint32_t i = a->n; i-- > 0;)
    m = m << 64 | a->limb[i];
  return a->sign < 0 ? -(int128)m : (int128)m;
}

static int is_normal(const tet_dyadic *a) {
  if (a->sign == 0)
    return a->n == 0;
  return (a->sign == 1 || a->sign == -1) && a->n > 0 && a->limb[a->n - 1] != 0;
}

static tet_dyadic reduced(tet_dyadic_space *w, double x) {
  return tet_dyadic_from_double_reduced(w, x);
}

static int same(tet_dyadic_space *w, tet_dyadic a, tet_dyadic b) {
  assert_true(is_normal(&a) && is_normal(&b));
  return tet_dyadic_sub(w, a, b).sign == 0;
}

static void test_against_int128(void **unused) {
  (void)unused;
  static tet_dyadic_space w;
  uint64_t state = 1;
  for (int i = 0; i < 100000; i++) {
    tet_dyadic_begin(&w);
    double x = small_integer(&state), y = small_integer(&state), z = small_integer(&state);
    tet_dyadic a = tet_dyadic_from_double(&w, x, 0), b = tet_dyadic_from_double(&w, y, 0);
    tet_dyadic c = tet_dyadic_from_double(&w, z, 0);
    int128 ia = (int128)x, ib = (int128)y, ic = (int128)z;
    tet_dyadic ab = tet_dyadic_mul(&w, a, b);
    tet_dyadic sum = tet_dyadic_add(&w, ab, c), difference = tet_dyadic_sub(&w, c, ab);
    assert_true(is_normal(&ab) && is_normal(&sum) && is_normal(&difference));
    assert_true(to_int128(&ab) == ia * ib);
    assert_true(to_int128(&sum) == ia * ib + ic);
    assert_true(to_int128(&difference) == ic - ia * ib);
    assert_int_equal(tet_dyadic_neg(sum).sign, -sum.sign);
  }
}

static void test_identities(void **unused) {
  (void)unused;
  static tet_dyadic_space w;
  uint64_t state = 2;
  for (int i = 0; i < 20000; i++) {
    tet_dyadic_begin(&w);
    tet_dyadic x[4];
    for (int k = 0; k < 4; k++) {
      /* a product of up to three doubles plus another */
      x[k] = reduced(&w, any_double(&state));
      for (uint64_t m = next_random(&state) % 3; m > 0; m--) {
        x[k] = tet_dyadic_mul(&w, x[k], reduced(&w, any_double(&state)));
      }
      if (i % 2)
        x[k] = tet_dyadic_add(&w, x[k], reduced(&w, any_double(&state)));
    }
    tet_dyadic a = x[0], b = x[1], c = x[2], d = x[3];
    /* (a + b) (c + d) == a c + a d + b c + b d */
    tet_dyadic left = tet_dyadic_mul(&w, tet_dyadic_add(&w, a, b), tet_dyadic_add(&w, c, d));
    tet_dyadic right = tet_dyadic_add(&w, tet_dyadic_mul(&w, a, c), tet_dyadic_mul(&w, a, d));
    right = tet_dyadic_add(&w, right, tet_dyadic_mul(&w, b, c));
    right = tet_dyadic_add(&w, right, tet_dyadic_mul(&w, b, d));
    assert_true(same(&w, left, right));
    /* a - (a - b) == b, (a b) c == a (b c), a b == b a */
    assert_true(same(&w, tet_dyadic_sub(&w, a, tet_dyadic_sub(&w, a, b)), b));
    assert_true(same(&w, tet_dyadic_mul(&w, tet_dyadic_mul(&w, a, b), c),
                     tet_dyadic_mul(&w, a, tet_dyadic_mul(&w, b, c))));
    assert_true(same(&w, tet_dyadic_mul(&w, a, b), tet_dyadic_mul(&w, b, a)));
    assert_true(w.top <= w.limb + TET_DYADIC_SPACE);
  }
}

/* Carries through every limb, and cancellation to one bit. */
static void test_carries(void **unused) {
  (void)unused;
  static tet_dyadic_space w;
  tet_dyadic_begin(&w);
  tet_dyadic one = reduced(&w, 1), huge = reduced(&w, 0x1p1000);
  tet_dyadic below = tet_dyadic_sub(&w, huge, one); /* 1000 ones */
  assert_int_equal(below.n, 16);
  tet_dyadic above = tet_dyadic_add(&w, below, one);
  assert_true(same(&w, above, huge));
  tet_dyadic difference = tet_dyadic_sub(&w, huge, below);
  assert_int_equal(difference.n, 1);
  assert_int_equal(difference.limb[0], 1);
  /* (2^1000 - 1)^2 == 2^2000 - 2^1001 + 1 */
  tet_dyadic square = tet_dyadic_mul(&w, below, below);
  tet_dyadic expected = tet_dyadic_mul(&w, huge, huge);
  expected = tet_dyadic_sub(&w, expected, tet_dyadic_add(&w, huge, huge));
  expected = tet_dyadic_add(&w, expected, one);
  assert_true(same(&w, square, expected));
}

static void check_there_and_back(double x) {
  static tet_dyadic_space w;
  tet_dyadic_begin(&w);
  tet_dyadic a = reduced(&w, x);
  assert_true(is_normal(&a));
  assert_true(tet_dyadic_to_double(&a) == x);
  assert_int_equal(a.sign, (x > 0) - (x < 0));
  tet_dyadic b = tet_dyadic_from_double(&w, x, -1074);
  assert_true(is_normal(&b) && b.exp == -1074);
  assert_true(tet_dyadic_to_double(&b) == x);
  assert_true(same(&w, a, b));
}

static void test_conversion(void **unused) {
  (void)unused;
  uint64_t state = 3;
  const double special[] = {
      0,       -0.0,       1, -1, DBL_MIN, DBL_MAX, -DBL_MAX, DBL_TRUE_MIN, 0x1.fffffffffffffp-1023,
      0x1p500, 0x1.8p-1073};
  for (size_t i = 0; i < sizeof special / sizeof *special; i++)
    check_there_and_back(special[i]);
  for (int i = 0; i < 20000; i++)
    check_there_and_back(any_double(&state));
}

/* The sum of two doubles is rounded by the processor as tet_dyadic_to_double does. */
static void test_rounding(void **unused) {
  (void)unused;
  static tet_dyadic_space w;
  uint64_t state = 4;
  for (int i = 0; i < 100000; i++) {
    tet_dyadic_begin(&w);
    double x = any_double(&state);
    double y = i % 2 ? any_double(&state) : x * 0x1p-54 * (double)(next_random(&state) % 9);
    tet_dyadic sum = tet_dyadic_add(&w, reduced(&w, x), reduced(&w, y));
    assert_true(tet_dyadic_to_double(&sum) == x + y);
    double p = ldexp((double)(next_random(&state) >> 11), -560);
    double q = ldexp((double)(next_random(&state) >> 11), -(int)(next_random(&state) % 600));
    tet_dyadic product = tet_dyadic_mul(&w, reduced(&w, p), reduced(&w, q));
    assert_true(tet_dyadic_to_double(&product) == p * q);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_against_int128), cmocka_unit_test(test_identities),
      cmocka_unit_test(test_carries),        cmocka_unit_test(test_conversion),
      cmocka_unit_test(test_rounding),
  };
  return cmocka_run_group_tests(tests, 0, 0);
}
