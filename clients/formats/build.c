// SPDX-License-Identifier: Apache-2.0
/* build.c: the growing PLS of the readers and its conversion to arrays. It checks
 * nothing about the geometry. */
#include "clients/formats/build.h"

#include <stdlib.h>
#include <string.h>

static void push(tf_build *build, tf_list *list, const void *item, size_t size) {
    if (build->no_memory) {
        return;
    }
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity < 8 ? 16 : list->capacity * 2;
        unsigned char *data =
            capacity > SIZE_MAX / size ? NULL : realloc(list->data, capacity * size);
        if (data == NULL) {
            build->no_memory = true;
            return;
        }
        list->data = data;
        list->capacity = capacity;
    }
    memcpy(list->data + list->count * size, item, size);
    list->count++;
}

static void push_u4(tf_build *build, tf_list *list, size_t value) {
    const uint32_t narrow = (uint32_t)value;
    push(build, list, &narrow, sizeof narrow);
}

// CSR starts begin with the 0 that goes before the first row.
static void push_start(tf_build *build, tf_list *starts, size_t end) {
    if (starts->count == 0) {
        push_u4(build, starts, 0);
    }
    push_u4(build, starts, end);
}

void tf_build_point(tf_build *build, const double place[3]) {
    push(build, &build->points, place, 3 * sizeof(double));
}

void tf_build_attribute(tf_build *build, double value) {
    push(build, &build->point_attributes, &value, sizeof value);
}

void tf_build_point_marker(tf_build *build, int32_t marker) {
    push(build, &build->point_markers, &marker, sizeof marker);
}

void tf_build_polygon_vertex(tf_build *build, uint32_t vertex) {
    push_u4(build, &build->polygon_vertices, vertex);
}

static size_t polygons(const tf_build *build) {
    return build->polygon_start.count == 0 ? 0 : build->polygon_start.count - 1;
}

void tf_build_polygon_end(tf_build *build) {
    push_start(build, &build->polygon_start, build->polygon_vertices.count);
}

void tf_build_facet_hole(tf_build *build, const double place[3]) {
    push(build, &build->facet_holes, place, 3 * sizeof(double));
}

void tf_build_facet_end(tf_build *build, int32_t marker) {
    push_start(build, &build->facet_start, polygons(build));
    push_start(build, &build->facet_hole_start, build->facet_holes.count);
    push(build, &build->facet_markers, &marker, sizeof marker);
}

void tf_build_segment(tf_build *build, uint32_t a, uint32_t b, int32_t marker) {
    const uint32_t ends[2] = {a, b};
    push(build, &build->segments, ends, sizeof ends);
    push(build, &build->segment_markers, &marker, sizeof marker);
}

void tf_build_hole(tf_build *build, const double place[3]) {
    push(build, &build->holes, place, 3 * sizeof(double));
}

void tf_build_region(tf_build *build, const double seed[3], double attribute, double max_volume) {
    push(build, &build->region_seeds, seed, 3 * sizeof(double));
    push(build, &build->region_attributes, &attribute, sizeof attribute);
    push(build, &build->region_max_volumes, &max_volume, sizeof max_volume);
}

static void all_lists(tf_build *build, tf_list *lists[15]) {
    tf_list *all[15] = {
        &build->points,           &build->point_attributes, &build->point_markers,
        &build->polygon_vertices, &build->polygon_start,    &build->facet_start,
        &build->facet_markers,    &build->facet_holes,      &build->facet_hole_start,
        &build->segments,         &build->segment_markers,  &build->holes,
        &build->region_seeds,     &build->region_attributes, &build->region_max_volumes};
    memcpy(lists, all, sizeof all);
}

void tf_build_free(tf_build *build) {
    tf_list *lists[15];
    all_lists(build, lists);
    for (size_t i = 0; i < 15; i++) {
        free(lists[i]->data);
        *lists[i] = (tf_list){NULL, 0, 0};
    }
}

// Moves a list into the set as [rows] (columns 0) or [rows, columns].
static void move(tf_build *build, tp_arrays *set, tf_list *list, const char *name, tp_dtype dtype,
                 size_t rows, size_t columns) {
    tp_error error;
    if (build->no_memory) {
        return;
    }
    if (list->data == NULL) {
        void *data;
        build->no_memory = tp_arrays_new(set, name, dtype, rows, columns, &data, &error) != TP_OK;
    } else if (tp_arrays_own(set, name, dtype, rows, columns, list->data, &error) != TP_OK) {
        build->no_memory = true;
    } else {
        *list = (tf_list){NULL, 0, 0};
    }
}

