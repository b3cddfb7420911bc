// SPDX-License-Identifier: Apache-2.0
/* Single facets of any shape, merging of coplanar ones, creases. */
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
} fixture;

/* Point 0 is off the plane z = 0 that the facets lie in. */
static int setup(void **state) {
  static fixture f;
  f.b = pls_new();
  memset(&f.s, 0, sizeof f.s);
  *state = &f;
  pls_point(f.b, 0.3, 0.7, 5);
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

static void refused(fixture *f, tet_status status, uint32_t facet) {
  assert_int_equal(pls_surface(f->b, f->ctx, &f->s), status);
  const tet_error *e = tet_ctx_error(f->ctx);
  assert_true(e->n_offences >= 1);
  assert_int_equal(e->offences[0].kind[0], TET_OFFENDER_FACET);
  assert_int_equal(e->offences[0].index[0], facet);
}

/* A rectangle's four corners; returns the first. */
static uint32_t rectangle(fixture *f, double x0, double y0, double x1, double y1) {
  uint32_t v = pls_point(f->b, x0, y0, 0);
  pls_point(f->b, x1, y0, 0);
  pls_point(f->b, x1, y1, 0);
  pls_point(f->b, x0, y1, 0);
  return v;
}

static void add_rectangle(fixture *f, uint32_t v) {
  const uint32_t p[4] = {v, v + 1, v + 2, v + 3};
  pls_polygon(f->b, 4, p);
}

static void ring_with_hole(void **state) {
  fixture *f = *state;
  uint32_t outer = rectangle(f, 0, 0, 4, 4), inner = rectangle(f, 1, 1, 2, 3);
  pls_facet(f->b, 3);
  add_rectangle(f, outer);
  add_rectangle(f, inner);
  built(f); /* without a hole the inner turn is segments alone */
  assert_int_equal(f->s.n_segments, 8);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 16) < 1e-12);
  tet_surface_free(f->ctx, &f->s);
  pls_hole(f->b, 1.5, 2, 0.3); /* projected */
  built(f);
  assert_int_equal(f->s.n_segments, 8);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 14) < 1e-12);
  assert_int_equal(f->s.facet[0].marker, 3);
}

static void hole_seed_on_side(void **state) {
  fixture *f = *state;
  pls_facet(f->b, 0);
  add_rectangle(f, rectangle(f, 0, 0, 4, 4));
  pls_hole(f->b, 4, 1, 0);
  refused(f, TET_E_SEED, 0);
  f->b->facet_holes[0] = 9;
  refused(f, TET_E_SEED, 0);
  f->b->facet_holes[0] = 2; /* all of the facet */
  refused(f, TET_E_DEGENERATE, 0);
}

/* One polygon with a bridge to an inner turn: the inner rectangle is no part of it. */
static void keyhole_polygon(void **state) {
  fixture *f = *state;
  uint32_t o = rectangle(f, 0, 0, 4, 4), i = rectangle(f, 1, 1, 2, 3);
  const uint32_t p[10] = {o, o + 1, o + 2, o + 3, o, i, i + 3, i + 2, i + 1, i};
  pls_facet(f->b, 0);
  pls_polygon(f->b, 10, p);
  built(f);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 14) < 1e-12);
  assert_int_equal(f->s.n_segments, 9);
}

/* An island in a hole stays. */
static void nested_rings(void **state) {
  fixture *f = *state;
  uint32_t a = rectangle(f, 0, 0, 10, 10), b = rectangle(f, 1, 1, 9, 9), c = rectangle(f, 4, 4, 5, 5);
  pls_facet(f->b, 0);
  add_rectangle(f, a);
  add_rectangle(f, b);
  add_rectangle(f, c);
  pls_hole(f->b, 2, 2, 0);
  built(f);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 37) < 1e-12);
  assert_int_equal(f->s.n_facets, 1);
}

static void nonconvex_with_loose(void **state) {
  fixture *f = *state;
  const double xy[6][2] = {{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}};
  uint32_t v[6];
  for (int i = 0; i < 6; i++) v[i] = pls_point(f->b, xy[i][0], xy[i][1], 0);
  uint32_t p = pls_point(f->b, 1, 1, 0), q = pls_point(f->b, 1, 4, 0), r = pls_point(f->b, 4, 1, 0);
  uint32_t out0 = pls_point(f->b, 4, 4, 0), out1 = pls_point(f->b, 5, 5, 0);
  const uint32_t inside[2] = {p, q}, outside[2] = {out0, out1};
  pls_facet(f->b, 0);
  pls_polygon(f->b, 6, v);
  pls_polygon(f->b, 2, inside);
  pls_polygon(f->b, 2, outside);
  pls_polygon(f->b, 1, &r);
  built(f);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 20) < 1e-12);
  assert_int_equal(f->s.n_segments, 8);
  uint32_t loose = 0, bare = 0;
  for (uint32_t i = 0; i < f->s.n_segments; i++) {
    loose += f->s.segment[i].loose;
    bare += f->s.subseg_tri[i] == TET_NONE;
  }
  assert_int_equal(loose, 2);
  assert_int_equal(bare, 1);
  assert_int_equal(f->s.used[r], 1);
}

