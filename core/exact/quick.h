// SPDX-License-Identifier: Apache-2.0
// The first look of the kernel's hot loops at a sign: one evaluation in doubles and a
// bound from the lengths of the difference vectors, which costs half of what the
// majorant of filter.h costs and is as sharp on well-shaped and badly scaled tetrahedra.
// Internal to this folder, to core/mesh, to core/refine and to core/build/intersections.c.
//
// Rows a, b, c of a determinant of three have a permanent of absolute values of at most
// sqrt(2) |a| |b| |c| (Cauchy and Schwarz, twice). So the majorant M of insphere, with
// rows d_i, is at most sqrt(2) sum_i |d_i|^2 prod_{j != i} |d_j| <= 4 sqrt(2) prod |d_i|
// max |d_i|, and M^2 <= 32 prod s_i max s_i with s_i = |d_i|^2; that of orient3d is at most
// sqrt(2) prod |d_i|. The errors are below 18 u M and 10 u M (filter.h); everything is
// compared squared, with room for the roundings of the bounds themselves. Underflow: where a
// row is shorter than 2^-100 (insphere) or 2^-150 (orient3d), or the squared value is below
// 2^-900, nothing is proven here; so the products of squares are normal numbers or far below 2^-900, and
// what a product of two small factors loses, at most 2^-1074, times the other rows is far
// below the bound. Overflow makes the bound infinite or NaN, and nothing is above it.
//
// Implicit points stand within u of the size S of the largest coordinate, so a row is moved by at
// most 3.5 u S: by a part t of its length at most, where t is that by the shortest row. Expanded,
// every term of a determinant of degree g, at most the product of the lengths in it (Hadamard),
// moves by at most (1 + t)^g - 1 < 1.03 g t of itself for t < 2^-8. Insphere has four such terms.
//
// Where all coordinates are multiples of g, the determinants are multiples of g^3 and g^5;
// one that is proven smaller is zero. On grids that settles what cannot be settled by
// any bound.
#ifndef TETRAD_CORE_EXACT_QUICK_H
#define TETRAD_CORE_EXACT_QUICK_H

#include <math.h>

#include "base/processor.h"
#include "base/vector.h"
#include "exact/filter.h"

enum { TET_UNSURE = 2 };

#define TET_QUICK_LEAST 0x1p-900
#define TET_QUICK_INSPHERE_ROW 0x1p-200 /* squared */
#define TET_QUICK_ORIENT3D_ROW 0x1p-300
#define TET_QUICK_INSPHERE (32.1 * (18 * TET_FILTER_UNIT) * (18 * TET_FILTER_UNIT))
#define TET_QUICK_DOT (1.01 * (8 * TET_FILTER_UNIT) * (8 * TET_FILTER_UNIT))
#define TET_QUICK_ORIENT3D (2.01 * (10 * TET_FILTER_UNIT) * (10 * TET_FILTER_UNIT))

/* The sign of a determinant of value `det` and squared error `limit`, multiple of `grain`; or
 * TET_UNSURE. `is_normal`: no row is too short. */
static inline int tet_quick_sign(double det, double limit, int is_normal, double grain) {
  if ((det * det > limit) & is_normal)
    return det > 0 ? 1 : -1;
  return fabs(det) + sqrt(limit) * 1.01 < grain ? 0 : TET_UNSURE;
}

static inline double tet_larger(double a, double b) {
  return a > b ? a : b;
}

static inline double tet_smaller(double a, double b) {
  return a < b ? a : b;
}

/* A little more than 3.5 u, and what the terms' moves are times of t; see above. */
#define TET_QUICK_MOVED (3.6 * TET_FILTER_UNIT)
#define TET_QUICK_MOST_MOVED 0x1p-8
#define TET_QUICK_MOVED_INSPHERE (4 * 1.04 * 5)
#define TET_QUICK_MOVED_ORIENT3D (1.04 * 3)

/* The largest |coordinate| of n points. */
static inline double tet_quick_size(const double *const *x, int n) {
  double size = 0;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) size = tet_larger(size, fabs(x[i][k]));
  return size;
}

/* A first look at insphere: one of the two below. */
typedef int tet_quick_look(const double *a, const double *b, const double *c, const double *d, const double *e,
                           double grain5);

/* tet_insphere_xyz, or TET_UNSURE. */
static inline int tet_quick_insphere(const double *a, const double *b, const double *c,
                                     const double *d, const double *e, double grain5) {
  double r[12];
  tet_minus(a, e, r);
  tet_minus(b, e, r + 3);
  tet_minus(c, e, r + 6);
  tet_minus(d, e, r + 9);
  double s0 = tet_square(r), s1 = tet_square(r + 3), s2 = tet_square(r + 6), s3 = tet_square(r + 9);
  double most = tet_larger(tet_larger(s0, s1), tet_larger(s2, s3));
  double limit = TET_QUICK_INSPHERE * ((s0 * s1) * (s2 * s3)) * most + TET_QUICK_LEAST;
  double least = tet_smaller(tet_smaller(s0, s1), tet_smaller(s2, s3));
  return tet_quick_sign(tet_insphere_value(r), limit, least > TET_QUICK_INSPHERE_ROW, grain5);
}

