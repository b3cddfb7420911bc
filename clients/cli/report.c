// SPDX-License-Identifier: Apache-2.0
/* report.c: the report of a mesh with the lists of what breaks the promised bounds. */
#include <math.h>

#include "clients/cli/cli.h"

static const uint32_t *indices(const tetrad_mesh *mesh, const char *name, uint64_t rows) {
    const tetrad_array *array = tetrad_mesh_find(mesh, name);
    return array != NULL && array->dtype == TETRAD_U4 && array->shape[0] == rows ? array->data
                                                                                 : NULL;
}

// The sharp segment to blame: its number and the vertices of the subsegment; null
// where there is none.
static json_t *segment_json(const tetrad_mesh *mesh, uint32_t row, int first_index) {
    const tetrad_array *subsegments = tetrad_mesh_find(mesh, "subsegments");
    const tetrad_array *numbers = tetrad_mesh_find(mesh, "subsegment_segments");
    const tetrad_array *markers = tetrad_mesh_find(mesh, "subsegment_markers");
    if (subsegments == NULL || row >= subsegments->shape[0] || subsegments->shape[1] != 2 ||
        numbers == NULL || row >= numbers->shape[0] || subsegments->dtype != TETRAD_U4 ||
        numbers->dtype != TETRAD_U4) {
        return json_null();
    }
    const uint32_t *ends = (const uint32_t *)subsegments->data + 2 * (size_t)row;
    const int32_t marker =
        markers != NULL && markers->dtype == TETRAD_I4 && row < markers->shape[0]
            ? ((const int32_t *)markers->data)[row]
            : 0;
    return json_pack("{s:I, s:i, s:[I,I]}", "number",
                     (json_int_t)((const uint32_t *)numbers->data)[row] + first_index, "marker",
                     (int)marker, "vertices", (json_int_t)ends[0] + first_index,
                     (json_int_t)ends[1] + first_index);
}

// What a list holds: the arrays of a mesh, and how their values are shown.
typedef struct listed {
    const char *name;
    const char *tetrahedra, *values, *segments;
    const char *measure;
    double (*shown)(double value);
} listed;

static double same(double value) {
    return value;
}

static double degrees(double cosine) {
    return acos(fmax(-1, fmin(1, cosine))) * (180 / 3.14159265358979323846);
}

static const listed lists[] = {
    {"exceptions", "exception_tetrahedra", "exception_radius_edge", "exception_segments",
     "radius_edge", same},
    {"slivers", "sliver_tetrahedra", "sliver_cosines", "sliver_segments", "dihedral", degrees}};

// Null for the ratio of a tetrahedron that is flat in doubles: JSON has no infinity.
static json_t *value_json(const listed *which, const tetrad_array *values, uint64_t i) {
    const double value = values != NULL && values->dtype == TETRAD_F8 && i < values->shape[0]
                             ? which->shown(((const double *)values->data)[i])
                             : INFINITY;
    return isfinite(value) ? json_real(value) : json_null();
}

// Sets one list, with its count, in the report.
static int set_list(json_t *report, const tetrad_mesh *mesh, const listed *which,
                    int first_index) {
    const tetrad_array *tetrahedra = tetrad_mesh_find(mesh, which->tetrahedra);
    const tetrad_array *values = tetrad_mesh_find(mesh, which->values);
    const uint64_t n = tetrahedra != NULL ? tetrahedra->shape[0] : 0;
    const uint32_t *rows = indices(mesh, which->tetrahedra, n);
    const uint32_t *segments = indices(mesh, which->segments, n);
    json_t *list = json_array();
    int failed = list == NULL;
    for (uint64_t i = 0; i < n && rows != NULL && !failed; i++) {
        json_t *segment =
            segments != NULL ? segment_json(mesh, segments[i], first_index) : json_null();
        failed = json_array_append_new(
            list, json_pack("{s:I, s:o, s:o}", "tetrahedron", (json_int_t)rows[i] + first_index,
                            which->measure, value_json(which, values, i), "segment", segment));
    }
    if (failed) {
        json_decref(list);
        return failed;
    }
    return json_object_set_new(report, which->name,
                               json_pack("{s:I, s:o}", "count", (json_int_t)n, "list", list));
}

// The worst edge's vertices are numbered as the output is.
static int renumber_worst(json_t *report, int first_index) {
    json_t *voronoi = json_object_get(report, "voronoi");
    json_t *worst = json_object_get(voronoi, "worst");
    json_t *vertices = json_object_get(worst, "vertices");
    if (json_array_size(vertices) != 2) {
        return 0;
    }
    const json_int_t a = json_integer_value(json_array_get(vertices, 0)) + first_index;
    const json_int_t b = json_integer_value(json_array_get(vertices, 1)) + first_index;
    json_t *mine = json_deep_copy(voronoi); // the job object keeps its own
    const int failed = json_object_set_new(json_object_get(mine, "worst"), "vertices",
                                           json_pack("[I,I]", a, b));
    return failed | json_object_set_new(report, "voronoi", mine);
}

json_t *make_report(const json_t *job, const tetrad_mesh *mesh, int first_index) {
    json_t *report = json_copy(json_object_get(job, "report"));
    int failed = report == NULL;
    for (size_t i = 0; i < sizeof lists / sizeof lists[0] && !failed; i++) {
        failed = set_list(report, mesh, &lists[i], first_index);
    }
    if (!failed) {
        failed = renumber_worst(report, first_index);
        failed |= json_object_set_new(report, "first_index", json_integer(first_index));
    }
    if (failed) {
        json_decref(report);
        return NULL;
    }
    return report;
}
