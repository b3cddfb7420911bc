// SPDX-License-Identifier: Apache-2.0
/* degeneracies.c: LOCALDEGENERACYREMOVAL of thesis 5.5 (Fig. 5.17), by break points.
 *
 * A local degeneracy is a pair of triangles that share an edge inside a patch and whose four
 * vertices are exactly on one circle. A break point strictly inside that circle ends it. The
 * thesis's v_b = c + epsilon (c - v) is in the facet's plane only up to rounding; here v_b is near
 * the foot of c on a line of two input vertices in the plane, so exactly in it: a diagonal of the
 * four vertices or, where these are Steiner points, one between ends of their lines. It goes to the
 * middle of a segment that it would encroach upon. What is random comes from the vertices'
 * numbers. Where a break point goes is chosen in doubles; whether it breaks is then tested exactly. */
#include "base/triangle.h"
#include "build/cdt2d.h"
#include "build/state.h"

#include <string.h>

#include "exact/predicates.h"

/* A break point is not nearer to the ends of its line's part between the four vertices, or of its
 * subsegment, than this share of it, before it is moved by up to half of that at random. */
static const double MARGIN = 0.25;
/* A line that has less than this part of the longest diagonal between the four vertices will not do. */
static const double LEAST_PART = 0.125;
/* Break points that there may be for each degeneracy at the beginning, and besides. */
enum { MOST_EACH = 8, MOST_BESIDE = 64 };
/* The four vertices, and the ends of the lines that they are on. */
enum { MOST_ENDS = 8 };

typedef struct removal {
  tet_state *st;
  tet_ctx *ctx;
  uint32_t *queue;   /* triangles to look at, from head on */
  size_t head, n_queue, cap_queue;
  uint8_t *queued;   /* [triangles] */
  size_t cap_queued;
  uint32_t *cavity;  /* triangles whose circles hold the break point */
  size_t n_cavity, cap_cavity;
  uint32_t *mark;    /* [triangles] the last cavity that each was in */
  size_t cap_mark;
  uint32_t number;   /* of the last cavity */
  size_t tries;
} removal;

/* Two triangles: abc of edge h = ab, and bad. */
typedef struct quad {
  uint32_t h, v[4]; /* a, d, b, c: in turn */
  const tet_patch *patch;
  double x[4][3], centre[3]; /* from a */
  double longest;            /* diagonal */
} quad;

static const double *at(const removal *r, uint32_t v) { return r->st->points.x + 3 * (size_t)v; }

static int is_steiner(const removal *r, uint32_t v) { return v >= r->st->n_input; }

/* In [-1, 1), another one for each try. */
static double scatter(const removal *r, const uint32_t v[4]) {
  uint64_t h = r->tries + ((uint64_t)r->st->attempt << 32);
  for (int i = 0; i < 4; i++) {
    h = (h ^ v[i]) * 0x9E3779B97F4A7C15u;
    h = (h ^ h >> 29) * 0xBF58476D1CE4E5B9u;
    h ^= h >> 32;
  }
  return (double)(h >> 11) * 0x1p-52 - 1;
}

/* 1: the triangles at edge h are a local degeneracy. */
static int is_degenerate(const tet_state *st, uint32_t h) {
  const tet_surface *s = &st->surface;
  uint32_t g = s->tri_adj[h];
  if (g == TET_NONE) return 0;
  return tet_insphere(&st->points, s->tri[h], s->tri[tet_next3(h)], s->tri[tet_prev3(h)],
                      s->patch[s->tri_patch[h / 3]].off_plane, s->tri[tet_prev3(g)]) == 0;
}

