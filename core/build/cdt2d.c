// SPDX-License-Identifier: Apache-2.0
/* cdt2d.c: sweep, Lawson flips, constraint recovery. See cdt2d.h.
 *
 * The sweep adds points in lexicographic order, so each lies outside the hull so
 * far and no location is needed. Constraints: the edges that cross one are flipped
 * where their quadrilateral is strictly convex until none is left (Sloan 1993). */
#include "build/cdt2d.h"

#include <stdlib.h>
#include <string.h>

#include "exact/predicates.h"

typedef struct sweep_key {
  double u, v;
  uint32_t i;
} sweep_key;

static int compare_keys(const void *pa, const void *pb) {
  const sweep_key *a = pa, *b = pb;
  if (a->u != b->u) return a->u < b->u ? -1 : 1;
  if (a->v != b->v) return a->v < b->v ? -1 : 1;
  return a->i < b->i ? -1 : a->i > b->i;
}

static int orient(const tet_cdt2d *c, uint32_t a, uint32_t b, uint32_t d) {
  return tet_orient2d(c->points, c->axis, c->id[a], c->id[b], c->id[d]);
}

static tet_status reserve(tet_cdt2d *c, uint32_t n) {
  tet_ctx *ctx = c->ctx;
  size_t handles = 6 * (size_t)n; /* fewer than 2n triangles */
  tet_status st;
  if (handles >= TET_NONE) return tet_fail(ctx, TET_E_TOO_LARGE, "a facet of %u vertices", n);
  if ((st = tet_grow(ctx, &c->tri, &c->cap_tri, handles, sizeof *c->tri)) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->adj, &c->cap_adj, handles, sizeof *c->adj)) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->fixed, &c->cap_fixed, handles, 1)) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->at, &c->cap_at, n, sizeof *c->at)) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->hull_next, &c->cap_hull_next, n, sizeof(uint32_t))) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->hull_prev, &c->cap_hull_prev, n, sizeof(uint32_t))) != TET_OK) return st;
  if ((st = tet_grow(ctx, &c->hull_edge, &c->cap_hull_edge, n, sizeof(uint32_t))) != TET_OK) return st;
  return tet_grow(ctx, &c->order, &c->cap_order, n, sizeof(sweep_key));
}

static tet_status push(tet_cdt2d *c, uint32_t h) {
  tet_status st = tet_grow(c->ctx, &c->stack, &c->cap_stack, (size_t)c->n_stack + 1, sizeof *c->stack);
  if (st == TET_OK) c->stack[c->n_stack++] = h;
  return st;
}

/* Puts the vertex `org` and the neighbour `across` at handle h. */
static void set_edge(tet_cdt2d *c, uint32_t h, uint32_t org, uint32_t across, uint8_t fixed) {
  c->tri[h] = org;
  c->adj[h] = across;
  c->fixed[h] = fixed;
  c->at[org] = h;
  if (across != TET_NONE) c->adj[across] = h;
  else c->hull_edge[org] = h;
}

/* A new triangle; its edges 1 and 2 are on the hull until linked. */
static uint32_t add_triangle(tet_cdt2d *c, uint32_t u, uint32_t v, uint32_t w, uint32_t across) {
  uint32_t h = 3 * c->n_tris++;
  set_edge(c, h, u, across, 0);
  set_edge(c, h + 1, v, TET_NONE, 0);
  set_edge(c, h + 2, w, TET_NONE, 0);
  return h;
}

static void link_edges(tet_cdt2d *c, uint32_t g, uint32_t h) {
  c->adj[g] = h;
  c->adj[h] = g;
}

