// SPDX-License-Identifier: Apache-2.0
/* reach.h: where does the mesh reach? Exact location of points, and of directions at vertices. */
#ifndef TET_AUDIT_REACH_H
#define TET_AUDIT_REACH_H

#include "base/context.h"

#include <tet/mesh.h>

/* What leaves vertex `at` straight towards vertex `to`; and, unless x is TET_NONE, lies on that side
 * of this line, in the plane through vertex x, on which x lies (side 1) or does not (side -1). Where
 * the mesh has subsegments on the line, `along` is the first one's other end, else TET_NONE. */
typedef struct tet_flag_at {
  uint32_t at, to, x, along;
  int side;
  int hit; /* out: 1 if it enters the closed mesh */
  uint64_t of; /* the caller's */
} tet_flag_at;

/* Fills `hit` of n flags; sorts them by `at`. One pass over the tetrahedra. */
tet_status tet_hit_flags(tet_ctx *ctx, const tet_mesh *mesh, tet_flag_at *flag, size_t n);

/* A place to be found in the mesh. */
typedef struct tet_probe {
  double x[3];
  uint64_t of;        /* the caller's */
  uint32_t tet;       /* out: the first tetrahedron that holds it, borders included, or TET_NONE */
} tet_probe;

/* Fills `tet` of n probes; sorts them by x[0]. One pass over the tetrahedra, each of which looks
 * at the probes within its box's first side. */
tet_status tet_find_probes(tet_ctx *ctx, const tet_mesh *mesh, tet_probe *probe, size_t n);

#endif
