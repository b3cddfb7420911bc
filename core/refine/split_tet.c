// SPDX-License-Identifier: Apache-2.0
/* split_tet.c: rule R3. The candidate is the circumcentre; one that encroaches
 * upon subsegments or subfaces, or lies beyond a subface, has one of those split
 * instead, subsegments first. Before it an off-centre is tried, where that is much
 * closer: fewer vertices do then, by a twentieth at bound 2 and a quarter at 1.2. What
 * is over the bound for the sake of a subface that is over it itself, as in narrow corners of facets,
 * gets no point in the volume: subsegments or that subface are split, or what protects them leaves
 * it as it is. */
#include "refine/refiner.h"

#include "base/triangle.h"
#include "base/vector.h"
#include "exact/predicates.h"

#include <math.h>
#include <string.h>

/* Splits the first that can be of what the candidate hit; none after one that is protected, as a point beside
 * it heals nothing, but leaves more over the bound, or that was given up. */
static tet_status split_hits(refiner *r, refine_outcome *ret) {
  if (r->hit_segs.n) return refine_split_hit_segs(r, CAUSE_CENTRE, ret);
  *ret = OUTCOME_REJECTED;
  tet_status status = TET_OK;
  const tet_rejections *n = &r->result.rejected;
  uint64_t before = n->protected_ball + n->given_up;
  for (uint32_t k = 0; k < r->hit_subs.n && !status && *ret != OUTCOME_INSERTED &&
                       before == n->protected_ball + n->given_up; k++)
    status = refine_split_sub(r, r->hit_subs.at[k], CAUSE_CENTRE, ret);
  return status;
}

/* Inserts x for tetrahedron t, or splits instead what it encroaches upon. */
static tet_status try_point(refiner *r, uint32_t t, const double x[3], refine_wanted wanted, refine_outcome *ret) {
  const uint32_t *corner = r->mesh.v + 4 * (size_t)t;
  *ret = OUTCOME_REJECTED;
  r->hit_segs.n = r->hit_subs.n = 0;
  if (!tet_is_place(x)) { /* the centre of a tetrahedron so flat or small that doubles hold none */
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
  status = refine_grow_or_hit(r, p, t, wanted);
  if (status) return status;
  int ok = 0, hit = r->hit_segs.n || r->hit_subs.n;
  if (!hit && c->is_part && wanted != WANT_HITS) {
    r->result.rejected.given_up++;
  } else if (!hit && wanted != WANT_HITS) {
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
  return hit && wanted != WANT_CAVITY ? split_hits(r, ret) : TET_OK;
}

/* The shortest edge of t. */
int refine_shortest_edge(const refiner *r, uint32_t t) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  double shortest2 = INFINITY;
  int shortest = 0;
  for (int e = 0; e < 6; e++) {
    double length2 = tet_distance2(refine_x(r, v[refine_edge[e][0]]), refine_x(r, v[refine_edge[e][1]]));
    if (!(length2 < shortest2)) continue;
    shortest2 = length2;
    shortest = e;
  }
  return shortest;
}

/* A point from the shortest edge's midpoint towards circumcentre c, rho_0 times
 * that edge away (an off-centre, Uengoer 2004): the circumball being empty, no
 * vertex is closer to it than that, which is all that Lemma 3.3.1 asks of a
 * circumcentre. 0 if that is about the circumcentre, as where the ratio holds. */
static int off_centre(const refiner *r, uint32_t t, const double c[3], double x[3]) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  const uint8_t *e = refine_edge[refine_shortest_edge(r, t)];
  const double *a = refine_x(r, v[e[0]]), *b = refine_x(r, v[e[1]]);
  double d[3];
  for (int i = 0; i < 3; i++) x[i] = 0.5 * (a[i] + b[i]);
  tet_minus(c, x, d);
  double share = r->o.radius_edge * sqrt(tet_distance2(a, b) / tet_square(d));
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
    double p[3], q[3], centre[3];
    for (int j = 0; j < 3; j++) c[j] = refine_x(r, r->mesh.v[4 * (size_t)t + tet_face[f][j]]);
    tet_minus(c[1], c[0], p);
    tet_minus(c[2], c[0], q);
    double nn = tet_triangle_centre(p, q, centre);
    if (!(nn > most)) continue;
    most = nn;
    for (int i = 0; i < 3; i++) x[i] = c[0][i] + centre[i];
  }
}

/* The subface at face h, if it is over the radius-edge bound itself, else TET_NONE. */
static uint32_t long_wall(const refiner *r, size_t h) {
  uint32_t s = refine_sub_at(r, h);
  if (s == TET_NONE) return TET_NONE;
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  double p[3], q[3], e[3], n[3];
  tet_minus(refine_x(r, v[1]), refine_x(r, v[0]), p);
  tet_minus(refine_x(r, v[2]), refine_x(r, v[0]), q);
  tet_minus(p, q, e);
  tet_cross(p, q, n);
  double pp = tet_square(p), qq = tet_square(q), ee = tet_square(e), reach = 2 * r->o.radius_edge;
  return pp * qq * ee > reach * reach * tet_square(n) * fmin(fmin(pp, qq), ee) ? s : TET_NONE;
}

