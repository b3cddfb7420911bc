// SPDX-License-Identifier: Apache-2.0
/* codec.c: the codecs raw, zlib and mesh (PROTOCOL.md, "Codecs").
 *
 * mesh = predict, byte shuffle, zlib. The prediction is fused with the shuffle:
 * one pass over the elements, one byte plane per byte and column. */
#include "protocol/codec.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static const char *const codec_names[TP_CODECS] = {"raw", "zlib", "mesh"};

enum { MAX_RATIO = 1032 };
enum { LEVEL = 1 }; /* higher levels cost much and gain little on shuffled planes */

const char *tp_codec_name(tp_codec codec) { return codec_names[codec]; }

bool tp_codec_of(const char *name, tp_codec *ret_codec) {
  for (unsigned i = 0; i < TP_CODECS; i++) {
    if (strcmp(name, codec_names[i]) == 0) {
      *ret_codec = (tp_codec)i;
      return true;
    }
  }
  return false;
}

void tp_bytes_free(tp_bytes *bytes) {
  free(bytes->data);
  *bytes = (tp_bytes)TP_BYTES_INIT;
}

tp_code tp_bytes_reserve(tp_bytes *bytes, size_t more) {
  if (more <= bytes->capacity - bytes->size) return TP_OK;
  if (more > SIZE_MAX / 2 - bytes->size) return TP_E_INTERNAL;
  size_t capacity = bytes->capacity + bytes->capacity / 2;
  if (capacity < bytes->size + more) capacity = bytes->size + more;
  unsigned char *data = realloc(bytes->data, capacity);
  if (data == NULL) return TP_E_INTERNAL;
  bytes->data = data;
  bytes->capacity = capacity;
  return TP_OK;
}

uint32_t tp_crc32(uint32_t crc, const void *data, size_t size) {
  /* zlib takes a null pointer as a wish for the start value */
  return size != 0 ? (uint32_t)crc32_z(crc, data, size) : crc;
}

static uint32_t zigzag(uint32_t d) { return (d << 1) ^ (0u - (d >> 31)); }

static uint32_t unzigzag(uint32_t z) { return (z >> 1) ^ (0u - (z & 1)); }

/* The elements of one unit, R rows by C columns, w bytes each. */
typedef struct layout {
  tp_dtype dtype;
  size_t rows, columns, width, bytes;
} layout;

static uint64_t load(const unsigned char *at, size_t width) {
  uint64_t value = 0;
  memcpy(&value, at, width);
  return value;
}

static void store(unsigned char *at, size_t width, uint64_t value) { memcpy(at, &value, width); }

/* Predict and shuffle: byte b of y[r][c] goes to out[(b C + c) R + r]. */
static void shuffle(const layout *unit, const unsigned char *in, unsigned char *out) {
  const size_t rows = unit->rows, columns = unit->columns, width = unit->width;
  for (size_t c = 0; c < columns; c++) {
    for (size_t r = 0; r < rows; r++) {
      const unsigned char *at = in + (r * columns + c) * width;
      uint64_t y = load(at, width);
      if (unit->dtype == TP_U4) {
        const size_t back = c != 0 ? c * width : columns * width;
        const uint64_t base = c != 0 || r != 0 ? load(at - back, width) : 0;
        y = zigzag((uint32_t)y - (uint32_t)base);
      } else if (unit->dtype == TP_F8 || unit->dtype == TP_F4) {
        if (r != 0) y ^= load(at - columns * width, width);
      }
      for (size_t b = 0; b < width; b++) {
        out[(b * columns + c) * rows + r] = (unsigned char)(y >> (8 * b));
      }
    }
  }
}

