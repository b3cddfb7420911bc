// SPDX-License-Identifier: Apache-2.0
/* gaps.c: what is not covered must not be there: outside the mesh, or in a facet's hole.
 *
 * A facet's part that the mesh lacks is bounded by links of input vertices. It may lie outside the
 * mesh: then from no link's end a tetrahedron, closed, holds the way along the link and to its left.
 * What is covered beyond the outline may be a hole's share that its seed does not reach. */
#include "audit/gaps.h"

#include "audit/reach.h"
#include "base/sort.h"
#include "exact/predicates.h"

#include <string.h>

/* The segments by their ends. */
typedef struct end_table {
  tet_keyed *item; /* key: vertex; value: 2 segment + end */
  size_t n;
} end_table;

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

static tet_status list_ends(const tet_pls_view *p, end_table *ret) {
  ret->item = tet_alloc(p->ctx, 2 * (size_t)p->ways->n, sizeof *ret->item);
  if (!ret->item) return tet_ctx_error(p->ctx)->status;
  ret->n = 0;
  for (size_t i = 0; i < 2 * (size_t)p->ways->n; i++)
    if (p->ways->end[i] != TET_NONE) ret->item[ret->n++] = (tet_keyed){p->ways->end[i], i};
  tet_sort_keyed(ret->item, ret->n);
  return TET_OK;
}

/* The end (2 segment + 0 or 1) at vertex `at` of the segment that goes towards `to`, or SIZE_MAX. */
static size_t find_end(const tet_pls_view *p, const end_table *ends, uint32_t at, uint32_t to) {
  size_t low = 0, high = ends->n;
  while (low < high) {
    size_t mid = low + (high - low) / 2;
    if (ends->item[mid].key < at) low = mid + 1;
    else high = mid;
  }
  for (; low < ends->n && ends->item[low].key == at; low++) {
    size_t e = ends->item[low].value;
    if (tet_same_direction(place(p->mesh, at), place(p->mesh, p->ways->end[e ^ 1]), place(p->mesh, to))) return e;
  }
  return SIZE_MAX;
}

/* The flags of link i, from both its ends. */
static void raise_flags(const tet_pls_view *p, const end_table *ends, const tet_link *link, uint64_t i,
                        tet_flag_at flag[2]) {
  const tet_facet_view *view = &p->facet[link->facet];
  uint32_t end[2] = {link->from, link->to}, x = TET_NONE;
  int turn = 0;
  for (int k = 0; k < 3 && !turn; k++) {
    x = view->v[k];
    turn = tet_orient2d_xyz(view->axis, place(p->mesh, end[0]), place(p->mesh, end[1]), place(p->mesh, x));
  }
  for (int k = 0; k < 2; k++) {
    size_t e = find_end(p, ends, end[k], end[!k]);
    flag[k] = (tet_flag_at){.at = end[k], .to = end[!k], .x = x, .side = turn * (link->n > 0 ? 1 : -1),
                            .along = e == SIZE_MAX ? TET_NONE : p->ways->near[e], .of = 2 * i + (uint64_t)k};
  }
}

/* The links of one facet that are inside the mesh. */
typedef struct gap {
  const tet_pls_view *view;
  uint32_t facet;
  int axis, i, j;
  tet_link *link; /* n > 0; those that hang together stand together */
  tet_link *sorted;
  tet_keyed *item; /* [2 n] */
  uint32_t *part; /* [n] which links hang together, by a link in it */
  size_t n, cap, cap_sorted, cap_item, cap_part;
} gap;

static int is_before(const gap *g, uint32_t v, uint32_t w) {
  const double *x = place(g->view->mesh, v), *y = place(g->view->mesh, w);
  return x[g->i] < y[g->i] || (x[g->i] == y[g->i] && x[g->j] < y[g->j]);
}

/* Odd: x is inside the n links, in projection. */
static int parity(const gap *g, const tet_link *link, size_t n, const double *x) {
  int odd = 0;
  for (size_t k = 0; k < n; k++) {
    const double *p = place(g->view->mesh, link[k].from), *q = place(g->view->mesh, link[k].to);
    if (p[g->j] > q[g->j]) {
      const double *swap = p;
      p = q;
      q = swap;
    }
    if (!(p[g->j] <= x[g->j] && x[g->j] < q[g->j])) continue;
    odd ^= tet_orient2d_xyz(g->axis, p, q, x) > 0;
  }
  return odd;
}

static uint32_t root(uint32_t *part, uint32_t k) {
  while (part[k] != k) k = part[k] = part[part[k]];
  return k;
}

