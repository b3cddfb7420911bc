// SPDX-License-Identifier: Apache-2.0
/* jobs.c: the life of jobs. set_state is the one place where a state changes. How a
 * job looks to clients is job_object.c. */
#include "server/daemon/jobs.h"

#include <assert.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"
#include "server/daemon/methods.h"
#include "server/daemon/pool.h"
#include "server/daemon/result.h"
#include "server/daemon/store.h"
#include "server/log.h"

bool job_ended(const job *j) { return j->state >= JOB_DONE; }

static void drop_input(job *j) {
  free(j->input);
  if (j->body) evbuffer_free(j->body);
  j->input = NULL;
  j->body = NULL;
}

void job_free(job *j) {
  drop_input(j);
  if (j->deadline_timer) event_free(j->deadline_timer);
  result_unref(j->result);
  json_decref(j->progress);
  json_decref(j->error);
  free(j->principal);
  free(j->key);
  free(j->arrays);
  free(j->report);
  free(j);
}

void jobs_release_upload(server *s, job *j) {
  s->upload_bytes -= j->reserved;
  j->reserved = 0;
}

/* Those that wait hear of it; the list is empty then. */
static void tell_ended(job *j) {
  request *r;
  while ((r = TAILQ_FIRST(&j->waiting))) {
    TAILQ_REMOVE(&j->waiting, r, in_job);
    r->job = NULL;
    request_job_ended(r, j);
  }
}

static void tell_changed(job *j) {
  request *r;
  j->changes++;
  TAILQ_FOREACH(r, &j->waiting, in_job) wait_job_changed(r, j);
}

static void log_state(const job *j) {
  const char *error = json_string_value(json_object_get(json_object_get(j->error, "data"), "name"));
  double since = j->started > 0.0 ? j->started : j->created;
  if (j->state == JOB_RUNNING)
    LOG(LOG_INFO, "job started", log_text("job", j->id), log_int("worker", j->worker->process.pid));
  else
    LOG(j->state == JOB_FAILED ? LOG_WARNING : LOG_INFO, "job ended", log_text("job", j->id),
        log_text("state", job_state_name(j->state)), log_text("error", error),
        log_real("seconds", j->finished - since));
}

/* What every change brings with it. The reasons (error, result) are already there. */
static void set_state(server *s, job *j, job_state state) {
  job_state from = j->state;
  assert((from == JOB_QUEUED && state != JOB_DONE && state != JOB_QUEUED) ||
         (from == JOB_RUNNING && state > JOB_RUNNING));
  TAILQ_REMOVE(&s->jobs[from], j, in_state);
  s->n_jobs[from]--;
  j->state = state;
  TAILQ_INSERT_TAIL(&s->jobs[state], j, in_state);
  s->n_jobs[state]++;
  s->quiet_since = clock_now();
  if (state == JOB_RUNNING) {
    j->started = clock_utc();
    j->attempts++;
    log_state(j);
    tell_changed(j);
    return;
  }
  j->finished = clock_utc();
  j->kept_since = clock_now();
  j->worker = NULL;
  s->totals.ended[state]++;
  drop_input(j);
  jobs_release_upload(s, j);
  json_decref(j->progress);
  j->progress = NULL;
  if (j->deadline_timer) event_free(j->deadline_timer);
  j->deadline_timer = NULL;
  if (state != JOB_DONE) {
    result_unref(j->result);
    j->result = NULL;
  }
  log_state(j);
  tell_ended(j);
}

/* ---- the beginning ---- */

static void on_deadline(evutil_socket_t fd, short what, void *arg) {
  job *j = arg;
  (void)fd, (void)what;
  jobs_end(j->server, j, TP_E_JOB_DEADLINE);
}

static void arm_deadline(server *s, job *j) {
  double left = j->deadline - clock_utc();
  if (j->deadline <= 0.0) return;
  if (left < 0.0) left = 0.0;
  if (left > 1e9) return; /* 30 years: none */
  struct timeval delay = {(time_t)left, (suseconds_t)((left - (double)(time_t)left) * 1e6)};
  j->deadline_timer = evtimer_new(s->base, on_deadline, j);
  if (j->deadline_timer) evtimer_add(j->deadline_timer, &delay);
}

/* Behind all jobs of its priority and above. */
static void enqueue(server *s, job *j) {
  job *before = TAILQ_LAST(&s->jobs[JOB_QUEUED], job_list);
  while (before && before->priority < j->priority) before = TAILQ_PREV(before, job_list, in_state);
  if (before) TAILQ_INSERT_AFTER(&s->jobs[JOB_QUEUED], before, j, in_state);
  else TAILQ_INSERT_HEAD(&s->jobs[JOB_QUEUED], j, in_state);
  s->n_jobs[JOB_QUEUED]++;
}