#if TET_HAVE_AVX2

/* The same with one lane for each of a, b, c, d: minors of (x, y) by minors of (z, square). The
 * monomials, and so the bound, are the same; no more roundings than there. */
TET_AVX2 static inline int tet_quick_insphere_avx2(const double *a, const double *b, const double *c,
                                                   const double *d, const double *e, double grain5) {
  __m256d ac = _mm256_set_m128d(_mm_loadu_pd(c), _mm_loadu_pd(a));
  __m256d bd = _mm256_set_m128d(_mm_loadu_pd(d), _mm_loadu_pd(b));
  __m256d z = _mm256_set_m128d(_mm_loadh_pd(_mm_load_sd(c + 2), d + 2), _mm_loadh_pd(_mm_load_sd(a + 2), b + 2));
  __m256d x = _mm256_sub_pd(_mm256_unpacklo_pd(ac, bd), _mm256_broadcast_sd(e));
  __m256d y = _mm256_sub_pd(_mm256_unpackhi_pd(ac, bd), _mm256_broadcast_sd(e + 1));
  z = _mm256_sub_pd(z, _mm256_broadcast_sd(e + 2));
  __m256d w = _mm256_fmadd_pd(x, x, _mm256_fmadd_pd(y, y, _mm256_mul_pd(z, z)));
  /* Minors of neighbours: 01, 12, 23, 30. */
  __m256d x1 = _mm256_permute4x64_pd(x, 0x39), y1 = _mm256_permute4x64_pd(y, 0x39);
  __m256d z1 = _mm256_permute4x64_pd(z, 0x39), w1 = _mm256_permute4x64_pd(w, 0x39);
  __m256d m = _mm256_fmsub_pd(x, y1, _mm256_mul_pd(x1, y));
  __m256d n = _mm256_fmsub_pd(z, w1, _mm256_mul_pd(z1, w));
  __m256d s = _mm256_mul_pd(m, _mm256_permute4x64_pd(n, 0x4e)); /* 01 23, -12 03, 23 01, -03 12 */
  /* Minors across: 02, 13. */
  __m128d x0 = _mm256_castpd256_pd128(x), x2 = _mm256_extractf128_pd(x, 1);
  __m128d y0 = _mm256_castpd256_pd128(y), y2 = _mm256_extractf128_pd(y, 1);
  __m128d z0 = _mm256_castpd256_pd128(z), z2 = _mm256_extractf128_pd(z, 1);
  __m128d w0 = _mm256_castpd256_pd128(w), w2 = _mm256_extractf128_pd(w, 1);
  __m128d across = _mm_fmsub_pd(z0, w2, _mm_mul_pd(z2, w0));
  __m128d q = _mm_mul_pd(_mm_fmsub_pd(x0, y2, _mm_mul_pd(x2, y0)), _mm_shuffle_pd(across, across, 1));
  __m128d t = _mm_addsub_pd(_mm_add_pd(_mm256_castpd256_pd128(s), _mm256_extractf128_pd(s, 1)), q);
  double det = _mm_cvtsd_f64(_mm_sub_sd(_mm_unpackhi_pd(t, t), t));
  __m128d products = _mm_mul_pd(w0, w2), most = _mm_max_pd(w0, w2), least = _mm_min_pd(w0, w2);
  products = _mm_mul_sd(products, _mm_unpackhi_pd(products, products));
  most = _mm_max_sd(most, _mm_unpackhi_pd(most, most));
  least = _mm_min_sd(least, _mm_unpackhi_pd(least, least));
  double limit = TET_QUICK_INSPHERE * _mm_cvtsd_f64(products) * _mm_cvtsd_f64(most) + TET_QUICK_LEAST;
  return tet_quick_sign(det, limit, _mm_cvtsd_f64(least) > TET_QUICK_INSPHERE_ROW, grain5);
}

#endif

/* tet_orient3d_xyz, or TET_UNSURE. */
static inline int tet_quick_orient3d(const double *a, const double *b, const double *c,
                                     const double *d, double grain3) {
  double r[9];
  tet_minus(b, a, r);
  tet_minus(c, a, r + 3);
  tet_minus(d, a, r + 6);
  double s0 = tet_square(r), s1 = tet_square(r + 3), s2 = tet_square(r + 6);
  double limit = TET_QUICK_ORIENT3D * (s0 * s1) * s2 + TET_QUICK_LEAST;
  int is_normal = tet_smaller(tet_smaller(s0, s1), s2) > TET_QUICK_ORIENT3D_ROW;
  return tet_quick_sign(tet_orient3d_value(r), limit, is_normal, grain3);
}

