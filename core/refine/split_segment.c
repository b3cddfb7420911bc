// SPDX-License-Identifier: Apache-2.0
/* split_segment.c: rule R1, and the insertion that all three rules end with.
 *
 * A subsegment is halved, but where that would only move the trouble on: encroached
 * by a point of a segment that shares an input vertex with it, it is cut as far
 * from that vertex as the point is (5.3, the reference vertex), so that the two do
 * not encroach upon each other in turn, or where there is no danger of that about there, so that
 * fewest subsegments of the facets around are encroached next; by a point close beside it, right there,
 * so that nearly parallel segments are cut in pairs; by anything else, at a vertex
 * where segments meet below 60 degrees, on a shell about it, its radius a power of
 * two. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <float.h>
#include <math.h>

/* Retriangulates the grown cavity; *ret_ok = 0, nothing changed, if it cannot be
 * made visible without a loss. */
tet_status refine_insert(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  *ret_ok = 0;
  if (r->tracing) return TET_OK;
  tet_status status = refine_cavity_trim(r, ret_ok);
  if (!status && !*ret_ok && (c->segment != TET_NONE || c->sub != TET_NONE)) {
    uint32_t p = c->p, segment = c->segment, sub = c->sub;
    refine_cavity_clear(r);
    status = segment != TET_NONE ? refine_cavity_of_seg(r, p, segment, 1) : refine_cavity_of_sub(r, p, sub, 1);
    if (!status) status = refine_cavity_trim(r, ret_ok);
  }
  if (status || !*ret_ok) return status;
  status = refine_fill(r);
  for (uint32_t k = 0; k < c->n_made && !status; k++) status = refine_look_at(r, r->mesh.cavity[k]);
  for (uint32_t k = 0; k < 4 * c->n_made && c->reshaped && !status; k++) {
    uint32_t h = 4 * r->mesh.cavity[k / 4] + k % 4;
    if (r->mesh.v[h] == c->p || r->mesh.adj[h] > h) status = refine_push(r, &r->suspects, h);
  }
  return status ? status : refine_repair(r);
}

/* Counts the last point against the budget of thin facets. */
void refine_spend(refiner *r) {
  if (r->thin_points && refine_is_thin(r, r->points.n - 1)) r->thin_points--;
}

static double distance(const refiner *r, uint32_t a, uint32_t b) {
  return sqrt(tet_distance2(refine_x(r, a), refine_x(r, b)));
}

/* 1 if v is a Steiner point on another segment that ends at input vertex `end`. */
static int shares_end(const refiner *r, uint32_t v, uint32_t end) {
  if (r->out->origin[v] != TET_ORIGIN_SEGMENT) return 0;
  const tet_segment *s = &r->out->segment[r->out->carrier[v]];
  return s->a == end || s->b == end;
}

/* Where vertex v is along ab, and its squared distance from the line, in lengths of ab. */
static double along(const refiner *r, uint32_t a, uint32_t b, uint32_t v, double length, double *ret_height2) {
  const double *x = refine_x(r, a), *y = refine_x(r, b), *z = refine_x(r, v);
  double t = 0, height2 = 0;
  for (int i = 0; i < 3; i++) t += (y[i] - x[i]) * (z[i] - x[i]);
  t /= length * length;
  for (int i = 0; i < 3; i++) {
    double d = z[i] - x[i] - t * (y[i] - x[i]);
    height2 += d * d;
  }
  *ret_height2 = height2 / (length * length);
  return t;
}

/* Where beside subsegment ab vertex v is, as a fraction, if much closer to it than
 * to its ends; else 0. */
static double beside(const refiner *r, uint32_t a, uint32_t b, uint32_t v, double length) {
  double height2, t = along(r, a, b, v, length, &height2), arm = fmin(t, 1 - t);
  return 16 * height2 < arm * arm ? t : 0;
}

/* The edges of subfaces around subsegment e that are subsegments and would be encroached by a cut at t: of
 * each triangle one, that on whose side of the apex's foot the cut is not. */
static int n_spoilt(const refiner *r, uint32_t e, double t, double length) {
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1], h = r->seg_sub[e];
  int n = 0;
  do {
    uint32_t next = h - h % 3 + (h + 1) % 3, last = h - h % 3 + (h + 2) % 3;
    int is_forward = r->sub_v[h] == a;
    double height2, foot = along(r, a, b, r->sub_v[last], length, &height2);
    n += r->sub_seg[(t < foot) == is_forward ? last : next] != TET_NONE;
    h = r->ring[h];
  } while (h != r->seg_sub[e]);
  return n;
}

/* From low to high the cut that spoils least, of those the one nearest the middle. */
static double best_cut(const refiner *r, uint32_t e, double low, double high, double length) {
  static const double off = 0.005; /* the foot: there all but nothing decides which edge is spoilt */
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1], h = r->seg_sub[e];
  double best = fmin(fmax(0.5, low), high);
  if (h == TET_NONE) return best;
  int least = n_spoilt(r, e, best, length);
  do {
    double height2, foot = along(r, a, b, r->sub_v[h - h % 3 + (h + 2) % 3], length, &height2);
    for (int side = -1; side <= 1; side += 2) {
      double t = foot + side * off;
      int n = t > low && t < high ? n_spoilt(r, e, t, length) : least + 1;
      if (n > least || (n == least && fabs(t - 0.5) >= fabs(best - 0.5))) continue;
      least = n;
      best = t;
    }
    h = r->ring[h];
  } while (h != r->seg_sub[e]);
  return best;
}

