// SPDX-License-Identifier: Apache-2.0
/* state.c: the state begun and ended, and Steiner points added to its points, its Delaunay
 * tetrahedralization and its surface together. They are exact points of a line of two input vertices;
 * where on it, others decide. */
#include "build/state.h"

#include <math.h>
#include <string.h>

/* One axis is rounded more than the others where it is by so much. */
static const double COARSE = 64;

/* Finds the axis whose coordinates are rounded most, where that stands out. */
static void find_coarse_axis(tet_state *st) {
  const tet_points *p = &st->points;
  double share[3], step[3];
  st->coarse = -1;
  if (!p->n) return;
  for (size_t j = 0; j < 3; j++) {
    double lo = p->x[j], hi = lo;
    for (size_t v = 1; v < p->n; v++) {
      lo = fmin(lo, p->x[3 * v + j]);
      hi = fmax(hi, p->x[3 * v + j]);
    }
    int exponent;
    frexp(fmax(fabs(lo), fabs(hi)), &exponent);
    step[j] = ldexp(1, exponent - 53);
    share[j] = hi > lo ? step[j] / (hi - lo) : 0;
  }
  for (int j = 0; j < 3; j++)
    if (share[j] > COARSE * share[(j + 1) % 3] && share[j] > COARSE * share[(j + 2) % 3]) {
      st->coarse = j;
      st->step = step[j];
    }
}

tet_status tet_state_init(tet_state *st, tet_ctx *ctx, const tet_pls *pls) {
  memset(st, 0, sizeof *st);
  st->ctx = ctx;
  st->pls = pls;
  st->n_input = st->points.n = st->points.first_implicit = pls->n_points;
  tet_complex_init(&st->complex, ctx, &st->points);
  tet_status status = tet_grow(ctx, &st->points.x, &st->cap_x, 3 * (size_t)pls->n_points, sizeof *st->points.x);
  if (status != TET_OK) return status;
  for (size_t i = 0; i < 3 * (size_t)pls->n_points; i++) {
    st->points.x[i] = pls->points[i];
    double size = fabs(pls->points[i]);
    if (size > st->points.max_abs) st->points.max_abs = size;
  }
  tet_points_find_grain(&st->points);
  find_coarse_axis(st);
  return TET_OK;
}

void tet_state_free(tet_state *st) {
  tet_complex_free(&st->complex);
  tet_surface_free(st->ctx, &st->surface);
  tet_free(st->ctx, st->points.x);
  tet_free(st->ctx, st->points.implicit);
  tet_free(st->ctx, st->carrier);
}

tet_status tet_state_add_steiner(tet_state *st, const tet_steiner *p, uint32_t *ret_v) {
  tet_points *points = &st->points;
  uint32_t v = points->n, i = v - st->n_input;
  if ((uint64_t)v + 1 > tet_vertex_limit(st->ctx))
    return tet_fail(st->ctx, TET_E_VERTEX_LIMIT, "the vertex limit of %llu is reached",
                    (unsigned long long)tet_vertex_limit(st->ctx));
  tet_status status = tet_grow(st->ctx, &points->x, &st->cap_x, 3 * ((size_t)v + 1), sizeof *points->x);
  if (status == TET_OK)
    status = tet_grow(st->ctx, &points->implicit, &st->cap_implicit, i + 1, sizeof *points->implicit);
  if (status == TET_OK) status = tet_grow(st->ctx, &st->carrier, &st->cap_carrier, i + 1, sizeof *st->carrier);
  if (status == TET_OK) status = tet_complex_reserve_vertices(&st->complex, v + 1);
  if (status != TET_OK) return status;
  points->implicit[i] = p->at;
  st->carrier[i] = p->carrier;
  tet_segment_point_round(points, &points->implicit[i], points->x + 3 * (size_t)v);
  points->n = v + 1;
  *ret_v = v;
  return TET_OK;
}

double tet_state_fine_place(const tet_state *st, uint32_t a, uint32_t b, double t, double most) {
  if (st->coarse < 0 || st->attempt > TET_LAST_FINE) return t;
  double from = st->points.x[3 * (size_t)a + (size_t)st->coarse];
  double d = st->points.x[3 * (size_t)b + (size_t)st->coarse] - from;
  double fine = d != 0 ? (st->step * rint((from + t * d) / st->step) - from) / d : t;
  return fabs(fine - t) < most ? fine : t;
}

static int same_place(const tet_points *p, uint32_t v, uint32_t w) {
  return !memcmp(p->x + 3 * (size_t)v, p->x + 3 * (size_t)w, 3 * sizeof *p->x);
}

tet_status tet_state_split(tet_state *st, uint32_t e, double t, uint32_t *ret_v) {
  tet_surface *s = &st->surface;
  uint32_t a = s->subseg[2 * (size_t)e], b = s->subseg[2 * (size_t)e + 1], number = s->subseg_segment[e], v;
  const tet_segment *g = &s->segment[number];
  tet_steiner p = {{g->a, g->b, t}, {TET_ORIGIN_SEGMENT, number}};
  tet_status status = tet_state_add_steiner(st, &p, &v);
  if (status != TET_OK) return status;
  const double *x = st->points.x + 3 * (size_t)a;
  if (same_place(&st->points, v, a) || same_place(&st->points, v, b))
    return tet_fail(st->ctx, TET_E_ROUNDING,
                    "the segment between vertices %u and %u would need points closer than doubles are, near (%.17g, %.17g, %.17g)",
                    g->a, g->b, x[0], x[1], x[2]);
  *ret_v = v;
  status = tet_complex_insert(&st->complex, v, st->complex.at[a]);
  return status == TET_OK ? tet_surface_split(st->ctx, s, &st->points, e, v) : status;
}

tet_status tet_split_breaks(tet_state *st) {
  const tet_breaks *breaks = st->breaks;
  tet_status status = TET_OK;
  double last = 0; /* on the segment of the break before */
  for (size_t k = 0; k < breaks->n && status == TET_OK; k++) {
    const tet_break *b = &breaks->at[k];
    const tet_segment *g = &st->surface.segment[b->segment];
    int again = k && breaks->at[k - 1].segment == b->segment;
    double least = tet_state_least(st, g->a, g->b);
    if (!again) last = 0;
    if (!(b->t - last > least && 1 - b->t > least)) continue;
    /* what is left towards b was appended last */
    uint32_t v;
    status = tet_state_split(st, last > 0 ? st->surface.n_subsegs - 1 : b->segment, b->t, &v);
    last = b->t;
    st->counts.segment_steiner_points++;
  }
  return status;
}
