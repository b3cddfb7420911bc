// SPDX-License-Identifier: Apache-2.0
/* store.h: the jobs that exist, by id and by key. An interface: what is behind it
 * (memory, store_memory.c) is nobody else's concern.
 *
 * The store owns its jobs. It does not know what their states mean. */
#ifndef TETRAD_DAEMON_STORE_H
#define TETRAD_DAEMON_STORE_H

#include "server/daemon/job.h"

typedef void (*store_free_fn)(job *job);

/* `free_job` is called for what is removed. NULL: no memory. */
store *store_create(store_free_fn free_job);
void store_free(store *store);

/* Accepted means stored. The job's id is new, and its key (if any) new within its
 * principal. */
void store_insert(store *store, job *job);

/* NULL if there is none. Cost: constant on average. */
job *store_find(const store *store, const char *id);
job *store_find_key(const store *store, const char *principal, const char *key);

/* Jobs in order of acceptance: the first, the one after. */
job *store_first(const store *store);
job *store_next(const job *job);
size_t store_count(const store *store);

/* Removes and frees. */
void store_remove(store *store, job *job);

#endif
