// SPDX-License-Identifier: Apache-2.0
/* edges.c: are the subsegments edges of the mesh, and Gabriel?
 *
 * A subsegment is encroached if a vertex of a tetrahedron around it lies
 * strictly inside its diametric ball (thesis 3.2.2). A crease, a diagonal inside
 * one input facet that is not exactly planar, is not promised Gabriel; it shows
 * in the arrays as an edge of two subfaces of one facet that are not coplanar.
 * So is one of facets merged by an angle: of two subfaces of one marker within it. */
#include "audit/edges.h"

#include "base/sort.h"
#include "base/vector.h"
#include "exact/predicates.h"

#include <math.h>

enum { SEEN = 1, ENCROACHED = 2, CREASE = 4 };

/* Subsegments by vertex; `subface` holds what is known of the subfaces around. */
typedef struct edge_table {
  const tet_mesh *mesh;
  uint32_t *start;    /* [n_points + 1] places in item */
  tet_keyed *item;    /* [n_subsegments] key: smaller vertex << 32 | other; value: row */
  uint8_t *flag;      /* [n_subsegments] */
  uint32_t *around;   /* [n_subsegments][2] the first two subfaces at it, or TET_NONE */
  uint8_t *n_around;  /* [n_subsegments] subfaces at it, 3 for more */
} edge_table;

static uint64_t edge_key(uint32_t a, uint32_t b) {
  return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static void edge_table_free(tet_ctx *ctx, edge_table *e) {
  tet_free(ctx, e->start);
  tet_free(ctx, e->item);
  tet_free(ctx, e->flag);
  tet_free(ctx, e->around);
  tet_free(ctx, e->n_around);
}

static tet_status edge_table_build(tet_ctx *ctx, const tet_mesh *mesh, edge_table *e) {
  uint32_t n = mesh->n_subsegments;
  *e = (edge_table){.mesh = mesh};
  e->start = tet_calloc(ctx, (size_t)mesh->n_points + 1, sizeof *e->start);
  e->item = tet_alloc(ctx, n, sizeof *e->item);
  e->flag = tet_calloc(ctx, n, sizeof *e->flag);
  e->around = tet_alloc(ctx, 2 * (size_t)n, sizeof *e->around);
  e->n_around = tet_calloc(ctx, n, sizeof *e->n_around);
  if (!e->start || !e->item || !e->flag || !e->around || !e->n_around) return tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t *v = mesh->subsegments + 2 * (size_t)i;
    e->item[i] = (tet_keyed){edge_key(v[0], v[1]), i};
  }
  tet_sort_keyed(e->item, n);
  for (uint32_t i = 0; i < n; i++) e->start[(e->item[i].key >> 32) + 1]++;
  for (uint32_t i = 0; i < mesh->n_points; i++) e->start[i + 1] += e->start[i];
  return TET_OK;
}

/* The row of subsegment ab, or TET_NONE. Most vertices have none: that is fast. */
static uint32_t find_edge(const edge_table *e, uint32_t a, uint32_t b) {
  uint32_t smaller = a < b ? a : b, low = e->start[smaller], end = e->start[smaller + 1], high = end;
  if (low == end) return TET_NONE;
  uint64_t key = edge_key(a, b);
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    if (e->item[mid].key < key)
      low = mid + 1;
    else
      high = mid;
  }
  return low < end && e->item[low].key == key ? (uint32_t)e->item[low].value : TET_NONE;
}

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

/* Do two subfaces, on ab and their vertices x and y, meet within the promised angle of flat? In doubles,
 * with a slack for what rounding does to small ones. */
static int is_merged(const tet_mesh *mesh, const uint32_t ab[2], uint32_t x, uint32_t y) {
  double u[3], d[3], n[2][3];
  if (!(mesh->report.promised.merge_angle > 0)) return 0;
  tet_minus(place(mesh, ab[1]), place(mesh, ab[0]), u);
  for (int k = 0; k < 2; k++) {
    tet_minus(place(mesh, k ? y : x), place(mesh, ab[0]), d);
    tet_cross(u, d, n[k]);
  }
  double cosine = -tet_dot(n[0], n[1]) / sqrt(tet_square(n[0]) * tet_square(n[1]));
  return cosine >= cos((mesh->report.promised.merge_angle + 0.01) * (M_PI / 180));
}

