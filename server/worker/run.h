// SPDX-License-Identifier: Apache-2.0
/* run.h: one job, from its upload to job.done or job.failed. */
#ifndef TETRAD_WORKER_RUN_H
#define TETRAD_WORKER_RUN_H

#include "server/worker/channel.h"

/* The last message about a job; `params` is a new reference. */
typedef struct answer {
  const char *method; /* job.done, job.failed */
  json_t *params;
} answer;

/* Runs a task: sends its progress and chunks. Everything that it took is freed when
 * it returns what is to be answered. */
answer run_task(channel *channel, task *task);

#endif
