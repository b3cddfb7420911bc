// SPDX-License-Identifier: Apache-2.0
/* message.c: array descriptors, nested lists, and the array table of results
 * (PROTOCOL.md, "Upload forms" and "The mesh"). */
#include "protocol/message.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"

/* ---- What a member of an upload says ---- */

typedef struct member {
  const char *name;
  const json_t *list; /* nested list, or NULL: a descriptor */
  tp_dtype dtype;
  unsigned ndim;
  uint64_t shape[2];
  uint64_t bytes;     /* decoded */
  tp_codec codec;
  uint64_t offset, size; /* in the body */
  bool has_crc;
  uint32_t crc;
} member;

typedef struct members {
  member *items;
  size_t count;
} members;

static bool read_u64(const json_t *value, uint64_t *ret) {
  const json_int_t number = json_integer_value(value);
  if (!json_is_integer(value) || number < 0 || number > TP_MAX_INTEGER) return false;
  *ret = (uint64_t)number;
  return true;
}

/* "shape": [rows] or [rows, columns]. */
static bool read_shape(const json_t *list, unsigned *ret_ndim, uint64_t ret_shape[2]) {
  const size_t ndim = json_array_size(list);
  if (ndim != 1 && ndim != 2) return false;
  uint64_t shape[2] = {0, 1};
  for (size_t i = 0; i < ndim; i++) {
    if (!read_u64(json_array_get(list, i), &shape[i])) return false;
  }
  *ret_ndim = (unsigned)ndim;
  memcpy(ret_shape, shape, sizeof shape);
  return true;
}

/* "at": [offset, bytes] within the body. */
static bool read_at(const json_t *list, uint64_t body_size, uint64_t *ret_offset,
                    uint64_t *ret_size) {
  uint64_t offset = 0, size = 0;
  if (json_array_size(list) != 2 || !read_u64(json_array_get(list, 0), &offset) ||
      !read_u64(json_array_get(list, 1), &size))
    return false;
  if (offset > body_size || size > body_size - offset) return false;
  *ret_offset = offset;
  *ret_size = size;
  return true;
}

static tp_code read_crc(const json_t *value, member *m, tp_error *error) {
  uint64_t crc = 0;
  if (value == NULL) return TP_OK;
  if (!read_u64(value, &crc) || crc > UINT32_MAX)
    return tp_fail(error, TP_E_PARAMS, m->name, "crc32 of %s is no 32-bit integer", m->name);
  m->has_crc = true;
  m->crc = (uint32_t)crc;
  return TP_OK;
}

static tp_code read_descriptor(const json_t *value, uint64_t body_size, member *m,
                               tp_error *error) {
  static const char *const known[] = {"dtype", "shape", "codec", "at", "crc32", NULL};
  const char *dtype = json_string_value(json_object_get(value, "dtype"));
  const json_t *codec = json_object_get(value, "codec");
  const char *codec_name = codec != NULL ? json_string_value(codec) : "raw";
  tp_error inner;
  if (tp_params_known(value, known, &inner) != TP_OK)
    return tp_fail(error, TP_E_PARAMS, m->name, "%s: %s", m->name, inner.message);
  if (dtype == NULL || !tp_dtype_of(dtype, &m->dtype))
    return tp_fail(error, TP_E_PARAMS, m->name, "dtype of %s is not known", m->name);
  if (!read_shape(json_object_get(value, "shape"), &m->ndim, m->shape))
    return tp_fail(error, TP_E_PARAMS, m->name, "shape of %s is no list of 1 or 2 sizes", m->name);
  if (codec_name == NULL || !tp_codec_of(codec_name, &m->codec))
    return tp_fail(error, TP_E_PARAMS, m->name, "codec of %s is not known", m->name);
  if (!read_at(json_object_get(value, "at"), body_size, &m->offset, &m->size))
    return tp_fail(error, TP_E_PARAMS, m->name, "at of %s is no range of the body", m->name);
  return read_crc(json_object_get(value, "crc32"), m, error);
}

/* The shape that a nested list has by its first row; its numbers are checked when
 * they are read. */
