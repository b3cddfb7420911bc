// SPDX-License-Identifier: Apache-2.0
// Readers refuse malformed files with the file's name, the line and what is wrong.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "clients/formats/format.h"

static const struct {
    const char *name;
    unsigned long line; // 0: the file has no lines, or none is to blame
    const char *what;
} cases[] = {
    {"bad_after.poly", 11, "there is more after the last region"},
    {"bad_attributes.node", 1, "1000000 attributes of 1 points are more than the file can hold"},
    {"bad_axes.ply", 7, "the file needs one element vertex with x, y and z"},
    {"bad_binary.off", 1, "the number of vertices is expected, 'BINARY' is no finite number"},
    {"bad_binary_length.stl", 0, "a binary .stl of 2 triangles has 184 bytes, this has 183"},
    {"bad_binary_nan.stl", 0, "triangle 0 (byte 84): a coordinate is not finite"},
    {"bad_count.mesh", 9, "the number of elements is 99999999, more than the rest of the file can hold"},
    {"bad_count.node", 1, "the number of points is 4000000000, more than the rest of the file can hold"},
    {"bad_count.off", 2, "the number of faces is 100000000, more than the rest of the file can hold"},
    {"bad_dimension.mesh", 2, "the Dimension is 2, not 3"},
    {"bad_dimension.node", 1, "the dimension is 2, not 3"},
    {"bad_empty.node", 1, "the file ends where the number of points is expected"},
    {"bad_end.mesh", 9, "the number of elements is 1, more than the rest of the file can hold"},
    {"bad_end.node", 3, "the file ends where a point is expected"},
    {"bad_end.off", 7, "the file ends after 1 of 2 faces"},
    {"bad_end.ply", 12, "the file ends inside its elements"},
    {"bad_end.stl", 8, "'endsolid' is expected"},
    {"bad_extra.node", 2, "'0' is more than belongs on this line"},
    {"bad_face.obj", 4, "a face needs at least 3 vertices"},
    {"bad_face.off", 6, "a face needs at least 3 vertices"},
    {"bad_face.ply", 13, "a face needs at least 3 vertices"},
    {"bad_facet_extra.smesh", 7, "'6' is more than belongs on this line"},
    {"bad_facets.poly", 7, "a facet needs at least 1 polygon"},
    {"bad_few.node", 3, "the z coordinate is missing"},
    {"bad_first_index.node", 2, "the first point's index is 2, outside 0 to 1"},
    {"bad_format.ply", 2, "'ascii2' is no format of .ply files"},
    {"bad_fraction.node", 1, "the number of points is expected, 1.5 is no integer"},
    {"bad_fraction.ply", 13, "a face's vertex is out of range"},
    {"bad_header.off", 1, "an ASCII .off file begins with OFF"},
    {"bad_header.ply", 4, "the file ends inside the header"},
    {"bad_hex.node", 2, "the x coordinate is expected, '0x10' is no finite number"},
    {"bad_hole.poly", 9, "the z coordinate is missing"},
    {"bad_hole_list.poly", 9, "the number of holes is 2, more than the rest of the file can hold"},
    {"bad_index.mesh", 10, "an element's vertex is 4, outside 1 to 3"},
    {"bad_index.obj", 4, "vertex 4 is outside 1 to 3"},
    {"bad_index.off", 6, "a face's vertex is 3, outside 0 to 2"},
    {"bad_index.ply", 13, "a face's vertex is out of range"},
    {"bad_index.smesh", 7, "a polygon's vertex is 4, outside 0 to 3"},
    {"bad_index_binary.ply", 0, "byte 247: a face's vertex is out of range"},
    {"bad_index_order.node", 3, "the point's index is 2, not 1"},
    {"bad_keyword.mesh", 1, "a keyword is expected, not '12'"},
    {"bad_magic.ply", 1, "a .ply file begins with ply"},
    {"bad_marker.node", 2, "the point's marker is 3000000000, outside -2147483648 to 2147483647"},
    {"bad_more.ply", 0, "byte 247: there is more after the last element"},
    {"bad_nan.node", 3, "the x coordinate is expected, 'nan' is no finite number"},
    {"bad_nan.stl", 5, "the y coordinate is expected, 'nan' is no finite number"},
    {"bad_negative.node", 1, "the number of points is -1, outside 0 to 4294967294"},
    {"bad_negative.off", 6, "a face's vertex is -1, outside 0 to 2"},
    {"bad_no_facets.smesh", 5, "the file ends where the number of facets is expected"},
    {"bad_no_points.node", 0, "there are no points in the file"},
    {"bad_none.mesh", 3, "there are no Vertices in the file"},
    {"bad_none.obj", 2, "there is no vertex in the file"},
    {"bad_none.stl", 0, "there are no points in the file"},
    {"bad_overflow.node", 2, "the x coordinate is expected, '1e999' is no finite number"},
    {"bad_polygon_count.smesh", 7, "the number of the polygon's vertices is 4000000000, more than the rest of the file can hold"},
    {"bad_polygon_empty.smesh", 7, "a polygon needs at least 1 vertex"},
    {"bad_polygon_end.smesh", 8, "the file ends where a polygon's vertex is expected"},
    {"bad_region.poly", 11, "the region's attribute is missing"},
    {"bad_relative.obj", 3, "vertex -3 is outside 1 to 2"},
    {"bad_row.ply", 11, "'0' is more than belongs on this line"},
    {"bad_short.ply", 0, "byte 243: the file ends inside its elements"},
    {"bad_statement.obj", 2, "'cstype' is no statement that is read here"},
    {"bad_text.stl", 1, "neither an ASCII .stl (which begins with solid) nor a binary one"},
    {"bad_trailing.node", 4, "there is more after the last point"},
    {"bad_trailing.off", 7, "there is more after the last face"},
    {"bad_type.ply", 4, "'long' is no type of a property"},
    {"bad_vertex.obj", 1, "the z coordinate is missing"},
    {"bad_vertex.off", 4, "the z coordinate is missing"},
    {"bad_word.mesh", 10, "an element's vertex is expected, 'x' is no finite number"},
    {"bad_word.node", 2, "the x coordinate is expected, '1,5' is no finite number"},
    {"bad_word.obj", 4, "'3x' is no vertex"},
    {"bad_word.stl", 6, "'vertex' is expected"},
    {"bad_zero.mesh", 10, "an element's vertex is 0, outside 1 to 3"},
    {"bad_zero.obj", 4, "vertex 0 is outside 1 to 3"},
};

