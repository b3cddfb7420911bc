// SPDX-License-Identifier: Apache-2.0
/* write_voronoi.c: the dual of a mesh as text: tables of volumes, factors and shares, and the
 * diagram in TetGen's .v.node, .v.edge, .v.face and .v.cell, without rays, as all cells end at
 * the domain's boundary. Numbers are printed in the C locale (tf_write_mesh sees to it). */
#include <inttypes.h>
#include <stdlib.h>

#include "clients/formats/mesh_view.h"

// vertex, region's marker, volume
void tf_write_volumes(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 "\n", mesh->n_cells);
    for (uint64_t i = 0; i < mesh->n_cells; i++) {
        fprintf(file, "%" PRIu64 " %" PRIu64 " %" PRId32 " %.17g\n", i + (uint64_t)first,
                (uint64_t)mesh->cell_vertices[i] + (uint64_t)first,
                tf_marker_of(mesh, mesh->cell_regions[i]), mesh->cell_volumes[i]);
    }
}

// two vertices, region's marker, factor
void tf_write_factors(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 "\n", mesh->n_edges);
    for (uint64_t i = 0; i < mesh->n_edges; i++) {
        const uint32_t *v = mesh->edge_vertices + 2 * i;
        fprintf(file, "%" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRId32 " %.17g\n",
                i + (uint64_t)first, (uint64_t)v[0] + (uint64_t)first,
                (uint64_t)v[1] + (uint64_t)first, tf_marker_of(mesh, mesh->edge_regions[i]),
                mesh->edge_factors[i]);
    }
}

// The rows of .face: three vertices, marker, and the shares of the three.
void tf_write_shares(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 "\n", mesh->n_subfaces);
    for (uint64_t i = 0; i < mesh->n_subfaces; i++) {
        const uint32_t *v = mesh->subfaces + 3 * i;
        const double *s = mesh->subface_shares + 3 * i;
        fprintf(file,
                "%" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRId32 " %.17g %.17g %.17g\n",
                i + (uint64_t)first, (uint64_t)v[0] + (uint64_t)first,
                (uint64_t)v[1] + (uint64_t)first, (uint64_t)v[2] + (uint64_t)first,
                mesh->subface_markers != NULL ? mesh->subface_markers[i] : 0, s[0], s[1], s[2]);
    }
}

void tf_write_voronoi_node(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 " 3 0 0\n", mesh->n_voronoi_points);
    for (uint64_t i = 0; i < mesh->n_voronoi_points; i++) {
        const double *x = mesh->voronoi_points + 3 * i;
        fprintf(file, "%" PRIu64 " %.17g %.17g %.17g\n", i + (uint64_t)first, x[0], x[1], x[2]);
    }
}

