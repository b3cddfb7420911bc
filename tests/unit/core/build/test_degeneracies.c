// SPDX-License-Identifier: Apache-2.0
/* LOCALDEGENERACYREMOVAL: before rounding no two neighbouring triangles of a patch are cocircular, patches
 * are exactly flat and constrained Delaunay still, and segments and facets can be recovered. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "build/state.h"
#include "exact/predicates.h"
#include "mesh/delaunay.h"
#include "pls_builder.h"

typedef struct fixture {
  tet_ctx *ctx;
  pls_builder *b;
  tet_state st;
} fixture;

static int setup(void **state) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  assert_int_equal(tet_ctx_create(NULL, &f->ctx), TET_OK);
  f->b = pls_new();
  *state = f;
  return 0;
}

static int teardown(void **state) {
  fixture *f = *state;
  tet_state_free(&f->st);
  int leaked = tet_ctx_bytes(f->ctx) != 0;
  tet_ctx_free(f->ctx);
  pls_free(f->b);
  free(f);
  return leaked;
}

/* The surface and D_0 of what was built. */
static void begin(fixture *f, double tolerance) {
  tet_state *st = &f->st;
  assert_int_equal(tet_state_init(st, f->ctx, &f->b->pls), TET_OK);
  st->complex.is_canonical = 1;
  assert_int_equal(tet_surface_build(f->ctx, st->pls, &st->points, tolerance, 0, &st->surface), TET_OK);
  uint32_t n = 0, *ids = calloc(st->n_input, sizeof *ids);
  assert_non_null(ids);
  for (uint32_t v = 0; v < st->n_input; v++)
    if (st->surface.used[v]) ids[n++] = v;
  assert_int_equal(tet_delaunay(&st->complex, ids, n, 1), TET_OK);
  free(ids);
}

/* Pairs of neighbouring triangles whose four vertices are on one sphere with any input vertex off their plane. */
static size_t cocircular(const tet_state *st) {
  const tet_surface *s = &st->surface;
  size_t n = 0;
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    uint32_t g = s->tri_adj[h], *v = s->tri + h - h % 3, off = 0;
    if (g == TET_NONE || g < h) continue;
    while (!st->surface.used[off] || !tet_orient3d(&st->points, v[0], v[1], v[2], off)) off++;
    n += tet_insphere(&st->points, v[0], v[1], v[2], off, s->tri[g - g % 3 + (g + 2) % 3]) == 0;
  }
  return n;
}

static void check(const fixture *f, double area) {
  const tet_state *st = &f->st;
  const char *fault = surface_fault(&st->surface, &st->points);
  if (fault) fail_msg("%s", fault);
  assert_true(fabs(surface_area(&st->surface, &st->points) - area) <= 1e-9 * area);
  for (uint32_t v = st->n_input; v < st->points.n; v++) assert_int_not_equal(st->complex.at[v], TET_NONE);
  assert_int_equal(st->counts.degeneracies_left, cocircular(st));
}

/* Removes all degeneracies, recovers segments, again until there is nothing left, and recovers facets. */
static uint32_t remove_all(fixture *f) {
  tet_state *st = &f->st;
  double area = surface_area(&st->surface, &st->points);
  size_t added = 0, sum = 0;
  for (int round = 0; round == 0 || added; round++) {
    assert_true(round < 8);
    assert_int_equal(tet_remove_degeneracies(st, 1, &added), TET_OK);
    check(f, area);
    assert_int_equal(st->counts.degeneracies_left, 0);
    sum += added;
    assert_int_equal(tet_recover_segments(st), TET_OK);
  }
  assert_int_equal(cocircular(st), 0);
  assert_int_equal(st->counts.break_points, sum);
  assert_int_equal(st->points.n - st->n_input, sum + st->counts.segment_steiner_points);
  uint32_t *face_tri = NULL;
  assert_int_equal(tet_recover_facets(st, &face_tri), TET_OK);
  tet_free(f->ctx, face_tri);
  return (uint32_t)sum;
}

/* How many Steiner points there are on facets. */
static uint32_t on_facets(const fixture *f) {
  uint32_t n = 0;
  for (uint32_t i = 0; i < f->st.points.n - f->st.n_input; i++) n += f->st.carrier[i].origin == TET_ORIGIN_FACET;
  return n;
}

/* A point (x, y) of a plane of no two axes, which is drawn five times as large as it is. */
static uint32_t place(fixture *f, int x, int y) { return pls_point(f->b, 5 * x, 3 * y, 4 * y); }

/* A polygon in that plane as a facet; and a vertex off it, loose. */
static void tilted(fixture *f, int n, const int at[][2]) {
  uint32_t v[16];
  for (int i = 0; i < n; i++) v[i] = place(f, at[i][0], at[i][1]);
  pls_facet(f->b, 0);
  pls_polygon(f->b, n, v);
  pls_point(f->b, 0, 1, 40);
}

