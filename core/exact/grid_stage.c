// SPDX-License-Identifier: Apache-2.0
// The quick exact stage. Coordinates become integers below 2^60 by an exact scaling;
// with implicit points all of them are multiplied by 2^k, the common denominator of
// the parameters t, and stay below 2^123 for k <= 63. So coordinates have one limb or
// two, and every later width is known when compiling: for L limbs a coordinate, 2 L
// for a minor, 3 L for an orient3d, 5 L for an insphere. Bits of these for L = 1
// (2): differences 61 (124), minors 123 (249), squares 124 (250), determinants of
// three rows 186 (375), of four 312 (627): below 64 times the limbs, with a sign.
#include "exact/grid_stage.h"

#include <math.h>

#define INLINE static inline __attribute__((always_inline))

__extension__ typedef __int128 int128;

enum { COORDINATE_BITS = 60, PARAMETER_BITS = 63, MOST_LIMBS = 10 };

/* Two's complement numbers, the lowest limb first. All widths are constants once
 * inlined. */

INLINE int is_negative(const uint64_t *a, int n) { return (int64_t)a[n - 1] < 0; }

/* out -= a, both of n limbs. */
INLINE void subtract(uint64_t *out, const uint64_t *a, int n) {
  uint64_t borrow = 0;
  for (int i = 0; i < n; i++) {
    tet_uint128 d = (tet_uint128)out[i] - a[i] - borrow;
    out[i] = (uint64_t)d;
    borrow = (uint64_t)(d >> 64) & 1;
  }
}

INLINE void add(uint64_t *out, const uint64_t *a, int n) {
  uint64_t carry = 0;
  for (int i = 0; i < n; i++) {
    tet_uint128 s = (tet_uint128)out[i] + a[i] + carry;
    out[i] = (uint64_t)s;
    carry = (uint64_t)(s >> 64);
  }
}

/* out = a b, of na + nb limbs: the product of the patterns, less what the signs add. */
INLINE void multiply(uint64_t *out, const uint64_t *a, int na, const uint64_t *b, int nb) {
  for (int i = 0; i < na + nb; i++) out[i] = 0;
  for (int i = 0; i < na; i++) {
    uint64_t carry = 0;
    for (int j = 0; j < nb; j++) {
      tet_uint128 s = (tet_uint128)a[i] * b[j] + out[i + j] + carry;
      out[i + j] = (uint64_t)s;
      carry = (uint64_t)(s >> 64);
    }
    out[i + nb] = carry;
  }
  uint64_t masked[MOST_LIMBS];
  uint64_t a_negative = 0 - (uint64_t)is_negative(a, na);
  for (int i = 0; i < nb; i++) masked[i] = b[i] & a_negative;
  subtract(out + na, masked, nb);
  uint64_t b_negative = 0 - (uint64_t)is_negative(b, nb);
  for (int i = 0; i < na; i++) masked[i] = a[i] & b_negative;
  subtract(out + nb, masked, na);
}

INLINE int sign_of(const uint64_t *a, int n) {
  if (is_negative(a, n)) return -1;
  uint64_t any = 0;
  for (int i = 0; i < n; i++) any |= a[i];
  return any != 0;
}

/* Rows of three coordinates of L limbs. */

/* m = a[0] b[1] - a[1] b[0], 2 L limbs. */
INLINE void minor(uint64_t *m, const uint64_t *a, const uint64_t *b, int L) {
  uint64_t t[MOST_LIMBS];
  multiply(m, a, L, b + L, L);
  multiply(t, a + L, L, b, L);
  subtract(m, t, 2 * L);
}

/* det(a, b, c), 3 L limbs, from the minors. */
INLINE void determinant(uint64_t *det, const uint64_t *a, const uint64_t *b, const uint64_t *c,
                        const uint64_t *ab, const uint64_t *ac, const uint64_t *bc, int L) {
  uint64_t t[MOST_LIMBS];
  multiply(det, a + 2 * L, L, bc, 2 * L);
  multiply(t, b + 2 * L, L, ac, 2 * L);
  subtract(det, t, 3 * L);
  multiply(t, c + 2 * L, L, ab, 2 * L);
  add(det, t, 3 * L);
}

/* |a|^2 det, 5 L limbs. */
INLINE void lifted(uint64_t *out, const uint64_t *a, const uint64_t *det, int L) {
  uint64_t square[MOST_LIMBS], t[MOST_LIMBS];
  multiply(square, a, L, a, L);
  for (int k = 1; k < 3; k++) {
    multiply(t, a + k * L, L, a + k * L, L);
    add(square, t, 2 * L);
  }
  multiply(out, square, 2 * L, det, 3 * L);
}

INLINE int orient3d(const uint64_t *r, int L) {
  const uint64_t *a = r, *b = r + 3 * L, *c = r + 6 * L;
  uint64_t ab[MOST_LIMBS], ac[MOST_LIMBS], bc[MOST_LIMBS], det[MOST_LIMBS];
  minor(ab, a, b, L);
  minor(ac, a, c, L);
  minor(bc, b, c, L);
  determinant(det, a, b, c, ab, ac, bc, L);
  return sign_of(det, 3 * L);
}

