// SPDX-License-Identifier: Apache-2.0
/* segments.c: SEGMENTRECOVERY of thesis 5.3, its three splitting rules and acute
 * vertices; reference points by walking along the segment (A.3.3).
 *
 * Where a Steiner point goes is chosen in doubles; it then is the exact point
 * a + t (b - a) of its segment, and whether a segment is missing is never a
 * question of rounding. */
#include "build/state.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "build/rim.h"
#include "exact/predicates.h"
#include "mesh/edge_map.h"

#define BOTH_ACUTE TET_GHOST

/* Of a subsegment. What is no edge of a Delaunay tetrahedralization does not become one by more vertices: ABSENT
 * lasts. Neither of the two: it is to be looked for. */
enum { QUEUED = 1, PRESENT = 2, ABSENT = 4 };

/* Segments are beside each other when the cosine between them is larger. */
static const double BESIDE = 0.5;
/* How far off level a point is put, as part of what would make the other point encroach: so
 * level points are not cospherical, which rounding could not keep. */
static const double OFF_LEVEL = 0.05;
/* How far off every point is put where rounding failed, as part of the way to an end, and how
 * much farther every other time: the ties of a symmetric input are gone then, and that
 * points stand beside each other is not. */
static const double ELSEWHERE = 0x1p-42, FARTHER = 8;
/* Nearer to an end of the subsegment than this part of the distance to the other point, a level
 * point would be of no use. */
static const double NEAR_END = 0.1;
/* Steiner points of two segments that are nearer to each other than this part of the largest coordinate, a
 * hundredth of what rounding moves them, are not told apart by doubles. */
static const double APART = 0x1p-60;
/* How far a point may be moved so that rounding moves it less, as part of the way to an end. */
static const double NUDGE = 0.5;

typedef struct recovery {
  tet_state *st;
  tet_ctx *ctx;
  tet_edge_map edges;  /* subsegments by their ends */
  uint64_t *mask;      /* [vertices] the bits of the other ends of its subsegments, and of some that were */
  size_t cap_mask;
  uint32_t *acute;     /* [subsegments] R: the acute end, TET_NONE (type-0), BOTH_ACUTE */
  uint8_t *state;      /* [subsegments] QUEUED, PRESENT, ABSENT */
  size_t cap_acute, cap_state;
  uint32_t *queue;     /* a ring */
  size_t cap_queue, head, n_queue;
  tet_rim rim;         /* of the last cavity */
} recovery;

static const double *at(const recovery *r, uint32_t v) { return r->st->points.x + 3 * (size_t)v; }

static double distance(const double *a, const double *b) {
  return sqrt(tet_distance2(a, b));
}

static tet_status enqueue(recovery *r, uint32_t e) {
  if (r->state[e] & QUEUED) return TET_OK;
  if (r->n_queue == r->cap_queue) {
    size_t old = r->cap_queue;
    tet_status status = tet_grow(r->ctx, &r->queue, &r->cap_queue, old + 1, sizeof *r->queue);
    if (status != TET_OK) return status;
    /* unroll the ring's wrapped part into the new room */
    size_t moved = r->cap_queue - old;
    memmove(r->queue + r->head + moved, r->queue + r->head, (old - r->head) * sizeof *r->queue);
    r->head += moved;
    if (r->head == r->cap_queue) r->head = 0;
  }
  r->queue[(r->head + r->n_queue++) % r->cap_queue] = e;
  r->state[e] |= QUEUED;
  return TET_OK;
}

/* Room for the per-subsegment and per-vertex arrays. */
static tet_status make_room(recovery *r) {
  size_t n = r->st->surface.n_subsegs, from = r->cap_mask;
  tet_status status = tet_grow(r->ctx, &r->acute, &r->cap_acute, n, sizeof *r->acute);
  if (status == TET_OK) status = tet_grow(r->ctx, &r->state, &r->cap_state, n, 1);
  if (status == TET_OK) status = tet_grow(r->ctx, &r->mask, &r->cap_mask, r->st->points.n, sizeof *r->mask);
  if (status == TET_OK && r->cap_mask > from) memset(r->mask + from, 0, (r->cap_mask - from) * sizeof *r->mask);
  return status == TET_OK ? tet_rim_reserve(r->ctx, &r->rim, r->st->points.n) : status;
}

