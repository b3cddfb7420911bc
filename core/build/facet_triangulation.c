// SPDX-License-Identifier: Apache-2.0
/* facet_triangulation.c: every facet to triangles (thesis A.3.2, "Triangulate a
 * Facet"): its polygons' sides, loose segments and points, what has joined it, as a
 * 2D constrained Delaunay triangulation. What is not a facet is recorded as a fault;
 * such a facet gets no triangles. */
#include <stdlib.h>
#include <string.h>

#include "build/facet_work.h"
#include "exact/predicates.h"

static tet_status fault_at(tet_facet_work *w, tet_status status, const char *what, uint32_t vertex) {
  const double *x = tet_soup_x(w->s, vertex);
  tet_fault fault = {.status = status, .amount = w->deviation, .what = what};
  fault.offence = (tet_offence){.kind = {TET_OFFENDER_FACET, TET_OFFENDER_FACET},
                                .index = {w->facet, TET_NONE},
                                .marker = {tet_facet_marker(w->s->pls, w->facet), 0},
                                .place = {x[0], x[1], x[2]}};
  return tet_soup_fault(w->s, &fault);
}

/* Polygon p without repeated consecutive vertices, appended as a loop. */
static tet_status add_loop(tet_facet_work *w, uint32_t p) {
  const tet_soup *s = w->s;
  uint32_t i0 = s->pls->polygon_start[p], i1 = s->pls->polygon_start[p + 1];
  uint32_t from = w->loop_start[w->n_loops], n = from;
  tet_status st = tet_grow(s->ctx, &w->loop, &w->cap_loop, (size_t)from + (i1 - i0), sizeof *w->loop);
  if (st == TET_OK)
    st = tet_grow(s->ctx, &w->loop_start, &w->cap_loop_start, (size_t)w->n_loops + 2, sizeof *w->loop_start);
  if (st != TET_OK) return st;
  for (uint32_t i = i0; i < i1; i++) {
    uint32_t v = s->same_as[s->pls->polygon_vertices[i]];
    if (n == from || w->loop[n - 1] != v) w->loop[n++] = v;
  }
  while (n > from + 1 && w->loop[n - 1] == w->loop[from]) n--;
  w->loop_start[++w->n_loops] = n;
  if (n - from >= 3) w->n_areas++;
  return TET_OK;
}

/* 1 if all vertices of the loop are on one line. */
static int is_degenerate(const tet_facet_work *w, uint32_t l) {
  uint32_t from = w->loop_start[l], to = w->loop_start[l + 1];
  if (to - from < 3) return 0;
  for (uint32_t i = from + 2; i < to; i++)
    if (!tet_collinear(w->s->points, w->loop[from], w->loop[from + 1], w->loop[i])) return 0;
  return 1;
}

static tet_status add_point(tet_facet_work *w, uint32_t v) {
  if (w->local[v] != TET_NONE) return TET_OK;
  tet_status st = tet_grow(w->s->ctx, &w->global, &w->cap_global, (size_t)w->n + 1, sizeof *w->global);
  if (st != TET_OK) return st;
  w->local[v] = w->n;
  w->global[w->n++] = v;
  return TET_OK;
}

static tet_status add_side(tet_facet_work *w, uint32_t a, uint32_t b, const tet_side *of) {
  tet_status st = tet_grow(w->s->ctx, &w->side, &w->cap_side, (size_t)w->n_sides + 1, sizeof *w->side);
  if (st != TET_OK) return st;
  w->side[w->n_sides] = *of;
  w->side[w->n_sides].lo = a < b ? a : b;
  w->side[w->n_sides++].hi = a < b ? b : a;
  return TET_OK;
}

static int compare_sides(const void *px, const void *py) {
  const tet_side *x = px, *y = py;
  if (x->lo != y->lo) return x->lo < y->lo ? -1 : 1;
  if (x->hi != y->hi) return x->hi < y->hi ? -1 : 1;
  return x->loop < y->loop ? -1 : x->loop > y->loop;
}

/* Row of the first join or constraint of facet f in an array sorted by facet. */
static uint32_t first_of(const void *array, uint32_t n, size_t size, uint32_t f) {
  uint32_t from = 0, to = n;
  while (from < to) {
    uint32_t mid = from + (to - from) / 2, facet;
    memcpy(&facet, (const char *)array + mid * size, sizeof facet); /* first member */
    if (facet < f) from = mid + 1;
    else to = mid;
  }
  return from;
}

