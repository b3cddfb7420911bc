// SPDX-License-Identifier: Apache-2.0
/* Descriptors and bodies: packing, tiling, nested lists, JSON text, array tables. */
#include "support.h"

#include <stdio.h>

#include "protocol/message.h"

enum { PLENTY = 1 << 24 };

static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
static const int32_t markers[4] = {-1, 0, INT32_MAX, INT32_MIN};

static json_t *load(const char *text) {
  json_t *json = json_loads(text, 0, NULL);
  assert_non_null(json);
  return json;
}

static void check_tetrahedron(const tp_arrays *set) {
  uint64_t rows = 0;
  assert_memory_equal(tp_arrays_data(set, "points", &rows), points, sizeof points);
  assert_int_equal(rows, 4);
  assert_memory_equal(tp_arrays_data(set, "triangles", NULL), triangles, sizeof triangles);
}

static void packed_sets_come_back(void **state) {
  (void)state;
  for (unsigned codec = 0; codec < TP_CODECS; codec++) {
    tp_arrays set = TP_ARRAYS_INIT, back = TP_ARRAYS_INIT;
    tp_bytes body = TP_BYTES_INIT;
    json_t *object = NULL;
    tp_error error;
    assert_int_equal(tp_arrays_borrow(&set, "holes", TP_F8, 0, 3, NULL, NULL), TP_OK);
    assert_int_equal(tp_arrays_borrow(&set, "points", TP_F8, 4, 3, points, NULL), TP_OK);
    assert_int_equal(tp_arrays_borrow(&set, "triangles", TP_U4, 4, 3, triangles, NULL), TP_OK);
    assert_int_equal(tp_arrays_borrow(&set, "facet_markers", TP_I4, 4, 0, markers, NULL), TP_OK);
    assert_int_equal(tp_pack(&set, (tp_codec)codec, &body, &object, &error), TP_OK);
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), body.size, PLENTY, &error), TP_OK);
    assert_int_equal(
        tp_unpack(object, tp_schema_pls(), body.data, body.size, PLENTY, &back, &error), TP_OK);
    check_tetrahedron(&back);
    assert_int_equal(back.count, 4);
    assert_memory_equal(tp_arrays_data(&back, "facet_markers", NULL), markers, sizeof markers);
    tp_arrays_free(&back);
    /* the sizes together are bounded */
    const uint64_t total = sizeof points + sizeof triangles + sizeof markers;
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), body.size, total, &error), TP_OK);
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), body.size, total - 1, &error),
                     TP_E_PARAMS);
    /* one flipped bit is seen: by the codec or by the CRC */
    body.data[body.size / 3] ^= 4;
    assert_int_equal(
        tp_unpack(object, tp_schema_pls(), body.data, body.size, PLENTY, &back, &error),
        TP_E_UPLOAD);
    assert_int_equal(back.count, 0);
    /* a body that is too short or too long is refused at once */
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), body.size - 1, PLENTY, &error),
                     TP_E_PARAMS);
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), body.size + 1, PLENTY, &error),
                     TP_E_PARAMS);
    json_decref(object);
    tp_bytes_free(&body);
    tp_arrays_free(&set);
  }
}

static const char lists[] =
    "{\"points\":[[0,0,0],[1.0,0,0],[0,1,0],[0,0,1]],\"triangles\":[[0,2,1],[0,1,3],[1,2,3],[2,0,3]],"
    "\"holes\":[],\"point_attributes\":[[1,2],[3,4],[5,6],[7,8e0]],\"facet_markers\":[-1,0,"
    "2147483647,-2147483648]}";

static void nested_lists_are_arrays(void **state) {
  (void)state;
  tp_arrays set = TP_ARRAYS_INIT;
  tp_error error = {.message = ""};
  json_t *object = load(lists);
  assert_int_equal(tp_upload_check(object, tp_schema_pls(), 0, PLENTY, &error), TP_OK);
  assert_int_equal(tp_unpack(object, tp_schema_pls(), NULL, 0, PLENTY, &set, &error), TP_OK);
  check_tetrahedron(&set);
  assert_int_equal(tp_arrays_find(&set, "point_attributes")->shape[1], 2);
  assert_int_equal(tp_arrays_find(&set, "holes")->shape[1], 3);
  assert_memory_equal(tp_arrays_data(&set, "facet_markers", NULL), markers, sizeof markers);
  tp_arrays_free(&set);
  json_decref(object);
}

