// SPDX-License-Identifier: Apache-2.0
/* What a point cloud is where the facets that its hull is taken for are no surface: here tet_build, which the linker
 * wraps, says so. The hull is its faces then, and if those are none either, that is the error. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/context.h"
#include "build/build.h"

#include <tet/engine.h>

enum { SIDE = 3, N = SIDE * SIDE * SIDE };

tet_status __real_tet_build(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options, tet_build_result *ret);
tet_status __wrap_tet_build(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options, tet_build_result *ret);

tet_status __wrap_tet_build(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options, tet_build_result *ret) {
  tet_status told = mock_type(tet_status);
  if (options->stage != TET_STAGE_DELAUNAY) assert_int_equal(pls->n_facets, mock_type(uint32_t));
  return told ? tet_fail(ctx, told, "as told") : __real_tet_build(ctx, pls, options, ret);
}

/* Meshes a lattice, of which the builds end as told. */
static tet_status mesh(tet_status squares, tet_status triangles) {
  double x[N][3];
  for (int i = 0; i < N; i++)
    for (int k = 0, rest = i; k < 3; k++, rest /= SIDE) x[i][k] = rest % SIDE;
  tet_ctx *ctx;
  tet_mesh *m = NULL;
  tet_options o;
  tet_options_default(&o);
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  will_return(__wrap_tet_build, TET_OK); /* the Delaunay tetrahedralization */
  will_return(__wrap_tet_build, squares);
  will_return(__wrap_tet_build, 6);
  if (squares == TET_E_INTERSECTION) {
    will_return(__wrap_tet_build, TET_OK); /* that again: it was not kept for what hardly comes */
    will_return(__wrap_tet_build, triangles);
    will_return(__wrap_tet_build, 6 * 2 * (SIDE - 1) * (SIDE - 1));
  }
  const tet_pls cloud = {.n_points = N, .points = x[0], .n_loose_points = TET_LOOSE_ALL_UNUSED};
  tet_status status = tet_mesh_pls(ctx, &cloud, &o, &m);
  if (!status) {
    assert_true(m->report.audit.passed && fabs(m->report.quality.volume - 8) < 1e-12);
    tet_mesh_free(m);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  return status;
}

static void facets_that_are_no_surface_are_faces(void **state) {
  (void)state;
  assert_int_equal(mesh(TET_OK, TET_OK), TET_OK);
  assert_int_equal(mesh(TET_E_INTERSECTION, TET_OK), TET_OK);
  assert_int_equal(mesh(TET_E_INTERSECTION, TET_E_SEED), TET_E_SEED);
}

static void what_ends_the_run_ends_it(void **state) {
  (void)state;
  assert_int_equal(mesh(TET_E_CANCELLED, TET_OK), TET_E_CANCELLED);
  assert_int_equal(mesh(TET_E_MEMORY, TET_OK), TET_E_MEMORY);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(facets_that_are_no_surface_are_faces),
                                     cmocka_unit_test(what_ends_the_run_ends_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
