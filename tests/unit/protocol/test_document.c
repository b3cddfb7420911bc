// SPDX-License-Identifier: Apache-2.0
/* The tables of PROTOCOL.md are those of the code. The document is found through
 * TETRAD_SOURCE, the folder of the sources. */
#include "support.h"

#include <stdio.h>

#include "protocol/array.h"
#include "protocol/frame.h"

/* The whole document; the caller frees it. */
static char *read_document(void) {
  const char *source = getenv("TETRAD_SOURCE");
  char path[4096];
  if (source == NULL) return NULL;
  snprintf(path, sizeof path, "%s/protocol/PROTOCOL.md", source);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char *text = calloc(1, 1 << 20);
  assert_non_null(text);
  assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  return text;
}

/* Rows of a Markdown table in [from, to) whose first cell begins with `mark`. */
static unsigned count_rows(const char *from, const char *to, const char *mark) {
  unsigned count = 0;
  for (const char *at = strstr(from, mark); at != NULL && at < to; at = strstr(at + 1, mark)) count++;
  return count;
}

static void errors_are_tabulated(void **state) {
  (void)state;
  char *text = read_document();
  if (text == NULL) skip();
  char *from = strstr(text, "## 9. Errors"), *to = strstr(text, "## 10. ");
  unsigned count = 0;
  tp_code code = TP_OK;
  const char *name = NULL;
  assert_true(from != NULL && to != NULL);
  for (unsigned i = 1; tp_code_at(i, &code, &name); i++, count++) {
    char row[100];
    snprintf(row, sizeof row, "\n| %d | `%s` | ", (int)code, name);
    if (strstr(from, row) == NULL) fail_msg("no row for%s", row);
  }
  char digits[] = "\n| 0";
  unsigned rows = count_rows(from, to, "\n| -");
  for (; digits[3] <= '9'; digits[3]++) rows += count_rows(from, to, digits);
  assert_int_equal(rows, count);
  free(text);
}

static void check_arrays(const tp_schema *schema, const char *begin, const char *end) {
  char *text = read_document();
  if (text == NULL) skip();
  char *from = strstr(text, begin), *to = strstr(text, end);
  assert_true(from != NULL && to != NULL);
  for (size_t i = 0; i < schema->count; i++) {
    const tp_field *field = &schema->fields[i];
    char row[100], columns[16] = "";
    const char *dtype = tp_dtype_name(field->dtype);
    snprintf(row, sizeof row, "\n| `%s` | `%s%s [", field->name, dtype[0] == '|' ? "\\" : "", dtype);
    char *at = strstr(from, row);
    if (at == NULL || at > to) fail_msg("no row for%s", row);
    const char *shape = at + strlen(row);
    if (field->columns > 1) snprintf(columns, sizeof columns, ",%u]", field->columns);
    if (field->columns == TP_ANY_COLUMNS) snprintf(columns, sizeof columns, ",k]");
    const size_t length = strcspn(shape, ",]");
    assert_memory_equal(shape + length, field->columns == 1 ? "]" : columns,
                        field->columns == 1 ? 1 : strlen(columns));
  }
  assert_int_equal(count_rows(from, to, "\n| `"), schema->count);
  free(text);
}

static void arrays_are_tabulated(void **state) {
  (void)state;
  check_arrays(tp_schema_pls(), "### 5.2 ", "### 5.3 ");
  check_arrays(tp_schema_mesh(), "### 5.3 ", "## 6. ");
}

static void limits_are_told(void **state) {
  (void)state;
  char *text = read_document();
  if (text == NULL) skip();
  char row[100];
  snprintf(row, sizeof row, "| `max_line` %d; %d before a required hello |", TP_MAX_LINE,
           TP_HELLO_LINE);
  assert_non_null(strstr(text, row));
  snprintf(row, sizeof row, "| `max_depth` %d |", TP_MAX_DEPTH);
  assert_non_null(strstr(text, row));
  snprintf(row, sizeof row, "lines of up to %d", TP_WORKER_LINE);
  assert_non_null(strstr(text, row));
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_are_tabulated),
      cmocka_unit_test(arrays_are_tabulated),
      cmocka_unit_test(limits_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
