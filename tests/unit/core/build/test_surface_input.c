// SPDX-License-Identifier: Apache-2.0
/* What tet_surface_build refuses for its arrays alone; duplicates, repeats, loose
 * and unused vertices. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "pls_builder.h"

static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};

typedef struct fixture {
  tet_ctx *ctx;
  pls_builder *b;
  tet_surface s;
} fixture;

static int setup(void **state) {
  static fixture f;
  f.b = pls_new();
  memset(&f.s, 0, sizeof f.s);
  *state = &f;
  pls_box(f.b, 1, zero, one);
  return tet_ctx_create(NULL, &f.ctx) == TET_OK ? 0 : -1;
}

static int teardown(void **state) {
  fixture *f = *state;
  tet_surface_free(f->ctx, &f->s);
  assert_int_equal(tet_ctx_bytes(f->ctx), 0);
  tet_ctx_free(f->ctx);
  pls_free(f->b);
  return 0;
}

static void refused(fixture *f, tet_status status, const char *words) {
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), status);
  assert_non_null(strstr(tet_ctx_error(f->ctx)->message, words));
  assert_null(f->s.tri);
}

static void bad_numbers(void **state) {
  fixture *f = *state;
  double was = f->b->x[5 * 3 + 1];
  f->b->x[5 * 3 + 1] = NAN;
  refused(f, TET_E_NOT_FINITE, "vertex 5: coordinate y");
  f->b->x[5 * 3 + 1] = -INFINITY;
  refused(f, TET_E_NOT_FINITE, "vertex 5");
  f->b->x[5 * 3 + 1] = 0x1p501;
  refused(f, TET_E_NOT_FINITE, "vertex 5");
  f->b->x[5 * 3 + 1] = was;
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
}

static void bad_indices(void **state) {
  fixture *f = *state;
  f->b->polygon_vertices[9] = 8;
  refused(f, TET_E_INDEX, "polygon 2 names vertex 8");
  f->b->polygon_vertices[9] = 1;
  pls_segment(f->b, 0, 0, 77);
  refused(f, TET_E_INDEX, "segment 0 names vertex 77");
}

static void bad_starts(void **state) {
  fixture *f = *state;
  f->b->polygon_start[3] = 2;
  refused(f, TET_E_ARGUMENT, "polygon_start");
  f->b->polygon_start[3] = 12;
  f->b->facet_start[6] = 5;
  refused(f, TET_E_ARGUMENT, "facet");
  f->b->facet_start[6] = 6;
  f->b->pls.facet_start = NULL;
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK); /* one polygon each */
}

static void bad_loose_points(void **state) {
  fixture *f = *state;
  const uint32_t loose[1] = {9};
  f->b->pls.loose_points = loose;
  f->b->pls.n_loose_points = 1;
  refused(f, TET_E_INDEX, "loose point 0 is vertex 9");
}

static void flat_input(void **state) {
  fixture *f = *state;
  pls_free(f->b);
  f->b = pls_new();
  pls_point(f->b, 0, 0, 0);
  pls_point(f->b, 1, 0, 0);
  pls_point(f->b, 0, 1, 0);
  pls_triangle(f->b, 0, 0, 1, 2);
  refused(f, TET_E_DEGENERATE, "one plane");
}

/* The lowest index survives, -0 equals 0, and facets meet at the survivor. */
static void duplicates(void **state) {
  fixture *f = *state;
  uint32_t v = pls_point(f->b, -0.0, 0.0, -0.0); /* corner 0 again */
  uint32_t w = pls_point(f->b, 1, 1, 0);         /* corner 3 */
  f->b->polygon_vertices[0] = v;
  f->b->polygon_vertices[2] = w;
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  assert_null(surface_fault(&f->s, &f->b->points));
  assert_int_equal(f->s.same_as[v], 0);
  assert_int_equal(f->s.same_as[w], 3);
  assert_int_equal(f->s.same_as[7], 7);
  assert_int_equal(f->s.n_duplicates, 2);
  assert_int_equal(f->s.used[v], 0);
  assert_int_equal(f->s.n_segments, 12);
  assert_int_equal(f->s.n_tris, 12);
}

