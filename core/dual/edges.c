// SPDX-License-Identifier: Apache-2.0
/* edges.c: the six edges of every tetrahedron go to their lower vertex, whose few others
 * are then sorted and made unique. */
#include "dual/edges.h"

#include "base/sort.h"
#include "dual/shares.h"

enum { POLL_EVERY = 4096 };

void tet_region_edges_free(tet_ctx *ctx, tet_region_edges *edges) {
  tet_free(ctx, edges->vertices);
  tet_free(ctx, edges->regions);
  tet_free(ctx, edges->first);
  *edges = (tet_region_edges){0};
}

/* What is collected at lower vertices: the upper vertex and the region, in one number. */
typedef struct gathering {
  uint64_t *start; /* [n_points + 1] */
  uint64_t *key;   /* [6 n_tetrahedra] */
} gathering;

static uint32_t lower(const uint32_t *v, int e, uint32_t *ret_upper) {
  uint32_t a = v[tet_edge[e][0]], b = v[tet_edge[e][1]];
  *ret_upper = a < b ? b : a;
  return a < b ? a : b;
}

static tet_status gather(tet_ctx *ctx, const tet_mesh *m, gathering *g) {
  uint32_t upper;
  tet_status status = TET_OK;
  for (size_t t = 0; t < m->n_tetrahedra && status == TET_OK; t++) {
    for (int e = 0; e < 6; e++) g->start[lower(m->tetrahedra + 4 * t, e, &upper)]++;
    if (t % POLL_EVERY == 0) status = tet_poll(ctx);
  }
  uint64_t end = 0;
  for (size_t v = 0; v <= m->n_points; v++) end = g->start[v] += end;
  /* Filled from their ends, the starts are where they belong afterwards. */
  for (size_t t = m->n_tetrahedra; t-- > 0 && status == TET_OK;) {
    for (int e = 0; e < 6; e++) {
      uint32_t a = lower(m->tetrahedra + 4 * t, e, &upper);
      g->key[--g->start[a]] = (uint64_t)upper << 32 | m->tetrahedron_regions[t];
    }
    if (t % POLL_EVERY == 0) status = tet_poll(ctx);
  }
  return status;
}

/* The n keys ascending and each once; returns how many there are. Most vertices have few,
 * of which each comes several times: these go into a sorted list one by one. */
static size_t unique(uint64_t *key, size_t n, tet_keyed *scratch) {
  enum { FEW = 100 };
  size_t k = 0;
  if (n <= FEW) {
    for (size_t i = 0; i < n; i++) {
      uint64_t x = key[i];
      size_t at = k;
      while (at > 0 && key[at - 1] > x) at--;
      if (at > 0 && key[at - 1] == x) continue;
      for (size_t j = k++; j > at; j--) key[j] = key[j - 1];
      key[at] = x;
    }
    return k;
  }
  for (size_t i = 0; i < n; i++) scratch[i] = (tet_keyed){key[i], 0};
  tet_sort_keyed(scratch, n);
  for (size_t i = 0; i < n; i++)
    if (i == 0 || scratch[i].key != scratch[i - 1].key) key[k++] = scratch[i].key;
  return k;
}

/* Sorts every vertex's keys and moves them together; first[v] becomes the row where they begin. */
static tet_status compact(tet_ctx *ctx, gathering *g, uint32_t n_points, uint32_t *first, uint64_t *ret_rows) {
  uint64_t most = 0, rows = 0;
  for (uint32_t v = 0; v < n_points; v++)
    if (g->start[v + 1] - g->start[v] > most) most = g->start[v + 1] - g->start[v];
  tet_keyed *scratch = tet_alloc(ctx, most, sizeof *scratch);
  tet_status status = scratch ? TET_OK : tet_ctx_error(ctx)->status;
  for (uint32_t v = 0; v < n_points && status == TET_OK; v++) {
    uint64_t *key = g->key + g->start[v];
    size_t n = unique(key, g->start[v + 1] - g->start[v], scratch);
    if (rows + n >= TET_NONE) status = tet_fail(ctx, TET_E_TOO_LARGE, "more than 2^32 - 2 edges");
    first[v] = (uint32_t)rows;
    for (size_t i = 0; i < n; i++) g->key[rows + i] = key[i];
    rows += n;
    if (status == TET_OK && v % POLL_EVERY == 0) status = tet_poll(ctx);
  }
  first[n_points] = (uint32_t)rows;
  tet_free(ctx, scratch);
  *ret_rows = rows;
  return status;
}

static tet_status fill(tet_ctx *ctx, const gathering *g, uint32_t n_points, uint64_t rows, tet_region_edges *ret) {
  ret->n = (uint32_t)rows;
  ret->vertices = tet_alloc(ctx, rows, 2 * sizeof *ret->vertices);
  ret->regions = tet_alloc(ctx, rows, sizeof *ret->regions);
  if (!ret->vertices || !ret->regions) return tet_ctx_error(ctx)->status;
  for (uint32_t v = 0; v < n_points; v++)
    for (size_t row = ret->first[v]; row < ret->first[v + 1]; row++) {
      ret->vertices[2 * row] = v;
      ret->vertices[2 * row + 1] = (uint32_t)(g->key[row] >> 32);
      ret->regions[row] = (uint32_t)g->key[row];
    }
  return tet_poll(ctx);
}

tet_status tet_region_edges_of(tet_ctx *ctx, const tet_mesh *mesh, tet_region_edges *ret) {
  gathering g = {tet_calloc(ctx, (size_t)mesh->n_points + 1, sizeof *g.start),
                 tet_alloc(ctx, 6 * (size_t)mesh->n_tetrahedra, sizeof *g.key)};
  uint64_t rows = 0;
  *ret = (tet_region_edges){.first = tet_alloc(ctx, (size_t)mesh->n_points + 1, sizeof *ret->first)};
  tet_status status = g.start && g.key && ret->first ? gather(ctx, mesh, &g) : tet_ctx_error(ctx)->status;
  if (status == TET_OK) status = compact(ctx, &g, mesh->n_points, ret->first, &rows);
  if (status == TET_OK) status = fill(ctx, &g, mesh->n_points, rows, ret);
  tet_free(ctx, g.start);
  tet_free(ctx, g.key);
  return status;
}
