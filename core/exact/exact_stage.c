// SPDX-License-Identifier: Apache-2.0
// The exact stage of the predicates. Points are translated by one of them, exactly;
// then each predicate is a polynomial of the differences, evaluated without
// rounding. An implicit point is a + t (b - a), a polynomial itself, so nothing is
// divided (compare Attene 2020, where intersections need denominators).
#include "exact/exact_stage.h"

typedef tet_dyadic_space space;
typedef tet_dyadic num;

/* Products and sums in the space w of the calling function. */
#define MUL(a, b) tet_dyadic_mul(w, a, b)
#define ADD(a, b) tet_dyadic_add(w, a, b)
#define SUB(a, b) tet_dyadic_sub(w, a, b)

/* A row of differences for each point but the one at `origin`. */
static void translate(space *w, const tet_point_ref *point, int count, int origin,
                      tet_dyadic_point *rows) {
  int32_t exp = tet_common_exponent(point, count);
  tet_dyadic_point o = tet_exact_point(w, &point[origin], exp);
  for (int i = 0, row = 0; i < count; i++) {
    if (i == origin)
      continue;
    tet_dyadic_point q = tet_exact_point(w, &point[i], exp);
    for (int k = 0; k < 3; k++)
      rows[row].x[k] = SUB(q.x[k], o.x[k]);
    row++;
  }
}

/* An explicit point, so that fewer rows grow by its length; else the first. */
static int best_origin(const tet_point_ref *point, int count) {
  for (int i = 0; i < count; i++) {
    if (!point[i].b)
      return i;
  }
  return 0;
}

static num minor(space *w, const tet_dyadic_point *a, const tet_dyadic_point *b, int i, int j) {
  return SUB(MUL(a->x[i], b->x[j]), MUL(a->x[j], b->x[i]));
}

/* The determinant of rows a, b, c from their minors in columns 0 and 1. */
static num determinant(space *w, const tet_dyadic_point *a, const tet_dyadic_point *b,
                       const tet_dyadic_point *c, num ab, num ac, num bc) {
  return ADD(SUB(MUL(a->x[2], bc), MUL(b->x[2], ac)), MUL(c->x[2], ab));
}

static num dot(space *w, const tet_dyadic_point *a, const tet_dyadic_point *b) {
  return ADD(ADD(MUL(a->x[0], b->x[0]), MUL(a->x[1], b->x[1])), MUL(a->x[2], b->x[2]));
}

int tet_exact_orient3d(const tet_point_ref point[4]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[3];
  int origin = best_origin(point, 4);
  translate(w, point, 4, origin, r);
  num ab = minor(w, &r[0], &r[1], 0, 1);
  num ac = minor(w, &r[0], &r[2], 0, 1);
  num bc = minor(w, &r[1], &r[2], 0, 1);
  num det = determinant(w, &r[0], &r[1], &r[2], ab, ac, bc);
  return origin % 2 == 0 ? det.sign : -det.sign;
}

int tet_exact_insphere(const tet_point_ref point[5]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[4];
  int origin = best_origin(point, 5);
  translate(w, point, 5, origin, r);
  num m01 = minor(w, &r[0], &r[1], 0, 1), m02 = minor(w, &r[0], &r[2], 0, 1);
  num m03 = minor(w, &r[0], &r[3], 0, 1), m12 = minor(w, &r[1], &r[2], 0, 1);
  num m13 = minor(w, &r[1], &r[3], 0, 1), m23 = minor(w, &r[2], &r[3], 0, 1);
  num d0 = determinant(w, &r[1], &r[2], &r[3], m12, m13, m23);
  num d1 = determinant(w, &r[0], &r[2], &r[3], m02, m03, m23);
  num d2 = determinant(w, &r[0], &r[1], &r[3], m01, m03, m13);
  num d3 = determinant(w, &r[0], &r[1], &r[2], m01, m02, m12);
  num first = SUB(MUL(dot(w, &r[0], &r[0]), d0), MUL(dot(w, &r[1], &r[1]), d1));
  num second = SUB(MUL(dot(w, &r[2], &r[2]), d2), MUL(dot(w, &r[3], &r[3]), d3));
  num det = ADD(first, second);
  return origin % 2 == 0 ? det.sign : -det.sign;
}

int tet_exact_orient2d(int axis, const tet_point_ref point[3]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[2];
  int origin = best_origin(point, 3);
  translate(w, point, 3, origin, r);
  num det = minor(w, &r[0], &r[1], (axis + 1) % 3, (axis + 2) % 3);
  return origin % 2 == 0 ? det.sign : -det.sign;
}

int tet_exact_dot_sign(const tet_point_ref point[3]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[2];
  translate(w, point, 3, 2, r);
  return dot(w, &r[0], &r[1]).sign;
}

int tet_exact_compare_distance(const tet_point_ref point[3]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[2];
  translate(w, point, 3, 0, r);
  return SUB(dot(w, &r[0], &r[0]), dot(w, &r[1], &r[1])).sign;
}

/* The circumcentre of triangle abc in its plane, seen from a, is
 *   (uu (v x n) + vv (n x u)) / (2 nn),  u = b - a, v = c - a, n = u x v,
 * and d = a + w is inside the ball about it iff ww nn < w . (uu (v x n) + vv (n x u)).
 * With v x n = vv u - uv v and n x u = uu v - uv u only dot products remain. For
 * parallel u and v the whole vanishes. */
int tet_exact_diametric_ball3(const tet_point_ref point[4]) {
  space store, *w = &store;
  tet_dyadic_begin(w);
  tet_dyadic_point r[3];
  translate(w, point, 4, 0, r);
  num uu = dot(w, &r[0], &r[0]), vv = dot(w, &r[1], &r[1]), ww = dot(w, &r[2], &r[2]);
  num uv = dot(w, &r[0], &r[1]), uw = dot(w, &r[0], &r[2]), vw = dot(w, &r[1], &r[2]);
  num first = MUL(uu, SUB(MUL(vv, uw), MUL(uv, vw)));
  num second = MUL(vv, SUB(MUL(uu, vw), MUL(uv, uw)));
  num third = MUL(ww, SUB(MUL(uu, vv), MUL(uv, uv)));
  return SUB(ADD(first, second), third).sign;
}