/* The wall that the tetrahedra around edge ab end at, from t on through its face opposite x, or SIZE_MAX
 * if there is none. */
static size_t fan_end(const refiner *r, uint32_t t, uint32_t a, uint32_t b, uint32_t x) {
  for (uint32_t u = t;;) {
    const uint32_t *v = r->mesh.v + 4 * (size_t)u;
    size_t h = 4 * (size_t)u + refine_corner(r, u, x);
    if (refine_sub_at(r, h) != TET_NONE || r->mesh.adj[h] == TET_NONE) return h;
    x = v[0] ^ v[1] ^ v[2] ^ v[3] ^ a ^ b ^ x;
    u = r->mesh.adj[h] >> 2;
    if (u == t) return SIZE_MAX;
  }
}

/* A subface over the bound for which t is over it too: one of its own, on which no tetrahedron has a better
 * ratio; or, where both subfaces that the tetrahedra around its shortest edge end at are over, one of these:
 * between them points in the volume leave more over the bound than they mend. TET_NONE: there is none. */
static uint32_t wall_to_blame(const refiner *r, uint32_t t) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  int shortest = refine_shortest_edge(r, t);
  const uint8_t *e = refine_edge[shortest], *f = refine_edge[5 - shortest];
  uint32_t wall = TET_NONE;
  for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4 && wall == TET_NONE; h++) wall = long_wall(r, h);
  if (wall != TET_NONE) return wall;
  size_t end = fan_end(r, t, v[e[0]], v[e[1]], v[f[0]]);
  if (end == SIZE_MAX || long_wall(r, end) == TET_NONE) return TET_NONE;
  return long_wall(r, fan_end(r, t, v[e[0]], v[e[1]], v[f[1]]));
}

/* For t, over the bound because of subface `wall`: no point in the volume. *ret_kept = 1 where the wall, or what
 * could be split instead, is protected, so that t stays whatever else is split for it. */
static tet_status split_wall(refiner *r, uint32_t t, uint32_t wall, const double centre[3], refine_outcome *ret,
                             int *ret_kept) {
  uint64_t noise = r->result.rejected.outside, protected = r->result.rejected.protected_ball;
  double x[3];
  tet_status status = refine_split_sub(r, wall, CAUSE_CENTRE, ret);
  *ret_kept = *ret == OUTCOME_REJECTED && protected != r->result.rejected.protected_ball;
  if (status || *ret_kept || *ret != OUTCOME_REJECTED) return status;
  status = try_point(r, t, centre, WANT_HITS, ret);
  if (!status && noise != r->result.rejected.outside) {
    face_centre(r, t, x);
    status = try_point(r, t, x, WANT_HITS, ret);
  }
  *ret_kept = *ret == OUTCOME_REJECTED && protected != r->result.rejected.protected_ball;
  return status;
}

/* A point in the volume for t, or what that encroaches upon. */
static tet_status split_volume(refiner *r, uint32_t t, double shortest2, const double centre[3], refine_outcome *ret) {
  double x[3];
  tet_status status = TET_OK;
  if (off_centre(r, t, centre, x)) status = try_point(r, t, x, WANT_CAVITY, ret);
  uint64_t noise = r->result.rejected.outside;
  if (!status && *ret == OUTCOME_REJECTED) status = try_point(r, t, centre, WANT_EITHER, ret);
  if (!status && noise != r->result.rejected.outside) {
    face_centre(r, t, x);
    refine_pick(r, shortest2, x);
    status = try_point(r, t, x, WANT_EITHER, ret);
  }
  return status;
}

tet_status refine_split_tet(refiner *r, uint32_t t, const refine_shape *shape, int is_sliver, refine_outcome *ret) {
  uint32_t old[4];
  double centre[3];
  uint64_t before = r->searched;
  memcpy(old, r->mesh.v + 4 * (size_t)t, sizeof old);
  refine_circumcentre(r, t, shape, centre);
  r->picking = is_sliver;
  refine_pick(r, shape->shortest2, centre);
  *ret = OUTCOME_REJECTED;
  uint32_t wall = refine_over_ratio(r, shape) ? wall_to_blame(r, t) : TET_NONE;
  tet_status status = TET_OK;
  int kept = 0;
  if (wall != TET_NONE) status = split_wall(r, t, wall, centre, ret, &kept);
  if (!status && *ret == OUTCOME_REJECTED && !kept) status = split_volume(r, t, shape->shortest2, centre, ret);
  r->picking = 0;
  if (*ret == OUTCOME_REJECTED) r->in_vain += r->searched - before;
  if (status || *ret != OUTCOME_INSERTED) return status;
  return refine_is_tet(r, t, old) ? refine_queue_tet(r, t) : TET_OK;
}
