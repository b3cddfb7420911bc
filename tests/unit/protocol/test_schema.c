// SPDX-License-Identifier: Apache-2.0
/* The tables of PLS and mesh, and the checks of sets against them. */
#include "support.h"

#include "protocol/array.h"

static const double zeros[64];

/* A tetrahedron's surface as polygons, facets and one facet hole. */
typedef struct case_pls {
  tp_arrays set;
  uint32_t vertices[12], polygons[5], facets[5], hole_start[5];
  int32_t markers[4];
} case_pls;

static void add(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows, uint64_t columns,
                const void *data) {
  assert_int_equal(tp_arrays_borrow(set, name, dtype, rows, columns, data, NULL), TP_OK);
}

static void make(case_pls *pls) {
  *pls = (case_pls){.set = TP_ARRAYS_INIT,
                    .vertices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3},
                    .polygons = {0, 3, 6, 9, 12},
                    .facets = {0, 1, 2, 3, 4},
                    .hole_start = {0, 0, 1, 1, 1}};
  add(&pls->set, "points", TP_F8, 4, 3, zeros);
  add(&pls->set, "polygon_vertices", TP_U4, 12, 0, pls->vertices);
  add(&pls->set, "polygon_start", TP_U4, 5, 0, pls->polygons);
  add(&pls->set, "facet_start", TP_U4, 5, 0, pls->facets);
  add(&pls->set, "facet_holes", TP_F8, 1, 3, zeros);
  add(&pls->set, "facet_hole_start", TP_U4, 5, 0, pls->hole_start);
  add(&pls->set, "facet_markers", TP_I4, 4, 0, pls->markers);
}

static void refused(const tp_arrays *set, const tp_schema *schema, const char *where) {
  tp_error error;
  assert_int_equal(tp_arrays_validate(set, schema, &error), TP_E_PARAMS);
  assert_string_equal(error.where, where);
  assert_true(error.message[0] != '\0');
}

/* Checks the PLS, frees it and makes it anew. */
static void expect(case_pls *pls, const char *where) {
  if (where == NULL) {
    tp_error error = {.message = ""};
    assert_int_equal(tp_arrays_validate(&pls->set, tp_schema_pls(), &error), TP_OK);
  } else {
    refused(&pls->set, tp_schema_pls(), where);
  }
  tp_arrays_free(&pls->set);
  make(pls);
}

/* Changes the rows of one array of the set. */
static void resize(case_pls *pls, const char *name, uint64_t rows) {
  for (size_t i = 0; i < pls->set.count; i++) {
    if (strcmp(pls->set.items[i].name, name) == 0) pls->set.items[i].shape[0] = rows;
  }
}

/* Takes one array out of the set. */
static void drop(case_pls *pls, const char *name) {
  for (size_t i = 0; i < pls->set.count; i++) {
    if (strcmp(pls->set.items[i].name, name) != 0) continue;
    pls->set.items[i] = pls->set.items[--pls->set.count];
    return;
  }
  fail();
}

static void csr_arrays_fit_each_other(void **state) {
  (void)state;
  case_pls pls;
  make(&pls);
  expect(&pls, NULL);
  pls.polygons[0] = 1;
  expect(&pls, "polygon_start");
  pls.polygons[2] = 2;
  expect(&pls, "polygon_start");
  pls.polygons[4] = 13;
  expect(&pls, "polygon_start");
  pls.polygons[4] = 11;
  expect(&pls, "polygon_start");
  pls.polygons[3] = UINT32_MAX;
  expect(&pls, "polygon_start");
  resize(&pls, "polygon_start", 0);
  expect(&pls, "polygon_start");
  pls.facets[4] = 5;
  expect(&pls, "facet_start");
  pls.hole_start[4] = 0;
  expect(&pls, "facet_hole_start");
  resize(&pls, "facet_hole_start", 4);
  expect(&pls, "facet_hole_start");
  resize(&pls, "facet_markers", 5);
  expect(&pls, "facet_markers");
  tp_arrays_free(&pls.set);
}

