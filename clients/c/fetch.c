// SPDX-License-Identifier: Apache-2.0
/* fetch.c: a result's arrays, chunk by chunk (PROTOCOL.md, 5.3 and mesh.fetch). Every
 * chunk and every whole array is checked against its CRC. */
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "clients/c/client_internal.h"
#include "protocol/message.h"

typedef struct part {
    tp_array_info info;
    tetrad_array array;
    unsigned char *data;
    uint64_t next; /* chunk expected */
    uint32_t crc;  /* of all rows so far */
} part;

struct tetrad_mesh {
    part *parts;
    size_t count;
};

typedef struct fetching {
    tetrad_client *client;
    tetrad_mesh *mesh;
    part *at; /* the array whose chunk is being read */
    uint64_t rows;
    uint32_t crc;
} fetching;

void tetrad_mesh_free(tetrad_mesh *mesh) {
    if (mesh != NULL) {
        for (size_t i = 0; i < mesh->count; i++) {
            free(mesh->parts[i].data);
        }
        free(mesh->parts);
        free(mesh);
    }
}

const tetrad_array *tetrad_mesh_array(const tetrad_mesh *mesh, size_t i) {
    return i < mesh->count ? &mesh->parts[i].array : NULL;
}

const tetrad_array *tetrad_mesh_find(const tetrad_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->count; i++) {
        if (strcmp(mesh->parts[i].info.name, name) == 0) {
            return &mesh->parts[i].array;
        }
    }
    return NULL;
}

static tetrad_status broken(tetrad_client *client, tetrad_error *error, const char *what) {
    client->broken = true;
    return tc_fail(error, TETRAD_E_PROTOCOL, "the server broke the protocol: %s", what);
}

static size_t row_bytes(const tp_array_info *info) {
    return (size_t)info->shape[1] * tp_dtype_size(info->dtype);
}

// The most bytes that a chunk of so many raw bytes can be encoded as.
static uint64_t encoded_limit(uint64_t raw) {
    return compressBound((uLong)raw) + 64;
}

static tetrad_status take_line(void *user, const tp_message *message, uint64_t *ret_limit,
                               tetrad_error *error) {
    fetching *f = user;
    const char *name = json_string_value(json_object_get(message->params, "array"));
    const json_t *chunk = json_object_get(message->params, "chunk");
    const json_t *rows = json_object_get(message->params, "rows");
    const json_t *crc = json_object_get(message->params, "crc32");
    f->at = NULL;
    if (strcmp(message->method, "mesh.chunk") != 0) {
        return TETRAD_OK;
    }
    for (size_t i = 0; name != NULL && i < f->mesh->count; i++) {
        if (strcmp(f->mesh->parts[i].info.name, name) == 0) {
            f->at = &f->mesh->parts[i];
        }
    }
    if (f->at == NULL || !json_is_integer(chunk) || !json_is_integer(rows) ||
        !json_is_integer(crc)) {
        return broken(f->client, error, "a chunk of an unknown array");
    }
    if (f->at->next >= f->at->info.chunks ||
        json_integer_value(chunk) != (json_int_t)f->at->next ||
        json_integer_value(rows) != (json_int_t)tp_array_info_rows(&f->at->info, f->at->next)) {
        return broken(f->client, error, "a chunk out of order");
    }
    f->rows = (uint64_t)json_integer_value(rows);
    f->crc = (uint32_t)json_integer_value(crc);
    *ret_limit = encoded_limit(f->rows * row_bytes(&f->at->info));
    return TETRAD_OK;
}

static tetrad_status take_body(void *user, const unsigned char *body, size_t size,
                               tetrad_error *error) {
    fetching *f = user;
    if (f->at == NULL) {
        return TETRAD_OK;
    }
    const tp_array_info *info = &f->at->info;
    const size_t bytes = row_bytes(info);
    unsigned char *to = f->at->data + (size_t)(f->at->next * info->rows_per_chunk) * bytes;
    uint32_t crc;
    const tp_code code = tp_decode(info->codec, info->dtype, info->shape[1], f->rows, body, size,
                                   to, &crc, NULL);
    if (code == TP_E_INTERNAL) {
        return tc_no_memory(error);
    }
    if (code != TP_OK || crc != f->crc) {
        return broken(f->client, error, "a chunk does not decode to its checksum");
    }
    f->at->crc = tp_crc32(f->at->crc, to, (size_t)f->rows * bytes);
    f->at->next++;
    return TETRAD_OK;
}

