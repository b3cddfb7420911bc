// SPDX-License-Identifier: Apache-2.0
/* server.c: the daemon's start, the signals that it takes, draining, its end. */
#include "server/daemon/server.h"

#include <errno.h>
#include <event2/event.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "server/daemon/connection.h"
#include "server/daemon/jobs.h"
#include "server/daemon/limits.h"
#include "server/daemon/listener.h"
#include "server/daemon/pool.h"
#include "server/daemon/store.h"
#include "server/log.h"

static double clock_seconds(clockid_t id) {
  struct timespec t;
  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double clock_now(void) { return clock_seconds(CLOCK_MONOTONIC); }
double clock_utc(void) { return clock_seconds(CLOCK_REALTIME); }

void server_stop(server *s, int status) {
  s->exit_status = status;
  event_base_loopbreak(s->base);
}

void server_ready(server *s) {
  if (s->serving) return;
  s->serving = true;
  if (!listeners_open(s)) server_stop(s, EXIT_FAILURE);
}

/* ---- signals and the passing of time ---- */

/* The first one drains: no new jobs, accepted ones end. The second one ends at once. */
static void on_signal(evutil_socket_t number, short what, void *arg) {
  server *s = arg;
  (void)what;
  if (s->draining) {
    LOG(LOG_WARNING, "ending at once", log_int("signal", number));
    server_stop(s, EXIT_FAILURE);
    return;
  }
  LOG(LOG_INFO, "draining", log_int("signal", number), log_int("queued", s->n_jobs[JOB_QUEUED]),
      log_int("running", s->n_jobs[JOB_RUNNING]));
  s->draining = true;
  s->quiet_since = clock_now();
  listeners_close(s);
  if (!s->n_connections && !s->n_jobs[JOB_QUEUED] && !s->n_jobs[JOB_RUNNING]) server_stop(s, 0);
}

/* Jobs have ended, and clients that are there have had a moment to ask for results. */
static bool drained(server *s, double now) {
  bool busy = s->n_jobs[JOB_QUEUED] || s->n_jobs[JOB_RUNNING] || s->n_requests;
  const connection *c;
  TAILQ_FOREACH(c, &s->connections, link) busy = busy || connection_waiting(c);
  if (busy) s->quiet_since = now;
  return !busy && (!s->n_connections || now - s->quiet_since > DRAIN_QUIET_MS * 1e-3);
}

static void on_janitor(evutil_socket_t fd, short what, void *arg) {
  server *s = arg;
  double now = clock_now();
  connection *c;
  (void)fd, (void)what;
  jobs_expire(s, now);
  listeners_update(s);
  TAILQ_FOREACH(c, &s->connections, link) connection_check_stall(c, now);
  if (s->draining && drained(s, now)) server_stop(s, 0);
}

/* ---- start and end ---- */

typedef struct events {
  struct event *terminate, *interrupt, *janitor;
} events;

static bool start_events(server *s, events *e) {
  struct timeval period = {JANITOR_MS / 1000, (JANITOR_MS % 1000) * 1000};
  e->terminate = evsignal_new(s->base, SIGTERM, on_signal, s);
  e->interrupt = evsignal_new(s->base, SIGINT, on_signal, s);
  e->janitor = event_new(s->base, -1, EV_PERSIST, on_janitor, s);
  return e->terminate && e->interrupt && e->janitor && !event_add(e->terminate, NULL) &&
         !event_add(e->interrupt, NULL) && !event_add(e->janitor, &period);
}

static void stop_events(events *e) {
  if (e->terminate) event_free(e->terminate);
  if (e->interrupt) event_free(e->interrupt);
  if (e->janitor) event_free(e->janitor);
}

/* Clients must not take the descriptors that jobs need. */
static uint64_t connections_allowed(const config *cfg) {
  struct rlimit limit;
  uint64_t kept = FDS_RESERVED + (uint64_t)FDS_WORKER * cfg->workers;
  if (getrlimit(RLIMIT_NOFILE, &limit)) return cfg->limits.max_connections;
  uint64_t most = limit.rlim_cur > kept ? (limit.rlim_cur - kept) / FDS_CONNECTION : 0;
  if (!most) most = 1;
  return most < cfg->limits.max_connections ? most : cfg->limits.max_connections;
}

/* Everything that the loop needs; false is logged. */
static bool start(server *s, events *e) {
  for (int i = 0; i < JOB_STATES; i++) TAILQ_INIT(&s->jobs[i]);
  TAILQ_INIT(&s->connections);
  TAILQ_INIT(&s->listeners);
  s->started = clock_now();
  s->max_connections = connections_allowed(s->config);
  s->worker_program = spawn_find("tetrad-worker", TETRAD_LIBEXECDIR);
  if (!s->worker_program) {
    LOG(LOG_ERROR, "tetrad-worker not found", log_text("libexecdir", TETRAD_LIBEXECDIR));
    return false;
  }
  s->base = event_base_new();
  s->store = store_create(job_free);
  if (s->base && s->store)
    s->spool = spool_create(s->base, s->config->spool, s->config->limits.result_bytes);
  if (!s->spool) {
    LOG(LOG_ERROR, "no spool", log_text("folder", s->config->spool),
        log_text("error", strerror(errno)));
    return false;
  }
  if (!start_events(s, e) || !pool_create(s)) {
    LOG(LOG_ERROR, "not started", log_text("error", "no memory"));
    return false;
  }
  spool_on_room(s->spool, pool_room, s->pool);
  LOG(LOG_INFO, "tetrad starts", log_text("version", TETRAD_VERSION),
      log_text("instance", s->config->instance), log_int("workers", s->config->workers),
      log_int("pid", getpid()));
  return true;
}

static void end(server *s, events *e) {
  if (s->base) {
    listeners_close(s);
    while (!TAILQ_EMPTY(&s->connections)) connection_free(TAILQ_FIRST(&s->connections));
  }
  pool_free(s->pool);
  store_free(s->store);
  spool_free(s->spool);
  stop_events(e);
  if (s->base) event_base_free(s->base);
  free(s->worker_program);
}

int server_run(const config *cfg) {
  server s = {.config = cfg};
  events e = {NULL, NULL, NULL};
  bool ok = start(&s, &e);
  if (ok) event_base_dispatch(s.base);
  end(&s, &e);
  if (ok) LOG(LOG_INFO, "tetrad ends", log_int("status", s.exit_status));
  return ok ? s.exit_status : EXIT_FAILURE;
}