static uint32_t apex_of(const uint32_t *v, const uint32_t end[2]) {
  for (int k = 0; k < 2; k++)
    if (v[k] != end[0] && v[k] != end[1]) return v[k];
  return v[2];
}

static void mark_creases(edge_table *e) {
  const tet_mesh *mesh = e->mesh;
  for (uint32_t s = 0; s < mesh->n_subfaces; s++) {
    const uint32_t *v = mesh->subfaces + 3 * (size_t)s;
    for (int k = 0; k < 3; k++) {
      uint32_t i = find_edge(e, v[k], v[(k + 1) % 3]);
      if (i == TET_NONE) continue;
      if (e->n_around[i] < 2) e->around[2 * (size_t)i + e->n_around[i]] = s;
      if (e->n_around[i] < 3) e->n_around[i]++;
    }
  }
  for (uint32_t i = 0; i < mesh->n_subsegments; i++) {
    if (e->n_around[i] != 2) continue;
    const uint32_t *s = e->around + 2 * (size_t)i, *end = mesh->subsegments + 2 * (size_t)i;
    const uint32_t *v = mesh->subfaces + 3 * (size_t)s[0], *w = mesh->subfaces + 3 * (size_t)s[1];
    uint32_t apex = apex_of(w, end);
    if (mesh->subface_facets[s[0]] != mesh->subface_facets[s[1]]) {
      if (mesh->subface_markers[s[0]] == mesh->subface_markers[s[1]] && is_merged(mesh, end, apex_of(v, end), apex))
        e->flag[i] |= CREASE;
      continue;
    }
    if (tet_orient3d_xyz(place(mesh, v[0]), place(mesh, v[1]), place(mesh, v[2]), place(mesh, apex)) != 0)
      e->flag[i] |= CREASE;
  }
}

/* Looks at the six edges of tetrahedron t; returns 1 if two of its faces, with
 * `subface` 1, meet in an edge that is no subsegment: all four vertices are on one
 * flat part of a facet, and the tetrahedron is what rounding made of nothing. */
static int look_at(edge_table *e, uint32_t t, const uint8_t subface[4]) {
  const tet_mesh *mesh = e->mesh;
  const uint32_t *v = mesh->tetrahedra + 4 * (size_t)t;
  int sliver = 0;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      uint32_t row = find_edge(e, v[i], v[j]);
      int walls = 0;
      for (int k = 0; k < 4; k++) walls += k != i && k != j && subface[k];
      sliver |= walls == 2 && row == TET_NONE;
      if (row == TET_NONE) continue;
      e->flag[row] |= SEEN;
      for (int k = 0; k < 4; k++)
        if (k != i && k != j && tet_dot_sign_xyz(place(mesh, v[i]), place(mesh, v[j]), place(mesh, v[k])) < 0)
          e->flag[row] |= ENCROACHED;
    }
  return sliver;
}

tet_status tet_audit_edges(tet_ctx *ctx, const tet_mesh *mesh, const uint8_t *subface, tet_audit *found) {
  edge_table e;
  tet_status status = edge_table_build(ctx, mesh, &e);
  if (status == TET_OK) mark_creases(&e);
  for (uint32_t t = 0; status == TET_OK && t < mesh->n_tetrahedra; t++) {
    found->facet_slivers += (uint64_t)look_at(&e, t, subface + 4 * (size_t)t);
    if ((t & 1023) == 0) status = tet_poll(ctx);
  }
  /* Of a subsegment listed twice one row is never found: it counts as missing. */
  for (uint32_t i = 0; status == TET_OK && i < mesh->n_subsegments; i++) {
    found->subsegments_missing += !(e.flag[i] & SEEN);
    found->subsegments_encroached += (e.flag[i] & ENCROACHED) && !(e.flag[i] & CREASE);
  }
  edge_table_free(ctx, &e);
  return status;
}
