// SPDX-License-Identifier: Apache-2.0
/* write_vtu.c: VTK's XML unstructured grid, data inline as base64 of zlib blocks.
 *
 * Cells are the tetrahedra, then the subfaces, then the subsegments. Cell data:
 * `region` (the region's marker; 0 off the tetrahedra), `marker` (of subfaces and
 * subsegments; 0 on tetrahedra), `radius_edge` and `least_dihedral` (degrees; 0 off
 * the tetrahedra). Point data: `marker`, `origin`, and the attributes. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "clients/formats/mesh_view.h"

enum { BLOCK = 1 << 16, TETRAHEDRON = 10, TRIANGLE = 5, LINE = 3 };

typedef struct vtu {
    FILE *file;
    const tf_mesh *mesh;
    uint64_t n_cells;
    bool no_memory;
} vtu;

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
static void print_compressed(vtu *w, const void *data, size_t size) {
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

static void print_array(vtu *w, const char *type, const char *name, unsigned columns,
                        const void *data, size_t size) {
    fprintf(w->file,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"binary\">", type,
            name, columns);
    print_compressed(w, data, size);
    fputs("</DataArray>\n", w->file);
}

static void *scratch(vtu *w, uint64_t items, size_t size) {
    void *data = calloc(items > 0 ? (size_t)items : 1, size);
    w->no_memory = w->no_memory || data == NULL;
    return data;
}

static void print_cells(vtu *w) {
    const tf_mesh *m = w->mesh;
    const uint64_t n_ends = 4 * m->n_tetrahedra + 3 * m->n_subfaces + 2 * m->n_subsegments;
    int64_t *ends = scratch(w, n_ends, sizeof *ends);
    int64_t *offsets = scratch(w, w->n_cells, sizeof *offsets);
    uint8_t *kinds = scratch(w, w->n_cells, 1);
    if (!w->no_memory) {
        const struct {
            const uint32_t *v;
            uint64_t rows;
            unsigned corners;
            uint8_t kind;
        } parts[3] = {{m->tetrahedra, m->n_tetrahedra, 4, TETRAHEDRON},
                      {m->subfaces, m->n_subfaces, 3, TRIANGLE},
                      {m->subsegments, m->n_subsegments, 2, LINE}};
        uint64_t at = 0, cell = 0;
        for (int p = 0; p < 3; p++) {
            for (uint64_t i = 0; i < parts[p].rows; i++) {
                for (unsigned k = 0; k < parts[p].corners; k++) {
                    ends[at++] = parts[p].v[i * parts[p].corners + k];
                }
                offsets[cell] = (int64_t)at;
                kinds[cell++] = parts[p].kind;
            }
        }
        fputs("<Cells>\n", w->file);
        print_array(w, "Int64", "connectivity", 1, ends, (size_t)n_ends * sizeof *ends);
        print_array(w, "Int64", "offsets", 1, offsets, (size_t)w->n_cells * sizeof *offsets);
        print_array(w, "UInt8", "types", 1, kinds, (size_t)w->n_cells);
        fputs("</Cells>\n", w->file);
    }
    free(ends);
    free(offsets);
    free(kinds);
}

static void print_cell_data(vtu *w) {
    const tf_mesh *m = w->mesh;
    int32_t *regions = scratch(w, w->n_cells, sizeof *regions);
    int32_t *markers = scratch(w, w->n_cells, sizeof *markers);
    double *ratios = scratch(w, w->n_cells, sizeof *ratios);
    double *angles = scratch(w, w->n_cells, sizeof *angles);
    if (!w->no_memory) {
        for (uint64_t t = 0; t < m->n_tetrahedra; t++) {
            regions[t] = tf_region_marker(m, t);
            ratios[t] = tf_radius_edge(m, t);
            angles[t] = tf_least_dihedral(m, t);
        }
        if (m->subface_markers != NULL) {
            memcpy(markers + m->n_tetrahedra, m->subface_markers,
                   (size_t)m->n_subfaces * sizeof *markers);
        }
        if (m->subsegment_markers != NULL) {
            memcpy(markers + m->n_tetrahedra + m->n_subfaces, m->subsegment_markers,
                   (size_t)m->n_subsegments * sizeof *markers);
        }
        const size_t n = (size_t)w->n_cells;
        fputs("<CellData>\n", w->file);
        print_array(w, "Int32", "region", 1, regions, n * sizeof *regions);
        print_array(w, "Int32", "marker", 1, markers, n * sizeof *markers);
        print_array(w, "Float64", "radius_edge", 1, ratios, n * sizeof *ratios);
        print_array(w, "Float64", "least_dihedral", 1, angles, n * sizeof *angles);
        fputs("</CellData>\n", w->file);
    }
    free(regions);
    free(markers);
    free(ratios);
    free(angles);
}

static void print_point_data(vtu *w) {
    const tf_mesh *m = w->mesh;
    const size_t n = (size_t)m->n_points;
    fputs("<PointData>\n", w->file);
    if (m->point_markers != NULL) {
        print_array(w, "Int32", "marker", 1, m->point_markers, n * sizeof *m->point_markers);
    }
    if (m->point_origin != NULL) {
        print_array(w, "UInt8", "origin", 1, m->point_origin, n);
    }
    if (m->n_attributes > 0) {
        print_array(w, "Float64", "attributes", (unsigned)m->n_attributes, m->point_attributes,
                    n * (size_t)m->n_attributes * sizeof *m->point_attributes);
    }
    fputs("</PointData>\n", w->file);
}

tf_status tf_write_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error) {
    vtu w = {file, mesh, mesh->n_tetrahedra + mesh->n_subfaces + mesh->n_subsegments, false};
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\" "
            "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
            "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfCells=\"%" PRIu64 "\">\n<Points>\n",
            mesh->n_points, w.n_cells);
    print_array(&w, "Float64", "points", 3, mesh->points, (size_t)mesh->n_points * 24);
    fputs("</Points>\n", file);
    print_cells(&w);
    print_point_data(&w);
    print_cell_data(&w);
    fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
    return w.no_memory ? tf_error_set(error, TF_E_MEMORY, "%s: no memory", path) : TF_OK;
}
