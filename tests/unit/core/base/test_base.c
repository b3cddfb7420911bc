// SPDX-License-Identifier: Apache-2.0
/* Sorting, Hilbert keys, accounted memory, polling and the stage clock. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/context.h"
#include "base/hilbert.h"
#include "base/sort.h"
#include "base/threads.h"
#include "base/triangle.h"

#ifndef __has_feature
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define IS_SANITIZED 1
#else
#define IS_SANITIZED 0
#endif

static uint64_t next(uint64_t *state) { /* xorshift */
  *state ^= *state << 13;
  *state ^= *state >> 7;
  return *state ^= *state << 17;
}

static void check_sorted(tet_keyed *x, size_t n) {
  uint64_t sum = 0, after = 0;
  for (size_t i = 0; i < n; i++) sum += x[i].key * 31 + x[i].value;
  tet_sort_keyed(x, n);
  for (size_t i = 0; i < n; i++) after += x[i].key * 31 + x[i].value;
  assert_true(sum == after);
  for (size_t i = 1; i < n; i++)
    assert_true(x[i - 1].key < x[i].key || (x[i - 1].key == x[i].key && x[i - 1].value <= x[i].value));
}

static void sorts(void **state) {
  (void)state;
  enum { N = 20000 };
  tet_keyed *x = malloc(N * sizeof *x);
  uint64_t seed = 12345;
  for (size_t n = 0; n < 200; n++) {
    for (size_t i = 0; i < n; i++) x[i] = (tet_keyed){next(&seed) % 50, next(&seed) % 3};
    check_sorted(x, n);
  }
  for (size_t i = 0; i < N; i++) x[i] = (tet_keyed){next(&seed), i};
  check_sorted(x, N);
  check_sorted(x, N); /* sorted already */
  for (size_t i = 0; i < N; i++) x[i] = (tet_keyed){7, N - i};
  check_sorted(x, N); /* one key */
  for (size_t i = 0; i < N; i++) x[i] = (tet_keyed){i < N / 2 ? i : N - i, i};
  check_sorted(x, N); /* up and down, which is hard on median of three */
  free(x);
}

/* Radix sort is stable and by key alone, whatever the number of threads. */
static void radix_sorts(void **state) {
  (void)state;
  enum { N = 30000 };
  tet_keyed *x = malloc(N * sizeof *x), *scratch = malloc(N * sizeof *scratch);
  uint64_t seed = 5;
  assert_true(x && scratch);
  for (uint32_t threads = 1; threads <= 100; threads = threads * 3 + 1)
    for (int kind = 0; kind < 4; kind++)
      for (size_t n = 0; n <= N; n = n * 7 + 1) {
        uint64_t sum = 0;
        for (size_t i = 0; i < n; i++) {
          uint64_t r = next(&seed);
          x[i] = (tet_keyed){kind == 0 ? r : kind == 1 ? r % 5 : kind == 2 ? r >> 12 << 43 : UINT64_MAX - i, i};
          sum += x[i].key;
        }
        tet_sort_radix(x, scratch, n, threads);
        for (size_t i = 0; i < n; i++) sum -= x[i].key;
        assert_true(sum == 0);
        for (size_t i = 1; i < n; i++)
          assert_true(x[i - 1].key < x[i].key || (x[i - 1].key == x[i].key && x[i - 1].value < x[i].value));
      }
  free(x);
  free(scratch);
}

static void mark(void *arg, uint32_t i) { ((uint8_t *)arg)[i]++; }

static void threads_take_every_part_once(void **state) {
  (void)state;
  for (uint32_t n = 0; n <= 400; n += 57) {
    uint8_t seen[512] = {0};
    tet_run_threads(n, mark, seen);
    for (uint32_t i = 0; i < 512; i++) assert_int_equal(seen[i], i < n);
  }
  for (uint32_t parts = 1; parts < 9; parts++) {
    assert_int_equal(tet_part(UINT32_MAX, parts, 0), 0);
    assert_int_equal(tet_part(UINT32_MAX, parts, parts), UINT32_MAX);
    for (uint32_t i = 0; i < parts; i++) assert_true(tet_part(5, parts, i) <= tet_part(5, parts, i + 1));
  }
}

