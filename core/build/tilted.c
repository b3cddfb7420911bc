// SPDX-License-Identifier: Apache-2.0
/* tilted.c: what a tilted box is, and when two are apart: along an axis of one of them. The nine
 * other axes of the separating axis theorem are left out: it prunes, and decides nothing. */
#include "build/tilted.h"

#include <math.h>

#include "base/vector.h"

/* v over its largest component, then over its length; 0 where it is none. */
static int normalise(double v[3]) {
  double most = tet_longest(v);
  if (!(most > 0)) return 0;
  for (int k = 0; k < 3; k++) v[k] /= most;
  double length = sqrt(tet_square(v));
  for (int k = 0; k < 3; k++) v[k] /= length;
  return 1;
}

/* Some direction at a right angle to u. */
static void any_across(const double u[3], double ret[3]) {
  int least = 0;
  double e[3] = {0, 0, 0};
  for (int k = 1; k < 3; k++)
    if (fabs(u[k]) < fabs(u[least])) least = k;
  e[least] = 1;
  tet_cross(u, e, ret);
  normalise(ret);
}

void tet_tilted_begin(const double *const *x, uint32_t n, tet_tilted *ret_box) {
  double most = -1, longest = -1, (*axis)[3] = ret_box->axis;
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 3; j++) axis[k][j] = j == k;
    ret_box->lo[k] = INFINITY;
    ret_box->hi[k] = -INFINITY;
  }
  for (uint32_t i = 0; i < n; i++) {
    double side[3], normal[3], d[3], size = -1;
    tet_minus(x[3 * i + 1], x[3 * i], side);
    tet_minus(x[3 * i + 2], x[3 * i], d);
    tet_cross(side, d, normal);
    double area = tet_square(normal);
    for (int k = 0; k < 3; k++) { /* its longest side */
      double e[3], length;
      tet_minus(x[3 * i + (uint32_t)(k + 1) % 3], x[3 * i + (uint32_t)k], e);
      length = tet_square(e);
      if (!(length > size)) continue;
      size = length;
      for (int j = 0; j < 3; j++) side[j] = e[j];
    }
    if (!(area > most) && !(area == most && size > longest)) continue;
    double u[3] = {side[0], side[1], side[2]};
    if (!normalise(u)) continue;
    most = area;
    longest = size;
    if (!normalise(normal)) any_across(u, normal);
    for (int k = 0; k < 3; k++) {
      axis[0][k] = u[k];
      axis[1][k] = normal[k];
    }
    tet_cross(u, normal, axis[2]);
    if (normalise(axis[2])) tet_cross(axis[2], u, axis[1]); /* at right angles to the last bits */
  }
}

void tet_tilted_add(tet_tilted *box, const double *p) {
  for (int k = 0; k < 3; k++) {
    double along = tet_dot(box->axis[k], p);
    box->lo[k] = fmin(box->lo[k], along);
    box->hi[k] = fmax(box->hi[k], along);
  }
}

int tet_tilted_apart(const tet_tilted *a, const tet_tilted *b, double most) {
  double slack = 1e-13 * most; /* of products of coordinates with axes, several times over */
  for (int side = 0; side < 2; side++) {
    const tet_tilted *p = side ? b : a, *q = side ? a : b;
    for (int k = 0; k < 3; k++) {
      double middle = 0, reach = 0;
      for (int j = 0; j < 3; j++) {
        double turn = tet_dot(p->axis[k], q->axis[j]);
        middle += turn * (0.5 * q->lo[j] + 0.5 * q->hi[j]);
        reach += fabs(turn) * (0.5 * q->hi[j] - 0.5 * q->lo[j]);
      }
      if (middle - reach > p->hi[k] + slack || middle + reach < p->lo[k] - slack) return 1;
    }
  }
  return 0;
}
