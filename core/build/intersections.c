// SPDX-License-Identifier: Apache-2.0
/* intersections.c: which triangles, pieces and loose points of the soup meet other
 * than in shared vertices and edges, exactly (design 9.6, 9.7).
 *
 * A vertex on a facet or piece, or a side in a facet's plane, is noted, to be
 * resolved; two interiors that meet are a fault. Pairs come from boxes that touch.
 * Triangles of one facet do not meet by construction. */
#include <math.h>

#include "build/boxtree.h"
#include "build/soup.h"
#include "exact/predicates.h"
#include "exact/quick.h"

/* Items: triangles, then pieces, then loose points. */
typedef struct finder {
  tet_soup *s;
  const tet_points *points;
  tet_quick_plane *plane; /* [triangles] */
} finder;

typedef struct ends {
  uint32_t a, b;
} ends;

static int is_corner(const uint32_t t[3], uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

/* The side of triangle `tri` on which vertex v lies. */
static int side_of(const finder *f, uint32_t tri, uint32_t v) {
  const uint32_t *t = f->s->tri + 3 * (size_t)tri;
  int side = tet_quick_side(&f->plane[tri], tet_soup_x(f->s, v));
  return side != TET_UNSURE ? side : tet_orient3d(f->points, t[0], t[1], t[2], v);
}

static tet_status note_join(finder *f, uint32_t facet, uint32_t vertex) {
  tet_soup *s = f->s;
  tet_status st = tet_grow(s->ctx, &s->new_join, &s->cap_new_join, (size_t)s->n_new_joins + 1, sizeof *s->new_join);
  if (st == TET_OK) s->new_join[s->n_new_joins++] = (tet_join){facet, vertex};
  return st;
}

static tet_status note_split(finder *f, uint32_t piece, uint32_t vertex) {
  tet_soup *s = f->s;
  tet_status st = tet_grow(s->ctx, &s->split, &s->cap_split, (size_t)s->n_splits + 1, sizeof *s->split);
  if (st == TET_OK) s->split[s->n_splits++] = (tet_piece_split){piece, vertex};
  return st;
}

static tet_status note_constraint(finder *f, uint32_t facet, ends e, tet_offender_kind kind, uint32_t owner) {
  tet_soup *s = f->s;
  tet_status st = tet_grow(s->ctx, &s->new_constraint, &s->cap_new_constraint, (size_t)s->n_new_constraints + 1,
                           sizeof *s->new_constraint);
  if (st != TET_OK) return st;
  if (e.a > e.b) e = (ends){e.b, e.a};
  s->new_constraint[s->n_new_constraints++] = (tet_constraint){facet, e.a, e.b, kind, owner};
  return TET_OK;
}

static tet_status note_fault(finder *f, tet_offender_kind k0, uint32_t i0, tet_offender_kind k1, uint32_t i1,
                             const char *what, const double place[3]) {
  tet_fault fault = {.status = TET_E_INTERSECTION, .what = what};
  fault.offence = (tet_offence){.kind = {k0, k1}, .index = {i0, i1}, .place = {place[0], place[1], place[2]}};
  return tet_soup_fault(f->s, &fault);
}

/* About where segment e meets the plane of t. */
static void crossing_place(const finder *f, ends e, const uint32_t t[3], double place[3]) {
  const double *p = tet_soup_x(f->s, e.a), *q = tet_soup_x(f->s, e.b), *o = tet_soup_x(f->s, t[0]);
  double n[3], hp = 0, hq = 0, scale = f->points->max_abs > 0 ? f->points->max_abs : 1.0;
  tet_soup_normal(f->s, t[0], t[1], t[2], n);
  for (int k = 0; k < 3; k++) {
    hp += n[k] * ((p[k] - o[k]) / scale);
    hq += n[k] * ((q[k] - o[k]) / scale);
  }
  double at = hp != hq ? hp / (hp - hq) : 0.5;
  if (!(at >= 0 && at <= 1)) at = 0.5;
  for (int k = 0; k < 3; k++) place[k] = p[k] * (1 - at) + q[k] * at;
}

static void middle_place(const finder *f, const uint32_t t[3], double place[3]) {
  for (int k = 0; k < 3; k++)
    place[k] = tet_soup_x(f->s, t[0])[k] / 3 + tet_soup_x(f->s, t[1])[k] / 3 + tet_soup_x(f->s, t[2])[k] / 3;
}

/* Vertex v in the plane of triangle t (of facet): inside it or on its border? */
static int in_closed(const finder *f, uint32_t v, const uint32_t t[3], int axis) {
  for (int j = 0; j < 3; j++)
    if (tet_orient2d(f->points, axis, t[j], t[(j + 1) % 3], v) < 0) return 0;
  return 1;
}

/* Segment e in the plane of t: does it meet the open triangle? A line along one of
 * the sides, or along e, separates them if not. */
static int enters(const finder *f, ends e, const uint32_t t[3], int axis) {
  int left = 0, right = 0;
  for (int j = 0; j < 3; j++) {
    uint32_t u = t[j], v = t[(j + 1) % 3];
    if (tet_orient2d(f->points, axis, u, v, e.a) <= 0 && tet_orient2d(f->points, axis, u, v, e.b) <= 0) return 0;
    int side = tet_orient2d(f->points, axis, e.a, e.b, u);
    left += side > 0;
    right += side < 0;
  }
  return left > 0 && right > 0;
}

/* Segment e strictly across the plane of t: 3 if through its interior, j if through
 * the interior of side j, -1 if it misses or goes through a corner (that corner is
 * noted on e elsewhere). */
static int pierced(const finder *f, ends e, const uint32_t t[3]) {
  int left = 0, right = 0, at = 3;
  for (int j = 0; j < 3; j++) {
    int side = tet_orient3d(f->points, e.a, e.b, t[j], t[(j + 1) % 3]);
    left += side > 0;
    right += side < 0;
    if (side == 0) at = j;
  }
  return (left == 0 && right >= 2) || (right == 0 && left >= 2) ? at : -1;
}

/* A segment, its sides of the plane of triangle `tri`, and whose it is. */
typedef struct segment {
  ends e;
  int sa, sb;
  int fixed, border;
  tet_offender_kind kind;
  uint32_t owner;
} segment;

static tet_status segment_triangle(finder *f, const segment *g, uint32_t tri) {
  const tet_soup *s = f->s;
  const uint32_t *t = s->tri + 3 * (size_t)tri;
  uint32_t facet = s->facet[tri];
  double place[3];
  if (g->sa * g->sb < 0) {
    int at = pierced(f, g->e, t);
    if (at < 0) return TET_OK;
    /* A border through an edge inside a facet goes through that facet, or lies in its
       plane: then that is what counts. */
    if (at < 3 && !g->border && s->edge[3 * (size_t)tri + (size_t)at] & TET_EDGE_BORDER) return TET_OK;
  } else {
    if (g->sa != 0 || g->sb != 0) return TET_OK;
    if (is_corner(t, g->e.a) && is_corner(t, g->e.b)) return TET_OK;
    if (!enters(f, g->e, t, s->axis[facet])) return TET_OK;
    if (g->fixed) return note_constraint(f, facet, g->e, g->kind, g->owner);
  }
  crossing_place(f, g->e, t, place);
  return note_fault(f, TET_OFFENDER_FACET, facet, g->kind, g->owner, NULL, place);
}

/* 1: the line of a side of t, in one plane with u, has u strictly beyond it but for common corners on it. */
static int is_beyond(const finder *f, const uint32_t t[3], const uint32_t u[3], int axis) {
  int beyond = 0;
  for (int j = 0; j < 3 && !beyond; j++) {
    uint32_t a = t[j], b = t[(j + 1) % 3];
    beyond = 1;
    for (int d = 0; d < 3 && beyond; d++)
      beyond = u[d] == a || u[d] == b || tet_orient2d(f->points, axis, a, b, u[d]) < 0;
  }
  return beyond;
}

/* Two triangles in one plane. */
static tet_status coplanar_triangles(finder *f, uint32_t i, uint32_t j) {
  const tet_soup *s = f->s;
  const uint32_t *t[2] = {s->tri + 3 * (size_t)i, s->tri + 3 * (size_t)j};
  const uint32_t facet[2] = {s->facet[i], s->facet[j]};
  int axis = s->axis[facet[0]], apart = 0;
  for (int k = 0; k < 2; k++)
    if (is_beyond(f, t[k], t[1 - k], s->axis[facet[k]])) return TET_OK;
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 3; c++) {
      uint32_t v = t[k][c];
      if (is_corner(t[1 - k], v) || !in_closed(f, v, t[1 - k], s->axis[facet[1 - k]])) continue;
      tet_status st = note_join(f, facet[1 - k], v);
      if (st != TET_OK) return st;
    }
  for (int k = 0; k < 2 && !apart; k++) {
    int sign = tet_orient2d(f->points, axis, t[k][0], t[k][1], t[k][2]);
    for (int c = 0; c < 3 && !apart; c++) {
      apart = 1;
      for (int d = 0; d < 3 && apart; d++)
        apart = sign * tet_orient2d(f->points, axis, t[k][c], t[k][(c + 1) % 3], t[1 - k][d]) <= 0;
    }
  }
  if (apart) return TET_OK;
  double place[3];
  middle_place(f, t[0], place);
  return note_fault(f, TET_OFFENDER_FACET, facet[0], TET_OFFENDER_FACET, facet[1], "overlap", place);
}

