// SPDX-License-Identifier: Apache-2.0
/* methods.c: the order of checks (PROTOCOL.md, section 3, from 3 on), the list of
 * methods, and their parameters. */
#include "server/daemon/methods.h"

#include <string.h>

#include "server/daemon/store.h"

typedef struct method_row {
  const char *name;
  method_fn fn;
} method_row;

static const method_row method_rows[] = {
    {"server.hello", method_hello},     {"server.stats", method_stats},
    {"mesh.submit", method_submit},     {"job.status", method_job_status},
    {"job.list", method_job_list},      {"job.wait", method_job_wait},
    {"job.cancel", method_job_cancel},  {"job.delete", method_job_delete},
    {"mesh.fetch", method_fetch},
};

static const method_row *find_method(const char *name) {
  for (size_t i = 0; i < sizeof method_rows / sizeof *method_rows; i++)
    if (!strcmp(method_rows[i].name, name)) return &method_rows[i];
  return NULL;
}

void methods_handle(connection *c, const tp_message *m, uint64_t body, unsigned depth) {
  bool hello = m->kind == TP_REQUEST && !strcmp(m->method, "server.hello");
  if (c->hello_required && !c->hello_done && (!hello || body)) {
    connection_refuse(c, m->id, TP_E_HELLO_REQUIRED, NULL,
                      "the first request is server.hello, without a body");
    return;
  }
  if (m->kind == TP_NOTIFICATION) {
    if (!strcmp(m->method, "request.cancel")) method_request_cancel(c, m);
    return;
  }
  if (m->kind != TP_REQUEST) {
    connection_refuse(c, NULL, TP_E_REQUEST, NULL, "a client sends requests, not replies");
    return;
  }
  if (depth > TP_MAX_DEPTH) {
    connection_refuse(c, m->id, TP_E_REQUEST, NULL, "nested deeper than %d", TP_MAX_DEPTH);
    return;
  }
  if (request_find(c, m->id)) {
    connection_refuse(c, m->id, TP_E_REQUEST, "id", "a request with this id is still open");
    return;
  }
  const method_row *row = find_method(m->method);
  if (!strcmp(m->method, "request.cancel")) {
    connection_refuse(c, m->id, TP_E_REQUEST, "id",
                      "request.cancel is a notification: it has no id");
    return;
  }
  if (!row) {
    connection_refuse(c, m->id, TP_E_METHOD, NULL, "there is no method \"%.100s\"", m->method);
    return;
  }
  if (body > c->server->config->limits.max_body) {
    connection_refuse(c, m->id, TP_E_BODY_TOO_LARGE, "body", "%llu bytes are over max_body, %llu",
                      (unsigned long long)body,
                      (unsigned long long)c->server->config->limits.max_body);
    return;
  }
  if (body && row->fn != method_submit) {
    connection_refuse(c, m->id, TP_E_PARAMS, "body", "%s takes no body", m->method);
    return;
  }
  row->fn(c, m, body);
}

bool params_known(connection *c, const tp_message *m, const char *const *names) {
  tp_error error;
  if (tp_params_known(m->params, names, &error) == TP_OK) return true;
  connection_error(c, m->id, &error, NULL);
  return false;
}

bool param_integer(connection *c, const tp_message *m, const char *name, int64_t least,
                   int64_t most, int64_t *ret_value) {
  const json_t *value = json_object_get(m->params, name);
  if (!value) return true;
  json_int_t number = json_integer_value(value);
  if (!json_is_integer(value) || number < least || number > most) {
    connection_refuse(c, m->id, TP_E_PARAMS, name, "%s is no integer from %lld to %lld", name,
                      (long long)least, (long long)most);
    return false;
  }
  *ret_value = number;
  return true;
}

bool param_string(connection *c, const tp_message *m, const char *name, size_t most,
                  const char **ret_value) {
  const json_t *value = json_object_get(m->params, name);
  *ret_value = NULL;
  if (!value) return true;
  size_t size = json_string_length(value);
  if (!json_is_string(value) || size < 1 || size > most) {
    connection_refuse(c, m->id, TP_E_PARAMS, name, "%s is no string of 1 to %zu bytes", name, most);
    return false;
  }
  *ret_value = json_string_value(value);
  return true;
}

/* Whether an id is of another instance; the instance's name is before the last '.'. */
static bool elsewhere(connection *c, const tp_message *m, const char *id) {
  const char *ours = c->server->config->instance, *dot = strrchr(id, '.');
  size_t size = dot ? (size_t)(dot - id) : 0;
  if (!dot || !size || (size == strlen(ours) && !strncmp(id, ours, size))) return false;
  tp_error error;
  tp_fail(&error, TP_E_ELSEWHERE, "job", "\"%s\" is a job of another server", id);
  connection_error(c, m->id, &error, json_pack("{s:s%}", "instance", id, size));
  return true;
}

bool param_job(connection *c, const tp_message *m, job **ret_job) {
  const char *id, *key;
  if (!param_string(c, m, "job", JOB_ID_SIZE - 1, &id) || !param_string(c, m, "key", KEY_MAX, &key))
    return false;
  if (!id == !key) {
    connection_refuse(c, m->id, TP_E_PARAMS, "job", "exactly one of job and key names the job");
    return false;
  }
  job *found = id ? store_find(c->server->store, id)
                  : store_find_key(c->server->store, c->principal, key);
  if (found && !c->same_uid && strcmp(found->principal, c->principal)) found = NULL;
  if (found) {
    *ret_job = found;
    return true;
  }
  if (!id || !elsewhere(c, m, id))
    connection_refuse(c, m->id, TP_E_JOB_UNKNOWN, id ? "job" : "key",
                      "there is no job \"%s\" of yours", id ? id : key);
  return false;
}
