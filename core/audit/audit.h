// SPDX-License-Identifier: Apache-2.0
/* audit.h: is a finished mesh what it says it is, and does it hold the PLS?
 *
 * Decides from the PLS, the output arrays and the exact predicates alone. Nothing here
 * is used to build meshes, and nothing that builds them is used here. */
#ifndef TET_AUDIT_AUDIT_H
#define TET_AUDIT_AUDIT_H

#include "base/context.h"

#include <tet/mesh.h>
#include <tet/pls.h>

/* Counts the faults of `mesh` (its arrays and report.promised filled) into
 * *ret_audit; with a `pls`, one that tet_mesh_pls takes, also how far the mesh holds its facets, segments,
 * vertices and seeds, else these counts are 0; `passed` is 1 where everything promised holds, counts of what was
 * not promised notwithstanding. Radius-edge ratios, volumes and distances from a facet's plane are compared
 * in doubles, with a slack; everything else is exact. Needs about 24 bytes
 * a tetrahedron and n log n time. Errors: TET_E_MEMORY, TET_E_CANCELLED, TET_E_DEADLINE. */
tet_status tet_audit_mesh(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, tet_audit *ret_audit);

#endif
