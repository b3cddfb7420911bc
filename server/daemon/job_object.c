// SPDX-License-Identifier: Apache-2.0
/* job_object.c: PROTOCOL.md's job object. */
#include "server/daemon/jobs.h"

#include "server/daemon/result.h"

const char *job_state_name(job_state state) {
  static const char *const names[JOB_STATES] = {"queued", "running", "done", "failed", "cancelled"};
  return names[state];
}

/* Jobs that start before it. */
static json_int_t position(const server *s, const job *j) {
  json_int_t n = 0;
  const job *before;
  TAILQ_FOREACH(before, &s->jobs[JOB_QUEUED], in_state) {
    if (before == j) break;
    n++;
  }
  return n;
}

static void set_text(json_t *object, const char *name, const char *text) {
  if (text) json_object_set_new(object, name, json_string(text));
}

static void set_time(json_t *object, const char *name, double seconds) {
  if (seconds > 0.0) json_object_set_new(object, name, json_real(seconds));
}

static void set_integer(json_t *object, const char *name, json_int_t value) {
  json_object_set_new(object, name, json_integer(value));
}

/* JSON that is kept as text. */
static void set_parsed(json_t *object, const char *name, const char *text) {
  if (text) json_object_set_new(object, name, json_loads(text, 0, NULL));
}

json_t *jobs_object(server *s, const job *j, bool brief) {
  json_t *object = json_object();
  set_text(object, "job", j->id);
  set_text(object, "key", j->key);
  set_text(object, "state", job_state_name(j->state));
  set_text(object, "stage", j->stage);
  set_text(object, "codec", j->codec);
  set_integer(object, "priority", j->priority);
  set_time(object, "created", j->created);
  set_time(object, "started", j->started);
  set_time(object, "finished", j->finished);
  set_time(object, "deadline", j->deadline);
  set_integer(object, "attempts", j->attempts);
  if (j->state == JOB_QUEUED) set_integer(object, "position", position(s, j));
  if (j->state == JOB_RUNNING && j->progress) json_object_set(object, "progress", j->progress);
  if (j->state == JOB_DONE) {
    set_integer(object, "bytes", (json_int_t)spool_file_bytes(j->result->file));
    if (!brief) set_parsed(object, "arrays", j->arrays);
  }
  if (!brief && job_ended(j)) set_parsed(object, "report", j->report);
  if (j->error) json_object_set(object, "error", j->error);
  if (job_ended(j)) {
    double left =
        (double)s->config->limits.result_ttl_ms - (clock_now() - j->kept_since) * 1000.0;
    set_integer(object, "expires_ms", left > 0.0 ? (json_int_t)left : 0);
  }
  return object;
}
