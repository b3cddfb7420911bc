// SPDX-License-Identifier: Apache-2.0
/* method_submit.c: mesh.submit: what can be seen without opening the body is checked
 * before it comes; the body goes into the job unopened. */
#include <event2/buffer.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/message.h"
#include "protocol/options.h"
#include "server/daemon/jobs.h"
#include "server/daemon/methods.h"
#include "server/daemon/store.h"

struct submission {
  server *server;
  job *job; /* not accepted yet */
  bool lost; /* a piece found no memory */
};

void submission_free(submission *s) {
  if (s->job) {
    jobs_release_upload(s->server, s->job);
    job_free(s->job);
  }
  free(s);
}

static void refuse_busy(connection *c, const json_t *id, const char *why) {
  tp_error error;
  tp_fail(&error, TP_E_BUSY, NULL, "%s", why);
  connection_error(c, id, &error, json_pack("{s:i}", "retry_ms", BUSY_RETRY_MS));
}

/* Whether there is room for a job with that body; answered if not. */
static bool room_for(connection *c, const json_t *id, uint64_t body) {
  const server *s = c->server;
  const config_limits *limits = &s->config->limits;
  if (s->draining) {
    connection_refuse(c, id, TP_E_DRAINING, NULL, "the server is going away");
    return false;
  }
  if (s->upload_bytes && s->upload_bytes + body > limits->upload_bytes)
    refuse_busy(c, id, "no room for another upload now");
  else if (store_count(s->store) >= limits->max_jobs)
    refuse_busy(c, id, "no room for another job now");
  else if (spool_full(s->spool))
    refuse_busy(c, id, "no room for results now");
  else
    return true;
  return false;
}

/* FNV-1a over the canonical text of the params. */
static bool digest_params(const json_t *params, uint64_t *ret_hash) {
  char *text = json_dumps(params, JSON_COMPACT | JSON_SORT_KEYS);
  if (!text) return false;
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (const char *at = text; *at; at++)
    hash = (hash ^ (unsigned char)*at) * UINT64_C(0x100000001b3);
  free(text);
  *ret_hash = hash;
  return true;
}

/* The worker's part of the params, as text: it is opened when a worker takes it. */
static char *input_text(const server *s, const json_t *params, const tp_options *options) {
  uint64_t budget = s->config->limits.memory_bytes;
  if (options->memory_bytes && options->memory_bytes < budget) budget = options->memory_bytes;
  const json_t *given = json_object_get(params, "options");
  json_t *copy = given ? json_copy((json_t *)(uintptr_t)given) : json_object();
  if (options->threads > s->config->limits.threads)
    json_object_set_new(copy, "threads", json_integer((json_int_t)s->config->limits.threads));
  json_object_set_new(copy, "memory_bytes", json_integer((json_int_t)budget));
  json_t *input = json_pack("{s:O, s:o}", "pls", json_object_get(params, "pls"), "options", copy);
  char *text = input ? json_dumps(input, JSON_COMPACT) : NULL;
  json_decref(input);
  return text;
}

typedef struct submit_params {
  tp_options options;
  const char *codec, *key;
  int64_t priority, deadline_ms;
} submit_params;

static bool read_params(connection *c, const tp_message *m, uint64_t body, submit_params *p) {
  static const char *const names[] = {"pls",      "options",     "codec", "priority",
                                      "deadline_ms", "key", NULL};
  const json_t *pls = json_object_get(m->params, "pls");
  tp_codec codec;
  tp_error error;
  *p = (submit_params){.deadline_ms = 0};
  if (!params_known(c, m, names)) return false;
  if (!json_is_object(pls)) {
    connection_refuse(c, m->id, TP_E_PARAMS, "pls", "pls is missing, or no object");
    return false;
  }
  if (tp_options_parse(json_object_get(m->params, "options"), &p->options, &error) != TP_OK) {
    connection_error(c, m->id, &error, NULL);
    return false;
  }
  if (!param_string(c, m, "codec", 16, &p->codec) || !param_string(c, m, "key", KEY_MAX, &p->key) ||
      !param_integer(c, m, "priority", -PRIORITY_MAX, PRIORITY_MAX, &p->priority) ||
      !param_integer(c, m, "deadline_ms", 1, TP_MAX_INTEGER, &p->deadline_ms))
    return false;
  if (!p->codec) p->codec = tp_codec_name(TP_MESH);
  if (!tp_codec_of(p->codec, &codec)) {
    connection_refuse(c, m->id, TP_E_PARAMS, "codec", "there is no codec \"%s\"", p->codec);
    return false;
  }
  if (tp_upload_check(pls, tp_schema_pls(), body, c->server->config->limits.max_decoded_bytes,
                      &error) != TP_OK) {
    connection_error(c, m->id, &error, NULL);
    return false;
  }
  return true;
}

