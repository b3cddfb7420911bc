// SPDX-License-Identifier: Apache-2.0
/* vtu.h: the frame of VTK's XML unstructured grids, data inline as base64 of zlib blocks. */
#ifndef TETRAD_FORMATS_VTU_H
#define TETRAD_FORMATS_VTU_H

#include "clients/formats/mesh_view.h"

typedef struct tf_vtu {
    FILE *file;
    const tf_mesh *mesh;
    uint64_t n_cells;
    bool no_memory; /* at some time: what was written is of no use */
} tf_vtu;

/* Everything up to the points [n][3], and what closes the file. Errors: TF_E_MEMORY. */
void tf_vtu_begin(tf_vtu *w, uint64_t n_points, const double *points);
tf_status tf_vtu_end(tf_vtu *w, const char *path, tf_error *error);

/* One DataArray of `size` bytes; `type` is VTK's name. */
void tf_vtu_array(tf_vtu *w, const char *type, const char *name, unsigned columns, const void *data,
                  size_t size);

/* Zeroed memory, to be freed with free; NULL sets no_memory. */
void *tf_vtu_scratch(tf_vtu *w, uint64_t items, size_t size);

#endif
