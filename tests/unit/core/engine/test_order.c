// SPDX-License-Identifier: Apache-2.0
/* The canonical order: the same whatever order a mesh comes in, and still the same mesh. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#include "audit/audit.h"
#include "box_mesh.h"
#include "engine/order.h"

static uint32_t below(uint64_t *state, uint32_t n) { /* xorshift */
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return (uint32_t)(*state % n);
}

static void swap_bytes(void *base, uint32_t i, uint32_t j, size_t size) {
  char t[32], *a = (char *)base + i * size, *b = (char *)base + j * size;
  memcpy(t, a, size);
  memcpy(a, b, size);
  memcpy(b, t, size);
}

/* Turns the vertices of a tetrahedron by an even permutation. */
static void turn(tet_mesh *m, uint32_t t) {
  for (uint32_t k = 0; k < 2; k++) {
    swap_bytes(m->tetrahedra + 4 * t, k, k + 1, sizeof(uint32_t));
    swap_bytes(m->neighbours + 4 * t, k, k + 1, sizeof(uint32_t));
  }
}

static void shuffle(tet_mesh *m, uint64_t seed) {
  for (uint32_t i = m->n_tetrahedra; i-- > 1;) {
    uint32_t j = below(&seed, i + 1);
    swap_bytes(m->tetrahedra, i, j, 16);
    swap_bytes(m->tetrahedron_regions, i, j, 4);
    swap_bytes(m->neighbours, i, j, 16);
    for (uint32_t k = 0; k < 4 * m->n_tetrahedra; k++)
      m->neighbours[k] = m->neighbours[k] == i ? j : m->neighbours[k] == j ? i : m->neighbours[k];
    for (uint32_t k = 0; k < m->n_exceptions; k++)
      m->exception_tetrahedra[k] = m->exception_tetrahedra[k] == i   ? j
                                   : m->exception_tetrahedra[k] == j ? i
                                                                     : m->exception_tetrahedra[k];
    for (uint32_t k = 0; k < m->n_slivers; k++)
      m->sliver_tetrahedra[k] = m->sliver_tetrahedra[k] == i   ? j
                                : m->sliver_tetrahedra[k] == j ? i
                                                               : m->sliver_tetrahedra[k];
    turn(m, i);
  }
  for (uint32_t i = m->n_subfaces; i-- > 1;) {
    uint32_t j = below(&seed, i + 1);
    swap_bytes(m->subfaces, i, j, 12);
    swap_bytes(m->subface_facets, i, j, 4);
    swap_bytes(m->subface_markers, i, j, 4);
    swap_bytes(m->subfaces + 3 * i, 0, 1, 4); /* twice: a rotation */
    swap_bytes(m->subfaces + 3 * i, 1, 2, 4);
  }
  for (uint32_t i = m->n_subsegments; i-- > 1;) {
    uint32_t j = below(&seed, i + 1);
    swap_bytes(m->subsegments, i, j, 8);
    swap_bytes(m->subsegment_segments, i, j, 4);
    swap_bytes(m->subsegment_markers, i, j, 4);
    for (uint32_t k = 0; k < m->n_exceptions; k++)
      m->exception_segments[k] = m->exception_segments[k] == i   ? j
                                 : m->exception_segments[k] == j ? i
                                                                 : m->exception_segments[k];
    for (uint32_t k = 0; k < m->n_slivers; k++)
      m->sliver_segments[k] = m->sliver_segments[k] == i   ? j
                              : m->sliver_segments[k] == j ? i
                                                           : m->sliver_segments[k];
    swap_bytes(m->subsegments + 2 * i, 0, 1, 4);
  }
}

static void except_some(tet_mesh *m) {
  m->n_exceptions = 3;
  for (uint32_t k = 0; k < 3; k++) {
    m->exception_tetrahedra[k] = 30 * (3 - k);
    m->exception_radius_edge[k] = k;
    m->exception_segments[k] = k == 1 ? TET_NONE : 5 * k;
  }
  m->n_slivers = 2;
  for (uint32_t k = 0; k < 2; k++) {
    m->sliver_tetrahedra[k] = 31 * (2 - k);
    m->sliver_cosines[k] = k;
    m->sliver_segments[k] = k == 1 ? TET_NONE : 7;
  }
}

#define SAME(array, count) assert_memory_equal(a->array, b->array, (count) * sizeof *a->array)

