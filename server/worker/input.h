// SPDX-License-Identifier: Apache-2.0
/* input.h: a validated set of PLS arrays as the engine's tet_pls. */
#ifndef TETRAD_WORKER_INPUT_H
#define TETRAD_WORKER_INPUT_H

#include <tet/engine.h>

#include "protocol/array.h"
#include "protocol/options.h"

/* Views the arrays of `set`, which must live longer. `*ret_starts` is memory that the
 * view needs besides (free it after use; may be NULL). Errors: TP_E_JOB_MEMORY,
 * TP_E_JOB_TOO_LARGE (a count over 2^32 - 2). */
tp_code input_view(const tp_arrays *set, tet_pls *ret_pls, uint32_t **ret_starts, tp_error *error);

/* The engine's form of the options. */
void input_options(const tp_options *options, tet_options *ret_options);

#endif
