// SPDX-License-Identifier: Apache-2.0
/* cut.c: where rule R1 cuts a subsegment.
 *
 * It is halved, but where that would only move the trouble on: encroached
 * by a point of a segment that shares an input vertex with it, it is cut as far
 * from that vertex as the point is (5.3, the reference vertex), so that the two do
 * not encroach upon each other in turn, or where there is no danger of that about there, so that
 * fewest subsegments of the facets around are encroached next; by a point close beside it, right there,
 * so that nearly parallel segments are cut in pairs; by anything else, at a vertex
 * where segments meet below 60 degrees, on a shell about it, its radius a power of
 * two.
 *
 * In a triangle without other cuts every cut of a side encroaches upon one of the other two: cuts come in
 * chains from triangle to triangle, each until it meets another. On surfaces of triangles most
 * points are of these, so a cut is made where its chain ends soonest. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <float.h>
#include <limits.h>
#include <math.h>

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

enum { MOST_AROUND = 40 };

/* A subsegment that a cut may encroach upon, as an edge of a subface around. */
typedef struct side {
  const double *a, *b;
  uint32_t edge;
  int price; /* 0: not known yet */
} side;

/* What a cut of a subsegment may concern: the subfaces at it, and what is joined to them by
 * edges that are no subsegments, the first of them; of these the corners, but for its own ends, and the sides
 * that do not wait to be split anyway. */
typedef struct surroundings {
  const double *a, *b; /* its ends */
  uint32_t n, n_corners, n_sides, sub[MOST_AROUND], corner[3 * MOST_AROUND];
  side side[3 * MOST_AROUND];
} surroundings;

static void find_subfaces(const refiner *r, uint32_t e, surroundings *ret) {
  enum { MOST_AT = 8 };
  uint32_t h = r->seg_sub[e];
  ret->n = 0;
  if (h == TET_NONE) return;
  do {
    ret->sub[ret->n++] = h / 3;
    h = r->ring[h];
  } while (h != r->seg_sub[e] && ret->n < MOST_AT);
  for (uint32_t k = 0; k < ret->n; k++)
    for (uint32_t g = 3 * ret->sub[k]; g < 3 * ret->sub[k] + 3; g++) {
      if (r->sub_seg[g] != TET_NONE) continue;
      uint32_t s = r->ring[g] / 3, i = 0;
      while (i < ret->n && ret->sub[i] != s) i++;
      if (i == ret->n && i < MOST_AROUND) ret->sub[ret->n++] = s;
    }
}

static void look_around(const refiner *r, uint32_t e, surroundings *ret) {
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  find_subfaces(r, e, ret);
  ret->a = refine_x(r, a);
  ret->b = refine_x(r, b);
  ret->n_corners = ret->n_sides = 0;
  for (uint32_t k = 0; k < 3 * ret->n; k++) {
    uint32_t s = ret->sub[k / 3], h = 3 * s + k % 3, v = r->sub_v[h], w = r->sub_v[3 * s + (k + 1) % 3];
    uint32_t f = r->sub_seg[h], i = 0;
    while (i < ret->n_corners && ret->corner[i] != v) i++;
    if (i == ret->n_corners && v != a && v != b) ret->corner[ret->n_corners++] = v;
    if (f == TET_NONE || f == e || r->seg_waiting[f]) continue;
    ret->side[ret->n_sides++] = (side){.a = refine_x(r, v), .b = refine_x(r, w), .edge = h};
  }
}

/* 1 if subface s has been cut at a corner, or will be: another cut there need not go on from it. */
static int is_open(const refiner *r, uint32_t s) {
  for (int j = 0; j < 3; j++) {
    uint32_t e = r->sub_seg[3 * (size_t)s + j];
    if (r->sub_v[3 * (size_t)s + j] >= r->n_first || (e != TET_NONE && r->seg_waiting[e])) return 1;
  }
  return 0;
}

/* Below 0: x is in the diametric ball of ab, about. */
static double over(const double *a, const double *b, const double *x) {
  double p[3], q[3];
  tet_minus(a, x, p);
  tet_minus(b, x, q);
  return tet_dot(p, q);
}

/* What it costs to encroach upon a side: one, and one more for each subface beyond that has no other cut where
 * the next could end. */
static int price_of(const refiner *r, side *s) {
  if (s->price) return s->price;
  s->price = 1;
  for (uint32_t g = r->ring[s->edge]; g != s->edge; g = r->ring[g]) s->price += !is_open(r, g / 3);
  return s->price;
}

/* What a cut at t costs: the sides that it would encroach upon, and one for each half that is still
 * encroached. Where that is above `most`, any number above it. */