/* Replaces the diagonal ab of quadrilateral adbc by cd; edge h becomes d to c. */
static void flip(tet_cdt2d *c, uint32_t h) {
  uint32_t g = c->adj[h];
  uint32_t h1 = tet_next3(h), h2 = tet_prev3(h), g1 = tet_next3(g), g2 = tet_prev3(g);
  uint32_t va = c->tri[h], vb = c->tri[h1], vc = c->tri[h2], vd = c->tri[g2];
  uint32_t bc = c->adj[h1], ca = c->adj[h2], ad = c->adj[g1], db = c->adj[g2];
  uint8_t f_bc = c->fixed[h1], f_ca = c->fixed[h2], f_ad = c->fixed[g1], f_db = c->fixed[g2];
  set_edge(c, h, vd, g, 0); /* h's triangle: d c a; g's: c d b */
  set_edge(c, h1, vc, ca, f_ca);
  set_edge(c, h2, va, ad, f_ad);
  set_edge(c, g, vc, h, 0);
  set_edge(c, g1, vd, db, f_db);
  set_edge(c, g2, vb, bc, f_bc);
}

/* Flips what the stack holds, and what follows from it, to locally Delaunay. */
static tet_status legalize(tet_cdt2d *c) {
  while (c->n_stack > 0) {
    uint32_t h = c->stack[--c->n_stack];
    uint32_t g = c->adj[h];
    if (g == TET_NONE || c->fixed[h]) continue;
    uint32_t a = c->tri[h], b = c->tri[tet_next3(h)], d = c->tri[tet_prev3(h)], e = c->tri[tet_prev3(g)];
    int in = tet_insphere_sos(c->points, c->id[a], c->id[b], c->id[d], c->off, c->id[e]);
    if (in * c->side <= 0) continue;
    flip(c, h);
    const uint32_t around[4] = {tet_next3(h), tet_prev3(h), tet_next3(g), tet_prev3(g)};
    for (int k = 0; k < 4; k++) {
      tet_status st = push(c, around[k]);
      if (st != TET_OK) return st;
    }
  }
  return TET_OK;
}

/* The fan of the first points (on one line) and the first point off it, number k. */
static void first_fan(tet_cdt2d *c, const sweep_key *order, uint32_t k, int sign) {
  uint32_t top = order[k].i, before = TET_NONE;
  for (uint32_t i = 0; i + 1 < k; i++) {
    uint32_t u = order[i].i, v = order[i + 1].i;
    uint32_t h = sign > 0 ? add_triangle(c, u, v, top, TET_NONE) : add_triangle(c, v, u, top, TET_NONE);
    /* edge h: u v; h+1: v top; h+2: top u (mirrored where sign < 0) */
    if (before != TET_NONE) {
      if (sign > 0) link_edges(c, before + 1, h + 2);
      else link_edges(c, before + 2, h + 1);
    }
    before = h;
  }
  for (uint32_t i = 0; i < c->n_tris * 3; i++) {
    if (c->adj[i] != TET_NONE) continue;
    uint32_t u = c->tri[i], v = c->tri[tet_next3(i)];
    c->hull_edge[u] = i;
    c->hull_next[u] = v;
    c->hull_prev[v] = u;
  }
}

/* Joins p, beyond the hull near its last point, to all hull edges it sees. */
static tet_status add_outside(tet_cdt2d *c, uint32_t p, uint32_t last) {
  uint32_t left = last, right = last, first = TET_NONE, h = TET_NONE;
  while (orient(c, c->hull_prev[left], left, p) < 0) left = c->hull_prev[left];
  while (orient(c, right, c->hull_next[right], p) < 0) right = c->hull_next[right];
  if (left == right) return tet_internal(c->ctx, "a swept point sees no hull edge");
  for (uint32_t x = left, y; x != right; x = y) {
    y = c->hull_next[x];
    uint32_t before = h;
    h = add_triangle(c, y, x, p, c->hull_edge[x]); /* edges: y x, x p, p y */
    if (before == TET_NONE) first = h;
    else link_edges(c, before + 2, h + 1);
    tet_status st = push(c, h);
    if (st != TET_OK) return st;
  }
  c->hull_next[left] = p;
  c->hull_prev[p] = left;
  c->hull_next[p] = right;
  c->hull_prev[right] = p;
  c->hull_edge[left] = first + 1;
  c->hull_edge[p] = h + 2;
  return legalize(c);
}

