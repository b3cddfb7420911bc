// SPDX-License-Identifier: Apache-2.0
/* mend.c: what is over a bound when no rule applies any more. Steiner points that do no good go first: rules
 * 1 to 3 insert many whose cause is gone at the end, or that leave more over the bound than they mend, as where short
 * edges grow from needles. Of what is still over a bound the circumcentre asks for a split that is protected; but a point
 * nearer its shortest edge may encroach upon nothing, and leave fewer over the bound than there were. With
 * each change the number of these falls, or that of tetrahedra does: so this ends. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Counts tetrahedron v where it is over a bound. */
void refine_count_faults(const refiner *r, const uint32_t v[4], uint32_t region, refine_faults *sum) {
  refine_shape shape;
  refine_measure_corners(r, v, &shape);
  int over = refine_over_ratio(r, &shape);
  sum->over += over || refine_over_volume(r, region, shape.volume6);
  if (over) {
    double ratio = shape.volume6 > 0 ? refine_radius_edge(&shape) : INFINITY;
    if (ratio * ratio > sum->worst2) sum->worst2 = ratio * ratio;
  }
  sum->slivers += refine_is_sliver(r, v);
}

/* What the trimmed cavity's point would mend, or 0: nothing, or something else would be worse. */
static uint32_t gain(const refiner *r) {
  const tet_complex *m = &r->mesh;
  refine_faults before = {0, 0, 0}, after = {0, 0, 0};
  for (size_t k = 0; k < m->n_cavity; k++)
    refine_count_faults(r, m->v + 4 * (size_t)m->cavity[k], r->tet_region[m->cavity[k]], &before);
  for (size_t k = 0; k < m->n_border; k++) {
    refine_count_faults(r, m->border[k].v, r->tet_region[m->border[k].inner >> 2], &after);
    if (after.over > before.over || after.worst2 > before.worst2) return 0;
    if (after.over + after.slivers >= before.over + before.slivers) return 0;
  }
  return before.over + before.slivers - after.over - after.slivers;
}

/* Grows the cavity of x from t on. *ret_gain = 0: x is not to be inserted, and is no vertex any more. */
static tet_status look(refiner *r, uint32_t t, const double x[3], uint32_t *ret_gain) {
  int ok = 0;
  *ret_gain = 0;
  if (!tet_is_place(x)) return TET_OK;
  tet_status status = refine_add_point(r, x, TET_ORIGIN_VOLUME, TET_NONE);
  if (status) return status;
  if (tet_complex_conflict(&r->mesh, t, r->points.n - 1)) {
    status = refine_grow_or_hit(r, r->points.n - 1, t, WANT_CAVITY);
    if (!status && !r->hit_segs.n && !r->hit_subs.n && !r->cavity.is_part) status = refine_cavity_trim(r, &ok);
    if (!status && ok && !r->cavity.reshaped) *ret_gain = gain(r);
  }
  if (status || *ret_gain) return status;
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}

/* The k-th place near the shortest edge of t; 0: there is none. */
static int place(const refiner *r, uint32_t t, uint32_t k, double x[3]) {
  static const double far[] = {0.8, 1, 1.3, 1.7, 2.3, 3};
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  int shortest = refine_shortest_edge(r, t);
  const uint8_t *e = refine_edge[shortest], *f = refine_edge[5 - shortest];
  const double *a = refine_x(r, v[e[0]]), *b = refine_x(r, v[e[1]]), *p = refine_x(r, v[f[0]]), *q = refine_x(r, v[f[1]]);
  double to[3], d[3];
  if (k % 4 == 1) {
    for (int i = 0; i < 3; i++) to[i] = 0.5 * (p[i] + q[i]);
  } else if (k % 4 > 1) {
    memcpy(to, k % 4 == 2 ? p : q, sizeof to);
  } else {
    refine_shape shape;
    refine_measure(r, t, &shape);
    refine_circumcentre(r, t, &shape, to);
  }
  for (int i = 0; i < 3; i++) x[i] = 0.5 * (a[i] + b[i]);
  tet_minus(to, x, d);
  double share = far[k / 4] * sqrt(tet_distance2(a, b) / tet_square(d));
  if (!(share > 0 && share < 1)) return 0;
  for (int i = 0; i < 3; i++) x[i] += share * d[i];
  return 1;
}

/* Inserts near t the point that mends most, if any does. */
static tet_status mend_by_point(refiner *r, uint32_t t) {
  enum { PLACES = 24 };
  double x[3], best[3] = {0, 0, 0};
  uint32_t most = 0, now = 0;
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
  if (status || ok) {
    r->result.volume_points += (uint64_t)ok;
    /* reshaped by nothing, it is as it was filled */
    for (uint32_t k = 0; ok && k < r->cavity.n_made; k++) refine_note_change(r, r->mesh.cavity[k]);
    return status;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}

/* Removes a corner of t, or inserts a point near it. */
static tet_status mend(refiner *r, uint32_t t) {
  static const uint64_t price = 4; /* of a tetrahedron searched, in others: here it is measured as well */
  for (int i = 0; i < 4; i++) {
    uint32_t p = r->mesh.v[4 * (size_t)t + i];
    int done = 0;
    tet_status status = p < r->n_first ? TET_OK : refine_remove(r, p, t, &done);
    if (status || done) return status;
  }
  uint64_t before = r->searched, points = r->points.n;
  tet_status status = refine_is_spent(r) ? TET_OK : mend_by_point(r, t);
  if (points == r->points.n) r->in_vain += price * (r->searched - before);
  return status;
}

/* Mends what can be. */
tet_status refine_mend(refiner *r) {
  refine_shape shape;
  uint32_t t;
  int sliver;
  tet_status status = refine_remove_points(r);
  int unwatched = refine_has_unwatched(r);
  r->strict = 1; /* no rule comes after that would heal a face */
  r->in_vain = 0; /* a budget of its own */
  r->watch_slivers = r->o.min_dihedral > 0;
  r->n_stays = r->points.n;
  r->stays = tet_calloc(r->ctx, r->n_stays, 1);
  if (!status && !r->stays) status = TET_E_MEMORY;
  while (!status && refine_next_tet(r, &t, &shape, &sliver)) continue; /* all are queued anew, once each */
  for (t = 0; t < r->mesh.n_slots && !status; t++) {
    if (refine_may_be_bad(r, t, unwatched)) status = refine_queue_tet(r, t);
    if (!status && (t & 4095) == 0) status = tet_poll(r->ctx);
  }
  while (!status && refine_next_tet(r, &t, &shape, &sliver)) {
    status = mend(r, t);
    if (!status) status = tet_poll(r->ctx);
  }
  tet_free(r->ctx, r->stays);
  r->stays = NULL;
  r->n_stays = 0;
  if (!status && r->result.n_not_delaunay) status = refine_check_delaunay(r);
  return status;
}