static tet_status add_triangle(tet_soup *s, uint32_t f, const uint32_t v[3], const uint8_t edge[3]) {
  size_t n = s->n_tris;
  tet_status st = tet_grow(s->ctx, &s->tri, &s->cap_tri, n + 1, 3 * sizeof *s->tri);
  if (st == TET_OK) st = tet_grow(s->ctx, &s->edge, &s->cap_edge, n + 1, 3);
  if (st == TET_OK) st = tet_grow(s->ctx, &s->facet, &s->cap_facet, n + 1, sizeof *s->facet);
  if (st != TET_OK) return st;
  if (n >= TET_NONE / 3 - 1) return tet_fail(s->ctx, TET_E_TOO_LARGE, "more than %zu facet triangles", n);
  memcpy(s->tri + 3 * n, v, 3 * sizeof *v);
  memcpy(s->edge + 3 * n, edge, 3);
  s->facet[n] = f;
  s->n_tris++;
  return TET_OK;
}

/* A facet that is one triangle. */
static tet_status single_triangle(tet_facet_work *w) {
  static const uint8_t border[3] = {3, 3, 3};
  uint32_t v[3] = {w->loop[0], w->loop[1], w->loop[2]};
  int axis, sign = tet_projection_axis(w->s, v[0], v[1], v[2], &axis);
  if (sign < 0) {
    v[1] = w->loop[2];
    v[2] = w->loop[1];
  }
  w->s->axis[w->facet] = (uint8_t)axis;
  w->s->flat[w->facet] = 1;
  return add_triangle(w->s, w->facet, v, border);
}

/* Side g crosses the constraint between points a and b. A foreign one is left out,
 * one of the facet's own spoils it. */
static tet_status crossing_fault(tet_facet_work *w, const tet_side *g, uint32_t a, uint32_t b, int *ret_ok) {
  uint32_t lo = a < b ? a : b, hi = a < b ? b : a, i = 0;
  while (i < w->n_sides && (w->side[i].lo != lo || w->side[i].hi != hi)) i++;
  if (i == w->n_sides) return tet_internal(w->s->ctx, "a constraint of nobody");
  const tet_side *other = &w->side[i];
  const double *x = tet_soup_x(w->s, w->global[g->lo]), *y = tet_soup_x(w->s, w->global[g->hi]);
  tet_fault fault = {.status = TET_E_INTERSECTION};
  fault.offence = (tet_offence){.kind = {other->kind, g->kind}, .index = {other->owner, g->owner}};
  for (int k = 0; k < 3; k++) fault.offence.place[k] = 0.5 * x[k] + 0.5 * y[k];
  if (g->kind == TET_OFFENDER_FACET && g->owner == w->facet) *ret_ok = 0;
  return tet_soup_fault(w->s, &fault);
}

/* Makes side g a constraint, in parts where points lie on it. *ret_ok 0: a fault was
 * recorded that leaves no facet. */
static tet_status constrain(tet_facet_work *w, const tet_side *g, int *ret_ok) {
  for (uint32_t from = g->lo, to; from != g->hi; from = to) {
    uint32_t crossed[2];
    tet_status st = tet_cdt2d_constrain(&w->cdt, from, g->hi, &to, crossed);
    if (st != TET_OK) return st;
    if (to == TET_NONE) return crossing_fault(w, g, crossed[0], crossed[1], ret_ok);
    if (!w->flat && to != g->hi &&
        !tet_collinear(w->s->points, w->global[g->lo], w->global[g->hi], w->global[to])) {
      *ret_ok = 0;
      return fault_at(w, TET_E_NOT_PLANAR, "has a vertex over a side of its own", w->global[to]);
    }
    if ((st = add_side(w, from, to, g)) != TET_OK) return st;
  }
  return TET_OK;
}

/* All constraints of the facet: its polygons' sides, then foreign segments. */
static tet_status constrain_all(tet_facet_work *w, int *ret_ok) {
  const tet_soup *s = w->s;
  tet_status st = TET_OK;
  w->n_sides = 0;
  for (uint32_t l = 0; l < w->n_loops; l++) {
    uint32_t from = w->loop_start[l], n = w->loop_start[l + 1] - from;
    for (uint32_t i = 0; i < n && n > 1; i++) {
      if (n == 2 && i == 1) break;
      uint32_t a = w->local[w->loop[from + i]], b = w->local[w->loop[from + (i + 1) % n]];
      tet_side g = {a, b, n == 2 ? TET_NONE : l, TET_OFFENDER_FACET, w->facet};
      if ((st = constrain(w, &g, ret_ok)) != TET_OK) return st;
    }
  }
  uint32_t i = first_of(s->constraint, s->n_constraints, sizeof *s->constraint, w->facet);
  for (; i < s->n_constraints && s->constraint[i].facet == w->facet && st == TET_OK; i++) {
    const tet_constraint *t = &s->constraint[i];
    tet_side g = {w->local[t->a], w->local[t->b], TET_NONE, t->kind, t->owner};
    st = constrain(w, &g, ret_ok);
  }
  qsort(w->side, w->n_sides, sizeof *w->side, compare_sides);
  return st;
}

