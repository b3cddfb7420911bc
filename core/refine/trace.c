// SPDX-License-Identifier: Apache-2.0
/* trace.c: which sharp segment is to blame for a tetrahedron that is over a bound (4.2.2). Its
 * candidates are tried once more, and nothing is inserted: the vertex whose protecting ball, or
 * gap, rejects one of them leads to a sharp subsegment, if it is on one. How far off that is
 * follows Theorem 4.2.3. */
#include "refine/refiner.h"

#include "base/triangle.h"
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

/* How far tetrahedron t is from subsegment e, in radii of its protecting balls over its segment's sine. */
static double distance(const refiner *r, uint32_t t, uint32_t e) {
  double corner2 = INFINITY, size = 0;
  const double *a = refine_x(r, r->seg_v[2 * (size_t)e]), *b = refine_x(r, r->seg_v[2 * (size_t)e + 1]);
  for (int i = 0; i < 2; i++) size = fmax(size, r->o.alpha2 * r->size[r->seg_v[2 * (size_t)e + i]]);
  for (size_t i = 4 * (size_t)t; i < 4 * (size_t)t + 4; i++)
    corner2 = fmin(corner2, tet_edge_distance2(a, b, refine_x(r, r->mesh.v[i])));
  return corner2 > 0 ? sqrt(corner2) * r->segment_sine[r->seg_of[e]] / size : 0;
}

/* 1 if the circumcentre of tetrahedron t is as near to an end of subsegment e as Theorem 4.2.3 says. */
static int is_within(const refiner *r, uint32_t t, uint32_t e) {
  refine_shape shape;
  double c[3];
  refine_measure(r, t, &shape);
  refine_circumcentre(r, t, &shape, c);
  for (int i = 0; i < 2; i++) {
    uint32_t p = r->seg_v[2 * (size_t)e + i];
    double reach = r->o.alpha2 * r->size[p];
    if (tet_distance2(refine_x(r, p), c) <= 2 * reach * reach) return 1;
  }
  return 0;
}

/* The subsegment to list tetrahedron t with: the one to blame, if that is within reach, else the nearest
 * of that, `nearest` and those at its corners; and if none of these is within reach, of all. */
static uint32_t choose(const refiner *r, uint32_t t, uint32_t nearest, double *ret_far) {
  uint32_t best = r->blamed, other[5] = {nearest};
  double least = best == TET_NONE ? INFINITY : distance(r, t, best);
  for (int i = 0; i < 4; i++) other[1 + i] = r->sharp_at[r->mesh.v[4 * (size_t)t + i]];
  for (int i = 0; i < 5 && least > TET_TRACE_REACH; i++) {
    double far = other[i] == TET_NONE ? INFINITY : distance(r, t, other[i]);
    if (far >= least) continue;
    least = far;
    best = other[i];
  }
  for (uint32_t e = 0, all = least > TET_TRACE_REACH ? r->n_segs : 0; e < all; e++) {
    double far = r->segment_sharp[r->seg_of[e]] ? distance(r, t, e) : INFINITY;
    if (far >= least) continue;
    least = far;
    best = e;
  }
  *ret_far = least;
  return best;
}

/* Counts tetrahedron t, listed with subsegment e, which is that far from it. */
static void count(refiner *r, uint32_t t, uint32_t e, double far, int is_sliver) {
  tet_trace *ret = &r->result.trace;
  *(is_sliver ? &ret->slivers : &ret->traced) += far <= TET_TRACE_REACH;
  if (is_sliver) return;
  ret->followed += e == r->blamed;
  ret->within += (uint64_t)is_within(r, t, e);
  if (far > ret->farthest) ret->farthest = far;
}

/* segment[k]: of tet[k] the nearest sharp subsegment, then the one to blame; of none it is left as it is. */
tet_status refine_trace(refiner *r, uint32_t n, const uint32_t *tet, int is_sliver, uint32_t *segment) {
  tet_rejections before = r->result.rejected;
  tet_status status = r->sharp_at ? TET_OK : sharp_subsegments(r, &r->sharp_at);
  r->tracing = 1;
  for (uint32_t k = 0; k < n && !status; k++) {
    refine_shape shape;
    refine_outcome outcome;
    refine_measure(r, tet[k], &shape);
    r->blamed = TET_NONE;
    status = refine_split_tet(r, tet[k], &shape, 0, &outcome);
    double far;
    uint32_t e = choose(r, tet[k], segment[k], &far);
    if (e != TET_NONE) count(r, tet[k], segment[k] = e, far, is_sliver);
    if (!status && (k & 63) == 0) status = tet_poll(r->ctx);
  }
  r->tracing = 0;
  r->result.rejected = before;
  return status;
}
