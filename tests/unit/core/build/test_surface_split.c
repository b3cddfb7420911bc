// SPDX-License-Identifier: Apache-2.0
/* tet_surface_split: many Steiner points, implicit ones, in all patches at once. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "pls_builder.h"

enum { STEINER = 2000 };

/* A view with room for implicit points behind the input's vertices. */
typedef struct steiner {
  tet_points points;
  double x[3 * (BUILDER_POINTS + STEINER)];
  tet_segment_point implicit[STEINER];
  double t0[STEINER * 2], t1[STEINER * 2]; /* of each subsegment along its segment */
} steiner;

static steiner *begin(const pls_builder *b, const tet_surface *s) {
  steiner *w = calloc(1, sizeof *w);
  assert_non_null(w);
  memcpy(w->x, b->x, 3 * (size_t)b->points.n * sizeof(double));
  w->points = b->points;
  w->points.x = w->x;
  w->points.first_implicit = b->points.n;
  w->points.implicit = w->implicit;
  assert_true(s->n_subsegs < STEINER);
  for (uint32_t e = 0; e < s->n_subsegs; e++) w->t1[e] = 1;
  return w;
}

/* Splits subsegment e at the part `at` of it. */
static void split(steiner *w, tet_ctx *ctx, tet_surface *s, uint32_t e, double at) {
  const tet_segment *g = &s->segment[s->subseg_segment[e]];
  double t = w->t0[e] + at * (w->t1[e] - w->t0[e]);
  uint32_t v = w->points.n++, i = v - w->points.first_implicit;
  w->implicit[i] = (tet_segment_point){g->a, g->b, t};
  tet_segment_point_round(&w->points, &w->implicit[i], w->x + 3 * (size_t)v);
  uint32_t far = s->n_subsegs;
  assert_int_equal(tet_surface_split(ctx, s, &w->points, e, v), TET_OK);
  assert_int_equal(s->n_subsegs, far + 1);
  assert_int_equal(s->subseg[2 * (size_t)e + 1], v);
  assert_int_equal(s->subseg[2 * (size_t)far], v);
  w->t0[far] = t;
  w->t1[far] = w->t1[e];
  w->t1[e] = t;
}

static void split_many(pls_builder *b, uint32_t count, int check_each) {
  tet_ctx *ctx;
  tet_surface s;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(pls_surface(b, ctx, &s), TET_OK);
  steiner *w = begin(b, &s);
  double area = surface_area(&s, &w->points);
  uint64_t rng = 12345;
  for (uint32_t i = 0; i < count; i++) {
    rng = rng * 6364136223846793005ULL + 1442695040888963407ULL;
    uint32_t e = (uint32_t)((rng >> 33) % s.n_subsegs);
    split(w, ctx, &s, e, 0.25 + 0.5 * (double)(rng >> 11 & 0xffff) / 65536.0);
    if (!check_each && i + 1 < count) continue;
    const char *fault = surface_fault(&s, &w->points);
    if (fault) fail_msg("after %u splits: %s", i + 1, fault);
  }
  assert_true(fabs(surface_area(&s, &w->points) - area) <= 1e-9 * area);
  tet_surface_free(ctx, &s);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  free(w);
}

static void box(void **state) {
  static const double lo[3] = {0.1, -0.3, 0.7}, hi[3] = {1.3, 2.2, 1.9};
  (void)state;
  pls_builder *b = pls_new();
  pls_box(b, 0, lo, hi);
  split_many(b, 150, 1);
  pls_free(b);
}

/* Facets of odd normals round a common segment, some with holes. */
static void spine(void **state) {
  (void)state;
  pls_builder *b = pls_new();
  uint32_t p = pls_point(b, 0.1, 0.2, -1), q = pls_point(b, 0.3, -0.1, 2);
  for (int i = 0; i < 9; i++) {
    uint32_t r = pls_point(b, cos(0.7 * i), sin(0.7 * i), 0.1 * i);
    pls_triangle(b, i, p, q, r);
  }
  split_many(b, 300, 0);
  pls_free(b);
}

static void loose_segment(void **state) {
  (void)state;
  pls_builder *b = pls_new();
  uint32_t p = pls_point(b, 0, 0, 0), q = pls_point(b, 1, 3, 2);
  pls_segment(b, 0, p, q);
  split_many(b, 40, 1);
  pls_free(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(box),
      cmocka_unit_test(spine),
      cmocka_unit_test(loose_segment),
  };
  return cmocka_run_group_tests_name("surface split", tests, NULL, NULL);
}
