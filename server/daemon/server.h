// SPDX-License-Identifier: Apache-2.0
/* server.h: the map of the daemon.
 *
 *   listener ---> connection ---> methods ---> jobs <--> store
 *                     ^              |           |
 *                     |            fetch        pool ---> worker processes
 *                     |              |           |
 *                     +----------- spool <------ link (chunks)
 *
 * One libevent loop runs all of it; only the spool has a thread. A connection parses
 * messages and holds requests; a request may wait for a job; a job is changed by
 * jobs.c alone; the pool gives queued jobs to idle workers; the link reads what a
 * worker says and puts chunks into the spool, from where fetches send them. */
#ifndef TETRAD_DAEMON_SERVER_H
#define TETRAD_DAEMON_SERVER_H

#include <event2/event.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "server/daemon/config.h"
#include "server/daemon/spool.h"

typedef struct server server;
typedef struct connection connection;
typedef struct request request;
typedef struct job job;
typedef struct worker worker;
typedef struct pool pool;
typedef struct store store;
typedef struct listener listener;
typedef struct result result;

TAILQ_HEAD(connection_list, connection);
TAILQ_HEAD(job_list, job);
TAILQ_HEAD(listener_list, listener);

enum { JOB_STATES = 5 };

typedef struct totals {
  uint64_t submitted, connections;
  uint64_t ended[JOB_STATES]; /* by final state */
  uint64_t received, sent;    /* bytes of all connections */
} totals;

struct server {
  const config *config;
  struct event_base *base;
  char *worker_program;
  store *store;
  pool *pool;
  spool *spool;
  struct listener_list listeners;
  struct connection_list connections;
  unsigned n_connections, n_requests;
  uint64_t max_connections; /* configured, or what descriptors allow */
  struct job_list jobs[JOB_STATES]; /* a job is in the list of its state */
  unsigned n_jobs[JOB_STATES];
  uint64_t next_job;
  uint64_t upload_bytes; /* reserved */
  totals totals;
  double started; /* monotonic */
  bool serving;   /* a worker has been ready: listeners are open */
  bool draining;
  double quiet_since; /* while draining: nothing happened since */
  int exit_status;
};

/* Runs the daemon until it is told to end; the process's exit status. */
int server_run(const config *cfg);

/* Monotonic and calendar clocks, seconds. */
double clock_now(void);
double clock_utc(void);

/* The first worker is ready: starts serving. */
void server_ready(server *server);

/* Ends the loop; the process exits with `status`. */
void server_stop(server *server, int status);

#endif
