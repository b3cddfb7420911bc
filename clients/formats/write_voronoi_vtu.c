// SPDX-License-Identifier: Apache-2.0
/* write_voronoi_vtu.c: the Voronoi cells as VTK's polyhedra. Cell data: `vertex` (the row of
 * the mesh's vertex that the cell is of), `region` (its marker), `volume`. */
#include <stdlib.h>
#include <string.h>

#include "clients/formats/vtu.h"

enum { POLYHEDRON = 42 };

// The cells' corners, and their faces as VTK has them: for each cell how many, and for each
// of these how many corners, and which.
typedef struct solids {
    int64_t *corners, *offsets, *faces, *face_offsets;
    uint64_t n_corners, n_faces;
} solids;

static int compare(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

// One cell, of the n faces at `face`: a polygon's number times two, odd where it is seen from
// its other side.
static void add_cell(const tf_mesh *m, const uint64_t *face, uint64_t n, solids *s) {
    int64_t *corner = s->corners + s->n_corners;
    uint64_t all = 0, k = 0;
    s->faces[s->n_faces++] = (int64_t)n;
    for (uint64_t i = 0; i < n; i++) {
        const uint64_t low = m->voronoi_face_start[face[i] / 2];
        const uint64_t high = m->voronoi_face_start[face[i] / 2 + 1];
        s->faces[s->n_faces++] = (int64_t)(high - low);
        for (uint64_t c = low; c < high; c++) {
            const int64_t point = m->voronoi_face_points[face[i] % 2 ? high - 1 - (c - low) : c];
            s->faces[s->n_faces++] = point;
            corner[all++] = point;
        }
    }
    qsort(corner, all, sizeof *corner, compare);
    for (uint64_t i = 0; i < all; i++) {
        if (i == 0 || corner[i] != corner[i - 1]) {
            corner[k++] = corner[i];
        }
    }
    s->n_corners += k;
}

static void print_cells(tf_vtu *w, const uint64_t *start, const uint64_t *face) {
    const tf_mesh *m = w->mesh;
    const uint64_t n_corners = 2 * (uint64_t)m->voronoi_face_start[m->n_voronoi_faces];
    const size_t n = (size_t)m->n_cells, row = sizeof(int64_t);
    solids s = {.corners = tf_vtu_scratch(w, n_corners, row),
                .offsets = tf_vtu_scratch(w, n, row),
                .faces = tf_vtu_scratch(w, n_corners + 2 * m->n_voronoi_faces + n, row),
                .face_offsets = tf_vtu_scratch(w, n, row)};
    uint8_t *kinds = tf_vtu_scratch(w, n, 1);
    if (!w->no_memory) {
        for (uint64_t c = 0; c < n; c++) {
            add_cell(m, face + start[c], start[c + 1] - start[c], &s);
            s.offsets[c] = (int64_t)s.n_corners;
            s.face_offsets[c] = (int64_t)s.n_faces;
            kinds[c] = POLYHEDRON;
        }
        fputs("<Cells>\n", w->file);
        tf_vtu_array(w, "Int64", "connectivity", 1, s.corners, (size_t)s.n_corners * row);
        tf_vtu_array(w, "Int64", "offsets", 1, s.offsets, n * row);
        tf_vtu_array(w, "UInt8", "types", 1, kinds, n);
        tf_vtu_array(w, "Int64", "faces", 1, s.faces, (size_t)s.n_faces * row);
        tf_vtu_array(w, "Int64", "faceoffsets", 1, s.face_offsets, n * row);
        fputs("</Cells>\n", w->file);
    }
    free(s.corners);
    free(s.offsets);
    free(s.faces);
    free(s.face_offsets);
    free(kinds);
}

static void print_data(tf_vtu *w) {
    const tf_mesh *m = w->mesh;
    const size_t n = (size_t)m->n_cells;
    int64_t *vertices = tf_vtu_scratch(w, n, sizeof *vertices);
    int32_t *regions = tf_vtu_scratch(w, n, sizeof *regions);
    if (!w->no_memory) {
        for (size_t c = 0; c < n; c++) {
            vertices[c] = m->cell_vertices[c];
            regions[c] = tf_marker_of(m, m->cell_regions[c]);
        }
        fputs("<CellData>\n", w->file);
        tf_vtu_array(w, "Int64", "vertex", 1, vertices, n * sizeof *vertices);
        tf_vtu_array(w, "Int32", "region", 1, regions, n * sizeof *regions);
        tf_vtu_array(w, "Float64", "volume", 1, m->cell_volumes, n * sizeof *m->cell_volumes);
        fputs("</CellData>\n", w->file);
    }
    free(vertices);
    free(regions);
}

tf_status tf_write_voronoi_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error) {
    tf_vtu w = {file, mesh, mesh->n_cells, false};
    uint64_t *start, *face;
    const tf_status status = tf_voronoi_cells(mesh, &start, &face, error);
    if (status != TF_OK) {
        return status;
    }
    tf_vtu_begin(&w, mesh->n_voronoi_points, mesh->voronoi_points);
    print_cells(&w, start, face);
    print_data(&w);
    free(start);
    free(face);
    return tf_vtu_end(&w, path, error);
}