/* Sorts the links by the part that they are of: links that share vertices. */
static tet_status sort_parts(gap *g) {
  tet_ctx *ctx = g->view->ctx;
  tet_status status = tet_grow(ctx, &g->part, &g->cap_part, g->n, sizeof *g->part);
  if (status == TET_OK) status = tet_grow(ctx, &g->item, &g->cap_item, 2 * g->n, sizeof *g->item);
  if (status == TET_OK) status = tet_grow(ctx, &g->sorted, &g->cap_sorted, g->n, sizeof *g->sorted);
  if (status != TET_OK) return status;
  for (uint32_t k = 0; k < g->n; k++) {
    g->part[k] = k;
    g->item[2 * (size_t)k] = (tet_keyed){g->link[k].from, k};
    g->item[2 * (size_t)k + 1] = (tet_keyed){g->link[k].to, k};
  }
  tet_sort_keyed(g->item, 2 * g->n);
  for (size_t e = 1; e < 2 * g->n; e++) {
    if (g->item[e].key != g->item[e - 1].key) continue;
    uint32_t x = root(g->part, (uint32_t)g->item[e].value), y = root(g->part, (uint32_t)g->item[e - 1].value);
    g->part[x < y ? y : x] = x < y ? x : y;
  }
  for (uint32_t k = 0; k < g->n; k++) g->item[k] = (tet_keyed){root(g->part, k), k};
  tet_sort_keyed(g->item, g->n);
  for (size_t k = 0; k < g->n; k++) g->sorted[k] = g->link[g->item[k].value];
  memcpy(g->link, g->sorted, g->n * sizeof *g->link);
  return TET_OK;
}

/* Is what is missing at the n links of a part on the side away from the unbounded one? The lowest
 * link at the part's first vertex in the plane's order tells. */
static int is_missing_within(const gap *g, const tet_link *link, size_t n, uint32_t *ret_first) {
  uint32_t first = TET_NONE, lowest = TET_NONE;
  int out = 0;
  for (size_t l = 0; l < n; l++) {
    uint32_t end[2] = {link[l].from, link[l].to};
    for (int e = 0; e < 2; e++) {
      if (first != TET_NONE && end[e] != first && !is_before(g, end[e], first)) continue;
      int turn = -1;
      if (end[e] == first)
        turn = tet_orient2d_xyz(g->axis, place(g->view->mesh, first), place(g->view->mesh, lowest),
                                place(g->view->mesh, end[!e]));
      if (turn >= 0) continue;
      first = end[e];
      lowest = end[!e];
      out = e == 0;
    }
  }
  *ret_first = first;
  return out;
}

/* Is each part of the gap the rim of a cover that may be where it is? That is, in what would be a hole if
 * others' segments did not part it from the seed; or, where the facet is made of segments alone,
 * what these enclose. */
static tet_status are_islands(const gap *g, int *ret_so) {
  const tet_pls_view *p = g->view;
  int by_polygons = 0, so = 1;
  tet_status status = TET_OK;
  for (uint32_t f = g->facet; f < p->pls->n_facets; f++)
    by_polygons |= p->mesh->facet_same_as[f] == g->facet && p->facet[f].has_area;
  for (size_t k = 0, run; k < g->n && so; k += run) {
    const tet_link *link = g->link + k;
    uint32_t first;
    for (run = 1; k + run < g->n && g->item[k + run].key == g->item[k].key;) run++;
    so = !is_missing_within(g, link, run, &first);
    const double *x = place(p->mesh, first);
    if (so) so = !(parity(g, g->link, k, x) ^ parity(g, link + run, g->n - k - run, x));
  }
  if (so && by_polygons)
    status = tet_is_hole_beside(p->ctx, p->pls, p->mesh, g->facet, g->axis, g->link, g->n, &so);
  *ret_so = so;
  return status;
}

/* Judges the links of each facet that were hit. */
static tet_status judge_links(const tet_pls_view *p, const tet_chain *missing, const uint8_t *hit) {
  gap g = {.view = p};
  tet_status status = TET_OK;
  for (size_t i = 0, run; i < missing->n && status == TET_OK; i += run) {
    g.facet = missing->link[i].facet;
    g.axis = p->facet[g.facet].axis;
    g.i = (g.axis + 1) % 3;
    g.j = (g.axis + 2) % 3;
    g.n = 0;
    for (run = 0; i + run < missing->n && missing->link[i + run].facet == g.facet && status == TET_OK; run++) {
      tet_link l = missing->link[i + run];
      if (l.n != 1 && l.n != -1) p->bad[g.facet] = 1;
      if (!hit[i + run]) continue;
      status = tet_grow(p->ctx, &g.link, &g.cap, g.n + 1, sizeof *g.link);
      if (status == TET_OK) g.link[g.n++] = l.n > 0 ? l : (tet_link){l.facet, l.to, l.from, -l.n};
    }
    if (status != TET_OK || !g.n || p->bad[g.facet]) continue;
    int so = 0;
    if (p->pls->n_facet_holes > 0 || !p->facet[g.facet].has_area) {
      status = sort_parts(&g);
      if (status == TET_OK) status = are_islands(&g, &so);
    }
    p->bad[g.facet] |= !so;
    if (status == TET_OK) status = tet_poll(p->ctx);
  }
  tet_free(p->ctx, g.link);
  tet_free(p->ctx, g.sorted);
  tet_free(p->ctx, g.item);
  tet_free(p->ctx, g.part);
  return status;
}

