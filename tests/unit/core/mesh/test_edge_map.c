// SPDX-License-Identifier: Apache-2.0
/* The edge map against a plain table: put, get and remove at random. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mesh/edge_map.h"

enum { N = 40 };

static void random_operations_agree_with_a_table(void **state) {
  (void)state;
  static uint32_t table[N][N];
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_edge_map map = {NULL, 0, 0};
  uint32_t random = 1;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) table[i][j] = TET_NONE;
  for (uint32_t step = 0; step < 200000; step++) {
    random = random * 1664525u + 1013904223u;
    uint32_t a = (random >> 8) % N, b = (random >> 16) % N, lo = a < b ? a : b, hi = a < b ? b : a;
    if (a == b) continue;
    if (random >> 30) {
      assert_int_equal(tet_edge_map_put(ctx, &map, a, b, step), TET_OK);
      table[lo][hi] = step;
    } else {
      tet_edge_map_remove(&map, a, b);
      table[lo][hi] = TET_NONE;
    }
    a = (random >> 12) % N;
    b = (random >> 20) % N;
    if (a != b) assert_int_equal(tet_edge_map_get(&map, a, b), table[a < b ? a : b][a < b ? b : a]);
  }
  tet_edge_map_free(ctx, &map);
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_operations_agree_with_a_table)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
