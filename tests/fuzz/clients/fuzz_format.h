// SPDX-License-Identifier: Apache-2.0
/* fuzz_format.h: what every reader's fuzz target does: parse, and if the file is
 * accepted, insist that the arrays are a PLS with indices in range. */
#ifndef TETRAD_FUZZ_FORMAT_H
#define TETRAD_FUZZ_FORMAT_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "clients/formats/format.h"

static void check_below(const tp_arrays *set, const char *name, uint64_t limit) {
    const tp_array *array = tp_arrays_find(set, name);
    const uint32_t *v = array != NULL ? array->data : NULL;
    for (uint64_t i = 0; v != NULL && i < array->shape[0] * array->shape[1]; i++) {
        if (v[i] >= limit) {
            abort();
        }
    }
}

static inline int fuzz_format(tf_format format, const uint8_t *data, size_t size) {
    static const char nodes[] = "3 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n";
    const tf_file beside = {"beside.node", nodes, sizeof nodes - 1};
    char *copy = malloc(size + 1); // a file is followed by a 0
    if (copy == NULL) {
        return 0;
    }
    if (size > 0) {
        memcpy(copy, data, size);
    }
    copy[size] = '\0';
    const tf_file file = {"input", copy, size};
    const int wants = (format == TF_POLY || format == TF_SMESH) && tf_wants_nodes(&file);
    tf_pls pls;
    tf_error error = {TF_OK, 0, ""};
    if (tf_parse(format, &file, wants ? &beside : NULL, &pls, &error) == TF_OK) {
        const uint64_t n = tp_arrays_find(&pls.arrays, "points")->shape[0];
        if (tp_arrays_validate(&pls.arrays, tp_schema_pls(), NULL) != TP_OK) {
            abort();
        }
        check_below(&pls.arrays, "triangles", n);
        check_below(&pls.arrays, "polygon_vertices", n);
        check_below(&pls.arrays, "segments", n);
        tf_pls_free(&pls);
    } else if (error.message[0] == '\0') {
        abort(); // a refusal says why
    }
    free(copy);
    return 0;
}

#endif
