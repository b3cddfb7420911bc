// SPDX-License-Identifier: Apache-2.0
/* sharp.c: the sharp segments (4.2.2): below 60 degrees to another segment, or
 * between two facets below arccos(1/(2 sqrt 2)), about 69.3 degrees, through the
 * domain; and those that stand so low on a facet that tetrahedra over the bound are forced there: the thesis
 * assumes that there are none (3.4.1, condition 1). In doubles: what is sharp steers points, and decides no sign. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>

/* The sine of the angle at v between segments f and g if that is below 60 degrees, else 1. */
static double sine_below_60(const refiner *r, uint32_t v, const tet_segment *f, const tet_segment *g) {
  double p[3], q[3], n[3];
  tet_minus(refine_x(r, f->a == v ? f->b : f->a), refine_x(r, v), p);
  tet_minus(refine_x(r, g->a == v ? g->b : g->a), refine_x(r, v), q);
  double c = tet_dot(p, q), lengths2 = tet_dot(p, p) * tet_dot(q, q);
  if (!(c > 0 && c * c > 0.25 * (1 + 1e-12) * lengths2)) return 1;
  tet_cross(p, q, n);
  return sqrt(tet_dot(n, n) / lengths2);
}

/* The segments that end at each vertex: `at` from start[v] to start[v + 1]. */
typedef struct stars {
  uint32_t *start, *at;
} stars;

/* Of all but creases, and what load.c dropped of them. */
static tet_status find_stars(const refiner *r, stars *ret) {
  const tet_pieces *p = r->out;
  uint32_t n = r->points.n;
  uint32_t *start = ret->start = tet_calloc(r->ctx, (size_t)n + 2, sizeof *start);
  ret->at = tet_alloc(r->ctx, 2 * (size_t)p->n_segments, sizeof *ret->at);
  uint8_t *live = tet_calloc(r->ctx, p->n_segments, 1);
  tet_status status = start && ret->at && live ? TET_OK : TET_E_MEMORY;
  for (uint32_t e = 0; e < r->n_segs && !status; e++) live[r->seg_of[e]] = !p->segment[r->seg_of[e]].crease;
  for (uint32_t s = 0; s < p->n_segments && !status; s++)
    if (live[s]) start[p->segment[s].a + 2]++, start[p->segment[s].b + 2]++;
  for (uint32_t i = 0; i < n && !status; i++) start[i + 2] += start[i + 1];
  for (uint32_t s = 0; s < p->n_segments && !status; s++) {
    if (!live[s]) continue;
    ret->at[start[p->segment[s].a + 1]++] = s;
    ret->at[start[p->segment[s].b + 1]++] = s;
  }
  tet_free(r->ctx, live);
  return status;
}

static void note_angle(refiner *r, uint32_t segment, uint8_t kind, double sine) {
  r->segment_sharp[segment] |= kind;
  r->segment_sine[segment] = fmin(r->segment_sine[segment], sine);
}

static tet_status plane_angles(refiner *r, const stars *ends) {
  tet_status status = TET_OK;
  for (uint32_t v = 0; v < r->points.n && !status; v++) {
    for (uint32_t i = ends->start[v]; i < ends->start[v + 1]; i++)
      for (uint32_t j = ends->start[v]; j < i; j++) {
        uint32_t f = ends->at[i], g = ends->at[j];
        double sine = sine_below_60(r, v, &r->out->segment[f], &r->out->segment[g]);
        if (!(sine < 1)) continue;
        note_angle(r, f, SHARP_PLANE, sine);
        note_angle(r, g, SHARP_PLANE, sine);
        r->segment_end[v] = END_ACUTE;
      }
    status = tet_poll(r->ctx);
  }
  return status;
}

/* The sine of the angle at corner j of subface s to the segment from there to vertex w, if right below that is
 * s, and the domain between them; else 1. */
