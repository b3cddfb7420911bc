// SPDX-License-Identifier: Apache-2.0
/* split_facet.c: rule R2. The candidate is the centre of the subface's diametric
 * ball; one that encroaches upon subsegments, or lies beyond one, has that split
 * instead. Near a vertex where a segment stands low on the facet, that has no end: there it is
 * as far from the vertex as the segment's point is. */
#include "refine/refiner.h"

#include "base/triangle.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Beside the point of a segment that stands so low on the facet that the edge right below it, from vertex `end`, and
 * the segment are over the bound: x aside of the point's foot, nearly as far as the point is high, on the side where subface
 * s has no such corner yet, and has more of itself. With one on either side no subface there is encroached upon by the
 * point, nor the segment by these, and all are as far apart as that can be. 0: s has a corner on either side, or is
 * elsewhere. Not for sharp segments: about these balls end what has no end. */
static int aside(const refiner *r, uint32_t s, uint32_t end, const double foot[3], double height, double x[3]) {
  static const double share = 0.95, room = 0.25;
  const double *o = refine_x(r, end);
  double across[3], place[2][3], far[2] = {-1, -1}, length = sqrt(tet_square(foot));
  int taken[2] = {0, 0}, has_end = 0;
  tet_cross(r->patch[r->sub_patch[s]].normal, foot, across);
  for (int side = 0; side < 2; side++)
    for (int i = 0; i < 3; i++)
      place[side][i] = o[i] + foot[i] + (side ? -share : share) * height / length * across[i];
  for (int j = 0; j < 3; j++) {
    uint32_t v = r->sub_v[3 * (size_t)s + j];
    double d[3];
    has_end |= v == end;
    if (v == end) continue;
    tet_minus(refine_x(r, v), o, d);
    double turn = tet_dot(d, across) / sqrt(tet_square(d));
    for (int side = 0; side < 2; side++) {
      far[side] = fmax(far[side], side ? -turn : turn);
      taken[side] |= tet_distance2(refine_x(r, v), place[side]) < room * room * height * height;
    }
  }
  int side = far[1] > far[0];
  if (taken[side]) side = !side;
  if (taken[side] || !(has_end || taken[!side])) return 0;
  memcpy(x, place[side], sizeof place[side]);
  return 1;
}

/* Where subface s, encroached by a Steiner point of a segment that ends at one of its corners and
 * is not in its facet, is cut: as far from that corner as the point is, and nearest to it, or aside of there. By no
 * subface with that edge is the point encroached upon again, where a centre would have the
 * segment split, and its half encroach upon a smaller subface, without end. 0: it is not so. */
static int opposite(const refiner *r, uint32_t s, double x[3]) {
  static const double more = 1.2; /* of the bound: a tetrahedron's ratio is that of a face, and more */
  const refine_patch *plane = &r->patch[r->sub_patch[s]];
  for (int side = 0; side < 2; side++) {
    uint32_t h = r->sub_side[2 * (size_t)s + side], by = h == TET_NONE ? TET_NONE : r->mesh.v[h];
    if (by == TET_NONE || r->out->origin[by] != TET_ORIGIN_SEGMENT || !refine_sub_hit_by(r, s, by) ||
        refine_on_facet(r, by, plane->facet)) continue;
    const tet_segment *segment = &r->out->segment[r->out->carrier[by]];
    for (int j = 0; j < 2; j++) {
      uint32_t end = j ? segment->b : segment->a;
      if (!refine_on_facet(r, end, plane->facet)) continue;
      double d[3], foot[3], off = 0, far = 0.1 * r->size[end];
      tet_minus(refine_x(r, by), refine_x(r, end), d);
      if (tet_square(d) > far * far) continue; /* it is not without end yet */
      for (int i = 0; i < 3; i++) off += d[i] * plane->normal[i];
      for (int i = 0; i < 3; i++) foot[i] = d[i] - off * plane->normal[i];
      double share = sqrt(tet_square(d) / tet_square(foot));
      if (!(share < 2)) continue; /* above 60 degrees nothing loops */
      int is_low = 2 * fabs(off) * r->o.radius_edge < more * sqrt(tet_square(d));
      int is_sharp = r->low[end] > 0 || r->segment_sharp[r->out->carrier[by]] & (SHARP_PLANE | SHARP_DIHEDRAL);
      if (is_low && !is_sharp && aside(r, s, end, foot, fabs(off), x)) return 1;
      const uint32_t *v = r->sub_v + 3 * (size_t)s;
      if (v[0] != end && v[1] != end && v[2] != end) continue;
      for (int i = 0; i < 3; i++) x[i] = refine_x(r, end)[i] + share * foot[i];
      return 1;
    }
  }
  return 0;
}

