// SPDX-License-Identifier: Apache-2.0
/* jsonrpc.c: what a line means as a JSON-RPC 2.0 message, and the lines that we
 * send (PROTOCOL.md, "Messages"). The framing is frame.c's. */
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"

/* An id that can be answered: an integer within 2^53 or a short string. */
static bool id_fits(const json_t *id) {
  if (json_is_integer(id)) {
    const json_int_t value = json_integer_value(id);
    return value >= -TP_MAX_INTEGER && value <= TP_MAX_INTEGER;
  }
  const size_t length = json_string_length(id);
  return json_is_string(id) && length >= 1 && length <= TP_MAX_ID;
}

/* The first member that is not in the list, or NULL. */
static const char *unknown_member(const json_t *object, const char *const *names) {
  json_t *open = (json_t *)(uintptr_t)object; /* jansson's iterators take no const */
  for (void *at = json_object_iter(open); at != NULL; at = json_object_iter_next(open, at)) {
    const char *member = json_object_iter_key(at);
    size_t i = 0;
    while (names[i] != NULL && strcmp(names[i], member) != 0) i++;
    if (names[i] == NULL) return member;
  }
  return NULL;
}

tp_code tp_params_known(const json_t *params, const char *const *names, tp_error *error) {
  const char *member = params != NULL ? unknown_member(params, names) : NULL;
  if (member == NULL) return TP_OK;
  return tp_fail(error, TP_E_PARAMS, member, "unknown param \"%.60s\"", member);
}

static tp_code parse_call(json_t *json, tp_message *message, tp_error *error) {
  static const char *const members[] = {"jsonrpc", "id", "method", "params", "body", NULL};
  const char *unknown = unknown_member(json, members);
  json_t *method = json_object_get(json, "method");
  json_t *params = json_object_get(json, "params");
  if (unknown != NULL)
    return tp_fail(error, TP_E_REQUEST, unknown, "unknown member \"%.60s\"", unknown);
  if (!json_is_string(method))
    return tp_fail(error, TP_E_REQUEST, "method", "method is no string");
  if (params != NULL && !json_is_object(params))
    return tp_fail(error, TP_E_REQUEST, "params", "params is no object");
  message->kind = message->id != NULL ? TP_REQUEST : TP_NOTIFICATION;
  message->method = json_string_value(method);
  message->params = params;
  return TP_OK;
}

static tp_code parse_error(json_t *object, tp_message *message, tp_error *error) {
  const json_t *code = json_object_get(object, "code");
  const json_t *text = json_object_get(object, "message");
  json_t *data = json_object_get(object, "data");
  if (!json_is_integer(code) || !json_is_string(text) || (data != NULL && !json_is_object(data)))
    return tp_fail(error, TP_E_REQUEST, "error", "error is no error object");
  message->kind = TP_ERROR_REPLY;
  message->code = json_integer_value(code);
  message->text = json_string_value(text);
  message->data = data;
  message->name = json_string_value(json_object_get(data, "name"));
  if (message->name == NULL) message->name = tp_code_name(message->code);
  if (message->name == NULL) message->name = "";
  return TP_OK;
}

tp_code tp_message_parse(json_t *json, tp_message *ret_message, tp_error *error) {
  *ret_message = (tp_message){.kind = TP_REQUEST, .name = "", .text = ""};
  const char *version = json_string_value(json_object_get(json, "jsonrpc"));
  json_t *id = json_object_get(json, "id");
  json_t *failure = json_object_get(json, "error");
  json_t *result = json_object_get(json, "result");
  if (id != NULL && (id_fits(id) || (failure != NULL && json_is_null(id)))) ret_message->id = id;
  if (version == NULL || strcmp(version, "2.0") != 0)
    return tp_fail(error, TP_E_REQUEST, "jsonrpc", "jsonrpc is not \"2.0\"");
  if (id != NULL && ret_message->id == NULL)
    return tp_fail(error, TP_E_REQUEST, "id",
                   "id is neither an integer within 2^53 nor a string of 1 to %d bytes", TP_MAX_ID);
  if (failure == NULL && result == NULL) return parse_call(json, ret_message, error);
  if (json_object_get(json, "method") != NULL || (failure != NULL && result != NULL) || id == NULL)
    return tp_fail(error, TP_E_REQUEST, NULL, "neither request nor reply");
  if (failure != NULL) return parse_error(failure, ret_message, error);
  ret_message->kind = TP_REPLY;
  ret_message->result = result;
  return TP_OK;
}

