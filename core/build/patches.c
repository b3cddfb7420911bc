// SPDX-License-Identifier: Apache-2.0
/* patches.c: the soup's triangles joined to patches and segments (thesis A.3.2,
 * "Connect Incident Facets").
 *
 * Every distinct edge becomes a segment, or an inner edge of a patch. Inner: edges of
 * a facet's own triangulation between exactly coplanar triangles, and sides that two
 * coplanar flat facets of one marker share alone; those facets are one. Where such facets meet at an
 * angle that the caller calls flat, the side stays a segment, a crease. */
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "build/soup.h"
#include "exact/predicates.h"

typedef struct soup_edge {
  uint32_t a, b;    /* a < b */
  uint32_t first;   /* handle 3t+j of a triangle on it, or TET_NONE; the others follow */
  uint32_t n;       /* triangles on it */
  uint32_t segment; /* lowest row of pls->segments on it, or TET_NONE */
  uint32_t facet;   /* lowest facet without area that has it as a loose segment, or TET_NONE */
  uint8_t flags;    /* of all its handles */
  uint8_t declared; /* a loose piece lies here */
  uint8_t crease;
  uint8_t merge;    /* two facets become one across it */
  uint32_t number;  /* of the segment, or TET_NONE */
} soup_edge;

typedef struct joiner {
  tet_soup *s;
  tet_surface *r;
  uint32_t *table; /* edge rows by hash */
  uint64_t mask;
  uint32_t n_edges;
  soup_edge *edge;
  size_t cap_edge;
  uint32_t *next;    /* [n_tris][3] next handle on the same edge, or TET_NONE */
  uint32_t *edge_of; /* [n_tris][3] */
  uint32_t *parent;  /* [n_facets] union-find; the lowest facet is the root */
  uint32_t *row;     /* [n_facets] of surface facets, for roots */
  uint8_t *swapped;  /* [n_tris] vertices 1 and 2 were exchanged */
} joiner;

static tet_status find_edge(joiner *w, uint32_t u, uint32_t v, uint32_t *ret_row) {
  uint32_t a = u < v ? u : v, b = u < v ? v : u;
  uint64_t h = ((uint64_t)a << 32 | b) * 0x9e3779b97f4a7c15ULL;
  uint64_t i = (h ^ h >> 32) & w->mask;
  for (; w->table[i] != TET_NONE; i = (i + 1) & w->mask) {
    const soup_edge *e = &w->edge[w->table[i]];
    if (e->a == a && e->b == b) {
      *ret_row = w->table[i];
      return TET_OK;
    }
  }
  tet_status st = tet_grow(w->s->ctx, &w->edge, &w->cap_edge, (size_t)w->n_edges + 1, sizeof *w->edge);
  if (st != TET_OK) return st;
  w->edge[w->n_edges] = (soup_edge){
      .a = a, .b = b, .first = TET_NONE, .segment = TET_NONE, .facet = TET_NONE, .number = TET_NONE};
  *ret_row = w->table[i] = w->n_edges++;
  return TET_OK;
}

static tet_status collect_edges(joiner *w) {
  const tet_soup *s = w->s;
  tet_status st;
  uint32_t row;
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    if ((st = find_edge(w, s->tri[h], s->tri[tet_next3(h)], &row)) != TET_OK) return st;
    if (h % 4096 == 0 && (st = tet_poll(s->ctx)) != TET_OK) return st;
    soup_edge *e = &w->edge[row];
    w->next[h] = e->first;
    w->edge_of[h] = row;
    e->first = h;
    e->n++;
    e->flags |= s->edge[h];
  }
  for (uint32_t p = 0; p < s->n_pieces; p++) {
    if ((st = find_edge(w, s->piece[p].a, s->piece[p].b, &row)) != TET_OK) return st;
    soup_edge *e = &w->edge[row];
    e->declared = 1;
    if (s->piece[p].segment < e->segment) e->segment = s->piece[p].segment;
    uint32_t f = s->piece[p].facet;
    if (f < e->facet && s->first[f] == s->first[f + 1]) e->facet = f;
  }
  return TET_OK;
}

