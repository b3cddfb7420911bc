// SPDX-License-Identifier: Apache-2.0
/* edges.h: the edges of a mesh and the regions around each. */
#ifndef TET_DUAL_EDGES_H
#define TET_DUAL_EDGES_H

#include "base/context.h"

#include <tet/mesh.h>

/* Rows (a, b, region), a < b, ascending: one for each edge and each region that has a
 * tetrahedron at it. */
typedef struct tet_region_edges {
  uint32_t n;
  uint32_t *vertices; /* [n][2] */
  uint32_t *regions;  /* [n] */
  uint32_t *first;    /* [n_points + 1] rows first[a] .. first[a + 1] - 1 begin at a */
} tet_region_edges;

void tet_region_edges_free(tet_ctx *ctx, tet_region_edges *edges);

/* All rows of `mesh`; *ret is the caller's to free, on failure too. Errors: TET_E_MEMORY,
 * TET_E_TOO_LARGE, cancel and deadline. Cost: about 70 ns and 48 bytes, for a while, a tetrahedron. */
tet_status tet_region_edges_of(tet_ctx *ctx, const tet_mesh *mesh, tet_region_edges *ret);

/* The row of edge ab (in any order) and a region, which must be there. */
static inline uint32_t tet_region_edge(const tet_region_edges *edges, uint32_t a, uint32_t b, uint32_t region) {
  uint32_t low = a < b ? a : b, high = a < b ? b : a, row = edges->first[low];
  while (edges->vertices[2 * (size_t)row + 1] != high || edges->regions[row] != region) row++;
  return row;
}

#endif