/* The view that a facet out of plane is triangulated in. */
static tet_status project(tet_facet_work *w) {
  tet_ctx *ctx = w->s->ctx;
  tet_status st = tet_grow(ctx, &w->projected, &w->cap_projected, 3 * ((size_t)w->n + 1), sizeof(double));
  if (st == TET_OK) st = tet_grow(ctx, &w->identity, &w->cap_identity, w->n, sizeof(uint32_t));
  if (st != TET_OK) return st;
  for (uint32_t i = 0; i <= w->n; i++) {
    memcpy(w->projected + 3 * (size_t)i, tet_soup_x(w->s, w->global[i < w->n ? i : 0]), 3 * sizeof(double));
    w->projected[3 * (size_t)i + w->axis] = i < w->n ? 0 : w->scale;
  }
  for (uint32_t i = 0; i < w->n; i++) w->identity[i] = i;
  w->view = (tet_points){.x = w->projected, .n = w->n + 1, .first_implicit = UINT32_MAX, .implicit = NULL,
                         .max_abs = w->s->points->max_abs > w->scale ? w->s->points->max_abs : w->scale};
  return TET_OK;
}

static tet_status triangulate_points(tet_facet_work *w, int *ret_ok) {
  uint32_t same[2];
  tet_status st;
  if (w->flat) {
    uint32_t off = tet_corner_off(w->s, w->span[0], w->span[1], w->span[2]);
    st = tet_cdt2d_points(&w->cdt, w->s->points, w->global, w->n, w->axis, off, same);
  } else {
    if ((st = project(w)) != TET_OK) return st;
    st = tet_cdt2d_points(&w->cdt, &w->view, w->identity, w->n, w->axis, w->n, same);
  }
  if (st != TET_OK || same[0] == TET_NONE) return st;
  *ret_ok = 0;
  return fault_at(w, TET_E_NOT_PLANAR, "has two vertices over each other", w->global[same[1]]);
}

/* Flags of edge h: which sides it carries. */
static uint8_t edge_flags(const tet_facet_work *w, uint32_t h) {
  if (!w->cdt.fixed[h]) return 0;
  uint32_t g = w->cdt.adj[h];
  int beyond = g != TET_NONE && w->kept[g / 3];
  return beyond ? TET_EDGE_FIXED : TET_EDGE_FIXED | TET_EDGE_BORDER;
}

/* Sides of polygons with no kept triangle beside them become loose pieces. */
static tet_status add_dangling_sides(tet_facet_work *w) {
  tet_soup *s = w->s;
  const tet_cdt2d *c = &w->cdt;
  for (uint32_t i = 0; i < w->n_sides; i++) {
    const tet_side *d = &w->side[i];
    if (d->loop == TET_NONE) continue;
    if (i > 0 && d[-1].lo == d->lo && d[-1].hi == d->hi && d[-1].loop != TET_NONE) continue;
    uint32_t h = tet_cdt2d_find(c, d->lo, d->hi);
    if (h == TET_NONE) return tet_internal(s->ctx, "a polygon's side is no edge");
    if (w->kept[h / 3] || (c->adj[h] != TET_NONE && w->kept[c->adj[h] / 3])) continue;
    tet_status st = tet_grow(s->ctx, &s->piece, &s->cap_piece, (size_t)s->n_pieces + 1, sizeof *s->piece);
    if (st != TET_OK) return st;
    s->piece[s->n_pieces++] = (tet_piece){w->global[d->lo], w->global[d->hi], w->facet, TET_NONE};
  }
  return TET_OK;
}

static tet_status deliver(tet_facet_work *w, int first_round) {
  tet_soup *s = w->s;
  const tet_cdt2d *c = &w->cdt;
  uint32_t before = s->n_tris;
  for (uint32_t t = 0; t < c->n_tris; t++) {
    if (!w->kept[t]) continue;
    uint32_t v[3];
    uint8_t edge[3];
    for (uint32_t j = 0; j < 3; j++) {
      v[j] = w->global[c->tri[3 * t + j]];
      edge[j] = edge_flags(w, 3 * t + j);
    }
    tet_status st = add_triangle(s, w->facet, v, edge);
    if (st != TET_OK) return st;
  }
  s->axis[w->facet] = (uint8_t)w->axis;
  s->flat[w->facet] = (uint8_t)w->flat;
  if (w->deviation > s->planarity) s->planarity = w->deviation;
  if (w->n_areas > 0 && s->n_tris == before)
    return fault_at(w, TET_E_DEGENERATE, "has no area left", w->global[0]);
  return first_round ? add_dangling_sides(w) : TET_OK;
}