static tp_code read_list_shape(const json_t *list, const tp_field *field, member *m,
                               tp_error *error) {
  const json_t *first = json_array_get(list, 0);
  m->list = list;
  m->dtype = field->dtype;
  m->ndim = field->columns == 1 ? 1 : 2;
  m->shape[0] = json_array_size(list);
  m->shape[1] = field->columns != TP_ANY_COLUMNS ? field->columns : 1;
  if (first != NULL && m->ndim == 2) {
    if (!json_is_array(first))
      return tp_fail(error, TP_E_PARAMS, m->name, "%s is no list of lists", m->name);
    m->shape[1] = json_array_size(first);
  }
  return TP_OK;
}

static tp_code read_member(const char *name, const json_t *value, const tp_schema *schema,
                           uint64_t body_size, member *ret_member, tp_error *error) {
  const tp_field *field = tp_schema_find(schema, name);
  member m = {.name = name};
  tp_code code = TP_OK;
  if (field == NULL)
    return tp_fail(error, TP_E_PARAMS, name, "a %s has no array \"%.40s\"", schema->name, name);
  if (json_is_object(value)) {
    code = read_descriptor(value, body_size, &m, error);
  } else if (json_is_array(value)) {
    code = read_list_shape(value, field, &m, error);
  } else {
    code = tp_fail(error, TP_E_PARAMS, name, "%s is neither descriptor nor list", name);
  }
  if (code == TP_OK) code = tp_field_check(schema, name, m.dtype, m.ndim, m.shape, error);
  if (code != TP_OK) return code;
  if (tp_shape_bytes(m.dtype, m.shape, &m.bytes) != TP_OK)
    return tp_fail(error, TP_E_PARAMS, name, "the shape of %s is too large", name);
  if (m.list == NULL && !tp_codec_fits(m.codec, m.size, m.bytes))
    return tp_fail(error, TP_E_PARAMS, name,
                   "%" PRIu64 " bytes of %s cannot hold the declared %" PRIu64, m.size, name,
                   m.bytes);
  *ret_member = m;
  return TP_OK;
}

static int by_offset(const void *left, const void *right) {
  const member *a = left, *b = right;
  if (a->offset != b->offset) return a->offset < b->offset ? -1 : 1;
  return a->size < b->size ? -1 : a->size > b->size; /* empty ranges first */
}

/* Whether the descriptors' ranges tile the body. Sorts the members. */
static tp_code check_tiling(members *list, uint64_t body_size, tp_error *error) {
  uint64_t end = 0;
  if (list->count != 0) qsort(list->items, list->count, sizeof *list->items, by_offset);
  for (size_t i = 0; i < list->count; i++) {
    const member *m = &list->items[i];
    if (m->list != NULL || m->size == 0) continue;
    if (m->offset != end)
      return tp_fail(error, TP_E_PARAMS, m->name, "the range of %s %s at %" PRIu64, m->name,
                     m->offset < end ? "overlaps another" : "leaves a gap before it", m->offset);
    end += m->size;
  }
  if (end != body_size)
    return tp_fail(error, TP_E_PARAMS, "body", "%" PRIu64 " bytes of the body belong to no array",
                   body_size - end);
  return TP_OK;
}

/* Reads all members of an upload in its first form. *ret_list is the caller's (free). */
static tp_code read_members(const json_t *object, const tp_schema *schema, uint64_t body_size,
                            uint64_t max_bytes, members *ret_list, tp_error *error) {
  members list = {calloc(json_object_size(object) + 1, sizeof(member)), 0};
  json_t *open = (json_t *)(uintptr_t)object; /* jansson's iterators take no const */
  uint64_t total = 0;
  tp_code code = TP_OK;
  if (list.items == NULL) return tp_fail(error, TP_E_INTERNAL, NULL, "out of memory");
  for (void *at = json_object_iter(open); at != NULL && code == TP_OK;
       at = json_object_iter_next(open, at)) {
    member *m = &list.items[list.count++];
    code = read_member(json_object_iter_key(at), json_object_iter_value(at), schema, body_size, m,
                       error);
    if (code == TP_OK && m->bytes > max_bytes - total)
      code = tp_fail(error, TP_E_PARAMS, m->name,
                     "the arrays together exceed %" PRIu64 " bytes at %s", max_bytes, m->name);
    if (code == TP_OK) total += m->bytes;
  }
  if (code == TP_OK) code = check_tiling(&list, body_size, error);
  if (code != TP_OK) {
    free(list.items);
    return code;
  }
  *ret_list = list;
  return TP_OK;
}

