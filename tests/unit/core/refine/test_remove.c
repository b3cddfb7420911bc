// SPDX-License-Identifier: Apache-2.0
/* Points inserted on segments, on facets and in the volume, and removed again. */
#include "refine/refiner.h"
#include "solids.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

typedef struct world {
  tet_ctx *ctx;
  solid s;
  tet_build_result built;
  double volume;
  refiner r;
} world;

/* One or two tetrahedra, about regular, so that nothing is encroached: with a face in common, or but an edge. */
typedef enum shape { ONE, ON_A_FACE, AT_AN_EDGE } shape;

static void stack(solid *s, shape which) {
  static const double x[6][3] = {{0, 0, 0}, {1, 0.03, 0.01}, {0.52, 0.87, 0}, {0.5, 0.3, 0.84}, {0.49, 0.27, -0.83},
                                 {0.51, -0.82, -0.01}};
  static const uint32_t on_a_face[7][3] = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 4}, {1, 2, 4}, {2, 0, 4}};
  static const uint32_t at_an_edge[8][3] = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3},
                                            {0, 1, 4}, {0, 1, 5}, {1, 4, 5}, {4, 0, 5}};
  uint32_t n = which == ONE ? 4 : which == ON_A_FACE ? 7 : 8;
  memset(s, 0, sizeof *s);
  memcpy(s->points, x, sizeof x);
  memcpy(s->polygon_vertices, which == AT_AN_EDGE ? at_an_edge : on_a_face, 3 * n * sizeof(uint32_t));
  for (uint32_t i = 0; i <= n; i++) s->polygon_start[i] = 3 * i;
  s->pls = (tet_pls){.n_points = which == ONE ? 4 : which == ON_A_FACE ? 5 : 6, .points = s->points[0], .n_facets = n,
                     .n_polygons = n, .polygon_start = s->polygon_start, .polygon_vertices = s->polygon_vertices};
}

/* The refiner of that, ready for its first point. */
static void begin(world *w, shape which) {
  stack(&w->s, which);
  assert_int_equal(tet_ctx_create(NULL, &w->ctx), TET_OK);
  assert_int_equal(solid_build(w->ctx, &w->s, &w->built), TET_OK);
  w->volume = pieces_volume(&w->built.pieces);
  tet_stage_begin(w->ctx, "refine");
  w->r = (refiner){.ctx = w->ctx, .out = &w->built.pieces};
  tet_refine_options_default(&w->r.o);
  assert_int_equal(refine_load(&w->r), TET_OK);
  assert_int_equal(refine_open_queue(&w->r), TET_OK);
  assert_int_equal(refine_set_bounds(&w->r), TET_OK);
  assert_int_equal(refine_find_sharp(&w->r), TET_OK);
  assert_int_equal(refine_lfs(&w->r), TET_OK);
  w->r.o.radius_edge = 1000; /* nothing is over it: what is fewer tetrahedra is better */
}

static void end(world *w, uint32_t n_points) {
  assert_int_equal(refine_unload(&w->r), TET_OK);
  refine_release(&w->r);
  assert_null(pieces_fault(&w->built.pieces));
  assert_int_equal(w->built.pieces.n_points, n_points);
  assert_float_equal(pieces_volume(&w->built.pieces), w->volume, 1e-12);
  tet_build_result_free(w->ctx, &w->built);
  assert_int_equal(tet_ctx_bytes(w->ctx), 0);
  tet_ctx_free(w->ctx);
}

static uint32_t some_tet(const refiner *r, uint32_t p) {
  for (size_t h = 0; h < 4 * (size_t)r->mesh.n_slots; h++)
    if (refine_alive(r, (uint32_t)(h / 4)) && r->mesh.v[h] == p) return (uint32_t)(h / 4);
  return TET_NONE;
}

/* Puts the last point, its cavity grown, in, and takes it out: all is as it was. */
static void in_and_out(refiner *r, int take_out) {
  uint32_t p = r->points.n - 1, tets = r->mesh.n_live, segs = r->n_segs;
  int ok;
  assert_int_equal(refine_insert(r, &ok), TET_OK);
  assert_true(ok && r->mesh.n_live > tets);
  if (!take_out) return;
  assert_int_equal(refine_remove(r, p, some_tet(r, p), &ok), TET_OK);
  assert_true(ok);
  assert_int_equal(some_tet(r, p), TET_NONE);
  assert_int_equal(r->mesh.n_live, tets);
  assert_int_equal(r->n_segs, segs);
  for (uint32_t e = 0; e < r->n_segs; e++) assert_int_equal(refine_find_seg(r, r->seg_v[2 * e], r->seg_v[2 * e + 1]), e);
}

