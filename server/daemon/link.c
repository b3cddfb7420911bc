// SPDX-License-Identifier: Apache-2.0
/* link.c: the worker protocol (PROTOCOL.md, appendix), the daemon's side. */
#include <errno.h>
#include <event2/buffer.h>
#include <stdlib.h>
#include <string.h>

#include "server/daemon/jobs.h"
#include "server/daemon/pool.h"
#include "server/daemon/result.h"
#include "server/log.h"

void link_reset(worker *w) {
  tp_reader_free(w->reader);
  w->reader = NULL;
  free(w->chunk);
  w->chunk = NULL;
  json_decref(w->chunk_params);
  w->chunk_params = NULL;
}

/* A worker that breaks the protocol is not to be trusted with anything. */
static void broken(worker *w, const char *what) {
  job *j = w->job;
  LOG(LOG_ERROR, "worker broke the protocol", log_int("worker", w->process.pid),
      log_text("what", what), log_text("job", j ? j->id : NULL));
  w->job = NULL;
  worker_kill(w);
  if (j)
    jobs_fail_with(w->server, j, TP_E_WORKER_EXITED, NULL, "the worker broke its protocol: %s",
                   what);
}

/* ---- chunks ---- */

static bool small_integer(const json_t *params, const char *name, uint32_t *ret_value) {
  const json_t *value = json_object_get(params, name);
  json_int_t number = json_integer_value(value);
  if (!json_is_integer(value) || number < 0 || number > (json_int_t)UINT32_MAX) return false;
  *ret_value = (uint32_t)number;
  return true;
}

/* All bytes of the chunk are here: into the spool with them. */
static void chunk_complete(worker *w) {
  json_t *params = w->chunk_params;
  void *data = w->chunk;
  size_t size = w->chunk_size;
  job *j = w->job;
  const char *name = json_string_value(json_object_get(params, "array"));
  result_chunk chunk = {.bytes = (uint32_t)size};
  uint32_t number = 0;
  w->chunk = NULL;
  w->chunk_params = NULL;
  bool valid = name && small_integer(params, "chunk", &number) &&
               small_integer(params, "rows", &chunk.rows) &&
               small_integer(params, "crc32", &chunk.crc32);
  if (valid && j->ending == TP_OK) {
    result *to = jobs_result(w->server, j);
    int error = to ? 0 : ENOMEM;
    if (to && size) {
      error = spool_file_append(to->file, data, size, &chunk.offset);
      data = NULL;
    }
    if (!error) valid = result_add(to, name, number, &chunk);
    if (error) {
      j->spool_errno = error;
      jobs_end(w->server, j, TP_E_SPOOL);
    }
  }
  free(data);
  if (!valid) broken(w, "a chunk that is not the next one");
  json_decref(params);
}

static void chunk_begin(worker *w, json_t *params, uint64_t body) {
  if (body > CHUNK_MAX || w->chunk_params) {
    broken(w, "a chunk over its limit");
    return;
  }
  w->chunk = malloc(body ? body : 1);
  if (!w->chunk) {
    broken(w, "a chunk for which there is no memory");
    return;
  }
  w->chunk_params = json_incref(params);
  w->chunk_size = body;
  w->chunk_filled = 0;
  if (!body) chunk_complete(w);
}

static void chunk_bytes(worker *w, const tp_step *step) {
  memcpy(w->chunk + w->chunk_filled, step->data, step->size);
  w->chunk_filled += step->size;
  if (!step->body) chunk_complete(w);
}

/* ---- messages ---- */

static void take_ready(worker *w, const json_t *params) {
  if (w->state != WORKER_STARTING || json_integer_value(json_object_get(params, "protocol")) != 1) {
    broken(w, "an unexpected worker.ready");
    return;
  }
  LOG(LOG_INFO, "worker ready", log_int("worker", w->process.pid));
  w->state = WORKER_IDLE;
  server_ready(w->server);
  pool_dispatch(w->server->pool);
}