/* Enters subsegment e, with ends a and b, where it is looked up. */
static tet_status enter(recovery *r, uint32_t a, uint32_t b, uint32_t e) {
  r->mask[a] |= tet_vertex_bit(b);
  r->mask[b] |= tet_vertex_bit(a);
  return tet_edge_map_put(r->ctx, &r->edges, a, b, e);
}

/* The subsegment with ends a and b, or TET_NONE: mostly told by one bit. */
static inline uint32_t look_up(const recovery *r, uint32_t a, uint32_t b) {
  return r->mask[a] & tet_vertex_bit(b) ? tet_edge_map_get(&r->edges, a, b) : TET_NONE;
}

/* Marks vertices where two segments meet at less than 90 degrees (5.3.1).
 * `start`/`ends`: the other ends of the segments at each vertex, as CSR. */
static void mark_acute(const recovery *r, const uint32_t *start, const uint32_t *ends, uint8_t *acute) {
  for (uint32_t v = 0; v < r->st->n_input; v++)
    for (uint32_t i = start[v]; i < start[v + 1] && !acute[v]; i++)
      for (uint32_t k = i + 1; k < start[v + 1] && !acute[v]; k++)
        acute[v] = tet_dot_sign(&r->st->points, ends[i], ends[k], v) > 0;
}

static tet_status find_acute(recovery *r) {
  const tet_surface *s = &r->st->surface;
  uint32_t n = r->st->n_input;
  uint32_t *start = tet_calloc(r->ctx, (size_t)n + 2, sizeof *start);
  uint32_t *ends = tet_alloc(r->ctx, 2 * (size_t)s->n_segments, sizeof *ends);
  uint8_t *acute = tet_calloc(r->ctx, n, 1);
  if (start && ends && acute) {
    for (uint32_t e = 0; e < s->n_segments; e++) {
      start[s->segment[e].a + 2]++;
      start[s->segment[e].b + 2]++;
    }
    for (uint32_t v = 2; v < n + 2; v++) start[v] += start[v - 1];
    for (uint32_t e = 0; e < s->n_segments; e++) {
      ends[start[s->segment[e].a + 1]++] = s->segment[e].b;
      ends[start[s->segment[e].b + 1]++] = s->segment[e].a;
    }
    mark_acute(r, start, ends, acute);
    for (uint32_t e = 0; e < s->n_subsegs; e++) {
      const tet_segment *g = &s->segment[s->subseg_segment[e]];
      const uint32_t *v = s->subseg + 2 * (size_t)e;
      r->acute[e] = acute[g->a] ? (acute[g->b] ? BOTH_ACUTE : g->a) : acute[g->b] ? g->b : TET_NONE;
      if (r->acute[e] == BOTH_ACUTE && (v[0] != g->a || v[1] != g->b)) r->acute[e] = v[0] == g->a ? g->a : g->b; /* split */
    }
  }
  tet_status status = start && ends && acute ? TET_OK : tet_ctx_error(r->ctx)->status;
  tet_free(r->ctx, start);
  tet_free(r->ctx, ends);
  tet_free(r->ctx, acute);
  return status;
}

/* Keeps in *best the vertex p that sees ab under the largest angle above 90
 * degrees: its triangle with ab has the largest circumball (5.3.1 (ii)). */