static tet_status make_room(removal *r) {
  size_t n = r->st->surface.n_tris, queued = r->cap_queued, mark = r->cap_mark;
  tet_status status = tet_grow(r->ctx, &r->queued, &r->cap_queued, n, 1);
  if (status == TET_OK && r->cap_queued > queued) memset(r->queued + queued, 0, r->cap_queued - queued);
  if (status == TET_OK) status = tet_grow(r->ctx, &r->mark, &r->cap_mark, n, sizeof *r->mark);
  if (status == TET_OK && r->cap_mark > mark) memset(r->mark + mark, 0, (r->cap_mark - mark) * sizeof *r->mark);
  return status;
}

static tet_status enqueue(removal *r, uint32_t tri) {
  if (r->queued[tri]) return TET_OK;
  r->queued[tri] = 1;
  return tet_push(r->ctx, &r->queue, &r->n_queue, &r->cap_queue, tri);
}

/* Counts all degeneracies, and enqueues a triangle of each. */
static tet_status find_all(removal *r, uint64_t *ret_n) {
  const tet_surface *s = &r->st->surface;
  tet_status status = make_room(r);
  *ret_n = 0;
  for (uint32_t h = 0; h < 3 * s->n_tris && status == TET_OK; h++) {
    if (h % 1024 == 0) status = tet_poll(r->ctx);
    if (status != TET_OK || s->tri_adj[h] == TET_NONE || h > s->tri_adj[h] || !is_degenerate(r->st, h)) continue;
    ++*ret_n;
    status = enqueue(r, h / 3);
  }
  return status;
}

/* Enqueues the triangles of the origin of edge h, in its patch. */
static tet_status enqueue_fan(removal *r, uint32_t h) {
  const tet_surface *s = &r->st->surface;
  uint32_t k = h;
  tet_status status = TET_OK;
  do {
    status = enqueue(r, k / 3);
    k = s->tri_adj[tet_prev3(k)];
  } while (k != TET_NONE && k != h && status == TET_OK);
  for (k = h; k != TET_NONE && status == TET_OK; k = s->tri_adj[k] == TET_NONE ? TET_NONE : tet_next3(s->tri_adj[k])) {
    status = enqueue(r, k / 3);
    if (s->tri_adj[k] != TET_NONE && tet_next3(s->tri_adj[k]) == h) break;
  }
  return status;
}

static quad look_at(const removal *r, uint32_t h) {
  const tet_surface *s = &r->st->surface;
  uint32_t g = s->tri_adj[h];
  quad q = {h, {s->tri[h], s->tri[tet_prev3(g)], s->tri[tet_next3(h)], s->tri[tet_prev3(h)]},
            &s->patch[s->tri_patch[h / 3]], {{0}}, {0}, 0};
  for (int i = 0; i < 4; i++) tet_minus(at(r, q.v[i]), at(r, q.v[0]), q.x[i]);
  tet_triangle_centre(q.x[2], q.x[3], q.centre);
  q.longest = sqrt(fmax(tet_square(q.x[2]), tet_distance2(q.x[1], q.x[3])));
  return q;
}

/* The part of the way from p to p + d that is between the four vertices, in projection; 0: none. */
static int clip(const quad *q, const double p[3], const double d[3], double *lo, double *hi) {
  int i = (q->patch->axis + 1) % 3, j = (q->patch->axis + 2) % 3;
  *lo = 0, *hi = 1;
  for (int k = 0; k < 4; k++) {
    const double *a = q->x[k], *b = q->x[(k + 1) % 4];
    double from = (b[i] - a[i]) * (p[j] - a[j]) - (b[j] - a[j]) * (p[i] - a[i]);
    double slope = (b[i] - a[i]) * d[j] - (b[j] - a[j]) * d[i];
    if (slope > 0) *lo = fmax(*lo, -from / slope);
    if (slope < 0) *hi = fmin(*hi, -from / slope);
    if (slope == 0 && from < 0) return 0;
  }
  return *lo < *hi;
}

