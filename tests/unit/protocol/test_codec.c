// SPDX-License-Identifier: Apache-2.0
/* The codec: the vectors of PROTOCOL.md, round trips of every dtype and codec on
 * smooth, random and special data, and what must be refused. */
#include "support.h"

#include <zlib.h>

#include "protocol/codec.h"

enum { FILL_RANDOM, FILL_SMOOTH, FILL_SPECIAL, FILL_ZERO, FILLS };

static void fill(unsigned char *data, size_t size, tp_dtype dtype, int kind, uint64_t seed) {
  static const uint64_t special[] = {0,
                                     UINT64_C(0x8000000000000000),
                                     UINT64_C(0x7ff0000000000000),
                                     UINT64_C(0xfff0000000000000),
                                     UINT64_C(0x7ff0000000000001),
                                     UINT64_C(0xfff8dead0000beef),
                                     UINT64_MAX,
                                     UINT64_C(0x7f800001ffc00002),
                                     1};
  const size_t width = tp_dtype_size(dtype);
  uint64_t state = seed * 2 + 1;
  for (size_t i = 0; i < size / width; i++) {
    uint64_t value = 0;
    if (kind == FILL_RANDOM) value = draw(&state);
    if (kind == FILL_SMOOTH) value = i / 3 + draw(&state) % 3;
    if (kind == FILL_SPECIAL) value = special[draw(&state) % 9];
    memcpy(data + i * width, &value, width);
  }
}

static void round_trip(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, int kind) {
  const size_t size = (size_t)(rows * columns) * tp_dtype_size(dtype);
  unsigned char *data = malloc(size + 1), *back = malloc(size + 8);
  tp_bytes out = TP_BYTES_INIT;
  uint32_t crc = 1, back_crc = 2;
  tp_error error;
  assert_non_null(data);
  assert_non_null(back);
  fill(data, size, dtype, kind, rows * 31 + columns);
  memset(back, 0xa5, size + 8);
  assert_int_equal(tp_encode(codec, dtype, columns, rows, data, &out, &crc), TP_OK);
  assert_int_equal(crc, crc32(crc32(0, NULL, 0), data, (uInt)size));
  assert_int_equal(
      tp_decode(codec, dtype, columns, rows, out.data, out.size, back, &back_crc, &error), TP_OK);
  assert_memory_equal(back, data, size);
  for (int i = 0; i < 8; i++) assert_int_equal(back[size + i], 0xa5);
  assert_int_equal(crc, back_crc);
  if (size == 0) assert_int_equal(out.size, 0);
  /* every proper prefix, and a byte more, is refused */
  if (size != 0) {
    const size_t cuts[] = {0, 1, out.size / 2, out.size - 1};
    for (int i = 0; i < 4; i++) {
      if (cuts[i] == out.size) continue;
      assert_int_equal(
          tp_decode(codec, dtype, columns, rows, out.data, cuts[i], back, NULL, &error),
          TP_E_UPLOAD);
    }
    assert_int_equal(tp_bytes_reserve(&out, 1), TP_OK);
    out.data[out.size] = 0;
    assert_int_equal(
        tp_decode(codec, dtype, columns, rows, out.data, out.size + 1, back, NULL, &error),
        TP_E_UPLOAD);
  }
  for (int i = 0; i < 8; i++) assert_int_equal(back[size + i], 0xa5);
  tp_bytes_free(&out);
  free(data);
  free(back);
}

static void every_dtype_comes_back(void **state) {
  (void)state;
  const uint64_t shapes[][2] = {{0, 1}, {0, 3}, {1, 1}, {1, 4}, {2, 3}, {7, 2}, {257, 4}, {3000, 3}};
  for (unsigned codec = 0; codec < TP_CODECS; codec++) {
    for (unsigned dtype = 0; dtype < TP_DTYPES; dtype++) {
      for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        for (int kind = 0; kind < FILLS; kind++) {
          round_trip((tp_codec)codec, (tp_dtype)dtype, shapes[s][1], shapes[s][0], kind);
        }
      }
    }
  }
}

static void a_large_unit_comes_back(void **state) {
  (void)state;
  round_trip(TP_MESH, TP_U4, 4, 300000, FILL_SMOOTH);
  round_trip(TP_MESH, TP_F8, 3, 100000, FILL_RANDOM);
}

/* The planes that a mesh unit holds, by zlib alone. */
static void inflate_planes(const tp_bytes *out, unsigned char *planes, uLongf size) {
  uLongf made = size;
  assert_int_equal(uncompress(planes, &made, out->data, out->size), Z_OK);
  assert_int_equal(made, size);
}

static void the_vectors_of_the_text(void **state) {
  (void)state;
  const uint32_t tetrahedra[8] = {5, 7, 9, 8, 4, 6, 5, 9};
  const unsigned char wanted[8] = {0x0a, 0x01, 0x04, 0x04, 0x08, 0x02, 0x06, 0x0a};
  const double values[2] = {1.0, 1.5};
  const unsigned char tail[4] = {0xf0, 0x08, 0x3f, 0x00};
  unsigned char planes[32];
  tp_bytes out = TP_BYTES_INIT;
  assert_int_equal(tp_encode(TP_MESH, TP_U4, 4, 2, tetrahedra, &out, NULL), TP_OK);
  inflate_planes(&out, planes, 32);
  assert_memory_equal(planes, wanted, 8);
  for (int i = 8; i < 32; i++) assert_int_equal(planes[i], 0);
  out.size = 0;
  assert_int_equal(tp_encode(TP_MESH, TP_F8, 1, 2, values, &out, NULL), TP_OK);
  inflate_planes(&out, planes, 16);
  for (int i = 0; i < 12; i++) assert_int_equal(planes[i], 0);
  assert_memory_equal(planes + 12, tail, 4);
  tp_bytes_free(&out);
  assert_int_equal(tp_crc32(0, "123456789", 9), UINT32_C(0xCBF43926));
  assert_int_equal(tp_crc32(tp_crc32(0, "1234", 4), "56789", 5), UINT32_C(0xCBF43926));
  assert_int_equal(tp_crc32(0, NULL, 0), 0);
}

