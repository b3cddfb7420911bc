// SPDX-License-Identifier: Apache-2.0
/* pool.c: worker processes: their start, their end, and what their end means for a
 * job. What they say is link.c. */
#include "server/daemon/pool.h"

#include <errno.h>
#include <event2/buffer.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/daemon/jobs.h"
#include "server/log.h"

struct pool {
  server *server;
  worker *workers;
  unsigned count;
  uint64_t starts;
};

static void worker_start(worker *w);

/* ---- the end of a process ---- */

static struct timeval milliseconds(unsigned ms) {
  return (struct timeval){ms / 1000, (suseconds_t)(ms % 1000) * 1000};
}

static bool from_outside(int signal) {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP ||
         signal == SIGQUIT || signal == SIGUSR1 || signal == SIGUSR2 || signal == SIGALRM ||
         signal == SIGXCPU || signal == SIGPIPE;
}

/* Whether the system killed it for want of memory; then the others start counting
 * from here, so that one kill explains one end. */
static bool killed_by_memory(worker *w) {
  uint64_t kills = oom_kill_count();
  if (w->how.signal != SIGKILL || kills <= w->oom_kills) return false;
  pool *p = w->server->pool;
  for (unsigned i = 0; i < p->count; i++) p->workers[i].oom_kills = kills;
  return true;
}

static void fail_job(worker *w, job *j) {
  char name[32];
  if (!w->how.signal) {
    jobs_fail_with(w->server, j, TP_E_WORKER_EXITED, json_pack("{s:i}", "status", w->how.status),
                   "the worker exited in mid-job with status %d", w->how.status);
    return;
  }
  const char *brief = sigabbrev_np(w->how.signal);
  snprintf(name, sizeof name, "SIG%s", brief ? brief : "?");
  json_t *data = json_pack("{s:s}", "signal", name);
  if (killed_by_memory(w))
    jobs_fail_with(w->server, j, TP_E_WORKER_MEMORY, data,
                   "the system ran out of memory and killed the worker");
  else if (from_outside(w->how.signal))
    jobs_fail_with(w->server, j, TP_E_WORKER_KILLED, data, "the worker was killed by %s", name);
  else
    jobs_fail_with(w->server, j, TP_E_WORKER_CRASHED, data, "the worker crashed with %s", name);
}

static void on_respawn(evutil_socket_t fd, short what, void *arg) {
  (void)fd, (void)what;
  worker_start(arg);
}

static void schedule_respawn(worker *w) {
  server *s = w->server;
  unsigned delay = 0;
  if (w->failures) {
    unsigned doublings = w->failures - 1 < 16 ? w->failures - 1 : 16;
    delay = RESPAWN_FIRST_MS << doublings;
    if (delay > RESPAWN_LAST_MS) delay = RESPAWN_LAST_MS;
  }
  if (!s->serving && w->failures >= START_ATTEMPTS) {
    LOG(LOG_ERROR, "workers do not start", log_text("program", s->worker_program));
    server_stop(s, EXIT_FAILURE);
    return;
  }
  struct timeval after = milliseconds(delay);
  evtimer_add(w->respawn, &after);
}

/* Its stream is read to the end, and it is reaped. */
static void worker_gone(worker *w) {
  job *j = w->job;
  w->job = NULL;
  bool useful = j || clock_now() - w->born > 1.0 || w->state == WORKER_ENDING;
  w->failures = useful ? 0 : w->failures + 1;
  LOG(w->state == WORKER_ENDING ? LOG_INFO : LOG_WARNING, "worker ended",
      log_int("worker", w->process.pid), log_int("status", w->how.status),
      log_int("signal", w->how.signal), log_text("job", j ? j->id : NULL));
  link_reset(w);
  evtimer_del(w->grace);
  event_free(w->reaper);
  bufferevent_free(w->bev);
  w->reaper = NULL;
  w->bev = NULL;
  close(w->process.pidfd);
  w->state = WORKER_ABSENT;
  if (j) fail_job(w, j);
  schedule_respawn(w);
}

static void on_process_end(evutil_socket_t fd, short what, void *arg) {
  worker *w = arg;
  (void)fd, (void)what;
  if (!w->has_ended) w->how = spawn_reap(&w->process);
  w->has_ended = true;
  if (w->stream_ended || w->state == WORKER_ENDING) worker_gone(w);
  else if (!(bufferevent_get_enabled(w->bev) & EV_READ)) bufferevent_enable(w->bev, EV_READ);
}

static void on_stream_end(struct bufferevent *bev, short what, void *arg) {
  worker *w = arg;
  (void)bev, (void)what;
  struct timeval after = milliseconds(END_GRACE_MS);
  w->stream_ended = true;
  if (w->has_ended) worker_gone(w);
  else if (!evtimer_pending(w->grace, NULL)) evtimer_add(w->grace, &after); /* dying, mostly */
}

static void on_written(struct bufferevent *bev, void *arg) {
  worker *w = arg;
  if (w->job && !evbuffer_get_length(bufferevent_get_output(bev)))
    jobs_release_upload(w->server, w->job);
}

void worker_kill(worker *w) {
  w->state = WORKER_ENDING;
  bufferevent_disable(w->bev, EV_READ | EV_WRITE);
  evtimer_del(w->grace);
  if (w->has_ended) event_active(w->reaper, EV_READ, 1);
  else spawn_kill(&w->process);
}

/* ---- the start ---- */

