// SPDX-License-Identifier: Apache-2.0
/* write_text.c: the text formats: TetGen's .node, .ele, .face, .edge and .neigh,
 * Medit's .mesh, and .off (the subfaces). 17 significant digits bring every double
 * back. Numbers are printed in the C locale (tf_write_mesh sees to it). */
#include <inttypes.h>
#include <stdlib.h>

#include "clients/formats/mesh_view.h"

static void print_place(FILE *file, const double *p) {
    fprintf(file, "%.17g %.17g %.17g", p[0], p[1], p[2]);
}

void tf_write_node(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 " 3 %" PRIu64 " %d\n", mesh->n_points, mesh->n_attributes,
            mesh->point_markers != NULL);
    for (uint64_t i = 0; i < mesh->n_points; i++) {
        fprintf(file, "%" PRIu64 " ", i + (uint64_t)first);
        print_place(file, mesh->points + 3 * i);
        for (uint64_t k = 0; k < mesh->n_attributes; k++) {
            fprintf(file, " %.17g", mesh->point_attributes[i * mesh->n_attributes + k]);
        }
        if (mesh->point_markers != NULL) {
            fprintf(file, " %" PRId32, mesh->point_markers[i]);
        }
        fputc('\n', file);
    }
}

static void print_vertices(FILE *file, const uint32_t *v, int n, int first) {
    for (int i = 0; i < n; i++) {
        fprintf(file, "%s%" PRIu64, i > 0 ? " " : "", (uint64_t)v[i] + (uint64_t)first);
    }
}

void tf_write_ele(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 " 4 1\n", mesh->n_tetrahedra);
    for (uint64_t t = 0; t < mesh->n_tetrahedra; t++) {
        fprintf(file, "%" PRIu64 " ", t + (uint64_t)first);
        print_vertices(file, mesh->tetrahedra + 4 * t, 4, first);
        fprintf(file, " %.17g\n", tf_region_attribute(mesh, t));
    }
}

// .face and .edge: rows of n vertices and a marker.
static void print_marked(FILE *file, const uint32_t *v, uint64_t rows, int n,
                         const int32_t *markers, int first) {
    fprintf(file, "%" PRIu64 " 1\n", rows);
    for (uint64_t i = 0; i < rows; i++) {
        fprintf(file, "%" PRIu64 " ", i + (uint64_t)first);
        print_vertices(file, v + (uint64_t)n * i, n, first);
        fprintf(file, " %" PRId32 "\n", markers != NULL ? markers[i] : 0);
    }
}

void tf_write_face(FILE *file, const tf_mesh *mesh, int first) {
    print_marked(file, mesh->subfaces, mesh->n_subfaces, 3, mesh->subface_markers, first);
}

void tf_write_edge(FILE *file, const tf_mesh *mesh, int first) {
    print_marked(file, mesh->subsegments, mesh->n_subsegments, 2, mesh->subsegment_markers, first);
}

void tf_write_neigh(FILE *file, const tf_mesh *mesh, int first) {
    fprintf(file, "%" PRIu64 " 4\n", mesh->n_tetrahedra);
    for (uint64_t t = 0; t < mesh->n_tetrahedra; t++) {
        fprintf(file, "%" PRIu64, t + (uint64_t)first);
        for (int i = 0; i < 4; i++) {
            const uint32_t n = mesh->neighbours[4 * t + (uint64_t)i];
            fprintf(file, " %" PRId64, n == UINT32_MAX ? -1 : (int64_t)n + first);
        }
        fputc('\n', file);
    }
}

static void medit_section(FILE *file, const char *name, const uint32_t *v, uint64_t rows, int n,
                          const int32_t *markers) {
    fprintf(file, "\n%s\n%" PRIu64 "\n", name, rows);
    for (uint64_t i = 0; i < rows; i++) {
        print_vertices(file, v + (uint64_t)n * i, n, 1);
        fprintf(file, " %" PRId32 "\n", markers != NULL ? markers[i] : 0);
    }
}

void tf_write_medit(FILE *file, const tf_mesh *mesh) {
    fprintf(file, "MeshVersionFormatted 2\nDimension 3\n\nVertices\n%" PRIu64 "\n", mesh->n_points);
    for (uint64_t i = 0; i < mesh->n_points; i++) {
        print_place(file, mesh->points + 3 * i);
        fprintf(file, " %" PRId32 "\n", mesh->point_markers != NULL ? mesh->point_markers[i] : 0);
    }
    fprintf(file, "\nTetrahedra\n%" PRIu64 "\n", mesh->n_tetrahedra);
    for (uint64_t t = 0; t < mesh->n_tetrahedra; t++) {
        print_vertices(file, mesh->tetrahedra + 4 * t, 4, 1);
        fprintf(file, " %" PRId32 "\n", tf_region_marker(mesh, t));
    }
    medit_section(file, "Triangles", mesh->subfaces, mesh->n_subfaces, 3, mesh->subface_markers);
    medit_section(file, "Edges", mesh->subsegments, mesh->n_subsegments, 2,
                  mesh->subsegment_markers);
    fputs("\nEnd\n", file);
}

// Rows keep their numbers; points behind the last one that a subface uses are left out.
void tf_write_off(FILE *file, const tf_mesh *mesh) {
    uint64_t n = 0;
    for (uint64_t i = 0; i < 3 * mesh->n_subfaces; i++) {
        n = mesh->subfaces[i] >= n ? (uint64_t)mesh->subfaces[i] + 1 : n;
    }
    fprintf(file, "OFF\n%" PRIu64 " %" PRIu64 " 0\n", n, mesh->n_subfaces);
    for (uint64_t i = 0; i < n; i++) {
        print_place(file, mesh->points + 3 * i);
        fputc('\n', file);
    }
    for (uint64_t i = 0; i < mesh->n_subfaces; i++) {
        fputs("3 ", file);
        print_vertices(file, mesh->subfaces + 3 * i, 3, 0);
        fputc('\n', file);
    }
}
