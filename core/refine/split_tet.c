// SPDX-License-Identifier: Apache-2.0
/* split_tet.c: rule R3. The candidate is the circumcentre; one that encroaches
 * upon subsegments or subfaces, or lies beyond a subface, has one of those split
 * instead, subsegments first. Before it an off-centre is tried, where that is much
 * closer: fewer vertices do then, by a twentieth at bound 2 and a quarter at 1.2. */
#include "refine/refiner.h"

#include "base/vector.h"
#include "exact/predicates.h"

#include <math.h>
#include <string.h>

/* Splits the first that can be of what the candidate hit; where that is in a thin facet, what is
 * near fares no better. */
static tet_status split_hits(refiner *r, refine_outcome *ret) {
  tet_status status = TET_OK;
  *ret = OUTCOME_REJECTED;
  int thin = 0;
  for (uint32_t k = 0; k < r->hit_segs.n && !thin && !status && *ret != OUTCOME_INSERTED; k++) {
    thin = refine_segment_is_thin(r, r->seg_of[r->hit_segs.at[k]]);
    status = refine_split_seg(r, r->hit_segs.at[k], TET_NONE, CAUSE_CENTRE, ret);
  }
  if (r->hit_segs.n) return status;
  for (uint32_t k = 0; k < r->hit_subs.n && !thin && !status && *ret != OUTCOME_INSERTED; k++) {
    thin = r->facet_thin[r->patch[r->sub_patch[r->hit_subs.at[k]]].facet];
    status = refine_split_sub(r, r->hit_subs.at[k], CAUSE_CENTRE, ret);
  }
  return status;
}

/* 0: the centre of a tetrahedron so flat or small that doubles hold none. */
static int is_place(const double x[3]) {
  int so = 1;
  for (int i = 0; i < 3; i++) so &= fabs(x[i]) <= TET_COORDINATE_LIMIT; /* false for NaN */
  return so;
}

/* Inserts x for tetrahedron t, or splits `instead` what it encroaches upon. */
static tet_status try_point(refiner *r, uint32_t t, const double x[3], int instead, refine_outcome *ret) {
  const uint32_t *corner = r->mesh.v + 4 * (size_t)t;
  *ret = OUTCOME_REJECTED;
  if (!is_place(x)) {
    r->result.rejected.outside++;
    return TET_OK;
  }
  tet_status status = refine_add_point(r, x, TET_ORIGIN_VOLUME, TET_NONE);
  if (status) return status;
  /* the circumcentre of a near-flat tetrahedron is noise unless it is inside */
  if (tet_insphere_sos(&r->points, corner[0], corner[1], corner[2], corner[3], r->points.n - 1) <= 0) {
    refine_drop_point(r);
    r->result.rejected.outside++;
    return TET_OK;
  }
  uint32_t p = r->points.n - 1;
  refine_cavity *c = &r->cavity;
  status = refine_grow_or_hit(r, p, t);
  if (status) return status;
  int ok = 0, hit = r->hit_segs.n || r->hit_subs.n;
  if (!hit) {
    int watched = refine_needs_sizes(r);
    if (watched) status = refine_cavity_vertices(r);
    if (status) return status;
    if (watched && !refine_accepts(r, p, c->vertices.at, c->vertices.n, 0, CAUSE_CENTRE)) {
      r->result.rejected.protected_ball++;
    } else {
      status = refine_insert(r, &ok);
      if (!ok) r->result.rejected.lost_subface++;
    }
  }
  if (status) return status;
  if (ok) {
    r->result.volume_points++;
    *ret = OUTCOME_INSERTED;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return hit && instead ? split_hits(r, ret) : TET_OK;
}

/* A point from the shortest edge's midpoint towards circumcentre c, rho_0 times
 * that edge away (an off-centre, Uengoer 2004): the circumball being empty, no
 * vertex is closer to it than that, which is all that Lemma 3.3.1 asks of a
 * circumcentre. 0 if that is about the circumcentre, as where the ratio holds. */
static int off_centre(const refiner *r, uint32_t t, const double c[3], double x[3]) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  double d[3], shortest2 = INFINITY;
  for (int e = 0; e < 6; e++) {
    const double *a = refine_x(r, v[refine_edge[e][0]]), *b = refine_x(r, v[refine_edge[e][1]]);
    tet_minus(a, b, d);
    if (!(tet_square(d) < shortest2)) continue;
    shortest2 = tet_square(d);
    for (int i = 0; i < 3; i++) x[i] = 0.5 * (a[i] + b[i]);
  }
  tet_minus(c, x, d);
  double share = r->o.radius_edge * sqrt(shortest2 / tet_square(d));
  if (!(share > 0 && share < 0.8)) return 0; /* 0: of a centre at infinity */
  for (int i = 0; i < 3; i++) x[i] += share * d[i];
  return 1;
}

