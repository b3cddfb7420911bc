// SPDX-License-Identifier: Apache-2.0
/* job.h: what a job is. Who changes it: jobs.c alone. */
#ifndef TETRAD_DAEMON_JOB_H
#define TETRAD_DAEMON_JOB_H

#include <event2/buffer.h>
#include <jansson.h>

#include "protocol/error.h"
#include "server/daemon/limits.h"
#include "server/daemon/server.h"

typedef enum job_state {
  JOB_QUEUED = 0,
  JOB_RUNNING,
  JOB_DONE,
  JOB_FAILED,
  JOB_CANCELLED
} job_state;

/* What distinguishes two requests under one key: canonical text of the params and
 * the body, by length and two independent checks. */
typedef struct digest {
  uint64_t params;
  uint64_t body_bytes;
  uint32_t body_crc;
} digest;

TAILQ_HEAD(waiting_list, request);

struct job {
  TAILQ_ENTRY(job) in_state;
  job *next_by_id, *next_by_key, *before, *after; /* the store's */

  server *server;
  char id[JOB_ID_SIZE];
  uint64_t number; /* order of acceptance */
  char *principal;
  char *key; /* or NULL */
  digest digest;
  char stage[16], codec[8];
  int priority;

  job_state state;
  tp_code ending; /* TP_OK, or why it is to end: set once, before the worker says so */
  int spool_errno; /* with ending TP_E_SPOOL */
  double created, started, finished; /* calendar; 0: not yet */
  double deadline;                   /* calendar; 0: none */
  double kept_since;                 /* monotonic: end or last complete fetch */
  unsigned attempts;
  struct event *deadline_timer;

  char *input;           /* JSON {pls, options}, until it is handed to a worker */
  struct evbuffer *body; /* likewise */
  uint64_t reserved;     /* of server->upload_bytes, for the two */

  worker *worker;     /* while it meshes */
  json_t *progress;   /* the last, while running */
  uint64_t changes;   /* counts state and progress */
  result *result;     /* from the first chunk on */
  char *arrays;       /* the table, when all chunks have come: JSON text */
  char *report;       /* JSON text */
  json_t *error;      /* failed, cancelled */

  struct waiting_list waiting; /* requests that wait for its end */
};

#endif