static void consider(const recovery *r, uint32_t a, uint32_t b, uint32_t p, uint32_t *best, double *best_cos) {
  const double *x = at(r, p), *xa = at(r, a), *xb = at(r, b);
  double dot = 0;
  for (int i = 0; i < 3; i++) dot += (xa[i] - x[i]) * (xb[i] - x[i]);
  double length = distance(x, xa) * distance(x, xb);
  if (length > 0 && dot / length < *best_cos) {
    *best_cos = dot / length;
    *best = p;
  }
}

/* In the star of a: the face opposite a that the ray ab leaves through, its
 * vertices in f so that (a, f0, f1, f2) is positive. Returns its handle. */
static uint32_t first_face(const recovery *r, uint32_t a, uint32_t b, uint32_t f[3]) {
  const tet_complex *c = &r->st->complex;
  const tet_points *p = c->points;
  for (size_t k = 0; k < c->n_made; k++) {
    uint32_t t = c->made[k];
    if (tet_is_ghost(c, t)) continue;
    int i = tet_index_of(c, t, a);
    for (int j = 0; j < 3; j++) f[j] = c->v[4 * (size_t)t + tet_face[i][j]];
    if (tet_orient3d(p, a, b, f[1], f[2]) >= 0 && tet_orient3d(p, a, f[0], b, f[2]) >= 0 &&
        tet_orient3d(p, a, f[0], f[1], b) >= 0)
      return 4 * t + (uint32_t)i;
  }
  return TET_NONE;
}

/* The reference point of missing subsegment ab: the best vertex of the
 * tetrahedra along it, or TET_NONE. */
static tet_status reference_point(recovery *r, uint32_t a, uint32_t b, uint32_t *ret_p) {
  tet_complex *c = &r->st->complex;
  uint32_t best = TET_NONE, f[3];
  double best_cos = 0;
  tet_status status = tet_complex_star(c, a);
  if (status != TET_OK) return status;
  uint32_t h = first_face(r, a, b, f);
  if (h == TET_NONE) return tet_internal(r->ctx, "a segment leaves no tetrahedron of its end");
  for (int j = 0; j < 3; j++) consider(r, a, b, f[j], &best, &best_cos);
  for (uint32_t steps = 0; steps < c->n_live; steps++) {
    uint32_t g = c->adj[h], t = g >> 2, w = c->v[g];
    if (w == TET_GHOST || w == b || tet_is_ghost(c, t)) break;
    consider(r, a, b, w, &best, &best_cos);
    int side[3], k = 0;
    for (int j = 0; j < 3; j++) side[j] = tet_orient3d(c->points, a, b, f[j], w);
    while (k < 3 && !(side[k] <= 0 && side[(k + 1) % 3] >= 0)) k++;
    if (k == 3) break;
    h = 4 * t + (uint32_t)tet_index_of(c, t, f[(k + 2) % 3]);
    f[(k + 2) % 3] = w;
  }
  *ret_p = best;
  return TET_OK;
}

/* Rules 2 and 3 of 5.3.1: the distance from the acute end at which to split the
 * subsegment whose ends lie at distances near < far; p: the reference point. */
static double acute_split(const double *end, const double *direction, double near, double far, const double *p) {
  double v[3], rest = distance(end, p), gap;
  if (rest > near && rest < far) {
    for (int i = 0; i < 3; i++) v[i] = end[i] + rest * direction[i];
    gap = distance(v, p);
    if (far - rest >= gap) return rest;               /* rule 2 */
    if (gap < 0.5 * (rest - near)) return rest - gap; /* rule 3 */
    return near + 0.5 * (rest - near);
  }
  return 0.5 * (near + far);
}

/* The segment that p is a Steiner point of, or NULL. */
static const tet_segment *segment_of(const recovery *r, uint32_t p) {
  const tet_state *st = r->st;
  if (p == TET_NONE || p < st->n_input || st->carrier[p - st->n_input].origin != TET_ORIGIN_SEGMENT) return NULL;
  return &st->surface.segment[st->carrier[p - st->n_input].number];
}

/* How far Steiner point p of segment h is from the line of segment g, in doubles; from their common end, if there is
 * one, as near to it p's own place says nothing. */
