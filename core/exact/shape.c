// SPDX-License-Identifier: Apache-2.0
/* shape.c: circumcentre and normals by exact polynomials; an axis by such where doubles do not tell. */
#include "exact/shape.h"

#include "base/vector.h"
#include "exact/dyadic_vector.h"

#include <float.h>
#include <math.h>

typedef tet_dyadic_space space;
typedef tet_dyadic num;

/* From the first vertex to the n others, up to three: a vector in each row. */
static void differences(space *w, const double *const *v, int n, num ret[][3]) {
  num at[4][3];
  for (int i = 0; i <= n; i++)
    for (int k = 0; k < 3; k++) at[i][k] = tet_dyadic_from_double_reduced(w, v[i][k]);
  for (int i = 0; i < n; i++) tet_dyadic_minus3(w, at[i + 1], at[0], ret[i]);
}

/* b x c, c x a, a x b. */
static void normals(space *w, num from[3][3], num ret[3][3]) {
  for (int i = 0; i < 3; i++) tet_dyadic_cross(w, from[(i + 1) % 3], from[(i + 2) % 3], ret[i]);
}

/* The power of two above |a|. */
static int32_t top_of(const num *a) {
  return a->exp + 64 * (int32_t)a->n - (a->n ? __builtin_clzll(a->limb[a->n - 1]) : 0);
}

static double scaled(num a, int32_t scale) {
  a.exp += scale;
  return tet_dyadic_to_double(&a);
}

/* n times a power of two that brings its largest coordinate to about 1. */
static void about_one(const num n[3], double ret[3]) {
  int32_t top = INT32_MIN;
  for (int k = 0; k < 3; k++)
    if (n[k].sign && top_of(&n[k]) > top) top = top_of(&n[k]);
  for (int k = 0; k < 3; k++) ret[k] = n[k].sign ? scaled(n[k], -top) : 0;
}

tet_exact_shape tet_shape_exactly(const double *const v[4]) {
  space store, *w = &store;
  num from[3][3], normal[3][3], square[3];
  tet_dyadic_begin(w);
  differences(w, v, 3, from);
  normals(w, from, normal);
  for (int i = 0; i < 3; i++) square[i] = tet_dyadic_dot(w, from[i], from[i]);
  num volume = tet_dyadic_dot(w, from[0], normal[0]);
  tet_exact_shape s = {.scale = volume.sign ? -top_of(&volume) : 0};
  s.volume6 = scaled(volume, s.scale);
  for (int k = 0; k < 3; k++) {
    num column[3] = {normal[0][k], normal[1][k], normal[2][k]};
    s.to_centre[k] = scaled(tet_dyadic_dot(w, square, column), s.scale);
  }
  return s;
}

void tet_normals_exactly(const double *const v[4], double ret[4][3]) {
  space store, *w = &store;
  num from[3][3], normal[4][3];
  tet_dyadic_begin(w);
  differences(w, v, 3, from);
  normals(w, from, normal + 1);
  for (int k = 0; k < 3; k++) {
    num sum = tet_dyadic_add(w, normal[1][k], normal[2][k]);
    normal[0][k] = tet_dyadic_neg(tet_dyadic_add(w, sum, normal[3][k]));
  }
  for (int i = 0; i < 4; i++) about_one(normal[i], ret[i]);
}

/* (b - a) x (c - a) */
static void triangle_normal(space *w, const double a[3], const double b[3], const double c[3], num ret[3]) {
  const double *const x[3] = {a, b, c};
  num from[2][3];
  differences(w, x, 2, from);
  tet_dyadic_cross(w, from[0], from[1], ret);
}

void tet_unit_normal(const double a[3], const double b[3], const double c[3], double ret[3]) {
  double u[3], v[3];
  tet_minus(b, a, u);
  tet_minus(c, a, v);
  tet_cross(u, v, ret);
  double square = tet_square(ret), least = TET_SURE_SHAPE * tet_square(u) * tet_square(v);
  if (!(least > 0 && square > fmax(least, 0x1p-450) && square < 0x1p450)) {
    space store;
    num normal[3];
    tet_dyadic_begin(&store);
    triangle_normal(&store, a, b, c, normal);
    about_one(normal, ret);
    square = tet_square(ret);
  }
  for (int k = 0; k < 3 && square > 0; k++) ret[k] /= sqrt(square);
}

/* tet_longest_axis of n, or -1 where doubles, wrong by up to `error`, do not tell. */
static int sure_axis(const double n[3], const double error[3]) {
  int k = tet_longest_axis(n);
  for (int i = 0; i < 3; i++)
    if (i != k && !(fabs(n[k]) - error[k] > fabs(n[i]) + error[i])) return -1;
  return fabs(n[k]) > 0x1p-900 && fabs(n[k]) < 0x1p900 ? k : -1;
}

int tet_widest_axis(const double a[3], const double b[3], const double c[3]) {
  double u[3], v[3], n[3], error[3];
  tet_minus(b, a, u);
  tet_minus(c, a, v);
  tet_cross(u, v, n);
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    error[k] = 8 * DBL_EPSILON * (fabs(u[i] * v[j]) + fabs(u[j] * v[i]));
  }
  int axis = sure_axis(n, error);
  if (axis >= 0) return axis;
  space store, *w = &store;
  num normal[3];
  tet_dyadic_begin(w);
  triangle_normal(w, a, b, c, normal);
  axis = 0;
  for (int k = 0; k < 3; k++) {
    if (normal[k].sign < 0) normal[k] = tet_dyadic_neg(normal[k]);
    if (tet_dyadic_sub(w, normal[k], normal[axis]).sign > 0) axis = k;
  }
  return axis;
}
