// SPDX-License-Identifier: Apache-2.0
// The predicates: quick.h or filter.h first; where these cannot tell, grid_stage.c if the
// points fit its grid; else exact_stage.c. The symbolic perturbation of insphere is
// here as well; it perturbs the lifted weights by vertex number (Devillers, Teillaud
// 2011), and nothing else.
#include "exact/predicates.h"

#include "exact/exact_stage.h"
#include "exact/filter.h"
#include "exact/grid_stage.h"
#include "exact/quick.h"
#include "exact/tally.h"

#include <math.h>

int tet_is_place(const double x[3]) {
  for (int i = 0; i < 3; i++)
    if (!(fabs(x[i]) <= TET_COORDINATE_LIMIT)) return 0; /* or no number */
  return 1;
}

static const double *xyz(const tet_points *p, uint32_t v) {
  return p->x + 3 * (size_t)v;
}

static inline uint32_t later(uint32_t v, uint32_t w) {
  return v > w ? v : w;
}

static inline void make_refs(const tet_points *p, const uint32_t *v, int n, tet_point_ref *ref) {
  for (int i = 0; i < n; i++)
    ref[i] = tet_ref(p, v[i]);
}

/* orient3d */

/* p is NULL where nobody counts. */
static int orient3d_exact(const tet_points *p, const tet_point_ref point[4]) {
  int sign;
  if (tet_grid_orient3d(point, &sign))
    return sign;
  tet_count(p, TET_TALLIED_DYADIC);
  return tet_exact_orient3d(point);
}

static __attribute__((noinline)) int orient3d_explicit_exact(const tet_points *p, const double *a,
                                                             const double *b, const double *c,
                                                             const double *d) {
  tet_count(p, TET_TALLIED_ORIENT3D_EXACT);
  for (int k = 0; k < 3; k++) { /* in an axis plane, as often in made-up models */
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k])
      return 0;
  }
  tet_point_ref ref[4] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c), tet_ref_xyz(d)};
  return orient3d_exact(p, ref);
}

int tet_orient3d_xyz(const double *a, const double *b, const double *c, const double *d) {
  int sign = tet_quick_orient3d(a, b, c, d, 0);
  return sign != TET_UNSURE ? sign : orient3d_explicit_exact(NULL, a, b, c, d);
}

static __attribute__((noinline)) int orient3d_implicit(const tet_points *p, const uint32_t v[4]) {
  const double *x[4];
  for (int i = 0; i < 4; i++)
    x[i] = xyz(p, v[i]);
  int sign = tet_quick_orient3d_moved(x);
  if (sign != TET_UNSURE)
    return sign;
  double d[9], r[9];
  for (int i = 0; i < 3; i++)
    tet_difference(p, v[i + 1], v[0], d + 3 * i, r + 3 * i);
  sign = tet_filter(tet_orient3d_value, tet_orient3d_majorant, d, r, 9, TET_ROUNDINGS_ORIENT3D);
  if (sign || tet_are_in_one_plane(p, v))
    return sign;
  tet_point_ref ref[4];
  make_refs(p, v, 4, ref);
  return orient3d_exact(p, ref);
}

int tet_orient3d(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  if (tet_is_implicit(p, later(later(a, b), later(c, d)))) {
    const uint32_t v[4] = {a, b, c, d};
    return orient3d_implicit(p, v);
  }
  const double *xa = xyz(p, a), *xb = xyz(p, b), *xc = xyz(p, c), *xd = xyz(p, d);
  int sign = tet_quick_orient3d(xa, xb, xc, xd, p->grain3);
  tet_count(p, TET_TALLIED_ORIENT3D);
  return sign != TET_UNSURE ? sign : orient3d_explicit_exact(p, xa, xb, xc, xd);
}

/* insphere */

static int insphere_exact(const tet_points *p, const tet_point_ref point[5]) {
  int sign;
  if (tet_grid_insphere(point, &sign))
    return sign;
  tet_count(p, TET_TALLIED_DYADIC);
  return tet_exact_insphere(point);
}