/* Puts x back into the plane: along the normal, or of a needle, whose normal is rounded by a thousand
 * times more than coordinates are, by its directions. */
static void into_plane(const refiner *r, const refine_patch *plane, double x[3]) {
  double d[3], along2 = tet_square(plane->along), across2 = tet_square(plane->across);
  tet_minus(x, plane->origin, d);
  if (along2 > 1000 * r->points.max_abs * sqrt(across2) && across2 > 0) {
    double u = tet_dot(d, plane->along) / along2, v = tet_dot(d, plane->across) / across2;
    for (int i = 0; i < 3; i++) x[i] = plane->origin[i] + (u * plane->along[i] + v * plane->across[i]);
    return;
  }
  double off = tet_dot(d, plane->normal);
  for (int i = 0; i < 3; i++) x[i] -= off * plane->normal[i];
}

/* The circumcentre of subface s, put back into its patch's plane. */
static int centre_of(const refiner *r, uint32_t s, double c[3]) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  const double *o = refine_x(r, v[0]);
  double p[3], q[3];
  tet_minus(refine_x(r, v[1]), o, p);
  tet_minus(refine_x(r, v[2]), o, q);
  if (!(tet_triangle_centre(p, q, c) > 0)) return 0;
  for (int i = 0; i < 3; i++) c[i] = o[i] + c[i];
  double pp = tet_square(p), qq = tet_square(q);
  refine_pick(r, fmin(fmin(pp, qq), pp + qq - 2 * tet_dot(p, q)), c);
  into_plane(r, &r->patch[r->sub_patch[s]], c);
  return 1;
}

/* Walks in the patch from s to the subface that holds vertex p; *ret_seg is the
 * subsegment in the way, if any. 0 if the walk does not end in `most` steps. */
static int walk(refiner *r, uint32_t s, uint32_t p, int most, uint32_t *ret_sub, uint32_t *ret_seg) {
  int axis = r->patch[r->sub_patch[s]].axis;
  uint32_t from = TET_NONE;
  *ret_seg = TET_NONE;
  for (int steps = 0; steps < most; steps++, r->searched++) {
    uint32_t out = TET_NONE;
    for (uint32_t h = 3 * s; h < 3 * s + 3; h++) {
      if (h == from) continue;
      if (tet_orient2d(&r->points, axis, r->sub_v[h], r->sub_v[3 * s + (h + 1) % 3], p) < 0) {
        out = h;
        if (r->sub_seg[h] == TET_NONE) break;
      }
    }
    *ret_sub = s;
    if (out == TET_NONE) return 1;
    if (r->sub_seg[out] != TET_NONE) {
      *ret_seg = r->sub_seg[out];
      return 1;
    }
    from = r->ring[out];
    s = from / 3;
  }
  return 0;
}

/* R1 on the first of the subsegments hit that can be split; for a circumcentre's sake on none after one that
 * is protected, as a point beside it heals nothing, or that was given up. */
tet_status refine_split_hit_segs(refiner *r, refine_cause cause, refine_outcome *ret) {
  *ret = OUTCOME_REJECTED;
  tet_status status = TET_OK;
  const tet_rejections *n = &r->result.rejected;
  uint64_t before = n->protected_ball + n->given_up;
  for (uint32_t k = 0; k < r->hit_segs.n && !status && *ret != OUTCOME_INSERTED &&
                       (cause == CAUSE_VERTEX || before == n->protected_ball + n->given_up); k++)
    status = refine_split_seg(r, r->hit_segs.at[k], TET_NONE, cause, ret);
  return status;
}

static tet_status halve_edge(refiner *r, uint32_t s, refine_cause cause, refine_outcome *ret);

