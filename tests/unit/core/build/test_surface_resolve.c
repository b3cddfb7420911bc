// SPDX-License-Identifier: Apache-2.0
/* Facets, segments and vertices that meet: what is resolved and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "pls_builder.h"

typedef struct fixture {
  tet_ctx *ctx;
  pls_builder *b;
  tet_surface s;
  uint32_t floor; /* first corner of the facet 0: [0,8]^2 at z = 0 */
} fixture;

static int setup(void **state) {
  static fixture f;
  f.b = pls_new();
  memset(&f.s, 0, sizeof f.s);
  *state = &f;
  f.floor = pls_point(f.b, 0, 0, 0);
  pls_point(f.b, 8, 0, 0);
  pls_point(f.b, 8, 8, 0);
  pls_point(f.b, 0, 8, 0);
  pls_quad(f.b, 1, f.floor, f.floor + 1, f.floor + 2, f.floor + 3);
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

static void built(fixture *f) {
  tet_status st = pls_surface(f->b, f->ctx, &f->s);
  if (st != TET_OK) fail_msg("%s", tet_ctx_error(f->ctx)->message);
  const char *fault = surface_fault(&f->s, &f->b->points);
  if (fault) fail_msg("%s", fault);
}

/* Exactly one pair, of facets f and g. */
static void refused(fixture *f, uint32_t facet, uint32_t g) {
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_E_INTERSECTION);
  const tet_error *e = tet_ctx_error(f->ctx);
  assert_int_equal(e->n_offences, 1);
  assert_int_equal(e->offences[0].index[0], facet);
  assert_int_equal(e->offences[0].index[1], g);
  for (int k = 0; k < 2; k++)
    if (e->offences[0].kind[k] == TET_OFFENDER_FACET)
      assert_int_equal(e->offences[0].marker[k], f->b->facet_markers[e->offences[0].index[k]]);
}

/* Quad in the plane y = 4 over [x0, x1] and [z0, z1]. */
static uint32_t wall(fixture *f, double x0, double x1, double z0, double z1) {
  uint32_t v = pls_point(f->b, x0, 4, z0);
  pls_point(f->b, x1, 4, z0);
  pls_point(f->b, x1, 4, z1);
  pls_point(f->b, x0, 4, z1);
  return pls_quad(f->b, 2, v, v + 1, v + 2, v + 3);
}

static uint32_t ring_size(const tet_surface *s, uint32_t e) {
  uint32_t first = s->subseg_tri[e], n = 0;
  if (first == TET_NONE) return 0;
  for (uint32_t h = first; n == 0 || h != first; h = s->tri_ring[h]) n++;
  return n;
}

/* A wall's lower side becomes a constraint of the floor. */
static void wall_stands(void **state) {
  fixture *f = *state;
  wall(f, 2, 6, 0, 3);
  built(f);
  assert_int_equal(f->s.n_segments, 8);
  uint32_t threes = 0;
  for (uint32_t e = 0; e < f->s.n_subsegs; e++) threes += ring_size(&f->s, e) == 3;
  assert_int_equal(threes, 1);
}

/* Two walls in line: their sides meet at a vertex; a third vertex lies on one. */
static void walls_in_line(void **state) {
  fixture *f = *state;
  wall(f, 0, 3, 0, 3);
  wall(f, 3, 8, 0, 3);
  pls_point(f->b, 5, 4, 0);
  built(f);
  assert_int_equal(f->s.n_facets, 2); /* the walls are coplanar and of one marker */
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 64 - 24) < 1e-12);
}

static void wall_pierces(void **state) {
  fixture *f = *state;
  uint32_t g = wall(f, 2, 6, -1, 3);
  refused(f, 0, g);
}

static void wall_leaves_floor(void **state) {
  fixture *f = *state;
  uint32_t g = wall(f, 2, 12, 0, 3);
  refused(f, 0, g);
}

/* The same, but with a vertex where it leaves: allowed. */
static void wall_leaves_at_vertex(void **state) {
  fixture *f = *state;
  wall(f, 2, 12, 0, 3);
  pls_point(f->b, 8, 4, 0);
  built(f);
}

static void needle_touches(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 3, 3, 0), q = pls_point(f->b, 2, 2, 5), r = pls_point(f->b, 4, 2, 5);
  pls_triangle(f->b, 2, p, q, r); /* touches the floor with one vertex */
  built(f);
  assert_int_equal(f->s.n_tris, 5);
}

static void corner_on_side(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 8, 3, 0), q = pls_point(f->b, 9, 2, 5), r = pls_point(f->b, 9, 4, 5);
  pls_triangle(f->b, 2, p, q, r);
  built(f);
  assert_int_equal(f->s.n_segments, 5 + 3);
}

/* Coplanar neighbours with unequal sides: T junctions are resolved, then merged. */
static void t_junctions(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 8, 4, 0), q = pls_point(f->b, 12, 4, 0), r = pls_point(f->b, 12, 0, 0);
  pls_quad(f->b, 1, f->floor + 1, r, q, p);
  pls_point(f->b, 0, 0, 9); /* off the plane */
  built(f);
  assert_int_equal(f->s.n_facets, 1);
  assert_int_equal(f->s.n_segments, 7);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 80) < 1e-12);
}

static void overlap(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 4, 4, 0), q = pls_point(f->b, 12, 4, 0), r = pls_point(f->b, 12, 5, 0);
  uint32_t g = pls_triangle(f->b, 1, p, q, r);
  pls_point(f->b, 0, 0, 9);
  refused(f, 0, g);
  assert_non_null(strstr(tet_ctx_error(f->ctx)->message, "facet 0 (marker 1) and facet 1 (marker 1) overlap"));
}