tet_status tet_cdt2d_points(tet_cdt2d *c, const tet_points *points, const uint32_t *id, uint32_t n,
                            int axis, uint32_t off, uint32_t ret_same[2]) {
  tet_status st = reserve(c, n);
  if (st != TET_OK) return st;
  c->points = points;
  c->id = id;
  c->n = n;
  c->axis = axis;
  c->off = off;
  c->n_tris = 0;
  c->n_stack = 0;
  ret_same[0] = ret_same[1] = TET_NONE;
  sweep_key *order = c->order;
  for (uint32_t i = 0; i < n; i++) {
    const double *x = points->x + 3 * (size_t)id[i];
    order[i] = (sweep_key){x[(axis + 1) % 3], x[(axis + 2) % 3], i};
    c->at[i] = TET_NONE;
  }
  qsort(order, n, sizeof *order, compare_keys);
  for (uint32_t i = 1; i < n; i++) {
    if (order[i].u != order[i - 1].u || order[i].v != order[i - 1].v) continue;
    ret_same[0] = order[i - 1].i;
    ret_same[1] = order[i].i;
    return TET_OK;
  }
  uint32_t k = 2;
  int sign = 0;
  for (; k < n && sign == 0; k += sign == 0) sign = orient(c, order[0].i, order[1].i, order[k].i);
  if (sign == 0) return TET_OK;
  c->side = sign * tet_orient3d(points, id[order[0].i], id[order[1].i], id[order[k].i], off);
  if (c->side == 0) return tet_internal(c->ctx, "the point off a facet's plane lies in it");
  first_fan(c, order, k, sign);
  for (uint32_t h = 0; h < 3 * c->n_tris && st == TET_OK; h++) st = push(c, h);
  if (st == TET_OK) st = legalize(c);
  for (uint32_t i = k + 1; i < n && st == TET_OK; i++) {
    if (i % 64 == 0 && (st = tet_poll(c->ctx)) != TET_OK) break;
    st = add_outside(c, order[i].i, order[i - 1].i);
  }
  return st;
}

/* The next edge out of the same origin, counter-clockwise or clockwise, or TET_NONE. */
static uint32_t turn_left(const tet_cdt2d *c, uint32_t h) { return c->adj[tet_prev3(h)]; }
static uint32_t turn_right(const tet_cdt2d *c, uint32_t h) {
  return c->adj[h] == TET_NONE ? TET_NONE : tet_next3(c->adj[h]);
}

/* Walks the star of p: the next handle after h, `start` being the first;
 * *leftwards starts as 1. TET_NONE: all seen. */
static uint32_t star_step(const tet_cdt2d *c, uint32_t h, uint32_t start, int *leftwards) {
  if (*leftwards) {
    uint32_t g = turn_left(c, h);
    if (g == start) return TET_NONE;
    if (g != TET_NONE) return g;
    *leftwards = 0;
    h = start;
  }
  return turn_right(c, h);
}

uint32_t tet_cdt2d_find(const tet_cdt2d *c, uint32_t p, uint32_t q) {
  uint32_t start = c->at[p];
  int leftwards = 1;
  for (uint32_t h = start; h != TET_NONE; h = star_step(c, h, start, &leftwards)) {
    if (c->tri[tet_next3(h)] == q) return h;
    if (c->tri[tet_prev3(h)] == q && c->adj[tet_prev3(h)] == TET_NONE) return tet_prev3(h);
  }
  return TET_NONE;
}

/* 1 if x, on the line pq, lies on q's side of p. */
static int ahead(const tet_cdt2d *c, uint32_t p, uint32_t q, uint32_t x) {
  const double *a = c->points->x + 3 * (size_t)c->id[p], *b = c->points->x + 3 * (size_t)c->id[q];
  const double *y = c->points->x + 3 * (size_t)c->id[x];
  int k = (c->axis + 1) % 3;
  if (a[k] == b[k]) k = (c->axis + 2) % 3;
  return (a[k] < b[k]) == (a[k] < y[k]) && a[k] != y[k];
}

