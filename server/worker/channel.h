// SPDX-License-Identifier: Apache-2.0
/* channel.h: the worker's fd 0 and 1 (PROTOCOL.md, appendix).
 *
 * A control thread reads fd 0 all the time, also while the main thread meshes; the
 * main thread alone writes fd 1. End of file on either ends the process at once, and
 * a broken peer ends it with status WORKER_BROKEN: there is nobody left to work for. */
#ifndef TETRAD_WORKER_CHANNEL_H
#define TETRAD_WORKER_CHANNEL_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <tet/context.h>

enum { WORKER_BROKEN = 70 };

typedef struct channel channel;

/* One job.run. */
typedef struct task {
  const char *id;       /* inside params */
  json_t *params;
  unsigned char *body;
  size_t body_size, body_room;
  bool lost;            /* no memory for the body: it was dropped */
  atomic_bool cancelled;
} task;

/* Starts the control thread. NULL: no memory, no thread. */
channel *channel_create(void);

/* Waits for the next task; it stays the channel's, until channel_done. */
task *channel_next(channel *channel);

/* From now on a cancellation reaches this context; NULL: none any more. */
void channel_set_context(channel *channel, tet_ctx *ctx);

/* Frees the task's body early. */
void channel_drop_body(task *task);

/* Answers the task by a last notification (`params` is taken, "job" is added) and
 * frees it. The next task may arrive at once. */
void channel_done(channel *channel, const char *method, json_t *params);

/* Sends a notification with a body; `params` is taken, "job" is added to it if there
 * is a task. Blocks while the daemon does not read. */
void channel_send(channel *channel, const char *method, json_t *params, const void *body,
                  size_t size);

#endif
