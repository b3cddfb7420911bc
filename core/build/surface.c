// SPDX-License-Identifier: Apache-2.0
/* surface.c: tet_surface_build, the order of its steps.
 *
 * Facets are triangulated and everything is tested against everything. Vertices that
 * lie on facets or loose segments join these, then segments in facets' planes do, and
 * the round begins anew, until nothing more meets but where it may. */
#include <stdlib.h>
#include <string.h>

#include "build/soup.h"

static tet_status add_piece(tet_soup *s, uint32_t a, uint32_t b, uint32_t facet, uint32_t segment) {
  tet_status st = tet_grow(s->ctx, &s->piece, &s->cap_piece, (size_t)s->n_pieces + 1, sizeof *s->piece);
  if (st == TET_OK) s->piece[s->n_pieces++] = (tet_piece){a, b, facet, segment};
  return st;
}

static tet_status add_loose(tet_soup *s, uint32_t v) {
  tet_status st = tet_grow(s->ctx, &s->loose, &s->cap_loose, (size_t)s->n_loose + 1, sizeof *s->loose);
  if (st == TET_OK) s->loose[s->n_loose++] = v;
  return st;
}

/* Marks a polygon's vertices used; one that comes down to one or two vertices is a
 * loose point or segment. */
static tet_status add_polygon(tet_soup *s, uint32_t f, uint32_t p) {
  uint32_t a = TET_NONE, b = TET_NONE, more = 0;
  for (uint32_t i = s->pls->polygon_start[p]; i < s->pls->polygon_start[p + 1]; i++) {
    uint32_t v = s->same_as[s->pls->polygon_vertices[i]];
    s->used[v] = 1;
    if (a == TET_NONE || v == a) a = v;
    else if (b == TET_NONE || v == b) b = v;
    else more++;
  }
  if (more > 0) return TET_OK;
  return b == TET_NONE ? add_loose(s, a) : add_piece(s, a, b, f, TET_NONE);
}

static tet_status add_loose_vertices(tet_soup *s) {
  const tet_pls *pls = s->pls;
  tet_status st = TET_OK;
  if (pls->n_loose_points == TET_LOOSE_ALL_UNUSED) {
    for (uint32_t v = 0; v < pls->n_points && st == TET_OK; v++) {
      if (s->same_as[v] != v || s->used[v]) continue;
      s->used[v] = 1;
      st = add_loose(s, v);
    }
    return st;
  }
  for (uint32_t i = 0; i < pls->n_loose_points && st == TET_OK; i++) {
    uint32_t v = s->same_as[pls->loose_points[i]];
    if (s->used[v]) continue;
    s->used[v] = 1;
    st = add_loose(s, v);
  }
  for (uint32_t v = 0; v < pls->n_points; v++) s->n_unused += s->same_as[v] == v && !s->used[v];
  return st;
}

static tet_status find_used(tet_soup *s) {
  const tet_pls *pls = s->pls;
  tet_status st = TET_OK;
  for (uint32_t f = 0; f < pls->n_facets; f++) {
    if (s->repeats[f] != TET_NONE) continue;
    for (uint32_t p = tet_first_polygon(pls, f); p < tet_first_polygon(pls, f + 1); p++)
      if ((st = add_polygon(s, f, p)) != TET_OK) return st;
  }
  for (uint32_t i = 0; i < pls->n_segments && st == TET_OK; i++) {
    uint32_t a = s->same_as[pls->segments[2 * (size_t)i]], b = s->same_as[pls->segments[2 * (size_t)i + 1]];
    s->used[a] = s->used[b] = 1;
    st = a == b ? add_loose(s, a) : add_piece(s, a, b, TET_NONE, i);
  }
  return st == TET_OK ? add_loose_vertices(s) : st;
}

