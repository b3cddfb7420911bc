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

#include "clients/formats/vtu.h"

enum { TETRAHEDRON = 10, TRIANGLE = 5, LINE = 3 };

static void print_cells(tf_vtu *w) {
    const tf_mesh *m = w->mesh;
    const uint64_t n_ends = 4 * m->n_tetrahedra + 3 * m->n_subfaces + 2 * m->n_subsegments;
    int64_t *ends = tf_vtu_scratch(w, n_ends, sizeof *ends);
    int64_t *offsets = tf_vtu_scratch(w, w->n_cells, sizeof *offsets);
    uint8_t *kinds = tf_vtu_scratch(w, w->n_cells, 1);
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
        tf_vtu_array(w, "Int64", "connectivity", 1, ends, (size_t)n_ends * sizeof *ends);
        tf_vtu_array(w, "Int64", "offsets", 1, offsets, (size_t)w->n_cells * sizeof *offsets);
        tf_vtu_array(w, "UInt8", "types", 1, kinds, (size_t)w->n_cells);
        fputs("</Cells>\n", w->file);
    }
    free(ends);
    free(offsets);
    free(kinds);
}

static void print_cell_data(tf_vtu *w) {
    const tf_mesh *m = w->mesh;
    int32_t *regions = tf_vtu_scratch(w, w->n_cells, sizeof *regions);
    int32_t *markers = tf_vtu_scratch(w, w->n_cells, sizeof *markers);
    double *ratios = tf_vtu_scratch(w, w->n_cells, sizeof *ratios);
    double *angles = tf_vtu_scratch(w, w->n_cells, sizeof *angles);
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
        tf_vtu_array(w, "Int32", "region", 1, regions, n * sizeof *regions);
        tf_vtu_array(w, "Int32", "marker", 1, markers, n * sizeof *markers);
        tf_vtu_array(w, "Float64", "radius_edge", 1, ratios, n * sizeof *ratios);
        tf_vtu_array(w, "Float64", "least_dihedral", 1, angles, n * sizeof *angles);
        fputs("</CellData>\n", w->file);
    }
    free(regions);
    free(markers);
    free(ratios);
    free(angles);
}

static void print_point_data(tf_vtu *w) {
    const tf_mesh *m = w->mesh;
    const size_t n = (size_t)m->n_points;
    fputs("<PointData>\n", w->file);
    if (m->point_markers != NULL) {
        tf_vtu_array(w, "Int32", "marker", 1, m->point_markers, n * sizeof *m->point_markers);
    }
    if (m->point_origin != NULL) {
        tf_vtu_array(w, "UInt8", "origin", 1, m->point_origin, n);
    }
    if (m->n_attributes > 0) {
        tf_vtu_array(w, "Float64", "attributes", (unsigned)m->n_attributes, m->point_attributes,
                     n * (size_t)m->n_attributes * sizeof *m->point_attributes);
    }
    fputs("</PointData>\n", w->file);
}

tf_status tf_write_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error) {
    tf_vtu w = {file, mesh, mesh->n_tetrahedra + mesh->n_subfaces + mesh->n_subsegments, false};
    tf_vtu_begin(&w, mesh->n_points, mesh->points);
    print_cells(&w);
    print_point_data(&w);
    print_cell_data(&w);
    return tf_vtu_end(&w, path, error);
}
