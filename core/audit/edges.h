// SPDX-License-Identifier: Apache-2.0
/* edges.h: the part of the audit that looks at subsegments. */
#ifndef TET_AUDIT_EDGES_H
#define TET_AUDIT_EDGES_H

#include "base/context.h"

#include <tet/mesh.h>

/* Counts into *found: subsegments_missing, subsegments_encroached (creases aside)
 * and broken_segments. All indices of `mesh` must be in range. */
tet_status tet_audit_edges(tet_ctx *ctx, const tet_mesh *mesh, tet_audit *found);

#endif