static double distance_to_line(const recovery *r, const tet_segment *g, const tet_segment *h, uint32_t p) {
  int at_a = h->a == g->a || h->a == g->b, at_b = h->b == g->a || h->b == g->b;
  double u[3], w[3], n[3], share = 1;
  tet_minus(at(r, g->b), at(r, g->a), u);
  tet_minus(at(r, p), at(r, g->a), w);
  if (at_a || at_b) {
    double t = tet_place_on(&r->st->points, h, p);
    tet_minus(at(r, h->b), at(r, h->a), w);
    share = at_a ? t : 1 - t;
  }
  tet_cross(u, w, n);
  return share * sqrt(tet_dot(n, n) / tet_dot(u, u));
}

/* Whether doubles can part what Steiner points subsegment e and p's segment need. Where not, and were they exact, each
 * would be encroached by another's next point, a little off level, without an end that matters. */
static tet_status check_apart(const recovery *r, uint32_t e, uint32_t p) {
  const tet_segment *g = &r->st->surface.segment[r->st->surface.subseg_segment[e]], *h = segment_of(r, p);
  if (!h || distance_to_line(r, g, h, p) >= APART * r->st->points.max_abs) return TET_OK;
  const double *x = at(r, p);
  return tet_fail(r->ctx, TET_E_ROUNDING,
                  "the segments between vertices %u and %u and between %u and %u would need points closer than doubles are, "
                  "near (%.17g, %.17g, %.17g)", g->a, g->b, h->a, h->b, x[0], x[1], x[2]);
}

/* In [-1, 1), by the number of the vertex to come. */
static double scatter(const recovery *r) {
  return (double)((r->st->points.n + 0x9E3779B9u * r->st->attempt) * 2654435761u) * 0x1p-31 - 1;
}

/* The place on segment g level with Steiner point p of another segment that runs beside
 * it, as t, for a subsegment of it between lo and hi; NaN where p is no such point. Level: in
 * one plane across the bisector of the two lines, which is the sphere of rule 2 where they
 * share an end. So p is level with what is level with it; by the other rules, each point of a
 * bundle of close segments would ask for one a little farther on the next. Where there is a
 * vertex level with p already, lines that cross beyond it are the reason: the middle. */
static double level_place(const recovery *r, const tet_segment *g, double lo, double hi, uint32_t p) {
  const tet_segment *h = segment_of(r, p);
  if (!h) return NAN;
  double u[3], w[3], to_p[3], across[3], apart = 0;
  tet_minus(at(r, g->b), at(r, g->a), u);
  tet_minus(at(r, h->b), at(r, h->a), w);
  tet_minus(at(r, p), at(r, g->a), to_p);
  double length = sqrt(tet_dot(u, u)), other = sqrt(tet_dot(w, w)), cosine = tet_dot(u, w) / (length * other);
  if (!(fabs(cosine) > BESIDE)) return NAN;
  for (int k = 0; k < 3; k++) across[k] = u[k] / length + (cosine < 0 ? -w[k] : w[k]) / other;
  double t = tet_dot(to_p, across) / tet_dot(u, across);
  for (int k = 0; k < 3; k++) apart += (to_p[k] - t * u[k]) * (to_p[k] - t * u[k]);
  apart = sqrt(apart) / length;
  if (fmin(t - lo, hi - t) < NEAR_END * apart) return t > lo && t < hi ? 0.5 * (lo + hi) : NAN;
  return t + scatter(r) * OFF_LEVEL * apart * apart / (hi - lo);
}