/* Where subsegment e is cut, as a fraction from its end k, which is on the segment of vertex `by` too: as
 * far from it as `by`. At wide angles there is a choice, about there, among the cuts that free
 * both halves of `by`; but not close to the end, as cuts could come closer to it
 * forever, segment after segment around it. */
static double beside_end(const refiner *r, uint32_t e, int k, uint32_t by, double length) {
  static const double nearer = 0.75, close = 0.1, least = 0.2, wide = 0.9; /* the last: a cosine */
  const tet_segment *whole = &r->out->segment[r->seg_of[e]];
  const uint32_t *v = r->seg_v + 2 * (size_t)e;
  double height2, foot = along(r, v[k], v[1 - k], by, length, &height2), same = distance(r, by, v[k]) / length;
  if (same * length < close * distance(r, whole->a, whole->b) || !(foot > 0) || foot > wide * same) return same;
  double low = fmax(fmax(nearer * same, foot - height2 / (1 - foot)), least);
  double high = fmin(foot + height2 / foot, 1 - least);
  if (!(low < high)) return same;
  return k ? 1 - best_cut(r, e, 1 - high, 1 - low, length) : best_cut(r, e, low, high, length);
}

/* Near 1, another for each point. Cuts on common spheres make four vertices of a
 * facet cocircular time and again; rounded, they are off their plane as well, and
 * the two sides of the facet would see that tie differently. Off by `most`, if that is less: beside a point
 * close by, a cut farther off than a part of its squared distance would encroach, or be encroached. */
static double off_tie(const refiner *r, double most) {
  uint32_t k = (r->points.n * 2654435761u) >> 12;
  return 1 + (double)k * 0x1p-20 * fmin(0x1p-26, most);
}

/* Where subsegment e, encroached by vertex `by` or TET_NONE, is cut: as a fraction
 * of its length from its first end. */
static double fraction(const refiner *r, uint32_t e, uint32_t by, double length) {
  static const double least = 0.1; /* no closer to an end than that */
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  if (by == TET_NONE) return r->picking ? 0.5 + 0.2 * refine_chance(r, 3) : 0.5;
  double height2;
  along(r, a, b, by, length, &height2);
  double most = fmax(height2 / 16, 64 * DBL_EPSILON * r->points.max_abs / length); /* not below rounding */
  for (int k = 0; k < 2; k++) {
    if (!shares_end(r, by, k ? b : a)) continue;
    double cut = beside_end(r, e, k, by, length) * off_tie(r, most);
    if (cut > least && cut < 1 - least) return k ? 1 - cut : cut;
  }
  double cut = beside(r, a, b, by, length) * off_tie(r, most);
  if (cut > least && cut < 1 - least) return cut;
  int at_a = a < r->n_first && r->acute_end[a], at_b = b < r->n_first && r->acute_end[b];
  if (!(r->segment_sharp[r->seg_of[e]] & 1) || at_a == at_b) return 0.5;
  int power;
  frexp(length * (2.0 / 3.0), &power);
  cut = ldexp(1.0, power - 1) / length * off_tie(r, 1); /* about 1/3 to 2/3 */
  return at_a ? cut : 1 - cut;
}

tet_status refine_split_seg(refiner *r, uint32_t e, uint32_t by, refine_cause cause, refine_outcome *ret) {
  const uint32_t ends[2] = {r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1]};
  const double *a = refine_x(r, ends[0]), *b = refine_x(r, ends[1]);
  double x[3], length2 = 0, most = 0;
  for (int i = 0; i < 3; i++) {
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
    most = fmax(most, fmax(fabs(a[i]), fabs(b[i])));
  }
  *ret = OUTCOME_REJECTED;
  double length = sqrt(length2), cut = fraction(r, e, by, length);
  if (length < 64 * DBL_EPSILON * most) {
    r->result.rejected.too_short++;
    return TET_OK;
  }
  int exact = cut == 0.5;
  for (int i = 0; i < 3; i++) {
    x[i] = 0.5 * (a[i] + b[i]);
    exact = exact && x[i] - a[i] == b[i] - x[i];
  }
  if (!exact && cut == 0.5) cut *= off_tie(r, 1);
  for (int i = 0; i < 3 && !exact; i++) x[i] = a[i] + cut * (b[i] - a[i]);
  tet_status status = refine_add_point(r, x, TET_ORIGIN_SEGMENT, r->seg_of[e]);
  if (status) return status;
  int ok = 0;
  if (!refine_accepts(r, r->points.n - 1, ends, 2, cause == CAUSE_CENTRE ? r->o.alpha2 : 0, cause)) {
    r->result.rejected.protected_ball++;
  } else {
    status = refine_cavity_of_seg(r, r->points.n - 1, e, 0);
    int crowded = !status && cause == CAUSE_CENTRE && refine_crowded(r, ends, 2);
    if (!status && !crowded) status = refine_insert(r, &ok);
    if (crowded) r->result.rejected.protected_ball++;
    else if (!ok) r->result.rejected.lost_subface++;
  }
  if (status) return status;
  if (ok) {
    r->result.segment_points++;
    refine_spend(r);
    *ret = OUTCOME_INSERTED;
    return TET_OK;
  }
  refine_cavity_clear(r);
  refine_drop_point(r);
  return TET_OK;
}