/* Prints `message` (whose reference it takes) as a line. */
static tp_code print_line(json_t *message, char **ret_line, size_t *ret_size) {
  if (message == NULL) return TP_E_INTERNAL;
  /* 17 significant digits, not the shortest form: doubles come back bit for bit */
  const size_t flags = JSON_COMPACT | JSON_REAL_PRECISION(17);
  tp_code code = TP_OK;
  char *text = json_dumps(message, flags);
  json_decref(message);
  if (text == NULL) return TP_E_INTERNAL;
  const size_t length = strlen(text);
  if (length + 1 > TP_WORKER_LINE) {
    code = TP_E_LINE_TOO_LONG;
  } else {
    char *line = realloc(text, length + 1); /* '\n' takes the place of the NUL */
    if (line == NULL) {
      code = TP_E_INTERNAL;
    } else {
      line[length] = '\n';
      *ret_line = line;
      *ret_size = length + 1;
      return TP_OK;
    }
  }
  free(text);
  return code;
}

/* Adds a borrowed value; the library's const views become counted references. */
static int add(json_t *object, const char *name, const json_t *value) {
  return json_object_set(object, name, (json_t *)(uintptr_t)value);
}

static json_t *begin(const json_t *id) {
  json_t *message = json_pack("{s:s}", "jsonrpc", "2.0");
  if (message != NULL && id != NULL && add(message, "id", id) != 0) {
    json_decref(message);
    return NULL;
  }
  return message;
}

static tp_code build_call(const json_t *id, const char *method, const json_t *params, uint64_t body,
                          char **ret_line, size_t *ret_size) {
  json_t *message = begin(id);
  if (message == NULL) return TP_E_INTERNAL;
  int failed = json_object_set_new(message, "method", json_string(method));
  if (body != 0) failed |= json_object_set_new(message, "body", json_integer((json_int_t)body));
  if (params != NULL) failed |= add(message, "params", params);
  if (failed != 0) {
    json_decref(message);
    return TP_E_INTERNAL;
  }
  return print_line(message, ret_line, ret_size);
}

tp_code tp_build_request(const json_t *id, const char *method, const json_t *params, uint64_t body,
                         char **ret_line, size_t *ret_size) {
  return build_call(id, method, params, body, ret_line, ret_size);
}

tp_code tp_build_notification(const char *method, const json_t *params, uint64_t body,
                              char **ret_line, size_t *ret_size) {
  return build_call(NULL, method, params, body, ret_line, ret_size);
}

tp_code tp_build_reply(const json_t *id, const json_t *result, char **ret_line, size_t *ret_size) {
  json_t *message = begin(id);
  if (message == NULL) return TP_E_INTERNAL;
  if (add(message, "result", result) != 0) {
    json_decref(message);
    return TP_E_INTERNAL;
  }
  return print_line(message, ret_line, ret_size);
}

json_t *tp_error_json(const tp_error *error, const json_t *data) {
  const char *name = tp_code_name(error->code);
  json_t *details = data != NULL ? json_copy((json_t *)(uintptr_t)data) : json_object();
  if (details == NULL) return NULL;
  int failed = json_object_set_new(details, "name", json_string(name != NULL ? name : ""));
  /* `where` may echo what the peer sent, cut within a character */
  if (error->where[0] != '\0' && json_object_get(details, "where") == NULL) {
    json_t *where = json_string(error->where);
    if (where != NULL) failed |= json_object_set_new(details, "where", where);
  }
  json_t *text = json_string(error->message);
  if (text == NULL) text = json_string(name != NULL ? name : "");
  if (failed != 0) {
    json_decref(details);
    json_decref(text);
    return NULL;
  }
  return json_pack("{s:i, s:o, s:o}", "code", (int)error->code, "message", text, "data", details);
}

tp_code tp_build_error(const json_t *id, const tp_error *error, const json_t *data, char **ret_line,
                       size_t *ret_size) {
  json_t *message = begin(id);
  if (message == NULL) return TP_E_INTERNAL;
  int failed = 0;
  if (id == NULL) failed |= json_object_set_new(message, "id", json_null());
  failed |= json_object_set_new(message, "error", tp_error_json(error, data));
  if (failed != 0) {
    json_decref(message);
    return TP_E_INTERNAL;
  }
  return print_line(message, ret_line, ret_size);
}