// Integer attributes name their regions: they are the markers too.
static void add_region_markers(tf_build *build, tp_arrays *set) {
    const double *attributes = (const double *)(const void *)build->region_attributes.data;
    tf_list markers = {NULL, 0, 0};
    for (size_t i = 0; i < build->region_attributes.count; i++) {
        const double value = attributes[i];
        if (!(value >= INT32_MIN && value <= INT32_MAX) || (double)(int32_t)value != value) {
            free(markers.data);
            return;
        }
        const int32_t marker = (int32_t)value;
        push(build, &markers, &marker, sizeof marker);
    }
    move(build, set, &markers, "region_markers", TP_I4, build->region_attributes.count, 0);
    free(markers.data);
}

static bool all_triangles(const tf_build *build) {
    const uint32_t *start = (const uint32_t *)(const void *)build->polygon_start.data;
    bool triangles = polygons(build) == build->facet_markers.count && build->facet_holes.count == 0;
    for (size_t i = 0; i < polygons(build) && triangles; i++) {
        triangles = start[i + 1] - start[i] == 3;
    }
    return triangles;
}

static void add_facets(tf_build *build, tp_arrays *set) {
    const size_t n_facets = build->facet_markers.count;
    if (all_triangles(build)) {
        move(build, set, &build->polygon_vertices, "triangles", TP_U4, n_facets, 3);
    } else {
        const size_t n_polygons = polygons(build), n_vertices = build->polygon_vertices.count;
        move(build, set, &build->polygon_vertices, "polygon_vertices", TP_U4, n_vertices, 0);
        move(build, set, &build->polygon_start, "polygon_start", TP_U4, n_polygons + 1, 0);
        if (n_polygons != n_facets) {
            move(build, set, &build->facet_start, "facet_start", TP_U4, n_facets + 1, 0);
        }
        if (build->facet_holes.count > 0) {
            const size_t n_holes = build->facet_holes.count;
            move(build, set, &build->facet_holes, "facet_holes", TP_F8, n_holes, 3);
            move(build, set, &build->facet_hole_start, "facet_hole_start", TP_U4, n_facets + 1, 0);
        }
    }
    move(build, set, &build->facet_markers, "facet_markers", TP_I4, n_facets, 0);
}

tf_status tf_build_finish(tf_build *build, tp_arrays *ret_arrays, tf_error *error) {
    tp_arrays set = TP_ARRAYS_INIT;
    const size_t n = build->points.count, n_segments = build->segment_markers.count;
    const size_t n_regions = build->region_attributes.count;
    move(build, &set, &build->points, "points", TP_F8, n, 3);
    if (build->n_attributes > 0) {
        move(build, &set, &build->point_attributes, "point_attributes", TP_F8, n,
             build->n_attributes);
    }
    if (build->point_markers.count > 0) {
        move(build, &set, &build->point_markers, "point_markers", TP_I4, n, 0);
    }
    if (build->facet_markers.count > 0) {
        add_facets(build, &set);
    }
    if (n_segments > 0) {
        move(build, &set, &build->segments, "segments", TP_U4, n_segments, 2);
        move(build, &set, &build->segment_markers, "segment_markers", TP_I4, n_segments, 0);
    }
    if (build->surface) {
        tf_list none = {NULL, 0, 0};
        move(build, &set, &none, "loose_points", TP_U4, 0, 0);
    }
    if (build->holes.count > 0) {
        move(build, &set, &build->holes, "holes", TP_F8, build->holes.count, 3);
    }
    if (n_regions > 0) {
        add_region_markers(build, &set);
        move(build, &set, &build->region_seeds, "region_seeds", TP_F8, n_regions, 3);
        move(build, &set, &build->region_attributes, "region_attributes", TP_F8, n_regions, 0);
        move(build, &set, &build->region_max_volumes, "region_max_volumes", TP_F8, n_regions, 0);
    }
    if (build->no_memory) {
        tp_arrays_free(&set);
        return tf_error_set(error, TF_E_MEMORY, "no memory for the input");
    }
    *ret_arrays = set;
    return TF_OK;
}
