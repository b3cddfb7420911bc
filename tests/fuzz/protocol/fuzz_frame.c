// SPDX-License-Identifier: Apache-2.0
/* Fuzzes tp_reader_next and tp_message_parse: the stream is cut in two ways, which
 * must give the same steps; messages that parse are printed and parsed again. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_LINE = 4096 };

/* What a stream said: counts, and an order-sensitive sum of lines and bodies. */
typedef struct summary {
  uint64_t messages, body_bytes, sum;
  tp_code error;
} summary;

static void check(int holds) {
  if (!holds) abort();
}

static void mix(summary *s, const void *bytes, size_t size) {
  const unsigned char *at = bytes;
  for (size_t i = 0; i < size; i++) s->sum = (s->sum ^ at[i]) * UINT64_C(1099511628211);
}

static void look_at(json_t *json, summary *s) {
  tp_message message;
  tp_error error = {.code = TP_OK};
  char *text = json_dumps(json, JSON_COMPACT | JSON_SORT_KEYS);
  check(text != NULL);
  mix(s, text, strlen(text));
  free(text);
  if (tp_message_parse(json, &message, &error) != TP_OK) {
    char *line = NULL;
    size_t length = 0;
    check(error.code == TP_E_REQUEST);
    check(tp_build_error(message.id, &error, NULL, &line, &length) == TP_OK);
    check(memchr(line, '\n', length) == line + length - 1);
    free(line);
  } else if (message.kind == TP_REQUEST) {
    char *line = NULL;
    size_t length = 0;
    tp_step step;
    tp_reader *reader = NULL;
    check(tp_build_request(message.id, message.method, message.params, 0, &line, &length) == TP_OK);
    check(tp_reader_create(TP_WORKER_LINE, &reader) == TP_OK);
    check(tp_reader_next(reader, line, length, &step) == TP_STEP_MESSAGE);
    check(step.used == length && json_equal(json_object_get(step.json, "id"), message.id));
    json_decref(step.json);
    tp_reader_free(reader);
    free(line);
  }
}

static summary run(const uint8_t *data, size_t size, size_t piece) {
  summary s = {0};
  tp_reader *reader = NULL;
  check(tp_reader_create(MAX_LINE, &reader) == TP_OK);
  for (size_t at = 0; at < size && s.error == TP_OK;) {
    const size_t end = size - at < piece ? size : at + piece;
    tp_step step = {.kind = TP_STEP_BODY};
    while (step.kind != TP_STEP_MORE && step.kind != TP_STEP_ERROR) {
      tp_reader_next(reader, data + at, end - at, &step);
      check(step.used <= end - at);
      at += step.used;
      if (step.kind == TP_STEP_ERROR) s.error = step.error.code;
      if (step.kind == TP_STEP_MESSAGE) {
        s.messages++;
        look_at(step.json, &s);
        json_decref(step.json);
      }
      if (step.kind == TP_STEP_BODY) {
        check(step.size == step.used && step.size > 0);
        s.body_bytes += step.size;
        mix(&s, step.data, step.size);
      }
    }
  }
  tp_reader_free(reader);
  return s;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const summary whole = run(data, size, size != 0 ? size : 1);
  const summary cut = run(data, size, 1 + size % 7);
  check(whole.messages == cut.messages && whole.body_bytes == cut.body_bytes &&
        whole.sum == cut.sum && whole.error == cut.error);
  return 0;
}
