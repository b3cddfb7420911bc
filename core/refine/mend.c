// SPDX-License-Identifier: Apache-2.0
/* mend.c: what is over a bound when no rule applies any more. Its circumcentre asks for a split that is
 * protected; but a point nearer its shortest edge may encroach upon nothing, and leave fewer over the bound than
 * there were. Such a point is inserted, so that their number falls with each one. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* 1 for each bound that a tetrahedron of that shape is over. */
typedef struct faults {
  uint32_t over, slivers;
} faults;

static void count(const refiner *r, const uint32_t v[4], uint32_t region, faults *sum) {
  refine_shape shape;
  refine_measure_corners(r, v, &shape);
  sum->over += refine_over_ratio(r, &shape) || shape.volume6 > 6 * r->max_volume[region];
  sum->slivers += r->sliver_sine2 > 0 && 1 - refine_sharpest_of(r, v) < r->sliver_sine2;
}

/* What the trimmed cavity's point would mend, or 0: nothing, or something else would be worse. */
static uint32_t gain(const refiner *r) {
  const tet_complex *m = &r->mesh;
  faults before = {0, 0}, after = {0, 0};
  for (size_t k = 0; k < m->n_cavity; k++)
    count(r, m->v + 4 * (size_t)m->cavity[k], r->tet_region[m->cavity[k]], &before);
  for (size_t k = 0; k < m->n_border; k++) {
    count(r, m->border[k].v, r->tet_region[m->border[k].inner >> 2], &after);
    if (after.over > before.over || after.over + after.slivers >= before.over + before.slivers) return 0;
  }
  return before.over + before.slivers - after.over - after.slivers;
}

/* Grows the cavity of x from t on. *ret_gain = 0: x is not to be inserted, and is no vertex any more. */
static tet_status look(refiner *r, uint32_t t, const double x[3], uint32_t *ret_gain) {
  int ok = 0;
  *ret_gain = 0;
  tet_status status = refine_add_point(r, x, TET_ORIGIN_VOLUME, TET_NONE);
  if (status) return status;
  if (tet_complex_conflict(&r->mesh, t, r->points.n - 1)) {
    status = refine_grow_or_hit(r, r->points.n - 1, t, 0);
    if (!status && !r->hit_segs.n && !r->hit_subs.n) status = refine_cavity_trim(r, &ok);
    if (!status && ok && !r->cavity.reshaped) *ret_gain = gain(r);
  }
  if (status || *ret_gain) return status;
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}

/* The k-th place near the shortest edge of t; 0: there is none. */
static int place(const refiner *r, uint32_t t, uint32_t k, double x[3]) {
  static const double far[] = {1, 1.5, 2, 3};
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  int shortest = refine_shortest_edge(r, t);
  const uint8_t *e = refine_edge[shortest], *f = refine_edge[5 - shortest];
  const double *a = refine_x(r, v[e[0]]), *b = refine_x(r, v[e[1]]), *p = refine_x(r, v[f[0]]), *q = refine_x(r, v[f[1]]);
  double to[3], d[3];
  if (k & 1) {
    for (int i = 0; i < 3; i++) to[i] = 0.5 * (p[i] + q[i]);
  } else {
    refine_shape shape;
    refine_measure(r, t, &shape);
    refine_circumcentre(r, t, &shape, to);
  }
  for (int i = 0; i < 3; i++) x[i] = 0.5 * (a[i] + b[i]);
  tet_minus(to, x, d);
  double share = far[k / 2] * sqrt(tet_distance2(a, b) / tet_square(d));
  if (!(share > 0 && share < 1)) return 0;
  for (int i = 0; i < 3; i++) x[i] += share * d[i];
  return 1;
}

/* Inserts near t the point that mends most, if any does. */
static tet_status mend(refiner *r, uint32_t t) {
  enum { PLACES = 8 };
  double x[3], best[3];
  uint32_t most = 0, now;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < PLACES && !status; k++) {
    if (!place(r, t, k, x)) continue;
    status = look(r, t, x, &now);
    if (status || !now) continue;
    refine_cavity_clear(r);
    refine_drop_point(r);
    if (now <= most) continue;
    most = now;
    memcpy(best, x, sizeof best);
  }
  if (status || !most) return status;
  int ok = 0;
  status = look(r, t, best, &now);
  if (!status && now) status = refine_insert(r, &ok);
  if (status) return status;
  if (ok) {
    r->result.volume_points++;
    r->result.mended += now;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}

/* Mends what can be. */
tet_status refine_mend(refiner *r) {
  refine_shape shape;
  uint32_t t;
  int sliver;
  tet_status status = TET_OK;
  for (t = 0; t < r->mesh.n_slots && !status; t++) {
    if (refine_alive(r, t)) status = refine_queue_tet(r, t);
    if (!status && (t & 4095) == 0) status = tet_poll(r->ctx);
  }
  while (!status && refine_next_tet(r, &t, &shape, &sliver)) {
    status = mend(r, t);
    if (!status) status = tet_poll(r->ctx);
  }
  return status;
}