/* Vertices and sides of triangle i, with signs o[], against triangle j. */
static tet_status half_pair(finder *f, uint32_t i, const int o[3], uint32_t j) {
  const tet_soup *s = f->s;
  const uint32_t *t = s->tri + 3 * (size_t)i, *u = s->tri + 3 * (size_t)j;
  uint32_t facet = s->facet[j];
  tet_status st = TET_OK;
  for (int c = 0; c < 3 && st == TET_OK; c++)
    if (o[c] == 0 && !is_corner(u, t[c]) && in_closed(f, t[c], u, s->axis[facet])) st = note_join(f, facet, t[c]);
  for (int c = 0; c < 3 && st == TET_OK; c++) {
    int d = (c + 1) % 3;
    uint8_t flags = s->edge[3 * (size_t)i + (size_t)c];
    segment g = {{t[c], t[d]}, o[c], o[d], flags & TET_EDGE_FIXED, flags & TET_EDGE_BORDER,
                 TET_OFFENDER_FACET, s->facet[i]};
    st = segment_triangle(f, &g, j);
  }
  return st;
}

/* 1 if all corners of triangle i that are not corners of triangle j are strictly on one side of it. */
static int one_sided(const finder *f, uint32_t i, uint32_t j, int o[3]) {
  const uint32_t *t = f->s->tri + 3 * (size_t)i, *u = f->s->tri + 3 * (size_t)j;
  int above = 0, below = 0, on = 0;
  for (int c = 0; c < 3; c++) {
    o[c] = 0;
    if (is_corner(u, t[c])) continue;
    o[c] = side_of(f, j, t[c]);
    above += o[c] > 0;
    below += o[c] < 0;
    on += o[c] == 0;
  }
  return on == 0 && (above == 0 || below == 0);
}