static int compare_joins(const void *px, const void *py) {
  const tet_join *x = px, *y = py;
  if (x->facet != y->facet) return x->facet < y->facet ? -1 : 1;
  return x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

static int compare_constraints(const void *px, const void *py) {
  const tet_constraint *x = px, *y = py;
  if (x->facet != y->facet) return x->facet < y->facet ? -1 : 1;
  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  if (x->b != y->b) return x->b < y->b ? -1 : 1;
  if (x->kind != y->kind) return x->kind < y->kind ? -1 : 1;
  return x->owner < y->owner ? -1 : x->owner > y->owner;
}

/* Adds the new joins to the old ones, sorted, each once. */
static tet_status apply_joins(tet_soup *s) {
  size_t n = (size_t)s->n_joins + s->n_new_joins;
  tet_status st = tet_grow(s->ctx, &s->join, &s->cap_join, n, sizeof *s->join);
  if (st != TET_OK || s->n_new_joins == 0) return st;
  uint32_t before = s->n_joins, kept = 0;
  memcpy(s->join + s->n_joins, s->new_join, s->n_new_joins * sizeof *s->join);
  qsort(s->join, n, sizeof *s->join, compare_joins);
  for (size_t i = 0; i < n; i++)
    if (i == 0 || compare_joins(&s->join[i], &s->join[kept - 1]) != 0) s->join[kept++] = s->join[i];
  s->n_joins = kept;
  if (kept == before) return tet_internal(s->ctx, "a vertex joined its facet twice");
  return TET_OK;
}

/* A split with the vertex's place along its piece. */
typedef struct ordered_split {
  uint32_t piece, vertex;
  double along; /* the coordinate in which the piece extends most: monotone on it */
} ordered_split;

static int compare_splits(const void *px, const void *py) {
  const ordered_split *x = px, *y = py;
  if (x->piece != y->piece) return x->piece < y->piece ? -1 : 1;
  if (x->along != y->along) return x->along < y->along ? -1 : 1;
  return x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

/* A coordinate in which the ends of a piece differ, and the sign of its growth. */
static int piece_axis(const tet_soup *s, const tet_piece *p, double *ret_sign) {
  const double *a = tet_soup_x(s, p->a), *b = tet_soup_x(s, p->b);
  int k = 0;
  while (k < 2 && a[k] == b[k]) k++;
  *ret_sign = a[k] < b[k] ? 1.0 : -1.0;
  return k;
}

/* Splits pieces at the vertices found on them. */
static tet_status apply_splits(tet_soup *s) {
  uint32_t n = s->n_splits;
  if (n == 0) return TET_OK;
  ordered_split *o = tet_alloc(s->ctx, n, sizeof *o);
  if (!o) return tet_ctx_error(s->ctx)->status;
  for (uint32_t i = 0; i < n; i++) {
    double sign;
    int k = piece_axis(s, &s->piece[s->split[i].piece], &sign);
    o[i] = (ordered_split){s->split[i].piece, s->split[i].vertex, sign * tet_soup_x(s, s->split[i].vertex)[k]};
  }
  qsort(o, n, sizeof *o, compare_splits);
  tet_status st = TET_OK;
  uint32_t current = TET_NONE; /* the part that runs to the piece's far end */
  for (uint32_t i = 0; i < n && st == TET_OK; i++) {
    if (i > 0 && compare_splits(&o[i], &o[i - 1]) == 0) continue;
    if (i == 0 || o[i].piece != o[i - 1].piece) current = o[i].piece;
    tet_piece p = s->piece[current];
    s->piece[current].b = o[i].vertex;
    st = add_piece(s, o[i].vertex, p.b, p.facet, p.segment);
    current = s->n_pieces - 1;
  }
  tet_free(s->ctx, o);
  return st;
}

/* 1 if there is a constraint between the same vertices in the same facet: the last
 * of all m, or among the sorted ones of earlier rounds (then the facet could not take
 * it, which is a fault recorded elsewhere). */
static int is_known(const tet_soup *s, uint32_t m, const tet_constraint *c) {
  uint32_t from = 0, to = s->n_constraints;
  if (m == 0) return 0;
  while (from < to) {
    uint32_t mid = from + (to - from) / 2;
    const tet_constraint *d = &s->constraint[mid];
    if (d->facet != c->facet ? d->facet < c->facet : d->a != c->a ? d->a < c->a : d->b < c->b) from = mid + 1;
    else to = mid;
  }
  if (from == s->n_constraints) from = m - 1;
  const tet_constraint *d[2] = {&s->constraint[from], &s->constraint[m - 1]};
  for (int k = 0; k < 2; k++)
    if (d[k]->facet == c->facet && d[k]->a == c->a && d[k]->b == c->b) return 1;
  return 0;
}

/* Adds those new constraints whose ends are vertices of their facet, or with `joins` join it; *ret_added
 * counts them. The others stay in new_constraint. */
static tet_status apply_constraints(tet_soup *s, int joins, uint32_t *ret_added) {
  uint32_t n = s->n_new_constraints, left = 0, m = s->n_constraints, marked = TET_NONE, j = 0;
  *ret_added = 0;
  if (n == 0) return TET_OK;
  qsort(s->new_constraint, n, sizeof *s->new_constraint, compare_constraints);
  uint32_t *mark = tet_alloc(s->ctx, s->points->n, sizeof *mark); /* facet a vertex was last seen in */
  if (!mark) return tet_ctx_error(s->ctx)->status;
  memset(mark, 0xff, (size_t)s->points->n * sizeof *mark);
  tet_status st = tet_grow(s->ctx, &s->constraint, &s->cap_constraint, (size_t)m + n, sizeof *s->constraint);
  for (uint32_t i = 0; i < n && st == TET_OK; i++) {
    const tet_constraint c = s->new_constraint[i];
    if (marked != c.facet)
      for (uint32_t h = 3 * s->first[c.facet]; h < 3 * s->first[c.facet + 1]; h++) mark[s->tri[h]] = c.facet;
    marked = c.facet;
    for (; joins && j < s->n_joins && s->join[j].facet <= c.facet; j++) /* both are sorted by facet */
      if (s->join[j].facet == c.facet) mark[s->join[j].vertex] = c.facet;
    if (is_known(s, m, &c)) continue;
    if (mark[c.a] == c.facet && mark[c.b] == c.facet) s->constraint[m++] = c;
    else s->new_constraint[left++] = c;
  }
  if (st == TET_OK) {
    *ret_added = m - s->n_constraints;
    s->n_constraints = m;
    s->n_new_constraints = left;
    qsort(s->constraint, m, sizeof *s->constraint, compare_constraints);
  }
  tet_free(s->ctx, mark);
  return st;
}

/* With the joins of a round, those of its new constraints that no join can change: sides of facets that
 * nothing joins, between vertices that their new facet has now. Or else a facet would be triangulated
 * across all segments that it is about to take, and would meet the square of their number. */
static tet_status apply_early(tet_soup *s) {
  uint32_t n = s->n_new_constraints, kept = 0;
  if (n == 0 || s->n_splits > 0) return TET_OK;
  uint8_t *joined = tet_calloc(s->ctx, s->pls->n_facets, 1);
  if (!joined) return tet_ctx_error(s->ctx)->status;
  for (uint32_t i = 0; i < s->n_new_joins; i++) joined[s->new_join[i].facet] = 1;
  for (uint32_t i = 0; i < n; i++) {
    const tet_constraint c = s->new_constraint[i];
    if (c.kind == TET_OFFENDER_FACET && !joined[c.owner]) s->new_constraint[kept++] = c;
  }
  tet_free(s->ctx, joined);
  s->n_new_constraints = kept;
  return apply_constraints(s, 1, &n);
}

/* Segments in a facet's plane that leave the facet other than at a vertex. */
static tet_status fault_constraints(tet_soup *s) {
  tet_status st = TET_OK;
  for (uint32_t i = 0; i < s->n_new_constraints && st == TET_OK; i++) {
    const tet_constraint *c = &s->new_constraint[i];
    tet_fault fault = {.status = TET_E_INTERSECTION};
    fault.offence = (tet_offence){.kind = {TET_OFFENDER_FACET, c->kind}, .index = {c->facet, c->owner}};
    for (int k = 0; k < 3; k++) fault.offence.place[k] = 0.5 * tet_soup_x(s, c->a)[k] + 0.5 * tet_soup_x(s, c->b)[k];
    st = tet_soup_fault(s, &fault);
  }
  return st;
}

/* Triangulates and tests until nothing joins anything; then fails if there are faults. */
static tet_status resolve(tet_soup *s) {
  for (int round = 0;; round++) {
    uint32_t added = 0;
    s->n_faults = 0;
    s->planarity = 0;
    tet_status st = tet_triangulate_facets(s, round == 0);
    if (st == TET_OK) st = tet_find_intersections(s);
    if (st != TET_OK) return st;
    if (s->n_new_joins + s->n_splits > 0) {
      if ((st = apply_joins(s)) != TET_OK || (st = apply_early(s)) != TET_OK || (st = apply_splits(s)) != TET_OK)
        return st;
      continue;
    }
    if ((st = apply_constraints(s, 0, &added)) != TET_OK) return st;
    if (added > 0) continue;
    st = fault_constraints(s);
    return st == TET_OK ? tet_soup_fail(s) : st;
  }
}

static void free_soup(tet_soup *s) {
  tet_ctx *ctx = s->ctx;
  tet_free(ctx, s->same_as);
  tet_free(ctx, s->used);
  tet_free(ctx, s->repeats);
  tet_free(ctx, s->tri);
  tet_free(ctx, s->edge);
  tet_free(ctx, s->facet);
  tet_free(ctx, s->first);
  tet_free(ctx, s->axis);
  tet_free(ctx, s->flat);
  tet_free(ctx, s->piece);
  tet_free(ctx, s->loose);
  tet_free(ctx, s->join);
  tet_free(ctx, s->constraint);
  tet_free(ctx, s->fault);
  tet_free(ctx, s->new_join);
  tet_free(ctx, s->split);
  tet_free(ctx, s->new_constraint);
}

static tet_status start(tet_soup *s) {
  tet_ctx *ctx = s->ctx;
  size_t n = s->pls->n_points, m = s->pls->n_facets;
  s->same_as = tet_alloc(ctx, n, sizeof *s->same_as);
  s->used = tet_calloc(ctx, n, 1);
  s->repeats = tet_alloc(ctx, m, sizeof *s->repeats);
  s->first = tet_calloc(ctx, m + 1, sizeof *s->first);
  s->axis = tet_calloc(ctx, m, 1);
  s->flat = tet_calloc(ctx, m, 1);
  if (!s->same_as || !s->used || !s->repeats || !s->first || !s->axis || !s->flat)
    return tet_ctx_error(ctx)->status;
  memset(s->repeats, 0xff, m * sizeof *s->repeats);
  return TET_OK;
}

tet_status tet_surface_build(tet_ctx *ctx, const tet_pls *pls, const tet_points *points, double tolerance,
                             double merge_angle, tet_surface *ret_surface) {
  tet_soup s = {.ctx = ctx, .pls = pls, .points = points, .tolerance = tolerance, .merge_angle = merge_angle};
  tet_surface r = {0};
  tet_status st = tet_check_pls(ctx, pls);
  if (st == TET_OK) st = start(&s);
  if (st == TET_OK) st = tet_find_duplicates(&s);
  if (st == TET_OK) st = tet_find_repeated_facets(&s);
  if (st == TET_OK) st = find_used(&s);
  if (st == TET_OK && pls->n_facets > 0) st = tet_find_corners(&s);
  if (st == TET_OK) st = resolve(&s);
  if (st == TET_OK) st = tet_make_patches(&s, &r);
  if (st == TET_OK) st = tet_surface_flip_all(ctx, &r, points);
  if (st == TET_OK) {
    r.same_as = s.same_as;
    r.used = s.used;
    s.same_as = NULL;
    s.used = NULL;
    r.repeats = s.repeats;
    s.repeats = NULL;
    r.planarity = s.planarity;
    r.n_duplicates = s.n_duplicates;
    r.n_repeated_facets = s.n_repeated_facets;
    r.n_unused = s.n_unused;
    *ret_surface = r;
  } else {
    tet_surface_free(ctx, &r);
  }
  free_soup(&s);
  return st;
}