static int price(const refiner *r, surroundings *around, double t, int most) {
  double x[3];
  int at_a = 0, at_b = 0;
  for (int i = 0; i < 3; i++) x[i] = around->a[i] + t * (around->b[i] - around->a[i]);
  for (uint32_t k = 0; k < around->n_corners; k++) {
    const double *v = refine_x(r, around->corner[k]);
    at_a |= over(around->a, x, v) < 0;
    at_b |= over(x, around->b, v) < 0;
  }
  int cost = at_a + at_b;
  for (uint32_t k = 0; k < around->n_sides && cost <= most; k++) {
    side *s = &around->side[k];
    if (over(s->a, s->b, x) < 0) cost += price_of(r, s);
  }
  return cost;
}

/* From low to high the cheapest cut, of those the one nearest the middle. What it encroaches upon changes at the
 * feet of vertices, and least where it is as far from an end as another cut. */
static double best_cut(const refiner *r, uint32_t e, double low, double high, double length) {
  static const double off = 0.005; /* the foot: there all but nothing decides which edge is encroached upon */
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  surroundings around;
  look_around(r, e, &around);
  double best = fmin(fmax(0.5, low), high);
  int least = price(r, &around, best, INT_MAX);
  if (!least) return best;
  for (uint32_t k = 0; k < around.n_corners; k++) {
    double height2, foot = along(r, a, b, around.corner[k], length, &height2);
    const double place[4] = {foot - off, foot + off, sqrt(height2 + foot * foot),
                             1 - sqrt(height2 + (1 - foot) * (1 - foot))};
    for (int i = 0; i < 4; i++) {
      if (!(place[i] > low && place[i] < high)) continue;
      int most = fabs(place[i] - 0.5) < fabs(best - 0.5) ? least : least - 1;
      int cost = price(r, &around, place[i], most);
      if (cost > most) continue;
      least = cost;
      best = place[i];
    }
  }
  return best;
}

/* Where subsegment e is cut, as a fraction from its end k, which is on the segment of vertex `by` too: as
 * far from it as `by`, or, at wide angles, from about there on, where it is cheapest: but not close to
 * the end, as cuts could come closer to it forever, segment after segment around it. */
static double beside_end(const refiner *r, uint32_t e, int k, uint32_t by, double length) {
  static const double nearer = 0.75, close = 0.1, least = 0.2, wide = 0.9; /* the last: a cosine */
  const tet_segment *whole = &r->out->segment[r->seg_of[e]];
  const uint32_t *v = r->seg_v + 2 * (size_t)e;
  double height2, foot = along(r, v[k], v[1 - k], by, length, &height2), same = distance(r, by, v[k]) / length;
  if (same * length < close * distance(r, whole->a, whole->b) || !(foot > 0) || foot > wide * same) return same;
  double low = fmax(nearer * same, least), high = 1 - least;
  if (!(low < high)) return same;
  return k ? 1 - best_cut(r, e, 1 - high, 1 - low, length) : best_cut(r, e, low, high, length);
}

/* Near 1, another for each point. Cuts on common spheres make four vertices of a
 * facet cocircular time and again; rounded, they are off their plane as well, and
 * the two sides of the facet would see that tie differently. Off by `most`, if that is less: beside a point
 * close by, a cut farther off than a part of its squared distance would encroach, or be encroached. */
double refine_off_tie(const refiner *r, double most) {
  uint32_t k = (r->points.n * 2654435761u) >> 12;
  return 1 + (double)k * 0x1p-20 * fmin(0x1p-26, most);
}

/* Where subsegment e, encroached by vertex `by` or TET_NONE, is cut: as a fraction
 * of its length from its first end. */
double refine_cut(const refiner *r, uint32_t e, uint32_t by, double length) {
  static const double least = 0.1; /* no closer to an end than that */
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  if (by == TET_NONE) return r->picking ? 0.5 + 0.2 * refine_chance(r, 3) : 0.5;
  double height2;
  along(r, a, b, by, length, &height2);
  double most = fmax(height2 / 16, 64 * DBL_EPSILON * r->points.max_abs / length); /* not below rounding */
  for (int k = 0; k < 2; k++) {
    if (!shares_end(r, by, k ? b : a)) continue;
    double cut = beside_end(r, e, k, by, length) * refine_off_tie(r, most);
    if (cut > least && cut < 1 - least) return k ? 1 - cut : cut;
  }
  double cut = beside(r, a, b, by, length) * refine_off_tie(r, most);
  if (cut > least && cut < 1 - least) return cut;
  int at_a = a < r->n_first && (r->segment_end[a] & END_ACUTE), at_b = b < r->n_first && (r->segment_end[b] & END_ACUTE);
  if (!(r->segment_sharp[r->seg_of[e]] & SHARP_PLANE) || at_a == at_b) return 0.5;
  int power;
  frexp(length * (2.0 / 3.0), &power);
  cut = ldexp(1.0, power - 1) / length * refine_off_tie(r, 1); /* about 1/3 to 2/3 */
  return at_a ? cut : 1 - cut;
}