/* Two triangles with a common edge: an inner edge of both facets means that these
 * cross there; in one plane on one side they overlap. */
static tet_status edge_neighbours(finder *f, uint32_t i, uint32_t j, int coplanar) {
  const tet_soup *s = f->s;
  const uint32_t *t = s->tri + 3 * (size_t)i, *u = s->tri + 3 * (size_t)j;
  double place[3];
  if (coplanar) return coplanar_triangles(f, i, j);
  for (int c = 0; c < 3; c++)
    for (int d = 0; d < 3; d++) {
      uint32_t a = t[c], b = t[(c + 1) % 3], p = u[d], q = u[(d + 1) % 3];
      if (!((a == p && b == q) || (a == q && b == p))) continue;
      if (s->edge[3 * (size_t)i + (size_t)c] || s->edge[3 * (size_t)j + (size_t)d]) return TET_OK;
      for (int k = 0; k < 3; k++) place[k] = 0.5 * tet_soup_x(s, a)[k] + 0.5 * tet_soup_x(s, b)[k];
      return note_fault(f, TET_OFFENDER_FACET, s->facet[i], TET_OFFENDER_FACET, s->facet[j], NULL, place);
    }
  return TET_OK;
}

static tet_status triangle_triangle(finder *f, uint32_t i, uint32_t j) {
  const tet_soup *s = f->s;
  if (s->facet[i] == s->facet[j]) return TET_OK;
  const uint32_t *t = s->tri + 3 * (size_t)i, *u = s->tri + 3 * (size_t)j;
  int shared = is_corner(u, t[0]) + is_corner(u, t[1]) + is_corner(u, t[2]);
  int o[3], w[3];
  double place[3];
  if (shared == 3) {
    middle_place(f, t, place);
    return note_fault(f, TET_OFFENDER_FACET, s->facet[i], TET_OFFENDER_FACET, s->facet[j], "overlap", place);
  }
  int clear = one_sided(f, i, j, o);
  if (shared == 2) return edge_neighbours(f, i, j, !clear);
  if (clear) return TET_OK;
  if (o[0] == 0 && o[1] == 0 && o[2] == 0) return coplanar_triangles(f, i, j);
  if (one_sided(f, j, i, w)) return TET_OK;
  tet_status st = half_pair(f, i, o, j);
  return st == TET_OK ? half_pair(f, j, w, i) : st;
}