/* The input vertices that lines through the four vertices may begin at. */
static int find_ends(const removal *r, const quad *q, uint32_t end[MOST_ENDS]) {
  const tet_points *points = &r->st->points;
  int n = 0;
  for (int i = 0; i < 4; i++) {
    uint32_t pair[2] = {q->v[i], q->v[i]};
    if (is_steiner(r, q->v[i])) {
      const tet_segment_point *p = &points->implicit[q->v[i] - points->first_implicit];
      pair[0] = p->a, pair[1] = p->b;
    }
    for (int k = 0; k < 2; k++) {
      int j = 0;
      while (j < n && end[j] != pair[k]) j++;
      if (j == n && !tet_orient3d(points, q->v[0], q->v[2], q->v[3], pair[k])) end[n++] = pair[k];
    }
  }
  return n;
}

/* The place nearest to the centre of the circle, at random, on a line of input vertices. 0: there is none. */
static int find_place(const removal *r, const quad *q, tet_segment_point *ret) {
  uint32_t end[MOST_ENDS];
  int n = find_ends(r, q, end);
  double nearest = INFINITY, off = scatter(r, q->v);
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++) {
      double p[3], d[3], to_centre[3], lo, hi;
      tet_minus(at(r, end[i]), at(r, q->v[0]), p);
      tet_minus(at(r, end[j]), at(r, end[i]), d);
      if (!clip(q, p, d, &lo, &hi)) continue;
      double part = hi - lo, length2 = tet_square(d);
      if (!(part * sqrt(length2) > LEAST_PART * q->longest)) continue;
      tet_minus(q->centre, p, to_centre);
      double t = fmin(fmax(tet_dot(to_centre, d) / length2, lo + MARGIN * part), hi - MARGIN * part);
      t = tet_state_fine_place(r->st, end[i], end[j], t + 0.5 * MARGIN * off * part, 0.25 * MARGIN * part);
      for (int k = 0; k < 3; k++) p[k] += t * d[k];
      double away = tet_distance2(p, q->centre);
      if (!(away < nearest && t > 0 && t < 1)) continue;
      nearest = away;
      *ret = (tet_segment_point){end[i], end[j], t};
    }
  return nearest < INFINITY;
}

/* Is v in or on triangle h / 3? *ret_edge: the edge it is on, or TET_NONE. */
static int holds(const removal *r, uint32_t h, uint32_t v, uint32_t *ret_edge) {
  const tet_surface *s = &r->st->surface;
  int axis = s->patch[s->tri_patch[h / 3]].axis;
  *ret_edge = TET_NONE;
  for (uint32_t k = h - h % 3, i = 0; i < 3; i++) {
    int side = tet_orient2d(&r->st->points, axis, s->tri[k + i], s->tri[tet_next3(k + i)], v);
    if (side < 0) return 0;
    if (side == 0) *ret_edge = k + i;
  }
  return 1;
}

/* 1: v is inside the circle of triangle `tri`. */
static int is_in_circle(const removal *r, uint32_t tri, uint32_t v) {
  const tet_surface *s = &r->st->surface;
  const tet_patch *p = &s->patch[s->tri_patch[tri]];
  const uint32_t *c = s->tri + 3 * (size_t)tri;
  return tet_insphere_sos(&r->st->points, c[0], c[1], c[2], p->off_plane, v) * p->side > 0;
}

/* The cosine of the angle at v in triangle abv. */
static double angle_at(const removal *r, uint32_t v, uint32_t a, uint32_t b) {
  double u[3], w[3];
  tet_minus(at(r, a), at(r, v), u);
  tet_minus(at(r, b), at(r, v), w);
  return tet_dot(u, w) / sqrt(tet_square(u) * tet_square(w));
}

/* The subsegment that v, in triangle `tri`, encroaches upon most, of those beside the triangles that it
 * would replace; or TET_NONE. */
