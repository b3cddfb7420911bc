// SPDX-License-Identifier: Apache-2.0
/* order.h: the rows of a finished mesh in the order in which they leave. */
#ifndef TET_ENGINE_ORDER_H
#define TET_ENGINE_ORDER_H

#include "base/context.h"

#include <tet/engine.h>

/* Brings `mesh` into its canonical order, in place: points along a Hilbert curve if
 * asked for (point_same_as then leads from input vertices to rows), else as they
 * are; each tetrahedron's vertices ascending up to parity, each subface and
 * subsegment from its smallest vertex on; all rows ascending. What refers to rows
 * follows. The result depends on the mesh alone, not on the order it came in. On
 * failure the mesh can only be freed. */
tet_status tet_order_mesh(tet_ctx *ctx, tet_mesh *mesh, tet_point_order order);

#endif
