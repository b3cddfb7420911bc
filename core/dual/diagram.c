// SPDX-License-Identifier: Apache-2.0
/* diagram.c: the Voronoi face of every edge and region, walking around the edge from
 * tetrahedron to tetrahedron. Where the walk ends at subfaces on both sides, their
 * circumcentres end the polygon; at a subsegment, where they are not of one facet, the edge's
 * midpoint closes it. */
#include "dual/diagram.h"

#include "dual/polygons.h"
#include "dual/shares.h"

#include <string.h>

enum { POLL_EVERY = 1024 };

tet_status tet_add_corner(tet_polygons *p, uint64_t point) {
  if (point >= TET_NONE || p->n_corners + 1 >= TET_NONE)
    return tet_fail(p->ctx, TET_E_TOO_LARGE, "the Voronoi diagram has 2^32 points or corners");
  return tet_push(p->ctx, &p->corner, &p->n_corners, &p->cap_corner, (uint32_t)point);
}

tet_status tet_end_polygon(tet_polygons *p, uint32_t from, uint32_t to) {
  size_t low = p->start[p->n_faces], high = p->n_corners, n_cells = 2 * p->n_faces, n_starts = p->n_faces + 1;
  if (from == TET_NONE) {
    from = to;
    to = TET_NONE;
    while (low + 1 < high) {
      uint32_t c = p->corner[low];
      p->corner[low++] = p->corner[--high];
      p->corner[high] = c;
    }
  }
  tet_status status = tet_push(p->ctx, &p->cell, &n_cells, &p->cap_cell, from);
  if (status == TET_OK) status = tet_push(p->ctx, &p->cell, &n_cells, &p->cap_cell, to);
  if (status == TET_OK) status = tet_push(p->ctx, &p->start, &n_starts, &p->cap_start, (uint32_t)p->n_corners);
  if (status == TET_OK) p->n_faces++;
  return status;
}

uint32_t tet_find_subface(const tet_polygons *p, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t v[3] = {a, b, c};
  tet_sort3(v);
  uint64_t key = (uint64_t)v[0] << 32 | v[1], value = (uint64_t)v[2] << 32;
  size_t low = 0, high = p->mesh->n_subfaces;
  while (low < high) {
    size_t mid = low + (high - low) / 2;
    const tet_keyed *s = &p->subface[mid];
    if (s->key < key || (s->key == key && s->value < value)) low = mid + 1;
    else high = mid;
  }
  if (low == p->mesh->n_subfaces || p->subface[low].key != key || p->subface[low].value >> 32 != v[2]) return TET_NONE;
  return (uint32_t)p->subface[low].value;
}

/* ---- around an edge ---- */

/* A tetrahedron at edge ab; with the local numbers k and l of its others, (a, b, k, l) is positive:
 * counterclockwise around the edge, seen from b, comes first the face with k, then that with l. */
typedef struct spot {
  uint32_t t;
  uint32_t k, l;
} spot;

static uint32_t local(const uint32_t *v, uint32_t x) { return v[0] == x ? 0 : v[1] == x ? 1 : v[2] == x ? 2 : 3; }

static spot spot_at(const tet_mesh *m, uint32_t t, uint32_t a, uint32_t b) {
  const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
  uint32_t i = local(v, a), j = local(v, b);
  for (int e = 0; e < 6; e++) {
    if (tet_edge[e][0] == i && tet_edge[e][1] == j) return (spot){t, tet_edge[e][2], tet_edge[e][3]};
    if (tet_edge[e][0] == j && tet_edge[e][1] == i) return (spot){t, tet_edge[e][3], tet_edge[e][2]};
  }
  return (spot){t, TET_NONE, TET_NONE};
}

/* On to the next tetrahedron counterclockwise (or back); 0 at the border of the region. */
static int step(const tet_mesh *m, spot *s, uint32_t a, uint32_t b, int on) {
  uint32_t next = m->neighbours[4 * (size_t)s->t + (on ? s->k : s->l)];
  if (next == TET_NONE || m->tetrahedron_regions[next] != m->tetrahedron_regions[s->t]) return 0;
  uint32_t shared = m->tetrahedra[4 * (size_t)s->t + (on ? s->l : s->k)];
  const uint32_t *v = m->tetrahedra + 4 * (size_t)next;
  uint32_t x = local(v, shared), other = 6 - x - local(v, a) - local(v, b);
  *s = on ? (spot){next, x, other} : (spot){next, other, x};
  return 1;
}

/* The circumcentre of the subface ab and vertex x of tetrahedron t. */
static tet_status add_border_centre(tet_polygons *p, uint32_t a, uint32_t b, uint32_t t, uint32_t x) {
  uint32_t s = tet_find_subface(p, a, b, p->mesh->tetrahedra[4 * (size_t)t + x]);
  if (s == TET_NONE) return tet_internal(p->ctx, "a region ends off the subfaces");
  return tet_add_corner(p, tet_subface_point(p, s));
}