/* Inserts the last point, which subface `at` holds, for subface s. */
static tet_status try_centre(refiner *r, uint32_t s, uint32_t at, refine_cause cause, refine_outcome *ret) {
  uint32_t p = r->points.n - 1;
  refine_cavity *c = &r->cavity;
  if (refine_is_narrow(r, at, tet_longest(refine_x(r, p)))) {
    refine_drop_point(r);
    r->result.rejected.too_short++;
    return TET_OK;
  }
  int near = refine_gives_up(r, cause);
  tet_status status = refine_cavity_of_sub(r, p, at, near ? EXTENT_NEAR : EXTENT_BEGUN);
  if (!status) status = near ? refine_collect_segs(r) : refine_grow_or_hit_segs(r);
  if (status) return status;
  int ok = 0, missed = 0;
  if (c->is_part) {
    r->result.rejected.given_up++;
  } else if (!r->hit_segs.n) {
    uint32_t now = ++r->stamp_now;
    c->vertices.n = 0;
    for (uint32_t k = 0; k < 3 * c->subs.n && !status; k++) {
      uint32_t v = r->sub_v[3 * (size_t)c->subs.at[k / 3] + k % 3];
      if (r->stamp[v] == now) continue;
      r->stamp[v] = now;
      status = refine_push(r, &c->vertices, v);
    }
    if (status) return status;
    if (!refine_accepts(r, p, c->vertices.at, c->vertices.n, r->o.alpha2, cause) ||
        (cause == CAUSE_CENTRE && refine_crowded(r, c->vertices.at, c->vertices.n))) {
      r->result.rejected.protected_ball++;
    } else if (!(r->sub_mark[s] & 1)) {
      missed = 1;
    } else {
      status = refine_insert(r, &ok);
      if (!ok) r->result.rejected.lost_subface++;
    }
  }
  if (status) return status;
  if (ok) {
    r->result.facet_points++;
    refine_spend(r);
    *ret = OUTCOME_INSERTED;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  if (missed) return halve_edge(r, s, cause, ret);
  return r->hit_segs.n ? refine_split_hit_segs(r, cause, ret) : TET_OK;
}

/* Halves the longest edge of s, for a subface that its circumcentre does not replace, or whose circumcentre
 * is beyond a subsegment that it does not encroach upon. In a Delaunay triangulation of the facet, no subsegment being encroached, there is no such
 * one; where the facet's diagonals had to stay, as beside a Steiner point rounded off a crease, there may be,
 * and cutting that subsegment would bring nothing, time and again. */
static tet_status halve_edge(refiner *r, uint32_t s, refine_cause cause, refine_outcome *ret) {
  double longest2 = -1, x[3] = {0, 0, 0};
  uint32_t at = 3 * s;
  for (uint32_t h = 3 * s; h < 3 * s + 3; h++) {
    const double *a = refine_x(r, r->sub_v[h]), *b = refine_x(r, r->sub_v[3 * s + (h + 1) % 3]);
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, length2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (length2 <= longest2) continue;
    longest2 = length2;
    at = h;
    for (int i = 0; i < 3; i++) x[i] = 0.5 * (a[i] + b[i]);
  }
  if (r->sub_seg[at] != TET_NONE) return refine_split_seg(r, r->sub_seg[at], TET_NONE, cause, ret);
  const refine_patch *plane = &r->patch[r->sub_patch[s]];
  into_plane(r, plane, x);
  if (!tet_is_place(x)) return TET_OK;
  tet_status status = refine_add_point(r, x, TET_ORIGIN_FACET, plane->facet);
  return status ? status : try_centre(r, s, s, cause, ret);
}

tet_status refine_split_sub(refiner *r, uint32_t s, refine_cause cause, refine_outcome *ret) {
  double x[3];
  uint32_t at, seg, old[3];
  *ret = OUTCOME_REJECTED;
  if (!(cause == CAUSE_VERTEX && opposite(r, s, x)) && !centre_of(r, s, x)) return TET_OK;
  if (!tet_is_place(x)) return TET_OK; /* of a size that products of its lengths have no doubles */
  memcpy(old, r->sub_v + 3 * (size_t)s, sizeof old);
  tet_status status = refine_add_point(r, x, TET_ORIGIN_FACET, r->patch[r->sub_patch[s]].facet);
  if (status) return status;
  if (!refine_accepts(r, r->points.n - 1, old, 3, r->o.alpha2, cause)) {
    refine_drop_point(r);
    r->result.rejected.protected_ball++;
    return TET_OK;
  }
  int found = walk(r, s, r->points.n - 1, refine_gives_up(r, cause) ? NEAR : 10000, &at, &seg);
  if (found && seg == TET_NONE) {
    status = try_centre(r, s, at, cause, ret);
  } else {
    int hit = found && refine_seg_hit_by(r, seg, r->points.n - 1);
    refine_drop_point(r);
    if (hit) status = refine_split_seg(r, seg, TET_NONE, cause, ret);
    else if (found) status = halve_edge(r, s, cause, ret);
  }
  if (status || *ret != OUTCOME_INSERTED || cause != CAUSE_VERTEX) return status;
  /* a subsegment was split instead: the subface may still be encroached */
  if (memcmp(old, r->sub_v + 3 * (size_t)s, sizeof old) == 0) return refine_queue_sub(r, s);
  return TET_OK;
}
