// SPDX-License-Identifier: Apache-2.0
/* trace.c: which sharp segment is to blame for a tetrahedron that is over a bound (4.2.2). Its
 * candidates are tried once more, and nothing is inserted: the vertex whose protecting ball, or
 * gap, rejects one of them leads to a sharp subsegment, if it is on one. How far off that is
 * follows Theorem 4.2.3. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>

/* For each vertex its subsegment of the sharpest angle, or TET_NONE. */
static tet_status sharp_subsegments(refiner *r, uint32_t **ret_at) {
  uint32_t *at = *ret_at = tet_alloc(r->ctx, r->points.n, sizeof *at);
  if (!at) return TET_E_MEMORY;
  memset(at, 0xff, (size_t)r->points.n * sizeof *at);
  for (uint32_t e = 0; e < r->n_segs; e++) {
    if (!r->segment_sharp[r->seg_of[e]]) continue;
    for (int i = 0; i < 2; i++) {
      uint32_t *mine = &at[r->seg_v[2 * (size_t)e + i]];
      if (*mine == TET_NONE || r->segment_sine[r->seg_of[e]] < r->segment_sine[r->seg_of[*mine]]) *mine = e;
    }
  }
  return TET_OK;
}

/* Notes that vertex v rejects the candidate; one on a sharp segment counts first. */
void refine_note_blame(refiner *r, uint32_t v) {
  if (r->tracing && r->blamed == TET_NONE && r->sharp_at[v] != TET_NONE) r->blamed = r->sharp_at[v];
}

/* Counts how far subsegment e is from tetrahedron t. */
static void measure(refiner *r, uint32_t t, uint32_t e) {
  tet_trace *ret = &r->result.trace;
  refine_shape shape;
  double c[3], corner2 = INFINITY, size = 0;
  const double *a = refine_x(r, r->seg_v[2 * (size_t)e]), *b = refine_x(r, r->seg_v[2 * (size_t)e + 1]);
  refine_measure(r, t, &shape);
  refine_circumcentre(r, t, &shape, c);
  int within = 0;
  for (int i = 0; i < 2; i++) {
    uint32_t p = r->seg_v[2 * (size_t)e + i];
    double reach = r->o.alpha2 * r->size[p];
    within |= tet_distance2(refine_x(r, p), c) <= 2 * reach * reach;
    size = fmax(size, reach);
  }
  ret->within += (uint64_t)within;
  for (size_t i = 4 * (size_t)t; i < 4 * (size_t)t + 4; i++)
    corner2 = fmin(corner2, refine_edge_distance2(a, b, refine_x(r, r->mesh.v[i])));
  double farthest = sqrt(corner2) * r->segment_sine[r->seg_of[e]] / size;
  if (farthest > ret->farthest) ret->farthest = farthest;
}

/* segment[k]: of tet[k] the subsegment to blame, where it is found; else it is left as it is. */
tet_status refine_trace(refiner *r, uint32_t n, const uint32_t *tet, uint32_t *segment) {
  tet_rejections before = r->result.rejected;
  tet_status status = sharp_subsegments(r, &r->sharp_at);
  r->tracing = 1;
  for (uint32_t k = 0; k < n && !status; k++) {
    refine_shape shape;
    refine_outcome outcome;
    refine_measure(r, tet[k], &shape);
    r->blamed = TET_NONE;
    status = refine_split_tet(r, tet[k], &shape, 0, &outcome);
    if (r->blamed != TET_NONE) {
      segment[k] = r->blamed;
      r->result.trace.traced++;
    }
    if (segment[k] != TET_NONE) measure(r, tet[k], segment[k]);
    if (!status && (k & 63) == 0) status = tet_poll(r->ctx);
  }
  r->tracing = 0;
  r->result.rejected = before;
  return status;
}
