// SPDX-License-Identifier: Apache-2.0
/* Budget, cancel, deadline and vertex limit, in every stage: the run ends with that status,
 * touches no output and leaks nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#include "maker.h"
#include <tet/engine.h>

static made_pls made;

static tet_options options_of(int order) {
  tet_options o;
  tet_options_default(&o);
  o.neighbours = order;
  o.break_points = order;
  o.voronoi = order ? TET_VORONOI_DIAGRAM : TET_VORONOI_NONE;
  o.point_order = order ? TET_ORDER_HILBERT : TET_ORDER_INPUT_FIRST;
  return o;
}

/* Runs under `limits`; returns the status, and the peak in *peak. */
static tet_status run(const tet_limits *limits, const tet_options *options, uint64_t *peak) {
  tet_ctx *ctx;
  tet_mesh *const untouched = (tet_mesh *)(void *)&made, *mesh = untouched;
  assert_int_equal(tet_ctx_create(limits, &ctx), TET_OK);
  tet_status status = tet_mesh_pls(ctx, &made.pls, options, &mesh);
  *peak = tet_ctx_peak_bytes(ctx);
  if (status == TET_OK) {
    assert_true(mesh->report.audit.passed);
    tet_mesh_free(mesh);
  } else {
    assert_ptr_equal(mesh, untouched);
    assert_int_equal(tet_ctx_error(ctx)->status, status);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  return status;
}

/* From no memory to enough, in steps that meet most allocations. */
static void budgets(void **state) {
  (void)state;
  for (int order = 0; order < 2; order++) {
    tet_options options = options_of(order);
    make_boxes(3, &made);
    uint64_t enough, peak;
    assert_int_equal(run(&(tet_limits){0}, &options, &enough), TET_OK);
    for (uint64_t part = 0; part < 300; part++) {
      tet_limits limits = {.memory_bytes = 1 + enough * part / 300};
      tet_status status = run(&limits, &options, &peak);
      if (part > 150 && status == TET_OK) break; /* arrays grow by less where memory is short */
      assert_int_equal(status, TET_E_MEMORY);
      assert_true(peak <= limits.memory_bytes);
    }
    assert_int_equal(run(&(tet_limits){.memory_bytes = enough}, &options, &peak), TET_OK);
  }
}

typedef struct stopper {
  tet_ctx *ctx;
  const char *stage;
  int seen;
} stopper;

static void stop_in(void *user, const tet_progress *progress) {
  stopper *s = user;
  assert_true(progress->fraction <= 1);
  if (strcmp(progress->stage, s->stage) != 0) return;
  s->seen = 1;
  tet_cancel(s->ctx);
}

/* Asked for at any stage's begin, the end comes. */
static void cancels(void **state) {
  (void)state;
  static const char *const stages[] = {"surface", "delaunay", "degeneracies", "segments", "facets", "regions", "refine", "audit", "voronoi"};
  make_boxes(3, &made);
  tet_options options = options_of(1);
  for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
    stopper s = {.stage = stages[i]};
    tet_mesh *mesh = NULL;
    assert_int_equal(tet_ctx_create(NULL, &s.ctx), TET_OK);
    tet_ctx_set_progress(s.ctx, stop_in, &s);
    assert_int_equal(tet_mesh_pls(s.ctx, &made.pls, &options, &mesh), TET_E_CANCELLED);
    assert_true(s.seen);
    assert_null(mesh);
    assert_int_equal(tet_ctx_bytes(s.ctx), 0);
    tet_ctx_free(s.ctx);
  }
}

static void deadlines(void **state) {
  (void)state;
  make_boxes(3, &made);
  tet_options options = options_of(0);
  uint64_t peak;
  assert_int_equal(run(&(tet_limits){.deadline_seconds = 1e-9}, &options, &peak), TET_E_DEADLINE);
  assert_int_equal(run(&(tet_limits){.deadline_seconds = 1e9}, &options, &peak), TET_OK);
}

static void vertex_limits(void **state) {
  (void)state;
  make_boxes(3, &made);
  tet_options options = options_of(0);
  uint64_t peak;
  for (uint32_t more = 0; more < 20; more++) {
    tet_limits limits = {.max_vertices = made.pls.n_points + more};
    assert_int_equal(run(&limits, &options, &peak), TET_E_VERTEX_LIMIT);
  }
  assert_int_equal(run(&(tet_limits){.max_vertices = made.pls.n_points - 1}, &options, &peak), TET_E_VERTEX_LIMIT);
  assert_int_equal(run(&(tet_limits){.max_vertices = 1000000}, &options, &peak), TET_OK);
}

/* A context serves again after a failure. */
static void context_serves_again(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_mesh *mesh = NULL;
  tet_options options = options_of(0), wrong = options;
  wrong.radius_edge = 0.5;
  make_boxes(1, &made);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(tet_mesh_pls(ctx, &made.pls, &wrong, &mesh), TET_E_ARGUMENT);
    assert_int_equal(tet_mesh_pls(ctx, &made.pls, &options, &mesh), TET_OK);
    assert_true(mesh->report.n_stages == 7);
    tet_mesh_free(mesh);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(budgets), cmocka_unit_test(cancels), cmocka_unit_test(deadlines),
                                     cmocka_unit_test(vertex_limits), cmocka_unit_test(context_serves_again)};
  return cmocka_run_group_tests_name("limits", tests, NULL, NULL);
}
