// SPDX-License-Identifier: Apache-2.0
/* context.c: the budget, cancellation, deadline, errors and progress. The blocks that the
 * budget is for are in memory.c. No globals, no printing. */
#define _POSIX_C_SOURCE 200809L
#include "base/context.h"
#include "base/memory.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct tet_ctx {
  tet_limits limits;
  double start;
  atomic_int cancelled;
  uint64_t bytes, peak;
  tet_progress_fn progress;
  void *user;
  const char *stage; /* the running one, or "" */
  double stage_wall, stage_cpu; /* clocks at its begin */
  tet_stage_report running;
  uint32_t n_stages;
  tet_stage_report stages[TET_MAX_STAGES];
  double last_report;
  uint32_t polls;
  tet_error error;
};

static double clock_seconds(clockid_t id) {
  struct timespec t;
  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double tet_wall_seconds(void) { return clock_seconds(CLOCK_MONOTONIC); }
double tet_cpu_seconds(void) { return clock_seconds(CLOCK_THREAD_CPUTIME_ID); }

tet_status tet_ctx_create(const tet_limits *limits, tet_ctx **ret_ctx) {
  tet_ctx *ctx = calloc(1, sizeof *ctx);
  if (!ctx) return TET_E_MEMORY;
  if (limits) ctx->limits = *limits;
  atomic_init(&ctx->cancelled, 0);
  ctx->start = tet_wall_seconds();
  ctx->stage = "";
  *ret_ctx = ctx;
  return TET_OK;
}

void tet_ctx_free(tet_ctx *ctx) { free(ctx); }

void tet_ctx_set_progress(tet_ctx *ctx, tet_progress_fn fn, void *user) {
  ctx->progress = fn;
  ctx->user = user;
}

void tet_cancel(tet_ctx *ctx) { atomic_store_explicit(&ctx->cancelled, 1, memory_order_relaxed); }
const tet_error *tet_ctx_error(const tet_ctx *ctx) { return &ctx->error; }
uint64_t tet_ctx_bytes(const tet_ctx *ctx) { return ctx->bytes; }
uint64_t tet_ctx_peak_bytes(const tet_ctx *ctx) { return ctx->peak; }

uint64_t tet_vertex_limit(const tet_ctx *ctx) {
  uint64_t most = (uint64_t)1 << 31;
  uint64_t given = ctx->limits.max_vertices;
  return given && given < most ? given : most;
}

int tet_fits(const tet_ctx *ctx, size_t more) {
  return !ctx->limits.memory_bytes || ctx->bytes + more <= ctx->limits.memory_bytes;
}

tet_status tet_account(tet_ctx *ctx, size_t before, size_t after) {
  if (after > before && !tet_fits(ctx, after - before))
    return tet_fail(ctx, TET_E_MEMORY, "%zu more bytes do not fit the memory budget of %llu bytes", after - before,
                    (unsigned long long)ctx->limits.memory_bytes);
  ctx->bytes += after;
  ctx->bytes -= before;
  if (ctx->bytes > ctx->peak) ctx->peak = ctx->bytes;
  return TET_OK;
}

static int is_cancelled(const tet_ctx *ctx) {
  return atomic_load_explicit(&ctx->cancelled, memory_order_relaxed);
}

static int is_late(const tet_ctx *ctx) {
  return ctx->limits.deadline_seconds > 0 && tet_wall_seconds() - ctx->start > ctx->limits.deadline_seconds;
}

int tet_is_stopping(const tet_ctx *ctx) { return is_cancelled(ctx) || is_late(ctx); }

tet_status tet_poll(tet_ctx *ctx) {
  if (is_cancelled(ctx)) return tet_fail(ctx, TET_E_CANCELLED, "cancelled in stage %s", ctx->stage);
  if ((ctx->polls++ & 15) == 0 && is_late(ctx))
    return tet_fail(ctx, TET_E_DEADLINE, "the deadline of %g s passed in stage %s", ctx->limits.deadline_seconds,
                    ctx->stage);
  return TET_OK;
}

tet_status tet_fail(tet_ctx *ctx, tet_status status, const char *format, ...) {
  va_list args;
  memset(&ctx->error, 0, sizeof ctx->error);
  ctx->error.status = status;
  va_start(args, format);
  vsnprintf(ctx->error.message, sizeof ctx->error.message, format, args);
  va_end(args);
  return status;
}

void tet_offend(tet_ctx *ctx, const tet_offence *offence) {
  tet_error *e = &ctx->error;
  e->n_offences++;
  if (e->n_listed < TET_MAX_OFFENDERS) e->offences[e->n_listed++] = *offence;
}

tet_status tet_fail_internal(tet_ctx *ctx, const char *file, int line, const char *what) {
  tet_fail(ctx, TET_E_INTERNAL, "a bug in tetrad: %s (%s:%d, stage %s)", what, file, line, ctx->stage);
  ctx->error.file = file;
  ctx->error.line = line;
  return TET_E_INTERNAL;
}

void tet_stages_clear(tet_ctx *ctx) {
  ctx->stage = "";
  ctx->running = (tet_stage_report){0};
  ctx->n_stages = 0;
}

const tet_stage_report *tet_stages(const tet_ctx *ctx, uint32_t *ret_n) {
  *ret_n = ctx->n_stages;
  return ctx->stages;
}

void tet_stage_end(tet_ctx *ctx) {
  if (!*ctx->stage) return;
  tet_stage_report *r = &ctx->running;
  r->seconds = tet_wall_seconds() - ctx->stage_wall;
  r->cpu_seconds = tet_cpu_seconds() - ctx->stage_cpu;
  r->peak_bytes = ctx->peak;
  ctx->stage = "";
  uint32_t i = 0;
  while (i < ctx->n_stages && strcmp(ctx->stages[i].name, r->name) != 0) i++;
  if (i == TET_MAX_STAGES) return;
  if (i < ctx->n_stages) {
    r->seconds += ctx->stages[i].seconds;
    r->cpu_seconds += ctx->stages[i].cpu_seconds;
  } else {
    ctx->n_stages++;
  }
  ctx->stages[i] = *r;
}

void tet_stage_begin(tet_ctx *ctx, const char *name) {
  uint64_t vertices = ctx->running.vertices, tetrahedra = ctx->running.tetrahedra;
  tet_stage_end(ctx);
  ctx->stage = name;
  ctx->stage_wall = tet_wall_seconds();
  ctx->stage_cpu = tet_cpu_seconds();
  ctx->running = (tet_stage_report){.name = name, .vertices = vertices, .tetrahedra = tetrahedra};
  ctx->last_report = 0;
  tet_progress_report(ctx, 0.0, vertices, tetrahedra, 0);
}

void tet_stage_counts(tet_ctx *ctx, uint64_t vertices, uint64_t tetrahedra) {
  ctx->running.vertices = vertices;
  ctx->running.tetrahedra = tetrahedra;
}

void tet_progress_report(tet_ctx *ctx, double fraction, uint64_t vertices, uint64_t tetrahedra,
                         uint64_t done) {
  if (!ctx->progress) return;
  double now = tet_wall_seconds();
  if (now - ctx->last_report < 0.05) return;
  ctx->last_report = now;
  tet_progress p = {ctx->stage, fraction, vertices, tetrahedra, done};
  ctx->progress(ctx->user, &p);
}
