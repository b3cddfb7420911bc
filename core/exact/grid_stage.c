// SPDX-License-Identifier: Apache-2.0
// The quick exact stage. Coordinates become integers below 2^60 by an exact scaling;
// with implicit points all of them are multiplied by 2^k, the common denominator of
// the parameters t, and stay below 2^123 for k <= 63. So coordinates have one limb or
// two, and every later width is known when compiling: for L limbs a coordinate, 2 L
// for a minor or a dot product, 3 L for orient3d, 5 L for insphere, 6 L for the ball of
// a triangle. Bits of these for L = 1 (2): differences 61 (124), minors 123 (249), dot
// products 124 (250), determinants of three rows 186 (375), of four 312 (627), minors
// of dot products 249 (501), the ball 375 (753): below 64 times the limbs, with a sign.
#include "exact/grid_stage.h"

#include <math.h>

#define INLINE static inline __attribute__((always_inline))

__extension__ typedef __int128 int128;

enum { COORDINATE_BITS = 60, PARAMETER_BITS = 63 };
enum { MOST_LIMBS = 12, MOST_POINTS = 5, MOST_ROWS = 4 * 3 * 2 };

/* Two's complement numbers, the lowest limb first. All widths are constants once
 * inlined. */

INLINE int is_negative(const uint64_t *a, int n) {
  return (int64_t)a[n - 1] < 0;
}

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
  for (int i = 0; i < na + nb; i++)
    out[i] = 0;
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
  for (int i = 0; i < nb; i++)
    masked[i] = b[i] & a_negative;
  subtract(out + na, masked, nb);
  uint64_t b_negative = 0 - (uint64_t)is_negative(b, nb);
  for (int i = 0; i < na; i++)
    masked[i] = a[i] & b_negative;
  subtract(out + nb, masked, na);
}

INLINE int sign_of(const uint64_t *a, int n) {
  if (is_negative(a, n))
    return -1;
  uint64_t any = 0;
  for (int i = 0; i < n; i++)
    any |= a[i];
  return any != 0;
}

/* Rows of three coordinates of L limbs. */

/* m = a b - c d of L limbs each, 2 L limbs. */
INLINE void difference(uint64_t *m, const uint64_t *a, const uint64_t *b, const uint64_t *c,
                       const uint64_t *d, int L) {
  uint64_t t[MOST_LIMBS];
  multiply(m, a, L, b, L);
  multiply(t, c, L, d, L);
  subtract(m, t, 2 * L);
}

/* m = a[0] b[1] - a[1] b[0], 2 L limbs. */
INLINE void minor(uint64_t *m, const uint64_t *a, const uint64_t *b, int L) {
  difference(m, a, b + L, a + L, b, L);
}

/* a . b, 2 L limbs. */
INLINE void dot(uint64_t *sum, const uint64_t *a, const uint64_t *b, int L) {
  uint64_t t[MOST_LIMBS];
  multiply(sum, a, L, b, L);
  for (int k = 1; k < 3; k++) {
    multiply(t, a + k * L, L, b + k * L, L);
    add(sum, t, 2 * L);
  }
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
  uint64_t square[MOST_LIMBS];
  dot(square, a, a, L);
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

INLINE int orient2d(const uint64_t *r, int axis, int L) {
  const uint64_t *a = r, *b = r + 3 * L;
  int i = (axis + 1) % 3 * L, j = (axis + 2) % 3 * L;
  uint64_t det[MOST_LIMBS];
  difference(det, a + i, b + j, a + j, b + i, L);
  return sign_of(det, 2 * L);
}

INLINE int dot_sign(const uint64_t *r, int L) {
  uint64_t sum[MOST_LIMBS];
  dot(sum, r, r + 3 * L, L);
  return sign_of(sum, 2 * L);
}

INLINE int compare_distance(const uint64_t *r, int L) {
  const uint64_t *a = r, *b = r + 3 * L;
  uint64_t aa[MOST_LIMBS], bb[MOST_LIMBS];
  dot(aa, a, a, L);
  dot(bb, b, b, L);
  subtract(aa, bb, 2 * L);
  return sign_of(aa, 2 * L);
}

/* The polynomial is derived at tet_exact_diametric_ball3. */
INLINE int diametric_ball3(const uint64_t *r, int L) {
  const uint64_t *u = r, *v = r + 3 * L, *w = r + 6 * L;
  uint64_t uu[MOST_LIMBS], vv[MOST_LIMBS], ww[MOST_LIMBS], uv[MOST_LIMBS], uw[MOST_LIMBS];
  uint64_t vw[MOST_LIMBS], m[MOST_LIMBS], sum[MOST_LIMBS], t[MOST_LIMBS];
  dot(uu, u, u, L);
  dot(vv, v, v, L);
  dot(ww, w, w, L);
  dot(uv, u, v, L);
  dot(uw, u, w, L);
  dot(vw, v, w, L);
  difference(m, vv, uw, uv, vw, 2 * L);
  multiply(sum, uu, 2 * L, m, 4 * L);
  difference(m, uu, vw, uv, uw, 2 * L);
  multiply(t, vv, 2 * L, m, 4 * L);
  add(sum, t, 6 * L);
  difference(m, uu, vv, uv, uv, 2 * L);
  multiply(t, ww, 2 * L, m, 4 * L);
  subtract(sum, t, 6 * L);
  return sign_of(sum, 6 * L);
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
    if (point[i].b)
      most = largest(point[i].b, most);
  }
  if (!(most < 0x1p900))
    return 0;
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
    if (!point[i].b)
      continue;
    uint64_t m;
    int32_t e;
    if (tet_double_parts(point[i].t, &m, &e) <= 0 || point[i].t >= 1)
      return -1;
    if (-e > most)
      most = -e;
  }
  return most <= PARAMETER_BITS ? most : -1;
}

