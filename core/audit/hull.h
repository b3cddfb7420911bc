// SPDX-License-Identifier: Apache-2.0
/* hull.h: does a mesh fill a convex body? */
#ifndef TET_AUDIT_HULL_H
#define TET_AUDIT_HULL_H

#include "base/context.h"

#include <tet/mesh.h>

/* Counts into *ret_reflex the edges of the mesh's boundary at which it is not convex,
 * or not met by two faces. `boundary`: the `n` handles 4t+i of all boundary faces. */
tet_status tet_audit_hull(tet_ctx *ctx, const tet_mesh *mesh, const uint32_t *boundary, uint32_t n,
                          uint64_t *ret_reflex);

#endif
