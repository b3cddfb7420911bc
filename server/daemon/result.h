// SPDX-License-Identifier: Apache-2.0
/* result.h: where the chunks of a job's arrays lie in the spool.
 *
 * Chunks come array after array, in each array ascending (PROTOCOL.md, appendix).
 * Shared by the job and by fetches under way; the file goes with the last of them. */
#ifndef TETRAD_DAEMON_RESULT_H
#define TETRAD_DAEMON_RESULT_H

#include "protocol/message.h"
#include "server/daemon/server.h"

typedef struct result_chunk {
  uint64_t offset;
  uint32_t bytes; /* encoded */
  uint32_t rows;
  uint32_t crc32;
} result_chunk;

typedef struct result_array {
  tp_array_info info; /* only its name until the table is there */
  result_chunk *chunks;
  size_t count, capacity;
} result_array;

struct result {
  unsigned refs;
  spool_file *file;
  result_array *arrays;
  size_t n_arrays;
};

/* Refs 1. NULL: no memory. `fn` as of spool_file_create. */
result *result_create(spool *spool, spool_file_fn fn, void *user);
result *result_ref(result *result);
void result_unref(result *result); /* NULL is fine */

/* Notes the next chunk of `array`, whose bytes are at `offset`. false: not the next
 * one (protocol broken), or no memory. */
bool result_add(result *result, const char *array, uint64_t chunk, const result_chunk *at);

/* Takes the array table, in its order, and checks that all its chunks came and no
 * other. Errors: TP_E_PARAMS with a message. */
tp_code result_complete(result *result, const json_t *table, tp_error *error);

/* NULL if there is none. */
const result_array *result_find(const result *result, const char *name);

#endif
