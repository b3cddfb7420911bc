// SPDX-License-Identifier: Apache-2.0
/* facet_plane.c: the plane of a facet. An exactly flat facet is projected as it is;
 * another one goes by Newell's normal of its largest polygon (epsilon geometry,
 * thesis A.1.2), and its largest distance from that plane is measured. */
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "build/facet_work.h"
#include "exact/predicates.h"
#include "exact/shape.h"

/* (b - a) / scale */
static void difference(const tet_soup *s, uint32_t a, uint32_t b, double scale, double d[3]) {
  for (int k = 0; k < 3; k++) d[k] = (tet_soup_x(s, b)[k] - tet_soup_x(s, a)[k]) / scale;
}

/* A scale for the coordinates of the soup. */
static double soup_scale(const tet_soup *s) { return s->points->max_abs > 0 ? s->points->max_abs : 1.0; }

void tet_soup_normal(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c, double ret_n[3]) {
  double u[3], v[3];
  difference(s, a, b, 1.0, u);
  difference(s, a, c, 1.0, v);
  double scale = fmax(tet_longest(u), tet_longest(v));
  if (scale == 0) scale = 1.0;
  for (int k = 0; k < 3; k++) {
    u[k] /= scale;
    v[k] /= scale;
  }
  tet_cross(u, v, ret_n);
}

int tet_projection_axis(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c, int *ret_axis) {
  *ret_axis = tet_widest_axis(tet_soup_x(s, a), tet_soup_x(s, b), tet_soup_x(s, c));
  return tet_orient2d(s->points, *ret_axis, a, b, c);
}

uint32_t tet_corner_off(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c) {
  double n[3], d[3], best = -1.0;
  uint32_t off = TET_NONE;
  tet_soup_normal(s, a, b, c, n);
  for (int k = 0; k < 4; k++) {
    difference(s, a, s->corner[k], soup_scale(s), d);
    double height = fabs(tet_dot(n, d));
    if (height > best && tet_orient3d(s->points, a, b, c, s->corner[k]) != 0) {
      best = height;
      off = s->corner[k];
    }
  }
  return off;
}

/* The used vertex of largest measure: distance from corner 0, from the line through
 * corners 0 and 1, from the plane through the first three (`known` of them). */
static uint32_t farthest(const tet_soup *s, int known) {
  double best = 0, scale = soup_scale(s), u[3] = {0}, v[3], d[3], n[3] = {0};
  uint32_t found = TET_NONE;
  if (known > 1) difference(s, s->corner[0], s->corner[1], scale, u);
  if (known > 2) {
    difference(s, s->corner[0], s->corner[2], scale, v);
    tet_cross(u, v, n);
  }
  for (uint32_t w = 0; w < s->points->n; w++) {
    if (!s->used[w]) continue;
    difference(s, s->corner[0], w, scale, d);
    double measure = tet_dot(d, d);
    if (known == 2) {
      tet_cross(u, d, v);
      measure = tet_dot(v, v);
    } else if (known == 3) {
      measure = fabs(tet_dot(n, d));
    }
    if (measure > best) {
      best = measure;
      found = w;
    }
  }
  return found;
}

/* The first used vertex that makes the corners independent, exactly. */
static uint32_t independent(const tet_soup *s, int known) {
  const uint32_t *c = s->corner;
  for (uint32_t w = 0; w < s->points->n; w++) {
    if (!s->used[w]) continue;
    if (known == 1 && w != c[0]) return w;
    if (known == 2 && !tet_collinear(s->points, c[0], c[1], w)) return w;
    if (known == 3 && tet_orient3d(s->points, c[0], c[1], c[2], w) != 0) return w;
  }
  return TET_NONE;
}

tet_status tet_find_corners(tet_soup *s) {
  uint32_t *c = s->corner;
  for (c[0] = 0; c[0] < s->points->n && !s->used[c[0]]; c[0]++) continue;
  if (c[0] == s->points->n) return tet_fail(s->ctx, TET_E_DEGENERATE, "no vertex is used");
  for (int known = 1; known < 4; known++) {
    c[known] = farthest(s, known);
    int exact = c[known] != TET_NONE;
    if (exact && known == 2) exact = !tet_collinear(s->points, c[0], c[1], c[2]);
    if (exact && known == 3) exact = tet_orient3d(s->points, c[0], c[1], c[2], c[3]) != 0;
    if (!exact) c[known] = independent(s, known);
    if (c[known] == TET_NONE) return tet_fail(s->ctx, TET_E_DEGENERATE, "all vertices lie in one plane");
  }
  return TET_OK;
}

