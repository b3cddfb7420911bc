// SPDX-License-Identifier: Apache-2.0
/* method_job.c: job.status, job.list, job.wait, job.cancel, job.delete, request.cancel. */
#include <stdlib.h>
#include <string.h>

#include "server/daemon/jobs.h"
#include "server/daemon/methods.h"
#include "server/daemon/store.h"

static const char *const job_names[] = {"job", "key", NULL};

static json_t *state_json(const job *j) {
  return json_pack("{s:s, s:s}", "job", j->id, "state", job_state_name(j->state));
}

void method_job_status(connection *c, const tp_message *m, uint64_t body) {
  job *j;
  (void)body;
  if (!params_known(c, m, job_names) || !param_job(c, m, &j)) return;
  connection_reply(c, m->id, jobs_object(c->server, j, false));
}

static bool state_of(const char *name, job_state *ret_state) {
  for (int s = 0; s < JOB_STATES; s++) {
    if (strcmp(job_state_name((job_state)s), name)) continue;
    *ret_state = (job_state)s;
    return true;
  }
  return false;
}

/* The first job after the one of that id, which may be gone. */
static const job *first_after(const store *jobs, const char *id) {
  const job *known = store_find(jobs, id);
  if (known) return store_next(known);
  const char *dot = strrchr(id, '.');
  unsigned long long number = dot ? strtoull(dot + 1, NULL, 10) : 0;
  const job *j = store_first(jobs);
  while (j && j->number <= number) j = store_next(j);
  return j;
}

void method_job_list(connection *c, const tp_message *m, uint64_t body) {
  static const char *const names[] = {"state", "limit", "after", NULL};
  enum { BYTES_MAX = TP_MAX_LINE - 4096 };
  const char *state_name, *after;
  int64_t limit = LIST_MAX;
  job_state state = JOB_QUEUED;
  (void)body;
  if (!params_known(c, m, names) || !param_string(c, m, "state", 16, &state_name) ||
      !param_integer(c, m, "limit", 1, LIST_MAX, &limit) ||
      !param_string(c, m, "after", JOB_ID_SIZE - 1, &after))
    return;
  if (state_name && !state_of(state_name, &state)) {
    connection_refuse(c, m->id, TP_E_PARAMS, "state", "there is no state \"%s\"", state_name);
    return;
  }
  const store *all = c->server->store;
  json_t *jobs = json_array(), *reply = json_object();
  const char *last = NULL;
  size_t bytes = 0;
  for (const job *j = after ? first_after(all, after) : store_first(all); j; j = store_next(j)) {
    if ((state_name && j->state != state) || (!c->same_uid && strcmp(j->principal, c->principal)))
      continue;
    json_t *object = jobs_object(c->server, j, true);
    bytes += json_dumpb(object, NULL, 0, JSON_COMPACT) + 1;
    if ((int64_t)json_array_size(jobs) == limit || (last && bytes > BYTES_MAX)) {
      json_object_set_new(reply, "next", json_string(last));
      json_decref(object);
      break;
    }
    json_array_append_new(jobs, object);
    last = j->id;
  }
  json_object_set_new(reply, "jobs", jobs);
  connection_reply(c, m->id, reply);
}

/* ---- job.wait ---- */

void method_job_wait(connection *c, const tp_message *m, uint64_t body) {
  static const char *const names[] = {"job", "key", "progress_ms", NULL};
  int64_t progress_ms = -1;
  job *j;
  (void)body;
  if (!params_known(c, m, names) || !param_job(c, m, &j) ||
      !param_integer(c, m, "progress_ms", 0, TP_MAX_INTEGER, &progress_ms))
    return;
  if (job_ended(j)) {
    connection_reply(c, m->id, jobs_object(c->server, j, false));
    return;
  }
  request *r = request_open(c, REQUEST_WAIT, m->id);
  if (!r) return;
  if (progress_ms >= 0)
    r->every = (double)(progress_ms < PROGRESS_MIN_MS ? PROGRESS_MIN_MS : progress_ms) * 1e-3;
  request_wait_for(r, j);
  wait_job_changed(r, j);
}

/* A client that does not read gets no more news until it does. */
static void tell(request *r, const job *j, double now) {
  connection *c = r->connection;
  r->last = now;
  if (r->told == j->changes || connection_waiting(c) >= OUTPUT_MAX) return;
  json_t *params = j->progress ? json_copy(j->progress) : json_object();
  json_object_set(params, "of", r->id);
  json_object_set_new(params, "job", json_string(j->id));
  json_object_set_new(params, "state", json_string(job_state_name(j->state)));
  if (connection_notify(c, "job.progress", params, 0)) r->told = j->changes;
}

static void on_wait_timer(evutil_socket_t fd, short what, void *arg) {
  request *r = arg;
  (void)fd, (void)what;
  tell(r, r->job, clock_now());
}

void wait_job_changed(request *r, const job *j) {
  if (r->kind != REQUEST_WAIT || r->every <= 0.0) return;
  double now = clock_now(), left = r->last + r->every - now;
  if (r->last <= 0.0 || left <= 0.0) {
    tell(r, j, now);
    return;
  }
  if (!r->timer) r->timer = evtimer_new(r->connection->server->base, on_wait_timer, r);
  if (!r->timer || evtimer_pending(r->timer, NULL)) return; /* without it, the next news tell */
  struct timeval delay = {(time_t)left, (suseconds_t)((left - (double)(time_t)left) * 1e6)};
  evtimer_add(r->timer, &delay);
}

void request_job_ended(request *r, job *j) {
  connection *c = r->connection;
  if (r->kind == REQUEST_FETCH) {
    fetch_start(r, j);
    return;
  }
  connection_reply(c, r->id,
                   r->kind == REQUEST_CANCEL ? state_json(j) : jobs_object(c->server, j, false));
  request_end(r);
}

/* ---- job.cancel, job.delete, request.cancel ---- */

void method_job_cancel(connection *c, const tp_message *m, uint64_t body) {
  job *j;
  (void)body;
  if (!params_known(c, m, job_names) || !param_job(c, m, &j)) return;
  if (job_ended(j)) {
    connection_reply(c, m->id, state_json(j));
    return;
  }
  request *r = request_open(c, REQUEST_CANCEL, m->id);
  if (!r) return;
  request_wait_for(r, j);
  jobs_end(c->server, j, TP_E_JOB_CANCELLED);
}

void method_job_delete(connection *c, const tp_message *m, uint64_t body) {
  job *j;
  (void)body;
  if (!params_known(c, m, job_names) || !param_job(c, m, &j)) return;
  if (!job_ended(j)) {
    connection_refuse(c, m->id, TP_E_JOB_ACTIVE, "job", "%s is %s: cancel it first", j->id,
                      job_state_name(j->state));
    return;
  }
  connection_reply(c, m->id, json_pack("{s:s}", "job", j->id));
  jobs_delete(c->server, j);
}

void method_request_cancel(connection *c, const tp_message *m) {
  const json_t *id = json_object_get(m->params, "id");
  request *r = id ? request_find(c, id) : NULL;
  if (!r || (r->kind != REQUEST_WAIT && r->kind != REQUEST_FETCH)) return;
  connection_refuse(c, r->id, TP_E_REQUEST_CANCELLED, NULL, "cancelled by request.cancel");
  request_end(r);
}