/* Which of the tetrahedron's edges ab is. */
static int edge_number(const tet_mesh *m, uint32_t t, uint32_t a, uint32_t b) {
  const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
  uint32_t both = local(v, a) + 4 * local(v, b);
  int e = 0;
  while (tet_edge[e][0] + 4u * tet_edge[e][1] != both && tet_edge[e][1] + 4u * tet_edge[e][0] != both) e++;
  return e;
}

/* The polygon of edge ab through tetrahedron t; `seen` [n_tetrahedra] gets a bit for each edge. */
static tet_status add_fan(tet_polygons *p, uint32_t t, uint32_t a, uint32_t b, uint8_t *seen) {
  const tet_mesh *m = p->mesh;
  uint32_t region = m->tetrahedron_regions[t];
  spot s = spot_at(m, t, a, b);
  int closed = 0;
  tet_status status = TET_OK;
  while (!closed && step(m, &s, a, b, 0)) closed = s.t == t;
  uint32_t begin = s.t;
  if (!closed) {
    uint32_t segment = tet_edge_map_get(&p->subsegment, a, b);
    if (segment != TET_NONE) status = tet_add_corner(p, tet_subsegment_point(p, segment));
    if (status == TET_OK) status = add_border_centre(p, a, b, s.t, s.k);
  }
  for (int more = 1; more && status == TET_OK;) {
    seen[s.t] = (uint8_t)(seen[s.t] | 1 << edge_number(m, s.t, a, b));
    status = tet_add_corner(p, s.t);
    more = step(m, &s, a, b, 1) && s.t != begin;
  }
  if (!closed && status == TET_OK) status = add_border_centre(p, a, b, s.t, s.l);
  if (status != TET_OK) return status;
  return tet_end_polygon(p, tet_cell_of(p, a, region), tet_cell_of(p, b, region));
}

/* One face for each row of the edges; then, where a region touches itself at an edge, the others. */
static tet_status edge_polygons(tet_polygons *p) {
  const tet_mesh *m = p->mesh;
  uint32_t *some = tet_alloc(p->ctx, m->n_edges, sizeof *some); /* a tetrahedron at each row's edge */
  uint8_t *seen = tet_calloc(p->ctx, m->n_tetrahedra, 1);
  tet_status status = some && seen ? TET_OK : tet_ctx_error(p->ctx)->status;
  for (uint32_t t = 0; t < m->n_tetrahedra && status == TET_OK; t++) {
    const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
    for (int e = 0; e < 6; e++)
      some[tet_region_edge(&p->edges, v[tet_edge[e][0]], v[tet_edge[e][1]], m->tetrahedron_regions[t])] = t;
    if (t % POLL_EVERY == 0) status = tet_poll(p->ctx);
  }
  for (size_t row = 0; row < m->n_edges && status == TET_OK; row++) {
    status = add_fan(p, some[row], m->edge_vertices[2 * row], m->edge_vertices[2 * row + 1], seen);
    if (row % POLL_EVERY == 0 && status == TET_OK) status = tet_poll(p->ctx);
  }
  for (uint32_t t = 0; t < m->n_tetrahedra && status == TET_OK; t++)
    for (int e = 0; e < 6 && status == TET_OK; e++) {
      if (seen[t] >> e & 1) continue;
      const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
      uint32_t a = v[tet_edge[e][0]], b = v[tet_edge[e][1]];
      status = add_fan(p, t, a < b ? a : b, a < b ? b : a, seen);
    }
  tet_free(p->ctx, some);
  tet_free(p->ctx, seen);
  return status;
}

/* ---- the whole ---- */

static void polygons_free(tet_polygons *p) {
  tet_edge_map_free(p->ctx, &p->subsegment);
  void *all[] = {p->edges.first, p->first_cell, p->subface, p->side, p->start, p->corner, p->cell};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(p->ctx, all[i]);
}

/* first[v]: the first of n ascending rows whose vertex (every `stride`-th number) is v or more. */
static uint32_t *first_rows(tet_ctx *ctx, const uint32_t *vertex, size_t stride, uint32_t n, uint32_t n_points) {
  uint32_t *first = tet_alloc(ctx, (size_t)n_points + 1, sizeof *first);
  for (uint32_t v = 0, row = 0; first && v <= n_points; v++) {
    while (row < n && vertex[stride * row] < v) row++;
    first[v] = row;
  }
  return first;
}

