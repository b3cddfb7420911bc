// SPDX-License-Identifier: Apache-2.0
/* read_ply.c: the Stanford polygon format, version 1.0: ASCII and binary of both
 * byte orders. Of the element `vertex` the properties x, y, z are read, of `face`
 * its first list; everything else is passed over. */
#include "clients/formats/readers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum ply_type { I1, U1, I2, U2, I4, U4, F4, F8, N_TYPES } ply_type;

static const struct {
    const char *names[2];
    size_t size;
} types[N_TYPES] = {{{"char", "int8"}, 1},   {{"uchar", "uint8"}, 1},  {{"short", "int16"}, 2},
                    {{"ushort", "uint16"}, 2}, {{"int", "int32"}, 4},  {{"uint", "uint32"}, 4},
                    {{"float", "float32"}, 4}, {{"double", "float64"}, 8}};

enum { MAX_PROPERTIES = 64, MAX_ELEMENTS = 16 };

typedef enum role { OTHER, AXIS_X, AXIS_Y, AXIS_Z, POLYGON } role;

typedef struct property {
    bool list;
    ply_type count_type, type;
    role role;
} property;

typedef struct element {
    bool vertex, face;
    size_t count, n_properties;
    property properties[MAX_PROPERTIES];
} element;

typedef struct ply {
    tf_text text; /* the header's cursor, and the rows' in ASCII */
    enum { ASCII, LITTLE, BIG } order;
    const char *start; /* of the file, for places in binary ones */
    size_t n_elements;
    element elements[MAX_ELEMENTS];
} ply;

static bool read_type(ply *p, ply_type *ret_type) {
    tf_token token = {"", 0};
    tf_text_token(&p->text, &token);
    for (int t = 0; t < N_TYPES; t++) {
        if (tf_token_is(token, types[t].names[0]) || tf_token_is(token, types[t].names[1])) {
            *ret_type = (ply_type)t;
            return true;
        }
    }
    tf_text_fail(&p->text, "'%.*s' is no type of a property",
                 (int)(token.size < 40 ? token.size : 40), token.at);
    return false;
}

static void read_property(ply *p) {
    element *e = p->n_elements > 0 ? &p->elements[p->n_elements - 1] : NULL;
    if (e == NULL || e->n_properties == MAX_PROPERTIES) {
        tf_text_fail(&p->text, e == NULL ? "a property needs an element before it"
                                         : "more than 64 properties of one element");
        return;
    }
    property next = {false, U1, U1, OTHER};
    tf_text ahead = p->text;
    tf_token token = {"", 0};
    if (tf_text_token(&ahead, &token) && tf_token_is(token, "list")) {
        next.list = true;
        p->text = ahead;
        if (!read_type(p, &next.count_type)) {
            return;
        }
        if (next.count_type == F4 || next.count_type == F8) {
            tf_text_fail(&p->text, "the length of a list is no integer type");
        }
    }
    if (!read_type(p, &next.type)) {
        return;
    }
    if (!tf_text_token(&p->text, &token)) {
        tf_text_fail(&p->text, "a property needs a name");
    }
    tf_text_row_end(&p->text);
    if (e->vertex && !next.list) {
        next.role = tf_token_is(token, "x")   ? AXIS_X
                    : tf_token_is(token, "y") ? AXIS_Y
                    : tf_token_is(token, "z") ? AXIS_Z
                                              : OTHER;
    } else if (e->face && next.list) {
        next.role = POLYGON;
        for (size_t i = 0; i < e->n_properties; i++) {
            next.role = e->properties[i].role == POLYGON ? OTHER : next.role;
        }
    }
    e->properties[e->n_properties++] = next;
}

static void read_element(ply *p) {
    tf_token name = {"", 0};
    if (p->n_elements == MAX_ELEMENTS) {
        tf_text_fail(&p->text, "more than 16 elements");
        return;
    }
    tf_text_token(&p->text, &name);
    element *e = &p->elements[p->n_elements++];
    *e = (element){.vertex = tf_token_is(name, "vertex"), .face = tf_token_is(name, "face")};
    e->count = (size_t)tf_text_integer(&p->text, "the number of elements", 0, UINT32_MAX - 1);
    tf_text_row_end(&p->text);
}

