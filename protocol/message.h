// SPDX-License-Identifier: Apache-2.0
/* message.h: array descriptors in JSON and the bytes in a body that they name.
 *
 * Packing and unpacking of uploads (params.pls of mesh.submit), and the array
 * table of results. PROTOCOL.md, "Arrays". */
#ifndef TETRAD_PROTOCOL_MESSAGE_H
#define TETRAD_PROTOCOL_MESSAGE_H

#include <jansson.h>

#include "protocol/array.h"
#include "protocol/codec.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Packs a set: appends each array's encoded bytes to *body and gives the object
 * {name: {"dtype","shape","codec","at","crc32"}} in *ret_object (a new reference).
 * `at` counts from the start of *body as it was given, so pack into an empty body
 * for a message. Errors: TP_E_INTERNAL; then *body is as before and *ret_object
 * untouched. */
tp_code tp_pack(const tp_arrays *set, tp_codec codec, tp_bytes *body, json_t **ret_object,
                tp_error *error);

/* Checks an uploaded object without its body: what the daemon can refuse at once.
 * Each member is a descriptor, or a nested list whose shape fits the schema, or the
 * object is {"json":{"at":[0,body_size]}}. Ranges must tile [0, body_size) (in any
 * order of members; no gap, no overlap; an empty range is allowed anywhere in
 * [0, body_size]); the decoded sizes together must not pass max_bytes. Errors:
 * TP_E_PARAMS, `where` the array. Cost: linear in the line. */
tp_code tp_upload_check(const json_t *object, const tp_schema *schema, uint64_t body_size,
                        uint64_t max_bytes, tp_error *error);

/* Opens an uploaded object: checks it as tp_upload_check, decodes body ranges and
 * nested lists, parses JSON text in the body (an object of nested lists; duplicate
 * keys refused, depth at most 16), compares given CRCs, and validates the set
 * (tp_arrays_validate). On success *ret_set owns copies of everything. max_bytes
 * bounds the decoded bytes together. Errors: TP_E_UPLOAD, `where` the array;
 * TP_E_INTERNAL (no memory); *ret_set is untouched. */
tp_code tp_unpack(const json_t *object, const tp_schema *schema, const void *body,
                  size_t body_size, uint64_t max_bytes, tp_arrays *ret_set, tp_error *error);

/* One row of a result's array table (job.status, job.wait, the worker's job.done). */
typedef struct tp_array_info {
  char name[TP_NAME_SIZE];
  tp_dtype dtype;
  unsigned ndim;
  uint64_t shape[2];       /* shape[1] is 1 if ndim is 1 */
  tp_codec codec;
  uint64_t rows_per_chunk;
  uint64_t chunks;         /* ceil(shape[0] / rows_per_chunk) */
  uint32_t crc32;          /* of all decoded bytes of the array */
} tp_array_info;

/* Fills *ret_info for an array that is sent with `codec`: chunks and CRC included.
 * Cost: one pass over the data. */
void tp_array_info_of(const tp_array *array, tp_codec codec, tp_array_info *ret_info);

/* {"name","dtype","shape","codec","rows_per_chunk","chunks","crc32"}; a new
 * reference, NULL: no memory. */
json_t *tp_array_info_json(const tp_array_info *info);

/* Reads and checks such an object; unknown members are ignored. Errors:
 * TP_E_PARAMS; *ret_info untouched. */
tp_code tp_array_info_parse(const json_t *json, tp_array_info *ret_info, tp_error *error);

/* Rows of chunk `chunk` (< info->chunks): rows_per_chunk, or what is left. */
uint64_t tp_array_info_rows(const tp_array_info *info, uint64_t chunk);

#ifdef __cplusplus
}
#endif
#endif
