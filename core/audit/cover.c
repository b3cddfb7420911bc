// SPDX-License-Identifier: Apache-2.0
/* cover.c: is every input facet covered by its subfaces, exactly once?
 *
 * A facet is looked at along an axis in which it has an area, its subfaces counter-clockwise. Where
 * none is turned over, as many lie over a place as the border of their sum winds around it; so
 * nothing is missing or doubled where that border, a chain of directed subsegments, is the border
 * of the facet, known from its polygons (outline.h). Off the subsegments it is nothing: two
 * subfaces at each edge, one on each side. Links between input vertices stand for the subsegments
 * of a segment, whose Steiner points are rounded; so all is exact but how far out of its plane a
 * vertex may be. Facets merged into one count together. */
#include "audit/cover.h"

#include "audit/gaps.h"
#include "base/sort.h"
#include "base/vector.h"
#include "exact/predicates.h"

#include <math.h>

typedef struct cover {
  tet_ctx *ctx;
  const tet_pls *pls;
  const tet_mesh *mesh;
  const tet_ways *ways;
  tet_audit *found;
  tet_facet_view *view; /* [n_facets] */
  uint8_t *bad;         /* [n_facets] */
  int8_t *up;           /* [n_subfaces] its turn in its facet's view */
  tet_keyed *edge;      /* [3 n_subfaces] key: the edge's vertices ascending; value: 3 subface + edge */
  tet_keyed *subseg;    /* [n_subsegments] key: likewise; value: row */
  tet_keyed *rim;       /* key: facet and segment; value: 1, or 0 against its way */
  size_t n_rim, cap_rim;
  tet_chain chain;      /* borders of facets, less those of their covers */
} cover;

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

static int32_t marker_of(const tet_pls *pls, uint32_t f) { return pls->facet_markers ? pls->facet_markers[f] : 0; }

uint64_t tet_count_bad_numbers(const tet_pls *pls, const tet_mesh *mesh) {
  uint64_t bad = (mesh->n_input_points != pls->n_points) + (mesh->n_input_facets != pls->n_facets);
  if (bad) return bad;
  for (uint32_t f = 0; f < pls->n_facets; f++) {
    uint32_t g = mesh->facet_same_as[f];
    bad += g > f || mesh->facet_same_as[g] != g;
  }
  for (uint32_t s = 0; s < mesh->n_subfaces; s++) bad += mesh->subface_facets[s] >= pls->n_facets;
  for (uint32_t s = 0; s < mesh->n_subfaces && !bad; s++)
    bad += mesh->facet_same_as[mesh->subface_facets[s]] != mesh->subface_facets[s];
  return bad;
}

/* How far from its facet's plane a vertex may be: for what tells a cover from a tent over its facet. */
static double slack(const tet_mesh *mesh) {
  double size = 0;
  for (size_t i = 0; i < 3 * (size_t)mesh->n_points; i++) size = fmax(size, fabs(mesh->points[i]));
  return 8 * mesh->report.promised.planarity + 1e-10 * size;
}

static int is_off_plane(const cover *c, const tet_facet_view *view, const uint32_t v[3], double most) {
  double u[3], w[3], n[3], d[3];
  tet_direction(place(c->mesh, view->v[1]), place(c->mesh, view->v[0]), u);
  tet_direction(place(c->mesh, view->v[2]), place(c->mesh, view->v[0]), w);
  tet_cross(u, w, n);
  double length = sqrt(tet_square(n)), error = 1e-14 * sqrt(tet_square(u)) * sqrt(tet_square(w)); /* of n */
  for (int k = 0; k < 3; k++) {
    if (v[k] == view->v[0]) continue;
    double far = tet_direction(place(c->mesh, v[k]), place(c->mesh, view->v[0]), d);
    if (fabs(tet_dot(n, d)) > most / far * length + error * sqrt(tet_square(d))) return 1;
  }
  return 0;
}