static tet_status find_encroached(removal *r, uint32_t tri, uint32_t v, uint32_t *ret_e) {
  const tet_surface *s = &r->st->surface;
  double best = INFINITY;
  r->number++;
  r->n_cavity = 0;
  *ret_e = TET_NONE;
  tet_status status = tet_push(r->ctx, &r->cavity, &r->n_cavity, &r->cap_cavity, tri);
  r->mark[tri] = r->number;
  for (size_t k = 0; k < r->n_cavity && status == TET_OK; k++)
    for (uint32_t h = 3 * r->cavity[k], i = 0; i < 3 && status == TET_OK; i++) {
      uint32_t a = s->tri[h + i], b = s->tri[tet_next3(h + i)], g = s->tri_adj[h + i];
      if (s->tri_seg[h + i] != TET_NONE) {
        if (tet_dot_sign(&r->st->points, a, b, v) >= 0) continue;
        double angle = angle_at(r, v, a, b);
        if (angle < best || *ret_e == TET_NONE) best = angle, *ret_e = s->tri_seg[h + i];
      } else if (r->mark[g / 3] != r->number && is_in_circle(r, g / 3, v)) {
        r->mark[g / 3] = r->number;
        status = tet_push(r->ctx, &r->cavity, &r->n_cavity, &r->cap_cavity, g / 3);
      }
    }
  return status;
}

/* Splits subsegment e at a share u of it. *ret_done: 1 unless the parts would be too short. */
static tet_status split(removal *r, uint32_t e, double u, int *ret_done) {
  tet_state *st = r->st;
  tet_surface *s = &st->surface;
  const tet_segment *g = &s->segment[s->subseg_segment[e]];
  double lo = tet_place_on(&st->points, g, s->subseg[2 * (size_t)e]), hi = tet_place_on(&st->points, g, s->subseg[2 * (size_t)e + 1]);
  double t = lo + u * (hi - lo), room = fmin(t - lo, hi - t);
  t = tet_state_fine_place(st, g->a, g->b, t, 0.5 * room);
  if (!(room > 4 * tet_state_least(st, g->a, g->b))) return TET_OK;
  uint32_t v;
  tet_status status = tet_state_split(st, e, t, &v);
  if (status == TET_OK) status = make_room(r);
  uint32_t part[2] = {e, s->n_subsegs - 1};
  for (int k = 0; k < 2 && status == TET_OK; k++) {
    uint32_t first = s->subseg_tri[part[k]];
    for (uint32_t h = first; h != TET_NONE && status == TET_OK; h = s->tri_ring[h] == first ? TET_NONE : s->tri_ring[h])
      status = enqueue_fan(r, s->tri[h] == v ? h : tet_next3(h));
  }
  *ret_done = 1;
  return status;
}

/* 1: v is strictly inside the common circle, and in one of the two triangles, and far enough from
 * their vertices. *ret_h: an edge of that one; with *ret_on_edge the edge of it that v is on. */
static int breaks(const removal *r, const quad *q, uint32_t v, uint32_t *ret_h, int *ret_on_edge) {
  const tet_surface *s = &r->st->surface;
  uint32_t edge;
  double least = 4 * TET_LEAST_GAP * r->st->points.max_abs;
  if (tet_insphere(&r->st->points, q->v[0], q->v[2], q->v[3], q->patch->off_plane, v) * q->patch->side <= 0) return 0;
  for (int i = 0; i < 4; i++)
    if (!(tet_distance2(at(r, v), at(r, q->v[i])) > least * least)) return 0;
  *ret_h = q->h;
  if (!holds(r, *ret_h, v, &edge)) {
    *ret_h = s->tri_adj[q->h];
    if (!holds(r, *ret_h, v, &edge)) return 0;
  }
  *ret_on_edge = edge != TET_NONE;
  if (*ret_on_edge) *ret_h = edge;
  return 1;
}

/* Where to split subsegment e that break point v encroaches upon, as a share of it: in the middle, and off it
 * by less than makes points of neighbouring long segments encroach upon each other. */
