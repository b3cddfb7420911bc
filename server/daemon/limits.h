// SPDX-License-Identifier: Apache-2.0
/* limits.h: bounds that are not configured; those that are stand in config.h. */
#ifndef TETRAD_DAEMON_LIMITS_H
#define TETRAD_DAEMON_LIMITS_H

enum {
  /* One connection. */
  OUTPUT_MAX = 4 << 20,     /* bytes waiting to be sent: then no request is read */
  OUTPUT_FETCH = 2 << 20,   /* chunks of at most about 1 MiB are added below this */
  OUTPUT_LOW = 1 << 20,     /* more chunks are asked for at this */
  INPUT_MAX = 256 << 10,    /* bytes read ahead of the parser */
  LINGER_MS = 1000,         /* to let the last error arrive before closing */

  /* Descriptors. */
  FDS_RESERVED = 16,        /* of the daemon itself */
  FDS_WORKER = 4,           /* socket, pidfd, the file it fills; one to spare for its start */
  FDS_CONNECTION = 2,       /* socket, the file that it fetches */

  /* One worker. */
  WORKER_INPUT = 2 << 20,
  CHUNK_MAX = 64 << 20,     /* encoded; rows of more than 1 MiB make large chunks */
  CANCEL_GRACE_MS = 80,     /* from job.cancel to SIGKILL */
  END_GRACE_MS = 500,       /* from the end of its stream to SIGKILL */
  RESPAWN_FIRST_MS = 50,    /* doubled for each failed start in a row */
  RESPAWN_LAST_MS = 10000,
  START_ATTEMPTS = 3,       /* of the first worker, before the daemon gives up */

  /* The spool's queue, all jobs together. */
  SPOOL_QUEUE_MAX = 16 << 20, /* bytes: then workers are not read */
  SPOOL_QUEUE_LOW = 8 << 20,

  /* Lives of things. */
  JANITOR_MS = 500,
  DRAIN_QUIET_MS = 1000,    /* after the last job, for clients to come for results */
  BUSY_RETRY_MS = 500,

  PROGRESS_MIN_MS = 50,
  PRIORITY_MAX = 100,
  KEY_MAX = 128,
  CLIENT_NAME_MAX = 128,
  LIST_MAX = 100,
  INSTANCE_MAX = 32,
  JOB_ID_SIZE = 65
};

#endif