/* The place by the rules of 5.3.1 on subsegment e between ti and tj of segment g. */
static double ruled_place(const recovery *r, uint32_t e, const tet_segment *g, double ti, double tj, uint32_t p) {
  double length = distance(at(r, g->a), at(r, g->b));
  if (r->acute[e] == TET_NONE) { /* rule 1 */
    const uint32_t *v = r->st->surface.subseg + 2 * (size_t)e;
    double half = 0.5 * (tj - ti) * length, di = distance(at(r, v[0]), at(r, p)), dj = distance(at(r, v[1]), at(r, p));
    return di < half ? ti + di / length : dj < half ? tj - dj / length : 0.5 * (ti + tj);
  }
  int back = r->acute[e] == g->b;
  const double *end = at(r, back ? g->b : g->a), *other = at(r, back ? g->a : g->b);
  double direction[3], near = back ? 1 - tj : ti, far = back ? 1 - ti : tj;
  for (int k = 0; k < 3; k++) direction[k] = (other[k] - end[k]) / length;
  double u = acute_split(end, direction, near * length, far * length, at(r, p)) / length;
  return back ? 1 - u : u;
}

/* Where to split subsegment e for reference point p, as t on its segment. */
static double split_place(const recovery *r, uint32_t e, uint32_t p) {
  const tet_surface *s = &r->st->surface;
  const tet_segment *g = &s->segment[s->subseg_segment[e]];
  const tet_points *points = &r->st->points;
  const uint32_t *v = s->subseg + 2 * (size_t)e;
  double ti = tet_place_on(points, g, v[0]), tj = tet_place_on(points, g, v[1]), middle = ti + 0.5 * (tj - ti);
  double t = level_place(r, g, ti, tj, p), least = tet_state_least(r->st, g->a, g->b);
  if (!(t > ti && t < tj)) t = p == TET_NONE || r->acute[e] == BOTH_ACUTE ? middle : ruled_place(r, e, g, ti, tj, p);
  if (!(t - ti > least && tj - t > least)) t = middle;
  double off = r->st->attempt ? ELSEWHERE * scatter(r) * fmin(t - ti, tj - t) : 0;
  for (uint32_t k = 1; k < r->st->attempt; k++) off *= FARTHER;
  t += off;
  return tet_state_fine_place(r->st, g->a, g->b, t, NUDGE * fmin(t - ti, tj - t));
}

/* What is to be noted of a subsegment that is an edge or not, if that is known. */
static uint8_t state_of(int known, int is_edge) { return known ? is_edge ? PRESENT : ABSENT : 0; }

/* Looks for subsegments among the edges of the cavity just filled, by its rim if that is known: those that are not on
 * its border are no edges any more. */
static tet_status requeue_cavity(recovery *r, int known) {
  const tet_complex *c = &r->st->complex;
  tet_status status = TET_OK;
  for (size_t k = 0; k < c->n_cavity && status == TET_OK; k++) {
    const uint32_t *v = c->old[k];
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4 && status == TET_OK; j++) {
        uint32_t e = v[i] == TET_GHOST || v[j] == TET_GHOST ? TET_NONE : look_up(r, v[i], v[j]);
        if (e == TET_NONE) continue;
        r->state[e] = (uint8_t)((r->state[e] & QUEUED) | state_of(known, tet_rim_has(&r->rim, v[i], v[j])));
        status = enqueue(r, e);
      }
  }
  return status;
}

/* Splits subsegment e at t of its segment: a Steiner point in the complex and the
 * surface. */
static tet_status split_at(recovery *r, uint32_t e, double t) {
  tet_state *st = r->st;
  tet_surface *s = &st->surface;
  uint32_t a = s->subseg[2 * (size_t)e], b = s->subseg[2 * (size_t)e + 1], v;
  uint32_t acute = r->acute[e];
  tet_status status = tet_state_split(st, e, t, &v);
  if (status == TET_OK) status = make_room(r);
  if (status != TET_OK) return status;
  uint32_t other = s->n_subsegs - 1; /* now e is a-v and other v-b */
  const tet_segment *g = &s->segment[s->subseg_segment[e]];
  r->acute[e] = acute == BOTH_ACUTE ? g->a : acute;
  r->acute[other] = acute == BOTH_ACUTE ? g->b : acute;
  int known = tet_rim_find(&r->rim, &st->complex);
  r->state[e] = state_of(known, tet_rim_holds(&r->rim, a));
  r->state[other] = state_of(known, tet_rim_holds(&r->rim, b));
  tet_edge_map_remove(&r->edges, a, b);
  status = enter(r, a, v, e);
  if (status == TET_OK) status = enter(r, v, b, other);
  if (status == TET_OK) status = requeue_cavity(r, known);
  if (status == TET_OK) status = enqueue(r, e);
  if (status == TET_OK) status = enqueue(r, other);
  return status;
}

