// SPDX-License-Identifier: Apache-2.0
/* edge_map.c: a hash table of edges; removal shifts back, so no tombstones. */
#include "mesh/edge_map.h"

#include <string.h>

#include <tet/mesh.h>

#include "base/sort.h"

static size_t home(const tet_edge_map *m, uint32_t a, uint32_t b) {
  uint64_t key = (uint64_t)a << 32 | b;
  key *= 0x9E3779B97F4A7C15u;
  return (size_t)(key >> 32 ^ key >> 13) & m->mask;
}

/* The slot of edge ab (a < b), or the empty one where it belongs. */
static size_t probe(const tet_edge_map *m, uint32_t a, uint32_t b) {
  size_t i = home(m, a, b);
  while (m->slot[3 * i] != TET_NONE && (m->slot[3 * i] != a || m->slot[3 * i + 1] != b)) i = (i + 1) & m->mask;
  return i;
}

void tet_edge_map_free(tet_ctx *ctx, tet_edge_map *m) {
  tet_free(ctx, m->slot);
  memset(m, 0, sizeof *m);
}

static tet_status enlarge(tet_ctx *ctx, tet_edge_map *m) {
  tet_edge_map bigger = {NULL, m->slot ? 2 * m->mask + 1 : 63, m->n};
  bigger.slot = tet_alloc(ctx, 3 * (bigger.mask + 1), sizeof *bigger.slot);
  if (!bigger.slot) return tet_ctx_error(ctx)->status;
  memset(bigger.slot, 0xff, 3 * (bigger.mask + 1) * sizeof *bigger.slot);
  for (size_t i = 0; m->slot && i <= m->mask; i++)
    if (m->slot[3 * i] != TET_NONE)
      memcpy(bigger.slot + 3 * probe(&bigger, m->slot[3 * i], m->slot[3 * i + 1]), m->slot + 3 * i,
             3 * sizeof *m->slot);
  tet_free(ctx, m->slot);
  *m = bigger;
  return TET_OK;
}

tet_status tet_edge_map_put(tet_ctx *ctx, tet_edge_map *m, uint32_t a, uint32_t b, uint32_t value) {
  if (!m->slot || 2 * m->n > m->mask) {
    tet_status status = enlarge(ctx, m);
    if (status != TET_OK) return status;
  }
  tet_sort2(&a, &b);
  uint32_t *s = m->slot + 3 * probe(m, a, b);
  m->n += s[0] == TET_NONE;
  s[0] = a;
  s[1] = b;
  s[2] = value;
  return TET_OK;
}

uint32_t tet_edge_map_get(const tet_edge_map *m, uint32_t a, uint32_t b) {
  if (!m->slot) return TET_NONE;
  tet_sort2(&a, &b);
  const uint32_t *s = m->slot + 3 * probe(m, a, b);
  return s[0] == TET_NONE ? TET_NONE : s[2];
}

void tet_edge_map_remove(tet_edge_map *m, uint32_t a, uint32_t b) {
  if (!m->slot) return;
  tet_sort2(&a, &b);
  size_t gap = probe(m, a, b);
  if (m->slot[3 * gap] == TET_NONE) return;
  m->n--;
  for (size_t i = (gap + 1) & m->mask; m->slot[3 * i] != TET_NONE; i = (i + 1) & m->mask) {
    size_t h = home(m, m->slot[3 * i], m->slot[3 * i + 1]);
    if (((i - h) & m->mask) < ((i - gap) & m->mask)) continue; /* its home lies after the gap */
    memcpy(m->slot + 3 * gap, m->slot + 3 * i, 3 * sizeof *m->slot);
    gap = i;
  }
  m->slot[3 * gap] = TET_NONE;
}
