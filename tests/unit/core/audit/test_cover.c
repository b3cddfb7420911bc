// SPDX-License-Identifier: Apache-2.0
/* A mesh that holds its PLS passes; what is missing, doubled, renumbered or shifted is found and
 * named. Where the mesh cannot be spoiled alone, the PLS is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "audit/audit.h"
#include "audit/chain.h"
#include "audit/outline.h"
#include "pls_builder.h"
#include <tet/engine.h>

static tet_ctx *ctx;
static pls_builder *b;
static tet_mesh *mesh;
static uint32_t plate, lid, left, right, bent, wall, outer;

/* A box of 4 parted in two at x = 2. In it: a plate with a hole, two coplanar squares that become one
 * facet, a pentagon a little out of plane, a loose segment; beside it a triangle outside. */
static int set_up(void **state) {
  (void)state;
  if (tet_ctx_create(NULL, &ctx) != TET_OK) return 1;
  b = pls_new();
  const double lo[3] = {0, 0, 0}, hi[3] = {4, 4, 4};
  uint32_t v = pls_box(b, 1, lo, hi), w[16];
  w[0] = pls_point(b, 2, 0, 0), w[1] = pls_point(b, 2, 4, 0), w[2] = pls_point(b, 2, 4, 4), w[3] = pls_point(b, 2, 0, 4);
  wall = pls_quad(b, 7, w[0], w[1], w[2], w[3]);
  const double at[2][2] = {{0.5, 1.5}, {0.75, 1.25}};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 4; i++)
      w[4 * k + i] = pls_point(b, at[k][i == 1 || i == 2], 0.5 + (k ? 0.25 : 0) + (i > 1 ? (k ? 1.5 : 2) : 0), 1);
  plate = pls_facet(b, 8);
  pls_polygon(b, 4, w);
  pls_polygon(b, 4, w + 4);
  pls_hole(b, 1, 1, 1);
  for (int i = 0; i < 6; i++) w[i] = pls_point(b, 2.5 + 0.5 * (i % 3), i < 3 ? 1 : 2, 3);
  left = pls_quad(b, 9, w[0], w[1], w[4], w[3]);
  right = pls_quad(b, 9, w[1], w[2], w[5], w[4]);
  const double five[5][2] = {{0.5, 0}, {1.5, 0}, {1.75, 1}, {1, 1.5}, {0.25, 1}};
  for (int i = 0; i < 5; i++) w[i] = pls_point(b, five[i][0], 1 + five[i][1], i == 2 ? 3 + 2e-6 : 3);
  bent = pls_facet(b, 10);
  pls_polygon(b, 5, w);
  w[0] = pls_point(b, 3, 3, 1), w[1] = pls_point(b, 3.5, 3, 2);
  pls_segment(b, 11, w[0], w[1]);
  w[0] = pls_point(b, 6, 1, 1), w[1] = pls_point(b, 6, 2, 2);
  outer = pls_triangle(b, 12, v + 7, w[0], w[1]);
  lid = 1;
  static const double seeds[6] = {1, 3.5, 3.5, 3, 3.5, 3.5};
  b->pls.n_regions = 2;
  b->pls.region_seeds = seeds;
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  tet_mesh_free(mesh);
  mesh = NULL;
  uint64_t leaked = tet_ctx_bytes(ctx);
  tet_ctx_free(ctx);
  pls_free(b);
  return leaked != 0;
}

static double merge_angle;

static void make(tet_stage stage) {
  tet_options options;
  tet_options_default(&options);
  options.merge_angle = merge_angle;
  options.stage = stage;
  options.max_volume = stage == TET_STAGE_REFINE ? 0.2 : 0;
  tet_mesh_free(mesh);
  mesh = NULL;
  tet_status status = tet_mesh_pls(ctx, &b->pls, &options, &mesh);
  if (status != TET_OK) print_message("%s\n", tet_ctx_error(ctx)->message);
  assert_int_equal(status, TET_OK);
}

static tet_audit audit(void) {
  tet_audit a;
  memset(&a, 0xff, sizeof a);
  assert_int_equal(tet_audit_mesh(ctx, &b->pls, mesh, &a), TET_OK);
  return a;
}

static void swap_rows(uint32_t s, uint32_t last) {
  for (uint32_t k = 0; k < 3; k++) {
    uint32_t v = mesh->subfaces[3 * s + k];
    mesh->subfaces[3 * s + k] = mesh->subfaces[3 * last + k];
    mesh->subfaces[3 * last + k] = v;
  }
  uint32_t f = mesh->subface_facets[s];
  mesh->subface_facets[s] = mesh->subface_facets[last];
  mesh->subface_facets[last] = f;
  int32_t m = mesh->subface_markers[s];
  mesh->subface_markers[s] = mesh->subface_markers[last];
  mesh->subface_markers[last] = m;
}

