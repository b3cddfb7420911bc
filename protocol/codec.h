// SPDX-License-Identifier: Apache-2.0
/* codec.h: encoding of array rows as bytes: raw, zlib, mesh.
 *
 * PROTOCOL.md, "Codecs", defines every bit. A unit (an uploaded array, or a chunk
 * of a result's array) is decodable alone. Lossless on any bytes: NaN payloads,
 * signs of zero and arbitrary indices come back as they went. */
#ifndef TETRAD_PROTOCOL_CODEC_H
#define TETRAD_PROTOCOL_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/array.h"
#include "protocol/error.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tp_codec { TP_RAW = 0, TP_ZLIB, TP_MESH } tp_codec;
enum { TP_CODECS = 3, TP_CHUNK_BYTES = 1048576 };

/* "raw", "zlib", "mesh". */
const char *tp_codec_name(tp_codec codec);

/* The codec of a name; false (*ret_codec untouched) if there is none. */
bool tp_codec_of(const char *name, tp_codec *ret_codec);

/* Growable bytes. Start from {0} (TP_BYTES_INIT); free with tp_bytes_free. */
typedef struct tp_bytes {
  unsigned char *data;
  size_t size;
  size_t capacity;
} tp_bytes;

#define TP_BYTES_INIT {NULL, 0, 0}

void tp_bytes_free(tp_bytes *bytes);

/* Makes room for `more` bytes after size. Errors: TP_E_INTERNAL (no memory). */
tp_code tp_bytes_reserve(tp_bytes *bytes, size_t more);

/* CRC-32 (zlib's) of bytes of any length; continues from `crc` (start: 0). */
uint32_t tp_crc32(uint32_t crc, const void *data, size_t size);

/* Encodes `rows` rows of `columns` (1 for 1-dimensional arrays) elements at `data`
 * and appends the result to *out; *ret_crc (may be NULL) is the CRC-32 of the
 * bytes at `data`. No rows encode to no bytes in every codec. Errors:
 * TP_E_INTERNAL (no memory), *out as before. Cost: one pass and zlib level 1;
 * scratch as large as the data. */
tp_code tp_encode(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, const void *data,
                  tp_bytes *out, uint32_t *ret_crc);

/* Decodes exactly rows * columns elements from in[0 .. in_size) into `out`, which
 * has that room; never writes past it and never inflates further. *ret_crc (may be
 * NULL) is the CRC-32 of the decoded bytes, for the caller to compare. Errors:
 * TP_E_UPLOAD if the bytes do not decode to exactly that size, TP_E_INTERNAL (no
 * memory); then `out` holds rubbish. */
tp_code tp_decode(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, const void *in,
                  size_t in_size, void *out, uint32_t *ret_crc, tp_error *error);

/* Whether in_size encoded bytes can decode to `bytes` at all (deflate's ratio ends at
 * 1032): looked at before memory for the decoded bytes is taken. */
bool tp_codec_fits(tp_codec codec, uint64_t in_size, uint64_t bytes);

/* Rows of a chunk: as many as fit 1 MiB raw, at least 1. A chunk of the last rows
 * may hold fewer. columns >= 1. */
uint64_t tp_chunk_rows(tp_dtype dtype, uint64_t columns);

/* Chunks of an array of `rows` rows: ceil(rows / rows_per_chunk); 0 rows, 0 chunks. */
uint64_t tp_chunk_count(uint64_t rows, uint64_t rows_per_chunk);

#ifdef __cplusplus
}
#endif
#endif
