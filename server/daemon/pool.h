// SPDX-License-Identifier: Apache-2.0
/* pool.h: worker processes: started ahead, one job each, replaced when they end. */
#ifndef TETRAD_DAEMON_POOL_H
#define TETRAD_DAEMON_POOL_H

#include <event2/bufferevent.h>
#include <jansson.h>

#include "protocol/frame.h"
#include "server/daemon/server.h"
#include "server/daemon/spawn.h"

typedef enum worker_state {
  WORKER_ABSENT = 0, /* waits to be started */
  WORKER_STARTING,   /* until worker.ready */
  WORKER_IDLE,
  WORKER_BUSY,
  WORKER_ENDING      /* killed, or its stream is broken: until it is reaped */
} worker_state;

/* A slot; processes come and go in it. */
struct worker {
  server *server;
  worker_state state;
  spawned process;
  struct bufferevent *bev;
  tp_reader *reader;
  struct event *reaper;  /* pidfd */
  struct event *respawn; /* timer */
  struct event *grace;   /* timer: job.cancel was sent */
  job *job;
  bool has_ended, stream_ended;
  ended how;
  unsigned failures;     /* starts in a row that came to nothing */
  double born;           /* monotonic */
  uint64_t oom_kills;    /* the system's count when it was started */
  /* the chunk that arrives */
  char *chunk;
  size_t chunk_size, chunk_filled;
  json_t *chunk_params;
};

/* Starts cfg->workers processes. NULL: no memory. */
pool *pool_create(server *server);

/* Kills all of them. */
void pool_free(pool *pool);

/* Gives queued jobs to idle workers. */
void pool_dispatch(pool *pool);

/* Asks the worker to give up its job; kills it if it does not within the grace. */
void worker_cancel(worker *w);

/* Kills it; its job, if it still has one, has been ended by the caller. */
void worker_kill(worker *w);

/* Its job is over, it can have another. */
void worker_finished(worker *w);

/* The spool has room again: a spool_room_fn. */
void pool_room(void *pool);

/* By state. */
void pool_count(const pool *pool, unsigned counts[5], uint64_t *ret_restarts);

/* ---- link.c: what a worker says ---- */
void link_read(struct bufferevent *bev, void *worker);
bool link_send(worker *w, const char *method, const json_t *params, struct evbuffer *body);
bool link_run(worker *w, job *job);
void link_reset(worker *w);

/* How many processes the system has killed for want of memory, in our cgroup. */
uint64_t oom_kill_count(void);

#endif
