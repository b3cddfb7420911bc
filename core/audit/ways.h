// SPDX-License-Identifier: Apache-2.0
/* ways.h: the subsegments of each segment, walked from end to end. */
#ifndef TET_AUDIT_WAYS_H
#define TET_AUDIT_WAYS_H

#include "base/context.h"

#include <tet/mesh.h>

/* Segments get numbers of their own here, 0 to n - 1, ascending as the mesh's. */
typedef struct tet_ways {
  uint32_t n;
  uint32_t *way;   /* [n_subsegments] the segment that it is of */
  int8_t *sense;   /* [n_subsegments] 1: the walk goes from its lower to its higher vertex; -1: the other way;
                      0: the segment is broken */
  uint32_t *size;  /* [n] subsegments of a segment */
  uint32_t *end;   /* [n][2] where the walk begins and ends; TET_NONE: the segment is broken */
  uint32_t *near;  /* [n][2] the vertices next to these */
  uint64_t broken; /* segments that are not one open chain */
} tet_ways;

/* Walks all segments. n log n. All indices of `mesh` must be in range. */
tet_status tet_walk_ways(tet_ctx *ctx, const tet_mesh *mesh, tet_ways *ret_ways);

void tet_ways_free(tet_ctx *ctx, tet_ways *ways);

#endif
