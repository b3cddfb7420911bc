// SPDX-License-Identifier: Apache-2.0
/* What the build does where rounding fails: here tet_repair, which the linker wraps, fails the first so many
 * times. The build is done again with its points elsewhere, then without break points; in the end it is refused, and
 * nothing is held. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/context.h"
#include "build/build.h"
#include "build/repair.h"
#include "pls_builder.h"

enum { ATTEMPTS = 8 };

typedef struct trial {
  tet_ctx *ctx;
  tet_build_result made;
  tet_status status;
} trial;

tet_status __real_tet_repair(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, tet_pieces *p,
                             uint32_t **tri, tet_breaks *breaks, tet_counts *counts);
tet_status __wrap_tet_repair(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, tet_pieces *p,
                             uint32_t **tri, tet_breaks *breaks, tet_counts *counts);

tet_status __wrap_tet_repair(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, tet_pieces *p,
                             uint32_t **tri, tet_breaks *breaks, tet_counts *counts) {
  if (mock_type(int)) return tet_fail(ctx, TET_E_ROUNDING, "as told");
  return __real_tet_repair(ctx, surface, exact, p, tri, breaks, counts);
}

/* A box with eight points on a circle in its top, so that its facets and they are locally degenerate, built with
 * rounding failing the first `failures` times. */
static trial build(int failures, int break_points) {
  pls_builder *b = pls_new();
  const double lo[3] = {-8, -8, -8}, hi[3] = {8, 8, 8};
  pls_box(b, 1, lo, hi);
  const double ring[8][2] = {{3, 4}, {4, 3}, {4, -3}, {3, -4}, {-3, -4}, {-4, -3}, {-4, 3}, {-3, 4}};
  for (int i = 0; i < 8; i++) pls_point(b, ring[i][0], ring[i][1], 8);
  trial t = {.status = TET_OK};
  assert_int_equal(tet_ctx_create(NULL, &t.ctx), TET_OK);
  for (int i = 0; i < failures; i++) will_return(__wrap_tet_repair, 1);
  int most = break_points ? 2 * ATTEMPTS : ATTEMPTS;
  if (failures < most) will_return(__wrap_tet_repair, 0);
  const tet_build_options options = {.stage = TET_STAGE_CDT, .threads = 1, .break_points = break_points};
  t.status = tet_build(t.ctx, &b->pls, &options, &t.made);
  pls_free(b);
  return t;
}

static void done(trial *t) {
  if (t->status == TET_OK) tet_build_result_free(t->ctx, &t->made);
  assert_int_equal(tet_ctx_bytes(t->ctx), 0);
  tet_ctx_free(t->ctx);
}

static void points_go_elsewhere(void **state) {
  (void)state;
  trial first = build(0, 1), second = build(1, 1), last = build(ATTEMPTS - 1, 1);
  assert_true(first.status == TET_OK && second.status == TET_OK && last.status == TET_OK);
  const tet_counts *c = &last.made.counts;
  assert_true(c->break_points > 0 && c->degeneracies_left == 0);
  assert_true(first.made.pieces.n_points != second.made.pieces.n_points ||
              memcmp(first.made.pieces.points, second.made.pieces.points,
                     3 * (size_t)first.made.pieces.n_points * sizeof(double)) != 0);
  done(&first);
  done(&second);
  done(&last);
}

static void break_points_are_given_up(void **state) {
  (void)state;
  for (int failures = ATTEMPTS; failures < 2 * ATTEMPTS; failures += ATTEMPTS - 1) {
    trial t = build(failures, 1), plain = build(0, 0);
    assert_true(t.status == TET_OK && plain.status == TET_OK);
    assert_true(t.made.counts.break_points == 0 && t.made.counts.degeneracies_left > 0);
    assert_int_equal(t.made.pieces.n_points, plain.made.pieces.n_points);
    assert_int_equal(t.made.pieces.n_tets, plain.made.pieces.n_tets);
    done(&t);
    done(&plain);
  }
}

static void what_no_attempt_mends_is_refused(void **state) {
  (void)state;
  for (int break_points = 0; break_points < 2; break_points++) {
    trial t = build(break_points ? 2 * ATTEMPTS : ATTEMPTS, break_points);
    assert_int_equal(t.status, TET_E_ROUNDING);
    assert_string_equal(tet_ctx_error(t.ctx)->message, "as told");
    done(&t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(points_go_elsewhere), cmocka_unit_test(break_points_are_given_up),
                                     cmocka_unit_test(what_no_attempt_mends_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
