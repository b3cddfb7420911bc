// SPDX-License-Identifier: Apache-2.0
/* memory.h: what memory.c needs of a context: its budget. Internal to this folder; the
 * functions that all use are in context.h. */
#ifndef TET_BASE_MEMORY_H
#define TET_BASE_MEMORY_H

#include "base/context.h"

/* 1 if `more` bytes fit the budget. */
int tet_fits(const tet_ctx *ctx, size_t more);

/* A block of `before` bytes has `after` now (0: it is not there). TET_E_MEMORY, recorded
 * and nothing changed, where the budget does not allow it. */
tet_status tet_account(tet_ctx *ctx, size_t before, size_t after);

#endif
