// SPDX-License-Identifier: Apache-2.0
/* maker.c: random boxes and point sets. */
#include "maker.h"

#include <math.h>
#include <string.h>

uint32_t maker_below(maker_random *r, uint32_t n) { return (uint32_t)(maker_unit(r) * n); }

double maker_unit(maker_random *r) { /* splitmix64 */
  uint64_t x = r->state += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static void begin(made_pls *p) {
  memset(p, 0, sizeof *p);
  p->pls.points = p->points[0];
  p->pls.point_attributes = p->attributes;
  p->pls.n_attributes = 1;
  p->pls.polygon_start = p->polygon_start;
  p->pls.polygon_vertices = p->polygon_vertices;
  p->pls.facet_markers = p->facet_markers;
  p->pls.holes = p->holes[0];
  p->pls.region_seeds = p->seeds[0];
  p->pls.region_markers = p->region_markers;
  p->pls.n_loose_points = TET_LOOSE_ALL_UNUSED;
}

static uint32_t add_point(made_pls *p, double x, double y, double z) {
  uint32_t v = p->pls.n_points++;
  p->points[v][0] = x;
  p->points[v][1] = y;
  p->points[v][2] = z;
  p->attributes[v] = x;
  return v;
}

static void add_quad(made_pls *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d, int32_t marker) {
  uint32_t f = p->pls.n_facets++, corner[4] = {a, b, c, d};
  memcpy(p->polygon_vertices + 4 * (size_t)f, corner, sizeof corner);
  p->polygon_start[f + 1] = 4 * (f + 1);
  p->facet_markers[f] = marker;
  p->pls.n_polygons++;
}

/* The corner points of a box, x fastest. */
static void add_corners(made_pls *p, const double low[3], const double high[3], uint32_t v[8]) {
  for (int i = 0; i < 8; i++)
    v[i] = add_point(p, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
}

static void add_sides(made_pls *p, const uint32_t v[8], int bottom, int32_t marker) {
  if (bottom) add_quad(p, v[0], v[1], v[3], v[2], marker);
  add_quad(p, v[4], v[5], v[7], v[6], marker);
  add_quad(p, v[0], v[1], v[5], v[4], marker + 1);
  add_quad(p, v[2], v[3], v[7], v[6], marker + 1);
  add_quad(p, v[0], v[2], v[6], v[4], marker + 2);
  add_quad(p, v[1], v[3], v[7], v[5], marker + 2);
}

static double add_box(made_pls *p, const double low[3], const double high[3], int32_t marker) {
  uint32_t v[8];
  add_corners(p, low, high, v);
  add_sides(p, v, 1, marker);
  return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
}

static void seed_region(made_pls *p, double x, double y, double z, int32_t marker) {
  double *s = p->seeds[p->pls.n_regions];
  s[0] = x;
  s[1] = y;
  s[2] = z;
  p->region_markers[p->pls.n_regions++] = marker;
}

void make_boxes(uint64_t seed, made_pls *ret) {
  maker_random r = {seed};
  begin(ret);
  uint32_t cells = 1 + maker_below(&r, 3);
  double side = 4.0 * cells;
  ret->volume = add_box(ret, (double[3]){0, 0, 0}, (double[3]){side, side, side}, 1);
  ret->n_regions = 1;
  for (uint32_t c = 0; c < cells * cells * cells; c++) {
    double at[3] = {4.0 * (c % cells), 4.0 * (c / cells % cells), 4.0 * (c / cells / cells)}, low[3], high[3];
    uint32_t kind = maker_below(&r, 4);
    for (int k = 0; k < 3; k++) {
      low[k] = at[k] + 1 + maker_below(&r, 2) * 0.25;
      high[k] = at[k] + 2.5 + maker_below(&r, 3) * 0.5;
    }
    if (kind == 0) continue;
    double volume = add_box(ret, low, high, 10 * (int32_t)c + 10);
    double mid[3] = {low[0] + 0.5, low[1] + 0.5, low[2] + 0.5};
    if (kind == 1) {
      memcpy(ret->holes[ret->pls.n_holes++], mid, sizeof mid);
      ret->volume -= volume;
    } else {
      ret->n_regions++;
      if (kind == 2) seed_region(ret, mid[0], mid[1], mid[2], 100 + (int32_t)c);
    }
  }
}

void make_stack(uint64_t seed, made_pls *ret) {
  maker_random r = {seed};
  begin(ret);
  uint32_t n = 2 + maker_below(&r, 5), v[8];
  double width = 1 + maker_below(&r, 4), depth = 1 + maker_below(&r, 4), z = 0;
  for (uint32_t i = 0; i < n; i++) {
    double height = 0.125 * (1 + maker_below(&r, 16));
    double low[3] = {0, 0, z}, high[3] = {width, depth, z += height};
    if (i == 0) {
      add_corners(ret, low, high, v);
    } else {
      memcpy(v, v + 4, 4 * sizeof *v);
      for (int k = 0; k < 4; k++) v[4 + k] = add_point(ret, k & 1 ? width : 0, k & 2 ? depth : 0, z);
    }
    add_sides(ret, v, i == 0, 10 * (int32_t)i + 1);
    if (maker_below(&r, 2)) seed_region(ret, width / 2, depth / 2, z - height / 2, 50 + (int32_t)i);
  }
  ret->volume = width * depth * z;
  ret->n_regions = n;
}

void make_oblique(uint64_t seed, made_pls *p) {
  maker_random r = {seed ^ 0xABCDEF};
  double a = 6.28 * maker_unit(&r), b = 6.28 * maker_unit(&r), stretch = 1 + 3 * maker_unit(&r);
  double offset[3] = {10 * maker_unit(&r), 100 * maker_unit(&r), -maker_unit(&r)};
  struct { double (*x)[3]; uint32_t n; } all[] = {
      {p->points, p->pls.n_points}, {p->holes, p->pls.n_holes}, {p->seeds, p->pls.n_regions}};
  for (int i = 0; i < 3; i++)
    for (uint32_t v = 0; v < all[i].n; v++) {
      double *q = all[i].x[v], x = q[0] * stretch, y = q[1], z = q[2];
      double u = cos(a) * x - sin(a) * y, w = sin(a) * x + cos(a) * y;
      q[0] = u + offset[0];
      q[1] = cos(b) * w - sin(b) * z + offset[1];
      q[2] = sin(b) * w + cos(b) * z + offset[2];
    }
  p->volume *= stretch;
}

void make_points(uint64_t seed, int kind, made_pls *ret) {
  maker_random r = {seed};
  begin(ret);
  uint32_t n = 4 + maker_below(&r, kind == 5 ? 500 : 120), span = 2 + maker_below(&r, 4);
  while (ret->pls.n_points < n) {
    double x = maker_below(&r, span), y = maker_below(&r, span), z = maker_below(&r, span);
    if (kind == 1) z = x + 2 * y;
    if (kind == 2) y = z = x;
    if (kind == 3) x = y = z = 1;
    if (kind == 4) {
      static const double on[3] = {0, 3, 4}; /* lattice points of the sphere of radius 5 */
      uint32_t turn = maker_below(&r, 3), swap = maker_below(&r, 2);
      double c[3] = {on[0], on[1 + swap], on[2 - swap]};
      x = c[turn] * (maker_below(&r, 2) ? 1 : -1);
      y = c[(turn + 1) % 3] * (maker_below(&r, 2) ? 1 : -1);
      z = c[(turn + 2) % 3] * (maker_below(&r, 2) ? 1 : -1);
    }
    if (kind == 5) {
      x = maker_unit(&r);
      y = maker_unit(&r);
      z = maker_unit(&r);
    }
    add_point(ret, x, y, z);
  }
}
