// SPDX-License-Identifier: Apache-2.0
/* attributes.c: attributes of Steiner points.
 *
 * Segments first, then facets from their own edges, then the volume, so that two
 * regions that share a facet agree on it. Means with positive weights never leave
 * the range of the given values. */
#include "engine/pack.h"

#include <string.h>

enum { SWEEPS = 12 };

typedef struct interpolation {
  tet_ctx *ctx;
  const tet_pieces *pieces;
  uint32_t n_attributes;
  double *values;
  uint8_t *known;    /* [n_points] has a value already */
  double *sum;       /* [n_points][n_attributes] weighted values of known neighbours */
  double *weight;    /* [n_points] */
} interpolation;

static double squared_distance(const double *a, const double *b) {
  double s = 0;
  for (int k = 0; k < 3; k++) s += (a[k] - b[k]) * (a[k] - b[k]);
  return s;
}

static void along_segments(interpolation *in) {
  const tet_pieces *p = in->pieces;
  for (uint32_t v = p->n_input; v < p->n_points; v++) {
    if (p->origin[v] != TET_ORIGIN_SEGMENT) continue;
    const tet_segment *s = &p->segment[p->carrier[v]];
    const double *a = p->points + 3 * (size_t)s->a, *b = p->points + 3 * (size_t)s->b, *x = p->points + 3 * (size_t)v;
    double along = 0, all = squared_distance(a, b);
    for (int k = 0; k < 3; k++) along += (x[k] - a[k]) * (b[k] - a[k]);
    double t = along / all;
    for (uint32_t k = 0; k < in->n_attributes; k++) {
      double from = in->values[s->a * (size_t)in->n_attributes + k];
      double to = in->values[s->b * (size_t)in->n_attributes + k];
      in->values[v * (size_t)in->n_attributes + k] = (1 - t) * from + t * to;
    }
    in->known[v] = 1;
  }
}

/* Neighbour `to` gives its value to `from`. */
static void gather(interpolation *in, uint32_t from, uint32_t to) {
  if (!in->known[to]) return;
  double d2 = squared_distance(in->pieces->points + 3 * (size_t)from, in->pieces->points + 3 * (size_t)to);
  double w = 1 / d2;
  in->weight[from] += w;
  for (uint32_t k = 0; k < in->n_attributes; k++)
    in->sum[from * (size_t)in->n_attributes + k] += w * in->values[to * (size_t)in->n_attributes + k];
}

/* One sweep over simplices of `size` vertices for the points of `origin`; returns
 * how many have no value yet. */
static uint64_t sweep(interpolation *in, const uint32_t *simplex, uint32_t n, uint32_t size, uint8_t origin) {
  const tet_pieces *p = in->pieces;
  memset(in->sum, 0, (size_t)p->n_points * in->n_attributes * sizeof *in->sum);
  memset(in->weight, 0, p->n_points * sizeof *in->weight);
  for (uint32_t s = 0; s < n; s++) {
    const uint32_t *v = simplex + (size_t)size * s;
    for (uint32_t i = 0; i < size; i++)
      for (uint32_t j = 0; j < size; j++)
        if (i != j && p->origin[v[i]] == origin) gather(in, v[i], v[j]);
  }
  uint64_t without = 0;
  for (uint32_t v = p->n_input; v < p->n_points; v++) {
    if (p->origin[v] != origin) continue;
    if (in->weight[v] > 0) {
      in->known[v] = 1;
      for (uint32_t k = 0; k < in->n_attributes; k++) {
        size_t at = v * (size_t)in->n_attributes + k;
        in->values[at] = in->sum[at] / in->weight[v];
      }
    }
    without += !in->known[v];
  }
  return without;
}

/* Sweeps until all points of `origin` have values, or none gets one any more, and
 * then some more. */
static tet_status settle(interpolation *in, const uint32_t *simplex, uint32_t n, uint32_t size, uint8_t origin) {
  uint64_t without = sweep(in, simplex, n, size, origin), before = UINT64_MAX;
  for (uint32_t more = 0; more < SWEEPS; more += without == before) {
    before = without;
    tet_status status = tet_poll(in->ctx);
    if (status != TET_OK) return status;
    without = sweep(in, simplex, n, size, origin);
  }
  return TET_OK;
}

tet_status tet_interpolate_attributes(tet_ctx *ctx, const tet_pieces *pieces, uint32_t n_attributes, double *values) {
  if (n_attributes == 0 || pieces->n_points == pieces->n_input) return TET_OK;
  interpolation in = {.ctx = ctx, .pieces = pieces, .n_attributes = n_attributes, .values = values};
  in.known = tet_calloc(ctx, pieces->n_points, sizeof *in.known);
  in.sum = tet_alloc(ctx, (size_t)pieces->n_points * n_attributes, sizeof *in.sum);
  in.weight = tet_alloc(ctx, pieces->n_points, sizeof *in.weight);
  tet_status status = in.known && in.sum && in.weight ? TET_OK : tet_ctx_error(ctx)->status;
  if (status == TET_OK) {
    memset(in.known, 1, pieces->n_input);
    along_segments(&in);
    status = settle(&in, pieces->subface, pieces->n_subfaces, 3, TET_ORIGIN_FACET);
  }
  if (status == TET_OK) status = settle(&in, pieces->tets, pieces->n_tets, 4, TET_ORIGIN_VOLUME);
  tet_free(ctx, in.known);
  tet_free(ctx, in.sum);
  tet_free(ctx, in.weight);
  return status;
}
