// SPDX-License-Identifier: Apache-2.0
// What is written comes back bit for bit, and files appear together or not at all.
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "clients/formats/format.h"

// Two tetrahedra on one face, two regions, one point attribute.
static const double points[15] = {0.1, 0, 0, 1.0 / 3.0, 1e-300, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static const double attributes[5] = {0.5, 1.0 / 7.0, 2, 3, 4}, region_attributes[2] = {10.25, 20};
static const int32_t point_markers[5] = {1, 2, 3, 4, -5}, region_markers[2] = {10, 20};
static const uint32_t tetrahedra[8] = {0, 1, 2, 3, 1, 4, 2, 3}, regions[2] = {1, 0};
static const uint32_t neighbours[8] = {1, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                       UINT32_MAX, 0, UINT32_MAX, UINT32_MAX};
static const uint32_t subfaces[6] = {0, 1, 2, 1, 2, 3}, subsegments[4] = {0, 1, 1, 2};
static const int32_t subface_markers[2] = {7, -8}, subsegment_markers[2] = {5, 6};
static const uint32_t subface_facets[2] = {0, 1}, subsegment_segments[2] = {0, 1};
static const uint8_t origin[5] = {0, 0, 0, 0, 3};

static void borrow(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                   uint64_t columns, const void *data) {
    tp_error error;
    assert_int_equal(tp_arrays_borrow(set, name, dtype, rows, columns, data, &error), TP_OK);
}

static tp_arrays sample_mesh(void) {
    tp_arrays set = TP_ARRAYS_INIT;
    borrow(&set, "points", TP_F8, 5, 3, points);
    borrow(&set, "point_attributes", TP_F8, 5, 1, attributes);
    borrow(&set, "point_markers", TP_I4, 5, 0, point_markers);
    borrow(&set, "point_origin", TP_U1, 5, 0, origin);
    borrow(&set, "tetrahedra", TP_U4, 2, 4, tetrahedra);
    borrow(&set, "tetrahedron_regions", TP_U4, 2, 0, regions);
    borrow(&set, "neighbours", TP_U4, 2, 4, neighbours);
    borrow(&set, "subfaces", TP_U4, 2, 3, subfaces);
    borrow(&set, "subface_facets", TP_U4, 2, 0, subface_facets);
    borrow(&set, "subface_markers", TP_I4, 2, 0, subface_markers);
    borrow(&set, "subsegments", TP_U4, 2, 2, subsegments);
    borrow(&set, "subsegment_segments", TP_U4, 2, 0, subsegment_segments);
    borrow(&set, "subsegment_markers", TP_I4, 2, 0, subsegment_markers);
    borrow(&set, "region_markers", TP_I4, 2, 0, region_markers);
    borrow(&set, "region_attributes", TP_F8, 2, 0, region_attributes);
    return set;
}

// A dual for it, of numbers that are easy to tell: two cells, two faces, one of them outside.
static const uint32_t cell_vertices[2] = {0, 4}, cell_regions[2] = {0, 1}, edge_vertices[2] = {0, 4},
                      edge_regions[1] = {1}, face_start[3] = {0, 3, 6}, face_cells[4] = {0, 1, 1, UINT32_MAX};
static const uint32_t face_points[6] = {0, 1, 2, 2, 1, 3};
static const double volumes[2] = {0.25, 1.0 / 3.0}, factors[1] = {-0.5}, shares[6] = {1, 2, 3, 4, 5, 6};
static const double voronoi_points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static void add_factors(tp_arrays *set) {
    borrow(set, "cell_vertices", TP_U4, 2, 0, cell_vertices);
    borrow(set, "cell_regions", TP_U4, 2, 0, cell_regions);
    borrow(set, "cell_volumes", TP_F8, 2, 0, volumes);
    borrow(set, "edge_vertices", TP_U4, 1, 2, edge_vertices);
    borrow(set, "edge_regions", TP_U4, 1, 0, edge_regions);
    borrow(set, "edge_factors", TP_F8, 1, 0, factors);
    borrow(set, "subface_shares", TP_F8, 2, 3, shares);
}

static void add_diagram(tp_arrays *set, const uint32_t *points_of_faces) {
    borrow(set, "voronoi_points", TP_F8, 4, 3, voronoi_points);
    borrow(set, "voronoi_face_start", TP_U4, 3, 0, face_start);
    borrow(set, "voronoi_face_points", TP_U4, 6, 0, points_of_faces);
    borrow(set, "voronoi_face_cells", TP_U4, 2, 2, face_cells);
}

static int make_folder(void **state) {
    char *folder = strdup("/tmp/tetrad-writers-XXXXXX");
    *state = folder;
    return mkdtemp(folder) == NULL;
}

static int files_in(const char *folder, int remove_them) {
    int n = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d)) != NULL;) {
        if (e->d_name[0] != '.') {
            n++;
            if (remove_them) {
                unlinkat(dirfd(d), e->d_name, 0);
            }
        }
    }
    closedir(d);
    return n;
}

static int remove_folder(void **state) {
    files_in(*state, 1);
    rmdir(*state);
    free(*state);
    return 0;
}

