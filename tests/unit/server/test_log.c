// SPDX-License-Identifier: Apache-2.0
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/log.h"

static const log_field none = {LOG_END, NULL, NULL, 0, 0.0};

static void expect_line(const char *message, const log_field *fields, const char *expected) {
  char line[LOG_LINE];
  size_t size = log_format(line, 1769860800.1239, LOG_INFO, message, fields);
  assert_int_equal(line[size - 1], '\n');
  line[size - 1] = '\0';
  assert_string_equal(line, expected);
}

static void test_plain(void **state) {
  (void)state;
  const log_field fields[] = {log_text("job", "k3v9x.1"), log_int("worker", -7),
                              log_real("seconds", 0.125), log_text("left_out", NULL), none};
  expect_line("ended", fields,
              "ts=2026-01-31T12:00:00.123Z level=info msg=ended job=k3v9x.1 worker=-7 seconds=0.125");
}

static void test_quoted(void **state) {
  (void)state;
  const log_field fields[] = {log_text("a", ""), log_text("b", "x y"), log_text("c", "q\"\\\n\x7f"),
                              log_text("d", "k=v"), none};
  expect_line("two words", fields,
              "ts=2026-01-31T12:00:00.123Z level=info msg=\"two words\" a=\"\" b=\"x y\" "
              "c=\"q\\\"\\\\\\x0a\\x7f\" d=\"k=v\"");
}

/* One line whatever is in it, never longer than the buffer. */
static void test_long(void **state) {
  (void)state;
  char value[3 * LOG_LINE], line[LOG_LINE];
  memset(value, '"', sizeof value - 1);
  value[sizeof value - 1] = '\0';
  const log_field fields[] = {log_text("long", value), log_int("after", 1), none};
  size_t size = log_format(line, 0.0, LOG_ERROR, "m", fields);
  assert_int_equal(size, LOG_LINE);
  assert_ptr_equal(memchr(line, '\n', size), line + size - 1);
  assert_memory_equal(line, "ts=1970-01-01T00:00:00.000Z level=error msg=m long=", 51);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plain),
      cmocka_unit_test(test_quoted),
      cmocka_unit_test(test_long),
  };
  return cmocka_run_group_tests_name("log", tests, NULL, NULL);
}