static double middle(const removal *r, const quad *q, uint32_t e, uint32_t v) {
  const uint32_t *end = r->st->surface.subseg + 2 * (size_t)e;
  double d[3], to_v[3], n[3];
  tet_minus(at(r, end[1]), at(r, end[0]), d);
  tet_minus(at(r, v), at(r, end[0]), to_v);
  tet_cross(d, to_v, n);
  double length2 = tet_square(d), slim = 4 * tet_square(n) / (length2 * length2);
  return 0.5 + 0.5 * MARGIN * fmin(1, slim) * scatter(r, q->v);
}

/* Adds a break point for the degeneracy at edge h. *ret_done: 1 unless there is no place for one. */
static tet_status break_up(removal *r, uint32_t h, int *ret_done) {
  tet_state *st = r->st;
  quad q = look_at(r, h);
  tet_steiner p = {.carrier = {TET_ORIGIN_FACET, q.patch->facet}};
  uint32_t v, e = TET_NONE, where = TET_NONE;
  int on_edge = 0;
  *ret_done = 0;
  r->tries++;
  if (!find_place(r, &q, &p.at)) return TET_OK;
  tet_status status = tet_state_add_steiner(st, &p, &v);
  if (status != TET_OK) return status;
  int good = breaks(r, &q, v, &where, &on_edge);
  if (good) status = find_encroached(r, where / 3, v, &e);
  if (status != TET_OK) return status;
  if (!good || e != TET_NONE) {
    double share = good ? middle(r, &q, e, v) : 0;
    st->points.n--;
    return good ? split(r, e, share, ret_done) : TET_OK;
  }
  *ret_done = 1;
  status = tet_complex_insert(&st->complex, v, st->complex.at[q.v[0]]);
  if (status == TET_OK) status = tet_surface_add(r->ctx, &st->surface, &st->points, where, on_edge, v);
  if (status == TET_OK) status = make_room(r);
  if (status != TET_OK) return status;
  uint32_t k = where - where % 3;
  for (int i = 0; i < 2; i++) k += st->surface.tri[k] != v;
  if (st->surface.tri[k] != v) return tet_internal(r->ctx, "a break point has left its triangle");
  return enqueue_fan(r, k);
}

/* Until the queue is empty or so many are added. */
static tet_status run(removal *r, uint64_t budget, size_t *ret_added) {
  tet_status status = TET_OK;
  while (r->head < r->n_queue && *ret_added < budget && status == TET_OK) {
    uint32_t tri = r->queue[r->head++];
    r->queued[tri] = 0;
    for (uint32_t h = 3 * tri; h < 3 * tri + 3 && *ret_added < budget && status == TET_OK; h++) {
      int done = 0;
      if (!is_degenerate(r->st, h)) continue;
      status = break_up(r, h, &done);
      *ret_added += (size_t)done;
      if (done && status == TET_OK) status = enqueue(r, tri); /* it may be degenerate still, or again */
      if (done) break;
    }
    if (status == TET_OK) status = tet_poll(r->ctx);
    tet_progress_report(r->ctx, -1.0, r->st->points.n, r->st->complex.n_live, *ret_added);
  }
  return status;
}

tet_status tet_remove_degeneracies(tet_state *st, int may_break, size_t *ret_added) {
  removal r = {.st = st, .ctx = st->ctx};
  uint64_t *left = &st->counts.degeneracies_left;
  *ret_added = 0;
  tet_status status = find_all(&r, left);
  if (status == TET_OK && may_break) status = run(&r, MOST_EACH * *left + MOST_BESIDE, ret_added);
  if (status == TET_OK && *ret_added) status = find_all(&r, left);
  st->counts.break_points += *ret_added;
  tet_free(st->ctx, r.queue);
  tet_free(st->ctx, r.queued);
  tet_free(st->ctx, r.cavity);
  tet_free(st->ctx, r.mark);
  return status;
}