static uint32_t subface_of(uint32_t facet) {
  for (uint32_t s = 0; s < mesh->n_subfaces; s++)
    if (mesh->subface_facets[s] == facet) return s;
  fail();
  return 0;
}

static void passes_a_good_mesh(void **state) {
  (void)state;
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    make(stage);
    assert_int_equal(mesh->facet_same_as[right], left);
    tet_audit a = audit();
    assert_true(a.passed);
    assert_int_equal(a.facet, TET_NONE);
    assert_true(mesh->report.audit.passed);
    for (uint32_t e = 0; e < mesh->n_subsegments; e++) { /* none between the two that are one */
      const double *p = mesh->points + 3 * mesh->subsegments[2 * e], *q = mesh->points + 3 * mesh->subsegments[2 * e + 1];
      assert_false(p[0] == 3 && q[0] == 3 && p[2] == 3 && q[2] == 3);
    }
  }
}

/* A round wall of 24 sides, each 15 degrees from the next. */
static void passes_merged_facets(void **state) {
  (void)state;
  enum { SIDES = 24 };
  pls_free(b);
  b = pls_new();
  uint32_t rim[2][SIDES];
  for (uint32_t i = 0; i < SIDES; i++)
    for (uint32_t k = 0; k < 2; k++) {
      double turn = i * (2 * acos(-1.0) / SIDES);
      rim[k][i] = pls_point(b, 2 * cos(turn), 2 * sin(turn), 1.5 * k);
    }
  for (uint32_t k = 0; k < 2; k++) {
    pls_facet(b, 1);
    pls_polygon(b, SIDES, rim[k]);
  }
  for (uint32_t i = 0, n; i < SIDES; i++) {
    n = (i + 1) % SIDES;
    pls_triangle(b, 2, rim[0][i], rim[0][n], rim[1][n]);
    pls_triangle(b, 2, rim[0][i], rim[1][n], rim[1][i]);
  }
  const double angles[] = {0, 14, 16};
  for (int k = 0; k < 3; k++) {
    merge_angle = angles[k];
    make(TET_STAGE_REFINE);
    merge_angle = 0;
    const tet_promise *p = &mesh->report.promised;
    assert_true(mesh->report.audit.passed && p->gabriel && p->merge_angle == angles[k]);
    assert_true(k < 2 ? p->merged_angle < 1e-6 : fabs(p->merged_angle - 15) < 1e-6);
    assert_true(k < 2 ? p->merged_distance < 1e-9 : p->merged_distance > 0.1 && p->merged_distance < 0.6);
  }
}

/* Each one taken away: that is a hole in its facet's cover, wherever it is. */
static void finds_every_dropped_subface(void **state) {
  (void)state;
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    make(stage);
    uint32_t last = --mesh->n_subfaces;
    for (uint32_t s = 0; s <= last; s += stage == TET_STAGE_CDT ? 1 : 7) {
      uint32_t facet = mesh->subface_facets[s];
      swap_rows(s, last);
      tet_audit a = audit();
      assert_false(a.passed);
      assert_int_equal(a.bad_facets, 1);
      assert_int_equal(a.facet, facet);
      swap_rows(s, last);
    }
    mesh->n_subfaces++;
    assert_true(audit().passed);
  }
}

static void finds_a_dropped_facet(void **state) {
  (void)state;
  const uint32_t facets[] = {plate, left, bent};
  for (int k = 0; k < 3; k++) {
    make(TET_STAGE_REFINE);
    for (uint32_t s = mesh->n_subfaces; s-- > 0;)
      if (mesh->subface_facets[s] == facets[k]) swap_rows(s, --mesh->n_subfaces);
    tet_audit a = audit();
    assert_int_equal(a.bad_facets, 1);
    assert_int_equal(a.facet, facets[k]);
    assert_int_equal(a.uncovered + a.region_leaks, 0);
    assert_false(a.passed);
  }
}

static void finds_renumbered_subfaces(void **state) {
  (void)state;
  make(TET_STAGE_REFINE);
  mesh->subface_facets[subface_of(wall)] = plate;
  tet_audit a = audit();
  assert_int_equal(a.bad_facets, 2);
  assert_int_equal(a.facet, plate < wall ? plate : wall);
  assert_int_equal(a.wrong_markers, 1);
  assert_false(a.passed);
  make(TET_STAGE_CDT);
  mesh->subface_markers[subface_of(lid)]++;
  a = audit();
  assert_int_equal(a.wrong_markers, 1);
  assert_int_equal(a.bad_facets, 0);
  assert_false(a.passed);
  mesh->subface_markers[subface_of(lid)]--;
  mesh->subface_facets[subface_of(left)] = right; /* a number that no subface may have */
  assert_true(audit().bad_indices > 0);
}

