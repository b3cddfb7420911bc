// SPDX-License-Identifier: Apache-2.0
/* read_stl.c: stereolithography files, ASCII and binary (3D Systems' layout). Equal
 * points become one vertex, in the order of their first appearance; triangles that
 * have two equal corners are left out. Normals are passed over. */
#include "clients/formats/readers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 80, PREFIX = 84, RECORD = 50 };

// Vertices by place: open addressing, indices + 1 in a table of a power of two.
typedef struct places {
    uint32_t *slots;
    size_t capacity;
} places;

static uint64_t place_hash(const double place[3]) {
    uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
    for (int i = 0; i < 3; i++) {
        const double value = place[i] + 0.0; // -0 is 0
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0xbf58476d1ce4e5b9);
        hash ^= hash >> 31;
    }
    return hash;
}

static const double *point_at(const tf_build *build, size_t i) {
    return (const double *)(const void *)build->points.data + 3 * i;
}

// The slot of `place`: its vertex's, or the free one where it belongs.
static size_t find_slot(const places *table, const tf_build *build, const double place[3]) {
    size_t slot = (size_t)place_hash(place) & (table->capacity - 1);
    while (table->slots[slot] != 0) {
        const double *other = point_at(build, table->slots[slot] - 1);
        if (other[0] == place[0] && other[1] == place[1] && other[2] == place[2]) {
            return slot;
        }
        slot = (slot + 1) & (table->capacity - 1);
    }
    return slot;
}

static bool grow(places *table, const tf_build *build) {
    const size_t capacity = table->capacity == 0 ? 1024 : table->capacity * 2;
    places larger = {calloc(capacity, sizeof(uint32_t)), capacity};
    if (larger.slots == NULL) {
        return false;
    }
    for (size_t i = 0; i < build->points.count; i++) {
        larger.slots[find_slot(&larger, build, point_at(build, i))] = (uint32_t)(i + 1);
    }
    free(table->slots);
    *table = larger;
    return true;
}

static uint32_t vertex_at(places *table, tf_build *build, const double place[3]) {
    if (build->no_memory) {
        return 0;
    }
    if (2 * (build->points.count + 1) > table->capacity && !grow(table, build)) {
        build->no_memory = true;
        return 0;
    }
    const size_t slot = find_slot(table, build, place);
    if (table->slots[slot] == 0) {
        table->slots[slot] = (uint32_t)(build->points.count + 1);
        tf_build_point(build, place);
    }
    return table->slots[slot] - 1;
}

static void add_triangle(places *table, tf_build *build, double corners[3][3]) {
    uint32_t v[3];
    for (int i = 0; i < 3; i++) {
        v[i] = vertex_at(table, build, corners[i]);
    }
    if (build->no_memory || v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        return;
    }
    for (int i = 0; i < 3; i++) {
        tf_build_polygon_vertex(build, v[i]);
    }
    tf_build_polygon_end(build);
    tf_build_facet_end(build, 0);
}

static uint32_t little_u4(const unsigned char *at) {
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static tf_status read_binary(const tf_file *file, places *table, tf_build *build, tf_error *error) {
    const unsigned char *at = (const unsigned char *)file->bytes + PREFIX;
    const size_t n = (file->size - PREFIX) / RECORD;
    for (size_t k = 0; k < n && !build->no_memory; k++, at += RECORD) {
        double corners[3][3];
        for (int i = 0; i < 9; i++) {
            const uint32_t bits = little_u4(at + 12 + 4 * i);
            float value;
            memcpy(&value, &bits, sizeof value);
            if (!isfinite(value)) {
                return tf_error_set(error, TF_E_MALFORMED,
                                    "%s: triangle %zu (byte %zu): a coordinate is not finite",
                                    file->name, k, (size_t)PREFIX + k * RECORD);
            }
            corners[i / 3][i % 3] = value;
        }
        add_triangle(table, build, corners);
    }
    return TF_OK;
}

// Takes the next word of the file if it is `word`.
static bool accept(tf_text *text, const char *word) {
    tf_text ahead = *text;
    tf_token token;
    if (tf_text_seek(&ahead) && tf_text_token(&ahead, &token) && tf_token_is(token, word)) {
        *text = ahead;
        return true;
    }
    return false;
}

static void expect(tf_text *text, const char *word) {
    if (!text->failed && !accept(text, word)) {
        tf_text_seek(text); // the failure's line is that of what stands there
        tf_text_fail(text, "'%s' is expected", word);
    }
}

static void skip_line(tf_text *text) {
    tf_token token;
    while (tf_text_token(text, &token)) {
    }
}

static void read_facet(tf_text *text, places *table, tf_build *build) {
    double corners[3][3];
    skip_line(text); // the normal, which is often (nan nan nan)
    expect(text, "outer");
    expect(text, "loop");
    for (int i = 0; i < 3; i++) {
        expect(text, "vertex");
        tf_text_place(text, corners[i]);
        tf_text_row_end(text);
    }
    expect(text, "endloop");
    expect(text, "endfacet");
    if (!text->failed) {
        add_triangle(table, build, corners);
    }
}

static void read_ascii(tf_text *text, places *table, tf_build *build) {
    do {
        expect(text, "solid");
        skip_line(text);
        while (!text->failed && accept(text, "facet")) {
            read_facet(text, table, build);
        }
        expect(text, "endsolid");
        skip_line(text);
    } while (tf_text_seek(text));
}

tf_status tf_read_stl(const tf_file *file, tf_build *build, tf_error *error) {
    places table = {NULL, 0};
    tf_text text;
    tf_status status;
    const unsigned char *bytes = (const unsigned char *)file->bytes;
    const uint64_t told = file->size >= PREFIX ? little_u4(bytes + HEADER) : 0;
    build->surface = true;
    // Binary files often begin with "solid" too: their length tells.
    if (file->size >= PREFIX && PREFIX + told * RECORD == file->size) {
        status = read_binary(file, &table, build, error);
    } else if ((status = tf_text_open(file, false, &text, error)) == TF_OK) {
        if (accept(&text, "solid")) {
            text.at = file->bytes;
            text.line = 1;
            read_ascii(&text, &table, build);
            status = text.failed ? error->status : TF_OK;
        } else if (file->size >= PREFIX) {
            status = tf_error_set(error, TF_E_MALFORMED,
                                  "%s: a binary .stl of %llu triangles has %llu bytes, this has "
                                  "%zu",
                                  file->name, (unsigned long long)told,
                                  (unsigned long long)(PREFIX + told * RECORD), file->size);
        } else {
            tf_text_fail(&text, "neither an ASCII .stl (which begins with solid) nor a binary one");
            status = error->status;
        }
        tf_text_close(&text);
    }
    free(table.slots);
    return status;
}
