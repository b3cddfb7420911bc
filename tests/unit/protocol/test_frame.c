// SPDX-License-Identifier: Apache-2.0
/* The reader of lines and bodies, fed in pieces of every size. */
#include "support.h"

#include <stdio.h>

#include "protocol/frame.h"

/* What a stream says, independent of how it was cut: messages, bodies, an error. */
typedef struct seen {
  char text[4096];
  size_t size;
} seen;

static void note(seen *log, const void *bytes, size_t size) {
  assert_true(log->size + size < sizeof log->text);
  memcpy(log->text + log->size, bytes, size);
  log->size += size;
  log->text[log->size] = '\0';
}

/* Feeds `bytes` in pieces of `piece`; returns the error that ended it, or TP_OK. */
static tp_code feed(tp_reader *reader, const char *bytes, size_t size, size_t piece, seen *log) {
  for (size_t at = 0; at < size;) {
    const size_t end = size - at < piece ? size : at + piece;
    /* an exact copy, so that a sanitizer sees every step outside */
    char *copy = malloc(end - at);
    assert_non_null(copy);
    memcpy(copy, bytes + at, end - at);
    size_t used = 0;
    for (;;) {
      tp_step step;
      const tp_step_kind kind = tp_reader_next(reader, copy + used, end - at - used, &step);
      assert_int_equal(kind, step.kind);
      used += step.used;
      assert_true(used <= end - at);
      if (kind == TP_STEP_MORE) {
        assert_int_equal(used, end - at);
        break;
      }
      if (kind == TP_STEP_BODY) {
        assert_true(step.size >= 1 && step.size == step.used);
        note(log, step.data, step.size);
        if (step.body == 0) note(log, ";", 1);
        continue;
      }
      if (kind == TP_STEP_ERROR) {
        free(copy);
        tp_step again;
        assert_int_equal(tp_reader_next(reader, "{}\n", 3, &again), TP_STEP_ERROR);
        assert_int_equal(again.error.code, step.error.code);
        assert_false(tp_reader_idle(reader));
        return step.error.code;
      }
      char *text = json_dumps(step.json, JSON_COMPACT | JSON_SORT_KEYS);
      assert_non_null(text);
      note(log, text, strlen(text));
      free(text);
      json_decref(step.json);
    }
    free(copy);
    at = end;
  }
  return TP_OK;
}

static tp_code run(const char *bytes, size_t size, size_t max_line, size_t piece, seen *log) {
  tp_reader *reader = NULL;
  log->size = 0;
  log->text[0] = '\0';
  assert_int_equal(tp_reader_create(max_line, &reader), TP_OK);
  const tp_code code = feed(reader, bytes, size, piece, log);
  tp_reader_free(reader);
  return code;
}

static void every_cut_gives_the_same(void **state) {
  (void)state;
  const char stream[] = "{\"a\":1}\n{\"body\":5,\"b\":2}\n{\n\"x\n{ \"c\" : [1,2] } \r\n"
                        "{\"body\":0}\n{\"body\":1}\n\n{}\n";
  const char wanted[] = "{\"a\":1}{\"b\":2,\"body\":5}{\n\"x\n;{\"c\":[1,2]}{\"body\":0}{\"body\":1}"
                        "\n;{}";
  seen log;
  for (size_t piece = 1; piece <= sizeof stream; piece++) {
    assert_int_equal(run(stream, sizeof stream - 1, 64, piece, &log), TP_OK);
    assert_string_equal(log.text, wanted);
  }
}

static void lines_have_a_limit(void **state) {
  (void)state;
  char line[101];
  seen log;
  memset(line, ' ', sizeof line);
  memcpy(line, "{}", 2);
  line[99] = '\n';
  for (size_t piece = 1; piece <= 100; piece += 9) {
    assert_int_equal(run(line, 100, 100, piece, &log), TP_OK);
    assert_string_equal(log.text, "{}");
    assert_int_equal(run(line, 100, 99, piece, &log), TP_E_LINE_TOO_LONG);
    /* refused before its end has come */
    assert_int_equal(run(line, 99, 99, piece, &log), TP_E_LINE_TOO_LONG);
    assert_int_equal(run(line, 98, 99, piece, &log), TP_OK);
  }
  tp_reader *reader = NULL;
  assert_int_equal(tp_reader_create(10, &reader), TP_OK);
  tp_reader_set_max_line(reader, 100);
  log.size = 0;
  assert_int_equal(feed(reader, line, 100, 7, &log), TP_OK);
  tp_reader_set_max_line(reader, 10);
  assert_int_equal(feed(reader, line, 100, 7, &log), TP_E_LINE_TOO_LONG);
  tp_reader_free(reader);
}