/* The circumcentre of the face of t with the longest normal: inside the circumball
 * of a near-flat tetrahedron, wherever rounding puts that ball's own centre. */
static void face_centre(const refiner *r, uint32_t t, double x[3]) {
  double most = 0;
  for (int f = 0; f < 4; f++) {
    const double *c[3];
    double p[3], q[3], n[3], pp = 0, qq = 0, nn = 0;
    for (int j = 0; j < 3; j++) c[j] = refine_x(r, r->mesh.v[4 * (size_t)t + tet_face[f][j]]);
    for (int i = 0; i < 3; i++) {
      p[i] = c[1][i] - c[0][i];
      q[i] = c[2][i] - c[0][i];
      pp += p[i] * p[i];
      qq += q[i] * q[i];
    }
    for (int i = 0; i < 3; i++) {
      n[i] = p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3];
      nn += n[i] * n[i];
    }
    if (!(nn > most)) continue;
    most = nn;
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      x[i] = c[0][i] + ((pp * q[j] - qq * p[j]) * n[k] - (pp * q[k] - qq * p[k]) * n[j]) / (2 * nn);
    }
  }
}

/* Where segments meet below 60 degrees and circumcentre x hits something, that is split first, as off-centres
 * would leave more tetrahedra over the bound: then *ret_hit = 1, and *ret is what came of that. */
static tet_status hits_first(refiner *r, uint32_t t, const double x[3], int *ret_hit, refine_outcome *ret) {
  const uint32_t *corner = r->mesh.v + 4 * (size_t)t;
  int acute = 0;
  *ret_hit = 0;
  for (int i = 0; i < 4; i++) acute |= corner[i] < r->n_first && r->acute_end[corner[i]];
  if (!acute || !is_place(x)) return TET_OK;
  tet_status status = refine_add_point(r, x, TET_ORIGIN_VOLUME, TET_NONE);
  if (status) return status;
  if (tet_insphere_sos(&r->points, corner[0], corner[1], corner[2], corner[3], r->points.n - 1) > 0) {
    status = refine_grow_or_hit(r, r->points.n - 1, t);
    if (status) return status;
    *ret_hit = r->hit_segs.n || r->hit_subs.n;
    refine_cavity_clear(r);
  }
  refine_drop_point(r);
  return *ret_hit ? split_hits(r, ret) : TET_OK;
}

tet_status refine_split_tet(refiner *r, uint32_t t, const refine_shape *shape, int is_sliver, refine_outcome *ret) {
  uint32_t old[4];
  double centre[3], x[3];
  memcpy(old, r->mesh.v + 4 * (size_t)t, sizeof old);
  refine_circumcentre(r, t, shape, centre);
  r->picking = is_sliver;
  refine_pick(r, shape->shortest2, centre);
  tet_status status = TET_OK;
  *ret = OUTCOME_REJECTED;
  int is_off = off_centre(r, t, centre, x), hit = 0;
  if (is_off) status = hits_first(r, t, centre, &hit, ret);
  if (!status && is_off && !hit) status = try_point(r, t, x, 0, ret);
  uint64_t noise = r->result.rejected.outside;
  if (!status && !hit && *ret == OUTCOME_REJECTED) status = try_point(r, t, centre, 1, ret);
  if (!status && noise != r->result.rejected.outside) {
    face_centre(r, t, x);
    refine_pick(r, shape->shortest2, x);
    status = try_point(r, t, x, 1, ret);
  }
  if (!status && hit && *ret == OUTCOME_REJECTED && off_centre(r, t, centre, x))
    status = try_point(r, t, x, 0, ret);
  r->picking = 0;
  if (status || *ret != OUTCOME_INSERTED) return status;
  return refine_is_tet(r, t, old) ? refine_queue_tet(r, t) : TET_OK;
}