/* Looks from p towards q: either a neighbour of p on the line (returned in *ret_end)
 * or the edge that the line leaves p's star through (returned). */
static uint32_t first_crossing(const tet_cdt2d *c, uint32_t p, uint32_t q, uint32_t *ret_end) {
  uint32_t start = c->at[p];
  int leftwards = 1;
  *ret_end = TET_NONE;
  for (uint32_t h = start; h != TET_NONE; h = star_step(c, h, start, &leftwards)) {
    uint32_t x = c->tri[tet_next3(h)], y = c->tri[tet_prev3(h)];
    int ox = x == q ? 0 : orient(c, p, q, x), oy = y == q ? 0 : orient(c, p, q, y);
    if (ox == 0 && ahead(c, p, q, x)) *ret_end = x;
    else if (oy == 0 && ahead(c, p, q, y)) *ret_end = y;
    else if (ox < 0 && oy > 0) return tet_next3(h);
    if (*ret_end != TET_NONE) return TET_NONE;
  }
  return TET_NONE;
}

/* Queues the edges that pq crosses, from edge e on, up to the first point on it.
 * ret_cross[0] != TET_NONE: one of them is a constraint. */
static tet_status collect_crossings(tet_cdt2d *c, uint32_t p, uint32_t q, uint32_t e,
                                    uint32_t *ret_n, uint32_t *ret_end, uint32_t ret_cross[2]) {
  uint32_t n = 0;
  for (;;) {
    uint32_t x = c->tri[e], y = c->tri[tet_next3(e)], g = c->adj[e];
    if (c->fixed[e]) {
      ret_cross[0] = x;
      ret_cross[1] = y;
      return TET_OK;
    }
    if (g == TET_NONE) return tet_internal(c->ctx, "a constraint leaves the hull");
    tet_status st = tet_grow(c->ctx, &c->queue, &c->cap_queue, (size_t)n + 1, 2 * sizeof *c->queue);
    if (st != TET_OK) return st;
    c->queue[2 * (size_t)n] = x;
    c->queue[2 * (size_t)n + 1] = y;
    *ret_n = ++n;
    uint32_t z = c->tri[tet_prev3(g)];
    int oz = z == q ? 0 : orient(c, p, q, z);
    if (oz == 0) {
      *ret_end = z;
      return TET_OK;
    }
    e = oz < 0 ? tet_prev3(g) : tet_next3(g);
  }
}

/* Flips the n queued edges away from pr; afterwards the edge is there. The queue
 * is a ring of n entries: a flip that gives another crossing edge puts it back.
 * Edges that no longer cross stay in `done` at the ring's front. */
static tet_status flip_away(tet_cdt2d *c, uint32_t p, uint32_t r, uint32_t n) {
  uint32_t left = n; /* entries still crossing; they stand at 0 .. left-1 */
  uint32_t i = 0;
  uint32_t *q = c->queue;
  for (uint64_t steps = 0; left > 0; steps++, i = i + 1 < left ? i + 1 : 0) {
    if (steps % 1024 == 1023) {
      tet_status st = tet_poll(c->ctx);
      if (st != TET_OK) return st;
    }
    uint32_t h = tet_cdt2d_find(c, q[2 * (size_t)i], q[2 * (size_t)i + 1]);
    if (h == TET_NONE || c->adj[h] == TET_NONE) return tet_internal(c->ctx, "a crossing edge vanished");
    uint32_t a = c->tri[h], b = c->tri[tet_next3(h)];
    uint32_t x = c->tri[tet_prev3(h)], y = c->tri[tet_prev3(c->adj[h])];
    if (orient(c, x, a, y) <= 0 || orient(c, y, b, x) <= 0) continue;
    flip(c, h);
    int crosses = x != p && x != r && y != p && y != r && orient(c, p, r, x) * orient(c, p, r, y) < 0;
    if (crosses) {
      q[2 * (size_t)i] = x;
      q[2 * (size_t)i + 1] = y;
      continue;
    }
    left--;
    q[2 * (size_t)i] = q[2 * (size_t)left];
    q[2 * (size_t)i + 1] = q[2 * (size_t)left + 1];
    q[2 * (size_t)left] = x;
    q[2 * (size_t)left + 1] = y;
    if (i > 0) i--; /* look at the entry that took this place */
  }
  return TET_OK;
}

