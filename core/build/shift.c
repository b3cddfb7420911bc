// SPDX-License-Identifier: Apache-2.0
/* shift.c: after rounding, Steiner points moved along their segments, and break points on facets along
 * their lines.
 *
 * A point of a segment is as good a unit in the last place farther on. What was
 * cospherical or coplanar before rounding is mostly mended so, and no tetrahedron is
 * made or lost; long moves are for facets close to each other, and for points so close to one
 * neighbour that rounding bends the line there: to the other side there is room. */
#include "build/repair_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

/* How far each break point on a facet may go along its line: on its facet, to the nearest vertex. */
static void find_reach(repair *r) {
  const tet_surface *s = r->surface;
  uint32_t from = r->exact.first_implicit;
  for (uint32_t i = 0; i < r->p->n_points - from; i++) r->reach[i] = INFINITY;
  for (size_t h = 0; h < 3 * (size_t)s->n_tris; h++) {
    uint32_t end[2] = {s->tri[h], s->tri[h - h % 3 + (h + 1) % 3]};
    double d = sqrt(tet_distance2(repair_at(r, end[0]), repair_at(r, end[1])));
    for (int k = 0; k < 2; k++)
      if (end[k] >= from) r->reach[end[k] - from] = fmin(r->reach[end[k] - from], d);
  }
}

/* The neighbours of every Steiner point on its segment, and an entry for each of its tetrahedra. */
static tet_status begin(repair *r) {
  const tet_surface *s = r->surface;
  uint32_t from = r->exact.first_implicit, n = r->p->n_points - from;
  r->beside = tet_alloc(r->ctx, 2 * (size_t)n, sizeof *r->beside);
  r->reach = tet_alloc(r->ctx, n, sizeof *r->reach);
  r->first = tet_alloc(r->ctx, n, sizeof *r->first);
  if (!r->beside || !r->reach || !r->first) return tet_ctx_error(r->ctx)->status;
  memset(r->first, 0xff, n * sizeof *r->first);
  memset(r->beside, 0xff, 2 * (size_t)n * sizeof *r->beside);
  find_reach(r);
  for (size_t e = 0; e < s->n_subsegs; e++) {
    uint32_t a = s->subseg[2 * e], b = s->subseg[2 * e + 1]; /* directed like the segment */
    if (a >= from) r->beside[2 * (size_t)(a - from) + 1] = b;
    if (b >= from) r->beside[2 * (size_t)(b - from)] = a;
  }
  tet_status status = TET_OK;
  for (uint32_t t = 0; t < r->p->n_tets && status == TET_OK; t++)
    if (!repair_is_dead(r, t)) status = tet_shift_note(r, t);
  return status;
}

tet_status tet_shift_note(repair *r, uint32_t t) {
  tet_status status = TET_OK;
  for (int i = 0; i < 4 && r->first && status == TET_OK; i++) {
    uint32_t v = r->p->tets[4 * (size_t)t + (size_t)i];
    if (v < r->exact.first_implicit) continue;
    uint32_t *first = &r->first[v - r->exact.first_implicit];
    status = tet_grow(r->ctx, &r->entry, &r->cap_entries, r->n_entries + 1, sizeof *r->entry);
    if (status != TET_OK) break;
    r->entry[r->n_entries][0] = t;
    r->entry[r->n_entries][1] = *first;
    *first = (uint32_t)r->n_entries++;
  }
  return status;
}

/* The place of the vertex before (0) or after (1) Steiner point v on its segment; of a break point on a
 * facet, as far as it may go on its line. */
static double place_beside(const repair *r, uint32_t v, int after) {
  uint32_t i = v - r->exact.first_implicit, w = r->beside[2 * (size_t)i + (size_t)after];
  if (w == TET_NONE) {
    const tet_segment_point *p = &r->exact.implicit[i];
    double reach = r->reach[i] / sqrt(tet_distance2(repair_at(r, p->a), repair_at(r, p->b)));
    return after ? fmin(p->t + reach, 1) : fmax(p->t - reach, 0);
  }
  return w < r->exact.first_implicit ? after : r->exact.implicit[w - r->exact.first_implicit].t;
}

static int compare(const void *pa, const void *pb) {
  uint32_t a = *(const uint32_t *)pa, b = *(const uint32_t *)pb;
  return (a > b) - (a < b);
}

/* The tetrahedra of v, each once. */
static tet_status find_star(repair *r, uint32_t v) {
  tet_status status = TET_OK;
  size_t n = 0;
  r->n_star = 0;
  for (uint32_t e = r->first[v - r->exact.first_implicit]; e != TET_NONE && status == TET_OK; e = r->entry[e][1]) {
    uint32_t t = r->entry[e][0];
    const uint32_t *c = r->p->tets + 4 * (size_t)t;
    if (!repair_is_dead(r, t) && (c[0] == v || c[1] == v || c[2] == v || c[3] == v))
      status = tet_push(r->ctx, &r->star, &r->n_star, &r->cap_star, t);
  }
  if (r->n_star) qsort(r->star, r->n_star, sizeof *r->star, compare);
  for (size_t k = 0; k < r->n_star; k++)
    if (!k || r->star[k] != r->star[k - 1]) r->star[n++] = r->star[k];
  r->n_star = n;
  return status;
}

/* How many faces of the star of v are bad; `most` where there are no fewer. A tetrahedron
 * that is not positive counts as five more. */
static uint32_t count_bad(const repair *r, uint32_t v, uint32_t most) {
  uint32_t n = 0;
  for (size_t k = 0; k < r->n_star && n < most; k++) {
    uint32_t h = 4 * r->star[k];
    int ok = tet_repair_is_positive(r, h >> 2);
    n += ok ? 0 : 5;
    for (uint32_t i = 0; i < 4; i++) {
      int twice = r->p->tets[h + i] != v && r->p->adj[h + i] != TET_NONE && r->p->adj[h + i] < h; /* seen before */
      if (!twice) n += (uint32_t)tet_repair_is_bad_face(r, h + i, ok);
    }
  }
  return n < most ? n : most;
}

/* Puts v at `t` of its segment; 0 where that is where it was, as rounded. */
static int put(repair *r, uint32_t v, double t) {
  tet_segment_point *s = &r->exact.implicit[v - r->exact.first_implicit];
  double *x = r->p->points + 3 * (size_t)v, old[3] = {x[0], x[1], x[2]};
  s->t = t;
  tet_segment_point_round(&r->exact, s, x);
  return memcmp(old, x, sizeof old) != 0;
}

tet_status tet_shift(repair *r, uint32_t v, int *ret_done) {
  const tet_segment_point *s = &r->exact.implicit[v - r->exact.first_implicit];
  tet_status status = r->first ? TET_OK : begin(r);
  if (status == TET_OK) status = find_star(r, v);
  if (status != TET_OK) return status;
  *ret_done = 0;
  double lo = place_beside(r, v, 0), hi = place_beside(r, v, 1), from = s->t;
  uint32_t before = count_bad(r, v, UINT32_MAX);
  for (double share = 0x1p-52; share < 1; share *= 2)
    for (int side = -1; side <= 1; side += 2) {
      double gap = side < 0 ? from - lo : hi - from;
      if (!put(r, v, from + side * share * gap) || count_bad(r, v, before) == before) continue;
      *ret_done = 1;
      r->moves++;
      return TET_OK;
    }
  put(r, v, from);
  return TET_OK;
}
