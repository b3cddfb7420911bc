// SPDX-License-Identifier: Apache-2.0
/* write.c: which files a mesh becomes, by the output's extension. The formats are
 * elsewhere. */
#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "clients/formats/mesh_view.h"

typedef void (*tetgen_writer)(FILE *file, const tf_mesh *mesh, int first);

// What a mesh must have for a file to be there.
enum { PART_NEIGHBOURS = TF_WITH_NEIGHBOURS, PART_DIAGRAM = TF_WITH_VORONOI, PART_FACTORS = 4 };

static const struct {
    const char *extension;
    tetgen_writer write; // NULL: by tf_write_voronoi
    unsigned part;       // 0: always there
} tetgen_files[] = {{".node", tf_write_node, 0},
                    {".ele", tf_write_ele, 0},
                    {".face", tf_write_face, 0},
                    {".edge", tf_write_edge, 0},
                    {".neigh", tf_write_neigh, PART_NEIGHBOURS},
                    {".v.volume", tf_write_volumes, PART_FACTORS},
                    {".v.factor", tf_write_factors, PART_FACTORS},
                    {".v.share", tf_write_shares, PART_FACTORS},
                    {".v.node", tf_write_voronoi_node, PART_DIAGRAM},
                    {".v.edge", NULL, PART_DIAGRAM},
                    {".v.face", NULL, PART_DIAGRAM},
                    {".v.cell", NULL, PART_DIAGRAM}};

enum { TETGEN_FILES = sizeof tetgen_files / sizeof *tetgen_files };

static bool is_there(int i, unsigned parts) {
    return tetgen_files[i].part == 0 || (tetgen_files[i].part & parts) != 0;
}

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

// `path` with its last `drop` characters replaced; NULL: no memory.
static char *beside(const char *path, size_t drop, const char *extension) {
    const size_t stem = strlen(path) - drop;
    char *name = malloc(stem + strlen(extension) + 1);
    if (name != NULL) {
        memcpy(name, path, stem);
        strcpy(name + stem, extension);
    }
    return name;
}

// File i of TetGen's: the path itself for .node, the others beside it; NULL: no memory.
static char *tetgen_path(const char *path, int i) {
    return i == 0 ? strdup(path) : beside(path, strlen(".node"), tetgen_files[i].extension);
}

static tf_status no_memory(const char *path, tf_error *error) {
    return tf_error_set(error, TF_E_MEMORY, "%s: no memory", path);
}

// Frees `name`.
static tf_status check_name(char *name, const char *path, tf_error *error) {
    const tf_status status = name == NULL ? no_memory(path, error) : tf_output_check(name, error);
    free(name);
    return status;
}

// Frees `name`.
static tf_status add_name(tf_outputs *set, char *name, const char *path, FILE **ret_file,
                          tf_error *error) {
    const tf_status status =
        name == NULL ? no_memory(path, error) : tf_outputs_add(set, name, ret_file, error);
    free(name);
    return status;
}

tf_status tf_write_check(const char *path, unsigned extras, tf_error *error) {
    tf_format format = TF_NODE;
    tf_status status = output_format(path, &format, error);
    if (status != TF_OK) {
        return status;
    }
    if ((extras & TF_WITH_VORONOI) != 0 && format != TF_NODE && format != TF_VTU) {
        return tf_error_set(error, TF_E_FORMAT,
                            "%s: Voronoi cells are written beside .node or .vtu", path);
    }
    if (format != TF_NODE) {
        status = tf_output_check(path, error);
        return status == TF_OK && (extras & TF_WITH_VORONOI) != 0
                   ? check_name(beside(path, strlen(".vtu"), ".voronoi.vtu"), path, error)
                   : status;
    }
    const unsigned parts = extras | ((extras & TF_WITH_VORONOI) != 0 ? PART_FACTORS : 0);
    for (int i = 0; i < TETGEN_FILES && status == TF_OK; i++) {
        if (is_there(i, parts)) {
            status = check_name(tetgen_path(path, i), path, error);
        }
    }
    return status;
}

static tf_status write_tetgen(tf_outputs *set, const char *path, const tf_mesh *mesh, int first,
                              tf_error *error) {
    const unsigned parts = (mesh->neighbours != NULL ? PART_NEIGHBOURS : 0U) |
                           (mesh->edge_factors != NULL ? PART_FACTORS : 0U) |
                           (mesh->voronoi_face_start != NULL ? PART_DIAGRAM : 0U);
    FILE *together[3];
    int n = 0;
    for (int i = 0; i < TETGEN_FILES; i++) {
        FILE *file;
        if (!is_there(i, parts)) {
            continue;
        }
        const tf_status status = add_name(set, tetgen_path(path, i), path, &file, error);
        if (status != TF_OK) {
            return status;
        }
        if (tetgen_files[i].write != NULL) {
            tetgen_files[i].write(file, mesh, first);
        } else {
            together[n++] = file;
        }
    }
    return n == 0 ? TF_OK
                  : tf_write_voronoi(together[0], together[1], together[2], mesh, first, error);
}

static tf_status write_vtu(tf_outputs *set, FILE *file, const char *path, const tf_mesh *mesh,
                           tf_error *error) {
    tf_status status = tf_write_vtu(file, mesh, path, error);
    if (status == TF_OK && mesh->voronoi_face_start != NULL) {
        status = add_name(set, beside(path, strlen(".vtu"), ".voronoi.vtu"), path, &file, error);
        if (status == TF_OK) {
            status = tf_write_voronoi_vtu(file, mesh, path, error);
        }
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
            status = write_vtu(set, file, path, &view, error);
        }
    }
    uselocale(before);
    freelocale(c_locale);
    return status;
}