tet_status tet_judge_gaps(const tet_pls_view *p, const tet_chain *missing) {
  if (!missing->n) return TET_OK;
  end_table ends = {0};
  tet_flag_at *flag = tet_alloc(p->ctx, 2 * missing->n, sizeof *flag);
  uint8_t *hit = tet_calloc(p->ctx, missing->n, 1);
  tet_status status = flag && hit ? list_ends(p, &ends) : tet_ctx_error(p->ctx)->status;
  if (status == TET_OK) {
    for (size_t i = 0; i < missing->n; i++) raise_flags(p, &ends, missing->link + i, i, flag + 2 * i);
    status = tet_hit_flags(p->ctx, p->mesh, flag, 2 * missing->n);
  }
  if (status == TET_OK) {
    for (size_t i = 0; i < 2 * missing->n; i++) hit[flag[i].of / 2] |= (uint8_t)flag[i].hit;
    status = judge_links(p, missing, hit);
  }
  tet_free(p->ctx, ends.item);
  tet_free(p->ctx, flag);
  tet_free(p->ctx, hit);
  return status;
}

/* Is c, straight on from a towards b, beyond b? */
static int is_beyond(const double *a, const double *b, const double *c) {
  for (int k = 0; k < 3; k++)
    if ((b[k] > a[k] && c[k] > b[k]) || (b[k] < a[k] && c[k] < b[k])) return 1;
  return 0;
}

/* Follows segments from a towards b as far as they go; one that goes on beyond b leaves b out. */
static uint32_t follow(const tet_pls_view *p, const end_table *ends, uint32_t a, uint32_t b) {
  while (a != b) {
    size_t e = find_end(p, ends, a, b);
    if (e == SIZE_MAX) break;
    uint32_t next = p->ways->end[e ^ 1];
    if (is_beyond(place(p->mesh, a), place(p->mesh, b), place(p->mesh, next))) break;
    a = next;
  }
  return a;
}

/* Flags for the stretch of segment ab that nothing covers, if there is one. */
static tet_status add_stretch(const tet_pls_view *p, const end_table *ends, uint32_t a, uint32_t b, uint64_t number,
                              tet_flag_at **flag, size_t *n, size_t *cap) {
  uint32_t from = follow(p, ends, a, b);
  if (from == b) return TET_OK;
  uint32_t to = follow(p, ends, b, a);
  tet_status status = tet_grow(p->ctx, flag, cap, *n + 2, sizeof **flag);
  if (status != TET_OK) return status;
  (*flag)[(*n)++] = (tet_flag_at){.at = from, .to = b, .x = TET_NONE, .along = TET_NONE, .of = number};
  (*flag)[(*n)++] = (tet_flag_at){.at = to, .to = a, .x = TET_NONE, .along = TET_NONE, .of = number};
  return TET_OK;
}

tet_status tet_judge_segments(const tet_pls_view *p, uint64_t *ret_count) {
  const tet_pls *pls = p->pls;
  const uint32_t *same = p->mesh->point_same_as;
  end_table ends = {0};
  tet_flag_at *flag = NULL;
  size_t n = 0, cap = 0;
  uint64_t count = 0, last = UINT64_MAX;
  tet_status status = list_ends(p, &ends);
  for (uint64_t i = 0; i < (uint64_t)pls->n_segments + pls->n_polygons && status == TET_OK; i++) {
    const uint32_t *v;
    if (i < pls->n_segments) {
      v = pls->segments + 2 * i;
    } else {
      uint32_t polygon = (uint32_t)(i - pls->n_segments), start = pls->polygon_start[polygon];
      if (pls->polygon_start[polygon + 1] - start != 2) continue;
      v = pls->polygon_vertices + start;
    }
    if (same[v[0]] != same[v[1]]) status = add_stretch(p, &ends, same[v[0]], same[v[1]], i, &flag, &n, &cap);
    if ((i & 1023) == 0 && status == TET_OK) status = tet_poll(p->ctx);
  }
  if (status == TET_OK) status = tet_hit_flags(p->ctx, p->mesh, flag, n);
  if (status == TET_OK) { /* both flags of a segment may be hit, and are apart: by number again */
    tet_keyed *hit = tet_alloc(p->ctx, n, sizeof *hit);
    size_t m = 0;
    if (!hit) status = tet_ctx_error(p->ctx)->status;
    for (size_t k = 0; k < n && hit; k++)
      if (flag[k].hit) hit[m++] = (tet_keyed){flag[k].of, 0};
    if (hit) tet_sort_keyed(hit, m);
    for (size_t k = 0; k < m; k++) {
      count += hit[k].key != last;
      last = hit[k].key;
    }
    tet_free(p->ctx, hit);
  }
  tet_free(p->ctx, ends.item);
  tet_free(p->ctx, flag);
  if (status == TET_OK) *ret_count = count;
  return status;
}