/* The turn of each subface, and its marker. */
static tet_status look_at_subfaces(cover *c) {
  const tet_mesh *m = c->mesh;
  double most = slack(m);
  tet_status status = TET_OK;
  for (uint32_t s = 0; s < m->n_subfaces && status == TET_OK; s++) {
    const uint32_t *v = m->subfaces + 3 * (size_t)s, f = m->subface_facets[s];
    const tet_facet_view *view = &c->view[f];
    c->found->wrong_markers += m->subface_markers[s] != marker_of(c->pls, f);
    c->up[s] = 0;
    if (view->v[0] != TET_NONE)
      c->up[s] = (int8_t)tet_orient2d_xyz(view->axis, place(m, v[0]), place(m, v[1]), place(m, v[2]));
    if (!c->up[s] || is_off_plane(c, view, v, most)) c->found->folded_subfaces++;
    if ((s & 1023) == 0) status = tet_poll(c->ctx);
  }
  return status;
}

/* All edges of subfaces, and all subsegments, sorted by their vertices. */
static void sort_edges(cover *c) {
  const tet_mesh *m = c->mesh;
  for (size_t h = 0; h < 3 * (size_t)m->n_subfaces; h++) {
    uint32_t a = m->subfaces[h], b = m->subfaces[h - h % 3 + (h + 1) % 3];
    c->edge[h] = (tet_keyed){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, h};
  }
  tet_sort_keyed(c->edge, 3 * (size_t)m->n_subfaces);
  for (size_t e = 0; e < m->n_subsegments; e++) {
    uint32_t a = m->subsegments[2 * e], b = m->subsegments[2 * e + 1];
    c->subseg[e] = (tet_keyed){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, e};
  }
  tet_sort_keyed(c->subseg, m->n_subsegments);
}

/* One edge, its `n` subfaces from place `at` on; `row`: the subsegment there, or TET_NONE. */
static tet_status look_at_edge(cover *c, size_t at, size_t n, uint32_t row) {
  const tet_mesh *m = c->mesh;
  tet_status status = TET_OK;
  for (size_t k = at; k < at + n && status == TET_OK; k++) {
    uint32_t f = m->subface_facets[c->edge[k].value / 3];
    size_t side[2] = {0, 0}; /* to the left, to the right of the way from the lower vertex to the higher */
    size_t l = at;
    while (m->subface_facets[c->edge[l].value / 3] != f) l++;
    if (l < k) continue; /* seen */
    for (; l < at + n; l++) {
      uint64_t h = c->edge[l].value;
      if (m->subface_facets[h / 3] != f) continue;
      int rising = m->subfaces[h] == c->edge[l].key >> 32;
      side[rising != (c->up[h / 3] > 0)]++;
    }
    if (side[0] > 1 || side[1] > 1 || (row == TET_NONE && side[0] != side[1])) c->bad[f] = 1;
    if (row == TET_NONE || side[0] == side[1]) continue;
    uint64_t along = (side[0] > side[1]) == (c->ways->sense[row] > 0);
    status = tet_grow(c->ctx, &c->rim, &c->cap_rim, c->n_rim + 1, sizeof *c->rim);
    if (status == TET_OK) c->rim[c->n_rim++] = (tet_keyed){(uint64_t)f << 32 | c->ways->way[row], along};
  }
  return status;
}

/* The border of each facet's cover, segment by segment, taken from the chain. */
static tet_status take_cover(cover *c) {
  const tet_mesh *m = c->mesh;
  size_t n = 3 * (size_t)m->n_subfaces, next = 0;
  tet_status status = TET_OK;
  sort_edges(c);
  for (size_t i = 0, run; i < n && status == TET_OK; i += run) {
    for (run = 1; i + run < n && c->edge[i + run].key == c->edge[i].key;) run++;
    while (next < m->n_subsegments && c->subseg[next].key < c->edge[i].key) next++;
    int on = next < m->n_subsegments && c->subseg[next].key == c->edge[i].key;
    status = look_at_edge(c, i, run, on ? (uint32_t)c->subseg[next].value : TET_NONE);
    if (status == TET_OK && (i & 1023) == 0) status = tet_poll(c->ctx);
  }
  tet_sort_keyed(c->rim, c->n_rim);
  for (size_t i = 0, run; i < c->n_rim && status == TET_OK; i += run) {
    uint32_t f = (uint32_t)(c->rim[i].key >> 32), way = (uint32_t)c->rim[i].key;
    const uint32_t *end = c->ways->end + 2 * (size_t)way;
    for (run = 1; i + run < c->n_rim && c->rim[i + run].key == c->rim[i].key;) run++;
    if (end[0] == TET_NONE || run != c->ways->size[way] || c->rim[i].value != c->rim[i + run - 1].value)
      c->bad[f] = 1;
    else
      status = tet_chain_add(c->ctx, &c->chain, f, end[0], end[1], c->rim[i].value ? -1 : 1);
  }
  return status;
}

