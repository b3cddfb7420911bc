// SPDX-License-Identifier: Apache-2.0
/* exceptions.h: the list of tetrahedra over a promised bound, made complete. */
#ifndef TET_ENGINE_EXCEPTIONS_H
#define TET_ENGINE_EXCEPTIONS_H

#include "base/context.h"

#include <tet/mesh.h>

/* Adds to the exceptions of `mesh` (ascending, and finally ordered otherwise) what is
 * over the bounds of report.promised and not listed, blamed on no segment. The ratio of
 * an almost flat tetrahedron is noise that depends on the order of its vertices, so
 * refinement, which had another one, may have taken it for good. */
tet_status tet_complete_exceptions(tet_ctx *ctx, tet_mesh *mesh);

#endif