/* Newell's area vector of loop l, scaled, about its first vertex. */
static void newell(const tet_facet_work *w, uint32_t l, double n[3]) {
  const uint32_t *v = w->loop + w->loop_start[l];
  uint32_t m = w->loop_start[l + 1] - w->loop_start[l];
  double p[3], q[3], c[3], scale = w->scale;
  n[0] = n[1] = n[2] = 0;
  for (uint32_t i = 1; i + 1 < m; i++) {
    difference(w->s, v[0], v[i], scale, p);
    difference(w->s, v[0], v[i + 1], scale, q);
    tet_cross(p, q, c);
    for (int k = 0; k < 3; k++) n[k] += c[k];
  }
}

/* The largest loop, and its normal; without loops of 3 and more, TET_NONE. */
static uint32_t largest_loop(const tet_facet_work *w, double ret_n[3]) {
  uint32_t best = TET_NONE;
  double most = -1.0, n[3];
  for (uint32_t l = 0; l < w->n_loops; l++) {
    if (w->loop_start[l + 1] - w->loop_start[l] < 3) continue;
    newell(w, l, n);
    double area = tet_dot(n, n);
    if (area <= most) continue;
    most = area;
    best = l;
    memcpy(ret_n, n, sizeof n);
  }
  return best;
}

/* Three vertices that span the facet well: the first, the farthest from it, and the
 * one farthest from their line. 0: all are on one line. */
static int spanning_triangle(const tet_facet_work *w, uint32_t n_own, uint32_t t[3]) {
  double best = 0, scale = w->scale, d[3], u[3], c[3];
  t[0] = t[1] = w->global[0];
  for (uint32_t i = 1; i < n_own; i++) {
    difference(w->s, t[0], w->global[i], scale, d);
    if (tet_dot(d, d) <= best && t[1] != t[0]) continue;
    best = tet_dot(d, d);
    t[1] = w->global[i];
  }
  if (t[1] == t[0]) return 0;
  difference(w->s, t[0], t[1], scale, u);
  t[2] = TET_NONE;
  best = 0;
  for (uint32_t i = 1; i < n_own; i++) {
    difference(w->s, t[0], w->global[i], scale, d);
    tet_cross(u, d, c);
    if (tet_dot(c, c) <= best) continue;
    best = tet_dot(c, c);
    t[2] = w->global[i];
  }
  if (t[2] != TET_NONE && !tet_collinear(w->s->points, t[0], t[1], t[2])) return 1;
  for (uint32_t i = 1; i < n_own; i++) {
    t[2] = w->global[i];
    if (!tet_collinear(w->s->points, t[0], t[1], t[2])) return 1;
  }
  return 0;
}

/* Largest distance of the facet's own vertices from the plane with normal n through
 * their mean. */
static double measure_deviation(const tet_facet_work *w, uint32_t n_own, const double n[3]) {
  double scale = w->scale, mean = 0, most = 0, d[3], length = sqrt(tet_dot(n, n));
  if (length == 0) return INFINITY;
  for (uint32_t i = 0; i < n_own; i++) {
    difference(w->s, w->global[0], w->global[i], scale, d);
    mean += tet_dot(n, d) / length / (double)n_own;
  }
  for (uint32_t i = 0; i < n_own; i++) {
    difference(w->s, w->global[0], w->global[i], scale, d);
    most = fmax(most, fabs(tet_dot(n, d) / length - mean));
  }
  return most * scale;
}

/* Makes n orthogonal to the facet's longest direction: the normal of a needle is noise along it, and that
 * times its length no deviation. */
static void straighten(const tet_facet_work *w, const uint32_t t[3], double n[3]) {
  double u[3];
  difference(w->s, t[0], t[1], w->scale, u);
  double share = tet_dot(n, u) / tet_dot(u, u);
  for (int k = 0; k < 3; k++) n[k] -= share * u[k];
}

void tet_facet_plane(tet_facet_work *w, int *ret_area) {
  const tet_points *points = w->s->points;
  uint32_t *t = w->span, n_own = w->n; /* vertices that join lie on it; foreign ones come later */
  double n[3];
  w->scale = 0;
  for (uint32_t i = 1; i < n_own; i++) {
    difference(w->s, w->global[0], w->global[i], 1.0, n);
    w->scale = fmax(w->scale, tet_longest(n));
  }
  *ret_area = w->scale > 0 && spanning_triangle(w, n_own, t);
  w->deviation = 0;
  w->flat = 1;
  if (!*ret_area) return;
  for (uint32_t i = 0; i < n_own && w->flat; i++)
    w->flat = tet_orient3d(points, t[0], t[1], t[2], w->global[i]) == 0;
  if (w->flat) {
    tet_projection_axis(w->s, t[0], t[1], t[2], &w->axis);
    return;
  }
  if (largest_loop(w, n) == TET_NONE) tet_soup_normal(w->s, t[0], t[1], t[2], n);
  straighten(w, t, n);
  w->axis = tet_longest_axis(n);
  w->deviation = measure_deviation(w, n_own, n);
}
