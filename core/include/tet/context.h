// SPDX-License-Identifier: Apache-2.0
/* context.h: limits, progress, cancellation and the last error of one run.
 *
 * A context is used by one thread at a time; only tet_cancel may be called from
 * another. Two contexts share nothing. Design sections 2 and 4. */
#ifndef TET_CONTEXT_H
#define TET_CONTEXT_H

#include <stddef.h>
#include <stdint.h>
#include <tet/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct tet_ctx tet_ctx;

typedef struct tet_limits {
  uint64_t memory_bytes;   /* all the engine's allocations together; 0: none */
  uint64_t max_vertices;   /* vertices of the mesh; 0: only 2^31 */
  double deadline_seconds; /* from the context's creation; 0: none */
} tet_limits;

/* What runs now. `fraction` is in [0,1], or negative where it cannot be known. */
typedef struct tet_progress {
  const char *stage; /* delaunay surface segments facets regions refine audit voronoi */
  double fraction;
  uint64_t vertices;
  uint64_t tetrahedra;
  uint64_t done;     /* stage's own count: segments recovered, points inserted ... */
} tet_progress;

/* Called by the meshing thread, at most about 20 times a second. */
typedef void (*tet_progress_fn)(void *user, const tet_progress *progress);

enum { TET_MAX_OFFENDERS = 64 };

typedef enum tet_offender_kind {
  TET_OFFENDER_VERTEX = 0,
  TET_OFFENDER_SEGMENT,
  TET_OFFENDER_FACET,
  TET_OFFENDER_HOLE,
  TET_OFFENDER_REGION
} tet_offender_kind;

/* One offending element or pair, in the caller's numbering. */
typedef struct tet_offence {
  tet_offender_kind kind[2]; /* of index[0] and index[1] */
  uint32_t index[2];         /* UINT32_MAX: no second one */
  int32_t marker[2];         /* of facets and segments; else 0 */
  double place[3];           /* a point of the crossing, about */
} tet_offence;

typedef struct tet_error {
  tet_status status;
  char message[256];       /* names the thing and the place; ends with NUL */
  const char *file;        /* TET_E_INTERNAL: where the invariant is; else NULL */
  int line;
  uint32_t n_offences;     /* all found, may exceed what is listed */
  uint32_t n_listed;
  tet_offence offences[TET_MAX_OFFENDERS];
} tet_error;

/* Creates a context. `limits` may be NULL. Errors: TET_E_MEMORY; then *ret_ctx
 * is untouched. */
tet_status tet_ctx_create(const tet_limits *limits, tet_ctx **ret_ctx);

/* Frees a context; meshes made with it must have been freed before. NULL is fine. */
void tet_ctx_free(tet_ctx *ctx);

/* Sets or clears (NULL) the progress callback. */
void tet_ctx_set_progress(tet_ctx *ctx, tet_progress_fn fn, void *user);

/* Asks the run to end with TET_E_CANCELLED; any thread, any time, also from a
 * signal handler. The engine looks at least every 10 ms. */
void tet_cancel(tet_ctx *ctx);

/* The error of the last call that failed on this context; never NULL. */
const tet_error *tet_ctx_error(const tet_ctx *ctx);

/* Bytes held now, and the most held at once since creation. */
uint64_t tet_ctx_bytes(const tet_ctx *ctx);
uint64_t tet_ctx_peak_bytes(const tet_ctx *ctx);

#ifdef __cplusplus
}
#endif
#endif