static void overlap_inside(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 4, 4, 0), q = pls_point(f->b, 5, 4, 0), r = pls_point(f->b, 5, 5, 0);
  uint32_t g = pls_triangle(f->b, 7, p, q, r);
  pls_point(f->b, 0, 0, 9);
  refused(f, 0, g);
}

/* The floor once more as two triangles. */
static void overlap_of_equals(void **state) {
  fixture *f = *state;
  pls_triangle(f->b, 1, f->floor, f->floor + 1, f->floor + 2);
  pls_triangle(f->b, 1, f->floor, f->floor + 2, f->floor + 3);
  pls_point(f->b, 0, 0, 9);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_E_INTERSECTION);
  assert_int_equal(tet_ctx_error(f->ctx)->n_offences, 2);
}

/* Two facets through each other along a diagonal that both have. */
static void common_diagonal(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 4, 4, 4), q = pls_point(f->b, 4, 4, -4);
  uint32_t g = pls_quad(f->b, 1, f->floor, p, f->floor + 2, q);
  refused(f, 0, g);
}

static void segment_in_facet(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 1, 1, 0), q = pls_point(f->b, 6, 5, 0);
  pls_point(f->b, 3.5, 3, 0); /* in the middle of it */
  pls_point(f->b, 0, 0, 9);
  pls_segment(f->b, 3, p, q);
  built(f);
  assert_int_equal(f->s.n_segments, 6);
  uint32_t marked = 0;
  for (uint32_t i = 0; i < f->s.n_segments; i++) {
    if (f->s.segment[i].marker != 3) continue;
    marked++;
    assert_int_equal(f->s.segment[i].loose, 1);
    assert_int_equal(ring_size(&f->s, i), 2);
  }
  assert_int_equal(marked, 2);
}

static void segment_pierces(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 1, 2, -1), q = pls_point(f->b, 1, 2, 1);
  pls_segment(f->b, 3, p, q);
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), TET_E_INTERSECTION);
  const tet_error *e = tet_ctx_error(f->ctx);
  assert_int_equal(e->offences[0].kind[0], TET_OFFENDER_FACET);
  assert_int_equal(e->offences[0].kind[1], TET_OFFENDER_SEGMENT);
  assert_int_equal(e->offences[0].marker[1], 3);
  assert_non_null(strstr(e->message, "facet 0 (marker 1) and segment 0 (marker 3) cross near (1, 2, 0)"));
  pls_point(f->b, 1, 2, 0); /* with a vertex there both are split */
  built(f);
}

static void segments_cross(void **state) {
  fixture *f = *state;
  uint32_t p = pls_point(f->b, 0, 0, 5), q = pls_point(f->b, 8, 8, 5);
  uint32_t r = pls_point(f->b, 8, 0, 5), s = pls_point(f->b, 0, 8, 5);
  pls_segment(f->b, 0, p, q);
  pls_segment(f->b, 0, r, s);
  refused(f, 0, 1);
  pls_point(f->b, 4, 4, 5);
  built(f);
  assert_int_equal(f->s.n_segments, 8);
}

/* Overlapping collinear segments become one chain. */
static void segments_overlap(void **state) {
  fixture *f = *state;
  uint32_t v[4];
  for (int i = 0; i < 4; i++) v[i] = pls_point(f->b, i, i, 5);
  pls_segment(f->b, 6, v[0], v[2]);
  pls_segment(f->b, 7, v[3], v[1]);
  built(f);
  assert_int_equal(f->s.n_segments, 4 + 3);
}

/* Two sides in the floor's plane that cross each other there. */
static void walls_cross_on_floor(void **state) {
  fixture *f = *state;
  uint32_t g = wall(f, 2, 6, 0, 3);
  uint32_t p = pls_point(f->b, 4, 2, 0), q = pls_point(f->b, 4, 6, 0), r = pls_point(f->b, 4, 4, -3);
  uint32_t h = pls_triangle(f->b, 2, p, q, r);
  refused(f, g, h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(wall_stands, setup, teardown),
      cmocka_unit_test_setup_teardown(walls_in_line, setup, teardown),
      cmocka_unit_test_setup_teardown(wall_pierces, setup, teardown),
      cmocka_unit_test_setup_teardown(wall_leaves_floor, setup, teardown),
      cmocka_unit_test_setup_teardown(wall_leaves_at_vertex, setup, teardown),
      cmocka_unit_test_setup_teardown(needle_touches, setup, teardown),
      cmocka_unit_test_setup_teardown(corner_on_side, setup, teardown),
      cmocka_unit_test_setup_teardown(t_junctions, setup, teardown),
      cmocka_unit_test_setup_teardown(overlap, setup, teardown),
      cmocka_unit_test_setup_teardown(overlap_inside, setup, teardown),
      cmocka_unit_test_setup_teardown(overlap_of_equals, setup, teardown),
      cmocka_unit_test_setup_teardown(common_diagonal, setup, teardown),
      cmocka_unit_test_setup_teardown(segment_in_facet, setup, teardown),
      cmocka_unit_test_setup_teardown(segment_pierces, setup, teardown),
      cmocka_unit_test_setup_teardown(segments_cross, setup, teardown),
      cmocka_unit_test_setup_teardown(segments_overlap, setup, teardown),
      cmocka_unit_test_setup_teardown(walls_cross_on_floor, setup, teardown),
  };
  return cmocka_run_group_tests_name("surface resolve", tests, NULL, NULL);
}
