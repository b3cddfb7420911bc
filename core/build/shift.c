// SPDX-License-Identifier: Apache-2.0
/* shift.c: after rounding, Steiner points moved along their segments.
 *
 * A point of a segment is as good a unit in the last place farther on. What was
 * cospherical or coplanar before rounding is mostly mended so, and no tetrahedron is
 * made or lost; long moves are for facets close to each other. */
#include "build/repair_work.h"

#include <string.h>

/* The neighbours of Steiner point v on its segment, as t. */
static void gap_around(const repair *r, uint32_t v, double *lo, double *hi) {
  const tet_surface *s = r->surface;
  const tet_segment_point *p = &r->exact.implicit[v - r->exact.first_implicit];
  *lo = 0;
  *hi = 1;
  for (size_t e = 0; e < s->n_subsegs; e++)
    for (int side = 0; side < 2; side++) {
      uint32_t other = s->subseg[2 * e + (size_t)!side];
      if (s->subseg[2 * e + (size_t)side] != v || other < r->exact.first_implicit) continue;
      double t = r->exact.implicit[other - r->exact.first_implicit].t;
      if (t < p->t && t > *lo) *lo = t;
      if (t > p->t && t < *hi) *hi = t;
    }
}

/* The tetrahedra of v. */
static tet_status find_star(repair *r, uint32_t v) {
  const tet_pieces *p = r->p;
  tet_status status = TET_OK;
  r->n_star = 0;
  for (uint32_t t = 0; t < p->n_tets && status == TET_OK; t++) {
    const uint32_t *c = p->tets + 4 * (size_t)t;
    if (!repair_is_dead(r, t) && (c[0] == v || c[1] == v || c[2] == v || c[3] == v))
      status = tet_push(r->ctx, &r->star, &r->n_star, &r->cap_star, t);
  }
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
  double lo, hi, from = s->t;
  tet_status status = find_star(r, v);
  if (status != TET_OK) return status;
  *ret_done = 0;
  gap_around(r, v, &lo, &hi);
  uint32_t before = count_bad(r, v, UINT32_MAX);
  double gap = hi - from < from - lo ? hi - from : from - lo;
  for (double share = 0x1p-52; share < 0.5; share *= 2)
    for (int side = -1; side <= 1; side += 2) {
      if (!put(r, v, from + side * share * gap) || count_bad(r, v, before) == before) continue;
      *ret_done = 1;
      r->moves++;
      return TET_OK;
    }
  put(r, v, from);
  return TET_OK;
}
