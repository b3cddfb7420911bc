// SPDX-License-Identifier: Apache-2.0
/* pls_builder.c: see pls_builder.h. */
#include "pls_builder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact/predicates.h"

pls_builder *pls_new(void) {
  pls_builder *b = calloc(1, sizeof *b);
  if (!b) abort();
  b->pls = (tet_pls){.points = b->x,
                     .facet_start = b->facet_start,
                     .polygon_start = b->polygon_start,
                     .polygon_vertices = b->polygon_vertices,
                     .facet_markers = b->facet_markers,
                     .facet_hole_start = b->facet_hole_start,
                     .facet_holes = b->facet_holes,
                     .segments = b->segments,
                     .segment_markers = b->segment_markers,
                     .n_loose_points = TET_LOOSE_ALL_UNUSED};
  b->points = (tet_points){.x = b->x, .first_implicit = UINT32_MAX};
  return b;
}

void pls_free(pls_builder *b) { free(b); }

uint32_t pls_point(pls_builder *b, double x, double y, double z) {
  uint32_t v = b->pls.n_points++;
  const double c[3] = {x, y, z};
  if (v >= BUILDER_POINTS) abort();
  for (int k = 0; k < 3; k++) {
    b->x[3 * v + (uint32_t)k] = c[k];
    if (fabs(c[k]) > b->points.max_abs) b->points.max_abs = fabs(c[k]);
  }
  b->points.n = b->pls.n_points;
  return v;
}

uint32_t pls_facet(pls_builder *b, int32_t marker) {
  uint32_t f = b->pls.n_facets++;
  if (f >= BUILDER_FACETS) abort();
  b->facet_start[f + 1] = b->facet_start[f];
  b->facet_hole_start[f + 1] = b->facet_hole_start[f];
  b->facet_markers[f] = marker;
  return f;
}

void pls_polygon(pls_builder *b, int n, const uint32_t *v) {
  uint32_t p = b->pls.n_polygons++, start = b->polygon_start[p];
  if (start + (uint32_t)n > BUILDER_INDICES || p >= BUILDER_FACETS) abort();
  memcpy(b->polygon_vertices + start, v, (size_t)n * sizeof *v);
  b->polygon_start[p + 1] = start + (uint32_t)n;
  b->facet_start[b->pls.n_facets] = b->pls.n_polygons;
}

void pls_hole(pls_builder *b, double x, double y, double z) {
  double *h = b->facet_holes + 3 * b->pls.n_facet_holes++;
  h[0] = x;
  h[1] = y;
  h[2] = z;
  b->facet_hole_start[b->pls.n_facets] = b->pls.n_facet_holes;
}

uint32_t pls_triangle(pls_builder *b, int32_t marker, uint32_t p, uint32_t q, uint32_t r) {
  const uint32_t v[3] = {p, q, r};
  uint32_t f = pls_facet(b, marker);
  pls_polygon(b, 3, v);
  return f;
}

uint32_t pls_quad(pls_builder *b, int32_t marker, uint32_t p, uint32_t q, uint32_t r, uint32_t s) {
  const uint32_t v[4] = {p, q, r, s};
  uint32_t f = pls_facet(b, marker);
  pls_polygon(b, 4, v);
  return f;
}

void pls_segment(pls_builder *b, int32_t marker, uint32_t p, uint32_t q) {
  uint32_t i = b->pls.n_segments++;
  b->segments[2 * i] = p;
  b->segments[2 * i + 1] = q;
  b->segment_markers[i] = marker;
}