/* Vertex v strictly between the ends of e, on it? */
static int on_segment(const finder *f, ends e, uint32_t v) {
  if (v == e.a || v == e.b || !tet_collinear(f->points, e.a, e.b, v)) return 0;
  const double *a = tet_soup_x(f->s, e.a), *b = tet_soup_x(f->s, e.b), *x = tet_soup_x(f->s, v);
  for (int k = 0; k < 3; k++) {
    if (a[k] < b[k]) return a[k] < x[k] && x[k] < b[k];
    if (a[k] > b[k]) return b[k] < x[k] && x[k] < a[k];
  }
  return 0;
}

static segment piece_segment(const tet_soup *s, uint32_t p) {
  const tet_piece *q = &s->piece[p];
  int of_facet = q->segment == TET_NONE;
  return (segment){{q->a, q->b}, 0, 0, 1, 1, of_facet ? TET_OFFENDER_FACET : TET_OFFENDER_SEGMENT,
                   of_facet ? q->facet : q->segment};
}

static tet_status triangle_piece(finder *f, uint32_t tri, uint32_t p) {
  const tet_soup *s = f->s;
  const uint32_t *t = s->tri + 3 * (size_t)tri;
  segment g = piece_segment(s, p);
  tet_status st = TET_OK;
  if (is_corner(t, g.e.a) && is_corner(t, g.e.b)) return TET_OK;
  g.sa = is_corner(t, g.e.a) ? 0 : side_of(f, tri, g.e.a);
  g.sb = is_corner(t, g.e.b) ? 0 : side_of(f, tri, g.e.b);
  if (g.sa * g.sb > 0) return TET_OK;
  for (int c = 0; c < 3 && st == TET_OK; c++)
    if (on_segment(f, g.e, t[c])) st = note_split(f, p, t[c]);
  const uint32_t end[2] = {g.e.a, g.e.b};
  for (int k = 0; k < 2 && st == TET_OK; k++) {
    if ((k == 0 ? g.sa : g.sb) != 0 || is_corner(t, end[k])) continue;
    if (in_closed(f, end[k], t, s->axis[s->facet[tri]])) st = note_join(f, s->facet[tri], end[k]);
  }
  return st == TET_OK ? segment_triangle(f, &g, tri) : st;
}

static tet_status triangle_point(finder *f, uint32_t tri, uint32_t v) {
  const tet_soup *s = f->s;
  const uint32_t *t = s->tri + 3 * (size_t)tri;
  if (is_corner(t, v) || side_of(f, tri, v) != 0) return TET_OK;
  return in_closed(f, v, t, s->axis[s->facet[tri]]) ? note_join(f, s->facet[tri], v) : TET_OK;
}

/* Do pq and rs, without a common end, cross in a point inside both? */
static int segments_cross(const finder *f, ends g, ends h) {
  if (tet_orient3d(f->points, g.a, g.b, h.a, h.b) != 0) return 0;
  for (int axis = 0; axis < 3; axis++) {
    int s1 = tet_orient2d(f->points, axis, g.a, g.b, h.a), s2 = tet_orient2d(f->points, axis, g.a, g.b, h.b);
    if (s1 == 0 && s2 == 0) continue;
    int s3 = tet_orient2d(f->points, axis, h.a, h.b, g.a), s4 = tet_orient2d(f->points, axis, h.a, h.b, g.b);
    return s1 * s2 < 0 && s3 * s4 < 0;
  }
  return 0;
}

