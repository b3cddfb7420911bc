// SPDX-License-Identifier: Apache-2.0
// The floating-point filter of the predicates. Internal to this folder.
//
// Every predicate is a homogeneous polynomial P of differences of coordinates. Its
// majorant M is P of the absolute differences with all signs positive. Let u = 2^-53
// and let every monomial pass at most k roundings between the coordinates and the
// result. Then the computed value is off by at most ((1+u)^k - 1) M, and M as
// computed (M') is at least (1-u)^k M, so the error is below (k + 1) u M' for all
// k used here (k <= 20; second-order terms and the rounding of the bound included).
// One more u M' pays for underflow, which is possible only in products: each loses
// at most 2^-1075 times its other factors. M' > TET_FILTER_LEAST and the limit on
// the factors, which each predicate checks where its degree makes it necessary, keep
// that far below u M'. Overflow makes M' infinite first, and the filter fails.
//
// An implicit point enters with its rounded coordinates x, which lie within u |x| of
// the exact ones (or half of the least denormal). Let r be the sum of these radii
// for each difference d. P moves by at most M(|d| + r) - M(|d|). Roundings in that
// term cost at most 2 k u M' for the two values of M and, for degree g < k, 3 g u M'
// for |d| and |d| + r being rounded themselves, so with the k + 2 from above
// (6 k + 2) u M'(|d| + r) is enough.
#ifndef TETRAD_CORE_EXACT_FILTER_H
#define TETRAD_CORE_EXACT_FILTER_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "base/vector.h"
#include "exact/points.h"

_Static_assert(FLT_EVAL_METHOD == 0, "filters need plain double arithmetic");

#define TET_FILTER_LEAST 0x1p-500
/* The limit on lengths where the degree is 5 or 6, as the sum of their squares. */
#define TET_FILTER_SQUARE_LIMIT 0x1p200

#define TET_FILTER_UNIT 0x1p-53
#define TET_FILTER_EXPLICIT(k) (((k) + 2) * TET_FILTER_UNIT)
#define TET_FILTER_IMPLICIT(k) ((6 * (k) + 2) * TET_FILTER_UNIT)

/* The most roundings that a monomial passes: those of its differences, then those of
 * the products and sums above them. */
enum {
  TET_ROUNDINGS_ORIENT2D = 4,         /* 2; product, difference */
  TET_ROUNDINGS_DOT = 5,              /* 2; product, two sums */
  TET_ROUNDINGS_COMPARE_DISTANCE = 6, /* 2; product, two sums, difference */
  TET_ROUNDINGS_ORIENT3D = 8,         /* 3; minor 2, product, two sums */
  TET_ROUNDINGS_INSPHERE = 16,        /* 5; square 3, determinant 5, product, two sums */
  TET_ROUNDINGS_BALL3 = 20            /* three dots of 5; product, difference, product, two sums */
};

/* det of rows d[0..2], d[3..5], d[6..8]. */
static inline double tet_orient3d_value(const double *d) {
  return d[2] * (d[3] * d[7] - d[4] * d[6]) - d[5] * (d[0] * d[7] - d[1] * d[6]) +
         d[8] * (d[0] * d[4] - d[1] * d[3]);
}

/* The majorants share the inner products with the values: |x y| = |x| |y|, rounded or
 * not, so the compiler forms them once. They also give the sum of the squared lengths
 * of the rows where the degree, 5 or 6, makes a limit on them necessary; else 0. */
static inline double tet_orient3d_majorant(const double *d, double *ret_squares) {
  *ret_squares = 0;
  return fabs(d[2]) * (fabs(d[3] * d[7]) + fabs(d[4] * d[6])) +
         fabs(d[5]) * (fabs(d[0] * d[7]) + fabs(d[1] * d[6])) +
         fabs(d[8]) * (fabs(d[0] * d[4]) + fabs(d[1] * d[3]));
}

/* Four rows relative to e. */
static inline double tet_insphere_value(const double *d) {
  double m01 = d[0] * d[4] - d[1] * d[3], m02 = d[0] * d[7] - d[1] * d[6];
  double m03 = d[0] * d[10] - d[1] * d[9], m12 = d[3] * d[7] - d[4] * d[6];
  double m13 = d[3] * d[10] - d[4] * d[9], m23 = d[6] * d[10] - d[7] * d[9];
  double d0 = d[5] * m23 - d[8] * m13 + d[11] * m12;
  double d1 = d[2] * m23 - d[8] * m03 + d[11] * m02;
  double d2 = d[2] * m13 - d[5] * m03 + d[11] * m01;
  double d3 = d[2] * m12 - d[5] * m02 + d[8] * m01;
  return (tet_square(d) * d0 - tet_square(d + 3) * d1) +
         (tet_square(d + 6) * d2 - tet_square(d + 9) * d3);
}

