// SPDX-License-Identifier: Apache-2.0
/* Fuzzes tp_upload_check and tp_unpack: a line with the uploaded object, then the
 * body. What the check lets through and the opening accepts is packed and opened
 * again. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"
#include "protocol/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_BYTES = 1 << 20 };

static void check(int holds) {
  if (!holds) abort();
}

static void pack_again(const tp_arrays *set, tp_codec codec) {
  tp_bytes body = TP_BYTES_INIT;
  json_t *object = NULL;
  tp_arrays back = TP_ARRAYS_INIT;
  check(tp_pack(set, codec, &body, &object, NULL) == TP_OK);
  check(tp_upload_check(object, tp_schema_pls(), body.size, MAX_BYTES, NULL) == TP_OK);
  check(tp_unpack(object, tp_schema_pls(), body.data, body.size, MAX_BYTES, &back, NULL) == TP_OK);
  check(back.count == set->count);
  for (size_t i = 0; i < set->count; i++) {
    const tp_array *a = &set->items[i], *b = tp_arrays_find(&back, a->name);
    check(b != NULL && tp_array_bytes(a) == tp_array_bytes(b));
    check(tp_array_bytes(a) == 0 || memcmp(a->data, b->data, tp_array_bytes(a)) == 0);
  }
  tp_arrays_free(&back);
  json_decref(object);
  tp_bytes_free(&body);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const uint8_t *end = size != 0 ? memchr(data, '\n', size) : NULL;
  if (end == NULL) return 0;
  const size_t line = (size_t)(end - data);
  const size_t body_size = size - line - 1;
  json_t *object = json_loadb((const char *)data, line, JSON_REJECT_DUPLICATES, NULL);
  tp_arrays set = TP_ARRAYS_INIT;
  tp_error error = {.code = TP_OK};
  const tp_code checked = tp_upload_check(object, tp_schema_pls(), body_size, MAX_BYTES, &error);
  check(checked == TP_OK || (checked == TP_E_PARAMS && error.message[0] != '\0'));
  const tp_code opened =
      tp_unpack(object, tp_schema_pls(), end + 1, body_size, MAX_BYTES, &set, &error);
  check(opened == TP_OK || (opened == TP_E_UPLOAD && set.count == 0 && error.code == opened));
  if (opened == TP_OK) {
    check(checked == TP_OK);
    for (unsigned codec = 0; codec < TP_CODECS; codec++) pack_again(&set, (tp_codec)codec);
  }
  tp_arrays_free(&set);
  json_decref(object);
  return 0;
}
