// SPDX-License-Identifier: Apache-2.0
/* split_segment.c: rule R1, and the insertion that all three rules end with. Where a subsegment
 * is cut says cut.c. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <float.h>
#include <math.h>

/* Retriangulates the grown cavity; *ret_ok = 0, nothing changed, if it cannot be
 * made visible without a loss, or, where that counts, not constrained Delaunay. */
tet_status refine_insert(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  *ret_ok = 0;
  if (r->tracing) return TET_OK;
  tet_status status = refine_cavity_trim(r, ret_ok);
  if (!status && !*ret_ok && (c->segment != TET_NONE || c->sub != TET_NONE)) {
    uint32_t p = c->p, segment = c->segment, sub = c->sub;
    refine_cavity_clear(r);
    status = segment != TET_NONE ? refine_cavity_of_seg(r, p, segment, EXTENT_LEAST)
                                 : refine_cavity_of_sub(r, p, sub, EXTENT_LEAST);
    if (!status) status = refine_cavity_trim(r, ret_ok);
  }
  if (status || !*ret_ok) return status;
  if (r->strict && !r->forcing && !refine_cavity_is_delaunay(r)) {
    *ret_ok = 0;
    return TET_OK;
  }
  r->exact = r->exact && refine_cavity_is_exact(r);
  status = refine_fill(r);
  if (!status) status = refine_look_at_made(r);
  for (uint32_t k = 0; k < 4 * c->n_made && c->reshaped && !status; k++) {
    uint32_t h = 4 * r->mesh.cavity[k / 4] + k % 4;
    if (r->mesh.v[h] == c->p || r->mesh.adj[h] > h) status = refine_push(r, &r->suspects, h);
  }
  return status ? status : refine_repair(r);
}

/* Counts the last point against the budget of thin facets. */
void refine_spend(refiner *r) {
  if (r->thin_points && refine_is_thin(r, r->points.n - 1)) r->thin_points--;
}

/* 1: some subface at subsegment e is too narrow for its points, of coordinates up to `most`. */
static int is_in_needle(const refiner *r, uint32_t e, double most) {
  uint32_t first = r->seg_sub[e], h = first;
  if (h == TET_NONE) return 0;
  do {
    if (refine_is_narrow(r, h / 3, most)) return 1;
    h = r->ring[h];
  } while (h != first);
  return 0;
}

tet_status refine_split_seg(refiner *r, uint32_t e, uint32_t by, refine_cause cause, refine_outcome *ret) {
  const uint32_t ends[2] = {r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1]};
  const double *a = refine_x(r, ends[0]), *b = refine_x(r, ends[1]);
  double x[3], length2 = 0, most = 0;
  for (int i = 0; i < 3; i++) {
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
    most = fmax(most, fmax(fabs(a[i]), fabs(b[i])));
  }
  *ret = OUTCOME_REJECTED;
  double length = sqrt(length2);
  if (length < 64 * DBL_EPSILON * most || is_in_needle(r, e, most)) {
    r->result.rejected.too_short++;
    return TET_OK;
  }
  double cut = refine_cut(r, e, by, length);
  int exact = cut == 0.5;
  for (int i = 0; i < 3; i++) {
    x[i] = 0.5 * (a[i] + b[i]);
    exact = exact && x[i] - a[i] == b[i] - x[i];
  }
  if (!exact && cut == 0.5) cut *= refine_off_tie(r, 1);
  for (int i = 0; i < 3 && !exact; i++) x[i] = a[i] + cut * (b[i] - a[i]);
  tet_status status = refine_add_point(r, x, TET_ORIGIN_SEGMENT, r->seg_of[e]);
  if (status) return status;
  int ok = 0;
  if (!refine_accepts(r, r->points.n - 1, ends, 2, cause == CAUSE_CENTRE ? r->o.alpha2 : 0, cause)) {
    r->result.rejected.protected_ball++;
  } else {
    status = refine_cavity_of_seg(r, r->points.n - 1, e, refine_gives_up(r, cause) ? EXTENT_NEAR : EXTENT_WHOLE);
    int is_part = r->cavity.is_part, crowded = !status && !is_part && cause == CAUSE_CENTRE && refine_crowded(r, ends, 2);
    if (!status && !is_part && !crowded) status = refine_insert(r, &ok);
    if (is_part) r->result.rejected.given_up++;
    else if (crowded) r->result.rejected.protected_ball++;
    else if (!ok) r->result.rejected.lost_subface++;
  }
  if (status) return status;
  if (ok) {
    r->result.segment_points++;
    refine_note_low(r, e);
    refine_note_low(r, r->n_segs - 1); /* the other half */
    refine_spend(r);
    *ret = OUTCOME_INSERTED;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}
