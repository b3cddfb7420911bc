// SPDX-License-Identifier: Apache-2.0
/* Fuzzes tp_decode and tp_encode. The first four bytes choose codec, dtype, columns
 * and rows; the rest is decoded as it is, and also encoded and decoded again. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/codec.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(int holds) {
  if (!holds) abort();
}

/* Encodes and decodes `rows` rows: the same bytes come back. */
static void round_trip(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows,
                       const uint8_t *data) {
  const size_t bytes = (size_t)(rows * columns) * tp_dtype_size(dtype);
  tp_bytes out = TP_BYTES_INIT;
  uint32_t crc = 0, back_crc = 1;
  uint8_t *back = malloc(bytes + 1);
  check(back != NULL);
  check(tp_encode(codec, dtype, columns, rows, data, &out, &crc) == TP_OK);
  check(tp_decode(codec, dtype, columns, rows, out.data, out.size, back, &back_crc, NULL) == TP_OK);
  check(crc == back_crc && (bytes == 0 || memcmp(back, data, bytes) == 0));
  tp_bytes_free(&out);
  free(back);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 4) return 0;
  const tp_codec codec = (tp_codec)(data[0] % TP_CODECS);
  const tp_dtype dtype = (tp_dtype)(data[1] % TP_DTYPES);
  const uint64_t columns = 1 + data[2] % 5, rows = data[3];
  const size_t bytes = (size_t)(rows * columns) * tp_dtype_size(dtype);
  tp_error error = {.code = TP_OK};
  uint32_t crc = 0;
  uint8_t *out = malloc(bytes != 0 ? bytes : 1);
  check(out != NULL);
  const tp_code code =
      tp_decode(codec, dtype, columns, rows, data + 4, size - 4, out, &crc, &error);
  check(code == TP_OK || (code == TP_E_UPLOAD && error.code == code));
  if (code == TP_OK) {
    check(crc == tp_crc32(0, out, bytes));
    round_trip(codec, dtype, columns, rows, out);
  }
  free(out);
  const uint64_t whole = (size - 4) / (columns * tp_dtype_size(dtype));
  round_trip(codec, dtype, columns, whole, data + 4);
  return 0;
}
