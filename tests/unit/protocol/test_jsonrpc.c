// SPDX-License-Identifier: Apache-2.0
/* Messages: what a line means, and the lines that the builders print. */
#include "support.h"

#include <stdio.h>

#include "protocol/frame.h"

static json_t *load(const char *text) {
  json_t *json = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
  assert_non_null(json);
  return json;
}

static void the_four_kinds(void **state) {
  (void)state;
  tp_message message;
  tp_error error;
  json_t *json = load("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"params\":{\"a\":2},\"body\":9}");
  assert_int_equal(tp_message_parse(json, &message, &error), TP_OK);
  assert_int_equal(message.kind, TP_REQUEST);
  assert_int_equal(json_integer_value(message.id), 1);
  assert_string_equal(message.method, "m");
  assert_int_equal(json_integer_value(json_object_get(message.params, "a")), 2);
  json_decref(json);

  json = load("{\"jsonrpc\":\"2.0\",\"method\":\"m\"}");
  assert_int_equal(tp_message_parse(json, &message, &error), TP_OK);
  assert_int_equal(message.kind, TP_NOTIFICATION);
  assert_null(message.id);
  assert_null(message.params);
  json_decref(json);

  json = load("{\"jsonrpc\":\"2.0\",\"id\":\"x\",\"result\":null,\"later\":1}");
  assert_int_equal(tp_message_parse(json, &message, &error), TP_OK);
  assert_int_equal(message.kind, TP_REPLY);
  assert_true(json_is_null(message.result));
  json_decref(json);

  json = load("{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":4,\"message\":\"later\"}}");
  assert_int_equal(tp_message_parse(json, &message, &error), TP_OK);
  assert_int_equal(message.kind, TP_ERROR_REPLY);
  assert_true(json_is_null(message.id));
  assert_int_equal(message.code, 4);
  assert_string_equal(message.name, "busy");
  assert_string_equal(message.text, "later");
  json_decref(json);

  json = load("{\"jsonrpc\":\"2.0\",\"id\":3,\"error\":{\"code\":4444,\"message\":\"\",\"data\":"
              "{\"name\":\"new_one\"}}}");
  assert_int_equal(tp_message_parse(json, &message, &error), TP_OK);
  assert_string_equal(message.name, "new_one");
  json_decref(json);
}

static void what_is_no_message(void **state) {
  (void)state;
  static const struct {
    const char *line;
    int answerable; /* the id was found all the same */
  } cases[] = {
      {"{}", 0},
      {"{\"jsonrpc\":\"1.0\",\"id\":1,\"method\":\"m\"}", 1},
      {"{\"jsonrpc\":2.0,\"id\":1,\"method\":\"m\"}", 1},
      {"{\"id\":1,\"method\":\"m\"}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":5}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"params\":[]}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"params\":null}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"extra\":1}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":null,\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":1.5,\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":true,\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":\"\",\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":9007199254740993,\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":\"12345678901234567890123456789012345678901234567890123456789"
       "012345\",\"method\":\"m\"}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"result\":1}", 1},
      {"{\"jsonrpc\":\"2.0\",\"result\":1}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":null,\"result\":1}", 0},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":1,\"error\":{}}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"message\":\"m\"}}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":1.5,\"message\":\"m\"}}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":1,\"message\":\"m\",\"data\":3}}", 1},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":7}", 1},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    tp_message message;
    tp_error error;
    json_t *json = load(cases[i].line);
    assert_int_equal(tp_message_parse(json, &message, &error), TP_E_REQUEST);
    assert_int_equal(message.id != NULL, cases[i].answerable);
    json_decref(json);
  }
}

static void unknown_params_are_named(void **state) {
  (void)state;
  static const char *const names[] = {"job", "key", NULL};
  tp_error error;
  json_t *json = load("{\"job\":1,\"jop\":2}");
  assert_int_equal(tp_params_known(json, names, &error), TP_E_PARAMS);
  assert_string_equal(error.where, "jop");
  json_object_del(json, "jop");
  assert_int_equal(tp_params_known(json, names, &error), TP_OK);
  assert_int_equal(tp_params_known(NULL, names, &error), TP_OK);
  json_decref(json);
}

