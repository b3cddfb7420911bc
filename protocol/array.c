// SPDX-License-Identifier: Apache-2.0
/* array.c: typed arrays and sets of them. The schemas are in schema.c. */
#include "protocol/array.h"

#include <stdlib.h>
#include <string.h>

#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "array data goes to the wire as it lies in memory: little-endian machines only"
#endif

static const char *const dtype_names[TP_DTYPES] = {"<f8", "<f4", "<u4", "<i4", "<u8", "|u1"};
static const size_t dtype_sizes[TP_DTYPES] = {8, 4, 4, 4, 8, 1};

const char *tp_dtype_name(tp_dtype dtype) { return dtype_names[dtype]; }

size_t tp_dtype_size(tp_dtype dtype) { return dtype_sizes[dtype]; }

bool tp_dtype_of(const char *name, tp_dtype *ret_dtype) {
  for (unsigned i = 0; i < TP_DTYPES; i++) {
    if (strcmp(name, dtype_names[i]) == 0) {
      *ret_dtype = (tp_dtype)i;
      return true;
    }
  }
  return false;
}

tp_code tp_shape_bytes(tp_dtype dtype, const uint64_t shape[2], uint64_t *ret_bytes) {
  const uint64_t most = TP_MAX_INTEGER / dtype_sizes[dtype];
  if (shape[0] > most || shape[1] > most) return TP_E_PARAMS;
  if (shape[1] != 0 && shape[0] > most / shape[1]) return TP_E_PARAMS;
  *ret_bytes = shape[0] * shape[1] * dtype_sizes[dtype];
  return TP_OK;
}

size_t tp_array_bytes(const tp_array *array) {
  return (size_t)(array->shape[0] * array->shape[1]) * dtype_sizes[array->dtype];
}

void tp_arrays_free(tp_arrays *set) {
  for (size_t i = 0; i < set->count; i++) {
    if (set->items[i].owned) free(set->items[i].data);
  }
  free(set->items);
  *set = (tp_arrays)TP_ARRAYS_INIT;
}

const tp_array *tp_arrays_find(const tp_arrays *set, const char *name) {
  for (size_t i = 0; i < set->count; i++) {
    if (strcmp(set->items[i].name, name) == 0) return &set->items[i];
  }
  return NULL;
}

const void *tp_arrays_data(const tp_arrays *set, const char *name, uint64_t *ret_rows) {
  const tp_array *array = tp_arrays_find(set, name);
  if (ret_rows != NULL) *ret_rows = array != NULL ? array->shape[0] : 0;
  if (array == NULL) return NULL;
  return array->data != NULL ? array->data : (const void *)array->name;
}

/* Names are [a-z0-9_]+: they stand in JSON, file names and log lines unescaped. */
static bool name_fits(const char *name) {
  const size_t length = strlen(name);
  return length > 0 && length < TP_NAME_SIZE &&
         strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_") == length;
}

/* Appends an entry; the one way into a set. */
static tp_code set_add(tp_arrays *set, const tp_array *entry, const char *name, tp_error *error) {
  uint64_t bytes = 0;
  if (!name_fits(name)) return tp_fail(error, TP_E_PARAMS, name, "\"%.40s\" is no array name", name);
  if (tp_arrays_find(set, name) != NULL)
    return tp_fail(error, TP_E_PARAMS, name, "array %s is there twice", name);
  if (tp_shape_bytes(entry->dtype, entry->shape, &bytes) != TP_OK || bytes > SIZE_MAX / 2)
    return tp_fail(error, TP_E_PARAMS, name, "the shape of %s is too large", name);
  if (set->count == set->capacity) {
    const size_t capacity = set->capacity != 0 ? 2 * set->capacity : 16;
    tp_array *items = realloc(set->items, capacity * sizeof *items);
    if (items == NULL) return tp_fail(error, TP_E_INTERNAL, name, "out of memory");
    set->items = items;
    set->capacity = capacity;
  }
  tp_array *item = &set->items[set->count++];
  *item = *entry;
  memcpy(item->name, name, strlen(name) + 1);
  return TP_OK;
}

static tp_array make_entry(tp_dtype dtype, uint64_t rows, uint64_t columns, void *data, bool owned) {
  tp_array entry = {.dtype = dtype, .ndim = columns != 0 ? 2 : 1, .data = data, .owned = owned};
  entry.shape[0] = rows;
  entry.shape[1] = columns != 0 ? columns : 1;
  return entry;
}

tp_code tp_arrays_borrow(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                         uint64_t columns, const void *data, tp_error *error) {
  /* A borrowed array is never written through: the set's readers see const arrays. */
  union {
    const void *in;
    void *out;
  } pointer = {.in = data};
  const tp_array entry = make_entry(dtype, rows, columns, pointer.out, false);
  return set_add(set, &entry, name, error);
}

tp_code tp_arrays_own(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                      uint64_t columns, void *data, tp_error *error) {
  const tp_array entry = make_entry(dtype, rows, columns, data, true);
  return set_add(set, &entry, name, error);
}

tp_code tp_arrays_new(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                      uint64_t columns, void **ret_data, tp_error *error) {
  tp_array entry = make_entry(dtype, rows, columns, NULL, true);
  uint64_t bytes = 0;
  if (tp_shape_bytes(dtype, entry.shape, &bytes) != TP_OK || bytes > SIZE_MAX / 2)
    return tp_fail(error, TP_E_PARAMS, name, "the shape of %s is too large", name);
  entry.data = calloc(bytes != 0 ? (size_t)bytes : 1, 1);
  if (entry.data == NULL) return tp_fail(error, TP_E_INTERNAL, name, "out of memory");
  const tp_code code = set_add(set, &entry, name, error);
  if (code != TP_OK) {
    free(entry.data);
    return code;
  }
  *ret_data = entry.data;
  return TP_OK;
}
