// SPDX-License-Identifier: Apache-2.0
// Exact coordinates of explicit and implicit points, and the rounding of implicit
// ones to doubles. Implicit points rest on the ends of their input segment, never on
// other implicit points: one interpolation without division is all there is.
#include "exact/exact_points.h"

#include <limits.h>
#include <math.h>

static int32_t least_exponent(const double *x, int32_t least) {
  for (int k = 0; k < 3; k++) {
    uint64_t m;
    int32_t e;
    if (tet_double_parts(x[k], &m, &e) != 0 && e < least)
      least = e;
  }
  return least;
}

int32_t tet_common_exponent(const tet_point_ref *points, int count) {
  int32_t least = INT_MAX;
  for (int i = 0; i < count; i++) {
    least = least_exponent(points[i].a, least);
    if (points[i].b)
      least = least_exponent(points[i].b, least);
  }
  return least == INT_MAX ? 0 : least;
}

/* a + t (b - a) with a and b at the exponent `exp`. */
static tet_dyadic interpolate(tet_dyadic_space *w, double a, double b, tet_dyadic t, int32_t exp) {
  tet_dyadic from = tet_dyadic_from_double(w, a, exp);
  if (a == b)
    return tet_dyadic_add(w, from, tet_dyadic_zero(exp + t.exp));
  tet_dyadic step = tet_dyadic_sub(w, tet_dyadic_from_double(w, b, exp), from);
  return tet_dyadic_add(w, from, tet_dyadic_mul(w, t, step));
}

tet_dyadic_point tet_exact_point(tet_dyadic_space *w, const tet_point_ref *point, int32_t exp) {
  tet_dyadic_point r;
  if (!point->b) {
    for (int k = 0; k < 3; k++)
      r.x[k] = tet_dyadic_from_double(w, point->a[k], exp);
    return r;
  }
  tet_dyadic t = tet_dyadic_from_double_reduced(w, point->t);
  for (int k = 0; k < 3; k++)
    r.x[k] = interpolate(w, point->a[k], point->b[k], t, exp);
  return r;
}

void tet_segment_point_round(const tet_points *p, const tet_segment_point *s, double out[3]) {
  tet_dyadic_space w;
  tet_dyadic_begin(&w);
  tet_point_ref ref = {.a = p->x + 3 * (size_t)s->a, .b = p->x + 3 * (size_t)s->b, .t = s->t};
  tet_dyadic t = tet_dyadic_from_double_reduced(&w, ref.t);
  for (int k = 0; k < 3; k++) {
    if (ref.a[k] == ref.b[k]) {
      out[k] = ref.a[k];
      continue;
    }
    int32_t least = INT_MAX;
    uint64_t m;
    int32_t e;
    if (tet_double_parts(ref.a[k], &m, &e) != 0)
      least = e;
    if (tet_double_parts(ref.b[k], &m, &e) != 0 && e < least)
      least = e;
    tet_dyadic x = interpolate(&w, ref.a[k], ref.b[k], t, least);
    out[k] = tet_dyadic_to_double(&x);
  }
}

/* 1: plane k is one of those from `from` on, before `to`. */
static int is_among(const uint32_t *of, uint32_t from, uint32_t to, uint32_t k) {
  while (from < to) {
    uint32_t mid = from + (to - from) / 2;
    if (of[mid] == k)
      return 1;
    if (of[mid] < k)
      from = mid + 1;
    else
      to = mid;
  }
  return 0;
}

/* 1: three of the vertices are on the segment of the implicit point i of them. */
static int are_on_segment(const tet_points *p, const uint32_t v[4], int i) {
  const tet_segment_point *s = p->implicit + (v[i] - p->first_implicit);
  int n = 0;
  for (int j = 0; j < 4; j++) {
    const tet_segment_point *q = tet_is_implicit(p, v[j]) ? p->implicit + (v[j] - p->first_implicit) : 0;
    n += q ? q->a == s->a && q->b == s->b : v[j] == s->a || v[j] == s->b;
  }
  return n >= 3;
}

int tet_are_in_one_plane(const tet_points *p, const uint32_t v[4]) {
  uint32_t on[8], fewest = 0;
  int n = 0;
  for (int i = 0; i < 4; i++) { /* the explicit vertices that the others rest on */
    if (!tet_is_implicit(p, v[i])) {
      on[n++] = v[i];
      continue;
    }
    if (are_on_segment(p, v, i))
      return 1;
    const tet_segment_point *s = p->implicit + (v[i] - p->first_implicit);
    on[n++] = s->a;
    on[n++] = s->b;
  }
  if (!p->planes)
    return 0;
  const uint32_t *start = p->planes->start, *of = p->planes->of;
  for (int i = 1; i < n; i++) {
    if (start[on[i] + 1] - start[on[i]] < start[on[fewest] + 1] - start[on[fewest]])
      fewest = (uint32_t)i;
  }
  for (uint32_t k = start[on[fewest]]; k < start[on[fewest] + 1]; k++) {
    int i = 0;
    while (i < n && is_among(of, start[on[i]], start[on[i] + 1], of[k]))
      i++;
    if (i == n)
      return 1;
  }
  return 0;
}

/* Useless where the largest coordinate is more than this many grains. */
#define MOST_GRAINS 0x1p42

void tet_points_find_grain(tet_points *p) {
  uint32_t n = p->n < p->first_implicit ? p->n : p->first_implicit;
  int32_t least = INT_MAX;
  double most = 0, grain = 0;
  p->grain3 = p->grain5 = 0;
  for (size_t i = 0; i < 3 * (size_t)n; i++) {
    uint64_t m;
    int32_t e;
    if (tet_double_parts(p->x[i], &m, &e) == 0)
      continue;
    most = fabs(p->x[i]) > most ? fabs(p->x[i]) : most;
    if (e < least) {
      least = e;
      grain = ldexp(1, e);
    }
    if (!(most <= grain * MOST_GRAINS))
      return;
  }
  if (least < -80 || least > 80) /* keeps the powers away from underflow */
    return;
  p->grain3 = grain * grain * grain;
  p->grain5 = p->grain3 * grain * grain;
}