static void take_done(worker *w, const json_t *params) {
  job *j = w->job;
  if (!jobs_complete(w->server, j, json_object_get(params, "arrays"),
                     json_object_get(params, "report"))) {
    broken(w, "an array table that does not fit the chunks");
    return;
  }
  worker_finished(w);
}

static void take_failed(worker *w, const json_t *params) {
  job *j = w->job;
  json_t *error = json_object_get(params, "error");
  json_int_t code = json_integer_value(json_object_get(error, "code"));
  if (code <= TP_JOB_CODE_BASE || code > TP_E_UPLOAD || !tp_code_name(code) ||
      !json_is_string(json_object_get(error, "message"))) {
    broken(w, "a job.failed without an error");
    return;
  }
  jobs_fail(w->server, j, json_incref(error), json_object_get(params, "report"));
  worker_finished(w);
}

static void take_message(worker *w, const tp_step *step) {
  tp_message m;
  if (tp_message_parse(step->json, &m, NULL) != TP_OK || m.kind != TP_NOTIFICATION) {
    broken(w, "no notification");
    return;
  }
  bool chunk = !strcmp(m.method, "job.chunk");
  if (!chunk && step->body) {
    broken(w, "a body where none belongs");
    return;
  }
  if (!strcmp(m.method, "worker.ready")) {
    take_ready(w, m.params);
    return;
  }
  const char *id = json_string_value(json_object_get(m.params, "job"));
  if (!w->job || !id || strcmp(id, w->job->id)) {
    broken(w, "a message about a job that it does not have");
    return;
  }
  if (chunk) chunk_begin(w, m.params, step->body);
  else if (!strcmp(m.method, "job.progress")) jobs_progress(w->server, w->job, m.params);
  else if (!strcmp(m.method, "job.done")) take_done(w, m.params);
  else if (!strcmp(m.method, "job.failed")) take_failed(w, m.params);
  else broken(w, "an unknown message");
}

void link_read(struct bufferevent *bev, void *arg) {
  worker *w = arg;
  struct evbuffer *input = bufferevent_get_input(bev);
  while (w->state != WORKER_ENDING) {
    struct evbuffer_iovec piece;
    tp_step step;
    if (spool_crowded(w->server->spool)) {
      bufferevent_disable(bev, EV_READ);
      return;
    }
    if (evbuffer_peek(input, -1, NULL, &piece, 1) < 1 || !piece.iov_len) return;
    switch (tp_reader_next(w->reader, piece.iov_base, piece.iov_len, &step)) {
    case TP_STEP_MESSAGE:
      take_message(w, &step);
      json_decref(step.json);
      break;
    case TP_STEP_BODY: chunk_bytes(w, &step); break;
    case TP_STEP_ERROR: broken(w, step.error.message); break;
    case TP_STEP_MORE: break;
    }
    evbuffer_drain(input, step.used);
  }
}

/* ---- to the worker ---- */

bool link_send(worker *w, const char *method, const json_t *params, struct evbuffer *body) {
  struct evbuffer *output = bufferevent_get_output(w->bev);
  char *line = NULL;
  size_t size = 0;
  if (tp_build_notification(method, params, body ? evbuffer_get_length(body) : 0, &line, &size))
    return false;
  bool ok = !evbuffer_add(output, line, size) && (!body || !evbuffer_add_buffer(output, body));
  free(line);
  return ok;
}

bool link_run(worker *w, job *j) {
  const config_limits *limits = &w->server->config->limits;
  json_t *params = json_loads(j->input, 0, NULL);
  if (!params) return false;
  json_object_set_new(params, "job", json_string(j->id));
  json_object_set_new(params, "codec", json_string(j->codec));
  json_object_set_new(params, "max_decoded_bytes",
                      json_integer((json_int_t)limits->max_decoded_bytes));
  if (j->deadline > 0.0) {
    double left = (j->deadline - clock_utc()) * 1000.0;
    json_object_set_new(params, "deadline_ms", json_integer(left > 1.0 ? (json_int_t)left : 1));
  }
  bool ok = link_send(w, "job.run", params, j->body);
  json_decref(params);
  return ok;
}
