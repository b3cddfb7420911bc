// SPDX-License-Identifier: Apache-2.0
/* read_off.c: the Object File Format (Geomview), ASCII: OFF, and with values per
 * vertex that are not used here COFF, NOFF, STOFF and their mixtures. */
#include "clients/formats/readers.h"

#include <string.h>

// Numbers that belong to the format but not to a PLS (colours, normals).
static void skip_numbers(tf_text *text, const char *what) {
    while (tf_text_more(text)) {
        tf_text_real(text, what);
    }
}

// [ST][C][N]OFF; *ret_extra tells whether vertices carry more than coordinates.
static bool is_off_header(tf_token token, bool *ret_extra) {
    const char *at = token.at, *end = token.at + token.size;
    if (end - at >= 2 && strncmp(at, "ST", 2) == 0) {
        at += 2;
    }
    if (at < end && *at == 'C') {
        at++;
    }
    if (at < end && *at == 'N') {
        at++;
    }
    *ret_extra = at != token.at;
    return end - at == 3 && strncmp(at, "OFF", 3) == 0;
}

static void read_face(tf_text *text, tf_build *build) {
    const int64_t n_points = (int64_t)build->points.count;
    const size_t n = tf_text_count(text, "the number of the face's vertices", sizeof "0");
    if (!text->failed && n < 3) {
        tf_text_fail(text, "a face needs at least 3 vertices");
    }
    for (size_t i = 0; i < n && !text->failed; i++) {
        tf_build_polygon_vertex(
            build, (uint32_t)tf_text_integer(text, "a face's vertex", 0, n_points - 1));
    }
    skip_numbers(text, "a face's colour");
    tf_build_polygon_end(build);
    tf_build_facet_end(build, 0);
}

void tf_read_off_text(tf_text *text, tf_build *build) {
    tf_token token;
    bool extra;
    build->surface = true;
    if (!tf_text_seek(text) || !tf_text_token(text, &token) || !is_off_header(token, &extra)) {
        tf_text_fail(text, "an ASCII .off file begins with OFF");
        return;
    }
    if (!tf_text_seek(text)) {
        tf_text_fail(text, "the file ends where the counts are expected");
    }
    const size_t n_points = tf_text_count(text, "the number of vertices", sizeof "0 0 0");
    const size_t n_faces = tf_text_count(text, "the number of faces", sizeof "3 0 0 0");
    if (tf_text_more(text)) {
        tf_text_integer(text, "the number of edges", 0, INT64_C(1) << 53);
    }
    tf_text_row_end(text);
    for (size_t i = 0; i < n_points && !text->failed; i++) {
        double place[3];
        if (!tf_text_seek(text)) {
            tf_text_fail(text, "the file ends after %zu of %zu vertices", i, n_points);
        }
        tf_text_place(text, place);
        if (extra) {
            skip_numbers(text, "a vertex's colour or normal");
        }
        tf_text_row_end(text);
        tf_build_point(build, place);
    }
    for (size_t i = 0; i < n_faces && !text->failed; i++) {
        if (!tf_text_seek(text)) {
            tf_text_fail(text, "the file ends after %zu of %zu faces", i, n_faces);
        }
        read_face(text, build);
        tf_text_row_end(text);
    }
    if (tf_text_seek(text)) {
        tf_text_fail(text, "there is more after the last face");
    }
}