/* A face of a tetrahedron inside is no part of the plate. */
static void finds_a_foreign_subface(void **state) {
  (void)state;
  make(TET_STAGE_REFINE);
  uint32_t plain = mesh->n_tetrahedra;
  for (uint32_t t = 0; t < mesh->n_tetrahedra && plain == mesh->n_tetrahedra; t++) {
    int inner = 1;
    for (int k = 0; k < 4; k++) inner &= mesh->point_origin[mesh->tetrahedra[4 * t + (uint32_t)k]] == TET_ORIGIN_VOLUME;
    if (inner) plain = t;
  }
  assert_true(plain < mesh->n_tetrahedra);
  uint32_t s = subface_of(plate); /* stands in for one of the plate's */
  memcpy(mesh->subfaces + 3 * s, mesh->tetrahedra + 4 * plain, 3 * sizeof *mesh->subfaces);
  tet_audit a = audit();
  assert_int_equal(a.bad_facets, 1);
  assert_int_equal(a.facet, plate);
  assert_true(a.folded_subfaces > 0);
  assert_false(a.passed);
}

static void finds_a_lost_segment(void **state) {
  (void)state;
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    make(stage);
    uint32_t n = 0;
    for (uint32_t e = 0; e < mesh->n_subsegments; e++) {
      if (mesh->subsegment_markers[e] == 11) continue;
      memmove(mesh->subsegments + 2 * n, mesh->subsegments + 2 * e, 2 * sizeof *mesh->subsegments);
      mesh->subsegment_segments[n++] = mesh->subsegment_segments[e];
    }
    assert_true(n < mesh->n_subsegments);
    mesh->n_subsegments = n;
    tet_audit a = audit();
    assert_int_equal(a.bad_segments, 1);
    assert_int_equal(a.bad_facets, 0);
    assert_false(a.passed);
  }
}

/* The segment between two facets goes, and with it what bounds them. */
static void finds_a_broken_chain(void **state) {
  (void)state;
  make(TET_STAGE_REFINE);
  uint32_t count = 0, row = 0;
  for (uint32_t e = 0; e < mesh->n_subsegments; e++) { /* a segment of three and more */
    count = 0;
    for (uint32_t g = 0; g < mesh->n_subsegments; g++)
      count += mesh->subsegment_segments[g] == mesh->subsegment_segments[e];
    row = e;
    if (count > 2) break;
  }
  assert_true(count > 2);
  uint32_t last = --mesh->n_subsegments;
  memcpy(mesh->subsegments + 2 * row, mesh->subsegments + 2 * last, 2 * sizeof *mesh->subsegments);
  mesh->subsegment_segments[row] = mesh->subsegment_segments[last];
  tet_audit a = audit();
  assert_true(a.bad_facets > 0);
  assert_false(a.passed);
}

static void finds_a_shifted_region(void **state) {
  (void)state;
  make(TET_STAGE_CDT);
  for (uint32_t t = 0; t < mesh->n_tetrahedra; t++) mesh->tetrahedron_regions[t] ^= 1;
  tet_audit a = audit();
  assert_int_equal(a.region_leaks, 0);
  assert_int_equal(a.wrong_regions, 2);
  assert_false(a.passed);
  for (uint32_t t = 0; t < mesh->n_tetrahedra; t++) mesh->tetrahedron_regions[t] = 0; /* two parts, one number */
  a = audit();
  assert_int_equal(a.region_leaks, 0);
  assert_true(a.wrong_regions > 0);
  make(TET_STAGE_CDT);
  static const double hole[3] = {1, 3.5, 3.5};
  b->pls.holes = hole;
  b->pls.n_holes = 1;
  a = audit();
  assert_int_equal(a.wrong_regions, 1);
  assert_false(a.passed);
}

/* Its seed is then the seed of no region of the mesh. */
static void passes_a_region_in_a_hole(void **state) {
  (void)state;
  static const double hole[3] = {1.5, 3.75, 3.5};
  b->pls.holes = hole;
  b->pls.n_holes = 1;
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    make(stage);
    assert_int_equal(mesh->n_regions, 1);
    assert_true(audit().passed);
  }
}

