// SPDX-License-Identifier: Apache-2.0
/* Arrays and sets: dtypes, overflow of shapes, ownership. */
#include "support.h"

#include "protocol/array.h"

static void dtypes_have_names_and_sizes(void **state) {
  (void)state;
  const size_t sizes[TP_DTYPES] = {8, 4, 4, 4, 8, 1};
  for (unsigned i = 0; i < TP_DTYPES; i++) {
    tp_dtype dtype = (tp_dtype)((i + 1) % TP_DTYPES);
    assert_true(tp_dtype_of(tp_dtype_name((tp_dtype)i), &dtype));
    assert_int_equal(dtype, i);
    assert_int_equal(tp_dtype_size((tp_dtype)i), sizes[i]);
  }
  tp_dtype dtype = TP_U8;
  assert_false(tp_dtype_of(">f8", &dtype));
  assert_false(tp_dtype_of("", &dtype));
  assert_int_equal(dtype, TP_U8);
}

static void shape_products_do_not_overflow(void **state) {
  (void)state;
  const uint64_t too_large[][2] = {{UINT64_MAX, 1},
                                   {1, UINT64_MAX},
                                   {UINT64_C(1) << 32, UINT64_C(1) << 32},
                                   {UINT64_C(1) << 31, UINT64_C(1) << 31},
                                   {(UINT64_C(1) << 50) + 1, 1},
                                   {UINT64_C(3) << 48, 3},
                                   {UINT64_MAX / 8 + 1, 8}};
  for (size_t i = 0; i < sizeof too_large / sizeof *too_large; i++) {
    uint64_t bytes = 7;
    assert_int_equal(tp_shape_bytes(TP_F8, too_large[i], &bytes), TP_E_PARAMS);
    assert_int_equal(bytes, 7);
  }
  uint64_t bytes = 7;
  assert_int_equal(tp_shape_bytes(TP_F8, (uint64_t[2]){UINT64_C(1) << 50, 1}, &bytes), TP_OK);
  assert_true(bytes == UINT64_C(1) << 53);
  assert_int_equal(tp_shape_bytes(TP_U1, (uint64_t[2]){0, 5}, &bytes), TP_OK);
  assert_true(bytes == 0);
}

static void sets_keep_names_apart(void **state) {
  (void)state;
  tp_arrays set = TP_ARRAYS_INIT;
  tp_error error;
  void *data = NULL;
  const double points[6] = {0, 1, 2, 3, 4, 5};
  assert_int_equal(tp_arrays_borrow(&set, "points", TP_F8, 2, 3, points, &error), TP_OK);
  assert_int_equal(tp_arrays_new(&set, "points", TP_F8, 2, 3, &data, &error), TP_E_PARAMS);
  assert_string_equal(error.where, "points");
  assert_null(data);
  assert_int_equal(tp_arrays_new(&set, "Points", TP_F8, 2, 3, &data, &error), TP_E_PARAMS);
  assert_int_equal(tp_arrays_new(&set, "", TP_F8, 2, 3, &data, &error), TP_E_PARAMS);
  assert_int_equal(tp_arrays_new(&set, "a123456789012345678901234567890", TP_F8, 2, 3, &data,
                                 &error), TP_OK);
  assert_int_equal(tp_arrays_new(&set, "a1234567890123456789012345678901", TP_F8, 2, 3, &data,
                                 &error), TP_E_PARAMS);
  assert_int_equal(tp_arrays_new(&set, "huge", TP_F8, UINT64_MAX, 3, &data, &error), TP_E_PARAMS);
  assert_int_equal(set.count, 2);
  tp_arrays_free(&set);
  assert_null(set.items);
}

static void many_arrays_of_every_ownership(void **state) {
  (void)state;
  tp_arrays set = TP_ARRAYS_INIT;
  char name[TP_NAME_SIZE] = "array_00";
  uint32_t *own = malloc(4 * sizeof *own);
  assert_non_null(own);
  own[3] = 9;
  assert_int_equal(tp_arrays_own(&set, "own", TP_U4, 4, 0, own, NULL), TP_OK);
  for (int i = 0; i < 50; i++) {
    uint8_t *data = NULL;
    name[6] = (char)('0' + i / 10);
    name[7] = (char)('0' + i % 10);
    assert_int_equal(tp_arrays_new(&set, name, TP_U1, (uint64_t)i, 0, (void **)&data, NULL), TP_OK);
    assert_non_null(data);
    for (int k = 0; k < i; k++) {
      assert_int_equal(data[k], 0);
      data[k] = (uint8_t)i;
    }
  }
  uint64_t rows = 1;
  const uint8_t *found = tp_arrays_data(&set, "array_33", &rows);
  assert_int_equal(rows, 33);
  assert_int_equal(found[32], 33);
  assert_non_null(tp_arrays_data(&set, "array_00", &rows));
  assert_int_equal(rows, 0);
  assert_null(tp_arrays_data(&set, "array_99", &rows));
  assert_int_equal(rows, 0);
  assert_null(tp_arrays_find(&set, "array_"));
  const tp_array *array = tp_arrays_find(&set, "own");
  assert_int_equal(array->ndim, 1);
  assert_int_equal(array->shape[1], 1);
  assert_int_equal(tp_array_bytes(array), 16);
  tp_arrays_free(&set);
  tp_arrays_free(&set);
}

static void an_empty_borrowed_array_is_there(void **state) {
  (void)state;
  tp_arrays set = TP_ARRAYS_INIT;
  uint64_t rows = 1;
  assert_int_equal(tp_arrays_borrow(&set, "holes", TP_F8, 0, 3, NULL, NULL), TP_OK);
  assert_non_null(tp_arrays_data(&set, "holes", &rows));
  assert_int_equal(rows, 0);
  tp_arrays_free(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dtypes_have_names_and_sizes),
      cmocka_unit_test(shape_products_do_not_overflow),
      cmocka_unit_test(sets_keep_names_apart),
      cmocka_unit_test(many_arrays_of_every_ownership),
      cmocka_unit_test(an_empty_borrowed_array_is_there),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
