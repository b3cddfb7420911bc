// SPDX-License-Identifier: Apache-2.0
/* split_segment.c: rule R1, and the insertion that all three rules end with.
 *
 * A subsegment is halved; one that ends at a vertex where segments meet below 60
 * degrees is cut on a shell about that vertex, its radius a power of two, so that
 * neighbours are cut alike and do not encroach upon each other in turn. */
#include "refine/refiner.h"

#include <float.h>
#include <math.h>

/* Retriangulates the grown cavity; *ret_ok = 0, nothing changed, if it cannot be
 * made visible without a loss. */
tet_status refine_insert(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  tet_status status = refine_cavity_trim(r, ret_ok);
  if (status || !*ret_ok) return status;
  int reshaped = c->reshaped;
  status = refine_fill(r);
  if (!status && reshaped) {
    for (uint32_t k = 0; k < c->faces_new.n && !status; k++)
      for (uint32_t i = 0; i < 4 && !status; i++) status = refine_push(r, &r->suspects, 4 * c->faces_new.at[k] + i);
    if (!status) status = refine_repair(r);
  }
  return status ? status : refine_after_insertion(r);
}

/* Where subsegment ab is cut, as a fraction of its length from a. */
static double fraction(const refiner *r, uint32_t e, double length) {
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  if (!(r->segment_sharp[r->seg_of[e]] & 1)) return 0.5;
  int at_a = a < r->n_first && r->acute_end[a], at_b = b < r->n_first && r->acute_end[b];
  if (at_a == at_b) return 0.5;
  int power;
  frexp(length * (2.0 / 3.0), &power);
  double cut = ldexp(1.0, power - 1) / length; /* in (1/3, 2/3] */
  return at_a ? cut : 1 - cut;
}

tet_status refine_split_seg(refiner *r, uint32_t e, refine_cause cause, refine_outcome *ret) {
  const uint32_t ends[2] = {r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1]};
  const double *a = refine_x(r, ends[0]), *b = refine_x(r, ends[1]);
  double x[3], length2 = 0, most = 0;
  for (int i = 0; i < 3; i++) {
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
    most = fmax(most, fmax(fabs(a[i]), fabs(b[i])));
  }
  *ret = OUTCOME_REJECTED;
  double length = sqrt(length2), cut = fraction(r, e, length);
  if (length < 64 * DBL_EPSILON * most) {
    r->result.rejected.too_short++;
    return TET_OK;
  }
  for (int i = 0; i < 3; i++) x[i] = cut == 0.5 ? 0.5 * a[i] + 0.5 * b[i] : a[i] + cut * (b[i] - a[i]);
  tet_status status = refine_add_point(r, x, TET_ORIGIN_SEGMENT, r->seg_of[e]);
  if (status) return status;
  int ok = 0;
  if (!refine_accepts(r, r->points.n - 1, ends, 2, cause)) {
    r->result.rejected.protected_ball++;
  } else {
    status = refine_cavity_of_seg(r, r->points.n - 1, e);
    if (!status) status = refine_insert(r, &ok);
    if (!ok) r->result.rejected.lost_subface++;
  }
  if (status) return status;
  if (ok) {
    r->result.segment_points++;
    *ret = OUTCOME_INSERTED;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}