/* A facet whose border is given segment by segment is what they enclose. */
static void border_of_segments(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  pls_facet(f->b, 0);
  for (uint32_t i = 0; i < 4; i++) {
    const uint32_t p[2] = {v + i, v + (i + 1) % 4};
    pls_polygon(f->b, 2, p);
  }
  built(f);
  assert_true(fabs(surface_area(&f->s, &f->b->points) - 4) < 1e-12);
}

static void only_a_segment(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  const uint32_t p[2] = {v, v + 2};
  pls_facet(f->b, 0);
  add_rectangle(f, v);
  pls_facet(f->b, 0);
  pls_polygon(f->b, 2, p); /* a facet of one segment, in the plane of the other */
  built(f);
  assert_int_equal(f->s.n_facets, 1);
  assert_int_equal(f->s.n_segments, 5);
  assert_int_equal(f->s.n_tris, 2);
}

static void degenerate_polygons(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  uint32_t mid = pls_point(f->b, 1, 0, 0);
  pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  pls_triangle(f->b, 4, v, mid, v + 1);
  refused(f, TET_E_DEGENERATE, 1);
  assert_int_equal(tet_ctx_error(f->ctx)->offences[0].marker[0], 4);
}

static void crossing_itself(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  pls_quad(f->b, 0, v, v + 2, v + 1, v + 3);
  refused(f, TET_E_INTERSECTION, 0);
  assert_int_equal(tet_ctx_error(f->ctx)->offences[0].index[1], 0);
}

static void out_of_plane(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  f->b->x[3 * (v + 2) + 2] = 1e-6;
  pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  refused(f, TET_E_NOT_PLANAR, 0);
  tet_status st = tet_surface_build(f->ctx, &f->b->pls, &f->b->points, 1e-6, 0, &f->s);
  assert_int_equal(st, TET_OK);
  assert_null(surface_fault(&f->s, &f->b->points));
  assert_true(f->s.planarity > 2e-7 && f->s.planarity < 3e-7);
  assert_int_equal(f->s.n_facets, 1);
  assert_int_equal(f->s.n_patches, 2);
  uint32_t n = 0;
  for (uint32_t i = 0; i < f->s.n_segments; i++) n += f->s.segment[i].crease;
  assert_int_equal(n, 1);
  assert_int_equal(f->s.n_segments, 5);
}

/* A fan of triangles: one facet if the markers agree, Delaunay again; a vertex
 * stays; with two markers the two sides between them are segments. */
static void merged_fan(void **state) {
  fixture *f = *state;
  const double xy[5][2] = {{0, 0}, {10, 0}, {10, 1}, {5, 1.5}, {0, 1}};
  for (int i = 0; i < 5; i++) pls_point(f->b, xy[i][0], xy[i][1], 0);
  for (uint32_t i = 2; i < 5; i++) pls_triangle(f->b, 8, 1, i, i + 1);
  built(f);
  assert_int_equal(f->s.n_facets, 1);
  assert_int_equal(f->s.n_patches, 1);
  assert_int_equal(f->s.facet[0].input, 0);
  assert_int_equal(f->s.n_segments, 5);
  tet_surface_free(f->ctx, &f->s);
  f->b->facet_markers[1] = 9;
  built(f);
  assert_int_equal(f->s.n_facets, 3);
  assert_int_equal(f->s.n_segments, 7);
  tet_surface_free(f->ctx, &f->s);
  f->b->facet_markers[1] = 8; /* a third facet on an inner side keeps it */
  pls_triangle(f->b, 8, 1, 3, 0);
  built(f);
  assert_int_equal(f->s.n_facets, 3);
}

static uint32_t creases(fixture *f, double merge_angle) {
  uint32_t n = 0;
  tet_surface_free(f->ctx, &f->s);
  memset(&f->s, 0, sizeof f->s);
  assert_int_equal(tet_surface_build(f->ctx, &f->b->pls, &f->b->points, 1e-6, merge_angle, &f->s), TET_OK);
  assert_null(surface_fault(&f->s, &f->b->points));
  for (uint32_t i = 0; i < f->s.n_segments; i++) n += f->s.segment[i].crease;
  return n;
}

/* Two squares at atan(0.1), 5.71 degrees, off flat; the side between them is a crease if the caller
 * says so, unless it is more than theirs, or its facets differ. Folded back they are not flat. */