void jobs_accept(server *s, job *j) {
  j->server = s;
  j->number = ++s->next_job;
  snprintf(j->id, sizeof j->id, "%s.%" PRIu64, s->config->instance, j->number);
  store_insert(s->store, j);
  enqueue(s, j);
  s->totals.submitted++;
  s->quiet_since = clock_now();
  arm_deadline(s, j);
  LOG(LOG_INFO, "job accepted", log_text("job", j->id), log_text("principal", j->principal),
      log_text("stage", j->stage), log_int("bytes", (int64_t)j->reserved));
  pool_dispatch(s->pool);
}

void jobs_start(server *s, job *j, worker *w) {
  j->worker = w;
  drop_input(j);
  set_state(s, j, JOB_RUNNING);
}

void jobs_progress(server *s, job *j, const json_t *params) {
  static const char *const members[] = {"stage", "fraction", "vertices", "tetrahedra", "done"};
  json_t *progress = json_object();
  (void)s;
  for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
    json_t *value = json_object_get(params, members[i]);
    if (value && (i ? json_is_number(value) : json_is_string(value)))
      json_object_set(progress, members[i], value);
  }
  json_decref(j->progress);
  j->progress = progress;
  tell_changed(j);
}

/* ---- the end ---- */

static void on_spooled(void *user, int error) {
  job *j = user;
  if (!error) {
    set_state(j->server, j, JOB_DONE);
    return;
  }
  j->spool_errno = error;
  jobs_end(j->server, j, TP_E_SPOOL);
}

result *jobs_result(server *s, job *j) {
  if (!j->result) j->result = result_create(s->spool, on_spooled, j);
  return j->result;
}

bool jobs_complete(server *s, job *j, const json_t *arrays, const json_t *report) {
  tp_error error;
  j->worker = NULL;
  if (j->ending != TP_OK) {
    jobs_fail(s, j, NULL, report);
    return true;
  }
  if (!jobs_result(s, j) || result_complete(j->result, arrays, &error) != TP_OK) return false;
  j->arrays = json_dumps(arrays, JSON_COMPACT);
  j->report = report ? json_dumps(report, JSON_COMPACT) : NULL;
  spool_file_finish(j->result->file);
  return true;
}

static json_t *error_of(tp_code code, json_t *data, const char *text) {
  tp_error error;
  tp_fail(&error, code, NULL, "%s", text);
  json_t *object = tp_error_json(&error, data);
  json_decref(data);
  return object;
}

/* Why it was ended from here. */
static json_t *ending_error(const job *j) {
  char text[TP_ERROR_TEXT];
  switch (j->ending) {
  case TP_E_JOB_CANCELLED: return error_of(j->ending, NULL, "cancelled by job.cancel");
  case TP_E_JOB_DEADLINE: return error_of(j->ending, NULL, "the deadline has passed");
  default:
    snprintf(text, sizeof text, "the result cannot be kept: %s", strerror(j->spool_errno));
    return error_of(j->ending, NULL, text);
  }
}

void jobs_fail(server *s, job *j, json_t *error, const json_t *report) {
  if (j->ending != TP_OK) {
    json_decref(error);
    error = ending_error(j);
  }
  j->error = error;
  j->report = report ? json_dumps(report, JSON_COMPACT) : NULL;
  bool cancelled =
      json_integer_value(json_object_get(error, "code")) == (json_int_t)TP_E_JOB_CANCELLED;
  set_state(s, j, cancelled ? JOB_CANCELLED : JOB_FAILED);
}

void jobs_fail_with(server *s, job *j, tp_code code, json_t *data, const char *format, ...) {
  char text[TP_ERROR_TEXT];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  jobs_fail(s, j, error_of(code, data, text), NULL);
}

void jobs_end(server *s, job *j, tp_code reason) {
  if (job_ended(j) || j->ending != TP_OK) return;
  j->ending = reason;
  if (j->worker) worker_cancel(j->worker);
  else jobs_fail(s, j, NULL, NULL); /* queued, or only the spool is behind */
}

void jobs_delete(server *s, job *j) {
  TAILQ_REMOVE(&s->jobs[j->state], j, in_state);
  s->n_jobs[j->state]--;
  store_remove(s->store, j);
}

void jobs_touch(server *s, job *j) {
  j->kept_since = clock_now();
  TAILQ_REMOVE(&s->jobs[j->state], j, in_state);
  TAILQ_INSERT_TAIL(&s->jobs[j->state], j, in_state); /* in order of expiry */
}

void jobs_expire(server *s, double now) {
  double ttl = (double)s->config->limits.result_ttl_ms * 1e-3;
  for (int state = JOB_DONE; state <= JOB_CANCELLED; state++) {
    job *j;
    while ((j = TAILQ_FIRST(&s->jobs[state])) && now - j->kept_since > ttl) {
      LOG(LOG_INFO, "job expired", log_text("job", j->id));
      jobs_delete(s, j);
    }
  }
}