/* The required arrays are there: all that can be said before the data is. */
static tp_code check_required(const json_t *object, const tp_schema *schema, tp_error *error) {
  for (size_t i = 0; i < schema->count; i++) {
    const char *name = schema->fields[i].name;
    if (schema->fields[i].required && json_object_get(object, name) == NULL)
      return tp_fail(error, TP_E_PARAMS, name, "%s is missing", name);
  }
  return TP_OK;
}

/* {"json":{"at":[0,body_size]}}: *ret_is tells whether the upload has that form. */
static tp_code check_json_form(const json_t *object, uint64_t body_size, bool *ret_is,
                               tp_error *error) {
  static const char *const known[] = {"at", NULL};
  const json_t *text = json_object_get(object, "json");
  uint64_t offset = 0, size = 0;
  *ret_is = text != NULL;
  if (text == NULL) return TP_OK;
  if (json_object_size(object) != 1 || !json_is_object(text) ||
      tp_params_known(text, known, NULL) != TP_OK ||
      !read_at(json_object_get(text, "at"), body_size, &offset, &size) || offset != 0 ||
      size != body_size)
    return tp_fail(error, TP_E_PARAMS, "json",
                   "json stands alone and is {\"at\":[0,%" PRIu64 "]}, the whole body", body_size);
  return TP_OK;
}

tp_code tp_upload_check(const json_t *object, const tp_schema *schema, uint64_t body_size,
                        uint64_t max_bytes, tp_error *error) {
  bool is_text = false;
  members list = {NULL, 0};
  if (!json_is_object(object))
    return tp_fail(error, TP_E_PARAMS, schema->name, "%s is no object", schema->name);
  tp_code code = check_json_form(object, body_size, &is_text, error);
  if (code != TP_OK || is_text) return code;
  code = read_members(object, schema, body_size, max_bytes, &list, error);
  free(list.items);
  return code == TP_OK ? check_required(object, schema, error) : code;
}

/* ---- Opening an upload ---- */

/* Element i of `out`, of a nested list's number. */
static bool write_number(const json_t *value, tp_dtype dtype, uint64_t i, void *out) {
  const json_int_t number = json_integer_value(value);
  switch (dtype) {
    case TP_F8:
      ((double *)out)[i] = json_number_value(value);
      return json_is_number(value);
    case TP_F4:
      ((float *)out)[i] = (float)json_number_value(value);
      return json_is_number(value);
    case TP_U4:
      ((uint32_t *)out)[i] = (uint32_t)number;
      return json_is_integer(value) && number >= 0 && number <= UINT32_MAX;
    case TP_I4:
      ((int32_t *)out)[i] = (int32_t)number;
      return json_is_integer(value) && number >= INT32_MIN && number <= INT32_MAX;
    case TP_U8:
      ((uint64_t *)out)[i] = (uint64_t)number;
      return json_is_integer(value) && number >= 0;
    case TP_U1:
      ((uint8_t *)out)[i] = (uint8_t)number;
      return json_is_integer(value) && number >= 0 && number <= UINT8_MAX;
  }
  return false;
}

static tp_code read_list(const member *m, void *out, tp_error *error) {
  for (uint64_t r = 0; r < m->shape[0]; r++) {
    const json_t *row = json_array_get(m->list, (size_t)r);
    if (m->ndim == 2 && json_array_size(row) != m->shape[1])
      return tp_fail(error, TP_E_UPLOAD, m->name, "row %" PRIu64 " of %s has not %" PRIu64
                     " numbers", r, m->name, m->shape[1]);
    for (uint64_t c = 0; c < m->shape[1]; c++) {
      const json_t *value = m->ndim == 2 ? json_array_get(row, (size_t)c) : row;
      if (!write_number(value, m->dtype, r * m->shape[1] + c, out))
        return tp_fail(error, TP_E_UPLOAD, m->name, "row %" PRIu64 " of %s does not fit %s", r,
                       m->name, tp_dtype_name(m->dtype));
    }
  }
  return TP_OK;
}