static uint32_t root(joiner *w, uint32_t f) {
  while (w->parent[f] != f) f = w->parent[f] = w->parent[w->parent[f]];
  return f;
}

static int coplanar(const joiner *w, uint32_t g, uint32_t h) {
  const uint32_t *t = w->s->tri + 3 * (size_t)(g / 3);
  return tet_orient3d(w->s->points, t[0], t[1], t[2], w->s->tri[tet_prev3(h)]) == 0;
}

/* The way from the line ab to x, turned by a quarter around it. */
static void arm(const joiner *w, uint32_t a, uint32_t b, uint32_t x, double ret[3]) {
  double u[3], d[3];
  tet_minus(tet_soup_x(w->s, b), tet_soup_x(w->s, a), u);
  tet_minus(tet_soup_x(w->s, x), tet_soup_x(w->s, a), d);
  double scale = sqrt(tet_square(u)), size = sqrt(tet_square(d)); /* no square of theirs overflows below */
  for (int k = 0; k < 3; k++) {
    u[k] /= scale;
    d[k] /= size;
  }
  tet_cross(u, d, ret);
}

/* Do two triangles meet at edge e flat enough to be one for refinement? Then notes how far from flat.
 * In doubles: what is merged steers points, and stays where it is. */
static int is_nearly_flat(const joiner *w, const soup_edge *e, uint32_t g, uint32_t h) {
  double p[3], q[3], across[3], limit = tet_sine_of_degrees(w->s->merge_angle);
  uint32_t x = w->s->tri[tet_prev3(g)], y = w->s->tri[tet_prev3(h)];
  arm(w, e->a, e->b, x, p);
  arm(w, e->a, e->b, y, q);
  tet_cross(p, q, across);
  double cosine = -tet_dot(p, q), sine2 = tet_square(across), lengths2 = tet_square(p) * tet_square(q);
  if (!(limit > 0 && cosine > 0 && sine2 <= limit * limit * lengths2)) return 0;
  double angle = atan2(sqrt(sine2), cosine) * (180 / 3.14159265358979323846);
  if (angle > w->r->merged_angle) w->r->merged_angle = angle;
  for (int k = 0; k < 2; k++) {
    double d[3], away = sqrt(sine2 / lengths2);
    tet_minus(tet_soup_x(w->s, k ? y : x), tet_soup_x(w->s, e->a), d);
    double distance = away * sqrt(tet_square(k ? q : p)) * sqrt(tet_square(d));
    if (distance > w->r->merged_distance) w->r->merged_distance = distance;
  }
  return 1;
}

/* Decides crease and merge of an edge; returns 1 if it is a segment. */
static int classify(const joiner *w, soup_edge *e) {
  const tet_soup *s = w->s;
  if (e->declared || e->n != 2) return 1;
  uint32_t g = e->first, h = w->next[g], f = s->facet[g / 3], k = s->facet[h / 3];
  if (f == k) {
    if (e->flags & TET_EDGE_FIXED) return 1;
    e->crease = !s->flat[f] && !coplanar(w, g, h);
    return e->crease;
  }
  if (!(s->edge[g] & s->edge[h] & TET_EDGE_BORDER)) return 1;
  if (tet_facet_marker(s->pls, f) != tet_facet_marker(s->pls, k)) return 1;
  e->merge = s->flat[f] && s->flat[k] && coplanar(w, g, h);
  e->crease = !e->merge && is_nearly_flat(w, e, g, h);
  return !e->merge;
}

/* A loose segment has its own marker; one that is a whole facet of a file format
 * without loose segments has that facet's. */
static int32_t segment_marker(const joiner *w, const soup_edge *e) {
  const tet_pls *pls = w->s->pls;
  if (e->segment != TET_NONE) return pls->segment_markers ? pls->segment_markers[e->segment] : 0;
  return e->facet != TET_NONE ? tet_facet_marker(pls, e->facet) : 0;
}

