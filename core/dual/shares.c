// SPDX-License-Identifier: Apache-2.0
/* shares.c: see shares.h. With vertex 0 as the origin and a, b, c the others,
 *
 *   2 det (circumcentre) = q = |a|^2 (b x c) + |b|^2 (c x a) + |c|^2 (a x b),
 *
 * and with N the inward normal of a face, of twice its area, and D = (x_i - x_k).(x_j - x_k),
 *
 *   cot(angle at k) h = D (q - 2 det x) . N / (2 det N.N),   x any vertex of the face:
 *
 * a quotient of polynomials, without a root. The circumcentre of an almost flat tetrahedron
 * is noise in doubles, while its parts must cancel those of its neighbours; there the
 * polynomials are evaluated exactly. */
#include "dual/shares.h"

#include "base/vector.h"
#include "exact/dyadic_vector.h"

#include <math.h>
#include <stddef.h>

const uint8_t tet_edge[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};

/* What the shares are made of, rounded. */
typedef struct parts {
  double height[4]; /* (q - 2 det x) . N */
  double normal[4]; /* N . N */
  double dot[4][6]; /* D at vertex k of edge e; only where k is not on e */
  double q[3], det;
} parts;

/* Doubles serve while the sine of the solid corner at vertex 0 is above this: the error of
 * the circumcentre is then below 2^7 roundings of the longest edge. */
#define LEAST_SINE 0x1p-7
#define BOUND_DOUBLE 0x1p-42 /* of radius / least sine of an angle; with the rounding of sums */
#define BOUND_EXACT 0x1p-47

static double square(const double a[3]) { return tet_dot(a, a); }

/* The parts in doubles; 0 where these would not do. */
static int parts_double(const double *const x[4], parts *p) {
  double a[3], b[3], c[3], ab[3], ac[3], n[4][3];
  tet_minus(x[1], x[0], a);
  tet_minus(x[2], x[0], b);
  tet_minus(x[3], x[0], c);
  tet_cross(b, c, n[1]);
  p->det = tet_dot(a, n[1]);
  double aa = square(a), bb = square(b), cc = square(c);
  if (!(p->det > 0x1p-300 && aa + bb + cc < 0x1p200) || p->det * p->det < LEAST_SINE * LEAST_SINE * (aa * bb * cc))
    return 0;
  tet_minus(x[2], x[1], ab);
  tet_minus(x[3], x[1], ac);
  tet_cross(ac, ab, n[0]);
  tet_cross(c, a, n[2]);
  tet_cross(a, b, n[3]);
  double from1[3];
  for (int k = 0; k < 3; k++) {
    p->q[k] = aa * n[1][k] + bb * n[2][k] + cc * n[3][k];
    from1[k] = p->q[k] - 2 * p->det * a[k];
  }
  for (int f = 0; f < 4; f++) {
    p->height[f] = tet_dot(f ? p->q : from1, n[f]);
    p->normal[f] = square(n[f]);
  }
  for (int e = 0; e < 6; e++)
    for (int side = 2; side < 4; side++) {
      double u[3], w[3];
      int k = tet_edge[e][side];
      tet_minus(x[tet_edge[e][0]], x[k], u);
      tet_minus(x[tet_edge[e][1]], x[k], w);
      p->dot[k][e] = tet_dot(u, w);
    }
  return 1;
}

typedef tet_dyadic_space space;
typedef tet_dyadic num;

/* The dot product rounded; its limbs are given back. */
static double rounded_dot(space *w, const num a[3], const num b[3]) {
  uint64_t *top = w->top;
  num d = tet_dyadic_dot(w, a, b);
  double value = tet_dyadic_to_double(&d);
  w->top = top;
  return value;
}

