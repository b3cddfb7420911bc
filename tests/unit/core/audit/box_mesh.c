// SPDX-License-Identifier: Apache-2.0
/* box_mesh.c: Kuhn's subdivision of a box of cubes, with its facets. */
#include "box_mesh.h"

#include "base/context.h"

#include <stdlib.h>
#include <string.h>

typedef struct box {
  tet_mesh *m;
  uint32_t side[3]; /* cubes along each axis */
} box;

static uint32_t point(const box *b, const uint32_t at[3]) {
  return at[0] + (b->side[0] + 1) * (at[1] + (b->side[1] + 1) * at[2]);
}

static void add_points(box *b) {
  for (uint32_t z = 0; z <= b->side[2]; z++)
    for (uint32_t y = 0; y <= b->side[1]; y++)
      for (uint32_t x = 0; x <= b->side[0]; x++) {
        uint32_t at[3] = {x, y, z}, v = point(b, at);
        for (int k = 0; k < 3; k++) b->m->points[3 * v + (uint32_t)k] = at[k];
        b->m->point_same_as[v] = v;
        b->m->point_markers[v] = (int32_t)v;
      }
}

/* The six paths from a cube's corner to the opposite one. */
static void add_cube(box *b, const uint32_t low[3]) {
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < 6; k++) {
    uint32_t at[3] = {low[0], low[1], low[2]}, v[4];
    v[0] = point(b, at);
    for (int i = 0; i < 3; i++) {
      at[path[k][i]]++;
      v[i + 1] = point(b, at);
    }
    if (k > 2) { /* the odd paths turn the other way */
      uint32_t t = v[2];
      v[2] = v[3];
      v[3] = t;
    }
    b->m->tetrahedron_regions[b->m->n_tetrahedra] = low[0] >= b->side[1];
    memcpy(b->m->tetrahedra + 4 * b->m->n_tetrahedra++, v, sizeof v);
  }
}

/* The square of axis `k` at `low`, in two triangles along the diagonal. */
static void add_square(box *b, int k, const uint32_t low[3], uint32_t facet) {
  for (int first = 1; first < 3; first++) {
    uint32_t at[3] = {low[0], low[1], low[2]}, *v = b->m->subfaces + 3 * b->m->n_subfaces;
    v[0] = point(b, at);
    at[(k + first) % 3]++;
    v[1] = point(b, at);
    at[(k + 3 - first) % 3]++;
    v[2] = point(b, at);
    b->m->subface_markers[b->m->n_subfaces] = (int32_t)facet + 10;
    b->m->subface_facets[b->m->n_subfaces++] = facet;
  }
}

/* The plane where coordinate `k` is `value`. */
static void add_plane(box *b, int k, uint32_t value, uint32_t facet) {
  int i = (k + 1) % 3, j = (k + 2) % 3;
  uint32_t at[3];
  at[k] = value;
  for (at[i] = 0; at[i] < b->side[i]; at[i]++)
    for (at[j] = 0; at[j] < b->side[j]; at[j]++) add_square(b, k, at, facet);
}

static void add_segment(box *b, int k, const uint32_t low[3], uint32_t from, uint32_t to, uint32_t segment) {
  uint32_t at[3] = {low[0], low[1], low[2]};
  for (at[k] = from; at[k] < to;) {
    uint32_t *v = b->m->subsegments + 2 * b->m->n_subsegments;
    v[0] = point(b, at);
    at[k]++;
    v[1] = point(b, at);
    b->m->subsegment_markers[b->m->n_subsegments] = -(int32_t)segment;
    b->m->subsegment_segments[b->m->n_subsegments++] = segment;
  }
}

/* The edges along axis `k`; those along x are two each, met by the wall. */
static uint32_t add_edges(box *b, int k, uint32_t segment) {
  int i = (k + 1) % 3, j = (k + 2) % 3;
  uint32_t at[3] = {0, 0, 0};
  for (int c = 0; c < 4; c++) {
    at[i] = c & 1 ? b->side[i] : 0;
    at[j] = c & 2 ? b->side[j] : 0;
    uint32_t parts = k == 0 ? 2 : 1, length = b->side[k] / parts;
    for (uint32_t p = 0; p < parts; p++) add_segment(b, k, at, p * length, (p + 1) * length, segment++);
  }
  return segment;
}

static void add_wall(box *b, uint32_t segment) {
  uint32_t n = b->side[1];
  add_plane(b, 0, n, 6);
  for (uint32_t c = 0; c < 2; c++) {
    uint32_t y[3] = {n, 0, c * n}, z[3] = {n, c * n, 0};
    add_segment(b, 1, y, 0, n, segment++);
    add_segment(b, 2, z, 0, n, segment++);
  }
}