static void a_square_takes_a_point_on_a_side(void **state) {
  fixture *f = *state;
  tilted(f, 4, (const int[][2]){{0, 0}, {2, 0}, {2, 2}, {0, 2}});
  begin(f, 1e-9);
  assert_int_equal(cocircular(&f->st), 1);
  assert_int_equal(remove_all(f), 1); /* in the square every point encroaches upon a side */
  assert_int_equal(on_facets(f), 0);
}

static void a_square_with_its_centre_needs_none(void **state) {
  fixture *f = *state;
  tilted(f, 4, (const int[][2]){{0, 0}, {2, 0}, {2, 2}, {0, 2}});
  place(f, 1, 1);
  begin(f, 1e-9);
  assert_int_equal(f->st.surface.n_tris, 4);
  assert_int_equal(remove_all(f), 0);
}

/* Six and twelve vertices on one circle: one point ends all degeneracies. */
static void a_hexagon_takes_one_point_inside(void **state) {
  fixture *f = *state;
  tilted(f, 6, (const int[][2]){{5, 0}, {3, 4}, {-3, 4}, {-5, 0}, {-3, -4}, {3, -4}});
  begin(f, 1e-9);
  assert_int_equal(cocircular(&f->st), 3);
  assert_int_equal(remove_all(f), 1);
  assert_int_equal(on_facets(f), 1);
  assert_int_equal(f->st.surface.n_tris, 6);
}

static void a_dodecagon_takes_one_point_inside(void **state) {
  fixture *f = *state;
  tilted(f, 12, (const int[][2]){{5, 0}, {4, 3}, {3, 4}, {0, 5}, {-3, 4}, {-4, 3}, {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}});
  begin(f, 1e-9);
  assert_int_equal(cocircular(&f->st), 9);
  assert_int_equal(remove_all(f), 1);
  assert_int_equal(on_facets(f), 1);
}

static void a_cube_takes_points_on_its_edges(void **state) {
  fixture *f = *state;
  pls_box(f->b, 0, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1});
  begin(f, 1e-9);
  assert_int_equal(cocircular(&f->st), 6);
  uint32_t n = remove_all(f);
  assert_true(n >= 3 && n <= 6); /* each is of two sides */
  assert_int_equal(on_facets(f), 0);
}

/* Six grids of 4 x 4 vertices, of squares or of triangles. */
static void grid(fixture *f, int split) {
  enum { N = 3 };
  uint32_t at[N + 1][N + 1][N + 1];
  for (int i = 0; i <= N; i++)
    for (int j = 0; j <= N; j++)
      for (int k = 0; k <= N; k++)
        if (i % N == 0 || j % N == 0 || k % N == 0) at[i][j][k] = pls_point(f->b, 0.1 * i, 0.1 * j, 0.1 * k);
  for (int side = 0; side < 6; side++)
    for (int i = 0; i < N; i++)
      for (int j = 0; j < N; j++) {
        uint32_t v[4];
        for (int c = 0; c < 4; c++) {
          int p = i + (c == 1 || c == 2), q = j + (c > 1), s = side % 2 * N;
          v[c] = side / 2 == 0 ? at[s][p][q] : side / 2 == 1 ? at[p][s][q] : at[p][q][s];
        }
        if (!split) pls_quad(f->b, side, v[0], v[1], v[2], v[3]);
        else pls_triangle(f->b, side, v[0], v[1], v[2]), pls_triangle(f->b, side, v[0], v[2], v[3]);
      }
  begin(f, 1e-9);
  size_t before = cocircular(&f->st);
  assert_true(before > 0 && before <= 54);
  uint32_t n = remove_all(f);
  assert_true(n <= before && on_facets(f) > 0);
}

static void grids_of_squares(void **state) { grid(*state, 0); }

static void grids_of_triangles(void **state) { grid(*state, 1); }

/* Two cubes with a common wall, and another one's facet with a square hole. */
static void shared_walls_and_holes(void **state) {
  fixture *f = *state;
  uint32_t v = pls_box(f->b, 0, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1});
  uint32_t w[4];
  for (uint32_t i = 0; i < 4; i++) w[i] = pls_point(f->b, 2, i & 1, i >> 1);
  const uint32_t near[4] = {v + 1, v + 3, v + 5, v + 7};
  pls_quad(f->b, 9, w[0], w[1], w[3], w[2]);
  pls_quad(f->b, 9, near[0], near[1], w[1], w[0]);
  pls_quad(f->b, 9, near[2], near[3], w[3], w[2]);
  pls_quad(f->b, 9, near[0], near[2], w[2], w[0]);
  pls_quad(f->b, 9, near[1], near[3], w[3], w[1]);
  uint32_t o[4], i[4];
  for (uint32_t k = 0; k < 4; k++) {
    double x = k == 1 || k == 2, y = k > 1;
    o[k] = pls_point(f->b, 4 * x, 4 * y, -3);
    i[k] = pls_point(f->b, 1 + 2 * x, 1 + 2 * y, -3);
  }
  pls_facet(f->b, 11);
  pls_polygon(f->b, 4, o);
  pls_polygon(f->b, 4, i);
  pls_hole(f->b, 2, 2, -3);
  begin(f, 1e-9);
  assert_true(cocircular(&f->st) > 8);
  remove_all(f);
}