static int compare(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

// Side i of the polygon whose corners are [low, high), as one number.
static uint64_t side_key(const tf_mesh *mesh, uint64_t i, uint64_t low, uint64_t high) {
    const uint64_t a = mesh->voronoi_face_points[i];
    const uint64_t b = mesh->voronoi_face_points[i + 1 < high ? i + 1 : low];
    return a < b ? a << 32 | b : b << 32 | a;
}

// All sides, each once, ascending; returns how many.
static uint64_t collect_sides(const tf_mesh *mesh, uint64_t *sides) {
    uint64_t n = 0, k = 0;
    for (uint64_t f = 0; f < mesh->n_voronoi_faces; f++) {
        const uint64_t low = mesh->voronoi_face_start[f], high = mesh->voronoi_face_start[f + 1];
        for (uint64_t i = low; i < high; i++) {
            sides[n++] = side_key(mesh, i, low, high);
        }
    }
    qsort(sides, n, sizeof *sides, compare);
    for (uint64_t i = 0; i < n; i++) {
        if (i == 0 || sides[i] != sides[i - 1]) {
            sides[k++] = sides[i];
        }
    }
    return k;
}

static void write_faces(FILE *file, const tf_mesh *mesh, const uint64_t *sides, uint64_t n_sides,
                        int first) {
    fprintf(file, "%" PRIu64 "\n", mesh->n_voronoi_faces);
    for (uint64_t f = 0; f < mesh->n_voronoi_faces; f++) {
        const uint64_t low = mesh->voronoi_face_start[f], high = mesh->voronoi_face_start[f + 1];
        fprintf(file, "%" PRIu64, f + (uint64_t)first);
        for (int k = 0; k < 2; k++) {
            const uint32_t cell = mesh->voronoi_face_cells[2 * f + (uint64_t)k];
            fprintf(file, " %" PRId64, cell == UINT32_MAX ? -1 : (int64_t)cell + first);
        }
        fprintf(file, " %" PRIu64, high - low);
        for (uint64_t i = low; i < high; i++) {
            const uint64_t key = side_key(mesh, i, low, high);
            const uint64_t *side = bsearch(&key, sides, n_sides, sizeof *sides, compare);
            fprintf(file, " %" PRIu64, (uint64_t)(side - sides) + (uint64_t)first);
        }
        fputc('\n', file);
    }
}

// start [n_cells + 1] is zeroed and has room for face [2 n_voronoi_faces].
static void collect_faces(const tf_mesh *mesh, uint64_t *start, uint64_t *face) {
    const uint32_t *cell = mesh->voronoi_face_cells;
    for (uint64_t i = 0; i < 2 * mesh->n_voronoi_faces; i++) {
        if (cell[i] != UINT32_MAX) {
            start[cell[i]]++;
        }
    }
    for (uint64_t c = 0, end = 0; c <= mesh->n_cells; c++) {
        end = start[c] += end;
    }
    for (uint64_t i = 2 * mesh->n_voronoi_faces; i-- > 0;) { // from the ends down to the starts
        if (cell[i] != UINT32_MAX) {
            face[--start[cell[i]]] = i;
        }
    }
}

tf_status tf_voronoi_cells(const tf_mesh *mesh, uint64_t **ret_start, uint64_t **ret_face,
                           tf_error *error) {
    uint64_t *start = calloc((size_t)mesh->n_cells + 1, sizeof *start);
    uint64_t *face = malloc((2 * (size_t)mesh->n_voronoi_faces + 1) * sizeof *face);
    if (start == NULL || face == NULL) {
        free(start);
        free(face);
        return tf_error_set(error, TF_E_MEMORY, "no memory for the Voronoi cells");
    }
    collect_faces(mesh, start, face);
    *ret_start = start;
    *ret_face = face;
    return TF_OK;
}

tf_status tf_write_voronoi(FILE *edge, FILE *face, FILE *cell, const tf_mesh *mesh, int first,
                           tf_error *error) {
    const uint64_t n_corners = mesh->voronoi_face_start[mesh->n_voronoi_faces];
    uint64_t *start, *faces, *sides = malloc(((size_t)n_corners + 1) * sizeof *sides);
    const tf_status status = sides == NULL
                                 ? tf_error_set(error, TF_E_MEMORY, "no memory for Voronoi edges")
                                 : tf_voronoi_cells(mesh, &start, &faces, error);
    if (status != TF_OK) {
        free(sides);
        return status;
    }
    const uint64_t n_sides = collect_sides(mesh, sides);
    fprintf(edge, "%" PRIu64 "\n", n_sides);
    for (uint64_t i = 0; i < n_sides; i++) {
        fprintf(edge, "%" PRIu64 " %" PRIu64 " %" PRIu64 "\n", i + (uint64_t)first,
                (sides[i] >> 32) + (uint64_t)first, (sides[i] & UINT32_MAX) + (uint64_t)first);
    }
    write_faces(face, mesh, sides, n_sides, first);
    fprintf(cell, "%" PRIu64 "\n", mesh->n_cells);
    for (uint64_t c = 0; c < mesh->n_cells; c++) {
        fprintf(cell, "%" PRIu64 " %" PRIu64, c + (uint64_t)first, start[c + 1] - start[c]);
        for (uint64_t i = start[c]; i < start[c + 1]; i++) {
            fprintf(cell, " %" PRIu64, faces[i] / 2 + (uint64_t)first);
        }
        fputc('\n', cell);
    }
    free(sides);
    free(start);
    free(faces);
    return TF_OK;
}