/* NULL: no memory. */
static job *make_job(const connection *c, const tp_message *m, const submit_params *p) {
  job *j = calloc(1, sizeof *j);
  if (!j) return NULL;
  TAILQ_INIT(&j->waiting);
  j->priority = (int)p->priority;
  j->created = clock_utc();
  if (p->deadline_ms) j->deadline = j->created + (double)p->deadline_ms * 1e-3;
  strncpy(j->stage, tp_stage_name(p->options.stage), sizeof j->stage - 1);
  strncpy(j->codec, p->codec, sizeof j->codec - 1);
  j->principal = strdup(c->principal);
  j->body = evbuffer_new();
  j->input = input_text(c->server, m->params, &p->options);
  bool ok = j->principal && j->body && j->input;
  if (p->key) ok = ok && (j->key = strdup(p->key)) && digest_params(m->params, &j->digest.params);
  if (ok) return j;
  job_free(j);
  return NULL;
}

void method_submit(connection *c, const tp_message *m, uint64_t body) {
  submit_params params;
  if (!room_for(c, m->id, body) || !read_params(c, m, body, &params)) return;
  request *r = request_open(c, REQUEST_SUBMIT, m->id);
  if (!r) return;
  job *j = make_job(c, m, &params);
  r->submission = j ? calloc(1, sizeof *r->submission) : NULL;
  if (!r->submission) {
    if (j) job_free(j);
    connection_refuse(c, m->id, TP_E_INTERNAL, NULL, "no memory for the job");
    request_end(r);
    return;
  }
  j->reserved = body + strlen(j->input);
  c->server->upload_bytes += j->reserved;
  r->submission->server = c->server;
  r->submission->job = j;
  c->upload = r;
}

void submit_body(request *r, const void *data, size_t size) {
  submission *s = r->submission;
  if (s->lost) return;
  s->job->digest.body_bytes += size;
  if (s->job->key) s->job->digest.body_crc = tp_crc32(s->job->digest.body_crc, data, size);
  if (evbuffer_add(s->job->body, data, size)) s->lost = true;
}

static bool same_digest(const digest *a, const digest *b) {
  return a->params == b->params && a->body_bytes == b->body_bytes && a->body_crc == b->body_crc;
}

/* A job of that key exists: the same request names it, another is refused. */
static void repeat(request *r, const job *existing) {
  connection *c = r->connection;
  if (same_digest(&existing->digest, &r->submission->job->digest)) {
    connection_reply(c, r->id,
                     json_pack("{s:s, s:s, s:b}", "job", existing->id, "state",
                               job_state_name(existing->state), "created", 0));
    return;
  }
  tp_error error;
  tp_fail(&error, TP_E_KEY_CONFLICT, "key", "the key \"%s\" names another request", existing->key);
  connection_error(c, r->id, &error, json_pack("{s:s}", "job", existing->id));
}

void submit_complete(request *r) {
  connection *c = r->connection;
  submission *s = r->submission;
  job *j = s->job;
  const job *existing = j->key ? store_find_key(c->server->store, j->principal, j->key) : NULL;
  if (s->lost) {
    connection_refuse(c, r->id, TP_E_INTERNAL, NULL, "no memory for the body");
  } else if (existing) {
    repeat(r, existing);
  } else {
    s->job = NULL;
    jobs_accept(c->server, j);
    connection_reply(c, r->id, json_pack("{s:s, s:s, s:b}", "job", j->id, "state",
                                         job_state_name(j->state), "created", 1));
  }
  request_end(r);
}