/* Out of plane, the two triangles are patches of their own, and what is between them is left alone. */
static void a_bent_square_needs_none(void **state) {
  fixture *f = *state;
  uint32_t v = pls_point(f->b, 0, 0, 0);
  pls_point(f->b, 1, 0, 0), pls_point(f->b, 1, 1, 1e-7), pls_point(f->b, 0, 1, 0);
  pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  pls_point(f->b, 0, 1, 4);
  begin(f, 1e-6);
  assert_int_equal(f->st.surface.n_patches, 2);
  assert_int_equal(remove_all(f), 0);
}

/* Steiner points in pairs on opposite sides of a rectangle: all corners of the degenerate pairs are implicit. */
static void steiner_points_level_with_each_other(void **state) {
  fixture *f = *state;
  tilted(f, 4, (const int[][2]){{0, 0}, {4, 0}, {4, 1}, {0, 1}});
  begin(f, 1e-9);
  tet_state *st = &f->st;
  for (uint32_t e = 0, n = st->surface.n_subsegs; e < n; e++) {
    const tet_segment *g = &st->surface.segment[e];
    if (st->points.x[3 * (size_t)g->a] == st->points.x[3 * (size_t)g->b]) continue; /* a short side */
    uint32_t v, at = e;
    for (int k = 1; k < 8; k++) {
      assert_int_equal(tet_state_split(st, at, 0.125 * k, &v), TET_OK);
      at = st->surface.n_subsegs - 1;
    }
  }
  assert_int_equal(st->points.n - st->n_input, 14);
  assert_int_equal(cocircular(st), 8);
  size_t added;
  assert_int_equal(tet_remove_degeneracies(st, 0, &added), TET_OK);
  assert_true(added == 0 && st->counts.degeneracies_left == 8 && st->counts.break_points == 0);
  assert_int_equal(tet_remove_degeneracies(st, 1, &added), TET_OK);
  check(f, surface_area(&st->surface, &st->points));
  assert_int_equal(st->counts.degeneracies_left, 0);
  assert_true(added >= 4 && added <= 8);
}

/* Corners so close that no point fits between them: they stay as they are. */
static void too_small_to_break(void **state) {
  fixture *f = *state;
  double s = 0x1p-40;
  uint32_t v = pls_point(f->b, 1, 1, 0);
  pls_point(f->b, 1 + s, 1, 0), pls_point(f->b, 1 + s, 1 + s, 0), pls_point(f->b, 1, 1 + s, 0);
  pls_quad(f->b, 0, v, v + 1, v + 2, v + 3);
  pls_point(f->b, 0, 1, 4);
  begin(f, 1e-9);
  size_t added;
  assert_int_equal(tet_remove_degeneracies(&f->st, 1, &added), TET_OK);
  assert_true(added == 0 && f->st.counts.degeneracies_left == 1);
}

/* The same points twice. */
static void is_deterministic(void **state) {
  fixture *f = *state;
  grid(f, 1);
  uint32_t n = f->st.points.n;
  double *x = malloc(3 * (size_t)n * sizeof *x);
  assert_non_null(x);
  memcpy(x, f->st.points.x, 3 * (size_t)n * sizeof *x);
  tet_state_free(&f->st);
  begin(f, 1e-9);
  remove_all(f);
  assert_int_equal(f->st.points.n, n);
  assert_memory_equal(f->st.points.x, x, 3 * (size_t)n * sizeof *x);
  free(x);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void) {
  const struct CMUnitTest tests[] = {TEST(a_square_takes_a_point_on_a_side), TEST(a_square_with_its_centre_needs_none),
                                     TEST(a_hexagon_takes_one_point_inside), TEST(a_dodecagon_takes_one_point_inside),
                                     TEST(a_cube_takes_points_on_its_edges), TEST(grids_of_squares),
                                     TEST(grids_of_triangles), TEST(shared_walls_and_holes),
                                     TEST(a_bent_square_needs_none), TEST(steiner_points_level_with_each_other),
                                     TEST(too_small_to_break), TEST(is_deterministic)};
  return cmocka_run_group_tests_name("degeneracies", tests, NULL, NULL);
}