static tp_code open_member(const member *m, const unsigned char *body, tp_arrays *set,
                           tp_error *error) {
  void *out = NULL;
  uint32_t crc = 0;
  tp_error inner;
  tp_code code = tp_arrays_new(set, m->name, m->dtype, m->shape[0],
                               m->ndim == 2 ? m->shape[1] : 0, &out, error);
  if (code != TP_OK) return code;
  if (m->list != NULL) return read_list(m, out, error);
  const unsigned char *in = m->size != 0 ? body + m->offset : NULL;
  code = tp_decode(m->codec, m->dtype, m->shape[1], m->shape[0], in, (size_t)m->size, out, &crc,
                   &inner);
  if (code != TP_OK) return tp_fail(error, code, m->name, "%s: %s", m->name, inner.message);
  if (m->has_crc && crc != m->crc)
    return tp_fail(error, TP_E_UPLOAD, m->name, "the CRC-32 of %s is not the given one", m->name);
  return TP_OK;
}

/* Opens the members of `object`; `where` stays the array's. */
static tp_code open_members(const json_t *object, const tp_schema *schema, const void *body,
                            size_t body_size, uint64_t max_bytes, tp_arrays *set,
                            tp_error *error) {
  members list = {NULL, 0};
  tp_code code = read_members(object, schema, body_size, max_bytes, &list, error);
  for (size_t i = 0; i < list.count && code == TP_OK; i++) {
    code = open_member(&list.items[i], body, set, error);
  }
  free(list.items);
  return code;
}

/* JSON text in the body, as an object of nested lists. */
static tp_code open_text(const tp_schema *schema, const void *body, size_t body_size,
                         uint64_t max_bytes, tp_arrays *set, tp_error *error) {
  json_error_t report;
  json_t *object = json_loadb(body_size != 0 ? body : "", body_size, JSON_REJECT_DUPLICATES,
                              &report);
  tp_code code = TP_OK;
  if (object == NULL && json_error_code(&report) == json_error_out_of_memory)
    return tp_fail(error, TP_E_INTERNAL, "json", "out of memory");
  if (object == NULL)
    return tp_fail(error, TP_E_UPLOAD, "json", "the JSON text breaks at line %d, column %d: %s",
                   report.line, report.column, report.text);
  if (!json_is_object(object)) {
    code = tp_fail(error, TP_E_UPLOAD, "json", "the JSON text is no object");
  } else if (tp_json_depth(object) > TP_MAX_DEPTH) {
    code = tp_fail(error, TP_E_UPLOAD, "json", "the JSON text nests deeper than %d", TP_MAX_DEPTH);
  } else {
    code = open_members(object, schema, NULL, 0, max_bytes, set, error);
  }
  json_decref(object);
  return code;
}

tp_code tp_unpack(const json_t *object, const tp_schema *schema, const void *body,
                  size_t body_size, uint64_t max_bytes, tp_arrays *ret_set, tp_error *error) {
  tp_arrays set = TP_ARRAYS_INIT;
  bool is_text = false;
  if (!json_is_object(object))
    return tp_fail(error, TP_E_UPLOAD, schema->name, "%s is no object", schema->name);
  tp_code code = check_json_form(object, body_size, &is_text, error);
  if (code == TP_OK) {
    code = is_text ? open_text(schema, body, body_size, max_bytes, &set, error)
                   : open_members(object, schema, body, body_size, max_bytes, &set, error);
  }
  if (code == TP_OK) code = tp_arrays_validate(&set, schema, error);
  if (code != TP_OK) {
    tp_arrays_free(&set);
    if (code == TP_E_PARAMS) code = TP_E_UPLOAD; /* past the request, in the job */
    if (error != NULL) error->code = code;
    return code;
  }
  *ret_set = set;
  return TP_OK;
}

/* ---- Packing ---- */

static json_t *shape_json(unsigned ndim, const uint64_t shape[2]) {
  return ndim == 1 ? json_pack("[I]", (json_int_t)shape[0])
                   : json_pack("[I, I]", (json_int_t)shape[0], (json_int_t)shape[1]);
}