static void refuses_malformed_files(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char path[512], expected[1024];
        snprintf(path, sizeof path, "%s/%s", DATA, cases[i].name);
        if (cases[i].line > 0) {
            snprintf(expected, sizeof expected, "%s:%lu: %s", path, cases[i].line, cases[i].what);
        } else {
            snprintf(expected, sizeof expected, "%s: %s", path, cases[i].what);
        }
        tf_pls pls;
        tf_error error;
        memset(&pls, 0x5a, sizeof pls);
        const tf_pls before = pls;
        assert_int_equal(tf_read(path, &pls, &error), TF_E_MALFORMED);
        assert_int_equal(error.status, TF_E_MALFORMED);
        assert_string_equal(error.message, expected);
        assert_int_equal(error.line, cases[i].line);
        assert_memory_equal(&pls, &before, sizeof pls);
    }
}

static void refuses_what_cannot_be_opened(void **state) {
    (void)state;
    tf_pls pls;
    tf_error error;
    assert_int_equal(tf_read(DATA "/missing.off", &pls, &error), TF_E_OPEN);
    assert_non_null(strstr(error.message, "missing.off: cannot be read: No such file"));
    // The .node file beside it is named, not the .smesh.
    assert_int_equal(tf_read(DATA "/bad_missing_nodes.smesh", &pls, &error), TF_E_OPEN);
    assert_non_null(strstr(error.message, "bad_missing_nodes.node: cannot be read"));
    assert_int_equal(tf_read(DATA, &pls, &error), TF_E_FORMAT);
    assert_int_equal(tf_read(DATA "/good.xyz", &pls, &error), TF_E_FORMAT);
    assert_int_equal(tf_read(DATA "/good.vtu", &pls, &error), TF_E_OPEN);
    assert_int_equal(tf_read(DATA "/missing.off", &pls, NULL), TF_E_OPEN);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(refuses_malformed_files),
                                       cmocka_unit_test(refuses_what_cannot_be_opened)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
