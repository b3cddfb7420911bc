// SPDX-License-Identifier: Apache-2.0
/* quality.c: radius-edge ratio (thesis 3.2.1), dihedral angles and aspect ratio
 * of every tetrahedron, and their histograms. In doubles, and by exact polynomials where these say nothing. */
#include "audit/quality.h"

#include "base/vector.h"
#include "exact/shape.h"

#include <math.h>
#include <string.h>

/* Normals n of the faces, inward and of any length, and their lengths, where doubles hold none. */
static void measure_faces_exactly(const double *const p[4], double n[4][3], double length[4]) {
  tet_normals_exactly(p, n);
  for (int i = 0; i < 4; i++) length[i] = sqrt(tet_dot(n[i], n[i]));
}

static inline double larger(double a, double b) { return a > b ? a : b; }

/* Circumradius, and six times the volume, signed, where doubles hold neither. */
static void measure_exactly(const double *const p[4], double *ret_radius, double *ret_det) {
  tet_exact_shape e = tet_shape_exactly(p);
  *ret_det = ldexp(e.volume6, -e.scale);
  *ret_radius = e.volume6 != 0 ? sqrt(tet_dot(e.to_centre, e.to_centre)) / (2 * fabs(e.volume6)) : INFINITY;
}

tet_shape tet_shape_of(const double *points, const uint32_t v[4]) {
  const double *p[4];
  for (int i = 0; i < 4; i++) p[i] = points + 3 * (size_t)v[i];
  double u[3][3], uu[3], n[4][3], area[4];
  double shortest = INFINITY, longest = 0;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      double e[3];
      tet_minus(p[j], p[i], e);
      double l = tet_dot(e, e);
      if (l < shortest) shortest = l;
      if (l > longest) longest = l;
    }
  for (int k = 0; k < 3; k++) tet_minus(p[k + 1], p[0], u[k]);
  for (int k = 0; k < 3; k++) uu[k] = tet_dot(u[k], u[k]);
  tet_cross(u[2], u[1], n[1]); /* n[i]: normal of face i, all outward, of length `area`, twice that */
  tet_cross(u[0], u[2], n[2]);
  tet_cross(u[1], u[0], n[3]);
  for (int k = 0; k < 3; k++) n[0][k] = -(n[1][k] + n[2][k] + n[3][k]);
  double det = -tet_dot(n[3], u[2]), largest = 0, smallest = INFINITY;
  for (int i = 0; i < 4; i++) {
    area[i] = sqrt(tet_dot(n[i], n[i]));
    if (area[i] > largest) largest = area[i];
    if (area[i] < smallest) smallest = area[i];
  }
  double centre[3]; /* from p[0], times 2 det */
  for (int k = 0; k < 3; k++) centre[k] = -(uu[0] * n[1][k] + uu[1] * n[2][k] + uu[2] * n[3][k]);
  double radius = det != 0 ? sqrt(tet_dot(centre, centre)) / (2 * fabs(det)) : INFINITY;
  if (!(det * det > TET_SURE_SHAPE * (uu[0] * uu[1] * uu[2]))) measure_exactly(p, &radius, &det);
  tet_shape s = {.volume = det / 6, .radius_edge = radius / sqrt(shortest), .aspect = INFINITY};
  if (det != 0) s.aspect = sqrt(longest) * largest / fabs(det);
  double most = larger(larger(uu[0] * uu[1], uu[1] * uu[2]), uu[2] * uu[0]);
  if (!(smallest * smallest > TET_SURE_SHAPE * most)) measure_faces_exactly(p, n, area);
  s.cos_smallest = -1;
  s.cos_largest = 1;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      double c = -tet_dot(n[i], n[j]) / (area[i] * area[j]);
      if (c > s.cos_smallest) s.cos_smallest = c;
      if (c < s.cos_largest) s.cos_largest = c;
    }
  if (s.cos_smallest > 1) s.cos_smallest = 1;
  if (s.cos_largest < -1) s.cos_largest = -1;
  return s;
}

static void histogram_begin(tet_histogram *h, const double *edges, uint32_t n_edges) {
  memset(h, 0, sizeof *h);
  h->n_bins = n_edges - 1;
  memcpy(h->edges, edges, n_edges * sizeof *edges);
  h->min = INFINITY;
  h->max = -INFINITY;
}

static void histogram_add(tet_histogram *h, double value) {
  uint32_t i = h->n_bins - 1;
  while (i > 0 && value < h->edges[i]) i--;
  h->bins[i]++;
  if (value < h->min) h->min = value;
  if (value > h->max) h->max = value;
}

/* An empty mesh has no extremes. */
static void histogram_end(tet_histogram *h) {
  if (h->min > h->max) h->min = h->max = 0;
}

#define COUNT(array) (sizeof(array) / sizeof *(array))

tet_status tet_measure_quality(tet_ctx *ctx, const tet_mesh *mesh, tet_quality *ret_quality) {
  static const double ratios[] = {0.6, 0.8, 1, 1.2, 1.4, 1.6, 1.8, 2, 2.5, 3, 4, 6, 10, 100, INFINITY};
  static const double smallest[] = {0, 1, 2, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 71};
  static const double largest[] = {70, 80, 90, 100, 110, 120, 130, 140, 150, 160, 165, 170, 175, 178, 179, 180};
  static const double aspects[] = {1.2, 1.5, 2, 2.5, 3, 4, 6, 10, 15, 25, 50, 100, 1000, 10000, INFINITY};
  const double degrees = 57.295779513082321;
  tet_quality q = {.volume = 0};
  histogram_begin(&q.radius_edge, ratios, COUNT(ratios));
  histogram_begin(&q.dihedral_min, smallest, COUNT(smallest));
  histogram_begin(&q.dihedral_max, largest, COUNT(largest));
  histogram_begin(&q.aspect, aspects, COUNT(aspects));
  for (uint32_t t = 0; t < mesh->n_tetrahedra; t++) {
    tet_status status = (t & 4095) == 0 ? tet_poll(ctx) : TET_OK;
    if (status != TET_OK) return status;
    tet_shape s = tet_shape_of(mesh->points, mesh->tetrahedra + 4 * (size_t)t);
    q.volume += s.volume;
    histogram_add(&q.radius_edge, s.radius_edge);
    histogram_add(&q.dihedral_min, degrees * acos(s.cos_smallest));
    histogram_add(&q.dihedral_max, degrees * acos(s.cos_largest));
    histogram_add(&q.aspect, s.aspect);
  }
  histogram_end(&q.radius_edge);
  histogram_end(&q.dihedral_min);
  histogram_end(&q.dihedral_max);
  histogram_end(&q.aspect);
  *ret_quality = q;
  return TET_OK;
}