static void read_format(ply *p) {
    tf_token token = {"", 0};
    tf_text_token(&p->text, &token);
    if (tf_token_is(token, "ascii")) {
        p->order = ASCII;
    } else if (tf_token_is(token, "binary_little_endian")) {
        p->order = LITTLE;
    } else if (tf_token_is(token, "binary_big_endian")) {
        p->order = BIG;
    } else {
        tf_text_fail(&p->text, "'%.*s' is no format of .ply files",
                     (int)(token.size < 40 ? token.size : 40), token.at);
    }
}

static bool is_ignored(tf_token token) {
    return tf_token_is(token, "comment") || tf_token_is(token, "obj_info");
}

// Ends behind the newline of end_header.
static void read_header(ply *p) {
    tf_text *text = &p->text;
    tf_token token = {"", 0};
    bool format = false;
    if (!tf_text_token(text, &token) || !tf_token_is(token, "ply")) {
        tf_text_fail(text, "a .ply file begins with ply");
    }
    while (!text->failed) {
        if (!tf_text_row(text) || !tf_text_token(text, &token)) {
            tf_text_fail(text, "the file ends inside the header");
        } else if (tf_token_is(token, "end_header")) {
            break;
        } else if (tf_token_is(token, "format")) {
            read_format(p);
            format = true;
        } else if (tf_token_is(token, "element")) {
            read_element(p);
        } else if (tf_token_is(token, "property")) {
            read_property(p);
        } else if (!is_ignored(token)) {
            tf_text_fail(text, "'%.*s' is no word of a .ply header",
                         (int)(token.size < 40 ? token.size : 40), token.at);
        }
    }
    const char *newline = memchr(text->at, '\n', (size_t)(text->end - text->at));
    if (!text->failed && !format) {
        tf_text_fail(text, "the header names no format");
    }
    text->at = newline != NULL ? newline + 1 : text->end;
    text->line++;
}

static void fail_binary(ply *p, const char *what) {
    if (!p->text.failed) {
        tf_error_set(p->text.error, TF_E_MALFORMED, "%s: byte %zu: %s", p->text.name,
                     (size_t)(p->text.at - p->start), what);
        p->text.failed = true;
    }
}

static double binary_value(ply *p, ply_type type) {
    const size_t size = types[type].size;
    if (p->text.failed) {
        return 0;
    }
    if ((size_t)(p->text.end - p->text.at) < size) {
        fail_binary(p, "the file ends inside its elements");
        return 0;
    }
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++) {
        const size_t shift = 8 * (p->order == BIG ? size - 1 - i : i);
        bits |= (uint64_t)(unsigned char)p->text.at[i] << shift;
    }
    p->text.at += size;
    const uint32_t narrow = (uint32_t)bits;
    float single;
    double value;
    memcpy(&single, &narrow, sizeof single);
    memcpy(&value, &bits, sizeof value);
    switch (type) {
    case I1: return (int8_t)bits;
    case I2: return (int16_t)bits;
    case I4: return (int32_t)bits;
    case F4: return single;
    case F8: return value;
    default: return (double)bits;
    }
}

// One value. `used`: only what is used must be a finite number.
static double next_value(ply *p, ply_type type, bool used) {
    double value = 0;
    if (p->order != ASCII) {
        value = binary_value(p, type);
        if (used && !isfinite(value)) {
            fail_binary(p, "a number is not finite");
        }
        return value;
    }
    if (!p->text.failed && !tf_text_seek(&p->text)) {
        tf_text_fail(&p->text, "the file ends inside its elements");
    } else if (used) {
        value = tf_text_real(&p->text, "a property");
    } else {
        tf_token token;
        tf_text_token(&p->text, &token);
    }
    return value;
}

