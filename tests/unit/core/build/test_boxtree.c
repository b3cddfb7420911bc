// SPDX-License-Identifier: Apache-2.0
/* Pairs of boxes: each that matters once, and about as many as there are, however they lie. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "build/boxtree.h"

enum { MOST = 4000, ALL = 400 };

typedef struct triangles {
  double x[MOST][3][3];
  uint32_t n;
  uint64_t asked;
  uint8_t *seen; /* [n][n], or NULL */
} triangles;

static uint64_t state_of_chance;

/* In [-1, 1]. */
static double chance(void) {
  state_of_chance = state_of_chance * 6364136223846793005u + 1442695040888963407u;
  return (double)(int64_t)(state_of_chance >> 11) * 0x1p-52 - 1;
}

static void corners(void *user, uint32_t i, const double *ret_x[3]) {
  const triangles *t = user;
  for (int k = 0; k < 3; k++) ret_x[k] = t->x[i][k];
}

static tet_status count(void *user, uint32_t i, uint32_t j) {
  triangles *t = user;
  assert_true(i < j && j < t->n);
  t->asked++;
  if (t->seen) t->seen[i * (size_t)t->n + j]++;
  return TET_OK;
}

static void find_pairs(triangles *t) {
  tet_ctx *ctx;
  tet_box *box = calloc(t->n, sizeof *box);
  for (uint32_t i = 0; i < t->n; i++)
    for (int k = 0; k < 3; k++) {
      box[i].lo[k] = box[i].hi[k] = t->x[i][0][k];
      for (int c = 1; c < 3; c++) {
        if (t->x[i][c][k] < box[i].lo[k]) box[i].lo[k] = t->x[i][c][k];
        if (t->x[i][c][k] > box[i].hi[k]) box[i].hi[k] = t->x[i][c][k];
      }
    }
  t->asked = 0;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(tet_box_pairs(ctx, box, t->n, corners, count, t), TET_OK);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  free(box);
}

/* Walls side by side, aslant: all boxes meet, and no walls. */
static void walls_aslant(void **state) {
  (void)state;
  static triangles t;
  uint64_t before = 0;
  for (t.n = 1000; t.n <= MOST; t.n *= 2) {
    for (uint32_t i = 0; i < t.n; i++) {
      double at = 0.5 * i, length = t.n;
      const double x[3][3] = {{at, 0, 0}, {at + 0.4 * length, 0.9 * length, 0.1 * length},
                              {at + 0.4 * length, 0.9 * length, 0.1 * length + 1}};
      memcpy(t.x[i], x, sizeof x);
    }
    find_pairs(&t);
    assert_true(t.asked < 48 * (uint64_t)t.n);
    if (before) assert_true(t.asked < 5 * before / 2);
    before = t.asked;
  }
}

/* Triangles about one point: all meet there, and each pair is asked about once. */
static void all_meet(void **state) {
  (void)state;
  static triangles t;
  static const double scales[] = {1, 1e-9, 1e150}, offsets[] = {0, 1e3, 0};
  for (int run = 0; run < 3; run++) {
    t.n = ALL;
    state_of_chance = 17 + (uint64_t)run;
    t.seen = calloc(ALL, ALL);
    for (uint32_t i = 0; i < t.n; i++)
      for (int k = 0; k < 3; k++) {
        double u = chance(), v = 1e-3 * chance(); /* long and thin, around the offset */
        t.x[i][0][k] = u + v;
        t.x[i][1][k] = u - v;
        t.x[i][2][k] = -u;
        for (int c = 0; c < 3; c++) t.x[i][c][k] = (t.x[i][c][k] + offsets[run]) * scales[run];
      }
    find_pairs(&t);
    assert_int_equal(t.asked, (uint64_t)ALL * (ALL - 1) / 2);
    for (uint32_t i = 0; i < ALL; i++)
      for (uint32_t j = i + 1; j < ALL; j++) assert_int_equal(t.seen[i * ALL + j], 1);
    free(t.seen);
    t.seen = NULL;
  }
}

/* Chains of needles, each touching the next in a corner, in all directions: touching counts. */
static void touching_is_asked_about(void **state) {
  (void)state;
  static triangles t;
  t.n = ALL;
  t.seen = calloc(ALL, ALL);
  state_of_chance = 5;
  double at[3] = {0, 0, 0};
  for (uint32_t i = 0; i < t.n; i++)
    for (int k = 0; k < 3; k++) {
      t.x[i][0][k] = at[k];
      t.x[i][1][k] = 0.5 * at[k] + 1e-9 * chance();
      t.x[i][2][k] = at[k] = 10 * chance();
    }
  find_pairs(&t);
  for (uint32_t i = 1; i < ALL; i++) assert_int_equal(t.seen[(i - 1) * ALL + i], 1);
  free(t.seen);
  t.seen = NULL;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(walls_aslant), cmocka_unit_test(all_meet),
                                     cmocka_unit_test(touching_is_asked_about)};
  return cmocka_run_group_tests_name("box tree", tests, NULL, NULL);
}
