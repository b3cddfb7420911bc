// SPDX-License-Identifier: Apache-2.0
/* frame.c: the incremental reader of lines and bodies (PROTOCOL.md, "Framing").
 * What the lines mean is jsonrpc.c's. */
#include "protocol/frame.h"

#include <stdlib.h>
#include <string.h>

struct tp_reader {
  size_t max_line;
  char *line;         /* the unfinished line */
  size_t size;
  size_t capacity;
  uint64_t body_left; /* of the last message's body */
  bool broken;
  tp_error error;     /* if broken */
};

tp_code tp_reader_create(size_t max_line, tp_reader **ret_reader) {
  tp_reader *reader = calloc(1, sizeof *reader);
  if (reader == NULL) return TP_E_INTERNAL;
  reader->max_line = max_line;
  *ret_reader = reader;
  return TP_OK;
}

void tp_reader_free(tp_reader *reader) {
  if (reader == NULL) return;
  free(reader->line);
  free(reader);
}

void tp_reader_set_max_line(tp_reader *reader, size_t max_line) { reader->max_line = max_line; }

bool tp_reader_idle(const tp_reader *reader) {
  return !reader->broken && reader->size == 0 && reader->body_left == 0;
}

static tp_step_kind give_error(const tp_reader *reader, tp_step *step) {
  step->kind = TP_STEP_ERROR;
  step->error = reader->error;
  return TP_STEP_ERROR;
}

/* Appends to the unfinished line. Memory grows with what came, not with max_line. */
static tp_code keep(tp_reader *reader, const char *bytes, size_t size) {
  if (size > reader->capacity - reader->size) {
    size_t capacity = reader->capacity != 0 ? 2 * reader->capacity : 1024;
    while (capacity < reader->size + size) capacity *= 2;
    char *line = realloc(reader->line, capacity);
    if (line == NULL) return tp_fail(&reader->error, TP_E_INTERNAL, NULL, "out of memory");
    reader->line = line;
    reader->capacity = capacity;
  }
  if (size != 0) memcpy(reader->line + reader->size, bytes, size);
  reader->size += size;
  return TP_OK;
}

/* Gives back the memory of an unusually long line. */
static void forget(tp_reader *reader) {
  reader->size = 0;
  if (reader->capacity <= 8192) return;
  free(reader->line);
  reader->line = NULL;
  reader->capacity = 0;
}

/* Reads a complete line (its '\n' excluded) into step->json and step->body. */
static tp_code parse_line(tp_reader *reader, const char *text, size_t size, tp_step *step) {
  json_error_t report;
  json_t *json = json_loadb(text, size, JSON_REJECT_DUPLICATES, &report);
  if (json == NULL) {
    if (json_error_code(&report) == json_error_out_of_memory)
      return tp_fail(&reader->error, TP_E_INTERNAL, NULL, "out of memory");
    return tp_fail(&reader->error, TP_E_PARSE, NULL, "the line is no JSON object: %s",
                   report.text);
  }
  if (!json_is_object(json)) {
    json_decref(json);
    return tp_fail(&reader->error, TP_E_PARSE, NULL, "the line is a list, not one JSON object");
  }
  const json_t *body = json_object_get(json, "body");
  const json_int_t bytes = json_integer_value(body);
  if (body != NULL && (!json_is_integer(body) || bytes < 0 || bytes > TP_MAX_INTEGER)) {
    json_decref(json);
    return tp_fail(&reader->error, TP_E_BAD_BODY, "body", "body is no integer from 0 to 2^53");
  }
  reader->body_left = (uint64_t)bytes;
  step->kind = TP_STEP_MESSAGE;
  step->json = json;
  step->body = (uint64_t)bytes;
  step->depth = tp_json_depth(json);
  return TP_OK;
}

static tp_code take_line(tp_reader *reader, const char *bytes, size_t size, tp_step *step) {
  const char *end = size != 0 ? memchr(bytes, '\n', size) : NULL;
  const size_t length = end != NULL ? (size_t)(end - bytes) : size;
  /* An unfinished line still needs its '\n', so it is too long one byte earlier. */
  if (reader->size >= reader->max_line || length >= reader->max_line - reader->size)
    return tp_fail(&reader->error, TP_E_LINE_TOO_LONG, NULL, "a line has at most %zu bytes",
                   reader->max_line);
  if (end == NULL) {
    step->used = size;
    return keep(reader, bytes, size);
  }
  step->used = length + 1;
  if (reader->size == 0) return parse_line(reader, bytes, length, step);
  tp_code code = keep(reader, bytes, length);
  if (code == TP_OK) code = parse_line(reader, reader->line, reader->size, step);
  forget(reader);
  return code;
}

tp_step_kind tp_reader_next(tp_reader *reader, const void *bytes, size_t size, tp_step *ret_step) {
  *ret_step = (tp_step){.kind = TP_STEP_MORE};
  if (reader->broken) return give_error(reader, ret_step);
  if (reader->body_left != 0) {
    if (size == 0) return TP_STEP_MORE;
    const size_t piece = size < reader->body_left ? size : (size_t)reader->body_left;
    reader->body_left -= piece;
    ret_step->kind = TP_STEP_BODY;
    ret_step->used = piece;
    ret_step->data = bytes;
    ret_step->size = piece;
    ret_step->body = reader->body_left;
    return TP_STEP_BODY;
  }
  if (size == 0) return TP_STEP_MORE;
  if (take_line(reader, bytes, size, ret_step) == TP_OK) return ret_step->kind;
  reader->broken = true;
  return give_error(reader, ret_step);
}

unsigned tp_json_depth(const json_t *json) {
  unsigned deepest = 0;
  if (json_is_array(json)) {
    for (size_t i = 0; i < json_array_size(json); i++) {
      const unsigned depth = tp_json_depth(json_array_get(json, i));
      if (depth > deepest) deepest = depth;
    }
    return deepest + 1;
  }
  if (json_is_object(json)) {
    json_t *object = (json_t *)(uintptr_t)json; /* jansson's iterators take no const */
    for (void *at = json_object_iter(object); at != NULL; at = json_object_iter_next(object, at)) {
      const unsigned depth = tp_json_depth(json_object_iter_value(at));
      if (depth > deepest) deepest = depth;
    }
    return deepest + 1;
  }
  return 0;
}