/* 1 if the points take at most two values on each axis: corners of a box, and so of a sphere. That
 * is how ties look on any grid of planes, also where its coordinates were rounded. */
static int on_box(const double *const x[5]) {
  for (int k = 0; k < 3; k++) {
    double one = x[0][k], other = one;
    for (int i = 1; i < 5; i++) {
      if (x[i][k] == one || x[i][k] == other)
        continue;
      if (other != one)
        return 0;
      other = x[i][k];
    }
  }
  return 1;
}

static __attribute__((noinline)) int insphere_explicit_exact(const tet_points *p, const double *a,
                                                             const double *b, const double *c,
                                                             const double *d, const double *e) {
  const double *const x[5] = {a, b, c, d, e};
  tet_count(p, TET_TALLIED_INSPHERE_EXACT);
  if (on_box(x))
    return 0;
  tet_point_ref ref[5] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c), tet_ref_xyz(d),
                          tet_ref_xyz(e)};
  return insphere_exact(p, ref);
}

int tet_insphere_xyz(const double *a, const double *b, const double *c, const double *d,
                     const double *e) {
  int sign = tet_quick_insphere(a, b, c, d, e, 0);
  return sign != TET_UNSURE ? sign : insphere_explicit_exact(NULL, a, b, c, d, e);
}

static __attribute__((noinline)) int insphere_implicit(const tet_points *p, const uint32_t v[5]) {
  const double *x[5];
  for (int i = 0; i < 5; i++)
    x[i] = xyz(p, v[i]);
  int sign = tet_quick_insphere_moved(x);
  if (sign != TET_UNSURE)
    return sign;
  double d[12], r[12];
  for (int i = 0; i < 4; i++)
    tet_difference(p, v[i], v[4], d + 3 * i, r + 3 * i);
  sign =
      tet_filter(tet_insphere_value, tet_insphere_majorant, d, r, 12, TET_ROUNDINGS_INSPHERE);
  if (sign)
    return sign;
  tet_point_ref ref[5];
  make_refs(p, v, 5, ref);
  return insphere_exact(p, ref);
}

int tet_insphere(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t e) {
  if (tet_is_implicit(p, later(later(later(a, b), later(c, d)), e))) {
    const uint32_t v[5] = {a, b, c, d, e};
    return insphere_implicit(p, v);
  }
  const double *xa = xyz(p, a), *xb = xyz(p, b), *xc = xyz(p, c), *xd = xyz(p, d), *xe = xyz(p, e);
  int sign = tet_quick_insphere(xa, xb, xc, xd, xe, p->grain5);
  tet_count(p, TET_TALLIED_INSPHERE);
  return sign != TET_UNSURE ? sign : insphere_explicit_exact(p, xa, xb, xc, xd, xe);
}

/* The lifted height of vertex v is raised by epsilon(v), where epsilon(v) is larger
 * than any multiple of epsilon(w) for w < v. insphere is linear in the heights, so the
 * vertex of the largest number whose coefficient is not zero decides. The coefficient
 * of e is -orient3d(a,b,c,d): raised, e leaves the sphere. Those of the others follow
 * by exchanging them with e, which also changes the sign. */
int tet_insphere_tie(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t e) {
  const uint32_t v[5] = {a, b, c, d, e};
  uint32_t rank[5];
  tet_count(p, TET_TALLIED_TIE);
  for (int i = 0; i < 5; i++)
    rank[i] = p->rank ? p->rank[v[i]] : v[i];
  int order[5] = {0, 1, 2, 3, 4}; /* places in v, by falling rank */
  for (int i = 1; i < 5; i++) {
    for (int j = i; j > 0 && rank[order[j - 1]] < rank[order[j]]; j--) {
      int t = order[j];
      order[j] = order[j - 1];
      order[j - 1] = t;
    }
  }
  for (int i = 1; i < 5; i++) {
    if (rank[order[i - 1]] == rank[order[i]])
      return 0;
  }
  for (int i = 0; i < 5; i++) {
    uint32_t q[5] = {v[0], v[1], v[2], v[3], v[4]};
    q[order[i]] = v[4];
    int sign = tet_orient3d(p, q[0], q[1], q[2], q[3]);
    if (sign)
      return order[i] == 4 ? -sign : sign;
  }
  return 0;
}

