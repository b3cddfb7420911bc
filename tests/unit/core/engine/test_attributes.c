// SPDX-License-Identifier: Apache-2.0
/* Attributes of new points: exact along segments, within the given range elsewhere. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "engine/pack.h"

/* Input 0..3, a point on the segment 0 1, one on the facet 0 1 2, one in the volume. */
static void interpolates(void **state) {
  (void)state;
  double points[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4, 1, 0, 0, 1, 1, 0, 1, 1, 1};
  uint8_t origin[] = {0, 0, 0, 0, TET_ORIGIN_SEGMENT, TET_ORIGIN_FACET, TET_ORIGIN_VOLUME};
  uint32_t carrier[] = {TET_NONE, TET_NONE, TET_NONE, TET_NONE, 0, 0, TET_NONE};
  uint32_t subface[] = {0, 4, 5, 4, 1, 5, 1, 2, 5, 2, 0, 5};
  uint32_t tets[] = {0, 4, 5, 6, 4, 1, 5, 6, 1, 2, 5, 6, 2, 0, 5, 6, 0, 3, 4, 6, 4, 3, 1, 6, 1, 3, 2, 6, 2, 3, 0, 6};
  tet_segment segment = {.a = 0, .b = 1};
  tet_facet facet = {.input = 0};
  tet_pieces p = {.n_points = 7, .points = points, .origin = origin, .carrier = carrier, .n_input = 4, .n_tets = 8,
                  .tets = tets, .n_subfaces = 4, .subface = subface, .n_segments = 1, .segment = &segment,
                  .n_facets = 1, .facet = &facet};
  double values[14] = {10, 7, 30, 7, 10, 7, 10, 7, 0, 0, 0, 0, 0, 0}; /* 10 + 5 x, and 7 */
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  assert_int_equal(tet_interpolate_attributes(ctx, &p, 2, values), TET_OK);
  assert_true(values[8] == 15);
  assert_true(values[10] > 10 && values[10] < 30);
  assert_true(values[12] > 10 && values[12] < 30);
  for (int v = 4; v < 7; v++) assert_true(fabs(values[2 * v + 1] - 7) < 1e-12); /* constants stay */
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  assert_int_equal(tet_interpolate_attributes(ctx, &p, 0, NULL), TET_OK);
  tet_ctx_free(ctx);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(interpolates)};
  return cmocka_run_group_tests_name("attributes", tests, NULL, NULL);
}
