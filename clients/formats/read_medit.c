// SPDX-License-Identifier: Apache-2.0
/* read_medit.c: Medit's ASCII .mesh: Vertices, Triangles, Quadrilaterals and Edges,
 * whose references are the markers. Edges become loose segments. Other sections
 * (Tetrahedra, Corners, Ridges, required entities ...) are passed over. */
#include "clients/formats/readers.h"

#include <string.h>

typedef struct section {
    const char *name;
    int vertices; /* per row; 0: the vertices themselves */
} section;

static const section sections[] = {
    {"Vertices", 0}, {"Triangles", 3}, {"Quadrilaterals", 4}, {"Edges", 2}};

static bool is_keyword(tf_token token) {
    const char c = token.at[0];
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

// Entries may be broken over lines anywhere.
static bool need_more(tf_text *text, const char *name) {
    if (!text->failed && !tf_text_seek(text)) {
        tf_text_fail(text, "the file ends inside %s", name);
    }
    return !text->failed;
}

static double next_real(tf_text *text, const char *name) {
    return need_more(text, name) ? tf_text_real(text, name) : 0;
}

static int64_t next_integer(tf_text *text, const char *name, int64_t low, int64_t high) {
    return need_more(text, name) ? tf_text_integer(text, name, low, high) : low;
}

static void skip_section(tf_text *text) {
    tf_text ahead = *text;
    tf_token token;
    while (tf_text_seek(&ahead) && tf_text_token(&ahead, &token) && !is_keyword(token)) {
        *text = ahead;
    }
}

static void read_vertices(tf_text *text, tf_build *build) {
    need_more(text, "Vertices");
    const size_t n = tf_text_count(text, "the number of Vertices", sizeof "0 0 0 0");
    for (size_t i = 0; i < n && !text->failed; i++) {
        double place[3];
        for (int k = 0; k < 3; k++) {
            place[k] = next_real(text, "a coordinate of Vertices");
        }
        tf_build_point(build, place);
        tf_build_point_marker(build, (int32_t)next_integer(text, "a reference of Vertices",
                                                           INT32_MIN, INT32_MAX));
    }
}

static void read_elements(tf_text *text, const section *kind, tf_build *build) {
    need_more(text, kind->name);
    const size_t n =
        tf_text_count(text, "the number of elements", 2 * ((size_t)kind->vertices + 1));
    const int64_t n_points = (int64_t)build->points.count;
    for (size_t i = 0; i < n && !text->failed; i++) {
        uint32_t v[4] = {0, 0, 0, 0};
        for (int k = 0; k < kind->vertices; k++) {
            v[k] = (uint32_t)(next_integer(text, "an element's vertex", 1, n_points) - 1);
        }
        const int32_t marker =
            (int32_t)next_integer(text, "an element's reference", INT32_MIN, INT32_MAX);
        if (kind->vertices == 2) {
            tf_build_segment(build, v[0], v[1], marker);
            continue;
        }
        for (int k = 0; k < kind->vertices; k++) {
            tf_build_polygon_vertex(build, v[k]);
        }
        tf_build_polygon_end(build);
        tf_build_facet_end(build, marker);
    }
}

// One pass over the sections: the vertices alone, or everything but them. Elements
// may stand before the vertices that they name.
static void read_sections(tf_text *text, bool vertices, tf_build *build) {
    tf_token token;
    while (tf_text_seek(text) && tf_text_token(text, &token) && !tf_token_is(token, "End")) {
        const section *kind = NULL;
        for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
            if (tf_token_is(token, sections[i].name)) {
                kind = &sections[i];
            }
        }
        if (!is_keyword(token)) {
            tf_text_fail(text, "a keyword is expected, not '%.*s'",
                         (int)(token.size < 40 ? token.size : 40), token.at);
        } else if (tf_token_is(token, "Dimension")) {
            next_integer(text, "the Dimension", 3, 3);
        } else if (kind == NULL || (kind->vertices == 0) != vertices) {
            skip_section(text);
        } else if (vertices) {
            read_vertices(text, build);
        } else {
            read_elements(text, kind, build);
        }
    }
}

void tf_read_medit_text(tf_text *text, tf_build *build) {
    tf_text again = *text;
    build->surface = true;
    read_sections(text, true, build);
    if (!text->failed && build->points.count == 0) {
        tf_text_fail(text, "there are no Vertices in the file");
    }
    if (!text->failed) {
        read_sections(&again, false, build);
        text->failed = again.failed;
    }
}
