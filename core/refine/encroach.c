// SPDX-License-Identifier: Apache-2.0
/* encroach.c: which subsegments and subfaces are encroached (3.1), with exact
 * signs on the stored doubles. On the sphere is not inside. In a locally Delaunay
 * mesh the apexes of the adjacent tetrahedra are all that need be looked at. */
#include "exact/quick.h"
#include "refine/refiner.h"

#include <math.h>

/* Cosine of the angle at v over ab, about. */
static double cosine_over(const refiner *r, uint32_t a, uint32_t b, uint32_t v) {
  const double *x = refine_x(r, a), *y = refine_x(r, b), *z = refine_x(r, v);
  double pq = 0, pp = 0, qq = 0;
  for (int i = 0; i < 3; i++) {
    double p = x[i] - z[i], q = y[i] - z[i];
    pq += p * q;
    pp += p * p;
    qq += q * q;
  }
  return pq / sqrt(pp * qq);
}

/* 1 if v is in the diametric ball of ab. */
static inline int is_over(const refiner *r, uint32_t a, uint32_t b, uint32_t v) {
  int sign = tet_quick_dot(refine_x(r, a), refine_x(r, b), refine_x(r, v));
  return (sign == TET_UNSURE ? tet_dot_sign(&r->points, a, b, v) : sign) < 0;
}

int refine_seg_hit_by(const refiner *r, uint32_t e, uint32_t vertex) {
  return is_over(r, r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1], vertex);
}

int refine_sub_hit_by(const refiner *r, uint32_t s, uint32_t vertex) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  return tet_in_diametric_ball3(&r->points, v[0], v[1], v[2], vertex) > 0;
}

int refine_sub_encroached(const refiner *r, uint32_t s) {
  for (int side = 0; side < 2; side++) {
    uint32_t h = r->sub_side[2 * (size_t)s + side];
    if (h != TET_NONE && refine_sub_hit_by(r, s, r->mesh.v[h])) return 1;
  }
  return 0;
}

/* The vertex deepest in the diametric ball of subsegment e, that is with the
 * widest angle over it, or TET_NONE. */
tet_status refine_seg_encroached(refiner *r, uint32_t e, uint32_t *ret_by) {
  refine_list *star = &r->star;
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1], last = TET_NONE;
  double widest = 2;
  star->n = 0;
  tet_status status = refine_seg_star(r, e, star);
  *ret_by = TET_NONE;
  for (uint32_t k = 0; k < 4 * star->n && !status; k++) {
    uint32_t v = r->mesh.v[4 * (size_t)star->at[k / 4] + k % 4];
    if (v == a || v == b || v == last) continue;
    last = v;
    if (!refine_seg_hit_by(r, e, v)) continue;
    double cosine = cosine_over(r, a, b, v);
    if (cosine < widest || (cosine == widest && v < *ret_by)) {
      widest = cosine;
      *ret_by = v;
    }
  }
  return status;
}

static tet_status push_new(refiner *r, refine_list *list, uint32_t value) {
  for (uint32_t i = 0; i < list->n; i++)
    if (list->at[i] == value) return TET_OK;
  return refine_push(r, list, value);
}

/* Puts the subsegment first in whose diametric ball the cavity's point is deepest. */
static void deepest_first(refiner *r) {
  refine_list *hits = &r->hit_segs;
  double widest = 2;
  uint32_t best = 0;
  for (uint32_t k = 0; k < hits->n; k++) {
    const uint32_t *v = r->seg_v + 2 * (size_t)hits->at[k];
    double cosine = cosine_over(r, v[0], v[1], r->cavity.p);
    if (!(cosine < widest)) continue;
    widest = cosine;
    best = k;
  }
  if (!best) return;
  uint32_t first = hits->at[0];
  hits->at[0] = hits->at[best];
  hits->at[best] = first;
}