INLINE int insphere(const uint64_t *r, int L) {
  const uint64_t *a = r, *b = r + 3 * L, *c = r + 6 * L, *d = r + 9 * L;
  uint64_t ab[MOST_LIMBS], ac[MOST_LIMBS], ad[MOST_LIMBS], bc[MOST_LIMBS], bd[MOST_LIMBS];
  uint64_t cd[MOST_LIMBS], det[MOST_LIMBS], sum[MOST_LIMBS], t[MOST_LIMBS];
  minor(ab, a, b, L);
  minor(ac, a, c, L);
  minor(ad, a, d, L);
  minor(bc, b, c, L);
  minor(bd, b, d, L);
  minor(cd, c, d, L);
  determinant(det, b, c, d, bc, bd, cd, L);
  lifted(sum, a, det, L);
  determinant(det, a, c, d, ac, ad, cd, L);
  lifted(t, b, det, L);
  subtract(sum, t, 5 * L);
  determinant(det, a, b, d, ab, ad, bd, L);
  lifted(t, c, det, L);
  add(sum, t, 5 * L);
  determinant(det, a, b, c, ab, ac, bc, L);
  lifted(t, d, det, L);
  subtract(sum, t, 5 * L);
  return sign_of(sum, 5 * L);
}

/* From points to rows. */

/* 2^e for -1022 <= e <= 1023. */
static double power_of_two(int e) {
  union {
    uint64_t bits;
    double x;
  } u = {.bits = (uint64_t)(e + 1023) << 52};
  return u.x;
}

INLINE double largest(const double *x, double so_far) {
  for (int k = 0; k < 3; k++) {
    double y = fabs(x[k]);
    so_far = y > so_far ? y : so_far;
  }
  return so_far;
}

/* The factor that brings all coordinates below 2^60 and keeps them exact; 0: none. */
INLINE double grid_scale(const tet_point_ref *point, int count) {
  double most = 0x1p-900;
  for (int i = 0; i < count; i++) {
    most = largest(point[i].a, most);
    if (point[i].b) most = largest(point[i].b, most);
  }
  if (!(most < 0x1p900)) return 0;
  union {
    double x;
    uint64_t bits;
  } u = {.x = most};
  int exponent = (int)(u.bits >> 52) - 1022; /* most < 2^exponent */
  return power_of_two(COORDINATE_BITS - exponent);
}

/* Three coordinates as integers; 0 unless the grid holds them. */
INLINE int to_grid(const double *x, double scale, int64_t out[3]) {
  int exact = 1;
  for (int k = 0; k < 3; k++) {
    double scaled = x[k] * scale;
    out[k] = (int64_t)scaled;
    /* A product rounded for underflow lies between 0 and 1 and is not an integer. */
    exact &= (double)out[k] == scaled && (scaled != 0 || x[k] == 0);
  }
  return exact;
}

/* The shift k that makes all parameters integers; -1 if too large. */
INLINE int parameter_shift(const tet_point_ref *point, int count) {
  int most = 0;
  for (int i = 0; i < count; i++) {
    if (!point[i].b) continue;
    uint64_t m;
    int32_t e;
    if (tet_double_parts(point[i].t, &m, &e) <= 0 || point[i].t >= 1) return -1;
    if (-e > most) most = -e;
  }
  return most <= PARAMETER_BITS ? most : -1;
}

/* All points less `origin` (0, or the last) as rows of 64-bit numbers. */
INLINE int explicit_rows(const tet_point_ref *point, int count, int origin, uint64_t *rows) {
  double scale = grid_scale(point, count);
  int64_t q[5][3];
  int exact = scale != 0;
  for (int i = 0; i < count; i++) exact &= to_grid(point[i].a, scale, q[i]);
  if (!exact) return 0;
  for (int i = 0; i < count; i++) {
    if (i == origin) continue;
    for (int k = 0; k < 3; k++) *rows++ = (uint64_t)(q[i][k] - q[origin][k]);
  }
  return 1;
}

/* The same with implicit points, as rows of 128-bit numbers. */
INLINE int implicit_rows(const tet_point_ref *point, int count, int origin, uint64_t *rows) {
  double scale = grid_scale(point, count);
  int shift = parameter_shift(point, count);
  if (scale == 0 || shift < 0) return 0;
  int128 q[5][3];
  for (int i = 0; i < count; i++) {
    int64_t a[3], b[3], t = 0;
    if (!to_grid(point[i].a, scale, a)) return 0;
    if (point[i].b) {
      if (!to_grid(point[i].b, scale, b)) return 0;
      t = (int64_t)(point[i].t * power_of_two(shift)); /* exact, < 2^63 */
    }
    for (int k = 0; k < 3; k++) {
      q[i][k] = (int128)a[k] * ((int128)1 << shift);
      if (point[i].b) q[i][k] += (int128)t * (b[k] - a[k]);
    }
  }
  for (int i = 0; i < count; i++) {
    if (i == origin) continue;
    for (int k = 0; k < 3; k++) {
      int128 d = q[i][k] - q[origin][k];
      *rows++ = (uint64_t)d;
      *rows++ = (uint64_t)(d >> 64);
    }
  }
  return 1;
}

static int has_implicit(const tet_point_ref *point, int count) {
  for (int i = 0; i < count; i++) {
    if (point[i].b) return 1;
  }
  return 0;
}

int tet_grid_orient3d(const tet_point_ref point[4], int *ret_sign) {
  uint64_t rows[3 * 3 * 2];
  if (!has_implicit(point, 4)) {
    if (!explicit_rows(point, 4, 0, rows)) return 0;
    *ret_sign = orient3d(rows, 1);
    return 1;
  }
  if (!implicit_rows(point, 4, 0, rows)) return 0;
  *ret_sign = orient3d(rows, 2);
  return 1;
}

int tet_grid_insphere(const tet_point_ref point[5], int *ret_sign) {
  uint64_t rows[4 * 3 * 2];
  if (!has_implicit(point, 5)) {
    if (!explicit_rows(point, 5, 4, rows)) return 0;
    *ret_sign = insphere(rows, 1);
    return 1;
  }
  if (!implicit_rows(point, 5, 4, rows)) return 0;
  *ret_sign = insphere(rows, 2);
  return 1;
}