static bool connect_worker(worker *w) {
  struct event_base *base = w->server->base;
  w->bev = bufferevent_socket_new(base, w->process.socket, BEV_OPT_CLOSE_ON_FREE);
  w->reaper = event_new(base, w->process.pidfd, EV_READ, on_process_end, w);
  if (!w->bev || !w->reaper || tp_reader_create(TP_WORKER_LINE, &w->reader) != TP_OK) return false;
  bufferevent_setcb(w->bev, link_read, on_written, on_stream_end, w);
  bufferevent_setwatermark(w->bev, EV_READ, 0, WORKER_INPUT);
  bufferevent_set_max_single_read(w->bev, WORKER_INPUT);
  bufferevent_set_max_single_write(w->bev, WORKER_INPUT);
  bufferevent_enable(w->bev, EV_READ | EV_WRITE);
  return !event_add(w->reaper, NULL);
}

static void worker_start(worker *w) {
  server *s = w->server;
  if (!spawn_worker(s->worker_program, s->config->worker_prefix.items,
                    s->config->limits.worker_memory_bytes, &w->process)) {
    LOG(LOG_ERROR, "worker not started", log_text("error", strerror(errno)));
    w->failures++;
    schedule_respawn(w);
    return;
  }
  w->born = clock_now();
  w->oom_kills = oom_kill_count();
  w->has_ended = w->stream_ended = false;
  w->state = WORKER_STARTING;
  s->pool->starts++;
  if (connect_worker(w)) return;
  /* No memory: undone, and tried again later. */
  spawn_reap(&w->process);
  link_reset(w);
  if (w->reaper) event_free(w->reaper);
  if (w->bev) bufferevent_free(w->bev);
  else close(w->process.socket);
  close(w->process.pidfd);
  w->reaper = NULL;
  w->bev = NULL;
  w->state = WORKER_ABSENT;
  w->failures++;
  schedule_respawn(w);
}

/* It did not give up its job, or closed its stream and lives. */
static void on_grace(evutil_socket_t fd, short what, void *arg) {
  worker *w = arg;
  job *j = w->job;
  (void)fd, (void)what;
  w->job = NULL;
  LOG(LOG_WARNING, "worker is killed", log_int("worker", w->process.pid),
      log_text("why", w->stream_ended ? "it closed its stream" : "it does not give up its job"),
      log_text("job", j ? j->id : NULL));
  worker_kill(w);
  if (j) jobs_fail_with(w->server, j, TP_E_WORKER_EXITED, NULL, "the worker closed its stream");
}

pool *pool_create(server *s) {
  pool *p = calloc(1, sizeof *p);
  if (!p || !(p->workers = calloc(s->config->workers, sizeof *p->workers))) {
    free(p);
    return NULL;
  }
  p->server = s;
  p->count = s->config->workers;
  s->pool = p;
  for (unsigned i = 0; i < p->count; i++) {
    worker *w = &p->workers[i];
    w->server = s;
    w->respawn = evtimer_new(s->base, on_respawn, w);
    w->grace = evtimer_new(s->base, on_grace, w);
    if (!w->respawn || !w->grace) {
      pool_free(p);
      return NULL;
    }
    struct timeval now = {0, 0};
    evtimer_add(w->respawn, &now);
  }
  return p;
}

void pool_free(pool *p) {
  if (!p) return;
  for (unsigned i = 0; i < p->count; i++) {
    worker *w = &p->workers[i];
    if (w->state != WORKER_ABSENT) {
      if (!w->has_ended) spawn_reap(&w->process);
      link_reset(w);
      event_free(w->reaper);
      bufferevent_free(w->bev);
      close(w->process.pidfd);
    }
    if (w->respawn) event_free(w->respawn);
    if (w->grace) event_free(w->grace);
  }
  free(p->workers);
  free(p);
}

/* ---- jobs ---- */

void pool_dispatch(pool *p) {
  server *s = p->server;
  for (unsigned i = 0; i < p->count; i++) {
    worker *w = &p->workers[i];
    job *j = TAILQ_FIRST(&s->jobs[JOB_QUEUED]);
    if (!j) return;
    if (w->state != WORKER_IDLE) continue;
    if (!link_run(w, j)) {
      jobs_fail_with(s, j, TP_E_INTERNAL, NULL, "no memory to hand the job to a worker");
      continue;
    }
    w->state = WORKER_BUSY;
    w->job = j;
    jobs_start(s, j, w);
  }
}

void worker_cancel(worker *w) {
  json_t *params = json_pack("{s:s}", "job", w->job->id);
  struct timeval after = milliseconds(CANCEL_GRACE_MS);
  link_send(w, "job.cancel", params, NULL); /* if not: the grace ends it */
  json_decref(params);
  evtimer_add(w->grace, &after);
}

void worker_finished(worker *w) {
  evtimer_del(w->grace);
  w->job = NULL;
  w->failures = 0;
  w->state = WORKER_IDLE;
  pool_dispatch(w->server->pool);
}

void pool_room(void *arg) {
  pool *p = arg;
  for (unsigned i = 0; i < p->count; i++) {
    worker *w = &p->workers[i];
    if (w->state == WORKER_ABSENT || w->state == WORKER_ENDING) continue;
    bufferevent_enable(w->bev, EV_READ);
    link_read(w->bev, w);
  }
}

void pool_count(const pool *p, unsigned counts[5], uint64_t *ret_restarts) {
  memset(counts, 0, 5 * sizeof *counts);
  for (unsigned i = 0; i < p->count; i++) counts[p->workers[i].state]++;
  *ret_restarts = p->starts > p->count ? p->starts - p->count : 0;
}