static bool is_wanted(const char *name, const char *const *names, size_t n_names) {
    for (size_t i = 0; i < n_names; i++) {
        if (strcmp(names[i], name) == 0) {
            return true;
        }
    }
    return names == NULL;
}

static bool is_listed(const tetrad_mesh *mesh, const char *name) {
    return tetrad_mesh_find(mesh, name) != NULL;
}

// Makes room for the wanted arrays of the job's table.
static tetrad_status prepare(fetching *f, const json_t *table, const char *const *names,
                             size_t n_names, tetrad_error *error) {
    const size_t n = json_array_size(table);
    f->mesh->parts = calloc(n > 0 ? n : 1, sizeof *f->mesh->parts);
    if (f->mesh->parts == NULL) {
        return tc_no_memory(error);
    }
    for (size_t i = 0; i < n; i++) {
        part *p = &f->mesh->parts[f->mesh->count];
        uint64_t bytes;
        if (tp_array_info_parse(json_array_get(table, i), &p->info, NULL) != TP_OK ||
            is_listed(f->mesh, p->info.name) ||
            tp_shape_bytes(p->info.dtype, p->info.shape, &bytes) != TP_OK) {
            return broken(f->client, error, "the table of arrays");
        }
        if (!is_wanted(p->info.name, names, n_names)) {
            continue;
        }
        p->data = malloc(bytes > 0 ? (size_t)bytes : 1);
        if (p->data == NULL) {
            return tc_no_memory(error);
        }
        p->array = (tetrad_array){p->info.name,
                                  (tetrad_dtype)p->info.dtype,
                                  p->info.ndim,
                                  {p->info.shape[0], p->info.shape[1]},
                                  p->data};
        f->mesh->count++;
    }
    for (size_t i = 0; i < n_names && names != NULL; i++) {
        if (!is_listed(f->mesh, names[i])) {
            return tc_fail(error, TETRAD_E_ARGUMENT, "the result has no array %s", names[i]);
        }
    }
    return TETRAD_OK;
}

static tetrad_status fetch_all(fetching *f, const char *job, tetrad_error *error) {
    const tc_listener listener = {take_line, take_body, f};
    json_t *result, *list = json_array();
    int failed = list == NULL;
    for (size_t i = 0; i < f->mesh->count && !failed; i++) {
        failed = json_array_append_new(list, json_string(f->mesh->parts[i].info.name));
    }
    json_t *params = failed ? NULL : json_pack("{s:s, s:O}", "job", job, "arrays", list);
    json_decref(list);
    if (params == NULL) {
        return tc_no_memory(error);
    }
    const tetrad_status status =
        tc_call(f->client, "mesh.fetch", params, NULL, &listener, &result, error);
    json_decref(params);
    if (status != TETRAD_OK) {
        return status;
    }
    json_decref(result);
    for (size_t i = 0; i < f->mesh->count; i++) {
        const part *p = &f->mesh->parts[i];
        if (p->next != p->info.chunks || p->crc != p->info.crc32) {
            return broken(f->client, error,
                          p->next != p->info.chunks ? "a chunk is missing"
                                                    : "an array does not match its checksum");
        }
    }
    return TETRAD_OK;
}

tetrad_status tetrad_fetch(tetrad_client *client, const char *job, const char *const *names,
                           size_t n_names, tetrad_mesh **ret_mesh, tetrad_error *error) {
    json_t *result, *params = json_pack("{s:s}", "job", job);
    if (params == NULL) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "the job's id is no UTF-8");
    }
    // The answer tells the arrays; it comes when the job has ended.
    tetrad_status status = tc_call(client, "job.wait", params, NULL, NULL, &result, error);
    json_decref(params);
    if (status != TETRAD_OK) {
        return status;
    }
    fetching f = {.client = client, .mesh = calloc(1, sizeof *f.mesh)};
    status = f.mesh == NULL
                 ? tc_no_memory(error)
                 : prepare(&f, json_object_get(result, "arrays"), names, n_names, error);
    json_decref(result);
    if (status == TETRAD_OK) {
        status = fetch_all(&f, job, error);
    }
    if (status != TETRAD_OK) {
        tetrad_mesh_free(f.mesh);
        return status;
    }
    *ret_mesh = f.mesh;
    return TETRAD_OK;
}