static void finds_a_moved_vertex(void **state) {
  (void)state;
  make(TET_STAGE_CDT);
  uint32_t loose = pls_point(b, 1, 1, 2); /* is in the box, and not in the mesh */
  make(TET_STAGE_CDT);
  assert_true(audit().passed);
  b->x[3 * loose] = 1.25;
  tet_audit a = audit();
  assert_int_equal(a.lost_vertices, 1);
  assert_false(a.passed);
}

static void finds_a_lost_vertex(void **state) {
  (void)state;
  uint32_t loose = pls_point(b, 1, 1, 2), none = 0;
  b->pls.n_loose_points = 0;
  b->pls.loose_points = &none;
  make(TET_STAGE_CDT);
  assert_true(audit().passed);
  b->pls.loose_points = &loose;
  b->pls.n_loose_points = 1;
  tet_audit a = audit();
  assert_int_equal(a.lost_vertices, 1);
  assert_false(a.passed);
}

/* Holes of facets: where the seed says, and nowhere else. */
static void finds_wrong_holes(void **state) {
  (void)state;
  for (int stage = TET_STAGE_CDT; stage <= TET_STAGE_REFINE; stage++) {
    const uint32_t holes = b->pls.n_facet_holes, *start = b->pls.facet_hole_start;
    b->pls.n_facet_holes = 0;
    b->pls.facet_hole_start = NULL;
    make(stage);
    assert_true(audit().passed);
    b->pls.n_facet_holes = holes;
    b->pls.facet_hole_start = start;
    tet_audit a = audit(); /* the hole is covered */
    assert_int_equal(a.bad_facets, 1);
    assert_int_equal(a.facet, plate);
    make(stage);
    b->pls.n_facet_holes = 0;
    a = audit(); /* there is no hole */
    assert_int_equal(a.bad_facets, 1);
    assert_int_equal(a.facet, plate);
    b->pls.n_facet_holes = holes;
    double x = b->facet_holes[0];
    b->facet_holes[0] = 0.625; /* the rim is the hole, and what is in it is not */
    a = audit();
    assert_int_equal(a.facet, plate);
    assert_false(a.passed);
    b->facet_holes[0] = x;
  }
}

static void finds_a_wrong_merge(void **state) {
  (void)state;
  make(TET_STAGE_CDT);
  b->facet_markers[right]++;
  tet_audit a = audit();
  assert_int_equal(a.bad_facets, 1);
  assert_int_equal(a.facet, left);
  b->facet_markers[right]--;
  mesh->facet_same_as[right] = right;
  a = audit(); /* one has too much, and the other nothing */
  assert_int_equal(a.bad_facets, 2);
  assert_int_equal(a.facet, left);
  assert_false(a.passed);
}

/* A facet of the PLS that the mesh was never asked for. */
static void finds_a_facet_not_meshed(void **state) {
  (void)state;
  uint32_t w[3] = {pls_point(b, 3, 1, 1), pls_point(b, 3.5, 1, 1), pls_point(b, 3, 1.5, 1)};
  make(TET_STAGE_REFINE); /* its vertices are loose */
  uint32_t facet = pls_triangle(b, 13, w[0], w[1], w[2]), *same = mesh->facet_same_as;
  mesh->facet_same_as = tet_alloc(ctx, facet + 1, sizeof *same);
  memcpy(mesh->facet_same_as, same, facet * sizeof *same);
  mesh->facet_same_as[facet] = facet;
  tet_free(ctx, same);
  assert_true(audit().bad_indices > 0);
  mesh->n_input_facets++;
  tet_audit a = audit();
  assert_int_equal(a.bad_facets, 1);
  assert_int_equal(a.facet, facet);
  assert_false(a.passed);
}

/* A chain cancels however its links are cut, and what is left is told. */
static void adds_chains_up(void **state) {
  (void)state;
  const double x[] = {0, 0, 0, 1, 2, 3, 2, 4, 6, 4, 8, 12, 0, 1, 0}; /* 0 to 3 on one line */
  tet_chain c = {0};
  const tet_link links[] = {{0, 0, 3, 1}, {0, 3, 1, 1}, {0, 1, 0, 1},                  /* out and back */
                            {1, 0, 2, 1}, {1, 3, 1, 1}, {1, 4, 0, 1},                  /* two leftovers and 1 2 */
                            {2, 0, 1, 1}, {2, 1, 2, 1}, {2, 2, 3, 1}, {2, 3, 0, 1}, {2, 0, 4, 0}};
  for (size_t i = 0; i < sizeof links / sizeof *links; i++)
    assert_int_equal(tet_chain_add(ctx, &c, links[i].facet, links[i].from, links[i].to, links[i].n), TET_OK);
  assert_int_equal(tet_chain_reduce(ctx, x, 3, &c), TET_OK);
  assert_int_equal(c.n, 3);
  const tet_link expected[] = {{1, 0, 4, -1}, {1, 0, 1, 1}, {1, 2, 3, -1}};
  for (size_t i = 0; i < 3; i++) {
    int found = 0;
    for (size_t k = 0; k < 3; k++) found |= memcmp(&c.link[i], &expected[k], sizeof *expected) == 0;
    assert_true(found);
  }
  tet_chain_free(ctx, &c);
}

