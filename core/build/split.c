// SPDX-License-Identifier: Apache-2.0
/* split.c: the surface kept constrained Delaunay: Lawson flips inside patches, Steiner points on
 * subsegments (thesis A.3.3) and break points inside patches (5.5). Predicates are exact on
 * implicit points, and subsegments are never flipped. */
#include "build/soup.h"
#include "exact/predicates.h"

typedef struct flip_stack {
  uint32_t *h;
  uint32_t n;
  size_t cap;
} flip_stack;

static tet_status push(tet_ctx *ctx, flip_stack *q, uint32_t h) {
  tet_status st = tet_grow(ctx, &q->h, &q->cap, (size_t)q->n + 1, sizeof *q->h);
  if (st == TET_OK) q->h[q->n++] = h;
  return st;
}

/* What stands at an edge of a triangle. */
typedef struct place {
  uint32_t org, adj, seg, ring;
} place;

static place take(const tet_surface *s, uint32_t h) {
  return (place){s->tri[h], s->tri_adj[h], s->tri_seg[h], s->tri_ring[h]};
}

/* Puts what was at edge `from` at edge `to`, and tells its neighbours. The ring's
 * other edges are in other triangles than those being rewritten. */
static void put(tet_surface *s, uint32_t to, uint32_t from, place p) {
  if (p.adj != TET_NONE) s->tri_adj[p.adj] = to;
  if (p.seg != TET_NONE) {
    if (s->subseg_tri[p.seg] == from) s->subseg_tri[p.seg] = to;
    if (p.ring == from) {
      p.ring = to;
    } else {
      uint32_t g = p.ring;
      while (s->tri_ring[g] != from) g = s->tri_ring[g];
      s->tri_ring[g] = to;
    }
  }
  s->tri[to] = p.org;
  s->tri_adj[to] = p.adj;
  s->tri_seg[to] = p.seg;
  s->tri_ring[to] = p.ring;
}

/* An edge inside a patch. */
static void put_inner(tet_surface *s, uint32_t h, uint32_t org, uint32_t adj) {
  s->tri[h] = org;
  s->tri_adj[h] = adj;
  s->tri_seg[h] = s->tri_ring[h] = TET_NONE;
}

/* Replaces the diagonal ab of quadrilateral adbc by cd: h's triangle becomes dca, with
 * h from d to c, the other one cdb. */
static void flip(tet_surface *s, uint32_t h) {
  uint32_t g = s->tri_adj[h];
  uint32_t h1 = tet_next3(h), h2 = tet_prev3(h), g1 = tet_next3(g), g2 = tet_prev3(g);
  place bc = take(s, h1), ca = take(s, h2), ad = take(s, g1), db = take(s, g2);
  put_inner(s, h, db.org, g);
  put_inner(s, g, ca.org, h);
  put(s, h1, h2, ca);
  put(s, h2, g1, ad);
  put(s, g1, g2, db);
  put(s, g2, h1, bc);
}

/* 1 if inner edge h is not locally Delaunay in its patch. */
static int must_flip(const tet_surface *s, const tet_points *points, uint32_t h) {
  const tet_patch *p = &s->patch[s->tri_patch[h / 3]];
  uint32_t g = s->tri_adj[h];
  int in = tet_insphere_sos(points, s->tri[h], s->tri[tet_next3(h)], s->tri[tet_prev3(h)], p->off_plane,
                            s->tri[tet_prev3(g)]);
  return in * p->side > 0;
}

static tet_status legalize(tet_ctx *ctx, tet_surface *s, const tet_points *points, flip_stack *q) {
  for (uint64_t steps = 0; q->n > 0; steps++) {
    uint32_t h = q->h[--q->n];
    tet_status st = steps % 1024 == 1023 ? tet_poll(ctx) : TET_OK;
    if (st != TET_OK) return st;
    if (s->tri_adj[h] == TET_NONE || !must_flip(s, points, h)) continue;
    uint32_t g = s->tri_adj[h];
    flip(s, h);
    const uint32_t around[4] = {tet_next3(h), tet_prev3(h), tet_next3(g), tet_prev3(g)};
    for (int k = 0; k < 4 && st == TET_OK; k++) st = push(ctx, q, around[k]);
    if (st != TET_OK) return st;
  }
  return TET_OK;
}

