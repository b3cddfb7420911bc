// SPDX-License-Identifier: Apache-2.0
/* read_obj.c: Wavefront .obj: vertices (v), faces (f) and polylines (l, which become
 * loose segments). Texture, normals, groups and materials are passed over; free-form
 * curves and surfaces are refused. Indices are from 1, or negative from the end. */
#include "clients/formats/readers.h"

#include <stdlib.h>

// Statements without geometry of their own.
static bool is_passed_over(tf_token token) {
    static const char *const words[] = {"vt", "vn", "vp", "p",  "o",   "g",        "s",
                                        "mg", "mtllib", "usemtl", "usemap", "maplib", "bevel",
                                        "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (tf_token_is(token, words[i])) {
            return true;
        }
    }
    return false;
}

// The next token of the statement; a lone '\' at a line's end goes on with the next.
static bool statement_token(tf_text *text, tf_token *ret_token) {
    while (tf_text_token(text, ret_token)) {
        if (ret_token->size != 1 || ret_token->at[0] != '\\') {
            return true;
        }
        tf_text_row_end(text);
        if (!tf_text_row(text)) {
            return false;
        }
    }
    return false;
}

// The vertex of `i`, `i/t`, `i//n` or `i/t/n`.
static uint32_t read_vertex(tf_text *text, tf_token token, size_t so_far, size_t total) {
    char *end;
    const long long index = strtoll(token.at, &end, 10);
    const char *stop = token.at + token.size;
    const bool number = end > token.at && end <= stop && (end == stop || *end == '/');
    for (const char *c = end; number && c < stop; c++) {
        if (!((*c >= '0' && *c <= '9') || *c == '/' || *c == '-')) {
            tf_text_fail(text, "'%.*s' is no vertex", (int)(token.size < 40 ? token.size : 40),
                         token.at);
        }
    }
    const long long vertex = index > 0 ? index - 1 : (long long)so_far + index;
    if (!number) {
        tf_text_fail(text, "'%.*s' is no vertex", (int)(token.size < 40 ? token.size : 40),
                     token.at);
    } else if (index == 0 || vertex < 0 || vertex >= (long long)total) {
        tf_text_fail(text, "vertex %lld is outside 1 to %zu", index, total);
    }
    return text->failed ? 0 : (uint32_t)vertex;
}

static void read_face(tf_text *text, size_t total, tf_build *build) {
    tf_token token;
    size_t n = 0;
    while (!text->failed && statement_token(text, &token)) {
        tf_build_polygon_vertex(build, read_vertex(text, token, build->points.count, total));
        n++;
    }
    if (n < 3) {
        tf_text_fail(text, "a face needs at least 3 vertices");
    }
    tf_build_polygon_end(build);
    tf_build_facet_end(build, 0);
}

static void read_polyline(tf_text *text, size_t total, tf_build *build) {
    tf_token token;
    uint32_t last = 0;
    size_t n = 0;
    while (!text->failed && statement_token(text, &token)) {
        const uint32_t vertex = read_vertex(text, token, build->points.count, total);
        if (n > 0) {
            tf_build_segment(build, last, vertex, 0);
        }
        last = vertex;
        n++;
    }
    if (n < 2) {
        tf_text_fail(text, "a line needs at least 2 vertices");
    }
}

static void read_point(tf_text *text, tf_build *build) {
    double place[3];
    tf_text_place(text, place);
    // A weight, or a colour, may follow.
    for (int i = 0; i < 4 && tf_text_more(text); i++) {
        tf_text_real(text, "a vertex's weight or colour");
    }
    tf_text_row_end(text);
    tf_build_point(build, place);
}

// Faces may name vertices that come later, so these are counted first. What a statement goes on
// with is no vertex.
static size_t count_points(tf_text text) {
    size_t n = 0;
    tf_token token;
    while (tf_text_seek(&text)) {
        n += tf_text_token(&text, &token) && tf_token_is(token, "v");
        while (statement_token(&text, &token)) {
        }
    }
    return n;
}

void tf_read_obj_text(tf_text *text, tf_build *build) {
    const size_t total = count_points(*text);
    tf_token token;
    build->surface = true;
    while (tf_text_seek(text) && tf_text_token(text, &token)) {
        if (tf_token_is(token, "v")) {
            read_point(text, build);
        } else if (tf_token_is(token, "f")) {
            read_face(text, total, build);
        } else if (tf_token_is(token, "l")) {
            read_polyline(text, total, build);
        } else if (is_passed_over(token)) {
            while (statement_token(text, &token)) {
            }
        } else {
            tf_text_fail(text, "'%.*s' is no statement that is read here",
                         (int)(token.size < 40 ? token.size : 40), token.at);
        }
    }
    if (!text->failed && build->points.count == 0) {
        tf_text_fail(text, "there is no vertex in the file");
    }
}
