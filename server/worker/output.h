// SPDX-License-Identifier: Apache-2.0
/* output.h: a mesh as arrays, encoded chunk by chunk and sent. */
#ifndef TETRAD_WORKER_OUTPUT_H
#define TETRAD_WORKER_OUTPUT_H

#include <tet/mesh.h>

#include "protocol/codec.h"
#include "server/worker/channel.h"

/* Sends all chunks of all arrays; gives the array table (a new reference). Errors:
 * TP_E_JOB_CANCELLED (between two chunks), TP_E_JOB_MEMORY. Cost: one pass to check,
 * one to encode; memory of one chunk. */
tp_code output_send(channel *channel, const task *task, const tet_mesh *mesh, tp_codec codec,
                    json_t **ret_table, tp_error *error);

#endif
