// SPDX-License-Identifier: Apache-2.0
/* spool.h: results on disk, written by a thread of its own.
 *
 * The loop appends blocks and never waits: they go into a queue, and the loop hears
 * of the end of a file through a callback. Blocks of a file are written in order.
 * Files lie in a private folder that goes with the daemon; folders left behind by
 * killed daemons are removed by the next one. Reading is the caller's, from the
 * descriptor of spool_file_open. All functions belong to the loop's thread. */
#ifndef TETRAD_DAEMON_SPOOL_H
#define TETRAD_DAEMON_SPOOL_H

#include <event2/event.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct spool spool;
typedef struct spool_file spool_file;

/* `error` 0: finished, all of it can be read; else an errno: the file is lost. */
typedef void (*spool_file_fn)(void *user, int error);
typedef void (*spool_room_fn)(void *user);

/* Makes the private folder in `parent` and starts the thread. `limit`: bytes of all
 * files together. Errors: NULL with errno. */
spool *spool_create(struct event_base *base, const char *parent, uint64_t limit);

/* Stops the thread, removes files and folder. Files must have been dropped. */
void spool_free(spool *spool);

/* Called when the queue has room again after spool_crowded said true. */
void spool_on_room(spool *spool, spool_room_fn fn, void *user);

/* Over SPOOL_QUEUE_MAX bytes wait to be written: take no more from workers. */
bool spool_crowded(spool *spool);

/* Whether less than a sixteenth of the limit is left: no room for another job. */
bool spool_full(const spool *spool);
uint64_t spool_bytes(const spool *spool);

/* A new file. `fn` is called once: after spool_file_finish, or earlier if writing
 * fails; never from inside a call. NULL: no memory. */
spool_file *spool_file_create(spool *spool, spool_file_fn fn, void *user);

/* Appends `data` (from malloc; taken, also on failure). Gives the offset that it will
 * have. Errors (errno): ENOSPC at the limit, ENOMEM; 0 is success. */
int spool_file_append(spool_file *file, void *data, size_t size, uint64_t *ret_offset);

/* Nothing more comes: `fn` tells when all is written. */
void spool_file_finish(spool_file *file);

/* Forgets the file; `fn` is not called any more; open descriptors stay good. */
void spool_file_drop(spool_file *file);

/* A descriptor to read a finished file, the caller's; -1 with errno. */
int spool_file_open(const spool_file *file);
uint64_t spool_file_bytes(const spool_file *file);

#endif