tet_status tet_surface_flip_all(tet_ctx *ctx, tet_surface *s, const tet_points *points) {
  flip_stack q = {0};
  tet_status st = TET_OK;
  for (uint32_t h = 0; h < 3 * s->n_tris && st == TET_OK; h++) {
    if (s->tri_adj[h] == TET_NONE || s->tri_adj[h] < h) continue;
    if ((st = push(ctx, &q, h)) == TET_OK) st = legalize(ctx, s, points, &q);
  }
  tet_free(ctx, q.h);
  return st;
}

static tet_status reserve(tet_ctx *ctx, tet_surface *s, size_t triangles, size_t subsegs) {
  tet_status st;
  if (triangles >= TET_NONE / 3) return tet_fail(ctx, TET_E_TOO_LARGE, "%zu facet triangles", triangles);
  if ((st = tet_grow(ctx, &s->tri, &s->cap_tri, triangles, 3 * sizeof *s->tri)) != TET_OK ||
      (st = tet_grow(ctx, &s->tri_adj, &s->cap_tri_adj, triangles, 3 * sizeof *s->tri_adj)) != TET_OK ||
      (st = tet_grow(ctx, &s->tri_seg, &s->cap_tri_seg, triangles, 3 * sizeof *s->tri_seg)) != TET_OK ||
      (st = tet_grow(ctx, &s->tri_ring, &s->cap_tri_ring, triangles, 3 * sizeof *s->tri_ring)) != TET_OK ||
      (st = tet_grow(ctx, &s->tri_patch, &s->cap_tri_patch, triangles, sizeof *s->tri_patch)) != TET_OK ||
      (st = tet_grow(ctx, &s->subseg, &s->cap_subseg, subsegs, 2 * sizeof *s->subseg)) != TET_OK ||
      (st = tet_grow(ctx, &s->subseg_segment, &s->cap_subseg_segment, subsegs, sizeof(uint32_t))) != TET_OK)
    return st;
  return tet_grow(ctx, &s->subseg_tri, &s->cap_subseg_tri, subsegs, sizeof(uint32_t));
}

/* Puts edge h on subsegment e, into its ring. */
static void hang(tet_surface *s, uint32_t h, uint32_t e) {
  uint32_t first = s->subseg_tri[e];
  s->tri_adj[h] = TET_NONE;
  s->tri_seg[h] = e;
  if (first == TET_NONE) {
    s->subseg_tri[e] = s->tri_ring[h] = h;
  } else {
    s->tri_ring[h] = s->tri_ring[first];
    s->tri_ring[first] = h;
  }
}

/* Splits the triangle of edge h = xy, third vertex z, at v on that edge: it stays
 * x v z; a new one v y z is appended. Returns the new one's first edge. */
static uint32_t split_triangle(tet_surface *s, uint32_t h, uint32_t v) {
  uint32_t h1 = tet_next3(h), g = 3 * s->n_tris++;
  uint32_t z = s->tri[tet_prev3(h)];
  place yz = take(s, h1);
  s->tri_patch[g / 3] = s->tri_patch[h / 3];
  s->tri[g] = v; /* its place on a ring follows */
  put(s, g + 1, h1, yz);
  put_inner(s, g + 2, z, h1);
  put_inner(s, h1, v, g + 2);
  return g;
}