static tet_status make_tables(tet_polygons *p) {
  const tet_mesh *m = p->mesh;
  p->edges = (tet_region_edges){.n = m->n_edges, .vertices = m->edge_vertices, .regions = m->edge_regions};
  p->edges.first = first_rows(p->ctx, m->edge_vertices, 2, m->n_edges, m->n_points);
  p->first_cell = first_rows(p->ctx, m->cell_vertices, 1, m->n_cells, m->n_points);
  p->subface = tet_alloc(p->ctx, m->n_subfaces, sizeof *p->subface);
  if (!p->edges.first || !p->first_cell || !p->subface) return tet_ctx_error(p->ctx)->status;
  for (uint32_t s = 0; s < m->n_subfaces; s++) {
    uint32_t v[3];
    memcpy(v, m->subfaces + 3 * (size_t)s, sizeof v);
    tet_sort3(v);
    p->subface[s] = (tet_keyed){(uint64_t)v[0] << 32 | v[1], (uint64_t)v[2] << 32 | s};
  }
  tet_sort_keyed(p->subface, m->n_subfaces);
  tet_status status = tet_poll(p->ctx);
  for (uint32_t s = 0; s < m->n_subsegments && status == TET_OK; s++) {
    const uint32_t *v = m->subsegments + 2 * (size_t)s;
    status = tet_edge_map_put(p->ctx, &p->subsegment, v[0], v[1], s);
  }
  size_t n_starts = 0;
  if (status == TET_OK) status = tet_push(p->ctx, &p->start, &n_starts, &p->cap_start, 0);
  return status;
}

/* Where the point of that number is. */
static void place_of(const tet_polygons *p, uint64_t number, double x[3]) {
  const tet_mesh *m = p->mesh;
  if (number >= tet_vertex_point(p, 0)) {
    memcpy(x, m->points + 3 * (number - tet_vertex_point(p, 0)), 3 * sizeof *x);
  } else if (number >= tet_subsegment_point(p, 0)) {
    const uint32_t *v = m->subsegments + 2 * (number - tet_subsegment_point(p, 0));
    for (size_t k = 0; k < 3; k++) x[k] = 0.5 * m->points[3 * (size_t)v[0] + k] + 0.5 * m->points[3 * (size_t)v[1] + k];
  } else if (number >= m->n_tetrahedra) {
    const uint32_t *v = m->subfaces + 3 * (number - m->n_tetrahedra);
    const double *corner[3];
    double shares[3];
    for (int i = 0; i < 3; i++) corner[i] = m->points + 3 * (size_t)v[i];
    tet_corner_shares(corner[0], corner[1], corner[2], shares, x);
  } else {
    const uint32_t *v = m->tetrahedra + 4 * number;
    tet_shares shares = {.bound = 0};
    tet_shares_of(m->points, v, &shares); /* positive: the factors are there */
    for (size_t k = 0; k < 3; k++) x[k] = m->points[3 * (size_t)v[0] + k] + shares.centre[k];
  }
}

/* The places of the points in use; corners get their final numbers. */
static tet_status make_points(tet_polygons *p, double **ret_points, uint32_t *ret_n) {
  uint64_t most = tet_vertex_point(p, p->mesh->n_points);
  uint32_t n = 0, *rename = tet_calloc(p->ctx, most, sizeof *rename); /* row + 1, or 0 */
  if (!rename) return tet_ctx_error(p->ctx)->status;
  for (size_t i = 0; i < p->n_corners; i++) rename[p->corner[i]] = 1;
  for (uint64_t i = 0; i < most; i++)
    if (rename[i]) rename[i] = ++n;
  double *points = tet_alloc(p->ctx, n, 3 * sizeof *points);
  tet_status status = points ? TET_OK : tet_ctx_error(p->ctx)->status;
  for (uint64_t i = 0; i < most && status == TET_OK; i++) {
    if (rename[i]) place_of(p, i, points + 3 * (size_t)(rename[i] - 1));
    if (i % POLL_EVERY == 0) status = tet_poll(p->ctx);
  }
  for (size_t i = 0; i < p->n_corners; i++) p->corner[i] = rename[p->corner[i]] - 1;
  tet_free(p->ctx, rename);
  if (status != TET_OK) {
    tet_free(p->ctx, points);
    return status;
  }
  *ret_points = points;
  *ret_n = n;
  return TET_OK;
}

tet_status tet_voronoi_diagram(tet_ctx *ctx, tet_mesh *mesh) {
  tet_polygons p = {.ctx = ctx, .mesh = mesh};
  double *points = NULL;
  uint32_t n_points = 0;
  tet_status status = make_tables(&p);
  if (status == TET_OK) status = tet_find_sides(&p);
  if (status == TET_OK) status = edge_polygons(&p);
  if (status == TET_OK) status = tet_border_polygons(&p);
  if (status == TET_OK) status = make_points(&p, &points, &n_points);
  if (status == TET_OK) {
    tet_shrink(ctx, &p.start, &p.cap_start, p.n_faces + 1, sizeof *p.start);
    tet_shrink(ctx, &p.corner, &p.cap_corner, p.n_corners, sizeof *p.corner);
    tet_shrink(ctx, &p.cell, &p.cap_cell, 2 * p.n_faces, sizeof *p.cell);
    mesh->n_voronoi_points = n_points;
    mesh->voronoi_points = points;
    mesh->n_voronoi_faces = (uint32_t)p.n_faces;
    mesh->voronoi_face_start = p.start;
    mesh->voronoi_face_points = p.corner;
    mesh->voronoi_face_cells = p.cell;
    p.start = p.corner = p.cell = NULL;
  }
  polygons_free(&p);
  return status;
}