/* 1 if tetrahedron t has subfaces or subsegments: few do. */
static inline int has_sides(const refiner *r, uint32_t t) { return r->mesh.wall[t] || r->tet_edges[t] & EDGES; }

/* The subsegments, the deepest first, and if asked for the subfaces, at the cavity's tetrahedra from the one
 * numbered `from` on, that its point encroaches upon or, being beyond it, cannot be seen from: the first
 * few of each, for the search began near the point's cause, and no more are tried. */
static tet_status collect(refiner *r, size_t from, int subfaces) {
  const refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  for (size_t k = from; k < r->mesh.n_cavity && r->hit_segs.n < MOST_TRIED && !status; k++) {
    uint32_t t = r->mesh.cavity[k];
    if (!has_sides(r, t)) continue;
    const uint32_t *v = r->mesh.v + 4 * (size_t)t;
    for (unsigned left = r->tet_edges[t] & EDGES; left && !status; left &= left - 1) {
      const uint8_t *e = refine_edge[__builtin_ctz(left)];
      if (is_over(r, v[e[0]], v[e[1]], c->p)) status = push_new(r, &r->hit_segs, refine_find_seg(r, v[e[0]], v[e[1]]));
    }
    for (uint32_t i = 0; i < 4 && subfaces && !r->hit_segs.n && r->hit_subs.n < MOST_TRIED && !status; i++) {
      uint32_t s = refine_sub_at(r, 4 * (size_t)t + i);
      if (s == TET_NONE) continue;
      const uint8_t *f = tet_face[i];
      if (refine_sub_hit_by(r, s, c->p) || tet_orient3d(&r->points, c->p, v[f[0]], v[f[1]], v[f[2]]) <= 0)
        status = push_new(r, &r->hit_subs, s);
    }
  }
  deepest_first(r);
  return status;
}

/* The subsegment at edge e of tetrahedron t, if one of its other two corners encroaches upon it, or
 * TET_NONE. */
uint32_t refine_hit_seg(const refiner *r, uint32_t t, int e) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  if (!(r->tet_edges[t] >> e & 1)) return TET_NONE;
  uint32_t a = v[refine_edge[e][0]], b = v[refine_edge[e][1]];
  if (!is_over(r, a, b, v[refine_edge[5 - e][0]]) && !is_over(r, a, b, v[refine_edge[5 - e][1]])) return TET_NONE;
  return refine_find_seg(r, a, b);
}

/* 1 if rejected candidates have had so many tetrahedra searched that no more wide cavities are searched for such. That
 * is for needles: there a cavity can have most of the mesh, and the accepting rule rejects most of what they ask
 * for, so that time would go with the square of the points, and more, for tetrahedra that stay over the bound anyway. The
 * share is about twice what inputs without a runaway were seen to need. */
int refine_is_spent(const refiner *r) {
  static const uint64_t least = 1000000, each = 500;
  return r->in_vain > least + each * r->points.n;
}

/* 1 if what is not split nearby for this cause is not split; what an existing vertex forces always is. */
int refine_gives_up(const refiner *r, refine_cause cause) { return cause == CAUSE_CENTRE && refine_is_spent(r); }

/* Grows the cavity, and collects what its point hits, until something is, or `end` tetrahedra are searched. */
static tet_status grow_or_hit(refiner *r, size_t most, size_t end, int subfaces) {
  size_t k = 0, seen = 0;
  int more = 1, hit = 0;
  tet_status status = TET_OK;
  r->hit_segs.n = 0;
  if (subfaces) r->hit_subs.n = 0;
  while (most < 2 * r->mesh.n_cavity) most *= 2; /* a begun one has some */
  for (; more && most <= end && !hit && !status; most *= 2) {
    status = tet_complex_grow_to(&r->mesh, r->cavity.p, most, &k, &more);
    if (!status) status = collect(r, seen, subfaces);
    hit = r->hit_segs.n || (subfaces && r->hit_subs.n);
    seen = r->mesh.n_cavity;
  }
  r->searched += seen;
  r->cavity.is_part = more && !hit;
  return status;
}

