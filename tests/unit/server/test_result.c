// SPDX-License-Identifier: Apache-2.0
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <event2/event.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/daemon/result.h"

static void on_end(void *user, int error) { (void)user, (void)error; }

typedef struct fixture {
  char parent[32];
  struct event_base *base;
  spool *spool;
  result *result;
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  strcpy(f->parent, "/tmp/test_result_XXXXXX");
  if (!mkdtemp(f->parent)) return -1;
  f->base = event_base_new();
  f->spool = spool_create(f->base, f->parent, 1000);
  f->result = f->spool ? result_create(f->spool, on_end, NULL) : NULL;
  *state = f;
  return f->result ? 0 : -1;
}

static int tear_down(void **state) {
  fixture *f = *state;
  result_unref(f->result);
  spool_free(f->spool);
  event_base_free(f->base);
  int left = rmdir(f->parent);
  free(f);
  return left;
}

/* A row of the array table: bytes, 1048576 of them in a chunk. */
static json_t *row(const char *name, json_int_t rows) {
  return json_pack("{s:s, s:s, s:[I], s:s, s:I, s:I, s:I}", "name", name, "dtype", "|u1", "shape",
                   rows, "codec", "raw", "rows_per_chunk", (json_int_t)1048576, "chunks",
                   (rows + 1048575) / 1048576, "crc32", (json_int_t)0);
}

static tp_code complete(result *r, json_t *a, json_t *b) {
  json_t *table = json_array();
  tp_error error;
  if (a) json_array_append_new(table, a);
  if (b) json_array_append_new(table, b);
  tp_code code = result_complete(r, table, &error);
  json_decref(table);
  return code;
}

static void test_chunks_come_in_order(void **state) {
  fixture *f = *state;
  const result_chunk whole = {.rows = 1048576}, rest = {.rows = 24};
  assert_false(result_add(f->result, "a", 1, &whole));
  assert_true(result_add(f->result, "a", 0, &whole));
  assert_false(result_add(f->result, "a", 0, &whole));
  assert_true(result_add(f->result, "a", 1, &rest));
  assert_true(result_add(f->result, "b", 0, &rest));
  assert_false(result_add(f->result, "a", 2, &rest)); /* b has begun */
  assert_int_equal(complete(f->result, row("b", 24), row("a", 1048600)), TP_OK);
  assert_int_equal(f->result->n_arrays, 2);
  assert_string_equal(f->result->arrays[0].info.name, "b"); /* the table's order */
  assert_int_equal(result_find(f->result, "a")->count, 2);
  assert_null(result_find(f->result, "c"));
}

static void test_the_table_fits_the_chunks(void **state) {
  fixture *f = *state;
  const result_chunk chunk = {.rows = 24};
  assert_true(result_add(f->result, "a", 0, &chunk));
  assert_true(result_add(f->result, "b", 0, &chunk));
  assert_int_equal(complete(f->result, row("a", 24), NULL), TP_E_PARAMS);
  assert_int_equal(complete(f->result, row("a", 24), row("a", 24)), TP_E_PARAMS);
  assert_int_equal(complete(f->result, row("a", 24), row("b", 25)), TP_E_PARAMS);
  assert_int_equal(complete(f->result, row("a", 24), row("b", 1048600)), TP_E_PARAMS);
  assert_int_equal(complete(f->result, row("a", 24), json_object()), TP_E_PARAMS);
  assert_int_equal(complete(f->result, row("a", 24), row("b", 24)), TP_OK);
}

static void test_empty_arrays_have_no_chunks(void **state) {
  fixture *f = *state;
  assert_int_equal(complete(f->result, row("a", 0), NULL), TP_OK);
  assert_int_equal(result_find(f->result, "a")->count, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_chunks_come_in_order, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_the_table_fits_the_chunks, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_empty_arrays_have_no_chunks, set_up, tear_down),
  };
  return cmocka_run_group_tests_name("result", tests, NULL, NULL);
}