static void what_breaks_a_stream(void **state) {
  (void)state;
  static const struct {
    const char *line;
    tp_code code;
  } cases[] = {
      {"\n", TP_E_PARSE},
      {"x\n", TP_E_PARSE},
      {"[]\n", TP_E_PARSE},
      {"[{}]\n", TP_E_PARSE},
      {"1\n", TP_E_PARSE},
      {"{}{}\n", TP_E_PARSE},
      {"{} x\n", TP_E_PARSE},
      {"{\"a\":1,\"a\":1}\n", TP_E_PARSE},
      {"{\"a\":{\"b\":1,\"c\":2,\"b\":1}}\n", TP_E_PARSE},
      {"{\"a\":1,\"\\u0061\":1}\n", TP_E_PARSE},
      {"{\"a\":NaN}\n", TP_E_PARSE},
      {"{\"a\":1e999}\n", TP_E_PARSE},
      {"{\"a\":99999999999999999999}\n", TP_E_PARSE},
      {"{\"a\":\"\\u0000\"}\n", TP_E_PARSE},
      {"{\"a\":\"\xff\"}\n", TP_E_PARSE},
      {"{\"a\":\"\xc0\x80\"}\n", TP_E_PARSE},
      {"{\"body\":-1}\n", TP_E_BAD_BODY},
      {"{\"body\":1.0}\n", TP_E_BAD_BODY},
      {"{\"body\":null}\n", TP_E_BAD_BODY},
      {"{\"body\":\"5\"}\n", TP_E_BAD_BODY},
      {"{\"body\":true}\n", TP_E_BAD_BODY},
      {"{\"body\":9007199254740993}\n", TP_E_BAD_BODY},
      {"{\"body\":1,\"body\":2}\n", TP_E_PARSE},
  };
  seen log;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    assert_int_equal(run(cases[i].line, strlen(cases[i].line), 1000, 1000, &log), cases[i].code);
    assert_int_equal(run(cases[i].line, strlen(cases[i].line), 1000, 1, &log), cases[i].code);
  }
  assert_int_equal(run("{\0}\n", 4, 1000, 1000, &log), TP_E_PARSE);
  assert_int_equal(run("{\"body\":9007199254740992}\nxyz", 29, 1000, 1000, &log), TP_OK);
}

static void depth_is_told(void **state) {
  (void)state;
  for (unsigned depth = 1; depth <= 40; depth++) {
    char line[200] = "";
    tp_reader *reader = NULL;
    tp_step step;
    for (unsigned i = 0; i < depth; i++) strcat(line, i % 2 == 0 ? "{\"a\":" : "[");
    strcat(line, "0");
    for (unsigned i = depth; i-- > 0;) strcat(line, i % 2 == 0 ? "}" : "]");
    strcat(line, "\n");
    assert_int_equal(tp_reader_create(1000, &reader), TP_OK);
    assert_int_equal(tp_reader_next(reader, line, strlen(line), &step), TP_STEP_MESSAGE);
    assert_int_equal(step.depth, depth);
    json_decref(step.json);
    tp_reader_free(reader);
  }
}

static void very_deep_lines_break_it(void **state) {
  (void)state;
  char *line = malloc(TP_MAX_LINE);
  seen log;
  assert_non_null(line);
  memset(line, '[', TP_MAX_LINE);
  memcpy(line, "{\"a\":", 5);
  line[TP_MAX_LINE - 1] = '\n';
  assert_int_equal(run(line, TP_MAX_LINE, TP_MAX_LINE, TP_MAX_LINE, &log), TP_E_PARSE);
  free(line);
}

static void a_stream_may_end_between_messages(void **state) {
  (void)state;
  tp_reader *reader = NULL;
  seen log = {.size = 0};
  assert_int_equal(tp_reader_create(1000, &reader), TP_OK);
  assert_true(tp_reader_idle(reader));
  assert_int_equal(feed(reader, "{\"body\":2", 9, 3, &log), TP_OK);
  assert_false(tp_reader_idle(reader));
  assert_int_equal(feed(reader, "}\n", 2, 3, &log), TP_OK);
  assert_false(tp_reader_idle(reader));
  assert_int_equal(feed(reader, "xy", 2, 1, &log), TP_OK);
  assert_true(tp_reader_idle(reader));
  tp_reader_free(reader);
  tp_reader_free(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_cut_gives_the_same), cmocka_unit_test(lines_have_a_limit),
      cmocka_unit_test(what_breaks_a_stream),     cmocka_unit_test(depth_is_told),
      cmocka_unit_test(very_deep_lines_break_it), cmocka_unit_test(a_stream_may_end_between_messages),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