/* Grows the begun cavity of a point in a subface, and collects subsegments that it encroaches upon. */
tet_status refine_grow_or_hit_segs(refiner *r) {
  enum { FAR = 4096 }; /* what is hit is looked for all over as many: to split the deepest takes fewest points */
  return grow_or_hit(r, FAR, SIZE_MAX, 0);
}

/* The same for a cavity that is grown already, or was given up. */
tet_status refine_collect_segs(refiner *r) {
  r->hit_segs.n = 0;
  tet_status status = collect(r, 0, 0);
  r->cavity.is_part = r->cavity.is_part && !r->hit_segs.n;
  return status;
}

/* Grows the cavity of p from `tet`, and collects what p hits. That of a circumcentre far off can have most of the
 * mesh: the search ends where the cavity is not going to be filled, as something near is hit, or hits alone
 * are asked for; what is hit farther off is not looked for. */
tet_status refine_grow_or_hit(refiner *r, uint32_t p, uint32_t tet, refine_wanted wanted) {
  tet_status status = refine_cavity_of_tet(r, p, tet);
  size_t most = wanted == WANT_CAVITY ? NEAREST : NEAR, end = wanted == WANT_HITS || refine_is_spent(r) ? NEAR : SIZE_MAX;
  return status ? status : grow_or_hit(r, most, end, 1);
}

/* 0 if no other corner of that tetrahedron is in the diametric ball of its edge e: the angle over e is acute where the
 * squares of the sides are more than that of e. */
static inline int may_be_over(const refine_shapes *shapes, uint32_t lane, int e) {
  const double(*length2)[4] = shapes->length2, most = length2[e][lane] + shapes->room[lane];
  const uint8_t *ends = refine_edge[e], *others = refine_edge[5 - e];
  for (int i = 0; i < 2; i++) {
    const uint8_t *to = refine_edge_of[others[i]];
    if (!(length2[to[ends[0]]][lane] + length2[to[ends[1]]][lane] > most)) return 1;
  }
  return 0;
}

/* Queues the subsegments, of the edges `edges`, and subfaces at the new tetrahedron n that are encroached. */
static tet_status look_around(refiner *r, uint32_t n, unsigned edges) {
  tet_status status = TET_OK;
  for (; edges && !status; edges &= edges - 1) {
    uint32_t seg = refine_hit_seg(r, n, __builtin_ctz(edges));
    if (seg != TET_NONE) status = refine_queue_seg(r, seg);
  }
  for (unsigned left = r->mesh.wall[n]; left && !status; left &= left - 1) {
    uint32_t h = 4 * n + (uint32_t)__builtin_ctz(left), s = r->tet_sub[h];
    if (refine_sub_hit_by(r, s, r->mesh.v[h])) status = refine_queue_sub(r, s);
  }
  return status;
}

/* Queues what the new tetrahedron n leaves to do: itself, and subsegments and
 * subfaces at it. */
tet_status refine_look_at(refiner *r, uint32_t n) {
  tet_status status = has_sides(r, n) ? look_around(r, n, r->tet_edges[n] & EDGES) : TET_OK;
  return status ? status : refine_queue_tet(r, n);
}

/* The same for all that the last fill made. */
tet_status refine_look_at_made(refiner *r) {
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < r->cavity.n_made && !status; k++) {
    uint32_t n = r->mesh.cavity[k];
    unsigned edges = 0;
    if (!has_sides(r, n)) continue;
    for (unsigned left = r->tet_edges[n] & EDGES; left; left &= left - 1) {
      int e = __builtin_ctz(left);
      edges |= (unsigned)may_be_over(&r->cavity.shapes[k / 4], k % 4, e) << e;
    }
    status = look_around(r, n, edges);
  }
  return status ? status : refine_queue_made(r);
}