static void merged_by_an_angle(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 1, 1);
  pls_point(f->b, 2, 0, 0.1), pls_point(f->b, 2, 1, 0.1);
  pls_quad(f->b, 8, v, v + 1, v + 2, v + 3);
  pls_quad(f->b, 8, v + 1, v + 4, v + 5, v + 2);
  assert_int_equal(creases(f, 0), 0);
  assert_int_equal(creases(f, 5.7), 0);
  assert_true(f->s.merged_angle == 0 && f->s.merged_distance == 0);
  assert_int_equal(creases(f, 5.72), 1);
  assert_int_equal(f->s.n_facets, 2);
  assert_int_equal(f->s.n_segments, 7);
  assert_true(fabs(f->s.merged_angle - 5.710593) < 1e-6);
  assert_true(fabs(f->s.merged_distance - 0.1) < 1e-9); /* of the second one's far side from the first one's plane */
  f->b->facet_markers[1] = 9;
  assert_int_equal(creases(f, 45), 0);
  f->b->facet_markers[1] = 8;
  f->b->x[3 * (v + 4)] = f->b->x[3 * (v + 5)] = 0;
  assert_int_equal(creases(f, 45), 0);
  f->b->x[3 * (v + 4)] = f->b->x[3 * (v + 5)] = 2;
  pls_segment(f->b, 0, v + 2, v + 1);
  assert_int_equal(creases(f, 45), 0);
  f->b->pls.n_segments = 0;
  assert_int_equal(creases(f, 45), 1);
  pls_triangle(f->b, 8, v + 1, v + 2, 0);
  assert_int_equal(creases(f, 45), 0);
}

static void declared_segment_is_kept(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 2, 2);
  pls_triangle(f->b, 8, v, v + 1, v + 2);
  pls_triangle(f->b, 8, v, v + 2, v + 3);
  pls_segment(f->b, 5, v + 2, v);
  built(f);
  assert_int_equal(f->s.n_facets, 2);
  assert_int_equal(f->s.n_segments, 5);
  int seen = 0;
  for (uint32_t i = 0; i < 5; i++) {
    const tet_segment *g = &f->s.segment[i];
    if (g->a != v || g->b != v + 2) continue;
    seen = 1;
    assert_int_equal(g->marker, 5);
    assert_int_equal(g->loose, 0);
  }
  assert_true(seen);
}

/* A slanted needle that rounding has bent is as far out of plane as rounding goes, not as its normal, noise
 * in doubles, goes along its length. */
static void needle_out_of_plane(void **state) {
  fixture *f = *state;
  const double thin = 0x1p-38;
  for (int k = 0; k < 20; k++) {
    const double along[3] = {(k + 1) / 3.0, (k + 2) / 7.0, 2 / 3.0}, o = 3.0 * k;
    const double across[3] = {thin * (k + 2) / 7, -thin * (k + 1) / 3, thin * k / 9};
    uint32_t v = pls_point(f->b, o, 0, 0);
    pls_point(f->b, o + along[0], along[1], along[2]);
    pls_point(f->b, o + (along[0] + across[0]), along[1] + across[1], along[2] + across[2]);
    pls_point(f->b, o + across[0], across[1], across[2]);
    pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  }
  built(f);
  assert_true(f->s.planarity > 0 && f->s.planarity < 1e-14);
}

/* Many cocircular points: ties everywhere, and the result depends on indices alone. */
static void grid_of_points(void **state) {
  fixture *f = *state;
  uint32_t v = rectangle(f, 0, 0, 20, 20);
  for (int y = 0; y <= 20; y++)
    for (int x = 0; x <= 20; x++) pls_point(f->b, x, y, 0);
  pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  built(f);
  assert_int_equal(f->s.n_tris, 800);
  assert_int_equal(f->s.n_segments, 80);
  assert_int_equal(f->s.n_duplicates, 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(ring_with_hole, setup, teardown),
      cmocka_unit_test_setup_teardown(hole_seed_on_side, setup, teardown),
      cmocka_unit_test_setup_teardown(keyhole_polygon, setup, teardown),
      cmocka_unit_test_setup_teardown(nested_rings, setup, teardown),
      cmocka_unit_test_setup_teardown(nonconvex_with_loose, setup, teardown),
      cmocka_unit_test_setup_teardown(border_of_segments, setup, teardown),
      cmocka_unit_test_setup_teardown(only_a_segment, setup, teardown),
      cmocka_unit_test_setup_teardown(degenerate_polygons, setup, teardown),
      cmocka_unit_test_setup_teardown(crossing_itself, setup, teardown),
      cmocka_unit_test_setup_teardown(out_of_plane, setup, teardown),
      cmocka_unit_test_setup_teardown(needle_out_of_plane, setup, teardown),
      cmocka_unit_test_setup_teardown(merged_fan, setup, teardown),
      cmocka_unit_test_setup_teardown(merged_by_an_angle, setup, teardown),
      cmocka_unit_test_setup_teardown(declared_segment_is_kept, setup, teardown),
      cmocka_unit_test_setup_teardown(grid_of_points, setup, teardown),
  };
  return cmocka_run_group_tests_name("surface facets", tests, NULL, NULL);
}