/* Splits missing subsegment e by the rules of 5.3.1. */
static tet_status split(recovery *r, uint32_t e) {
  const uint32_t *v = r->st->surface.subseg + 2 * (size_t)e;
  uint32_t p = TET_NONE;
  tet_status status = reference_point(r, v[0], v[1], &p);
  if (status == TET_OK) status = check_apart(r, e, p);
  return status == TET_OK ? split_at(r, e, split_place(r, e, p)) : status;
}

/* Marks the subsegments that are sides of triangles that are faces: most of those that are not missing. */
static tet_status mark_present(recovery *r) {
  const tet_surface *s = &r->st->surface;
  uint32_t *face = NULL;
  tet_status status = tet_match_triangles(r->st, &face);
  for (size_t i = 0; i < 3 * (size_t)s->n_tris && status == TET_OK; i++)
    if (face[i / 3] != TET_NONE && s->tri_seg[i] != TET_NONE) r->state[s->tri_seg[i]] |= PRESENT;
  tet_free(r->ctx, face);
  return status;
}

static tet_status recover(recovery *r) {
  tet_surface *s = &r->st->surface;
  uint64_t splits = 0;
  tet_status status = TET_OK;
  while (r->n_queue && status == TET_OK) {
    uint32_t e = r->queue[r->head], t = TET_NONE;
    int known = r->state[e] & (PRESENT | ABSENT);
    r->head = (r->head + 1) % r->cap_queue;
    r->n_queue--;
    r->state[e] = (uint8_t)known;
    if (!known)
      status = tet_complex_find_edge(&r->st->complex, s->subseg[2 * (size_t)e], s->subseg[2 * (size_t)e + 1], &t);
    if (status == TET_OK && t == TET_NONE && known != PRESENT) {
      splits++;
      const tet_segment *g = &s->segment[s->subseg_segment[e]];
      r->st->counts.missing_segments += s->subseg[2 * (size_t)e] == g->a && s->subseg[2 * (size_t)e + 1] == g->b;
      status = split(r, e);
    }
    if (status == TET_OK) status = tet_poll(r->ctx);
    tet_progress_report(r->ctx, -1.0, r->st->points.n, r->st->complex.n_live, splits);
  }
  r->st->counts.segment_steiner_points += splits;
  return status;
}

tet_status tet_recover_segments(tet_state *st) {
  recovery r = {.st = st, .ctx = st->ctx};
  tet_surface *s = &st->surface;
  tet_status status = make_room(&r);
  st->complex.keep_old = 1;
  if (status == TET_OK) status = find_acute(&r);
  for (uint32_t e = 0; e < s->n_subsegs && status == TET_OK; e++) {
    const uint32_t *v = s->subseg + 2 * (size_t)e;
    r.state[e] = 0;
    status = enter(&r, v[0], v[1], e);
    if (status == TET_OK) status = enqueue(&r, e);
  }
  if (status == TET_OK) status = mark_present(&r);
  if (status == TET_OK) status = recover(&r);
  st->complex.keep_old = 0;
  tet_edge_map_free(r.ctx, &r.edges);
  tet_free(r.ctx, r.mask);
  tet_rim_free(r.ctx, &r.rim);
  tet_free(r.ctx, r.acute);
  tet_free(r.ctx, r.state);
  tet_free(r.ctx, r.queue);
  return status;
}