uint32_t pls_box(pls_builder *b, int32_t first, const double lo[3], const double hi[3]) {
  static const uint32_t side[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                      {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  uint32_t v = b->pls.n_points;
  for (int i = 0; i < 8; i++)
    pls_point(b, i & 1 ? hi[0] : lo[0], i >> 1 & 1 ? hi[1] : lo[1], i >> 2 ? hi[2] : lo[2]);
  for (int i = 0; i < 6; i++)
    pls_quad(b, first + i, v + side[i][0], v + side[i][1], v + side[i][2], v + side[i][3]);
  return v;
}

tet_status pls_surface(pls_builder *b, tet_ctx *ctx, tet_surface *ret) {
  return tet_surface_build(ctx, &b->pls, &b->points, 1e-9, 0, ret);
}

static uint32_t next3(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static uint32_t prev3(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

static const char *triangle_fault(const tet_surface *s, const tet_points *p, uint32_t t) {
  const uint32_t *v = s->tri + 3 * (size_t)t;
  if (s->tri_patch[t] >= s->n_patches) return "a triangle of no patch";
  const tet_patch *q = &s->patch[s->tri_patch[t]];
  if (q->facet >= s->n_facets) return "a patch of no facet";
  if (tet_orient2d(p, q->axis, v[0], v[1], v[2]) <= 0) return "a triangle is not counter-clockwise";
  if (q->side == 0 || tet_orient3d(p, v[0], v[1], v[2], q->off_plane) != q->side) return "a patch's side is wrong";
  return NULL;
}

static const char *edge_fault(const tet_surface *s, const tet_points *p, uint32_t h) {
  uint32_t a = s->tri[h], b = s->tri[next3(h)], c = s->tri[prev3(h)], g = s->tri_adj[h], e = s->tri_seg[h];
  if ((g == TET_NONE) != (e != TET_NONE)) return "an edge must have a neighbour or a subsegment";
  if (e != TET_NONE) {
    if (e >= s->n_subsegs) return "no such subsegment";
    uint32_t x = s->subseg[2 * (size_t)e], y = s->subseg[2 * (size_t)e + 1];
    if (!((x == a && y == b) || (x == b && y == a))) return "an edge on another subsegment";
    uint32_t steps = 0, r = s->tri_ring[h];
    for (; r != h && r != TET_NONE && steps <= s->n_tris; steps++) {
      if (s->tri_seg[r] != e) return "a ring leaves its subsegment";
      r = s->tri_ring[r];
    }
    if (r != h) return "a ring does not close";
    if (s->subseg_tri[e] == TET_NONE) return "a ring without a start";
    return NULL;
  }
  if (s->tri_ring[h] != TET_NONE) return "a ring off subsegments";
  if (s->tri_adj[g] != h || s->tri[g] != b || s->tri[next3(g)] != a) return "adjacency is not mutual";
  if (s->tri_patch[g / 3] != s->tri_patch[h / 3]) return "adjacency leaves the patch";
  const tet_patch *q = &s->patch[s->tri_patch[h / 3]];
  uint32_t d = s->tri[prev3(g)];
  if (tet_orient3d(p, a, b, c, d) != 0) return "a patch is not flat";
  if (tet_insphere_sos(p, a, b, c, q->off_plane, d) * q->side > 0) return "an inner edge is not locally Delaunay";
  return NULL;
}

/* Counts ring members against the triangles' own marks. */
static const char *ring_fault(const tet_surface *s) {
  uint64_t marks = 0, members = 0;
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) marks += s->tri_seg[h] != TET_NONE;
  for (uint32_t e = 0; e < s->n_subsegs; e++) {
    uint32_t first = s->subseg_tri[e], h = first;
    if (first == TET_NONE) continue;
    do {
      if (s->tri_seg[h] != e) return "a subsegment's ring starts elsewhere";
      members++;
      h = s->tri_ring[h];
    } while (h != first && members <= marks);
  }
  return members == marks ? NULL : "rings do not hold all edges";
}

/* The planes of input vertices are those of their triangles, exactly. */
static const char *plane_fault(const tet_surface *s, const tet_points *p) {
  uint32_t n = p->n < p->first_implicit ? p->n : p->first_implicit;
  uint32_t some_tri[BUILDER_POINTS * 4]; /* of each patch */
  if (s->n_patches > BUILDER_POINTS * 4) return "more patches than the test has room for";
  for (uint32_t t = 0; t < s->n_tris; t++) some_tri[s->tri_patch[t]] = t;
  for (uint32_t v = 0; v < n; v++)
    for (uint32_t k = s->plane_start[v]; k < s->plane_start[v + 1]; k++) {
      if (k > s->plane_start[v] && s->plane[k - 1] >= s->plane[k]) return "a vertex's planes do not rise";
      const uint32_t *t = s->tri + 3 * (size_t)some_tri[s->plane[k]];
      if (tet_orient3d(p, t[0], t[1], t[2], v) != 0) return "a vertex off a plane of its own";
    }
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    uint32_t v = s->tri[h], k;
    if (v >= n) continue;
    for (k = s->plane_start[v]; k < s->plane_start[v + 1] && s->plane[k] != s->tri_patch[h / 3];) k++;
    if (k == s->plane_start[v + 1]) return "a vertex that does not know its plane";
  }
  tet_planes planes = {s->plane_start, s->plane};
  tet_points knowing = *p;
  knowing.planes = &planes;
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    uint32_t a = some_tri[s->tri_patch[h / 3]];
    uint32_t v[4] = {s->tri[3 * a], s->tri[3 * a + 1], s->tri[3 * a + 2], s->tri[h]};
    if (!tet_are_in_one_plane(&knowing, v)) return "a patch not known to be flat";
  }
  return NULL;
}

static const char *segment_fault(const tet_surface *s, const tet_points *p) {
  for (uint32_t i = 0; i < s->n_segments; i++) {
    if (s->segment[i].a >= s->segment[i].b) return "a segment's ends are not in order";
    if (!s->used[s->segment[i].a] || !s->used[s->segment[i].b]) return "a segment at an unused vertex";
  }
  for (uint32_t e = 0; e < s->n_subsegs; e++) {
    if (s->subseg_segment[e] >= s->n_segments) return "a subsegment of no segment";
    const tet_segment *g = &s->segment[s->subseg_segment[e]];
    for (int k = 0; k < 2; k++) {
      uint32_t v = s->subseg[2 * (size_t)e + (size_t)k];
      if (v == g->a || v == g->b) continue;
      if (!tet_collinear(p, g->a, g->b, v)) return "a subsegment off its segment";
    }
    if (tet_dot_sign(p, s->subseg[2 * (size_t)e + 1], g->b, s->subseg[2 * (size_t)e]) <= 0 &&
        s->subseg[2 * (size_t)e + 1] != g->b)
      return "a subsegment against its segment";
  }
  return NULL;
}

const char *surface_fault(const tet_surface *s, const tet_points *points) {
  const char *fault = NULL;
  for (uint32_t t = 0; t < s->n_tris && !fault; t++) fault = triangle_fault(s, points, t);
  for (uint32_t h = 0; h < 3 * s->n_tris && !fault; h++) fault = edge_fault(s, points, h);
  if (!fault) fault = ring_fault(s);
  if (!fault) fault = plane_fault(s, points);
  return fault ? fault : segment_fault(s, points);
}

double surface_area(const tet_surface *s, const tet_points *points) {
  double area = 0;
  for (uint32_t t = 0; t < s->n_tris; t++) {
    const double *a = points->x + 3 * (size_t)s->tri[3 * (size_t)t];
    const double *b = points->x + 3 * (size_t)s->tri[3 * (size_t)t + 1];
    const double *c = points->x + 3 * (size_t)s->tri[3 * (size_t)t + 2];
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
      u[k] = b[k] - a[k];
      v[k] = c[k] - a[k];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  return area;
}
