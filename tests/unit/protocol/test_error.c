// SPDX-License-Identifier: Apache-2.0
/* The table of errors: names and numbers are one to one. */
#include "support.h"

#include <stdio.h>

#include "protocol/error.h"

static void names_and_numbers_are_one_to_one(void **state) {
  (void)state;
  tp_code code = TP_OK, other = TP_OK;
  const char *name = NULL, *other_name = NULL;
  unsigned count = 0;
  for (; tp_code_at(count, &code, &name); count++) {
    assert_string_equal(tp_code_name(code), name);
    assert_int_equal(tp_code_of(name), code);
    for (unsigned j = 0; j < count; j++) {
      assert_int_equal(tp_code_at(j, &other, &other_name), 1);
      assert_int_not_equal(other, code);
      assert_string_not_equal(other_name, name);
    }
  }
  assert_true(count > 40);
}

static void strangers_have_no_name(void **state) {
  (void)state;
  assert_null(tp_code_name(99));
  assert_null(tp_code_name(INT64_MAX));
  assert_int_equal(tp_code_of("no_such_error"), TP_OK);
}

static void fail_cuts_texts_at_characters(void **state) {
  (void)state;
  tp_error error;
  char text[400];
  for (size_t i = 0; i + 2 < sizeof text; i += 2) memcpy(text + i, "\xc3\xa4", 2);
  text[398] = '\0';
  for (int shift = 0; shift < 2; shift++) {
    assert_int_equal(tp_fail(&error, TP_E_PARAMS, text + 2 * shift, "%.*s%s", shift, "x", text),
                     TP_E_PARAMS);
    assert_int_equal(error.code, TP_E_PARAMS);
    /* whole characters up to the cut; what is left of one is a '?' */
    const size_t length = strlen(error.message);
    assert_int_equal(length, TP_ERROR_TEXT - 1);
    assert_true(error.message[length - 1] == '?' || error.message[length - 1] == '\xa4');
    assert_int_equal(strlen(error.where), TP_ERROR_WHERE - 1);
    assert_int_equal(error.where[TP_ERROR_WHERE - 2], '?');
  }
  assert_int_equal(tp_fail(NULL, TP_E_BUSY, NULL, "x"), TP_E_BUSY);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names_and_numbers_are_one_to_one),
      cmocka_unit_test(strangers_have_no_name),
      cmocka_unit_test(fail_cuts_texts_at_characters),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