static tet_status make_segments(joiner *w) {
  tet_surface *r = w->r;
  tet_ctx *ctx = w->s->ctx;
  uint32_t n = 0;
  for (uint32_t i = 0; i < w->n_edges; i++) {
    soup_edge *e = &w->edge[i];
    if (classify(w, e)) e->number = n++;
    if (!e->merge) continue;
    uint32_t f = root(w, w->s->facet[e->first / 3]), g = root(w, w->s->facet[w->next[e->first] / 3]);
    if (f < g) w->parent[g] = f;
    else w->parent[f] = g;
  }
  r->n_segments = r->n_subsegs = n;
  r->segment = tet_alloc(ctx, n, sizeof *r->segment);
  if (!r->segment || tet_grow(ctx, &r->subseg, &r->cap_subseg, (size_t)n + 1, 2 * sizeof *r->subseg) != TET_OK ||
      tet_grow(ctx, &r->subseg_segment, &r->cap_subseg_segment, (size_t)n + 1, sizeof(uint32_t)) != TET_OK ||
      tet_grow(ctx, &r->subseg_tri, &r->cap_subseg_tri, (size_t)n + 1, sizeof(uint32_t)) != TET_OK)
    return tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; i < w->n_edges; i++) {
    const soup_edge *e = &w->edge[i];
    if (e->number == TET_NONE) continue;
    r->segment[e->number] = (tet_segment){.a = e->a,
                                          .b = e->b,
                                          .marker = segment_marker(w, e),
                                          .crease = e->crease,
                                          .loose = !e->crease && !(e->flags & TET_EDGE_BORDER)};
    r->subseg[2 * (size_t)e->number] = e->a;
    r->subseg[2 * (size_t)e->number + 1] = e->b;
    r->subseg_segment[e->number] = e->number;
  }
  return TET_OK;
}

static tet_status make_facets(joiner *w) {
  const tet_soup *s = w->s;
  tet_surface *r = w->r;
  r->facet = tet_alloc(s->ctx, s->pls->n_facets, sizeof *r->facet);
  r->facet_same_as = tet_alloc(s->ctx, s->pls->n_facets, sizeof *r->facet_same_as);
  if (!r->facet || !r->facet_same_as) return tet_ctx_error(s->ctx)->status;
  for (uint32_t f = 0; f < s->pls->n_facets; f++) {
    r->facet_same_as[f] = root(w, s->repeats[f] != TET_NONE ? s->repeats[f] : f);
    if (s->first[f] == s->first[f + 1] || root(w, f) != f) continue;
    w->row[f] = r->n_facets;
    r->facet[r->n_facets++] = (tet_facet){f, tet_facet_marker(s->pls, f)};
  }
  return TET_OK;
}

/* The handle across inner edge h, or TET_NONE at a segment. */
static uint32_t across(const joiner *w, uint32_t h) {
  const soup_edge *e = &w->edge[w->edge_of[h]];
  if (e->number != TET_NONE) return TET_NONE;
  return e->first == h ? w->next[h] : e->first;
}

/* Edge j of triangle t keeps its ends but not its place when vertices 1 and 2 are
 * exchanged: edges 0 and 2 change places. */
static uint32_t placed(const joiner *w, uint32_t h) {
  return w->swapped[h / 3] ? h / 3 * 3 + (2 - h % 3) : h;
}

/* A new patch: axis and off-plane vertex by its first triangle. */
static tet_status add_patch(joiner *w, uint32_t t, size_t *cap) {
  const tet_soup *s = w->s;
  tet_surface *r = w->r;
  tet_status st = tet_grow(s->ctx, &r->patch, cap, (size_t)r->n_patches + 1, sizeof *r->patch);
  if (st != TET_OK) return st;
  const uint32_t *v = s->tri + 3 * (size_t)t;
  int axis, sign = tet_projection_axis(s, v[0], v[1], v[2], &axis);
  uint32_t off = tet_corner_off(s, v[0], v[1], v[2]);
  if (sign == 0 || off == TET_NONE) return tet_internal(s->ctx, "a patch without area");
  int side = sign * tet_orient3d(s->points, v[0], v[1], v[2], off);
  r->patch[r->n_patches++] = (tet_patch){.facet = w->row[root(w, s->facet[t])],
                                         .axis = (uint8_t)axis,
                                         .side = (int8_t)side,
                                         .off_plane = off};
  return TET_OK;
}