int tet_insphere_sos(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d,
                     uint32_t e) {
  int sign = tet_insphere(p, a, b, c, d, e);
  return sign ? sign : tet_insphere_tie(p, a, b, c, d, e);
}

/* orient2d and collinearity */

static int orient2d_exact(int axis, const tet_point_ref point[3]) {
  int sign;
  return tet_grid_orient2d(axis, point, &sign) ? sign : tet_exact_orient2d(axis, point);
}

int tet_orient2d_xyz(int axis, const double *a, const double *b, const double *c) {
  int i = (axis + 1) % 3, j = (axis + 2) % 3;
  double d[4] = {b[i] - a[i], b[j] - a[j], c[i] - a[i], c[j] - a[j]};
  int sign = tet_filter(tet_orient2d_value, tet_orient2d_majorant, d, 0, 4, TET_ROUNDINGS_ORIENT2D);
  if (sign)
    return sign;
  /* Two axis-parallel sides, or coincident points: differences are zero only exactly. */
  if ((d[0] == 0 || d[3] == 0) && (d[1] == 0 || d[2] == 0))
    return 0;
  tet_point_ref ref[3] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c)};
  return orient2d_exact(axis, ref);
}

static __attribute__((noinline)) int orient2d_implicit(const tet_points *p, int axis,
                                                       const uint32_t v[3]) {
  double d[6], r[6];
  for (int i = 0; i < 2; i++)
    tet_difference(p, v[i + 1], v[0], d + 3 * i, r + 3 * i);
  int i = (axis + 1) % 3, j = (axis + 2) % 3;
  double plane_d[4] = {d[i], d[j], d[3 + i], d[3 + j]};
  double plane_r[4] = {r[i], r[j], r[3 + i], r[3 + j]};
  int sign = tet_filter(tet_orient2d_value, tet_orient2d_majorant, plane_d, plane_r, 4,
                        TET_ROUNDINGS_ORIENT2D);
  if (sign)
    return sign;
  tet_point_ref ref[3];
  make_refs(p, v, 3, ref);
  return orient2d_exact(axis, ref);
}

int tet_orient2d(const tet_points *p, int axis, uint32_t a, uint32_t b, uint32_t c) {
  if (tet_is_implicit(p, later(later(a, b), c))) {
    const uint32_t v[3] = {a, b, c};
    return orient2d_implicit(p, axis, v);
  }
  return tet_orient2d_xyz(axis, xyz(p, a), xyz(p, b), xyz(p, c));
}

int tet_collinear_xyz(const double *a, const double *b, const double *c) {
  for (int axis = 0; axis < 3; axis++) {
    if (tet_orient2d_xyz(axis, a, b, c))
      return 0;
  }
  return 1;
}

int tet_collinear(const tet_points *p, uint32_t a, uint32_t b, uint32_t c) {
  for (int axis = 0; axis < 3; axis++) {
    if (tet_orient2d(p, axis, a, b, c))
      return 0;
  }
  return 1;
}

/* dot_sign */

static int dot_sign_exact(const tet_point_ref point[3]) {
  int sign;
  return tet_grid_dot_sign(point, &sign) ? sign : tet_exact_dot_sign(point);
}

int tet_dot_sign_xyz(const double *a, const double *b, const double *c) {
  double d[6];
  tet_minus(a, c, d);
  tet_minus(b, c, d + 3);
  int sign = tet_filter(tet_dot_value, tet_dot_majorant, d, 0, 6, TET_ROUNDINGS_DOT);
  if (sign)
    return sign;
  tet_point_ref ref[3] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c)};
  return dot_sign_exact(ref);
}

static __attribute__((noinline)) int dot_sign_implicit(const tet_points *p, const uint32_t v[3]) {
  double d[6], r[6];
  for (int i = 0; i < 2; i++)
    tet_difference(p, v[i], v[2], d + 3 * i, r + 3 * i);
  int sign = tet_filter(tet_dot_value, tet_dot_majorant, d, r, 6, TET_ROUNDINGS_DOT);
  if (sign)
    return sign;
  tet_point_ref ref[3];
  make_refs(p, v, 3, ref);
  return dot_sign_exact(ref);
}

