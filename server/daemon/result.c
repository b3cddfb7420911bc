// SPDX-License-Identifier: Apache-2.0
/* result.c: see result.h. */
#include "server/daemon/result.h"

#include <stdlib.h>
#include <string.h>

result *result_create(spool *s, spool_file_fn fn, void *user) {
  result *r = calloc(1, sizeof *r);
  if (!r) return NULL;
  r->refs = 1;
  r->file = spool_file_create(s, fn, user);
  if (r->file) return r;
  free(r);
  return NULL;
}

result *result_ref(result *r) {
  r->refs++;
  return r;
}

void result_unref(result *r) {
  if (!r || --r->refs) return;
  spool_file_drop(r->file);
  for (size_t i = 0; i < r->n_arrays; i++) free(r->arrays[i].chunks);
  free(r->arrays);
  free(r);
}

/* The array being filled: the last one, or a new one of that name. */
static result_array *filling(result *r, const char *name) {
  if (r->n_arrays && !strcmp(r->arrays[r->n_arrays - 1].info.name, name))
    return &r->arrays[r->n_arrays - 1];
  if (result_find(r, name) || strlen(name) >= TP_NAME_SIZE) return NULL;
  result_array *arrays = realloc(r->arrays, (r->n_arrays + 1) * sizeof *arrays);
  if (!arrays) return NULL;
  r->arrays = arrays;
  result_array *a = &arrays[r->n_arrays++];
  *a = (result_array){.chunks = NULL};
  strcpy(a->info.name, name);
  return a;
}

bool result_add(result *r, const char *name, uint64_t chunk, const result_chunk *at) {
  result_array *a = filling(r, name);
  if (!a || chunk != a->count) return false;
  if (a->count == a->capacity) {
    size_t capacity = a->capacity ? a->capacity * 2 : 4;
    result_chunk *chunks = realloc(a->chunks, capacity * sizeof *chunks);
    if (!chunks) return false;
    a->chunks = chunks;
    a->capacity = capacity;
  }
  a->chunks[a->count++] = *at;
  return true;
}

static result_array *take(result *r, const char *name) {
  for (size_t i = 0; i < r->n_arrays; i++)
    if (!strcmp(r->arrays[i].info.name, name)) return &r->arrays[i];
  return NULL;
}

static tp_code check_array(const result_array *a, tp_error *error) {
  if (a->count != a->info.chunks)
    return tp_fail(error, TP_E_PARAMS, a->info.name, "%s: %zu chunks came, not %llu", a->info.name,
                   a->count, (unsigned long long)a->info.chunks);
  for (size_t i = 0; i < a->count; i++)
    if (a->chunks[i].rows != tp_array_info_rows(&a->info, i))
      return tp_fail(error, TP_E_PARAMS, a->info.name, "%s: chunk %zu has %u rows", a->info.name, i,
                     a->chunks[i].rows);
  return TP_OK;
}

tp_code result_complete(result *r, const json_t *table, tp_error *error) {
  size_t n = json_array_size(table), seen = 0;
  result_array *arrays = calloc(n ? n : 1, sizeof *arrays);
  if (!arrays) return tp_fail(error, TP_E_INTERNAL, NULL, "no memory for the array table");
  tp_code code = json_is_array(table) ? TP_OK
                                      : tp_fail(error, TP_E_PARAMS, "arrays", "no array table");
  for (size_t i = 0; i < n && code == TP_OK; i++) {
    code = tp_array_info_parse(json_array_get(table, i), &arrays[i].info, error);
    result_array *came = code == TP_OK ? take(r, arrays[i].info.name) : NULL;
    for (size_t j = 0; j < i && code == TP_OK; j++)
      if (!strcmp(arrays[j].info.name, arrays[i].info.name))
        code =
            tp_fail(error, TP_E_PARAMS, "arrays", "%s is twice in the table", arrays[i].info.name);
    if (!came || code != TP_OK) continue;
    tp_array_info info = arrays[i].info;
    arrays[i] = *came;
    arrays[i].info = info;
    seen++;
  }
  for (size_t i = 0; i < n && code == TP_OK; i++) code = check_array(&arrays[i], error);
  if (code == TP_OK && seen != r->n_arrays)
    code = tp_fail(error, TP_E_PARAMS, "arrays", "chunks of an array that is not in the table");
  if (code != TP_OK) {
    free(arrays);
    return code;
  }
  free(r->arrays);
  r->arrays = arrays;
  r->n_arrays = n;
  return TP_OK;
}

const result_array *result_find(const result *r, const char *name) {
  return take((result *)(uintptr_t)r, name);
}
