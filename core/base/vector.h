// SPDX-License-Identifier: Apache-2.0
/* vector.h: three-dimensional vectors in doubles, for what decides no sign. */
#ifndef TET_BASE_VECTOR_H
#define TET_BASE_VECTOR_H

#include <math.h>

/* d = a - b */
static inline void tet_minus(const double a[3], const double b[3], double d[3]) {
  for (int i = 0; i < 3; i++) d[i] = a[i] - b[i];
}

static inline double tet_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double tet_square(const double a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

static inline double tet_distance2(const double a[3], const double b[3]) {
  double d[3];
  tet_minus(a, b, d);
  return tet_square(d);
}

/* c = a x b; c is neither a nor b */
static inline void tet_cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* The longest coordinate of a: its size where the squares of small ones would be 0. */
static inline double tet_longest(const double a[3]) { return fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2]))); }

/* Which coordinate that is; of several the first. */
static inline int tet_longest_axis(const double a[3]) {
  int axis = fabs(a[1]) > fabs(a[0]);
  return fabs(a[2]) > fabs(a[axis]) ? 2 : axis;
}

/* d = a - b, a not b, over its longest coordinate, which is returned: products of lengths far apart are no doubles. */
static inline double tet_direction(const double a[3], const double b[3], double d[3]) {
  tet_minus(a, b, d);
  double longest = tet_longest(d);
  for (int k = 0; k < 3; k++) d[k] /= longest;
  return longest;
}

/* The sine of an angle up to 90 degrees by its series: the same bits everywhere, as what it bounds
 * decides where points go. */
static inline double tet_sine_of_degrees(double degrees) {
  double x = degrees * (3.14159265358979323846 / 180), term = x, sum = x;
  for (int k = 1; k < 12; k++) {
    term *= -x * x / (2 * k * (2 * k + 1));
    sum += term;
  }
  return sum;
}

#endif