static void split_seg(refiner *r, uint32_t e, int take_out) {
  double x[3];
  for (int i = 0; i < 3; i++)
    x[i] = 0.55 * refine_x(r, r->seg_v[2 * (size_t)e])[i] + 0.45 * refine_x(r, r->seg_v[2 * (size_t)e + 1])[i];
  assert_int_equal(refine_add_point(r, x, TET_ORIGIN_SEGMENT, r->seg_of[e]), TET_OK);
  assert_int_equal(refine_cavity_of_seg(r, r->points.n - 1, e, 0), TET_OK);
  in_and_out(r, take_out);
}

static void split_sub(refiner *r, uint32_t sub, int take_out) {
  double x[3] = {0, 0, 0};
  for (int j = 0; j < 9; j++) x[j % 3] += refine_x(r, r->sub_v[3 * (size_t)sub + (size_t)(j / 3)])[j % 3] / 3;
  assert_int_equal(refine_add_point(r, x, TET_ORIGIN_FACET, r->patch[r->sub_patch[sub]].facet), TET_OK);
  assert_int_equal(refine_cavity_of_sub(r, r->points.n - 1, sub, 0), TET_OK);
  in_and_out(r, take_out);
}

static void split_tet(refiner *r, uint32_t t, int take_out) {
  double x[3] = {0, 0, 0};
  for (int j = 0; j < 12; j++) x[j % 3] += refine_x(r, r->mesh.v[4 * (size_t)t + (size_t)(j / 3)])[j % 3] / 4;
  assert_int_equal(refine_add_point(r, x, TET_ORIGIN_VOLUME, TET_NONE), TET_OK);
  assert_int_equal(refine_cavity_of_tet(r, r->points.n - 1, t), TET_OK);
  assert_int_equal(tet_complex_grow(&r->mesh, r->points.n - 1), TET_OK);
  in_and_out(r, take_out);
}

static void one_at_a_time(void **state) {
  (void)state;
  for (shape which = ONE; which <= ON_A_FACE; which++) {
    world w;
    begin(&w, which);
    refiner *r = &w.r;
    uint32_t n = r->points.n;
    for (uint32_t e = 0; e < r->n_segs; e++) split_seg(r, e, 1);
    for (uint32_t s = 0; s < r->n_subs; s++)
      if (r->sub_v[3 * (size_t)s] != TET_NONE) split_sub(r, s, 1);
    for (uint32_t t = 0; t < r->mesh.n_slots; t++)
      if (refine_alive(r, t)) split_tet(r, t, 1);
    end(&w, n);
  }
}

/* Many at once: those on segments encroach upon what others would leave, and stay. */
static void all_that_were_inserted(void **state) {
  (void)state;
  world w;
  begin(&w, ON_A_FACE);
  refiner *r = &w.r;
  uint32_t n = r->points.n, segs = r->n_segs;
  for (uint32_t e = 0; e < segs; e++) split_seg(r, e, 0);
  for (uint32_t s = 0; s < 8; s++)
    if (r->sub_v[3 * (size_t)s] != TET_NONE) split_sub(r, s, 0);
  for (uint32_t t = 0; t < 8; t++)
    if (refine_alive(r, t)) split_tet(r, t, 0);
  uint32_t inserted = r->points.n - n, before = r->mesh.n_live;
  assert_true(inserted > segs);
  r->result.segment_points = r->result.facet_points = r->result.volume_points = inserted; /* as if by the rules */
  assert_int_equal(refine_remove_points(r), TET_OK);
  assert_int_equal(r->result.removed_points, 0); /* as nothing is over the bound */
  r->o.radius_edge = 1.2;
  assert_int_equal(refine_remove_points(r), TET_OK);
  assert_true(r->result.removed_points > 0 && r->mesh.n_live < before);
  end(&w, n + inserted - (uint32_t)r->result.removed_points);
}

/* A point on a segment in which alone the domain meets itself: no faces lead all around it, and it stays. */
static void between_two_parts(void **state) {
  (void)state;
  world w;
  begin(&w, AT_AN_EDGE);
  refiner *r = &w.r;
  uint32_t e = refine_find_seg(r, 0, 1), n = r->points.n;
  int done;
  assert_int_equal(r->mesh.n_live, 2);
  split_seg(r, e, 0);
  assert_int_equal(refine_remove(r, n, some_tet(r, n), &done), TET_OK);
  assert_false(done);
  end(&w, n + 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_at_a_time), cmocka_unit_test(all_that_were_inserted),
                                     cmocka_unit_test(between_two_parts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
