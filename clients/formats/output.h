// SPDX-License-Identifier: Apache-2.0
/* output.h: errors of the formats, and files that appear together or not at all.
 *
 * Each file is written under a temporary name in its own folder and renamed when
 * all of the set are complete. */
#ifndef TETRAD_FORMATS_OUTPUT_H
#define TETRAD_FORMATS_OUTPUT_H

#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tf_status {
    TF_OK = 0,
    TF_E_OPEN,      /* the file cannot be read */
    TF_E_FORMAT,    /* no format of that extension can be read (or written) */
    TF_E_MALFORMED, /* the file is not what its extension says */
    TF_E_WRITE,     /* the file cannot be written */
    TF_E_MEMORY
} tf_status;

/* Filled by a failing call only. */
typedef struct tf_error {
    tf_status status;
    unsigned long line; /* TF_E_MALFORMED: the line, from 1; 0 where there are no lines */
    char message[512];  /* begins with the file's name (and :line) */
} tf_error;

/* Fills *error (if not NULL) and returns `status`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
tf_status tf_error_set(tf_error *error, tf_status status, const char *format, ...);

enum { TF_MAX_OUTPUTS = 16 };

typedef struct tf_output {
    char *path;
    char *temporary;
    FILE *file;
} tf_output;

typedef struct tf_outputs {
    tf_output items[TF_MAX_OUTPUTS];
    size_t count;
} tf_outputs;

#define TF_OUTPUTS_INIT {.count = 0}

/* Checks that a file can be created beside `path` and that `path` is no folder.
 * Errors: TF_E_WRITE, TF_E_MEMORY. */
tf_status tf_output_check(const char *path, tf_error *error);

/* Adds a file to the set; *ret_file, open for writing, stays the set's. Errors:
 * TF_E_WRITE, TF_E_MEMORY. */
tf_status tf_outputs_add(tf_outputs *set, const char *path, FILE **ret_file, tf_error *error);

/* Flushes, closes and renames all files; the set is empty afterwards. On failure
 * (TF_E_WRITE) files that were not yet renamed are removed. */
tf_status tf_outputs_commit(tf_outputs *set, tf_error *error);

/* Removes the temporary files; the set is empty afterwards. */
void tf_outputs_drop(tf_outputs *set);

#ifdef __cplusplus
}
#endif
#endif