static tp_code pack_array(const tp_array *array, tp_codec codec, tp_bytes *body, size_t start,
                          json_t *object) {
  const size_t offset = body->size;
  uint32_t crc = 0;
  const tp_code code = tp_encode(codec, array->dtype, array->shape[1], array->shape[0],
                                 array->data, body, &crc);
  if (code != TP_OK) return code;
  json_t *descriptor =
      json_pack("{s:s, s:o, s:s, s:[I, I], s:I}", "dtype", tp_dtype_name(array->dtype), "shape",
                shape_json(array->ndim, array->shape), "codec", tp_codec_name(codec), "at",
                (json_int_t)(offset - start), (json_int_t)(body->size - offset), "crc32",
                (json_int_t)crc);
  return json_object_set_new(object, array->name, descriptor) == 0 ? TP_OK : TP_E_INTERNAL;
}

tp_code tp_pack(const tp_arrays *set, tp_codec codec, tp_bytes *body, json_t **ret_object,
                tp_error *error) {
  const size_t start = body->size;
  json_t *object = json_object();
  tp_code code = object != NULL ? TP_OK : TP_E_INTERNAL;
  for (size_t i = 0; i < set->count && code == TP_OK; i++) {
    code = pack_array(&set->items[i], codec, body, start, object);
  }
  if (code != TP_OK) {
    json_decref(object);
    body->size = start;
    return tp_fail(error, code, NULL, "out of memory");
  }
  *ret_object = object;
  return TP_OK;
}

/* ---- The array table of results ---- */

void tp_array_info_of(const tp_array *array, tp_codec codec, tp_array_info *ret_info) {
  tp_array_info info = {.dtype = array->dtype, .ndim = array->ndim, .codec = codec};
  memcpy(info.name, array->name, sizeof info.name);
  memcpy(info.shape, array->shape, sizeof info.shape);
  info.rows_per_chunk = tp_chunk_rows(array->dtype, array->shape[1]);
  info.chunks = tp_chunk_count(array->shape[0], info.rows_per_chunk);
  info.crc32 = tp_crc32(0, array->data, tp_array_bytes(array));
  *ret_info = info;
}

json_t *tp_array_info_json(const tp_array_info *info) {
  return json_pack("{s:s, s:s, s:o, s:s, s:I, s:I, s:I}", "name", info->name, "dtype",
                   tp_dtype_name(info->dtype), "shape", shape_json(info->ndim, info->shape),
                   "codec", tp_codec_name(info->codec), "rows_per_chunk",
                   (json_int_t)info->rows_per_chunk, "chunks", (json_int_t)info->chunks, "crc32",
                   (json_int_t)info->crc32);
}

tp_code tp_array_info_parse(const json_t *json, tp_array_info *ret_info, tp_error *error) {
  tp_array_info info = {.name = ""};
  uint64_t crc = 0, bytes = 0;
  const char *name = json_string_value(json_object_get(json, "name"));
  const char *dtype = json_string_value(json_object_get(json, "dtype"));
  const char *codec = json_string_value(json_object_get(json, "codec"));
  if (name == NULL || name[0] == '\0' || strlen(name) >= TP_NAME_SIZE)
    return tp_fail(error, TP_E_PARAMS, "arrays", "a row of the array table has no name");
  if (dtype == NULL || !tp_dtype_of(dtype, &info.dtype) || codec == NULL ||
      !tp_codec_of(codec, &info.codec) ||
      !read_shape(json_object_get(json, "shape"), &info.ndim, info.shape) ||
      info.shape[1] == 0 || tp_shape_bytes(info.dtype, info.shape, &bytes) != TP_OK ||
      !read_u64(json_object_get(json, "rows_per_chunk"), &info.rows_per_chunk) ||
      info.rows_per_chunk == 0 || !read_u64(json_object_get(json, "chunks"), &info.chunks) ||
      info.chunks != tp_chunk_count(info.shape[0], info.rows_per_chunk) ||
      !read_u64(json_object_get(json, "crc32"), &crc) || crc > UINT32_MAX)
    return tp_fail(error, TP_E_PARAMS, name, "the array table's row of %s makes no sense", name);
  memcpy(info.name, name, strlen(name) + 1);
  info.crc32 = (uint32_t)crc;
  *ret_info = info;
  return TP_OK;
}

uint64_t tp_array_info_rows(const tp_array_info *info, uint64_t chunk) {
  const uint64_t before = chunk * info->rows_per_chunk;
  const uint64_t left = info->shape[0] - before;
  return left < info->rows_per_chunk ? left : info->rows_per_chunk;
}