static void check_line(char *line, size_t size, const char *wanted) {
  assert_int_equal(size, strlen(wanted));
  assert_memory_equal(line, wanted, size);
  free(line);
}

static void builders_print_lines(void **state) {
  (void)state;
  char *line = NULL;
  size_t size = 0;
  json_t *id = json_integer(7);
  json_t *params = json_pack("{s:s}", "a", "x\ny");
  assert_int_equal(tp_build_request(id, "m", params, 12, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"m\",\"body\":12,\"params\":"
                         "{\"a\":\"x\\ny\"}}\n");
  assert_int_equal(tp_build_request(id, "m", NULL, 0, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"m\"}\n");
  assert_int_equal(tp_build_notification("n", params, 0, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"method\":\"n\",\"params\":{\"a\":\"x\\ny\"}}\n");
  assert_int_equal(tp_build_reply(id, params, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"id\":7,\"result\":{\"a\":\"x\\ny\"}}\n");
  json_decref(params);
  json_decref(id);
}

static void errors_carry_their_name(void **state) {
  (void)state;
  char *line = NULL;
  size_t size = 0;
  tp_error error;
  json_t *id = json_string("a");
  json_t *data = json_pack("{s:i}", "retry_ms", 50);
  tp_fail(&error, TP_E_BUSY, NULL, "come back");
  assert_int_equal(tp_build_error(id, &error, data, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"id\":\"a\",\"error\":{\"code\":4,\"message\":\"come"
                         " back\",\"data\":{\"retry_ms\":50,\"name\":\"busy\"}}}\n");
  assert_int_equal(json_object_size(data), 1);
  tp_fail(&error, TP_E_PARAMS, "\xc3\xa4\xff", "broken \xe2\x82");
  assert_int_equal(tp_build_error(NULL, &error, NULL, &line, &size), TP_OK);
  check_line(line, size, "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32602,\"message\":"
                         "\"broken ??\",\"data\":{\"name\":\"invalid_params\",\"where\":\"\xc3\xa4?\"}}}\n");
  json_decref(data);
  json_decref(id);
}

static void lines_too_long_are_not_built(void **state) {
  (void)state;
  char *line = NULL;
  size_t size = 0;
  char *text = malloc(TP_WORKER_LINE + 1);
  assert_non_null(text);
  memset(text, 'x', TP_WORKER_LINE);
  text[TP_WORKER_LINE] = '\0';
  json_t *result = json_string(text);
  json_t *id = json_integer(1);
  assert_int_equal(tp_build_reply(id, result, &line, &size), TP_E_LINE_TOO_LONG);
  assert_null(line);
  text[TP_WORKER_LINE - 100] = '\0';
  json_string_set(result, text);
  assert_int_equal(tp_build_reply(id, result, &line, &size), TP_OK);
  free(line);
  json_decref(id);
  json_decref(result);
  free(text);
}

static void doubles_survive_a_line(void **state) {
  (void)state;
  uint64_t seed = 99;
  json_t *id = json_integer(1);
  for (int i = 0; i < 500; i++) {
    const double value = (double)(int64_t)draw(&seed) / (double)(draw(&seed) | 1);
    char *line = NULL;
    size_t size = 0;
    json_t *result = json_real(value);
    assert_int_equal(tp_build_reply(id, result, &line, &size), TP_OK);
    json_t *back = json_loadb(line, size, 0, NULL);
    assert_true(json_real_value(json_object_get(back, "result")) == value);
    json_decref(back);
    json_decref(result);
    free(line);
  }
  json_decref(id);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_four_kinds),           cmocka_unit_test(what_is_no_message),
      cmocka_unit_test(unknown_params_are_named), cmocka_unit_test(builders_print_lines),
      cmocka_unit_test(errors_carry_their_name),  cmocka_unit_test(lines_too_long_are_not_built),
      cmocka_unit_test(doubles_survive_a_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
