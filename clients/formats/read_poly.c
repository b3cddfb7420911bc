// SPDX-License-Identifier: Apache-2.0
/* read_poly.c: TetGen's text formats .node, .poly and .smesh, as its manual has them.
 *
 * Rows are lines with '#' comments; only a polygon's vertices may go on over several
 * lines. The first vertex's index (0 or 1) is the first index of everything. */
#include "clients/formats/readers.h"

void tf_text_place(tf_text *text, double place[3]) {
    static const char *const names[3] = {"the x coordinate", "the y coordinate",
                                         "the z coordinate"};
    for (int i = 0; i < 3; i++) {
        place[i] = tf_text_real(text, names[i]);
    }
}

static bool need_row(tf_text *text, const char *what) {
    if (!text->failed && !tf_text_seek(text)) {
        tf_text_fail(text, "the file ends where %s is expected", what);
    }
    return !text->failed;
}

static int64_t optional_integer(tf_text *text, const char *what, int64_t low, int64_t high,
                                int64_t otherwise) {
    return tf_text_more(text) ? tf_text_integer(text, what, low, high) : otherwise;
}

// The header of a node list: count, dimension, attributes, whether markers follow.
typedef struct node_header {
    size_t count, attributes;
    bool markers;
} node_header;

static node_header read_node_header(tf_text *text) {
    node_header header = {0, 0, false};
    if (!need_row(text, "the number of points")) {
        return header;
    }
    header.count = tf_text_count(text, "the number of points", sizeof "0 0 0 0");
    optional_integer(text, "the dimension", 3, 3, 3);
    header.attributes =
        (size_t)optional_integer(text, "the number of attributes", 0, 1 << 20, 0);
    header.markers = optional_integer(text, "the boundary marker flag", 0, 1, 0) != 0;
    tf_text_row_end(text);
    // Each attribute takes a digit and a blank at least.
    if (header.count > 0 &&
        header.attributes > (size_t)(text->end - text->at) / 2 / header.count) {
        tf_text_fail(text, "%zu attributes of %zu points are more than the file can hold",
                     header.attributes, header.count);
    }
    return header;
}

static void read_points(tf_text *text, node_header header, tf_build *build, int *ret_first) {
    int64_t first = 0;
    build->n_attributes = header.attributes;
    for (size_t i = 0; i < header.count && need_row(text, "a point"); i++) {
        if (i == 0) {
            first = tf_text_integer(text, "the first point's index", 0, 1);
        } else {
            const int64_t expected = (int64_t)i + first;
            tf_text_integer(text, "the point's index", expected, expected);
        }
        double place[3];
        tf_text_place(text, place);
        tf_build_point(build, place);
        for (size_t k = 0; k < header.attributes && !text->failed; k++) {
            tf_build_attribute(build, tf_text_real(text, "a point attribute"));
        }
        if (header.markers) {
            tf_build_point_marker(
                build, (int32_t)tf_text_integer(text, "the point's marker", INT32_MIN, INT32_MAX));
        }
        tf_text_row_end(text);
    }
    *ret_first = (int)first;
}

void tf_read_node_text(tf_text *text, tf_build *build, int *ret_first) {
    read_points(text, read_node_header(text), build, ret_first);
    if (!text->failed && tf_text_seek(text)) {
        tf_text_fail(text, "there is more after the last point");
    }
}

// `k v1 ... vk`, over as many lines as it takes; leaves the cursor behind vk.
static void read_polygon(tf_text *text, int64_t first, tf_build *build) {
    const int64_t n_points = (int64_t)build->points.count;
    const size_t n = tf_text_count(text, "the number of the polygon's vertices", sizeof "0");
    if (!text->failed && n == 0) {
        tf_text_fail(text, "a polygon needs at least 1 vertex");
    }
    for (size_t i = 0; i < n && need_row(text, "a polygon's vertex"); i++) {
        const int64_t vertex =
            tf_text_integer(text, "a polygon's vertex", first, first + n_points - 1);
        tf_build_polygon_vertex(build, (uint32_t)(vertex - first));
    }
    tf_build_polygon_end(build);
}

