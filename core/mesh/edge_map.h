// SPDX-License-Identifier: Apache-2.0
/* edge_map.h: from an edge (two vertices, in any order) to a number. */
#ifndef TET_MESH_EDGE_MAP_H
#define TET_MESH_EDGE_MAP_H

#include "base/context.h"

/* Open addressing, linear probing, at most half full. */
typedef struct tet_edge_map {
  uint32_t *slot; /* [mask + 1][3]: vertices and value; first vertex TET_NONE: empty */
  size_t mask, n;
} tet_edge_map;

void tet_edge_map_free(tet_ctx *ctx, tet_edge_map *m);

/* Sets the value of edge ab, new or not. */
tet_status tet_edge_map_put(tet_ctx *ctx, tet_edge_map *m, uint32_t a, uint32_t b, uint32_t value);

/* The value of edge ab, or TET_NONE. */
uint32_t tet_edge_map_get(const tet_edge_map *m, uint32_t a, uint32_t b);

/* Takes edge ab out if it is there. */
void tet_edge_map_remove(tet_edge_map *m, uint32_t a, uint32_t b);

#endif