/* Keys taken many at a time are those taken one by one. */
static void hilbert_keys_agree(void **state) {
  (void)state;
  enum { N = 101 };
  double p[3 * N];
  uint32_t ids[N];
  uint64_t seed = 3, keys[N], picked[N];
  for (int i = 0; i < 3 * N; i++) p[i] = (double)(next(&seed) >> 12);
  for (uint32_t i = 0; i < N; i++) ids[i] = N - 1 - i;
  tet_hilbert_box box = tet_hilbert_bound(p, ids, N), same = tet_hilbert_bound(p, NULL, N);
  assert_memory_equal(&box, &same, sizeof box);
  tet_hilbert_keys(&box, p, NULL, N, keys);
  tet_hilbert_keys(&box, p, ids, N, picked);
  for (uint32_t i = 0; i < N; i++) {
    assert_true(keys[i] == tet_hilbert_key(&box, p + 3 * (size_t)i));
    assert_true(picked[i] == keys[N - 1 - i]);
  }
}

/* Blocks of many megabytes grow, shrink and move with what is in them, within the budget. */
static void large_blocks_keep_what_they_hold(void **state) {
  (void)state;
  const tet_limits limits = {.memory_bytes = (uint64_t)64 << 20};
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
  uint64_t *x = NULL, filled = 0;
  size_t capacity = 0, before = 0;
  for (size_t n = 1000; tet_grow(ctx, &x, &capacity, n, sizeof *x) == TET_OK; n = capacity + capacity / 64 + 1) {
    for (; filled < capacity; filled++) x[filled] = filled * 7;
    /* in small steps, but where a sanitizer wants malloc's blocks */
    if (before * sizeof *x > (size_t)4 << 20 && !IS_SANITIZED) assert_true(capacity <= before + before / 16);
    before = capacity;
  }
  assert_int_equal(tet_ctx_error(ctx)->status, TET_E_MEMORY);
  assert_true(IS_SANITIZED || capacity * sizeof *x > limits.memory_bytes / 10 * 9);
  for (uint64_t i = 0; i < filled; i++) assert_true(x[i] == i * 7);
  tet_shrink(ctx, &x, &capacity, 1 << 20, sizeof *x);
  assert_true(tet_ctx_bytes(ctx) < (uint64_t)9 << 20);
  assert_int_equal(tet_grow(ctx, &x, &capacity, 3 << 20, sizeof *x), TET_OK);
  for (uint64_t i = 0; i < 1 << 20; i++) assert_true(x[i] == i * 7);
  tet_free(ctx, x);
  uint8_t *zeroed = tet_calloc(ctx, (size_t)5 << 20, 1);
  assert_non_null(zeroed);
  for (size_t i = 0; i < (size_t)5 << 20; i += 511) assert_int_equal(zeroed[i], 0);
  tet_free(ctx, zeroed);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

/* Under a limit on address space no more of it is taken than is used. */
static void address_space_may_be_short(void **state) {
  (void)state;
  if (IS_SANITIZED) skip(); /* sanitizers need the address space themselves */
  struct rlimit before, limit;
  assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
  limit = before;
  limit.rlim_cur = (rlim_t)256 << 20;
  assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  uint64_t *x[4] = {NULL};
  size_t capacity[4] = {0};
  for (size_t n = 1000; n < (size_t)5 << 20; n += n / 9)
    for (int i = 0; i < 4; i++) {
      size_t from = capacity[i];
      assert_int_equal(tet_grow(ctx, &x[i], &capacity[i], n, sizeof *x[i]), TET_OK);
      for (size_t k = from; k < capacity[i]; k++) x[i][k] = k * (size_t)(i + 3);
    }
  for (int i = 0; i < 4; i++) {
    for (size_t k = 0; k < capacity[i]; k++) assert_true(x[i][k] == k * (size_t)(i + 3));
    tet_free(ctx, x[i]);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  setrlimit(RLIMIT_AS, &before);
}

/* Along the curve through a cubic grid every step goes to a neighbouring cell. */
static void hilbert_steps_are_short(void **state) {
  (void)state;
  enum { SIDE = 8, N = SIDE * SIDE * SIDE };
  double *p = malloc(3 * N * sizeof *p);
  tet_keyed key[N];
  for (int i = 0; i < N; i++) {
    p[3 * i] = i % SIDE + 0.5;
    p[3 * i + 1] = i / SIDE % SIDE + 0.5;
    p[3 * i + 2] = i / SIDE / SIDE + 0.5;
  }
  tet_hilbert_box box = {{0, 0, 0}, 2097152.0 / SIDE};
  for (uint64_t i = 0; i < N; i++) key[i] = (tet_keyed){tet_hilbert_key(&box, p + 3 * i), i};
  tet_sort_keyed(key, N);
  for (size_t i = 1; i < N; i++) {
    double steps = 0;
    for (int k = 0; k < 3; k++) {
      double d = p[3 * key[i].value + (uint64_t)k] - p[3 * key[i - 1].value + (uint64_t)k];
      steps += d < 0 ? -d : d;
    }
    assert_true(steps == 1);
  }
  tet_hilbert_box around = tet_hilbert_bound(p, NULL, N);
  assert_true(around.low[0] == 0.5 && around.scale == 2097152.0 / (SIDE - 1));
  double far[3] = {1e300, -1e300, 0};
  assert_true(tet_hilbert_key(&around, far) < (uint64_t)1 << 63);
  free(p);
}

static void budget_holds(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_limits limits = {.memory_bytes = 10000};
  assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
  void *a = tet_alloc(ctx, 100, 50);
  assert_non_null(a);
  assert_true(tet_ctx_bytes(ctx) >= 5000);
  assert_null(tet_alloc(ctx, 100, 60));
  assert_int_equal(tet_ctx_error(ctx)->status, TET_E_MEMORY);
  assert_null(tet_alloc(ctx, SIZE_MAX, 2));
  assert_int_equal(tet_ctx_error(ctx)->status, TET_E_TOO_LARGE);
  uint32_t *array = NULL;
  size_t capacity = 0;
  for (uint32_t i = 0; i < 1000; i++) {
    assert_int_equal(tet_grow(ctx, &array, &capacity, i + 1, sizeof *array), TET_OK);
    array[i] = i;
  }
  size_t before = capacity;
  assert_int_equal(tet_grow(ctx, &array, &capacity, 5000, sizeof *array), TET_E_MEMORY);
  assert_int_equal(capacity, before); /* and the array is whole */
  for (uint32_t i = 0; i < 1000; i++) assert_int_equal(array[i], i);
  tet_shrink(ctx, &array, &capacity, 10, sizeof *array);
  assert_int_equal(capacity, 10);
  assert_true(tet_ctx_peak_bytes(ctx) <= limits.memory_bytes);
  tet_free(ctx, array);
  tet_free(ctx, a);
  tet_free(ctx, NULL);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void cancel_and_deadline(void **state) {
  (void)state;
  tet_ctx *ctx;
  tet_limits limits = {.deadline_seconds = 1e-9};
  assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
  tet_status status = TET_OK;
  for (int i = 0; i < 16 && status == TET_OK; i++) status = tet_poll(ctx);
  assert_int_equal(status, TET_E_DEADLINE);
  tet_cancel(ctx);
  assert_int_equal(tet_poll(ctx), TET_E_CANCELLED);
  assert_int_equal(tet_ctx_error(ctx)->status, TET_E_CANCELLED);
  tet_ctx_free(ctx);
}

static void offenders_are_capped(void **state) {
  (void)state;
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_fail(ctx, TET_E_INTERSECTION, "facets cross");
  for (uint32_t i = 0; i < 100; i++) {
    tet_offence o = {.index = {i, i + 1}};
    tet_offend(ctx, &o);
  }
  const tet_error *e = tet_ctx_error(ctx);
  assert_int_equal(e->n_offences, 100);
  assert_int_equal(e->n_listed, TET_MAX_OFFENDERS);
  assert_int_equal(e->offences[63].index[1], 64);
  tet_stage_begin(ctx, "audit");
  assert_int_equal(tet_internal(ctx, "nothing holds"), TET_E_INTERNAL);
  assert_int_equal(e->n_offences, 0);
  assert_non_null(strstr(e->message, "audit"));
  assert_non_null(e->file);
  tet_ctx_free(ctx);
}

static void on_progress(void *user, const tet_progress *p) {
  const char **last = user;
  *last = p->stage;
}

static void stages_gather(void **state) {
  (void)state;
  tet_ctx *ctx;
  const char *seen = NULL;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_ctx_set_progress(ctx, on_progress, &seen);
  tet_stages_clear(ctx);
  tet_stage_begin(ctx, "delaunay");
  assert_string_equal(seen, "delaunay");
  tet_stage_counts(ctx, 8, 6);
  tet_stage_begin(ctx, "surface");
  tet_stage_begin(ctx, "delaunay"); /* again */
  tet_stage_counts(ctx, 9, 7);
  tet_stage_end(ctx);
  tet_stage_end(ctx);
  uint32_t n;
  const tet_stage_report *s = tet_stages(ctx, &n);
  assert_int_equal(n, 2);
  assert_string_equal(s[0].name, "delaunay");
  assert_int_equal(s[0].tetrahedra, 7);
  assert_int_equal(s[1].vertices, 8); /* what it did not change it keeps */
  assert_true(s[0].seconds >= 0 && s[0].cpu_seconds >= 0);
  static const char *const more[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
  for (int i = 0; i < 9; i++) tet_stage_begin(ctx, more[i]);
  tet_stage_end(ctx);
  tet_stages(ctx, &n);
  assert_int_equal(n, TET_MAX_STAGES);
  tet_stages_clear(ctx);
  tet_stages(ctx, &n);
  assert_int_equal(n, 0);
  tet_ctx_free(ctx);
}

/* Of the right-angled triangle of sides 3 and 4. */
static void triangles_are_measured(void **state) {
  (void)state;
  const double a[3] = {0, 0, 0}, b[3] = {3, 0, 0}, c[3] = {0, 4, 0};
  const struct {
    double x[3], d2;
  } at[] = {{{1, 1, 0}, 0},   {{1, 1, 2}, 4},  {{-1, 1, 2}, 5},   {{1, -3, 0}, 9},
            {{5, 0, 1}, 5},   {{0, 6, -1}, 5}, {{-3, -4, 0}, 25}, {{1.5 + 4, 2 + 3, 0}, 25}};
  for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
    assert_float_equal(tet_triangle_distance2(a, b, c, at[i].x), at[i].d2, 1e-12);
    assert_float_equal(tet_triangle_distance2(c, b, a, at[i].x), at[i].d2, 1e-12);
    assert_float_equal(tet_triangle_distance2(a, c, c, at[i].x), tet_edge_distance2(a, c, at[i].x), 1e-12); /* flat */
  }
  double centre[3] = {7, 7, 7};
  assert_float_equal(tet_triangle_centre(b, c, centre), 144, 0);
  assert_true(centre[0] == 1.5 && centre[1] == 2 && centre[2] == 0);
  assert_float_equal(tet_triangle_centre(b, b, centre), 0, 0);
  assert_true(centre[0] == 1.5);
  const double size[] = {0x1p-1060, 0x1p-600, 0x1p-200, 0x1p300, 0x1p498};
  for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
    double u[3], w[3];
    for (int k = 0; k < 3; k++) {
      u[k] = size[i] * b[k];
      w[k] = size[i] * c[k];
    }
    assert_true(tet_triangle_centre(u, w, centre) > 0);
    assert_true(centre[0] == 1.5 * size[i] && centre[1] == 2 * size[i] && centre[2] == 0);
  }
  const double needle[2][3] = {{1e150, 0, 0}, {-1e150, 1e-250, 0}};
  assert_float_equal(tet_triangle_centre(needle[0], needle[1], centre), 0, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sorts),          cmocka_unit_test(radix_sorts), cmocka_unit_test(threads_take_every_part_once),
      cmocka_unit_test(hilbert_keys_agree), cmocka_unit_test(large_blocks_keep_what_they_hold), cmocka_unit_test(address_space_may_be_short),
      cmocka_unit_test(hilbert_steps_are_short), cmocka_unit_test(budget_holds),
      cmocka_unit_test(cancel_and_deadline), cmocka_unit_test(offenders_are_capped), cmocka_unit_test(stages_gather),
      cmocka_unit_test(triangles_are_measured)};
  return cmocka_run_group_tests_name("base", tests, NULL, NULL);
}