/* Integers of 64 bits from explicit points; 0 unless the grid holds them. */
INLINE int explicit_rows(const tet_point_ref *point, int count, int origin, uint64_t *rows) {
  double scale = grid_scale(point, count);
  int64_t q[MOST_POINTS][3];
  int exact = scale != 0;
  for (int i = 0; i < count; i++)
    exact &= to_grid(point[i].a, scale, q[i]);
  if (!exact)
    return 0;
  for (int i = 0; i < count; i++) {
    if (i == origin)
      continue;
    for (int k = 0; k < 3; k++)
      *rows++ = (uint64_t)(q[i][k] - q[origin][k]);
  }
  return 1;
}

/* Integers of 128 bits, of all points times 2^shift. */
INLINE int implicit_rows(const tet_point_ref *point, int count, int origin, uint64_t *rows) {
  double scale = grid_scale(point, count);
  int shift = parameter_shift(point, count);
  if (scale == 0 || shift < 0)
    return 0;
  int128 q[MOST_POINTS][3];
  for (int i = 0; i < count; i++) {
    int64_t a[3], b[3], t = 0;
    if (!to_grid(point[i].a, scale, a))
      return 0;
    if (point[i].b) {
      if (!to_grid(point[i].b, scale, b))
        return 0;
      t = (int64_t)(point[i].t * power_of_two(shift)); /* exact, < 2^63 */
    }
    for (int k = 0; k < 3; k++) {
      q[i][k] = (int128)a[k] * ((int128)1 << shift);
      if (point[i].b)
        q[i][k] += (int128)t * (b[k] - a[k]);
    }
  }
  for (int i = 0; i < count; i++) {
    if (i == origin)
      continue;
    for (int k = 0; k < 3; k++) {
      int128 d = q[i][k] - q[origin][k];
      *rows++ = (uint64_t)d;
      *rows++ = (uint64_t)(d >> 64);
    }
  }
  return 1;
}

/* A row of differences for each point but the one at `origin`. Returns the limbs of a
 * coordinate, 1 or 2; 0 for points that do not fit. */
INLINE int make_rows(const tet_point_ref *point, int count, int origin, uint64_t *rows) {
  int any_implicit = 0;
  for (int i = 0; i < count; i++)
    any_implicit |= point[i].b != 0;
  if (any_implicit)
    return implicit_rows(point, count, origin, rows) ? 2 : 0;
  return explicit_rows(point, count, origin, rows) ? 1 : 0;
}

int tet_grid_orient3d(const tet_point_ref point[4], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 4, 0, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? orient3d(rows, 1) : orient3d(rows, 2);
  return limbs;
}

int tet_grid_insphere(const tet_point_ref point[5], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 5, 4, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? insphere(rows, 1) : insphere(rows, 2);
  return limbs;
}

int tet_grid_orient2d(int axis, const tet_point_ref point[3], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 3, 0, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? orient2d(rows, axis, 1) : orient2d(rows, axis, 2);
  return limbs;
}

int tet_grid_dot_sign(const tet_point_ref point[3], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 3, 2, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? dot_sign(rows, 1) : dot_sign(rows, 2);
  return limbs;
}

int tet_grid_compare_distance(const tet_point_ref point[3], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 3, 0, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? compare_distance(rows, 1) : compare_distance(rows, 2);
  return limbs;
}

int tet_grid_diametric_ball3(const tet_point_ref point[4], int *ret_sign) {
  uint64_t rows[MOST_ROWS];
  int limbs = make_rows(point, 4, 0, rows);
  if (limbs)
    *ret_sign = limbs == 1 ? diametric_ball3(rows, 1) : diametric_ball3(rows, 2);
  return limbs;
}