static void json_text_is_arrays(void **state) {
  (void)state;
  tp_arrays set = TP_ARRAYS_INIT;
  tp_error error = {.message = ""};
  json_t *object = json_pack("{s:{s:[i,i]}}", "json", "at", 0, (int)sizeof lists - 1);
  assert_int_equal(tp_upload_check(object, tp_schema_pls(), sizeof lists - 1, PLENTY, &error),
                   TP_OK);
  assert_int_equal(
      tp_unpack(object, tp_schema_pls(), lists, sizeof lists - 1, PLENTY, &set, &error), TP_OK);
  check_tetrahedron(&set);
  tp_arrays_free(&set);
  assert_int_equal(tp_upload_check(object, tp_schema_pls(), sizeof lists, PLENTY, &error),
                   TP_E_PARAMS);
  json_decref(object);

  static const char *const bad[] = {
      "",
      "[]",
      "{\"points\":[[0,0,0]]",
      "{\"points\":[[0,0,0]],\"points\":[]}",
      "{\"points\":[[0,0,0]]} x",
      "{\"points\":[[0,0,0]],\"json\":[]}",
      "{\"points\":[[0,0,0]],\"triangles\":{\"json\":1}}",
      "{\"points\":[[[[[[[[[[[[[[[[[[0]]]]]]]]]]]]]]]]]]}",
      "{\"points\":[[0,0,1e999]]}",
      "{\"points\":\"zero\"}",
      "{\"triangles\":[]}",
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    object = json_pack("{s:{s:[i,i]}}", "json", "at", 0, (int)strlen(bad[i]));
    assert_int_equal(
        tp_unpack(object, tp_schema_pls(), bad[i], strlen(bad[i]), PLENTY, &set, &error),
        TP_E_UPLOAD);
    assert_int_equal(error.code, TP_E_UPLOAD);
    json_decref(object);
  }
  assert_int_equal(set.count, 0);
}

static void lists_that_do_not_fit(void **state) {
  (void)state;
  static const char *const bad[][2] = {
      {"{\"points\":[[0,0,0],[0,0]]}", "points"},
      {"{\"points\":[[0,0,0],[0,0,0,0]]}", "points"},
      {"{\"points\":[[0,0,0],0]}", "points"},
      {"{\"points\":[[0,0,null]]}", "points"},
      {"{\"points\":[[0,0,\"0\"]]}", "points"},
      {"{\"points\":[],\"triangles\":[[0,1,-1]]}", "triangles"},
      {"{\"points\":[],\"triangles\":[[0,1,4294967296]]}", "triangles"},
      {"{\"points\":[],\"triangles\":[[0,1,2.0]]}", "triangles"},
      {"{\"points\":[[0,0,0]],\"point_markers\":[2147483648]}", "point_markers"},
      {"{\"points\":[[0,0,0]],\"point_markers\":[[1]]}", "point_markers"},
      {"{\"points\":[[0,0,0]],\"point_attributes\":[1]}", "point_attributes"},
      {"{\"points\":[[0,0,0]],\"point_attributes\":[[]]}", "point_attributes"},
      {"{\"points\":[[0,0,0]],\"point_markers\":[1,2]}", "point_markers"},
      {"{\"points\":[],\"colours\":[]}", "colours"},
      {"{\"points\":3}", "points"},
      {"{\"points\":null}", "points"},
      {"{}", "points"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    tp_arrays set = TP_ARRAYS_INIT;
    tp_error error;
    json_t *object = load(bad[i][0]);
    assert_int_equal(tp_unpack(object, tp_schema_pls(), NULL, 0, PLENTY, &set, &error),
                     TP_E_UPLOAD);
    assert_string_equal(error.where, bad[i][1]);
    json_decref(object);
  }
}

/* A descriptor object with points at [a, b] and point_markers at [c, d], one row,
 * raw: 24 and 4 bytes. */
static tp_code check_ranges(int a, int b, int c, int d, uint64_t body) {
  json_t *object = json_pack("{s:{s:s,s:[i,i],s:[i,i]},s:{s:s,s:[i],s:[i,i]}}", "points", "dtype",
                             "<f8", "shape", 1, 3, "at", a, b, "point_markers", "dtype", "<i4",
                             "shape", 1, "at", c, d);
  const tp_code code = tp_upload_check(object, tp_schema_pls(), body, PLENTY, NULL);
  json_decref(object);
  return code;
}

static void ranges_tile_the_body(void **state) {
  (void)state;
  assert_int_equal(check_ranges(0, 24, 24, 4, 28), TP_OK);
  assert_int_equal(check_ranges(4, 24, 0, 4, 28), TP_OK);
  assert_int_equal(check_ranges(0, 24, 24, 4, 29), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, 25, 4, 29), TP_E_PARAMS);
  assert_int_equal(check_ranges(1, 24, 25, 4, 29), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, 20, 4, 28), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, 0, 4, 24), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, 24, 4, 27), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 23, 23, 4, 27), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, 24, 0, 24), TP_E_PARAMS);
  assert_int_equal(check_ranges(0, 24, -4, 4, 28), TP_E_PARAMS);
}