/* tet_orient3d where points may be implicit, x being as they are rounded; or TET_UNSURE. */
static inline int tet_quick_orient3d_moved(const double *const x[4]) {
  double r[9];
  for (int i = 0; i < 3; i++) tet_minus(x[i + 1], x[0], r + 3 * i);
  double s0 = tet_square(r), s1 = tet_square(r + 3), s2 = tet_square(r + 6);
  double least = tet_smaller(tet_smaller(s0, s1), s2), t = TET_QUICK_MOVED * tet_quick_size(x, 4) / sqrt(least);
  double part = sqrt(TET_QUICK_ORIENT3D) + TET_QUICK_MOVED_ORIENT3D * t;
  return tet_quick_sign(tet_orient3d_value(r), 1.01 * part * part * (s0 * s1) * s2 + TET_QUICK_LEAST,
                        (least > TET_QUICK_ORIENT3D_ROW) & (t < TET_QUICK_MOST_MOVED), 0);
}

/* tet_insphere where points may be implicit, x being as they are rounded; or TET_UNSURE. */
static inline int tet_quick_insphere_moved(const double *const x[5]) {
  double r[12];
  for (int i = 0; i < 4; i++) tet_minus(x[i], x[4], r + 3 * i);
  double s0 = tet_square(r), s1 = tet_square(r + 3), s2 = tet_square(r + 6), s3 = tet_square(r + 9);
  double most = tet_larger(tet_larger(s0, s1), tet_larger(s2, s3));
  double least = tet_smaller(tet_smaller(s0, s1), tet_smaller(s2, s3));
  double t = TET_QUICK_MOVED * tet_quick_size(x, 5) / sqrt(least);
  double part = sqrt(TET_QUICK_INSPHERE) + TET_QUICK_MOVED_INSPHERE * t;
  return tet_quick_sign(tet_insphere_value(r), 1.01 * part * part * ((s0 * s1) * (s2 * s3)) * most + TET_QUICK_LEAST,
                        (least > TET_QUICK_INSPHERE_ROW) & (t < TET_QUICK_MOST_MOVED), 0);
}

/* The plane of a triangle, to ask for the sides of many points. */
typedef struct tet_quick_plane {
  const double *origin;
  double normal[3], limit;
  int is_normal; /* its rows are not too short */
} tet_quick_plane;

static inline tet_quick_plane tet_quick_plane_of(const double *a, const double *b, const double *c) {
  double r[6];
  tet_minus(b, a, r);
  tet_minus(c, a, r + 3);
  return (tet_quick_plane){a,
                           {r[1] * r[5] - r[2] * r[4], r[2] * r[3] - r[0] * r[5], r[0] * r[4] - r[1] * r[3]},
                           TET_QUICK_ORIENT3D * tet_square(r) * tet_square(r + 3),
                           tet_smaller(tet_square(r), tet_square(r + 3)) > TET_QUICK_ORIENT3D_ROW};
}

/* tet_orient3d_xyz(a, b, c, d) of the plane's triangle, or TET_UNSURE; as many roundings as there. */
static inline int tet_quick_side(const tet_quick_plane *plane, const double *d) {
  double r[3];
  tet_minus(d, plane->origin, r);
  double s = tet_square(r);
  return tet_quick_sign(tet_dot3(plane->normal, r), plane->limit * s + TET_QUICK_LEAST,
                        plane->is_normal & (s > TET_QUICK_ORIENT3D_ROW), 0);
}

/* tet_dot_sign_xyz, or TET_UNSURE: a sum of products p_i q_i is off by at most 7 u sum |p_i q_i| (filter.h), and that
 * sum at most |p| |q|. */
static inline int tet_quick_dot(const double *a, const double *b, const double *c) {
  double r[6];
  tet_minus(a, c, r);
  tet_minus(b, c, r + 3);
  double s0 = tet_square(r), s1 = tet_square(r + 3);
  return tet_quick_sign(tet_dot3(r, r + 3), TET_QUICK_DOT * s0 * s1 + TET_QUICK_LEAST,
                        tet_smaller(s0, s1) > TET_QUICK_ORIENT3D_ROW, 0);
}

/* The value of the determinant of tet_orient3d_xyz, however wrong. */
static inline double tet_rough_orient3d(const double *a, const double *b, const double *c, const double *d) {
  double r[9];
  tet_minus(b, a, r);
  tet_minus(c, a, r + 3);
  tet_minus(d, a, r + 6);
  return tet_orient3d_value(r);
}

#endif