static double sine_over(const refiner *r, uint32_t s, int j, uint32_t w) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  const refine_patch *plane = &r->patch[r->sub_patch[s]];
  const double *o = refine_x(r, v[j]);
  double d[3], a[3], b[3], n[3], side[3], foot[3];
  if (refine_on_facet(r, w, plane->facet)) return 1;
  tet_direction(refine_x(r, w), o, d);
  double up = tet_dot(d, plane->normal);
  int is_inside = 0;
  for (int i = 0; i < 2; i++) {
    uint32_t h = r->sub_side[2 * (size_t)s + i];
    if (h == TET_NONE) continue;
    tet_minus(refine_x(r, r->mesh.v[h]), o, a);
    is_inside |= tet_dot(a, plane->normal) * up > 0;
  }
  for (int i = 0; i < 3; i++) foot[i] = d[i] - up * plane->normal[i];
  tet_minus(refine_x(r, v[(j + 1) % 3]), o, a);
  tet_minus(refine_x(r, v[(j + 2) % 3]), o, b);
  tet_cross(a, b, n);
  tet_cross(a, foot, side);
  if (!is_inside || !(tet_dot(side, n) >= 0)) return 1;
  tet_cross(foot, b, side);
  return tet_dot(side, n) >= 0 ? fabs(up) / sqrt(tet_square(d)) : 1;
}

/* 1 if v has a protecting ball anyway, being on a sharp segment, and on more than one facet: most of what meets low
 * there is part of what is sharp. */
static int is_seen_to(const refiner *r, uint32_t v) {
  return r->segment_end[v] & END_SHARP && r->vertex_facet_start[v + 1] - r->vertex_facet_start[v] > 1;
}

/* A segment's first point has an edge to about right below it on the facet; where the two enclose a smaller angle
 * than any triangle within the bound has, points there would never end. */
static tet_status facet_angles(refiner *r, const stars *ends) {
  double least = 1 / (2 * r->o.radius_edge);
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < 3 * r->n_subs && !status; k++) {
    uint32_t s = k / 3, v = r->sub_v[k];
    if ((k & 1023) == 0) status = tet_poll(r->ctx);
    if (r->sub_v[3 * (size_t)s] == TET_NONE || is_seen_to(r, v)) continue;
    for (uint32_t i = ends->start[v]; i < ends->start[v + 1]; i++) {
      const tet_segment *segment = &r->out->segment[ends->at[i]];
      double sine = sine_over(r, s, (int)(k % 3), segment->a == v ? segment->b : segment->a);
      if (!(sine < least)) continue;
      r->n_sharp += !r->segment_sharp[ends->at[i]];
      note_angle(r, ends->at[i], SHARP_FACET, sine);
      r->low[v] = INFINITY;
    }
  }
  for (uint32_t e = 0; e < r->n_segs; e++) refine_note_low(r, e);
  return status;
}

/* Subsegment e may be the shortest of those that stand low at its ends. */
void refine_note_low(refiner *r, uint32_t e) {
  if (!(r->segment_sharp[r->seg_of[e]] & SHARP_FACET)) return;
  const uint32_t *v = r->seg_v + 2 * (size_t)e;
  double length = sqrt(tet_distance2(refine_x(r, v[0]), refine_x(r, v[1])));
  for (int i = 0; i < 2; i++)
    if (v[i] < r->n_first && length < r->low[v[i]]) r->low[v[i]] = length;
}

/* From the line ab to x, at a right angle, and turned by a quarter: only angles
 * between such vectors count. */
static void arm(const refiner *r, uint32_t a, uint32_t b, uint32_t x, double w[3]) {
  double e[3], d[3];
  tet_minus(refine_x(r, b), refine_x(r, a), e);
  tet_minus(refine_x(r, x), refine_x(r, a), d);
  tet_cross(e, d, w);
}

/* The sine of the angle that the fan of tetrahedra from face h around ab to the next subface
 * spans if that is sharp, else 1. */