tet_status tet_surface_split(tet_ctx *ctx, tet_surface *s, const tet_points *points, uint32_t e, uint32_t v) {
  uint32_t first = s->subseg_tri[e], n = 0, b = s->subseg[2 * (size_t)e + 1], a = s->subseg[2 * (size_t)e];
  for (uint32_t h = first; h != TET_NONE; h = s->tri_ring[h] == first ? TET_NONE : s->tri_ring[h]) n++;
  flip_stack q = {0};
  tet_status st = reserve(ctx, s, (size_t)s->n_tris + n, (size_t)s->n_subsegs + 1);
  if (st == TET_OK) st = tet_grow(ctx, &q.h, &q.cap, 2 * (size_t)n, sizeof *q.h);
  if (st != TET_OK) {
    tet_free(ctx, q.h);
    return st;
  }
  uint32_t far = s->n_subsegs++;
  s->subseg[2 * (size_t)e + 1] = v;
  s->subseg[2 * (size_t)far] = v;
  s->subseg[2 * (size_t)far + 1] = b;
  s->subseg_segment[far] = s->subseg_segment[e];
  s->subseg_tri[e] = s->subseg_tri[far] = TET_NONE;
  uint32_t h = first;
  for (uint32_t i = 0; i < n; i++) {
    uint32_t next = s->tri_ring[h];
    int forward = s->tri[h] == a;
    uint32_t g = split_triangle(s, h, v);
    hang(s, h, forward ? e : far);
    hang(s, g, forward ? far : e);
    q.h[q.n++] = tet_prev3(h);
    q.h[q.n++] = g + 1;
    h = next;
  }
  st = legalize(ctx, s, points, &q);
  tet_free(ctx, q.h);
  return st;
}

/* Splits triangle xyz of edge h = xy at v inside it: it stays x y v; y z v and z x v are appended. */
static void split_inside(tet_surface *s, uint32_t h, uint32_t v, flip_stack *q) {
  uint32_t h1 = tet_next3(h), h2 = tet_prev3(h), g = 3 * s->n_tris, k = g + 3;
  place yz = take(s, h1), zx = take(s, h2);
  s->n_tris += 2;
  s->tri_patch[g / 3] = s->tri_patch[k / 3] = s->tri_patch[h / 3];
  put(s, g, h1, yz);
  put(s, k, h2, zx);
  put_inner(s, h1, yz.org, g + 2);
  put_inner(s, h2, v, k + 1);
  put_inner(s, g + 1, zx.org, k + 2);
  put_inner(s, g + 2, v, h1);
  put_inner(s, k + 1, s->tri[h], h2);
  put_inner(s, k + 2, v, g + 1);
  q->h[q->n++] = h;
  q->h[q->n++] = g;
  q->h[q->n++] = k;
}

/* Splits the two triangles of inner edge h at v on it. */
static void split_edge(tet_surface *s, uint32_t h, uint32_t v, flip_stack *q) {
  uint32_t g = s->tri_adj[h], x = s->tri[h], y = s->tri[g];
  uint32_t a = split_triangle(s, h, v), b = split_triangle(s, g, v);
  put_inner(s, h, x, b); /* x v and back, */
  put_inner(s, b, v, h);
  put_inner(s, g, y, a); /* y v and back */
  put_inner(s, a, v, g);
  q->h[q->n++] = tet_prev3(h);
  q->h[q->n++] = a + 1;
  q->h[q->n++] = tet_prev3(g);
  q->h[q->n++] = b + 1;
}

tet_status tet_surface_add(tet_ctx *ctx, tet_surface *s, const tet_points *points, uint32_t h, int on_edge, uint32_t v) {
  flip_stack q = {0};
  tet_status st = reserve(ctx, s, (size_t)s->n_tris + 2, s->n_subsegs);
  if (st == TET_OK) st = tet_grow(ctx, &q.h, &q.cap, 4, sizeof *q.h);
  if (st == TET_OK) {
    (on_edge ? split_edge : split_inside)(s, h, v, &q);
    st = legalize(ctx, s, points, &q);
  }
  tet_free(ctx, q.h);
  return st;
}

void tet_surface_free(tet_ctx *ctx, tet_surface *s) {
  tet_free(ctx, s->patch);
  tet_free(ctx, s->repeats);
  tet_free(ctx, s->facet_same_as);
  tet_free(ctx, s->tri);
  tet_free(ctx, s->tri_adj);
  tet_free(ctx, s->tri_seg);
  tet_free(ctx, s->tri_patch);
  tet_free(ctx, s->plane_start);
  tet_free(ctx, s->plane);
  tet_free(ctx, s->facet);
  tet_free(ctx, s->segment);
  tet_free(ctx, s->subseg);
  tet_free(ctx, s->subseg_segment);
  tet_free(ctx, s->subseg_tri);
  tet_free(ctx, s->tri_ring);
  tet_free(ctx, s->same_as);
  tet_free(ctx, s->used);
  *s = (tet_surface){0};
}