/* The inverse. Column 0 is complete before the columns that need it. */
static void unshuffle(const layout *unit, const unsigned char *in, unsigned char *out) {
  const size_t rows = unit->rows, columns = unit->columns, width = unit->width;
  for (size_t c = 0; c < columns; c++) {
    for (size_t r = 0; r < rows; r++) {
      unsigned char *at = out + (r * columns + c) * width;
      uint64_t y = 0;
      for (size_t b = 0; b < width; b++) {
        y |= (uint64_t)in[(b * columns + c) * rows + r] << (8 * b);
      }
      if (unit->dtype == TP_U4) {
        const size_t back = c != 0 ? c * width : columns * width;
        const uint64_t base = c != 0 || r != 0 ? load(at - back, width) : 0;
        y = unzigzag((uint32_t)y) + (uint32_t)base;
      } else if (unit->dtype == TP_F8 || unit->dtype == TP_F4) {
        if (r != 0) y ^= load(at - columns * width, width);
      }
      store(at, width, y);
    }
  }
}

/* zlib counts in unsigned int: hand it pieces. */
static uInt piece_of(size_t left) { return left < UINT_MAX / 2 ? (uInt)left : UINT_MAX / 2; }

static Bytef *zlib_input(const void *data) {
  union {
    const void *in;
    Bytef *out;
  } pointer = {.in = data}; /* z_stream.next_in is not const in every build of zlib */
  return pointer.out;
}

static tp_code deflate_bytes(const unsigned char *in, size_t size, tp_bytes *out) {
  z_stream stream = {0};
  if (deflateInit(&stream, LEVEL) != Z_OK) return TP_E_INTERNAL;
  const size_t start = out->size;
  size_t taken = 0;
  int status = Z_OK;
  /* the bound of a stream, so that usually one reservation does */
  size_t room = size + size / 1000 + 64;
  while (status == Z_OK) {
    if (tp_bytes_reserve(out, room) != TP_OK) break;
    const uInt give = piece_of(size - taken);
    const uInt space = piece_of(out->capacity - out->size);
    stream.next_in = zlib_input(in + taken);
    stream.avail_in = give;
    stream.next_out = out->data + out->size;
    stream.avail_out = space;
    status = deflate(&stream, taken + give == size ? Z_FINISH : Z_NO_FLUSH);
    taken += give - stream.avail_in;
    out->size += space - stream.avail_out;
    room = 4096;
  }
  deflateEnd(&stream);
  if (status == Z_STREAM_END) return TP_OK;
  out->size = start;
  return TP_E_INTERNAL;
}

/* Inflates exactly `size` bytes; the stream must end there, and the input too. */
static tp_code inflate_bytes(const unsigned char *in, size_t in_size, unsigned char *out,
                             size_t size, tp_error *error) {
  z_stream stream = {0};
  stream.next_in = zlib_input(in);
  const int started = inflateInit(&stream);
  if (started != Z_OK) return tp_fail(error, TP_E_INTERNAL, NULL, "out of memory");
  size_t taken = 0, made = 0;
  int status = Z_OK;
  unsigned char beyond = 0; /* room for one byte too many, to see that there is none */
  while (status == Z_OK) {
    const uInt give = piece_of(in_size - taken);
    const uInt space = made < size ? piece_of(size - made) : 1;
    stream.next_in = zlib_input(in + taken);
    stream.avail_in = give;
    stream.next_out = made < size ? out + made : &beyond;
    stream.avail_out = space;
    status = inflate(&stream, Z_NO_FLUSH);
    taken += give - stream.avail_in;
    const size_t got = space - stream.avail_out;
    if (got != 0 && made == size) {
      inflateEnd(&stream);
      return tp_fail(error, TP_E_UPLOAD, NULL, "zlib stream holds more than its declared size");
    }
    made += got;
  }
  inflateEnd(&stream);
  if (status == Z_MEM_ERROR) return tp_fail(error, TP_E_INTERNAL, NULL, "out of memory");
  if (status == Z_BUF_ERROR) return tp_fail(error, TP_E_UPLOAD, NULL, "zlib stream is truncated");
  if (status != Z_STREAM_END) return tp_fail(error, TP_E_UPLOAD, NULL, "zlib stream is corrupt");
  if (made != size)
    return tp_fail(error, TP_E_UPLOAD, NULL, "zlib stream holds less than its declared size");
  if (taken != in_size)
    return tp_fail(error, TP_E_UPLOAD, NULL, "bytes follow the end of a zlib stream");
  return TP_OK;
}

