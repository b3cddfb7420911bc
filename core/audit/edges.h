// SPDX-License-Identifier: Apache-2.0
/* edges.h: the part of the audit that looks at subsegments. */
#ifndef TET_AUDIT_EDGES_H
#define TET_AUDIT_EDGES_H

#include "base/context.h"

#include <tet/mesh.h>

/* Counts into *found: subsegments_missing, subsegments_encroached (creases aside)
 * and facet_slivers. `subface` [4 n_tetrahedra]: 1 where face i of
 * tetrahedron t, at 4t+i, is a subface. All indices of `mesh` must be in range. */
tet_status tet_audit_edges(tet_ctx *ctx, const tet_mesh *mesh, const uint8_t *subface, tet_audit *found);

#endif
