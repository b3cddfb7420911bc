// SPDX-License-Identifier: Apache-2.0
/* write.c: which files a mesh becomes, by the output's extension. The formats are
 * elsewhere. */
#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "clients/formats/mesh_view.h"

typedef void (*tetgen_writer)(FILE *file, const tf_mesh *mesh, int first);

static const struct {
    const char *extension;
    tetgen_writer write;
} tetgen_files[] = {{".node", tf_write_node},
                    {".ele", tf_write_ele},
                    {".face", tf_write_face},
                    {".edge", tf_write_edge},
                    {".neigh", tf_write_neigh}};

enum { TETGEN_FILES = 5 };

static tf_status output_format(const char *path, tf_format *ret_format, tf_error *error) {
    tf_format format = TF_NODE;
    const tf_status status = tf_format_of(path, &format, error);
    if (status != TF_OK) {
        return status;
    }
    if (format != TF_NODE && format != TF_MEDIT && format != TF_VTU && format != TF_OFF) {
        return tf_error_set(error, TF_E_FORMAT,
                            "%s: meshes are written as .node, .mesh, .vtu or .off", path);
    }
    *ret_format = format;
    return TF_OK;
}

// File i of TetGen's: the path itself for .node, the others beside it; NULL: no memory.
static char *tetgen_path(const char *path, int i) {
    const size_t stem = strlen(path) - (i == 0 ? 0 : strlen(".node"));
    char *name = malloc(stem + sizeof ".neigh");
    if (name != NULL) {
        memcpy(name, path, stem);
        strcpy(name + stem, i == 0 ? "" : tetgen_files[i].extension);
    }
    return name;
}

tf_status tf_write_check(const char *path, bool neighbours, tf_error *error) {
    tf_format format = TF_NODE;
    tf_status status = output_format(path, &format, error);
    if (status != TF_OK || format != TF_NODE) {
        return status == TF_OK ? tf_output_check(path, error) : status;
    }
    for (int i = 0; i < TETGEN_FILES - !neighbours && status == TF_OK; i++) {
        char *name = tetgen_path(path, i);
        status = name == NULL ? tf_error_set(error, TF_E_MEMORY, "%s: no memory", path)
                              : tf_output_check(name, error);
        free(name);
    }
    return status;
}

static tf_status write_tetgen(tf_outputs *set, const char *path, const tf_mesh *mesh, int first,
                              tf_error *error) {
    tf_status status = TF_OK;
    for (int i = 0; i < TETGEN_FILES - (mesh->neighbours == NULL) && status == TF_OK; i++) {
        FILE *file;
        char *name = tetgen_path(path, i);
        status = name == NULL ? tf_error_set(error, TF_E_MEMORY, "%s: no memory", path)
                              : tf_outputs_add(set, name, &file, error);
        if (status == TF_OK) {
            tetgen_files[i].write(file, mesh, first);
        }
        free(name);
    }
    return status;
}

tf_status tf_write_mesh(tf_outputs *set, const char *path, const tp_arrays *mesh, int first_index,
                        tf_error *error) {
    tf_format format = TF_NODE;
    tf_mesh view;
    FILE *file;
    tf_status status = output_format(path, &format, error);
    if (status != TF_OK || (status = tf_mesh_view(mesh, path, &view, error)) != TF_OK) {
        return status;
    }
    // The caller's thread may use another decimal point.
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0) {
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", path);
    }
    const locale_t before = uselocale(c_locale);
    if (format == TF_NODE) {
        status = write_tetgen(set, path, &view, first_index, error);
    } else if ((status = tf_outputs_add(set, path, &file, error)) == TF_OK) {
        if (format == TF_MEDIT) {
            tf_write_medit(file, &view);
        } else if (format == TF_OFF) {
            tf_write_off(file, &view);
        } else {
            status = tf_write_vtu(file, &view, path, error);
        }
    }
    uselocale(before);
    freelocale(c_locale);
    return status;
}
