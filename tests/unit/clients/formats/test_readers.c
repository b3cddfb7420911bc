// SPDX-License-Identifier: Apache-2.0
// Every reader's arrays, value by value.
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "clients/formats/format.h"

static tf_pls read_file(const char *name) {
    char path[512];
    tf_pls pls;
    tf_error error = {TF_OK, 0, ""};
    tp_error why = {TP_OK, "", ""};
    snprintf(path, sizeof path, "%s/%s", DATA, name);
    if (tf_read(path, &pls, &error) != TF_OK) {
        fail_msg("%s", error.message);
    }
    if (tp_arrays_validate(&pls.arrays, tp_schema_pls(), &why) != TP_OK) {
        fail_msg("%s: %s", name, why.message);
    }
    return pls;
}

static const void *array(const tf_pls *pls, const char *name, uint64_t rows) {
    uint64_t n = 0;
    const void *data = tp_arrays_data(&pls->arrays, name, &n);
    if (data == NULL || n != rows) {
        fail_msg("%s has %d rows, not %d", name, (int)n, (int)rows);
    }
    return data;
}

static void check_f8(const tf_pls *pls, const char *name, uint64_t rows, const double *expected,
                     size_t n) {
    assert_memory_equal(array(pls, name, rows), expected, n * sizeof *expected);
}

static void check_u4(const tf_pls *pls, const char *name, uint64_t rows, const uint32_t *expected,
                     size_t n) {
    assert_memory_equal(array(pls, name, rows), expected, n * sizeof *expected);
}

static void check_i4(const tf_pls *pls, const char *name, uint64_t rows, const int32_t *expected) {
    assert_memory_equal(array(pls, name, rows), expected, rows * sizeof *expected);
}

static void check_absent(const tf_pls *pls, const char *name) {
    assert_null(tp_arrays_find(&pls->arrays, name));
}

// Facet markers 0 and an empty list of loose points, as of every surface file.
static void check_surface(const tf_pls *pls, size_t n_facets) {
    const int32_t zero[8] = {0};
    check_i4(pls, "facet_markers", n_facets, zero);
    array(pls, "loose_points", 0);
}

static void reads_poly(void **state) {
    (void)state;
    tf_pls pls = read_file("good.poly");
    assert_int_equal(pls.first_index, 1);
    const double points[24] = {0,   0,   0, 1,   0,   0, 1,   1,   0, 0,   1,   0,
                               .25, .25, 0, .75, .25, 0, .75, .75, 0, .25, .75, 0};
    check_f8(&pls, "points", 8, points, 24);
    const double attributes[8] = {0.5, 1.5, 2.5, 3.5, 1e-3, 2, -3, 4};
    check_f8(&pls, "point_attributes", 8, attributes, 8);
    const int32_t markers[8] = {7, 7, 7, 8, 8, 8, -9, 8};
    check_i4(&pls, "point_markers", 8, markers);
    const uint32_t vertices[10] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 2};
    check_u4(&pls, "polygon_vertices", 10, vertices, 10);
    const uint32_t polygons[4] = {0, 4, 8, 10}, facets[3] = {0, 2, 3}, hole_start[3] = {0, 1, 1};
    check_u4(&pls, "polygon_start", 4, polygons, 4);
    check_u4(&pls, "facet_start", 3, facets, 3);
    check_u4(&pls, "facet_hole_start", 3, hole_start, 3);
    const double facet_hole[3] = {0.5, 0.5, 0}, hole[3] = {9, 9, 9};
    check_f8(&pls, "facet_holes", 1, facet_hole, 3);
    check_f8(&pls, "holes", 1, hole, 3);
    const int32_t facet_markers[2] = {5, 0}, region_markers[2] = {10, 20};
    check_i4(&pls, "facet_markers", 2, facet_markers);
    check_i4(&pls, "region_markers", 2, region_markers);
    const double seeds[6] = {.1, .1, .1, .2, .2, .2}, values[2] = {10, 20}, volumes[2] = {0.001, 0};
    check_f8(&pls, "region_seeds", 2, seeds, 6);
    check_f8(&pls, "region_attributes", 2, values, 2);
    check_f8(&pls, "region_max_volumes", 2, volumes, 2);
    check_absent(&pls, "loose_points");
    check_absent(&pls, "triangles");
    tf_pls_free(&pls);
}

static void reads_smesh_with_nodes_beside(void **state) {
    (void)state;
    tf_pls pls = read_file("beside.smesh");
    assert_int_equal(pls.first_index, 1);
    const double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[3] = {0, 1, 2};
    const int32_t marker[1] = {4};
    check_f8(&pls, "points", 3, points, 9);
    check_u4(&pls, "triangles", 1, triangle, 3);
    check_i4(&pls, "facet_markers", 1, marker);
    check_absent(&pls, "facet_start");
    check_absent(&pls, "holes");
    tf_pls_free(&pls);
}

static void reads_points_alone(void **state) {
    (void)state;
    tf_pls pls = read_file("Points.NODE");
    assert_int_equal(pls.first_index, 0);
    assert_int_equal(pls.arrays.count, 1);
    array(&pls, "points", 4);
    tf_pls_free(&pls);
}