/* A number that facets of one group with the same sides, or with none, have in common. */
static uint64_t mark_of_sides(const tet_pls *pls, const tet_mesh *mesh, uint32_t f) {
  uint64_t sum = mesh->facet_same_as[f] * 0x9e3779b97f4a7c15u;
  uint32_t p = pls->facet_start ? pls->facet_start[f] : f, q = pls->facet_start ? pls->facet_start[f + 1] : f + 1;
  for (; p < q; p++)
    for (uint32_t from = pls->polygon_start[p], to = pls->polygon_start[p + 1], i = from; i < to; i++) {
      uint32_t a = mesh->point_same_as[pls->polygon_vertices[i]];
      uint32_t b = mesh->point_same_as[pls->polygon_vertices[i + 1 < to ? i + 1 : from]];
      uint64_t h = (a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a) * 0x9e3779b97f4a7c15u;
      h = (h ^ h >> 31) * 0xbf58476d1ce4e5b9u;
      sum += a == b ? 0 : h ^ h >> 29;
    }
  return sum;
}

/* May facet f, which does not repeat another, count with facet `root`? Only in its plane, with its marker. */
static int belongs(const cover *c, uint32_t f, uint32_t root) {
  const tet_pls *pls = c->pls;
  const uint32_t *v = c->view[root].v;
  if (v[0] == TET_NONE || marker_of(pls, f) != marker_of(pls, root)) return 0;
  uint32_t p = pls->facet_start ? pls->facet_start[f] : f, q = pls->facet_start ? pls->facet_start[f + 1] : f + 1;
  for (uint32_t i = pls->polygon_start[p]; i < pls->polygon_start[q]; i++) {
    const double *x = place(c->mesh, c->mesh->point_same_as[pls->polygon_vertices[i]]);
    if (tet_orient3d_xyz(place(c->mesh, v[0]), place(c->mesh, v[1]), place(c->mesh, v[2]), x) != 0) return 0;
  }
  return 1;
}

/* The borders of all facets, to the chain; one that repeats another of its group counts once. */
static tet_status add_outlines(cover *c) {
  uint32_t n = c->pls->n_facets;
  tet_keyed *item = tet_alloc(c->ctx, n, sizeof *item);
  uint8_t *in_group = tet_calloc(c->ctx, n, 1);
  tet_status status = item && in_group ? TET_OK : tet_ctx_error(c->ctx)->status;
  size_t m = 0;
  for (uint32_t f = 0; f < n && status == TET_OK; f++) {
    uint32_t root = c->mesh->facet_same_as[f];
    if (root != f) in_group[root] = in_group[f] = 1;
  }
  for (uint32_t f = 0; f < n && status == TET_OK; f++)
    if (in_group[f]) item[m++] = (tet_keyed){mark_of_sides(c->pls, c->mesh, f), f};
  if (status == TET_OK) tet_sort_keyed(item, m);
  for (size_t k = 1; k < m; k++) /* in_group 2: repeats the one before it */
    if (item[k].key == item[k - 1].key && c->mesh->facet_same_as[item[k].value] == c->mesh->facet_same_as[item[k - 1].value])
      in_group[item[k].value] = 2;
  for (uint32_t f = 0; f < n && status == TET_OK; f++) {
    uint32_t root = c->mesh->facet_same_as[f];
    if (in_group[f] == 2) continue;
    if (root != f && !belongs(c, f, root)) c->bad[root] = 1;
    status = tet_facet_outline(c->ctx, c->pls, c->mesh, f, root, c->view[root].axis, &c->chain);
    if (status == TET_OK && (f & 255) == 0) status = tet_poll(c->ctx);
  }
  tet_free(c->ctx, item);
  tet_free(c->ctx, in_group);
  return status;
}

/* Is hole seed x in subface s of facet f? */
static int holds_seed(const cover *c, uint32_t s, uint32_t f, const double *x) {
  const uint32_t *v = c->mesh->subfaces + 3 * (size_t)s;
  if (!c->up[s]) return 0;
  for (int k = 0; k < 3; k++) { /* its box */
    double a = place(c->mesh, v[0])[k], b = place(c->mesh, v[1])[k], d = place(c->mesh, v[2])[k];
    if (k != c->view[f].axis && ((x[k] < a && x[k] < b && x[k] < d) || (x[k] > a && x[k] > b && x[k] > d))) return 0;
  }
  for (int k = 0; k < 3; k++)
    if (c->up[s] * tet_orient2d_xyz(c->view[f].axis, place(c->mesh, v[k]), place(c->mesh, v[(k + 1) % 3]), x) <= 0)
      return 0;
  return 1;
}