static inline double tet_insphere_majorant(const double *d, double *ret_squares) {
  double m01 = fabs(d[0] * d[4]) + fabs(d[1] * d[3]);
  double m02 = fabs(d[0] * d[7]) + fabs(d[1] * d[6]);
  double m03 = fabs(d[0] * d[10]) + fabs(d[1] * d[9]);
  double m12 = fabs(d[3] * d[7]) + fabs(d[4] * d[6]);
  double m13 = fabs(d[3] * d[10]) + fabs(d[4] * d[9]);
  double m23 = fabs(d[6] * d[10]) + fabs(d[7] * d[9]);
  double z0 = fabs(d[2]), z1 = fabs(d[5]), z2 = fabs(d[8]), z3 = fabs(d[11]);
  double d0 = z1 * m23 + z2 * m13 + z3 * m12;
  double d1 = z0 * m23 + z2 * m03 + z3 * m02;
  double d2 = z0 * m13 + z1 * m03 + z3 * m01;
  double d3 = z0 * m12 + z1 * m02 + z2 * m01;
  double s0 = tet_square(d), s1 = tet_square(d + 3);
  double s2 = tet_square(d + 6), s3 = tet_square(d + 9);
  *ret_squares = (s0 + s1) + (s2 + s3);
  return (s0 * d0 + s1 * d1) + (s2 * d2 + s3 * d3);
}

static inline double tet_orient2d_value(const double *d) {
  return d[0] * d[3] - d[1] * d[2];
}

static inline double tet_orient2d_majorant(const double *d, double *ret_squares) {
  *ret_squares = 0;
  return fabs(d[0] * d[3]) + fabs(d[1] * d[2]);
}

static inline double tet_dot3(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double tet_dot3_majorant(const double *a, const double *b) {
  return fabs(a[0] * b[0]) + fabs(a[1] * b[1]) + fabs(a[2] * b[2]);
}

static inline double tet_dot_value(const double *d) {
  return tet_dot3(d, d + 3);
}

static inline double tet_dot_majorant(const double *d, double *ret_squares) {
  *ret_squares = 0;
  return tet_dot3_majorant(d, d + 3);
}

static inline double tet_compare_distance_value(const double *d) {
  return tet_square(d) - tet_square(d + 3);
}

static inline double tet_compare_distance_majorant(const double *d, double *ret_squares) {
  *ret_squares = 0;
  return tet_square(d) + tet_square(d + 3);
}

/* Rows u, v, w of tet_exact_diametric_ball3, where the polynomial is derived. */
static inline double tet_ball3_value(const double *d) {
  double uu = tet_square(d), vv = tet_square(d + 3), ww = tet_square(d + 6);
  double uv = tet_dot3(d, d + 3), uw = tet_dot3(d, d + 6), vw = tet_dot3(d + 3, d + 6);
  return uu * (vv * uw - uv * vw) + vv * (uu * vw - uv * uw) - ww * (uu * vv - uv * uv);
}

static inline double tet_ball3_majorant(const double *d, double *ret_squares) {
  double uu = tet_square(d), vv = tet_square(d + 3), ww = tet_square(d + 6);
  double uv = tet_dot3_majorant(d, d + 3), uw = tet_dot3_majorant(d, d + 6);
  double vw = tet_dot3_majorant(d + 3, d + 6);
  *ret_squares = uu + vv + ww;
  return uu * (vv * uw + uv * vw) + vv * (uu * vw + uv * uw) + ww * (uu * vv + uv * uv);
}

typedef double (*tet_polynomial)(const double *differences);
typedef double (*tet_majorant)(const double *differences, double *ret_squares);

/* The sign of `value`, or 0 for "cannot tell", from `n` differences d with radii r (NULL:
 * all points are explicit). The functions and numbers are constants at every call and
 * the whole gets inlined. */
static inline __attribute__((always_inline)) int tet_filter(tet_polynomial value,
                                                            tet_majorant majorant, const double *d,
                                                            const double *r, int n, int k) {
  double squares, least = majorant(d, &squares), bound = TET_FILTER_EXPLICIT(k) * least;
  if (r) {
    double big[12] = {0};
    for (int i = 0; i < n; i++)
      big[i] = fabs(d[i]) + r[i];
    double moved = majorant(big, &squares);
    bound = (moved - least) + TET_FILTER_IMPLICIT(k) * moved;
  }
  double p = value(d);
  if (!(least > TET_FILTER_LEAST) || !(squares < TET_FILTER_SQUARE_LIMIT))
    return 0;
  return (p > bound) - (p < -bound);
}

/* d = x(v) - x(o), and the radius of its error where points are implicit. */
static inline void tet_difference(const tet_points *p, uint32_t v, uint32_t o, double *d,
                                  double *r) {
  const double *x = p->x + 3 * (size_t)v, *y = p->x + 3 * (size_t)o;
  /* A little more than u, for the rounding of r itself; and more than any denormal. */
  double of_x = tet_is_implicit(p, v) ? 0x1.01p-53 : 0;
  double of_y = tet_is_implicit(p, o) ? 0x1.01p-53 : 0;
  for (int k = 0; k < 3; k++) {
    d[k] = x[k] - y[k];
    r[k] = fabs(x[k]) * of_x + fabs(y[k]) * of_y + 0x1p-1000;
  }
}

#endif