static int has(const uint32_t *t, uint32_t v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

/* By comparing all pairs: slow, and like nothing that is tested. */
static void add_neighbours(tet_mesh *m) {
  for (uint32_t t = 0; t < m->n_tetrahedra; t++)
    for (uint32_t i = 0; i < 4; i++) {
      const uint32_t *v = m->tetrahedra + 4 * t;
      m->neighbours[4 * t + i] = TET_NONE;
      for (uint32_t u = 0; u < m->n_tetrahedra; u++) {
        const uint32_t *w = m->tetrahedra + 4 * u;
        if (u != t && has(w, v[(i + 1) & 3]) && has(w, v[(i + 2) & 3]) && has(w, v[(i + 3) & 3]))
          m->neighbours[4 * t + i] = u;
      }
    }
}

static void allocate(tet_ctx *ctx, tet_mesh *m, uint32_t n) {
  size_t points = (size_t)(2 * n + 1) * (n + 1) * (n + 1), tets = 12 * (size_t)n * n * n + 1, faces = 64 * (size_t)n * n;
  m->points = tet_alloc(ctx, points, 3 * sizeof *m->points);
  m->point_markers = tet_calloc(ctx, points, sizeof *m->point_markers);
  m->point_origin = tet_calloc(ctx, points, sizeof *m->point_origin);
  m->point_same_as = tet_alloc(ctx, points, sizeof *m->point_same_as);
  m->tetrahedra = tet_alloc(ctx, tets, 4 * sizeof *m->tetrahedra);
  m->tetrahedron_regions = tet_calloc(ctx, tets, sizeof *m->tetrahedron_regions);
  m->neighbours = tet_alloc(ctx, tets, 4 * sizeof *m->neighbours);
  m->subfaces = tet_alloc(ctx, faces, 3 * sizeof *m->subfaces);
  m->subface_facets = tet_alloc(ctx, faces, sizeof *m->subface_facets);
  m->subface_markers = tet_alloc(ctx, faces, sizeof *m->subface_markers);
  m->subsegments = tet_alloc(ctx, 64 * n, 2 * sizeof *m->subsegments);
  m->subsegment_segments = tet_alloc(ctx, 64 * n, sizeof *m->subsegment_segments);
  m->subsegment_markers = tet_alloc(ctx, 64 * n, sizeof *m->subsegment_markers);
  m->region_markers = tet_calloc(ctx, 2, sizeof *m->region_markers);
  m->region_attributes = tet_calloc(ctx, 2, sizeof *m->region_attributes);
  m->region_max_volumes = tet_calloc(ctx, 2, sizeof *m->region_max_volumes);
  m->exception_tetrahedra = tet_calloc(ctx, tets, sizeof *m->exception_tetrahedra);
  m->exception_radius_edge = tet_calloc(ctx, tets, sizeof *m->exception_radius_edge);
  m->exception_segments = tet_calloc(ctx, tets, sizeof *m->exception_segments);
  m->sliver_tetrahedra = tet_calloc(ctx, tets, sizeof *m->sliver_tetrahedra);
  m->sliver_cosines = tet_calloc(ctx, tets, sizeof *m->sliver_cosines);
  m->sliver_segments = tet_calloc(ctx, tets, sizeof *m->sliver_segments);
  m->n_points = m->n_input_points = (uint32_t)points;
}

tet_mesh *box_mesh(tet_ctx *ctx, uint32_t n) {
  tet_mesh *m = tet_calloc(ctx, 1, sizeof *m);
  if (!m) abort();
  box b = {m, {2 * n, n, n}};
  m->ctx = ctx;
  allocate(ctx, m, n);
  add_points(&b);
  uint32_t low[3];
  for (low[2] = 0; low[2] < n; low[2]++)
    for (low[1] = 0; low[1] < n; low[1]++)
      for (low[0] = 0; low[0] < 2 * n; low[0]++) add_cube(&b, low);
  for (int k = 0; k < 3; k++) {
    add_plane(&b, k, 0, 2 * (uint32_t)k);
    add_plane(&b, k, b.side[k], 2 * (uint32_t)k + 1);
  }
  uint32_t segment = 0;
  for (int k = 0; k < 3; k++) segment = add_edges(&b, k, segment);
  add_wall(&b, segment);
  add_neighbours(m);
  m->n_regions = 2;
  m->report.promised = (tet_promise){.delaunay = 1, .constrained_delaunay = 1, .gabriel = 1, .covered = 1,
                                     .radius_edge = 1, .max_volume = 0.5, .region_volumes = 1};
  return m;
}