static double sharp_sine(const refiner *r, uint32_t h, uint32_t a, uint32_t b) {
  double e[3], first[3], second[3], last[3], n[3];
  uint32_t x = TET_NONE, steps = 0;
  tet_minus(refine_x(r, b), refine_x(r, a), e);
  for (;; steps++) {
    uint32_t t = h >> 2, i = h & 3, j = 0;
    for (uint32_t k = 0; k < 4; k++)
      if (k != i && r->mesh.v[4 * (size_t)t + k] != a && r->mesh.v[4 * (size_t)t + k] != b) j = k;
    if (!steps) arm(r, a, b, r->mesh.v[4 * (size_t)t + j], first);
    x = r->mesh.v[4 * (size_t)t + i];
    if (!steps) arm(r, a, b, x, second);
    size_t exit = 4 * (size_t)t + j;
    if (refine_sub_at(r, exit) != TET_NONE || r->mesh.adj[exit] == TET_NONE) break;
    h = r->mesh.adj[exit];
  }
  arm(r, a, b, x, last);
  double c = tet_dot(first, last), lengths2 = tet_dot(first, first) * tet_dot(last, last);
  if (!(c > 0 && 8 * c * c > (1 + 1e-12) * lengths2)) return 1;
  tet_cross(first, second, n); /* the sense of the fan */
  double sense = tet_dot(n, e);
  tet_cross(first, last, n);
  return !steps || sense * tet_dot(n, e) > 0 ? sqrt(tet_dot(n, n) / lengths2) : 1;
}

static void dihedral_angles(refiner *r) {
  for (uint32_t e = 0; e < r->n_segs; e++) {
    uint32_t start = r->seg_sub[e], a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
    if (start == TET_NONE || r->out->segment[r->seg_of[e]].crease) continue;
    uint32_t edge = start;
    do {
      for (int side = 0; side < 2; side++) {
        uint32_t h = r->sub_side[2 * (size_t)(edge / 3) + side];
        double sine = h == TET_NONE || r->ring[edge] == edge ? 1 : sharp_sine(r, h, a, b);
        if (sine < 1) note_angle(r, r->seg_of[e], SHARP_DIHEDRAL, sine);
        if (sine < r->o.thin) r->facet_thin[r->patch[r->sub_patch[edge / 3]].facet] = 1; /* the other likewise */
      }
      edge = r->ring[edge];
    } while (edge != start);
  }
}

/* Fills segment_end by the angles of segments and facets among themselves. */
static void note_ends(refiner *r) {
  for (uint32_t s = 0; s < r->out->n_segments; s++) {
    if (!r->segment_sharp[s]) continue;
    r->segment_end[r->out->segment[s].a] |= END_SHARP;
    r->segment_end[r->out->segment[s].b] |= END_SHARP;
    r->n_sharp++;
    r->n_wedges += (r->segment_sharp[s] & SHARP_DIHEDRAL) != 0;
  }
  r->n_crowds = r->n_sharp;
}

/* Fills segment_sharp, segment_sine, facet_thin, segment_end, low and n_sharp; creases are never sharp. */
tet_status refine_find_sharp(refiner *r) {
  r->segment_sharp = tet_calloc(r->ctx, r->out->n_segments, 1);
  r->segment_sine = tet_alloc(r->ctx, r->out->n_segments, sizeof *r->segment_sine);
  r->facet_thin = tet_calloc(r->ctx, r->out->n_facets, 1);
  r->segment_end = tet_calloc(r->ctx, r->points.n, 1);
  r->low = tet_calloc(r->ctx, r->points.n, sizeof *r->low);
  if (!r->segment_sharp || !r->segment_sine || !r->facet_thin || !r->segment_end || !r->low) return TET_E_MEMORY;
  for (uint32_t s = 0; s < r->out->n_segments; s++) r->segment_sine[s] = 1;
  stars ends;
  tet_status status = find_stars(r, &ends);
  if (!status) status = plane_angles(r, &ends);
  if (!status) dihedral_angles(r);
  if (!status) note_ends(r);
  if (!status) status = facet_angles(r, &ends);
  tet_free(r->ctx, ends.start);
  tet_free(r->ctx, ends.at);
  return status;
}