/* A hole's seed must be in no subface of its facet. */
static tet_status look_into_holes(cover *c) {
  const tet_mesh *m = c->mesh;
  const tet_pls *pls = c->pls;
  if (!pls->n_facet_holes) return TET_OK;
  uint32_t *start = tet_calloc(c->ctx, (size_t)pls->n_facets + 2, sizeof *start); /* seeds by their facet's number */
  uint32_t *seed = tet_alloc(c->ctx, pls->n_facet_holes, sizeof *seed);
  tet_status status = start && seed ? TET_OK : tet_ctx_error(c->ctx)->status;
  for (int fill = 0; fill < 2 && status == TET_OK; fill++) {
    for (uint32_t f = 0; f < pls->n_facets; f++)
      for (uint32_t h = pls->facet_hole_start[f]; h < pls->facet_hole_start[f + 1]; h++) {
        uint32_t *at = &start[m->facet_same_as[f] + (fill ? 1 : 2)];
        if (fill) seed[*at] = h;
        ++*at;
      }
    for (uint32_t f = 0; f < pls->n_facets && !fill; f++) start[f + 2] += start[f + 1];
  }
  for (uint32_t s = 0; s < m->n_subfaces && status == TET_OK; s++) {
    uint32_t f = m->subface_facets[s];
    for (uint32_t k = start[f]; k < start[f + 1] && !c->bad[f]; k++)
      if (holds_seed(c, s, f, pls->facet_holes + 3 * (size_t)seed[k])) c->bad[f] = 1;
    if ((s & 255) == 0) status = tet_poll(c->ctx);
  }
  tet_free(c->ctx, start);
  tet_free(c->ctx, seed);
  return status;
}

static tet_status begin(cover *c) {
  c->view = tet_alloc(c->ctx, c->pls->n_facets, sizeof *c->view);
  c->bad = tet_calloc(c->ctx, c->pls->n_facets, 1);
  c->up = tet_alloc(c->ctx, c->mesh->n_subfaces, 1);
  c->edge = tet_alloc(c->ctx, 3 * (size_t)c->mesh->n_subfaces, sizeof *c->edge);
  c->subseg = tet_alloc(c->ctx, c->mesh->n_subsegments, sizeof *c->subseg);
  if (!c->view || !c->bad || !c->up || !c->edge || !c->subseg) return tet_ctx_error(c->ctx)->status;
  for (uint32_t f = 0; f < c->pls->n_facets; f++) tet_view_facet(c->pls, c->mesh, f, &c->view[f]);
  return TET_OK;
}

tet_status tet_audit_cover(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, const tet_ways *ways,
                           tet_audit *found) {
  cover c = {.ctx = ctx, .pls = pls, .mesh = mesh, .ways = ways, .found = found};
  tet_status status = begin(&c);
  if (status == TET_OK) status = look_at_subfaces(&c);
  if (status == TET_OK) status = take_cover(&c);
  if (status == TET_OK) status = add_outlines(&c);
  if (status == TET_OK) status = tet_chain_reduce(ctx, mesh->points, pls->n_facets, &c.chain);
  if (status == TET_OK) status = look_into_holes(&c);
  tet_pls_view view = {ctx, pls, mesh, ways, c.view, c.bad};
  if (status == TET_OK) status = tet_judge_gaps(&view, &c.chain);
  if (status == TET_OK) status = tet_judge_segments(&view, &found->bad_segments);
  for (uint32_t f = pls->n_facets; f-- > 0 && status == TET_OK;) {
    if (!c.bad[f]) continue;
    found->bad_facets++;
    found->facet = f;
  }
  tet_chain_free(ctx, &c.chain);
  tet_free(ctx, c.view);
  tet_free(ctx, c.bad);
  tet_free(ctx, c.up);
  tet_free(ctx, c.edge);
  tet_free(ctx, c.subseg);
  tet_free(ctx, c.rim);
  return status;
}
