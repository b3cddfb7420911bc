// SPDX-License-Identifier: Apache-2.0
/* facet_area.c: which triangles of the hull's triangulation are the facet.
 *
 * A search from outside crosses the sides of polygons and keeps, for every polygon,
 * the parity of its crossings: a triangle is inside a polygon where it is odd (so a
 * side that a polygon walks twice, as a bridge to an inner turn, bounds nothing).
 * A facet of 2-vertex polygons alone is what they enclose. Facet holes flood from
 * their seed up to the next constraint (thesis A.1.2). */
#include <string.h>

#include "build/facet_work.h"
#include "exact/predicates.h"

/* The first side with these local ends, or n_sides. */
static uint32_t first_side(const tet_facet_work *w, uint32_t lo, uint32_t hi) {
  uint32_t from = 0, to = w->n_sides;
  while (from < to) {
    uint32_t mid = from + (to - from) / 2;
    const tet_side *s = &w->side[mid];
    if (s->lo < lo || (s->lo == lo && s->hi < hi)) from = mid + 1;
    else to = mid;
  }
  return from;
}

/* Crosses edge h of the triangulation; *count is the number of odd loops. */
static void cross_edge(tet_facet_work *w, uint32_t h, uint32_t *count) {
  if (!w->cdt.fixed[h]) return;
  uint32_t a = w->cdt.tri[h], b = w->cdt.tri[tet_next3(h)];
  uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
  for (uint32_t i = first_side(w, lo, hi); i < w->n_sides && w->side[i].lo == lo && w->side[i].hi == hi; i++) {
    if (w->side[i].loop == TET_NONE) continue;
    uint8_t *odd = &w->odd[w->side[i].loop];
    *odd ^= 1;
    if (*odd) ++*count;
    else --*count;
  }
}

/* Depth-first from the hull edge `start`: the state of all loops goes along, and
 * back on return. kept: 2 means not seen. */
static tet_status search_parity(tet_facet_work *w, uint32_t start) {
  tet_ctx *ctx = w->s->ctx;
  uint32_t depth = 0, count = 0;
  memset(w->odd, 0, w->n_loops);
  cross_edge(w, start, &count);
  w->frame[depth++] = (tet_frame){start, 0};
  w->kept[start / 3] = count > 0;
  while (depth > 0) {
    tet_frame *f = &w->frame[depth - 1];
    if (f->next == 3) {
      cross_edge(w, f->enter, &count);
      depth--;
      continue;
    }
    uint32_t h = f->enter / 3 * 3 + f->next++, g = w->cdt.adj[h];
    if (g == TET_NONE || w->kept[g / 3] != 2) continue;
    cross_edge(w, h, &count);
    w->kept[g / 3] = count > 0;
    w->frame[depth++] = (tet_frame){g, 0};
    if (depth % 4096 == 0 && tet_poll(ctx) != TET_OK) return tet_ctx_error(ctx)->status;
  }
  return TET_OK;
}

/* Clears kept on what is reached from triangle t without crossing constraints.
 * Flooded triangles are marked by `mark` on the way, so that all are seen once. */
static void flood(tet_facet_work *w, uint32_t t) {
  uint32_t n = 0;
  if (!w->kept[t]) return;
  w->kept[t] = 0;
  w->flood[n++] = t;
  while (n > 0) {
    uint32_t h = 3 * w->flood[--n];
    for (uint32_t j = 0; j < 3; j++) {
      uint32_t g = w->cdt.adj[h + j];
      if (g == TET_NONE || w->cdt.fixed[h + j] || !w->kept[g / 3]) continue;
      w->kept[g / 3] = 0;
      w->flood[n++] = g / 3;
    }
  }
}

static tet_status hole_fault(tet_facet_work *w, const double *seed, const char *what) {
  tet_fault fault = {.status = TET_E_SEED, .what = what};
  fault.offence = (tet_offence){.kind = {TET_OFFENDER_FACET, TET_OFFENDER_FACET},
                                .index = {w->facet, TET_NONE},
                                .marker = {tet_facet_marker(w->s->pls, w->facet), 0},
                                .place = {seed[0], seed[1], seed[2]}};
  return tet_soup_fault(w->s, &fault);
}

static tet_status cut_hole(tet_facet_work *w, const double *seed) {
  const tet_cdt2d *c = &w->cdt;
  uint32_t t = tet_cdt2d_locate(c, seed);
  if (t == TET_NONE) return hole_fault(w, seed, "has a hole seed outside");
  for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
    const double *a = c->points->x + 3 * (size_t)c->id[c->tri[h]];
    const double *b = c->points->x + 3 * (size_t)c->id[c->tri[tet_next3(h)]];
    if (c->fixed[h] && tet_orient2d_xyz(c->axis, a, b, seed) == 0)
      return hole_fault(w, seed, "has a hole seed on a side");
  }
  flood(w, t);
  return TET_OK;
}

static tet_status reserve(tet_facet_work *w) {
  tet_ctx *ctx = w->s->ctx;
  size_t m = w->cdt.n_tris;
  tet_status st = tet_grow(ctx, &w->kept, &w->cap_kept, m, 1);
  if (st == TET_OK) st = tet_grow(ctx, &w->odd, &w->cap_odd, w->n_loops, 1);
  if (st == TET_OK) st = tet_grow(ctx, &w->frame, &w->cap_frame, m, sizeof *w->frame);
  if (st == TET_OK) st = tet_grow(ctx, &w->flood, &w->cap_flood, m, sizeof *w->flood);
  return st;
}

tet_status tet_facet_area(tet_facet_work *w) {
  const tet_pls *pls = w->s->pls;
  const tet_cdt2d *c = &w->cdt;
  tet_status st = reserve(w);
  if (st != TET_OK || c->n_tris == 0) return st;
  uint32_t n_handles = 3 * c->n_tris, h = 0;
  if (w->n_areas > 0) {
    memset(w->kept, 2, c->n_tris);
    while (c->adj[h] != TET_NONE) h++;
    if ((st = search_parity(w, h)) != TET_OK) return st;
  } else {
    memset(w->kept, 1, c->n_tris);
    for (h = 0; h < n_handles; h++)
      if (c->adj[h] == TET_NONE && !c->fixed[h]) flood(w, h / 3);
  }
  if (pls->n_facet_holes == 0) return TET_OK;
  for (uint32_t i = pls->facet_hole_start[w->facet]; i < pls->facet_hole_start[w->facet + 1] && st == TET_OK; i++)
    st = cut_hole(w, pls->facet_holes + 3 * (size_t)i);
  return st;
}