static char *path_in(const char *folder, const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_set(tp_arrays mesh, const char *folder, const char *name, int first) {
    tf_outputs set = TF_OUTPUTS_INIT;
    tf_error error = {TF_OK, 0, ""};
    if (tf_write_mesh(&set, path_in(folder, name), &mesh, first, &error) != TF_OK ||
        tf_outputs_commit(&set, &error) != TF_OK) {
        fail_msg("%s", error.message);
    }
    tp_arrays_free(&mesh);
}

static void write_sample(const char *folder, const char *name, int first) {
    write_set(sample_mesh(), folder, name, first);
}

static void check_text(const char *folder, const char *name, const char *expected) {
    char text[1024] = "";
    FILE *file = fopen(path_in(folder, name), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(text, expected);
}

static void writes_tetgen_files(void **state) {
    write_sample(*state, "Mesh.Node", 1);
    assert_int_equal(files_in(*state, 0), 5);
    check_text(*state, "Mesh.ele", "2 4 1\n1 1 2 3 4 20\n2 2 5 3 4 10.25\n");
    check_text(*state, "Mesh.face", "2 1\n1 1 2 3 7\n2 2 3 4 -8\n");
    check_text(*state, "Mesh.edge", "2 1\n1 1 2 5\n2 2 3 6\n");
    check_text(*state, "Mesh.neigh", "2 4\n1 2 -1 -1 -1\n2 -1 1 -1 -1\n");
    tf_pls back;
    tf_error error;
    assert_int_equal(tf_read(path_in(*state, "Mesh.Node"), &back, &error), TF_OK);
    assert_int_equal(back.first_index, 1);
    assert_memory_equal(tp_arrays_data(&back.arrays, "points", NULL), points, sizeof points);
    assert_memory_equal(tp_arrays_data(&back.arrays, "point_attributes", NULL), attributes,
                        sizeof attributes);
    assert_memory_equal(tp_arrays_data(&back.arrays, "point_markers", NULL), point_markers,
                        sizeof point_markers);
    tf_pls_free(&back);
}

static void writes_the_dual(void **state) {
    tp_arrays mesh = sample_mesh();
    add_factors(&mesh);
    write_set(mesh, *state, "f.node", 0);
    assert_int_equal(files_in(*state, 0), 5 + 3);
    check_text(*state, "f.v.volume", "2\n0 0 10 0.25\n1 4 20 0.33333333333333331\n");
    check_text(*state, "f.v.factor", "1\n0 0 4 20 -0.5\n");
    check_text(*state, "f.v.share", "2\n0 0 1 2 7 1 2 3\n1 1 2 3 -8 4 5 6\n");
    files_in(*state, 1);
    mesh = sample_mesh();
    add_factors(&mesh);
    add_diagram(&mesh, face_points);
    write_set(mesh, *state, "d.node", 1);
    assert_int_equal(files_in(*state, 0), 5 + 3 + 4);
    check_text(*state, "d.v.volume", "2\n1 1 10 0.25\n2 5 20 0.33333333333333331\n");
    check_text(*state, "d.v.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    check_text(*state, "d.v.edge", "5\n1 1 2\n2 1 3\n3 2 3\n4 2 4\n5 3 4\n");
    check_text(*state, "d.v.face", "2\n1 1 2 3 1 3 2\n2 2 -1 3 3 4 5\n");
    check_text(*state, "d.v.cell", "2\n1 1 1\n2 2 1 2\n");
    files_in(*state, 1);
    mesh = sample_mesh();
    add_factors(&mesh);
    add_diagram(&mesh, face_points);
    write_set(mesh, *state, "d.vtu", 1);
    assert_int_equal(files_in(*state, 0), 2);
}

static void refuses_a_dual_that_does_not_fit(void **state) {
    const uint32_t wrong[6] = {0, 1, 2, 2, 1, 4};
    for (int i = 0; i < 3; i++) {
        tp_arrays mesh = sample_mesh();
        tf_outputs set = TF_OUTPUTS_INIT;
        tf_error error;
        if (i != 1) {
            add_factors(&mesh);
        }
        add_diagram(&mesh, i == 2 ? wrong : face_points);
        if (i == 0) {
            mesh.items[mesh.count - 3].shape[0] = 2; // one polygon's end is missing
        }
        assert_int_equal(tf_write_mesh(&set, path_in(*state, "a.node"), &mesh, 0, &error), TF_E_MALFORMED);
        tf_outputs_drop(&set);
        tp_arrays_free(&mesh);
    }
    tf_error error;
    assert_int_equal(tf_write_check(path_in(*state, "a.mesh"), TF_WITH_VORONOI, &error), TF_E_FORMAT);
    assert_int_equal(tf_write_check(path_in(*state, "a.vtu"), TF_WITH_VORONOI, &error), TF_OK);
    assert_int_equal(mkdir(path_in(*state, "a.v.cell"), 0700), 0);
    assert_int_equal(tf_write_check(path_in(*state, "a.node"), 0, &error), TF_OK);
    assert_int_equal(tf_write_check(path_in(*state, "a.node"), TF_WITH_VORONOI, &error), TF_E_WRITE);
    assert_int_equal(rmdir(path_in(*state, "a.v.cell")), 0);
    assert_int_equal(files_in(*state, 0), 0);
}

static void writes_medit(void **state) {
    write_sample(*state, "mesh.mesh", 0);
    assert_int_equal(files_in(*state, 0), 1);
    tf_pls back;
    tf_error error;
    assert_int_equal(tf_read(path_in(*state, "mesh.mesh"), &back, &error), TF_OK);
    assert_memory_equal(tp_arrays_data(&back.arrays, "points", NULL), points, sizeof points);
    assert_memory_equal(tp_arrays_data(&back.arrays, "triangles", NULL), subfaces, sizeof subfaces);
    assert_memory_equal(tp_arrays_data(&back.arrays, "facet_markers", NULL), subface_markers,
                        sizeof subface_markers);
    assert_memory_equal(tp_arrays_data(&back.arrays, "segments", NULL), subsegments,
                        sizeof subsegments);
    assert_memory_equal(tp_arrays_data(&back.arrays, "segment_markers", NULL), subsegment_markers,
                        sizeof subsegment_markers);
    tf_pls_free(&back);
}

static void writes_off_without_unused_points_at_the_end(void **state) {
    write_sample(*state, "surface.off", 0);
    tf_pls back;
    tf_error error;
    uint64_t n;
    assert_int_equal(tf_read(path_in(*state, "surface.off"), &back, &error), TF_OK);
    assert_memory_equal(tp_arrays_data(&back.arrays, "points", &n), points, 12 * sizeof *points);
    assert_int_equal(n, 4);
    assert_memory_equal(tp_arrays_data(&back.arrays, "triangles", NULL), subfaces, sizeof subfaces);
    tf_pls_free(&back);
}

static void leaves_nothing_when_dropped_or_impossible(void **state) {
    tp_arrays mesh = sample_mesh();
    tf_outputs set = TF_OUTPUTS_INIT;
    tf_error error;
    assert_int_equal(tf_write_mesh(&set, path_in(*state, "a.node"), &mesh, 0, &error), TF_OK);
    assert_int_equal(files_in(*state, 0), 5);
    tf_outputs_drop(&set);
    assert_int_equal(files_in(*state, 0), 0);
    assert_int_equal(tf_write_check(path_in(*state, "a.node"), TF_WITH_NEIGHBOURS, &error), TF_OK);
    assert_int_equal(tf_write_check(path_in(*state, "a.vtu"), 0, &error), TF_OK);
    assert_int_equal(files_in(*state, 0), 0);
    assert_int_equal(tf_write_check(path_in(*state, "no/a.vtu"), 0, &error), TF_E_WRITE);
    assert_int_equal(tf_write_check(path_in(*state, "a.stl"), 0, &error), TF_E_FORMAT);
    assert_int_equal(tf_write_check(path_in(*state, "a"), 0, &error), TF_E_FORMAT);
    // A folder where one of the five files belongs.
    assert_int_equal(mkdir(path_in(*state, "a.face"), 0700), 0);
    assert_int_equal(tf_write_check(path_in(*state, "a.node"), 0, &error), TF_E_WRITE);
    assert_int_equal(tf_write_mesh(&set, path_in(*state, "a.node"), &mesh, 0, &error), TF_E_WRITE);
    tf_outputs_drop(&set);
    assert_int_equal(rmdir(path_in(*state, "a.face")), 0);
    assert_int_equal(files_in(*state, 0), 0);
    tp_arrays_free(&mesh);
}

static void refuses_meshes_that_would_be_read_out_of_range(void **state) {
    const uint32_t wrong[4] = {0, 1, 2, 5};
    tp_arrays mesh = TP_ARRAYS_INIT;
    tf_outputs set = TF_OUTPUTS_INIT;
    tf_error error;
    borrow(&mesh, "points", TP_F8, 5, 3, points);
    borrow(&mesh, "tetrahedra", TP_U4, 1, 4, wrong);
    assert_int_equal(tf_write_mesh(&set, path_in(*state, "a.node"), &mesh, 0, &error),
                     TF_E_MALFORMED);
    tp_arrays_free(&mesh);
    borrow(&mesh, "points", TP_F8, 5, 3, points);
    assert_int_equal(tf_write_mesh(&set, path_in(*state, "a.node"), &mesh, 0, &error),
                     TF_E_MALFORMED);
    tp_arrays_free(&mesh);
    assert_int_equal(files_in(*state, 0), 0);
}

int main(void) {
#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(writes_tetgen_files), WITH_FOLDER(writes_the_dual),
        WITH_FOLDER(refuses_a_dual_that_does_not_fit), WITH_FOLDER(writes_medit),
        WITH_FOLDER(writes_off_without_unused_points_at_the_end),
        WITH_FOLDER(leaves_nothing_when_dropped_or_impossible),
        WITH_FOLDER(refuses_meshes_that_would_be_read_out_of_range)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