static tet_status fix_edge(tet_cdt2d *c, uint32_t p, uint32_t r) {
  uint32_t h = tet_cdt2d_find(c, p, r);
  if (h == TET_NONE) return tet_internal(c->ctx, "a constraint was not recovered");
  c->fixed[h] = 1;
  if (c->adj[h] != TET_NONE) c->fixed[c->adj[h]] = 1;
  return TET_OK;
}

tet_status tet_cdt2d_constrain(tet_cdt2d *c, uint32_t p, uint32_t q, uint32_t *ret_end,
                               uint32_t ret_cross[2]) {
  uint32_t end, n = 0;
  *ret_end = ret_cross[0] = ret_cross[1] = TET_NONE;
  uint32_t e = first_crossing(c, p, q, &end);
  tet_status st = TET_OK;
  if (end == TET_NONE) {
    if (e == TET_NONE) return tet_internal(c->ctx, "a constraint leaves no star");
    st = collect_crossings(c, p, q, e, &n, &end, ret_cross);
    if (st != TET_OK || ret_cross[0] != TET_NONE) return st;
    st = flip_away(c, p, end, n);
  }
  if (st == TET_OK) st = fix_edge(c, p, end);
  for (uint32_t i = 0; i < n && st == TET_OK; i++) {
    uint32_t h = tet_cdt2d_find(c, c->queue[2 * (size_t)i], c->queue[2 * (size_t)i + 1]);
    if (h != TET_NONE) st = push(c, h);
  }
  if (st == TET_OK) st = legalize(c);
  if (st == TET_OK) *ret_end = end;
  return st;
}

static int holds(const tet_cdt2d *c, uint32_t s, const double *x, uint32_t *ret_exit) {
  for (uint32_t h = 3 * s; h < 3 * s + 3; h++) {
    const double *a = c->points->x + 3 * (size_t)c->id[c->tri[h]];
    const double *b = c->points->x + 3 * (size_t)c->id[c->tri[tet_next3(h)]];
    *ret_exit = h;
    if (tet_orient2d_xyz(c->axis, a, b, x) < 0) return 0;
  }
  return 1;
}

uint32_t tet_cdt2d_locate(const tet_cdt2d *c, const double *x) {
  uint32_t exit_edge, s = 0;
  if (c->n_tris == 0) return TET_NONE;
  /* A walk may circle where constraints keep edges from being Delaunay. */
  for (uint32_t steps = 0; steps < c->n_tris; steps++) {
    if (holds(c, s, x, &exit_edge)) return s;
    uint32_t g = c->adj[exit_edge];
    if (g == TET_NONE) return TET_NONE;
    s = g / 3;
  }
  for (s = 0; s < c->n_tris; s++)
    if (holds(c, s, x, &exit_edge)) return s;
  return TET_NONE;
}

void tet_cdt2d_free(tet_cdt2d *c) {
  tet_free(c->ctx, c->tri);
  tet_free(c->ctx, c->adj);
  tet_free(c->ctx, c->fixed);
  tet_free(c->ctx, c->at);
  tet_free(c->ctx, c->hull_next);
  tet_free(c->ctx, c->hull_prev);
  tet_free(c->ctx, c->hull_edge);
  tet_free(c->ctx, c->stack);
  tet_free(c->ctx, c->queue);
  tet_free(c->ctx, c->order);
}