static void fail(ply *p, const char *what) {
    if (p->order == ASCII) {
        tf_text_fail(&p->text, "%s", what);
    } else {
        fail_binary(p, what);
    }
}

static void read_list(ply *p, const property *list, size_t n_points, tf_build *build) {
    const double length = next_value(p, list->count_type, true);
    if (!p->text.failed &&
        !(length >= 0 && length <= UINT32_MAX && (double)(uint32_t)length == length)) {
        fail(p, "the length of a list is no natural number");
    }
    if (!p->text.failed && list->role == POLYGON && length < 3) {
        fail(p, "a face needs at least 3 vertices");
    }
    for (size_t i = 0; !p->text.failed && (double)i < length; i++) {
        const double value = next_value(p, list->type, list->role == POLYGON);
        if (list->role != POLYGON || p->text.failed) {
            continue;
        }
        if (!(value >= 0 && value < (double)n_points) || (double)(uint32_t)value != value) {
            fail(p, "a face's vertex is out of range");
            return;
        }
        tf_build_polygon_vertex(build, (uint32_t)value);
    }
}

static void read_row(ply *p, const element *e, size_t n_points, tf_build *build) {
    double place[3] = {0, 0, 0};
    bool polygon = false;
    for (size_t i = 0; i < e->n_properties && !p->text.failed; i++) {
        const property *q = &e->properties[i];
        if (q->list) {
            read_list(p, q, n_points, build);
            polygon = polygon || q->role == POLYGON;
        } else {
            const double value = next_value(p, q->type, q->role != OTHER);
            if (q->role != OTHER) {
                place[q->role - AXIS_X] = value;
            }
        }
    }
    if (p->order == ASCII) {
        tf_text_row_end(&p->text);
    }
    if (p->text.failed) {
        return;
    }
    if (e->vertex) {
        tf_build_point(build, place);
    }
    if (polygon) {
        tf_build_polygon_end(build);
        tf_build_facet_end(build, 0);
    }
}

// The number of vertices, where the elements make sense together.
static size_t check_elements(ply *p) {
    size_t n_points = 0;
    int vertices = 0, axes = 0;
    for (size_t i = 0; i < p->n_elements; i++) {
        const element *e = &p->elements[i];
        bool polygon = false;
        for (size_t k = 0; k < e->n_properties; k++) {
            axes |= e->properties[k].role == OTHER ? 0 : 1 << e->properties[k].role;
            polygon = polygon || e->properties[k].role == POLYGON;
        }
        if (e->vertex) {
            n_points = e->count;
            vertices++;
        }
        if (e->face && !polygon) {
            tf_text_fail(&p->text, "the faces have no list of vertices");
        }
        if (e->n_properties == 0 && e->count > 0) {
            tf_text_fail(&p->text, "an element has no properties");
        }
    }
    if (vertices != 1 || (axes >> AXIS_X & 7) != 7) {
        tf_text_fail(&p->text, "the file needs one element vertex with x, y and z");
    }
    return n_points;
}

tf_status tf_read_ply(const tf_file *file, tf_build *build, tf_error *error) {
    ply *p = calloc(1, sizeof *p);
    if (p == NULL) {
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", file->name);
    }
    tf_status status = tf_text_open(file, false, &p->text, error);
    if (status == TF_OK) {
        p->start = file->bytes;
        build->surface = true;
        read_header(p);
        const size_t n_points = p->text.failed ? 0 : check_elements(p);
        for (size_t i = 0; i < p->n_elements && !p->text.failed; i++) {
            for (size_t k = 0; k < p->elements[i].count && !p->text.failed; k++) {
                read_row(p, &p->elements[i], n_points, build);
            }
        }
        // Blank bytes at the end do no harm; anything else is more than was announced.
        if (tf_text_seek(&p->text)) {
            fail(p, "there is more after the last element");
        }
        status = p->text.failed ? error->status : TF_OK;
        tf_text_close(&p->text);
    }
    free(p);
    return status;
}
