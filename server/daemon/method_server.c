// SPDX-License-Identifier: Apache-2.0
/* method_server.c: server.hello and server.stats. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/daemon/jobs.h"
#include "server/daemon/methods.h"
#include "server/daemon/pool.h"
#include "server/log.h"

enum { PROTOCOL = 1, TOKEN_MAX = 1024 };

/* Compares in a time that does not tell how much of it was right. */
static bool same_secret(const char *given, const char *secret) {
  size_t n = strlen(given), m = strlen(secret);
  unsigned difference = n != m;
  for (size_t i = 0; i < n; i++)
    difference |= (unsigned)(given[i] ^ secret[m ? i % m : 0]);
  return !difference;
}

static const config_token *find_token(const config *cfg, const char *given) {
  const config_token *found = NULL;
  for (size_t i = 0; given && i < cfg->n_tokens; i++)
    if (same_secret(given, cfg->tokens[i].secret)) found = &cfg->tokens[i];
  return found;
}

/* Settles who the client is. A Unix peer is its uid, with or without a token. */
static bool authorize(connection *c, const tp_message *m, const char *token) {
  const config *cfg = c->server->config;
  if (c->peer != PEER_TCP || !cfg->n_tokens) return true;
  const config_token *found = find_token(cfg, token);
  char name[256];
  char *principal = NULL;
  if (found) {
    snprintf(name, sizeof name, "token:%s", found->name);
    principal = strdup(name);
  }
  if (!principal) {
    connection_refuse(c, m->id, TP_E_UNAUTHORIZED, "token",
                      token ? "the token is not known" : "a token is needed here");
    return false;
  }
  free(c->principal);
  c->principal = principal;
  return true;
}

static json_t *limits_json(const config_limits *limits) {
  return json_pack("{s:i, s:I, s:i, s:I, s:I, s:i, s:I, s:I}", "max_line", TP_MAX_LINE, "max_body",
                   (json_int_t)limits->max_body, "max_depth", TP_MAX_DEPTH, "max_requests",
                   (json_int_t)limits->max_requests, "max_decoded_bytes",
                   (json_int_t)limits->max_decoded_bytes, "max_waiting_bytes", OUTPUT_MAX,
                   "stall_ms", (json_int_t)limits->stall_ms, "result_ttl_ms",
                   (json_int_t)limits->result_ttl_ms);
}

void method_hello(connection *c, const tp_message *m, uint64_t body) {
  static const char *const names[] = {"protocol", "token", "client", NULL};
  const config *cfg = c->server->config;
  const char *token, *client;
  int64_t protocol = -1;
  (void)body;
  if (c->hello_done) {
    connection_refuse(c, m->id, TP_E_REQUEST, NULL, "server.hello comes once");
    return;
  }
  if (!params_known(c, m, names) ||
      !param_integer(c, m, "protocol", 0, TP_MAX_INTEGER, &protocol) ||
      !param_string(c, m, "token", TOKEN_MAX, &token) ||
      !param_string(c, m, "client", CLIENT_NAME_MAX, &client))
    return;
  if (protocol < 0) {
    connection_refuse(c, m->id, TP_E_PARAMS, "protocol", "protocol is missing");
    return;
  }
  if (protocol != PROTOCOL) {
    tp_error error;
    tp_fail(&error, TP_E_VERSION, "protocol", "this server speaks protocol %d", PROTOCOL);
    connection_error(c, m->id, &error, json_pack("{s:[i]}", "protocols", PROTOCOL));
    return;
  }
  if (!authorize(c, m, token)) return;
  c->hello_done = true;
  tp_reader_set_max_line(c->reader, TP_MAX_LINE);
  LOG(LOG_INFO, "hello", log_int("connection", (int64_t)c->number),
      log_text("principal", c->principal), log_text("client", client));
  connection_reply(c, m->id,
                   json_pack("{s:i, s:s, s:s, s:s, s:s, s:[s,s,s], s:o}", "protocol", PROTOCOL,
                             "server", "tetrad", "version", TETRAD_VERSION, "instance",
                             cfg->instance, "principal", c->principal, "codecs", "raw", "zlib",
                             "mesh", "limits", limits_json(&cfg->limits)));
}

/* Resident bytes of this process. */
static json_int_t resident_bytes(void) {
  long pages = 0;
  FILE *file = fopen("/proc/self/statm", "re");
  if (file && fscanf(file, "%*d %ld", &pages) != 1) pages = 0;
  if (file) fclose(file);
  return (json_int_t)pages * (json_int_t)sysconf(_SC_PAGESIZE);
}

static int open_descriptors(void) {
  int n = 0;
  DIR *folder = opendir("/proc/self/fd");
  const struct dirent *entry;
  while (folder && (entry = readdir(folder))) n += entry->d_name[0] != '.';
  if (folder) closedir(folder);
  return n - (folder != NULL); /* the one that reads */
}

static json_t *states_json(const uint64_t *counts, size_t first) {
  json_t *object = json_object();
  for (size_t s = first; s < JOB_STATES; s++)
    json_object_set_new(object, job_state_name((job_state)s), json_integer((json_int_t)counts[s]));
  return object;
}

void method_stats(connection *c, const tp_message *m, uint64_t body) {
  static const char *const names[] = {NULL};
  const server *s = c->server;
  unsigned workers[5];
  uint64_t restarts, present[JOB_STATES];
  (void)body;
  if (!params_known(c, m, names)) return;
  pool_count(s->pool, workers, &restarts);
  for (size_t i = 0; i < JOB_STATES; i++) present[i] = s->n_jobs[i];
  json_t *since_start = states_json(s->totals.ended, JOB_DONE);
  json_object_set_new(since_start, "submitted", json_integer((json_int_t)s->totals.submitted));
  json_t *bytes = json_pack(
      "{s:I, s:I, s:I, s:I, s:I, s:I}", "uploads", (json_int_t)s->upload_bytes, "uploads_limit",
      (json_int_t)s->config->limits.upload_bytes, "results", (json_int_t)spool_bytes(s->spool),
      "results_limit", (json_int_t)s->config->limits.result_bytes, "received",
      (json_int_t)s->totals.received, "sent", (json_int_t)s->totals.sent);
  connection_reply(
      c, m->id,
      json_pack(
          "{s:s, s:s, s:I, s:b, s:{s:i, s:i, s:i, s:i, s:I}, s:o, s:o, s:i, s:i, s:o, s:I, s:i}",
          "instance", s->config->instance, "version", TETRAD_VERSION, "uptime_ms",
          (json_int_t)((clock_now() - s->started) * 1000.0), "draining", (int)s->draining,
          "workers", "wanted", (int)s->config->workers, "starting", (int)workers[WORKER_STARTING],
          "idle", (int)workers[WORKER_IDLE], "busy", (int)workers[WORKER_BUSY], "restarts",
          (json_int_t)restarts, "jobs", states_json(present, 0), "totals", since_start,
          "connections", (int)s->n_connections, "requests", (int)s->n_requests, "bytes", bytes,
          "memory_bytes", resident_bytes(), "descriptors", open_descriptors()));
}