static int32_t read_marker(tf_text *text) {
    return (int32_t)optional_integer(text, "the facet's marker", INT32_MIN, INT32_MAX, 0);
}

static void read_facet(tf_text *text, bool smesh, int64_t first, tf_build *build) {
    if (smesh) {
        read_polygon(text, first, build);
        const int32_t marker = read_marker(text);
        tf_text_row_end(text);
        tf_build_facet_end(build, marker);
        return;
    }
    const size_t n_polygons =
        tf_text_count(text, "the number of the facet's polygons", sizeof "1 1");
    const size_t n_holes = (size_t)optional_integer(text, "the number of the facet's holes", 0,
                                                    UINT32_MAX - 1, 0);
    const int32_t marker = read_marker(text);
    tf_text_row_end(text);
    if (!text->failed && n_polygons == 0) {
        tf_text_fail(text, "a facet needs at least 1 polygon");
    }
    for (size_t i = 0; i < n_polygons && need_row(text, "a polygon"); i++) {
        read_polygon(text, first, build);
        tf_text_row_end(text);
    }
    for (size_t i = 0; i < n_holes && need_row(text, "a facet's hole"); i++) {
        double place[3];
        tf_text_integer(text, "the hole's index", INT32_MIN, INT32_MAX);
        tf_text_place(text, place);
        tf_text_row_end(text);
        tf_build_facet_hole(build, place);
    }
    tf_build_facet_end(build, marker);
}

static void read_holes(tf_text *text, tf_build *build) {
    const size_t n = tf_text_count(text, "the number of holes", sizeof "0 0 0 0");
    tf_text_row_end(text);
    for (size_t i = 0; i < n && need_row(text, "a hole"); i++) {
        double place[3];
        tf_text_integer(text, "the hole's index", INT32_MIN, INT32_MAX);
        tf_text_place(text, place);
        tf_text_row_end(text);
        tf_build_hole(build, place);
    }
}

static void read_regions(tf_text *text, tf_build *build) {
    const size_t n = tf_text_count(text, "the number of regions", sizeof "0 0 0 0 0");
    tf_text_row_end(text);
    for (size_t i = 0; i < n && need_row(text, "a region"); i++) {
        double place[3], max_volume = 0;
        tf_text_integer(text, "the region's index", INT32_MIN, INT32_MAX);
        tf_text_place(text, place);
        const double attribute = tf_text_real(text, "the region's attribute");
        if (tf_text_more(text)) {
            max_volume = tf_text_real(text, "the region's largest volume");
        }
        tf_text_row_end(text);
        tf_build_region(build, place, attribute, max_volume);
    }
}

void tf_read_poly_text(tf_text *text, tf_text *nodes, bool smesh, tf_build *build, int *ret_first) {
    node_header header = read_node_header(text);
    if (!text->failed && header.count == 0 && nodes == NULL) {
        tf_text_fail(text, "the points are in a .node file beside it, which is missing");
    }
    if (text->failed) {
        return;
    }
    if (header.count == 0) {
        tf_read_node_text(nodes, build, ret_first);
        if (nodes->failed) {
            text->failed = true; // its error names the .node file
            return;
        }
    } else {
        read_points(text, header, build, ret_first);
    }
    if (!need_row(text, "the number of facets")) {
        return;
    }
    const size_t n = tf_text_count(text, "the number of facets", sizeof "1 1");
    optional_integer(text, "the boundary marker flag", 0, 1, 0);
    tf_text_row_end(text);
    for (size_t i = 0; i < n && need_row(text, "a facet"); i++) {
        read_facet(text, smesh, *ret_first, build);
    }
    // The hole and region lists may be left out.
    if (tf_text_seek(text)) {
        read_holes(text, build);
    }
    if (tf_text_seek(text)) {
        read_regions(text, build);
    }
    if (tf_text_seek(text)) {
        tf_text_fail(text, "there is more after the last region");
    }
}