/* Patches are what inner edges connect. */
static tet_status make_patches(joiner *w) {
  const tet_soup *s = w->s;
  tet_surface *r = w->r;
  size_t cap = 0, cap_stack = 0;
  uint32_t *stack = NULL;
  tet_status st = TET_OK;
  if (s->n_tris > 0) memset(r->tri_patch, 0xff, s->n_tris * sizeof *r->tri_patch);
  for (uint32_t t = 0; t < s->n_tris && st == TET_OK; t++) {
    if (r->tri_patch[t] != TET_NONE) continue;
    if (t % 1024 == 0) st = tet_poll(s->ctx);
    if (st == TET_OK) st = add_patch(w, t, &cap);
    uint32_t n = 0, patch = r->n_patches - 1;
    if (st == TET_OK) st = tet_grow(s->ctx, &stack, &cap_stack, 1, sizeof *stack);
    if (st != TET_OK) break;
    r->tri_patch[t] = patch;
    stack[n++] = t;
    while (n > 0 && st == TET_OK) {
      uint32_t u = stack[--n];
      const uint32_t *v = s->tri + 3 * (size_t)u;
      w->swapped[u] = tet_orient2d(s->points, r->patch[patch].axis, v[0], v[1], v[2]) < 0;
      st = tet_grow(s->ctx, &stack, &cap_stack, (size_t)n + 3, sizeof *stack);
      for (uint32_t h = 3 * u; h < 3 * u + 3 && st == TET_OK; h++) {
        uint32_t g = across(w, h);
        if (g == TET_NONE || r->tri_patch[g / 3] != TET_NONE) continue;
        r->tri_patch[g / 3] = patch;
        stack[n++] = g / 3;
      }
    }
  }
  tet_free(s->ctx, stack);
  return st;
}

static tet_status alloc_triangles(joiner *w) {
  const tet_soup *s = w->s;
  tet_ctx *ctx = s->ctx;
  tet_surface *r = w->r;
  size_t n = s->n_tris;
  tet_status st = tet_grow(ctx, &r->tri, &r->cap_tri, n, 3 * sizeof *r->tri);
  if (st == TET_OK) st = tet_grow(ctx, &r->tri_adj, &r->cap_tri_adj, n, 3 * sizeof *r->tri_adj);
  if (st == TET_OK) st = tet_grow(ctx, &r->tri_seg, &r->cap_tri_seg, n, 3 * sizeof *r->tri_seg);
  if (st == TET_OK) st = tet_grow(ctx, &r->tri_ring, &r->cap_tri_ring, n, 3 * sizeof *r->tri_ring);
  if (st == TET_OK) st = tet_grow(ctx, &r->tri_patch, &r->cap_tri_patch, n, sizeof *r->tri_patch);
  return st;
}

static void fill_triangles(joiner *w) {
  const tet_soup *s = w->s;
  tet_surface *r = w->r;
  r->n_tris = s->n_tris;
  for (uint32_t t = 0; t < s->n_tris; t++)
    for (uint32_t j = 0; j < 3; j++)
      r->tri[3 * t + j] = s->tri[3 * t + (w->swapped[t] && j > 0 ? 3 - j : j)];
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    uint32_t g = across(w, h), to = placed(w, h);
    const soup_edge *e = &w->edge[w->edge_of[h]];
    r->tri_adj[to] = g == TET_NONE ? TET_NONE : placed(w, g);
    r->tri_seg[to] = e->number;
    r->tri_ring[to] = TET_NONE;
    if (e->number != TET_NONE) r->tri_ring[to] = placed(w, w->next[h] != TET_NONE ? w->next[h] : e->first);
  }
  for (uint32_t i = 0; i < w->n_edges; i++) {
    const soup_edge *e = &w->edge[i];
    if (e->number != TET_NONE) r->subseg_tri[e->number] = e->first == TET_NONE ? TET_NONE : placed(w, e->first);
  }
}

/* Triangles by the number of their patch. */
static void sort_by_patch(const tet_surface *r, uint32_t *count, uint32_t *order) {
  for (uint32_t t = 0; t < r->n_tris; t++) count[r->tri_patch[t] + 1]++;
  for (uint32_t p = 0; p < r->n_patches; p++) count[p + 1] += count[p];
  for (uint32_t t = 0; t < r->n_tris; t++) order[count[r->tri_patch[t]]++] = t;
}

