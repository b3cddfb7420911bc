// SPDX-License-Identifier: Apache-2.0
/* vtu.c: see vtu.h. */
#include "clients/formats/vtu.h"

#include <inttypes.h>
#include <stdlib.h>
#include <zlib.h>

enum { BLOCK = 1 << 16 };

static void print_base64(FILE *file, const unsigned char *bytes, size_t size) {
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const uint32_t bits = (uint32_t)bytes[i] << 16 |
                              (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                              (left > 2 ? bytes[i + 2] : 0);
        const char four[4] = {digits[bits >> 18], digits[bits >> 12 & 63],
                              left > 1 ? digits[bits >> 6 & 63] : '=',
                              left > 2 ? digits[bits & 63] : '='};
        fwrite(four, 1, 4, file);
    }
}

// VTK's layout: [blocks, bytes of a block, bytes of the last if it is short,
// compressed bytes of each], then the blocks; both parts are base64 by themselves.
static void print_compressed(tf_vtu *w, const void *data, size_t size) {
    const size_t n = (size + BLOCK - 1) / BLOCK;
    uint64_t *head = calloc(n + 3, sizeof *head);
    unsigned char *packed = malloc(n * compressBound(BLOCK) + 1);
    size_t at = 0;
    bool failed = head == NULL || packed == NULL;
    for (size_t i = 0; i < n && !failed; i++) {
        const size_t raw = size - i * BLOCK < BLOCK ? size - i * BLOCK : BLOCK;
        uLongf bytes = compressBound(BLOCK);
        const unsigned char *block = (const unsigned char *)data + i * BLOCK;
        failed = compress2(packed + at, &bytes, block, raw, 6) != Z_OK;
        head[3 + i] = bytes;
        at += bytes;
    }
    if (!failed) {
        head[0] = n;
        head[1] = BLOCK;
        head[2] = size % BLOCK;
        print_base64(w->file, (const unsigned char *)head, (n + 3) * sizeof *head);
        print_base64(w->file, packed, at);
    }
    w->no_memory = w->no_memory || failed;
    free(head);
    free(packed);
}

void tf_vtu_array(tf_vtu *w, const char *type, const char *name, unsigned columns,
                  const void *data, size_t size) {
    fprintf(w->file,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"binary\">", type,
            name, columns);
    print_compressed(w, data, size);
    fputs("</DataArray>\n", w->file);
}

void *tf_vtu_scratch(tf_vtu *w, uint64_t items, size_t size) {
    void *data = calloc(items > 0 ? (size_t)items : 1, size);
    w->no_memory = w->no_memory || data == NULL;
    return data;
}

void tf_vtu_begin(tf_vtu *w, uint64_t n_points, const double *points) {
    fprintf(w->file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\" "
            "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
            "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfCells=\"%" PRIu64 "\">\n<Points>\n",
            n_points, w->n_cells);
    tf_vtu_array(w, "Float64", "points", 3, points, (size_t)n_points * 24);
    fputs("</Points>\n", w->file);
}

tf_status tf_vtu_end(tf_vtu *w, const char *path, tf_error *error) {
    fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", w->file);
    return w->no_memory ? tf_error_set(error, TF_E_MEMORY, "%s: no memory", path) : TF_OK;
}