static void assert_same(const tet_mesh *a, const tet_mesh *b) {
  SAME(points, 3 * a->n_points);
  SAME(point_same_as, a->n_input_points);
  SAME(point_markers, a->n_points);
  SAME(tetrahedra, 4 * a->n_tetrahedra);
  SAME(tetrahedron_regions, a->n_tetrahedra);
  SAME(neighbours, 4 * a->n_tetrahedra);
  SAME(subfaces, 3 * a->n_subfaces);
  SAME(subface_facets, a->n_subfaces);
  SAME(subface_markers, a->n_subfaces);
  SAME(subsegments, 2 * a->n_subsegments);
  SAME(subsegment_segments, a->n_subsegments);
  SAME(subsegment_markers, a->n_subsegments);
  SAME(exception_tetrahedra, a->n_exceptions);
  SAME(exception_radius_edge, a->n_exceptions);
  SAME(exception_segments, a->n_exceptions);
  SAME(sliver_tetrahedra, a->n_slivers);
  SAME(sliver_cosines, a->n_slivers);
  SAME(sliver_segments, a->n_slivers);
}

static void order_is_canonical(void **state) {
  (void)state;
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  for (int hilbert = 0; hilbert < 2; hilbert++)
    for (uint64_t seed = 1; seed < 6; seed++) {
      tet_mesh *a = box_mesh(ctx, 2), *b = box_mesh(ctx, 2);
      except_some(a);
      except_some(b);
      shuffle(b, seed);
      tet_point_order order = hilbert ? TET_ORDER_HILBERT : TET_ORDER_INPUT_FIRST;
      assert_int_equal(tet_order_mesh(ctx, a, order), TET_OK);
      assert_int_equal(tet_order_mesh(ctx, b, order), TET_OK);
      assert_same(a, b);
      tet_audit audit;
      assert_int_equal(tet_audit_mesh(ctx, NULL, b, &audit), TET_OK);
      assert_true(audit.passed);
      tet_mesh_free(a);
      tet_mesh_free(b);
    }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
}

static void rows_are_sorted(void **state) {
  (void)state;
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_mesh *m = box_mesh(ctx, 3);
  assert_int_equal(tet_order_mesh(ctx, m, TET_ORDER_INPUT_FIRST), TET_OK);
  for (uint32_t t = 0; t < m->n_tetrahedra; t++) {
    const uint32_t *v = m->tetrahedra + 4 * t;
    assert_true(v[0] < v[1] && v[1] < v[2] && v[1] < v[3]);
    for (int k = 0; t > 0 && k < 4 && v[k] != v[k - 4]; k++) {
      assert_true(v[k - 4] < v[k]);
      break;
    }
  }
  tet_mesh_free(m);
  tet_ctx_free(ctx);
}

/* Input vertex i is found again, with its marker, at row point_same_as[i]. */
static void hilbert_keeps_track(void **state) {
  (void)state;
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_mesh *a = box_mesh(ctx, 2), *b = box_mesh(ctx, 2);
  assert_int_equal(tet_order_mesh(ctx, b, TET_ORDER_HILBERT), TET_OK);
  uint32_t moved = 0;
  for (uint32_t i = 0; i < a->n_points; i++) {
    uint32_t row = b->point_same_as[i];
    moved += row != i;
    assert_memory_equal(a->points + 3 * i, b->points + 3 * row, 3 * sizeof *a->points);
    assert_int_equal(b->point_markers[row], (int)i);
  }
  assert_true(moved > 0);
  tet_mesh_free(a);
  tet_mesh_free(b);
  tet_ctx_free(ctx);
}

static void fails_cleanly_under_a_budget(void **state) {
  (void)state;
  tet_ctx *ctx;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_mesh_free(box_mesh(ctx, 2));
  uint64_t need = tet_ctx_peak_bytes(ctx);
  tet_ctx_free(ctx);
  tet_status status = TET_E_MEMORY;
  for (uint64_t more = 0; status != TET_OK; more += 64) {
    tet_limits limits = {.memory_bytes = need + more};
    assert_int_equal(tet_ctx_create(&limits, &ctx), TET_OK);
    tet_mesh *m = box_mesh(ctx, 2);
    status = tet_order_mesh(ctx, m, TET_ORDER_HILBERT);
    assert_true(status == TET_OK || status == TET_E_MEMORY);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(order_is_canonical), cmocka_unit_test(rows_are_sorted),
                                     cmocka_unit_test(hilbert_keeps_track),
                                     cmocka_unit_test(fails_cleanly_under_a_budget)};
  return cmocka_run_group_tests_name("order", tests, NULL, NULL);
}