static void encoding_appends(void **state) {
  (void)state;
  const uint32_t value = 7;
  tp_bytes out = TP_BYTES_INIT;
  for (int i = 0; i < 3; i++) {
    assert_int_equal(tp_encode(TP_RAW, TP_U4, 1, 1, &value, &out, NULL), TP_OK);
    assert_int_equal(out.size, 4 * (size_t)(i + 1));
  }
  tp_bytes_free(&out);
}

static void bombs_are_defused(void **state) {
  (void)state;
  /* 64 MiB of zeros in about 64 KiB, declared as 1000 bytes */
  const size_t size = (size_t)64 << 20;
  unsigned char *zero = calloc(1, size);
  uLongf packed_size = compressBound(size);
  unsigned char *packed = malloc(packed_size);
  unsigned char out[1008];
  tp_error error;
  assert_non_null(zero);
  assert_non_null(packed);
  assert_int_equal(compress2(packed, &packed_size, zero, size, 9), Z_OK);
  memset(out, 0xa5, sizeof out);
  for (int codec = TP_ZLIB; codec <= TP_MESH; codec++) {
    assert_int_equal(tp_decode((tp_codec)codec, TP_U1, 1, 1000, packed, packed_size, out, NULL,
                               &error), TP_E_UPLOAD);
    for (int i = 1000; i < 1008; i++) assert_int_equal(out[i], 0xa5);
    /* declared as far more than the bytes can hold: refused before memory is taken */
    assert_int_equal(tp_decode((tp_codec)codec, TP_U1, 1, UINT64_C(1) << 45, packed, packed_size,
                               NULL, NULL, &error), TP_E_UPLOAD);
  }
  assert_int_equal(tp_decode(TP_RAW, TP_F8, UINT64_MAX, UINT64_MAX, packed, 0, out, NULL, &error),
                   TP_E_UPLOAD);
  free(zero);
  free(packed);
}

static void rubbish_is_refused(void **state) {
  (void)state;
  uint64_t seed = 12345;
  unsigned char in[200], out[400];
  for (int round = 0; round < 2000; round++) {
    const size_t size = (size_t)(draw(&seed) % sizeof in);
    for (size_t i = 0; i < size; i++) in[i] = (unsigned char)draw(&seed);
    if (size > 2 && round % 2 == 0) memcpy(in, "\x78\x01", 2);
    assert_int_equal(tp_decode(TP_MESH, TP_U4, 4, 25, in, size, out, NULL, NULL), TP_E_UPLOAD);
  }
  /* a stream that asks for a preset dictionary */
  assert_int_equal(tp_decode(TP_ZLIB, TP_U1, 1, 4, "\x78\xbb\0\0\0\1\0\0", 8, out, NULL, NULL),
                   TP_E_UPLOAD);
}

static void chunks_partition_rows(void **state) {
  (void)state;
  assert_int_equal(tp_chunk_rows(TP_F8, 3), 43690);
  assert_int_equal(tp_chunk_rows(TP_U4, 4), 65536);
  assert_int_equal(tp_chunk_rows(TP_U1, 1), 1048576);
  assert_int_equal(tp_chunk_rows(TP_F8, 131072), 1);
  assert_int_equal(tp_chunk_rows(TP_F8, 131073), 1);
  assert_int_equal(tp_chunk_rows(TP_F8, UINT64_MAX), 1);
  assert_int_equal(tp_chunk_count(0, 5), 0);
  assert_int_equal(tp_chunk_count(1, 5), 1);
  assert_int_equal(tp_chunk_count(5, 5), 1);
  assert_int_equal(tp_chunk_count(6, 5), 2);
  assert_true(tp_chunk_count(UINT64_MAX, 2) == UINT64_C(1) << 63);
}

static void codecs_have_names(void **state) {
  (void)state;
  for (unsigned i = 0; i < TP_CODECS; i++) {
    tp_codec codec = (tp_codec)((i + 1) % TP_CODECS);
    assert_true(tp_codec_of(tp_codec_name((tp_codec)i), &codec));
    assert_int_equal(codec, i);
  }
  tp_codec codec = TP_ZLIB;
  assert_false(tp_codec_of("gzip", &codec));
  assert_int_equal(codec, TP_ZLIB);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_dtype_comes_back),  cmocka_unit_test(a_large_unit_comes_back),
      cmocka_unit_test(the_vectors_of_the_text), cmocka_unit_test(encoding_appends),
      cmocka_unit_test(bombs_are_defused),       cmocka_unit_test(rubbish_is_refused),
      cmocka_unit_test(chunks_partition_rows),   cmocka_unit_test(codecs_have_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
