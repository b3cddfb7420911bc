// SPDX-License-Identifier: Apache-2.0
/* ways.c: is every segment one open chain of subsegments, and which way do these go? */
#include "audit/ways.h"

#include "base/sort.h"

void tet_ways_free(tet_ctx *ctx, tet_ways *w) {
  tet_free(ctx, w->way);
  tet_free(ctx, w->sense);
  tet_free(ctx, w->size);
  tet_free(ctx, w->end);
  tet_free(ctx, w->near);
  *w = (tet_ways){0};
}

/* The first place in item[0..n) with this vertex (items are (vertex, edge)). */
static uint32_t first_with(const tet_keyed *item, uint32_t n, uint64_t vertex) {
  uint32_t low = 0, high = n;
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    if (item[mid].key < vertex)
      low = mid + 1;
    else
      high = mid;
  }
  return low;
}

/* The place of the pair to begin at, if the `n_ends` (vertex, subsegment) pairs may be those of one
 * open chain: all vertices of two subsegments but two of one. Else TET_NONE. */
static uint32_t find_tip(const tet_keyed *end, uint32_t n_ends) {
  uint32_t tip = TET_NONE, n_tips = 0;
  for (uint32_t i = 0, run; i < n_ends; i += run) {
    run = 1;
    while (i + run < n_ends && end[i + run].key == end[i].key) run++;
    if (run > 2) return TET_NONE;
    if (run > 1) continue;
    if (!n_tips) tip = i;
    n_tips++;
  }
  return n_tips == 2 ? tip : TET_NONE;
}

/* Walks segment k, whose pairs these are; 1 if the walk meets all of them. */
static int walk(const tet_mesh *mesh, const tet_keyed *end, uint32_t n_ends, tet_ways *w, uint32_t k) {
  uint32_t tip = find_tip(end, n_ends);
  if (tip == TET_NONE) return 0;
  uint64_t vertex = end[tip].key, edge = end[tip].value;
  w->end[2 * (size_t)k] = (uint32_t)vertex;
  for (uint32_t walked = 1;; walked++) {
    const uint32_t *v = mesh->subsegments + 2 * edge;
    uint32_t from = (uint32_t)vertex, to = v[0] == from ? v[1] : v[0];
    w->sense[edge] = from < to ? 1 : -1;
    if (walked == 1) w->near[2 * (size_t)k] = to;
    vertex = to;
    uint32_t i = first_with(end, n_ends, vertex);
    int last = i + 1 >= n_ends || end[i + 1].key != vertex;
    if (last) {
      w->end[2 * (size_t)k + 1] = to;
      w->near[2 * (size_t)k + 1] = from;
      return walked == n_ends / 2;
    }
    edge = end[i].value == edge ? end[i + 1].value : end[i].value;
  }
}

static tet_status allocate(tet_ctx *ctx, uint32_t n, tet_ways *w) {
  w->way = tet_alloc(ctx, n, sizeof *w->way);
  w->sense = tet_calloc(ctx, n, sizeof *w->sense);
  w->size = tet_alloc(ctx, n, sizeof *w->size);
  w->end = tet_alloc(ctx, 2 * (size_t)n, sizeof *w->end);
  w->near = tet_alloc(ctx, 2 * (size_t)n, sizeof *w->near);
  return w->way && w->sense && w->size && w->end && w->near ? TET_OK : tet_ctx_error(ctx)->status;
}

tet_status tet_walk_ways(tet_ctx *ctx, const tet_mesh *mesh, tet_ways *ret_ways) {
  uint32_t n = mesh->n_subsegments;
  tet_ways w = {0};
  tet_keyed *by_segment = tet_alloc(ctx, n, sizeof *by_segment);
  tet_keyed *ends = tet_alloc(ctx, 2 * (size_t)n, sizeof *ends);
  tet_status status = by_segment && ends ? allocate(ctx, n, &w) : tet_ctx_error(ctx)->status;
  if (status == TET_OK) {
    for (uint32_t i = 0; i < n; i++) by_segment[i] = (tet_keyed){mesh->subsegment_segments[i], i};
    tet_sort_keyed(by_segment, n);
  }
  for (uint32_t i = 0, run; status == TET_OK && i < n; i += run) {
    uint32_t k = w.n++;
    run = 0;
    for (; i + run < n && by_segment[i + run].key == by_segment[i].key; run++) {
      uint64_t row = by_segment[i + run].value;
      w.way[row] = k;
      for (uint32_t e = 0; e < 2; e++) ends[2 * run + e] = (tet_keyed){mesh->subsegments[2 * row + e], row};
    }
    w.size[k] = run;
    tet_sort_keyed(ends, 2 * (size_t)run);
    if (!walk(mesh, ends, 2 * run, &w, k)) {
      w.end[2 * (size_t)k] = w.end[2 * (size_t)k + 1] = w.near[2 * (size_t)k] = w.near[2 * (size_t)k + 1] = TET_NONE;
      for (uint32_t e = i; e < i + run; e++) w.sense[by_segment[e].value] = 0;
      w.broken++;
    }
    if ((k & 255) == 0) status = tet_poll(ctx);
  }
  tet_free(ctx, by_segment);
  tet_free(ctx, ends);
  if (status == TET_OK) *ret_ways = w;
  else tet_ways_free(ctx, &w);
  return status;
}