/* The unit's layout. Errors: TP_E_PARAMS if memory cannot address it. */
static tp_code make_layout(tp_dtype dtype, uint64_t columns, uint64_t rows, layout *ret_unit) {
  const uint64_t shape[2] = {rows, columns};
  uint64_t bytes = 0;
  if (tp_shape_bytes(dtype, shape, &bytes) != TP_OK || bytes > SIZE_MAX / 2) return TP_E_PARAMS;
  *ret_unit = (layout){dtype, (size_t)rows, (size_t)columns, tp_dtype_size(dtype), (size_t)bytes};
  return TP_OK;
}

static tp_code encode_mesh(const layout *unit, const void *data, tp_bytes *out) {
  unsigned char *planes = malloc(unit->bytes);
  if (planes == NULL) return TP_E_INTERNAL;
  shuffle(unit, data, planes);
  const tp_code code = deflate_bytes(planes, unit->bytes, out);
  free(planes);
  return code;
}

tp_code tp_encode(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, const void *data,
                  tp_bytes *out, uint32_t *ret_crc) {
  layout unit;
  if (make_layout(dtype, columns, rows, &unit) != TP_OK) return TP_E_INTERNAL;
  tp_code code = TP_OK;
  if (unit.bytes != 0) {
    switch (codec) {
      case TP_RAW:
        code = tp_bytes_reserve(out, unit.bytes);
        if (code != TP_OK) break;
        memcpy(out->data + out->size, data, unit.bytes);
        out->size += unit.bytes;
        break;
      case TP_ZLIB:
        code = deflate_bytes(data, unit.bytes, out);
        break;
      case TP_MESH:
        code = encode_mesh(&unit, data, out);
        break;
    }
  }
  if (code == TP_OK && ret_crc != NULL) *ret_crc = tp_crc32(0, data, unit.bytes);
  return code;
}

static tp_code decode_mesh(const layout *unit, const void *in, size_t in_size, void *out,
                           tp_error *error) {
  unsigned char *planes = malloc(unit->bytes);
  if (planes == NULL) return tp_fail(error, TP_E_INTERNAL, NULL, "out of memory");
  const tp_code code = inflate_bytes(in, in_size, planes, unit->bytes, error);
  if (code == TP_OK) unshuffle(unit, planes, out);
  free(planes);
  return code;
}

tp_code tp_decode(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, const void *in,
                  size_t in_size, void *out, uint32_t *ret_crc, tp_error *error) {
  layout unit;
  if (make_layout(dtype, columns, rows, &unit) != TP_OK)
    return tp_fail(error, TP_E_UPLOAD, NULL, "shape too large");
  tp_code code = TP_OK;
  if (!tp_codec_fits(codec, in_size, unit.bytes))
    return tp_fail(error, TP_E_UPLOAD, NULL, "%zu bytes cannot hold the declared %zu", in_size,
                   unit.bytes);
  if (unit.bytes == 0 || codec == TP_RAW) {
    if (in_size != 0) memcpy(out, in, in_size);
  } else if (codec == TP_ZLIB) {
    code = inflate_bytes(in, in_size, out, unit.bytes, error);
  } else {
    code = decode_mesh(&unit, in, in_size, out, error);
  }
  if (code == TP_OK && ret_crc != NULL) *ret_crc = tp_crc32(0, out, unit.bytes);
  return code;
}

bool tp_codec_fits(tp_codec codec, uint64_t in_size, uint64_t bytes) {
  if (bytes == 0 || codec == TP_RAW) return in_size == bytes;
  return in_size != 0 && bytes / MAX_RATIO <= in_size;
}

uint64_t tp_chunk_rows(tp_dtype dtype, uint64_t columns) {
  const uint64_t most = TP_CHUNK_BYTES / tp_dtype_size(dtype);
  return columns == 0 || columns >= most ? 1 : most / columns;
}

uint64_t tp_chunk_count(uint64_t rows, uint64_t rows_per_chunk) {
  return rows / rows_per_chunk + (rows % rows_per_chunk != 0);
}