static void unused_vertices(void **state) {
  fixture *f = *state;
  uint32_t v = pls_point(f->b, 0.5, 0.5, 0.5);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  assert_int_equal(f->s.used[v], 1);
  assert_int_equal(f->s.n_unused, 0);
  tet_surface_free(f->ctx, &f->s);
  f->b->pls.n_loose_points = 0;
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  assert_int_equal(f->s.used[v], 0);
  assert_int_equal(f->s.n_unused, 1);
}

/* A facet again, turned, reversed and with another marker, is left out. */
static void repeated_facets(void **state) {
  fixture *f = *state;
  pls_quad(f->b, 50, 3, 1, 0, 2);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  assert_null(surface_fault(&f->s, &f->b->points));
  assert_int_equal(f->s.n_repeated_facets, 1);
  assert_int_equal(f->s.n_facets, 6);
  assert_int_equal(f->s.n_tris, 12);
}

static void points_and_segments_alone(void **state) {
  fixture *f = *state;
  pls_free(f->b);
  f->b = pls_new();
  for (int i = 0; i < 4; i++) pls_point(f->b, i, 0, 0);
  pls_segment(f->b, 7, 0, 3);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  assert_int_equal(f->s.n_segments, 3); /* the loose points 1 and 2 lie on it */
  for (uint32_t i = 0; i < 3; i++) {
    assert_int_equal(f->s.segment[i].marker, 7);
    assert_int_equal(f->s.segment[i].loose, 1);
    assert_int_equal(f->s.segment[i].b, f->s.segment[i].a + 1);
    assert_int_equal(f->s.subseg_tri[i], TET_NONE);
  }
}

/* A facet that is one 2-vertex polygon: a file format's way to say loose segment. */
static void segment_as_facet(void **state) {
  fixture *f = *state;
  uint32_t ends[2] = {pls_point(f->b, 0.3, 0.3, 0.3), pls_point(f->b, 0.7, 0.6, 0.5)}, found = 0;
  pls_facet(f->b, 77);
  pls_polygon(f->b, 2, ends);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_OK);
  for (uint32_t i = 0; i < f->s.n_segments; i++) {
    if (f->s.segment[i].a != ends[0]) continue;
    assert_int_equal(f->s.segment[i].marker, 77);
    assert_int_equal(f->s.segment[i].loose, 1);
    found++;
  }
  assert_int_equal(found, 1);
}

static void memory_budget(void **state) {
  fixture *f = *state;
  for (uint64_t budget = 64; budget < 8192; budget = budget * 5 / 4 + 8) {
    tet_limits limits = {.memory_bytes = budget};
    tet_ctx *ctx;
    assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
    tet_surface s = {0};
    tet_status st = pls_surface(f->b, ctx, &s);
    assert_true(st == TET_OK || st == TET_E_MEMORY);
    tet_surface_free(ctx, &s);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

static void cancelled(void **state) {
  fixture *f = *state;
  tet_cancel(f->ctx);
  refused(f, TET_E_CANCELLED, "cancelled");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(bad_numbers, setup, teardown),
      cmocka_unit_test_setup_teardown(bad_indices, setup, teardown),
      cmocka_unit_test_setup_teardown(bad_starts, setup, teardown),
      cmocka_unit_test_setup_teardown(bad_loose_points, setup, teardown),
      cmocka_unit_test_setup_teardown(flat_input, setup, teardown),
      cmocka_unit_test_setup_teardown(duplicates, setup, teardown),
      cmocka_unit_test_setup_teardown(unused_vertices, setup, teardown),
      cmocka_unit_test_setup_teardown(repeated_facets, setup, teardown),
      cmocka_unit_test_setup_teardown(points_and_segments_alone, setup, teardown),
      cmocka_unit_test_setup_teardown(segment_as_facet, setup, teardown),
      cmocka_unit_test_setup_teardown(memory_budget, setup, teardown),
      cmocka_unit_test_setup_teardown(cancelled, setup, teardown),
  };
  return cmocka_run_group_tests_name("surface input", tests, NULL, NULL);
}
