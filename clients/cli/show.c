// SPDX-License-Identifier: Apache-2.0
/* show.c: what tetractl tells people: failures, progress, the summary of a mesh. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "clients/cli/cli.h"

int show_failure(const tetrad_error *error) {
    switch (error->status) {
    case TETRAD_E_INTERRUPTED: complain("interrupted"); return STATUS_INTERRUPTED;
    case TETRAD_E_REFUSED:
        complain("the server refuses: %s (%s)%s%s", error->message, error->name,
                 error->where[0] != '\0' ? ": " : "", error->where);
        return strcmp(error->name, "job_failed") == 0 || strcmp(error->name, "body_too_large") == 0
                   ? STATUS_JOB
                   : STATUS_CONNECTION;
    case TETRAD_E_ARGUMENT: complain("%s", error->message); return STATUS_USAGE;
    default: complain("%s", error->message); return STATUS_CONNECTION;
    }
}

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text != NULL ? text : "";
}

// "facet 3 (marker 5)", numbered from 0 as in the message.
static void print_element(const json_t *offence, size_t i) {
    const char *kind = json_string_value(json_array_get(json_object_get(offence, "kind"), i));
    const json_t *marker = json_array_get(json_object_get(offence, "marker"), i);
    const json_int_t index =
        json_integer_value(json_array_get(json_object_get(offence, "index"), i));
    fprintf(stderr, "%s %" JSON_INTEGER_FORMAT, kind != NULL ? kind : "element", index);
    if (json_integer_value(marker) != 0) {
        fprintf(stderr, " (marker %" JSON_INTEGER_FORMAT ")", json_integer_value(marker));
    }
}

static void print_offences(const json_t *offences, int first_index) {
    const json_t *list = json_object_get(offences, "list"), *offence;
    const json_int_t count = json_integer_value(json_object_get(offences, "count"));
    size_t i;
    if (first_index != 0 && json_array_size(list) > 0) {
        fputs("  (numbered from 0, though the file's vertices are numbered from 1)\n", stderr);
    }
    json_array_foreach(list, i, offence) {
        const json_t *place = json_object_get(offence, "place");
        fputs("  ", stderr);
        print_element(offence, 0);
        if (json_array_size(json_object_get(offence, "kind")) > 1) {
            fputs(" and ", stderr);
            print_element(offence, 1);
        }
        if (json_array_size(place) == 3) {
            fprintf(stderr, " near (%.10g, %.10g, %.10g)",
                    json_number_value(json_array_get(place, 0)),
                    json_number_value(json_array_get(place, 1)),
                    json_number_value(json_array_get(place, 2)));
        }
        fputc('\n', stderr);
    }
    if (count > (json_int_t)json_array_size(list)) {
        fprintf(stderr, "  and %" JSON_INTEGER_FORMAT " more\n",
                count - (json_int_t)json_array_size(list));
    }
}

int show_job_failure(const json_t *job, const char *subject, int first_index) {
    const json_t *error = json_object_get(job, "error");
    const json_t *data = json_object_get(error, "data");
    const json_int_t code = json_integer_value(json_object_get(error, "code"));
    const json_int_t repeated = json_integer_value(json_object_get(
        json_object_get(json_object_get(job, "report"), "counts"), "repeated_facets"));
    // Codes 101 to 119 are what the engine has against the input (PROTOCOL.md, 9).
    const bool refused = code > 100 && code < 120;
    complain("%s: %s%s (%s)", subject, refused ? "refused: " : "", text_of(error, "message"),
             text_of(data, "name"));
    print_offences(json_object_get(data, "offences"), first_index);
    if (repeated > 0) {
        fprintf(stderr, "  repeated facets: %" JSON_INTEGER_FORMAT "\n", repeated);
    }
    return refused ? STATUS_REFUSED : STATUS_JOB;
}

enum { BAR = 24 };

void progress_show(void *user, const tetrad_progress *progress) {
    progress_line *line = user;
    char bar[BAR + 1];
    if (!line->terminal) {
        return;
    }
    memset(bar, ' ', BAR);
    bar[BAR] = '\0';
    const bool known = progress->fraction >= 0 && progress->fraction <= 1;
    memset(bar, '#', known ? (size_t)(progress->fraction * BAR) : 0);
    char percent[8] = "    ";
    if (known) {
        snprintf(percent, sizeof percent, "%3.0f%%", progress->fraction * 100);
    }
    fprintf(stderr, "\r\033[K[%s] %s %s", bar, percent,
            progress->stage[0] != '\0' ? progress->stage : progress->state);
    if (progress->tetrahedra > 0) {
        fprintf(stderr, ": %" PRIu64 " vertices, %" PRIu64 " tetrahedra", progress->vertices,
                progress->tetrahedra);
    }
    fflush(stderr);
    line->drawn = true;
}

void progress_clear(progress_line *line) {
    if (line->drawn) {
        fputs("\r\033[K", stderr);
        line->drawn = false;
    }
}

static double number_at(const json_t *object, const char *a, const char *b) {
    return json_number_value(json_object_get(json_object_get(object, a), b));
}

static json_int_t count_at(const json_t *object, const char *a, const char *b) {
    return json_integer_value(json_object_get(json_object_get(object, a), b));
}

static const char *promise_of(const json_t *promised) {
    const bool gabriel = json_is_true(json_object_get(promised, "gabriel"));
    if (json_is_true(json_object_get(promised, "delaunay"))) {
        return gabriel ? "boundary conforming Delaunay" : "Delaunay";
    }
    return json_is_true(json_object_get(promised, "constrained_delaunay"))
               ? (gabriel ? "constrained Delaunay, Gabriel" : "constrained Delaunay")
               : "nothing";
}

void show_summary(const json_t *report, const char *output) {
    const json_t *quality = json_object_get(report, "quality"), *stage;
    const json_t *promised = json_object_get(report, "promised");
    const double bound = json_number_value(json_object_get(promised, "radius_edge"));
    const double least = json_number_value(json_object_get(promised, "min_dihedral"));
    double seconds = 0;
    size_t i;
    json_array_foreach(json_object_get(report, "stages"), i, stage) {
        seconds += json_number_value(json_object_get(stage, "seconds"));
    }
    printf("%s: %" JSON_INTEGER_FORMAT " vertices, %" JSON_INTEGER_FORMAT
           " tetrahedra, %.3g s\n",
           output, count_at(report, "counts", "vertices"), count_at(report, "counts", "tetrahedra"),
           seconds);
    printf("  radius-edge   worst %.4g", number_at(quality, "radius_edge", "max"));
    if (bound > 0) {
        printf(", bound %.4g%s, exceptions %" JSON_INTEGER_FORMAT, bound,
               json_is_false(json_object_get(promised, "radius_edge_proven"))
                   ? " (below 1.414: no guarantee)"
                   : "",
               count_at(report, "exceptions", "count"));
    }
    printf("\n  dihedral      %.4g to %.4g degrees", number_at(quality, "dihedral_min", "min"),
           number_at(quality, "dihedral_max", "max"));
    if (least > 0) {
        printf(", bound %.4g, slivers %" JSON_INTEGER_FORMAT, least,
               count_at(report, "slivers", "count"));
    }
    putchar('\n');
    if (json_object_get(report, "voronoi") != NULL) {
        printf("  Voronoi       %" JSON_INTEGER_FORMAT " cells, %" JSON_INTEGER_FORMAT
               " edges, negative factors %" JSON_INTEGER_FORMAT "\n",
               count_at(report, "voronoi", "cells"), count_at(report, "voronoi", "edges"),
               count_at(report, "voronoi", "negative_factors"));
    }
    printf("  promised      %s; audit %s\n", promise_of(promised),
           json_is_true(json_object_get(json_object_get(report, "audit"), "passed")) ? "passed"
                                                                                  : "failed");
}
