// SPDX-License-Identifier: Apache-2.0
/* read.c: which reader a file needs, and the file's bytes. Formats are elsewhere. */
#include "clients/formats/readers.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const struct {
    const char *extension;
    tf_format format;
} formats[] = {{".node", TF_NODE}, {".poly", TF_POLY}, {".smesh", TF_SMESH},
               {".off", TF_OFF},   {".stl", TF_STL},   {".ply", TF_PLY},
               {".obj", TF_OBJ},   {".mesh", TF_MEDIT}, {".vtu", TF_VTU}};

static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    return dot != NULL ? dot : name + strlen(name);
}

tf_status tf_format_of(const char *path, tf_format *ret_format, tf_error *error) {
    const char *extension = extension_of(path);
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (strcasecmp(extension, formats[i].extension) == 0) {
            *ret_format = formats[i].format;
            return TF_OK;
        }
    }
    return tf_error_set(error, TF_E_FORMAT, "%s: the extension '%s' is of no format known here",
                        path, extension);
}

void tf_pls_free(tf_pls *pls) {
    tp_arrays_free(&pls->arrays);
}

// Reads a text format: opens the cursors, lets the format read, gathers its failure.
static tf_status parse_text(tf_format format, const tf_file *file, const tf_file *nodes,
                            tf_build *build, int *ret_first, tf_error *error) {
    tf_text text, node_text;
    tf_status status = tf_text_open(file, true, &text, error);
    if (status != TF_OK) {
        return status;
    }
    if (nodes != NULL && (status = tf_text_open(nodes, true, &node_text, error)) != TF_OK) {
        tf_text_close(&text);
        return status;
    }
    switch (format) {
    case TF_NODE: tf_read_node_text(&text, build, ret_first); break;
    case TF_POLY:
    case TF_SMESH:
        tf_read_poly_text(&text, nodes != NULL ? &node_text : NULL, format == TF_SMESH, build,
                          ret_first);
        break;
    case TF_OFF: tf_read_off_text(&text, build); break;
    case TF_OBJ: tf_read_obj_text(&text, build); break;
    default: tf_read_medit_text(&text, build); break;
    }
    if (nodes != NULL) {
        tf_text_close(&node_text);
    }
    tf_text_close(&text);
    return text.failed ? error->status : TF_OK;
}

tf_status tf_parse(tf_format format, const tf_file *file, const tf_file *nodes, tf_pls *ret_pls,
                   tf_error *error) {
    tf_build build = {0};
    tf_pls pls = {TP_ARRAYS_INIT, format == TF_OBJ || format == TF_MEDIT ? 1 : 0};
    tf_error local = {TF_OK, 0, ""};
    tf_status status;
    switch (format) {
    case TF_VTU:
        return tf_error_set(error, TF_E_FORMAT, "%s: .vtu files are written, not read", file->name);
    case TF_STL: status = tf_read_stl(file, &build, &local); break;
    case TF_PLY: status = tf_read_ply(file, &build, &local); break;
    default: status = parse_text(format, file, nodes, &build, &pls.first_index, &local); break;
    }
    if (status == TF_OK && build.points.count == 0 && !build.no_memory) {
        status = tf_error_set(&local, TF_E_MALFORMED, "%s: there are no points in the file",
                              file->name);
    }
    if (status == TF_OK) {
        status = tf_build_finish(&build, &pls.arrays, &local);
    }
    tf_build_free(&build);
    if (status == TF_OK) {
        *ret_pls = pls;
    } else if (error != NULL) {
        *error = local;
    }
    return status;
}

bool tf_wants_nodes(const tf_file *file) {
    tf_error error;
    tf_text text;
    tf_token token;
    double count = 1;
    if (tf_text_open(file, true, &text, &error) == TF_OK) {
        if (tf_text_seek(&text) && tf_text_token(&text, &token)) {
            tf_token_real(&text, token, &count);
        }
        tf_text_close(&text);
    }
    return count == 0;
}

static tf_status load(const char *path, tf_file *ret_file, tf_error *error) {
    struct stat status;
    FILE *stream = fopen(path, "rbe");
    if (stream == NULL || fstat(fileno(stream), &status) != 0 || S_ISDIR(status.st_mode)) {
        const int reason = stream == NULL ? errno : EISDIR;
        if (stream != NULL) {
            fclose(stream);
        }
        return tf_error_set(error, TF_E_OPEN, "%s: cannot be read: %s", path, strerror(reason));
    }
    // One more byte than a regular file has, so that its end is seen without growing.
    size_t size = 0, capacity = (status.st_size > 0 ? (size_t)status.st_size : 65536) + 2, got;
    char *bytes = malloc(capacity);
    while (bytes != NULL && (got = fread(bytes + size, 1, capacity - size - 1, stream)) > 0) {
        size += got;
        if (size == capacity - 1) {
            char *larger = realloc(bytes, capacity * 2);
            if (larger == NULL) {
                free(bytes);
            }
            bytes = larger;
            capacity *= 2;
        }
    }
    const bool failed = ferror(stream) != 0;
    fclose(stream);
    if (bytes == NULL) {
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", path);
    }
    if (failed) {
        free(bytes);
        return tf_error_set(error, TF_E_OPEN, "%s: cannot be read: %s", path, strerror(EIO));
    }
    bytes[size] = '\0';
    *ret_file = (tf_file){path, bytes, size};
    return TF_OK;
}

static void unload(tf_file *file) {
    free((void *)(uintptr_t)file->bytes);
}

// "dir/name.poly" -> "dir/name.node"; NULL: no memory.
static char *node_path(const char *path) {
    const size_t stem = (size_t)(extension_of(path) - path);
    char *name = malloc(stem + sizeof ".node");
    if (name != NULL) {
        memcpy(name, path, stem);
        memcpy(name + stem, ".node", sizeof ".node");
    }
    return name;
}

tf_status tf_read(const char *path, tf_pls *ret_pls, tf_error *error) {
    tf_format format;
    tf_file file, nodes;
    char *beside = NULL;
    tf_status status = tf_format_of(path, &format, error);
    if (status != TF_OK || (status = load(path, &file, error)) != TF_OK) {
        return status;
    }
    const bool wants_nodes = (format == TF_POLY || format == TF_SMESH) && tf_wants_nodes(&file);
    if (wants_nodes) {
        beside = node_path(path);
        status = beside == NULL ? tf_error_set(error, TF_E_MEMORY, "%s: no memory", path)
                                : load(beside, &nodes, error);
    }
    if (status == TF_OK) {
        status = tf_parse(format, &file, wants_nodes ? &nodes : NULL, ret_pls, error);
        if (wants_nodes) {
            unload(&nodes);
        }
    }
    free(beside);
    unload(&file);
    return status;
}