static void reads_off(void **state) {
    (void)state;
    tf_pls pls = read_file("good.off");
    const uint32_t vertices[7] = {0, 1, 2, 3, 0, 2, 1}, start[3] = {0, 4, 7};
    assert_int_equal(pls.first_index, 0);
    array(&pls, "points", 5);
    check_u4(&pls, "polygon_vertices", 7, vertices, 7);
    check_u4(&pls, "polygon_start", 3, start, 3);
    check_surface(&pls, 2);
    tf_pls_free(&pls);
    pls = read_file("colours.off");
    const double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    check_f8(&pls, "points", 3, points, 9);
    tf_pls_free(&pls);
}

static void reads_stl(void **state) {
    (void)state;
    tf_pls pls = read_file("ascii.stl");
    // The second triangle begins at (-0,0,0), which is (0,0,0); the third is degenerate.
    const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    check_f8(&pls, "points", 4, points, 12);
    check_u4(&pls, "triangles", 2, triangles, 6);
    check_surface(&pls, 2);
    tf_pls_free(&pls);
    pls = read_file("binary.STL");
    const double half[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5};
    check_f8(&pls, "points", 4, half, 12);
    check_u4(&pls, "triangles", 2, triangles, 6);
    tf_pls_free(&pls);
}

static void reads_ply(void **state) {
    (void)state;
    tf_pls pls = read_file("ascii.ply");
    const double points[12] = {0, 0, 0, 1, 0, 0, 1, 0.1, 0, 0, 1, 0};
    const uint32_t vertices[7] = {0, 1, 2, 0, 1, 2, 3};
    check_f8(&pls, "points", 4, points, 12);
    check_u4(&pls, "polygon_vertices", 7, vertices, 7);
    check_surface(&pls, 2);
    tf_pls_free(&pls);
    static const char *const names[2] = {"little.ply", "big.ply"};
    for (int i = 0; i < 2; i++) {
        pls = read_file(names[i]);
        const double three[9] = {0.1, 0, 0, 1, -0.5, 0, 0, 1, -2};
        const uint32_t triangle[3] = {2, 1, 0};
        check_f8(&pls, "points", 3, three, 9);
        check_u4(&pls, "triangles", 1, triangle, 3);
        check_surface(&pls, 1);
        tf_pls_free(&pls);
    }
}

static void reads_obj(void **state) {
    (void)state;
    tf_pls pls = read_file("good.obj");
    assert_int_equal(pls.first_index, 1);
    const double points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const uint32_t vertices[7] = {0, 1, 2, 0, 1, 2, 3}, segments[4] = {0, 1, 1, 2};
    check_f8(&pls, "points", 4, points, 12);
    check_u4(&pls, "polygon_vertices", 7, vertices, 7);
    check_u4(&pls, "segments", 2, segments, 4);
    check_surface(&pls, 2);
    tf_pls_free(&pls);
}

static void reads_medit(void **state) {
    (void)state;
    tf_pls pls = read_file("good.mesh");
    assert_int_equal(pls.first_index, 1);
    const double points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const uint32_t vertices[7] = {0, 1, 2, 0, 1, 2, 3}, segments[2] = {0, 2};
    const int32_t point_markers[4] = {1, 1, 2, -3}, markers[2] = {5, 6}, segment_marker[1] = {9};
    check_f8(&pls, "points", 4, points, 12);
    check_i4(&pls, "point_markers", 4, point_markers);
    check_u4(&pls, "polygon_vertices", 7, vertices, 7);
    check_i4(&pls, "facet_markers", 2, markers);
    check_u4(&pls, "segments", 1, segments, 2);
    check_i4(&pls, "segment_markers", 1, segment_marker);
    array(&pls, "loose_points", 0);
    tf_pls_free(&pls);
}

static void parse_one(const char *coordinate, double *ret_x) {
    char text[2048];
    const int size = snprintf(text, sizeof text, "1 3 0 0\n0 %s 0 0", coordinate);
    const tf_file file = {"memory", text, (size_t)size};
    tf_pls pls;
    tf_error error;
    assert_int_equal(tf_parse(TF_NODE, &file, NULL, &pls, &error), TF_OK);
    *ret_x = ((const double *)array(&pls, "points", 1))[0];
    tf_pls_free(&pls);
}

static void reads_numbers_exactly_in_any_locale(void **state) {
    (void)state;
    // Where the system has one with a decimal comma; the other numbers count anyway.
    const char *comma = setlocale(LC_ALL, "de_DE.UTF-8");
    if (comma == NULL) {
        comma = setlocale(LC_ALL, "fr_FR.UTF-8");
    }
    char digits[1200];
    memset(digits, '3', sizeof digits);
    memcpy(digits, "0.", 2);
    digits[sizeof digits - 1] = '\0';
    const struct {
        const char *text;
        double value;
    } numbers[] = {{"0.1", 0.1},
                   {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022},
                   {"9007199254740993", 9007199254740992.0},
                   {"1e-400", 0.0},
                   {"-.5E+1", -5.0},
                   {"4.9e-324", 0x1p-1074},
                   {digits, 1.0 / 3.0}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        double x;
        parse_one(numbers[i].text, &x);
        assert_memory_equal(&x, &numbers[i].value, sizeof x);
    }
    setlocale(LC_ALL, "C");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_poly),         cmocka_unit_test(reads_smesh_with_nodes_beside),
        cmocka_unit_test(reads_points_alone), cmocka_unit_test(reads_off),
        cmocka_unit_test(reads_stl),          cmocka_unit_test(reads_ply),
        cmocka_unit_test(reads_obj),          cmocka_unit_test(reads_medit),
        cmocka_unit_test(reads_numbers_exactly_in_any_locale)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
