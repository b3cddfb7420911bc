// SPDX-License-Identifier: Apache-2.0
/* context.h: what every stage needs of its context: accounted memory, polling,
 * errors with offenders, progress. Design section 4 "Errors" and section 2. */
#ifndef TET_BASE_CONTEXT_H
#define TET_BASE_CONTEXT_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <tet/context.h>
#include <tet/mesh.h>

/* Allocates `count * size` bytes (0 gives a valid pointer) under the budget.
 * Returns NULL after recording TET_E_MEMORY; never aborts. */
void *tet_alloc(tet_ctx *ctx, size_t count, size_t size);

/* The same, zeroed. */
void *tet_calloc(tet_ctx *ctx, size_t count, size_t size);

/* Frees what tet_alloc, tet_calloc or tet_grow gave; NULL is fine. */
void tet_free(tet_ctx *ctx, void *block);

/* Makes *array hold at least `need` items of `size` bytes, growing by half and more, or
 * where it is large by a thirty-second part; *capacity counts items. On failure nothing changes (the array stays
 * walkable) and TET_E_MEMORY or TET_E_TOO_LARGE is recorded and returned. */
tet_status tet_grow(tet_ctx *ctx, void *array, size_t *capacity, size_t need, size_t size);

/* Appends `value` to an array of `*n` numbers, growing it as tet_grow does. */
tet_status tet_push(tet_ctx *ctx, uint32_t **array, size_t *n, size_t *capacity, uint32_t value);

/* Gives memory above `count` items back; *array may move. Cannot fail. */
void tet_shrink(tet_ctx *ctx, void *array, size_t *capacity, size_t count, size_t size);

/* Looks at cancel and deadline. Cheap enough for every inserted point. */
tet_status tet_poll(tet_ctx *ctx);

/* What tet_poll looks at, for any thread: 1 if the run is to end. Records nothing. */
int tet_is_stopping(const tet_ctx *ctx);

/* Records an error, printf style, and returns `status`; clears old offences. */
tet_status tet_fail(tet_ctx *ctx, tet_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds an offender pair to the error recorded last; beyond TET_MAX_OFFENDERS
 * only counted. */
void tet_offend(tet_ctx *ctx, const tet_offence *offence);

/* Records TET_E_INTERNAL with the place; use through tet_internal(). */
tet_status tet_fail_internal(tet_ctx *ctx, const char *file, int line, const char *what);
#define tet_internal(ctx, what) tet_fail_internal((ctx), __FILE__, __LINE__, (what))

/* Vertices that the mesh may have (limit of the caller, or of the index type). */
uint64_t tet_vertex_limit(const tet_ctx *ctx);

/* Ends the running stage and starts one of this name (a literal: the pointer is
 * kept): progress, errors and times go under it. A name begun again adds to its
 * earlier time. */
void tet_stage_begin(tet_ctx *ctx, const char *name);

/* Ends the running stage; none runs then. */
void tet_stage_end(tet_ctx *ctx);

/* Sets what the running stage has made so far; the last call before its end
 * goes into the report. */
void tet_stage_counts(tet_ctx *ctx, uint64_t vertices, uint64_t tetrahedra);

/* Forgets the stages of an earlier run on this context. */
void tet_stages_clear(tet_ctx *ctx);

/* The ended stages in the order of their first begin, *ret_n <= TET_MAX_STAGES of them;
 * valid until the next call on the context. */
const tet_stage_report *tet_stages(const tet_ctx *ctx, uint32_t *ret_n);

/* Reports progress when it is time to; fraction < 0: unknown. */
void tet_progress_report(tet_ctx *ctx, double fraction, uint64_t vertices, uint64_t tetrahedra,
                         uint64_t done);

/* Wall and thread CPU seconds, monotonic. */
double tet_wall_seconds(void);
double tet_cpu_seconds(void);

#endif