static void arrays_need_their_partners(void **state) {
  (void)state;
  case_pls pls;
  make(&pls);
  drop(&pls, "points");
  expect(&pls, "points");
  drop(&pls, "polygon_vertices");
  expect(&pls, "polygon_start");
  drop(&pls, "polygon_start");
  expect(&pls, "polygon_vertices");
  drop(&pls, "polygon_start");
  drop(&pls, "polygon_vertices");
  expect(&pls, "facet_start");
  drop(&pls, "facet_holes");
  expect(&pls, "facet_hole_start");
  drop(&pls, "facet_hole_start");
  expect(&pls, "facet_holes");
  drop(&pls, "facet_start"); /* one facet per polygon */
  expect(&pls, NULL);
  add(&pls.set, "triangles", TP_U4, 1, 3, pls.vertices);
  expect(&pls, "triangles");
  add(&pls.set, "region_markers", TP_I4, 0, 0, NULL);
  expect(&pls, "region_markers");
  add(&pls.set, "point_markers", TP_I4, 3, 0, pls.markers);
  expect(&pls, "point_markers");
  add(&pls.set, "neighbours", TP_U4, 1, 4, pls.vertices);
  expect(&pls, "neighbours");
  tp_arrays_free(&pls.set);
}

static void triangles_count_facets(void **state) {
  (void)state;
  const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
  const int32_t markers[2] = {1, 2};
  tp_arrays set = TP_ARRAYS_INIT;
  add(&set, "points", TP_F8, 4, 3, zeros);
  add(&set, "triangles", TP_U4, 2, 3, triangles);
  add(&set, "facet_markers", TP_I4, 2, 0, markers);
  assert_int_equal(tp_arrays_validate(&set, tp_schema_pls(), NULL), TP_OK);
  set.items[1].shape[0] = 1;
  refused(&set, tp_schema_pls(), "facet_markers");
  tp_arrays_free(&set);
}

static void fields_check_dtype_and_shape(void **state) {
  (void)state;
  const tp_schema *pls = tp_schema_pls();
  tp_error error;
  const uint64_t good[2] = {4, 3};
  assert_int_equal(tp_field_check(pls, "points", TP_F8, 2, good, &error), TP_OK);
  assert_int_equal(tp_field_check(pls, "points", TP_F4, 2, good, &error), TP_E_PARAMS);
  assert_int_equal(tp_field_check(pls, "points", TP_F8, 1, good, &error), TP_E_PARAMS);
  assert_int_equal(tp_field_check(pls, "points", TP_F8, 2, (uint64_t[2]){3, 4}, &error),
                   TP_E_PARAMS);
  assert_int_equal(
      tp_field_check(pls, "points", TP_F8, 2, (uint64_t[2]){UINT64_C(1) << 32, 3}, &error),
      TP_E_PARAMS);
  assert_int_equal(tp_field_check(pls, "point_attributes", TP_F8, 2, (uint64_t[2]){4, 17}, &error),
                   TP_OK);
  assert_int_equal(tp_field_check(pls, "point_attributes", TP_F8, 2, (uint64_t[2]){4, 0}, &error),
                   TP_E_PARAMS);
  assert_int_equal(tp_field_check(pls, "json", TP_F8, 2, good, &error), TP_E_PARAMS);
  assert_string_equal(error.where, "json");
}

static void tables_refer_to_their_own_rows(void **state) {
  (void)state;
  const tp_schema *schemas[2] = {tp_schema_pls(), tp_schema_mesh()};
  for (int s = 0; s < 2; s++) {
    for (size_t i = 0; i < schemas[s]->count; i++) {
      const tp_field *field = &schemas[s]->fields[i];
      assert_true(strlen(field->name) < TP_NAME_SIZE);
      assert_ptr_equal(tp_schema_find(schemas[s], field->name), field);
      if (field->rows_of != NULL) assert_non_null(tp_schema_find(schemas[s], field->rows_of));
    }
  }
}

static void a_mesh_has_points_and_tetrahedra(void **state) {
  (void)state;
  const uint32_t tetrahedron[4] = {0, 1, 2, 3};
  tp_arrays set = TP_ARRAYS_INIT;
  add(&set, "points", TP_F8, 4, 3, zeros);
  refused(&set, tp_schema_mesh(), "tetrahedra");
  add(&set, "tetrahedra", TP_U4, 1, 4, tetrahedron);
  assert_int_equal(tp_arrays_validate(&set, tp_schema_mesh(), NULL), TP_OK);
  add(&set, "tetrahedron_regions", TP_U4, 2, 0, tetrahedron);
  refused(&set, tp_schema_mesh(), "tetrahedron_regions");
  tp_arrays_free(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(csr_arrays_fit_each_other),
      cmocka_unit_test(arrays_need_their_partners),
      cmocka_unit_test(triangles_count_facets),
      cmocka_unit_test(fields_check_dtype_and_shape),
      cmocka_unit_test(tables_refer_to_their_own_rows),
      cmocka_unit_test(a_mesh_has_points_and_tetrahedra),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
