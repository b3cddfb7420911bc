// SPDX-License-Identifier: Apache-2.0
/* check.h: does what the caller gave make sense by itself? */
#ifndef TET_ENGINE_CHECK_H
#define TET_ENGINE_CHECK_H

#include "base/context.h"

#include <tet/engine.h>

/* Refuses options out of their range: TET_E_ARGUMENT naming the option. */
tet_status tet_check_options(tet_ctx *ctx, const tet_options *options);

/* Refuses arrays that are missing, not ascending where they must be, or hold an
 * index out of range or a coordinate that is not finite or beyond 2^500, and
 * fewer than four vertices. No geometry is looked at. Linear cost. */
tet_status tet_check_arrays(tet_ctx *ctx, const tet_pls *pls);

#endif