static void descriptors_that_lie(void **state) {
  (void)state;
  static const char *const bad[][2] = {
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[0,24],\"colour\":1}}", "points"},
      {"{\"points\":{\"dtype\":\">f8\",\"shape\":[1,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f4\",\"shape\":[2,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"shape\":[1,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3,1],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":3,\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[-1,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1.0,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[9007199254740992,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[768614336404564651,3],\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[4294967295,3],\"codec\":\"zlib\",\"at\":[0,24]}}",
       "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[0]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[0,24.0]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[9007199254740992,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"codec\":\"lzma\",\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"codec\":null,\"at\":[0,24]}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[0,24],\"crc32\":-1}}", "points"},
      {"{\"points\":{\"dtype\":\"<f8\",\"shape\":[1,3],\"at\":[0,24],\"crc32\":4294967296}}",
       "points"},
      {"{\"json\":{\"at\":[0,24]},\"points\":[]}", "json"},
      {"{\"json\":{\"at\":[0,23]}}", "json"},
      {"{\"json\":{\"at\":[1,23]}}", "json"},
      {"{\"json\":{\"at\":[0,24],\"codec\":\"zlib\"}}", "json"},
      {"{\"json\":24}", "json"},
      {"{\"points\":[[0,0,0]]}", "body"},
      {"{\"triangles\":{\"dtype\":\"<u4\",\"shape\":[2,3],\"at\":[0,24]}}", "points"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    tp_error error;
    json_t *object = load(bad[i][0]);
    assert_int_equal(tp_upload_check(object, tp_schema_pls(), 24, PLENTY, &error), TP_E_PARAMS);
    assert_string_equal(error.where, bad[i][1]);
    json_decref(object);
  }
  json_t *list = json_array();
  assert_int_equal(tp_upload_check(list, tp_schema_pls(), 0, PLENTY, NULL), TP_E_PARAMS);
  assert_int_equal(tp_upload_check(NULL, tp_schema_pls(), 0, PLENTY, NULL), TP_E_PARAMS);
  json_decref(list);
}

static void array_tables_come_back(void **state) {
  (void)state;
  double *data = calloc(3 * 100000, sizeof *data);
  assert_non_null(data);
  const tp_array array = {.name = "points", .dtype = TP_F8, .ndim = 2, .shape = {100000, 3},
                          .data = data};
  tp_array_info info, back;
  tp_array_info_of(&array, TP_MESH, &info);
  assert_int_equal(info.rows_per_chunk, 43690);
  assert_int_equal(info.chunks, 3);
  assert_int_equal(tp_array_info_rows(&info, 0), 43690);
  assert_int_equal(tp_array_info_rows(&info, 2), 100000 - 2 * 43690);
  assert_int_equal(info.crc32, tp_crc32(0, data, tp_array_bytes(&array)));
  json_t *json = tp_array_info_json(&info);
  json_object_set_new(json, "later", json_integer(1));
  memset(&back, 0, sizeof back);
  assert_int_equal(tp_array_info_parse(json, &back, NULL), TP_OK);
  assert_string_equal(back.name, "points");
  assert_true(back.dtype == info.dtype && back.ndim == 2 && back.shape[0] == 100000 &&
              back.shape[1] == 3 && back.codec == TP_MESH && back.rows_per_chunk == 43690 &&
              back.chunks == 3 && back.crc32 == info.crc32);
  static const char *const members[] = {"name", "dtype", "shape", "codec", "rows_per_chunk",
                                        "chunks", "crc32"};
  for (int i = 0; i < 7; i++) {
    json_t *broken = json_copy(json);
    json_object_del(broken, members[i]);
    assert_int_equal(tp_array_info_parse(broken, &back, NULL), TP_E_PARAMS);
    json_decref(broken);
  }
  json_object_set_new(json, "rows_per_chunk", json_integer(0));
  assert_int_equal(tp_array_info_parse(json, &back, NULL), TP_E_PARAMS);
  json_object_set_new(json, "rows_per_chunk", json_integer(1));
  assert_int_equal(tp_array_info_parse(json, &back, NULL), TP_E_PARAMS);
  json_decref(json);
  free(data);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(packed_sets_come_back), cmocka_unit_test(nested_lists_are_arrays),
      cmocka_unit_test(json_text_is_arrays),   cmocka_unit_test(lists_that_do_not_fit),
      cmocka_unit_test(ranges_tile_the_body),  cmocka_unit_test(descriptors_that_lie),
      cmocka_unit_test(array_tables_come_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