int tet_dot_sign(const tet_points *p, uint32_t a, uint32_t b, uint32_t c) {
  if (tet_is_implicit(p, later(later(a, b), c))) {
    const uint32_t v[3] = {a, b, c};
    return dot_sign_implicit(p, v);
  }
  return tet_dot_sign_xyz(xyz(p, a), xyz(p, b), xyz(p, c));
}

/* compare_distance */

static int compare_distance_exact(const tet_point_ref point[3]) {
  int sign;
  return tet_grid_compare_distance(point, &sign) ? sign : tet_exact_compare_distance(point);
}

int tet_compare_distance_xyz(const double *a, const double *b, const double *c) {
  double d[6];
  tet_minus(b, a, d);
  tet_minus(c, a, d + 3);
  int sign = tet_filter(tet_compare_distance_value, tet_compare_distance_majorant, d, 0, 6,
                        TET_ROUNDINGS_COMPARE_DISTANCE);
  if (sign)
    return sign;
  tet_point_ref ref[3] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c)};
  return compare_distance_exact(ref);
}

static __attribute__((noinline)) int compare_distance_implicit(const tet_points *p,
                                                               const uint32_t v[3]) {
  double d[6], r[6];
  for (int i = 0; i < 2; i++)
    tet_difference(p, v[i + 1], v[0], d + 3 * i, r + 3 * i);
  int sign = tet_filter(tet_compare_distance_value, tet_compare_distance_majorant, d, r, 6,
                        TET_ROUNDINGS_COMPARE_DISTANCE);
  if (sign)
    return sign;
  tet_point_ref ref[3];
  make_refs(p, v, 3, ref);
  return compare_distance_exact(ref);
}

int tet_compare_distance(const tet_points *p, uint32_t a, uint32_t b, uint32_t c) {
  if (tet_is_implicit(p, later(later(a, b), c))) {
    const uint32_t v[3] = {a, b, c};
    return compare_distance_implicit(p, v);
  }
  return tet_compare_distance_xyz(xyz(p, a), xyz(p, b), xyz(p, c));
}

/* in_diametric_ball3 */

static int diametric_ball3_exact(const tet_point_ref point[4]) {
  int sign;
  return tet_grid_diametric_ball3(point, &sign) ? sign : tet_exact_diametric_ball3(point);
}

int tet_in_diametric_ball3_xyz(const double *a, const double *b, const double *c, const double *d) {
  double e[9];
  tet_minus(b, a, e);
  tet_minus(c, a, e + 3);
  tet_minus(d, a, e + 6);
  int sign = tet_filter(tet_ball3_value, tet_ball3_majorant, e, 0, 9, TET_ROUNDINGS_BALL3);
  if (sign)
    return sign;
  tet_point_ref ref[4] = {tet_ref_xyz(a), tet_ref_xyz(b), tet_ref_xyz(c), tet_ref_xyz(d)};
  return diametric_ball3_exact(ref);
}

static __attribute__((noinline)) int ball3_implicit(const tet_points *p, const uint32_t v[4]) {
  double d[9], r[9];
  for (int i = 0; i < 3; i++)
    tet_difference(p, v[i + 1], v[0], d + 3 * i, r + 3 * i);
  int sign = tet_filter(tet_ball3_value, tet_ball3_majorant, d, r, 9, TET_ROUNDINGS_BALL3);
  if (sign)
    return sign;
  tet_point_ref ref[4];
  make_refs(p, v, 4, ref);
  return diametric_ball3_exact(ref);
}

int tet_in_diametric_ball3(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  if (tet_is_implicit(p, later(later(a, b), later(c, d)))) {
    const uint32_t v[4] = {a, b, c, d};
    return ball3_implicit(p, v);
  }
  return tet_in_diametric_ball3_xyz(xyz(p, a), xyz(p, b), xyz(p, c), xyz(p, d));
}