/* The patches of each vertex, each once; by the order of patches, so that they rise. */
static tet_status list_planes(const tet_soup *s, tet_surface *r) {
  uint32_t n = s->points->n, *end = tet_alloc(s->ctx, n, sizeof *end);
  uint32_t *count = tet_calloc(s->ctx, (size_t)r->n_patches + 1, sizeof *count);
  uint32_t *order = tet_alloc(s->ctx, r->n_tris, sizeof *order);
  r->plane_start = tet_calloc(s->ctx, (size_t)n + 1, sizeof *r->plane_start);
  r->plane = tet_alloc(s->ctx, 3 * (size_t)r->n_tris, sizeof *r->plane);
  int ok = end && count && order && r->plane_start && r->plane;
  if (ok) {
    uint32_t *start = r->plane_start, kept = 0;
    sort_by_patch(r, count, order);
    for (size_t i = 0; i < 3 * (size_t)r->n_tris; i++) start[r->tri[i] + 1]++;
    for (uint32_t v = 0; v < n; v++) start[v + 1] += start[v];
    memcpy(end, start, n * sizeof *end);
    for (size_t i = 0; i < 3 * (size_t)r->n_tris; i++) {
      uint32_t t = order[i / 3], v = r->tri[3 * (size_t)t + i % 3];
      if (end[v] == start[v] || r->plane[end[v] - 1] != r->tri_patch[t]) r->plane[end[v]++] = r->tri_patch[t];
    }
    for (uint32_t v = 0; v < n; v++) { /* closes the gaps of those listed more than once */
      uint32_t from = start[v];
      start[v] = kept;
      while (from < end[v]) r->plane[kept++] = r->plane[from++];
    }
    start[n] = kept;
  }
  tet_free(s->ctx, end);
  tet_free(s->ctx, count);
  tet_free(s->ctx, order);
  return ok ? TET_OK : tet_ctx_error(s->ctx)->status;
}

static tet_status start(joiner *w) {
  const tet_soup *s = w->s;
  uint64_t size = 16, n = 2 * (uint64_t)s->n_tris + s->n_pieces; /* about 1.5 edges a triangle */
  while (size < 2 * n) size *= 2;
  w->mask = size - 1;
  w->table = tet_alloc(s->ctx, size, sizeof *w->table);
  w->next = tet_alloc(s->ctx, 3 * (size_t)s->n_tris, sizeof *w->next);
  w->edge_of = tet_alloc(s->ctx, 3 * (size_t)s->n_tris, sizeof *w->edge_of);
  w->parent = tet_alloc(s->ctx, s->pls->n_facets, sizeof *w->parent);
  w->row = tet_alloc(s->ctx, s->pls->n_facets, sizeof *w->row);
  w->swapped = tet_calloc(s->ctx, s->n_tris, 1);
  if (!w->table || !w->next || !w->edge_of || !w->parent || !w->row || !w->swapped)
    return tet_ctx_error(s->ctx)->status;
  memset(w->table, 0xff, size * sizeof *w->table);
  for (uint32_t f = 0; f < s->pls->n_facets; f++) w->parent[f] = f;
  return TET_OK;
}

tet_status tet_make_patches(tet_soup *s, tet_surface *r) {
  joiner w = {.s = s, .r = r};
  tet_status st = start(&w);
  if (st == TET_OK) st = collect_edges(&w);
  if (st == TET_OK) st = make_segments(&w);
  if (st == TET_OK) st = make_facets(&w);
  if (st == TET_OK) st = alloc_triangles(&w);
  if (st == TET_OK) st = make_patches(&w);
  if (st == TET_OK) fill_triangles(&w);
  if (st == TET_OK) st = list_planes(s, r);
  tet_free(s->ctx, w.table);
  tet_free(s->ctx, w.edge);
  tet_free(s->ctx, w.next);
  tet_free(s->ctx, w.edge_of);
  tet_free(s->ctx, w.parent);
  tet_free(s->ctx, w.row);
  tet_free(s->ctx, w.swapped);
  return st;
}