/* The parts of x, each the nearest double. 0: not positive. */
static int parts_exact(double x[4][3], parts *p) {
  space store, *w = &store;
  num at[4][3], from[3][3], ab[3], ac[3], n[4][3], q[3], from1[3];
  tet_dyadic_begin(w);
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) at[i][k] = tet_dyadic_from_double_reduced(w, x[i][k]);
  for (int i = 0; i < 3; i++) tet_dyadic_minus3(w, at[i + 1], at[0], from[i]);
  tet_dyadic_minus3(w, at[2], at[1], ab);
  tet_dyadic_minus3(w, at[3], at[1], ac);
  tet_dyadic_cross(w, ac, ab, n[0]);
  for (int i = 0; i < 3; i++) tet_dyadic_cross(w, from[(i + 1) % 3], from[(i + 2) % 3], n[i + 1]);
  num det = tet_dyadic_dot(w, from[0], n[1]), twice = tet_dyadic_add(w, det, det);
  if (det.sign <= 0) return 0;
  p->det = tet_dyadic_to_double(&det);
  num aa[3];
  for (int i = 0; i < 3; i++) aa[i] = tet_dyadic_dot(w, from[i], from[i]);
  for (int k = 0; k < 3; k++) {
    num column[3] = {n[1][k], n[2][k], n[3][k]};
    q[k] = tet_dyadic_dot(w, aa, column);
    p->q[k] = tet_dyadic_to_double(&q[k]);
    from1[k] = tet_dyadic_sub(w, q[k], tet_dyadic_mul(w, twice, from[0][k]));
  }
  for (int f = 0; f < 4; f++) {
    p->height[f] = rounded_dot(w, f ? q : from1, n[f]);
    p->normal[f] = rounded_dot(w, n[f], n[f]);
  }
  for (int e = 0; e < 6; e++)
    for (int side = 2; side < 4; side++) {
      uint64_t *top = w->top;
      int k = tet_edge[e][side];
      num u[3], v[3];
      tet_dyadic_minus3(w, at[tet_edge[e][0]], at[k], u);
      tet_dyadic_minus3(w, at[tet_edge[e][1]], at[k], v);
      p->dot[k][e] = rounded_dot(w, u, v);
      w->top = top;
    }
  return 1;
}

/* The shares from the parts, times `unit`. */
static void combine(const parts *p, double unit, double accuracy, tet_shares *ret) {
  double of_face[4], steepest = 0; /* square of the largest cotangent */
  for (int f = 0; f < 4; f++) of_face[f] = p->height[f] / p->normal[f] / (8 * p->det) * unit;
  for (int e = 0; e < 6; e++) {
    int k = tet_edge[e][2], l = tet_edge[e][3];
    double at_k = p->dot[k][e], at_l = p->dot[l][e];
    ret->edge[e] = at_k * of_face[l] + at_l * of_face[k];
    steepest = fmax(steepest, fmax(at_k * at_k / p->normal[l], at_l * at_l / p->normal[k]));
  }
  double radius = sqrt(square(p->q)) / (2 * p->det) * unit;
  ret->bound = accuracy * radius * sqrt(1 + steepest);
  for (int k = 0; k < 3; k++) ret->centre[k] = p->q[k] / (2 * p->det) * unit;
}

int tet_shares_of(const double *points, const uint32_t v[4], tet_shares *ret) {
  const double *x[4];
  parts p;
  for (int i = 0; i < 4; i++) x[i] = points + 3 * (size_t)v[i];
  if (parts_double(x, &p)) {
    combine(&p, 1, BOUND_DOUBLE, ret);
    return 1;
  }
  double longest = 0, scaled[4][3]; /* of about unit size, so that no rounding overflows */
  int exponent;
  for (int i = 1; i < 4; i++)
    for (int k = 0; k < 3; k++) longest = fmax(longest, fabs(x[i][k] - x[0][k]));
  frexp(longest, &exponent);
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) scaled[i][k] = ldexp(x[i][k], -exponent);
  if (!parts_exact(scaled, &p)) return 0;
  combine(&p, ldexp(1, exponent), BOUND_EXACT, ret);
  return 1;
}

void tet_corner_shares(const double a[3], const double b[3], const double c[3], double ret_shares[3],
                       double ret_centre[3]) {
  const double *x[3] = {a, b, c};
  double side[3][3], squared[3], dot[3], n[3]; /* side k is opposite corner k */
  for (int k = 0; k < 3; k++) {
    tet_minus(x[(k + 2) % 3], x[(k + 1) % 3], side[k]);
    squared[k] = square(side[k]);
  }
  for (int k = 0; k < 3; k++) dot[k] = -tet_dot(side[(k + 1) % 3], side[(k + 2) % 3]);
  int l = squared[0] > squared[1] ? squared[0] > squared[2] ? 0 : 2 : squared[1] > squared[2] ? 1 : 2;
  tet_cross(side[(l + 1) % 3], side[(l + 2) % 3], n); /* the two shorter sides lose the least */
  double nn = square(n), eighth = 0.125 / sqrt(nn);
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    ret_shares[k] = eighth * (squared[i] * dot[i] + squared[j] * dot[j]);
  }
  if (!ret_centre) return;
  for (int k = 0; k < 3; k++)
    ret_centre[k] = a[k] + (squared[1] * dot[1] * side[2][k] - squared[2] * dot[2] * side[1][k]) / (2 * nn);
}
