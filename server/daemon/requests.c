// SPDX-License-Identifier: Apache-2.0
/* requests.c: sending messages, and the requests that stay open. See connection.h. */
#include <event2/buffer.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/daemon/connection.h"
#include "server/daemon/job.h"
#include "server/daemon/methods.h"

static void free_line(const void *data, size_t size, void *extra) {
  (void)size, (void)extra;
  free((void *)(uintptr_t)data);
}

/* Takes `line`. A connection for which there is no memory is closed: a lost reply
 * would leave its client waiting for ever. */
static bool send_line(connection *c, char *line, size_t size) {
  if (line && !evbuffer_add_reference(bufferevent_get_output(c->bev), line, size, free_line, NULL))
    return true;
  free(line);
  connection_close(c);
  return false;
}

static bool closes(tp_code code) {
  return code == TP_E_PARSE || code == TP_E_LINE_TOO_LONG || code == TP_E_BAD_BODY ||
         code == TP_E_HELLO_REQUIRED || code == TP_E_UNAUTHORIZED;
}

void connection_error(connection *c, const json_t *id, const tp_error *error, json_t *data) {
  char *line = NULL;
  size_t size = 0;
  if (c->dead) {
    json_decref(data);
    return;
  }
  tp_build_error(id, error, data, &line, &size);
  json_decref(data);
  send_line(c, line, size);
  if (closes(error->code)) connection_linger(c);
}

void connection_refuse(connection *c, const json_t *id, tp_code code, const char *where,
                       const char *format, ...) {
  char text[TP_ERROR_TEXT];
  tp_error error;
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  tp_fail(&error, code, where, "%s", text);
  connection_error(c, id, &error, NULL);
}

void connection_reply(connection *c, const json_t *id, json_t *reply) {
  char *line = NULL;
  size_t size = 0;
  if (!reply) {
    connection_refuse(c, id, TP_E_INTERNAL, NULL, "no memory for the reply");
    return;
  }
  if (!c->dead) {
    tp_build_reply(id, reply, &line, &size);
    send_line(c, line, size);
  }
  json_decref(reply);
}

bool connection_notify(connection *c, const char *method, json_t *params, uint64_t body) {
  char *line = NULL;
  size_t size = 0;
  if (params) tp_build_notification(method, params, body, &line, &size);
  json_decref(params);
  return send_line(c, line, size);
}

request *request_open(connection *c, request_kind kind, const json_t *id) {
  request *r = calloc(1, sizeof *r);
  if (!r) {
    connection_refuse(c, id, TP_E_INTERNAL, NULL, "no memory for the request");
    return NULL;
  }
  r->connection = c;
  r->kind = kind;
  r->id = json_incref((json_t *)(uintptr_t)id);
  TAILQ_INSERT_TAIL(&c->requests, r, in_connection);
  c->n_requests++;
  c->server->n_requests++;
  return r;
}

void request_end(request *r) {
  connection *c = r->connection;
  if (c->upload == r) c->upload = NULL;
  if (r->fetching) TAILQ_REMOVE(&c->fetching, r, in_fetching);
  if (r->fetch) fetch_free(r->fetch);
  if (r->submission) submission_free(r->submission);
  if (r->job) TAILQ_REMOVE(&r->job->waiting, r, in_job);
  if (r->timer) event_free(r->timer);
  TAILQ_REMOVE(&c->requests, r, in_connection);
  c->n_requests--;
  c->server->n_requests--;
  json_decref(r->id);
  free(r);
  if (c->kick) event_active(c->kick, EV_TIMEOUT, 1);
}

request *request_find(const connection *c, const json_t *id) {
  request *r;
  TAILQ_FOREACH(r, &c->requests, in_connection) {
    if (json_equal(r->id, id)) return r;
  }
  return NULL;
}

void request_wait_for(request *r, job *j) {
  r->job = j;
  TAILQ_INSERT_TAIL(&j->waiting, r, in_job);
}