/* Twice the area that the outline of facet f goes around. */
static double outlined(uint32_t f) {
  tet_mesh m = {.points = b->x};
  uint32_t same[64];
  for (uint32_t v = 0; v < 64; v++) same[v] = v;
  m.point_same_as = same;
  tet_facet_view view;
  tet_chain c = {0};
  tet_view_facet(&b->pls, &m, f, &view);
  assert_int_equal(view.axis, 2);
  assert_int_equal(tet_facet_outline(ctx, &b->pls, &m, f, f, view.axis, &c), TET_OK);
  assert_int_equal(tet_chain_reduce(ctx, b->x, f + 1, &c), TET_OK);
  double sum = 0;
  for (size_t i = 0; i < c.n; i++) {
    const double *p = b->x + 3 * c.link[i].from, *q = b->x + 3 * c.link[i].to;
    sum += c.link[i].n * (p[0] * q[1] - p[1] * q[0]);
  }
  tet_chain_free(ctx, &c);
  return sum;
}

/* What is inside an odd number of turns of any polygon. */
static void outlines_facets(void **state) {
  (void)state;
  pls_free(b);
  b = pls_new();
  for (int y = 0; y < 4; y++)
    for (int x = 0; x < 4; x++) pls_point(b, x, y, 0);
  const uint32_t big[4] = {0, 3, 15, 12}, back[4] = {0, 12, 15, 3}, small[4] = {5, 6, 10, 9}, part[4] = {0, 1, 5, 4},
                 half[4] = {1, 2, 14, 13}, bridge[10] = {0, 3, 15, 5, 6, 10, 5, 15, 12, 0},
                 eight[6] = {0, 1, 5, 10, 9, 5}, twice[8] = {0, 3, 15, 12, 0, 3, 15, 12};
  uint32_t f = pls_facet(b, 0);
  pls_polygon(b, 4, big);
  assert_true(outlined(f) == 18);
  f = pls_facet(b, 0);
  pls_polygon(b, 4, back); /* the other way around is the same facet */
  assert_true(outlined(f) == 18);
  f = pls_facet(b, 0);
  pls_polygon(b, 4, big);
  pls_polygon(b, 4, small); /* inside, and no hole */
  assert_true(outlined(f) == 18);
  f = pls_facet(b, 0);
  pls_polygon(b, 4, part);
  pls_polygon(b, 4, half); /* they share a part of a side */
  assert_true(outlined(f) == 2 + 6);
  f = pls_facet(b, 0);
  pls_polygon(b, 10, bridge); /* in, around a triangle, and out again */
  assert_true(outlined(f) == 18 - 1);
  f = pls_facet(b, 0);
  pls_polygon(b, 6, eight); /* two triangles that meet in a vertex, turning in the two senses */
  assert_true(outlined(f) == 1 + 1);
  f = pls_facet(b, 0);
  pls_polygon(b, 8, twice); /* twice around is outside */
  assert_true(outlined(f) == 0);
  f = pls_facet(b, 0);
  pls_polygon(b, 2, big); /* a loose segment bounds nothing */
  pls_polygon(b, 4, small);
  assert_true(outlined(f) == 2);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(passes_a_good_mesh), TEST(passes_merged_facets), TEST(finds_every_dropped_subface), TEST(finds_a_dropped_facet),
      TEST(finds_renumbered_subfaces), TEST(finds_a_foreign_subface), TEST(finds_a_lost_segment),
      TEST(finds_a_broken_chain), TEST(finds_a_shifted_region), TEST(passes_a_region_in_a_hole),
      TEST(finds_a_moved_vertex), TEST(finds_a_lost_vertex),
      TEST(finds_wrong_holes), TEST(finds_a_wrong_merge), TEST(finds_a_facet_not_meshed), TEST(adds_chains_up),
      TEST(outlines_facets)};
  return cmocka_run_group_tests_name("audit against the PLS", tests, NULL, NULL);
}