static tet_status piece_piece(finder *f, uint32_t p, uint32_t q) {
  segment g = piece_segment(f->s, p), h = piece_segment(f->s, q);
  tet_status st = TET_OK;
  if (on_segment(f, g.e, h.e.a)) st = note_split(f, p, h.e.a);
  if (st == TET_OK && on_segment(f, g.e, h.e.b)) st = note_split(f, p, h.e.b);
  if (st == TET_OK && on_segment(f, h.e, g.e.a)) st = note_split(f, q, g.e.a);
  if (st == TET_OK && on_segment(f, h.e, g.e.b)) st = note_split(f, q, g.e.b);
  if (st != TET_OK || g.e.a == h.e.a || g.e.a == h.e.b || g.e.b == h.e.a || g.e.b == h.e.b) return st;
  if (!segments_cross(f, g.e, h.e)) return TET_OK;
  double place[3];
  for (int k = 0; k < 3; k++) place[k] = 0.5 * tet_soup_x(f->s, g.e.a)[k] + 0.5 * tet_soup_x(f->s, g.e.b)[k];
  return note_fault(f, g.kind, g.owner, h.kind, h.owner, NULL, place);
}

static tet_status test_pair(void *user, uint32_t i, uint32_t j) {
  finder *f = user;
  const tet_soup *s = f->s;
  uint32_t pieces = s->n_tris, points = s->n_tris + s->n_pieces;
  if (i >= points) return TET_OK; /* two points never coincide */
  if (i >= pieces) {
    if (j < points) return piece_piece(f, i - pieces, j - pieces);
    const tet_piece *p = &s->piece[i - pieces];
    uint32_t v = s->loose[j - points];
    return on_segment(f, (ends){p->a, p->b}, v) ? note_split(f, i - pieces, v) : TET_OK;
  }
  if (j < pieces) return triangle_triangle(f, i, j);
  return j < points ? triangle_piece(f, i, j - pieces) : triangle_point(f, i, s->loose[j - points]);
}

/* The vertices of item i, the last one again where there are fewer than three. */
static void corners_of(void *user, uint32_t i, const double *ret_x[3]) {
  const tet_soup *s = ((const finder *)user)->s;
  uint32_t v[3], pieces = s->n_tris, points = s->n_tris + s->n_pieces;
  for (int k = 0; k < 3; k++) {
    if (i < pieces) v[k] = s->tri[3 * (size_t)i + (size_t)k];
    else if (i < points) v[k] = k ? s->piece[i - pieces].b : s->piece[i - pieces].a;
    else v[k] = s->loose[i - points];
    ret_x[k] = tet_soup_x(s, v[k]);
  }
}

static tet_box box_of(const tet_soup *s, const uint32_t *v, int n) {
  tet_box b;
  for (int k = 0; k < 3; k++) {
    b.lo[k] = b.hi[k] = tet_soup_x(s, v[0])[k];
    for (int c = 1; c < n; c++) {
      double x = tet_soup_x(s, v[c])[k];
      if (x < b.lo[k]) b.lo[k] = x;
      if (x > b.hi[k]) b.hi[k] = x;
    }
  }
  return b;
}

tet_status tet_find_intersections(tet_soup *s) {
  finder f = {s, s->points, NULL};
  uint64_t n = (uint64_t)s->n_tris + s->n_pieces + s->n_loose, k = 0;
  s->n_new_joins = s->n_splits = s->n_new_constraints = 0;
  if (n >= TET_NONE) return tet_fail(s->ctx, TET_E_TOO_LARGE, "%llu triangles and segments", (unsigned long long)n);
  tet_box *box = tet_alloc(s->ctx, n, sizeof *box);
  f.plane = tet_alloc(s->ctx, s->n_tris, sizeof *f.plane);
  if (!box || !f.plane) {
    tet_free(s->ctx, box);
    tet_free(s->ctx, f.plane);
    return tet_ctx_error(s->ctx)->status;
  }
  for (uint32_t t = 0; t < s->n_tris; t++) {
    const uint32_t *v = s->tri + 3 * (size_t)t;
    f.plane[t] = tet_quick_plane_of(tet_soup_x(s, v[0]), tet_soup_x(s, v[1]), tet_soup_x(s, v[2]));
    box[k++] = box_of(s, v, 3);
  }
  for (uint32_t p = 0; p < s->n_pieces; p++) {
    const uint32_t v[2] = {s->piece[p].a, s->piece[p].b};
    box[k++] = box_of(s, v, 2);
  }
  for (uint32_t p = 0; p < s->n_loose; p++) box[k++] = box_of(s, &s->loose[p], 1);
  tet_status st = tet_box_pairs(s->ctx, box, (uint32_t)n, corners_of, test_pair, &f);
  tet_free(s->ctx, box);
  tet_free(s->ctx, f.plane);
  return st;
}
