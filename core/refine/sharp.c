// SPDX-License-Identifier: Apache-2.0
/* sharp.c: the sharp segments (4.2.2): below 60 degrees to another segment, or
 * between two facets below arccos(1/(2 sqrt 2)), about 69.3 degrees, through the
 * domain. In doubles: what is sharp steers points, and decides no sign. */
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

static tet_status plane_angles(refiner *r) {
  const tet_pieces *p = r->out;
  uint32_t n = r->points.n;
  uint32_t *start = tet_calloc(r->ctx, (size_t)n + 2, sizeof *start);
  uint32_t *at = tet_alloc(r->ctx, 2 * (size_t)p->n_segments, sizeof *at);
  uint8_t *live = tet_calloc(r->ctx, p->n_segments, 1); /* not so: creases, and what load.c dropped of them */
  tet_status status = start && at && live ? TET_OK : TET_E_MEMORY;
  for (uint32_t e = 0; e < r->n_segs && !status; e++) live[r->seg_of[e]] = !p->segment[r->seg_of[e]].crease;
  if (!status) {
    for (uint32_t s = 0; s < p->n_segments; s++)
      if (live[s]) start[p->segment[s].a + 2]++, start[p->segment[s].b + 2]++;
    for (uint32_t i = 0; i < n; i++) start[i + 2] += start[i + 1];
    for (uint32_t s = 0; s < p->n_segments; s++) {
      if (!live[s]) continue;
      at[start[p->segment[s].a + 1]++] = s;
      at[start[p->segment[s].b + 1]++] = s;
    }
  }
  for (uint32_t v = 0; v < n && !status; v++) {
    for (uint32_t i = start[v]; i < start[v + 1]; i++)
      for (uint32_t j = start[v]; j < i; j++) {
        double sine = sine_below_60(r, v, &p->segment[at[i]], &p->segment[at[j]]);
        if (!(sine < 1)) continue;
        for (int k = 0; k < 2; k++) {
          r->segment_sharp[at[k ? j : i]] |= 1;
          r->segment_sine[at[k ? j : i]] = fmin(r->segment_sine[at[k ? j : i]], sine);
        }
        r->segment_end[v] = END_ACUTE;
      }
    status = tet_poll(r->ctx);
  }
  tet_free(r->ctx, start);
  tet_free(r->ctx, at);
  tet_free(r->ctx, live);
  return status;
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
    double *least = &r->segment_sine[r->seg_of[e]];
    if (start == TET_NONE || r->out->segment[r->seg_of[e]].crease) continue;
    uint32_t edge = start;
    do {
      for (int side = 0; side < 2; side++) {
        uint32_t h = r->sub_side[2 * (size_t)(edge / 3) + side];
        double sine = h == TET_NONE || r->ring[edge] == edge ? 1 : sharp_sine(r, h, a, b);
        if (sine < 1) r->segment_sharp[r->seg_of[e]] |= 2;
        if (sine < *least) *least = sine;
        if (sine < r->o.thin) r->facet_thin[r->patch[r->sub_patch[edge / 3]].facet] = 1; /* the other likewise */
      }
      edge = r->ring[edge];
    } while (edge != start);
  }
}

/* Fills segment_sharp, segment_sine, facet_thin, segment_end and n_sharp; creases are never sharp. */
tet_status refine_find_sharp(refiner *r) {
  r->segment_sharp = tet_calloc(r->ctx, r->out->n_segments, 1);
  r->segment_sine = tet_alloc(r->ctx, r->out->n_segments, sizeof *r->segment_sine);
  r->facet_thin = tet_calloc(r->ctx, r->out->n_facets, 1);
  r->segment_end = tet_calloc(r->ctx, r->points.n, 1);
  if (!r->segment_sharp || !r->segment_sine || !r->facet_thin || !r->segment_end) return TET_E_MEMORY;
  for (uint32_t s = 0; s < r->out->n_segments; s++) r->segment_sine[s] = 1;
  tet_status status = plane_angles(r);
  if (status) return status;
  dihedral_angles(r);
  for (uint32_t s = 0; s < r->out->n_segments; s++) {
    if (!r->segment_sharp[s]) continue;
    r->segment_end[r->out->segment[s].a] |= END_SHARP;
    r->segment_end[r->out->segment[s].b] |= END_SHARP;
    r->n_sharp++;
    r->n_wedges += (r->segment_sharp[s] & 2) != 0;
  }
  return TET_OK;
}