/* A facet of any shape, from its loops in w. */
static tet_status general_facet(tet_facet_work *w, int first_round) {
  const tet_soup *s = w->s;
  tet_status st = TET_OK;
  int area, ok = 1;
  for (uint32_t i = 0; i < w->loop_start[w->n_loops] && st == TET_OK; i++) st = add_point(w, w->loop[i]);
  if (st != TET_OK) return st;
  tet_facet_plane(w, &area);
  if (!area) return TET_OK; /* points and segments on one line: pieces alone */
  if (w->deviation > s->tolerance) {
    if (w->n_areas == 0) return TET_OK; /* segments that share no plane enclose nothing */
    return fault_at(w, TET_E_NOT_PLANAR, "is out of plane", w->global[0]);
  }
  uint32_t i = first_of(s->join, s->n_joins, sizeof *s->join, w->facet);
  for (; i < s->n_joins && s->join[i].facet == w->facet && st == TET_OK; i++) st = add_point(w, s->join[i].vertex);
  if (st == TET_OK) st = triangulate_points(w, &ok);
  if (st == TET_OK && ok) st = constrain_all(w, &ok);
  if (st == TET_OK && ok) st = tet_facet_area(w);
  if (st == TET_OK && ok) st = deliver(w, first_round);
  return st;
}

static tet_status triangulate_facet(tet_facet_work *w, int first_round) {
  const tet_soup *s = w->s;
  const tet_pls *pls = s->pls;
  tet_status st = TET_OK;
  w->n_loops = w->n_areas = w->n = 0;
  w->deviation = 0;
  for (uint32_t p = tet_first_polygon(pls, w->facet); p < tet_first_polygon(pls, w->facet + 1); p++)
    if ((st = add_loop(w, p)) != TET_OK) return st;
  for (uint32_t l = 0; l < w->n_loops; l++)
    if (is_degenerate(w, l))
      return fault_at(w, TET_E_DEGENERATE, "has a polygon without area", w->loop[w->loop_start[l]]);
  uint32_t j = first_of(s->join, s->n_joins, sizeof *s->join, w->facet);
  uint32_t t = first_of(s->constraint, s->n_constraints, sizeof *s->constraint, w->facet);
  int alone = (j == s->n_joins || s->join[j].facet != w->facet) &&
              (t == s->n_constraints || s->constraint[t].facet != w->facet) &&
              (pls->n_facet_holes == 0 || pls->facet_hole_start[w->facet] == pls->facet_hole_start[w->facet + 1]);
  if (alone && w->n_loops == 1 && w->loop_start[1] == 3) return single_triangle(w);
  st = general_facet(w, first_round);
  for (uint32_t i = 0; i < w->n; i++) w->local[w->global[i]] = TET_NONE;
  return st;
}

static void free_work(tet_ctx *ctx, tet_facet_work *w) {
  tet_cdt2d_free(&w->cdt);
  tet_free(ctx, w->local);
  tet_free(ctx, w->global);
  tet_free(ctx, w->loop_start);
  tet_free(ctx, w->loop);
  tet_free(ctx, w->projected);
  tet_free(ctx, w->identity);
  tet_free(ctx, w->side);
  tet_free(ctx, w->kept);
  tet_free(ctx, w->odd);
  tet_free(ctx, w->frame);
  tet_free(ctx, w->flood);
}

tet_status tet_triangulate_facets(tet_soup *s, int first_round) {
  tet_facet_work w = {.s = s};
  w.cdt.ctx = s->ctx;
  w.local = tet_alloc(s->ctx, s->points->n, sizeof *w.local);
  tet_status st = w.local ? TET_OK : tet_ctx_error(s->ctx)->status;
  if (st == TET_OK) memset(w.local, 0xff, (size_t)s->points->n * sizeof *w.local);
  if (st == TET_OK) st = tet_grow(s->ctx, &w.loop_start, &w.cap_loop_start, 1, sizeof *w.loop_start);
  if (st == TET_OK) w.loop_start[0] = 0;
  s->n_tris = 0;
  for (w.facet = 0; w.facet < s->pls->n_facets && st == TET_OK; w.facet++) {
    s->first[w.facet] = s->n_tris;
    if (w.facet % 256 == 0) st = tet_poll(s->ctx);
    if (st == TET_OK && s->repeats[w.facet] == TET_NONE) st = triangulate_facet(&w, first_round);
  }
  s->first[s->pls->n_facets] = s->n_tris;
  free_work(s->ctx, &w);
  return st;
}
