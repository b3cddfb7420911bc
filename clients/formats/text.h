// SPDX-License-Identifier: Apache-2.0
/* text.h: a cursor over a text file: lines, tokens, numbers, and the first failure.
 *
 * Failures stick: after the first one (with its line) every call returns nothing
 * useful and changes nothing, so that readers may look once per row. */
#ifndef TETRAD_FORMATS_TEXT_H
#define TETRAD_FORMATS_TEXT_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/formats/format.h"

typedef struct tf_text {
    const char *name;
    const char *at, *end; /* unread bytes; *end is 0 */
    unsigned long line;   /* of `at`, from 1 */
    bool comments;        /* '#' ends a line's tokens */
    locale_t c_locale;    /* shared by copies of the cursor */
    tf_error *error;
    bool failed;
} tf_text;

typedef struct tf_token {
    const char *at;
    size_t size;
} tf_token;

/* Starts at the file's first byte. `error` must not be NULL. Errors: TF_E_MEMORY. */
tf_status tf_text_open(const tf_file *file, bool comments, tf_text *ret_text, tf_error *error);
void tf_text_close(tf_text *text);

/* Fails with TF_E_MALFORMED at the cursor's line (the first failure stands). */
__attribute__((format(printf, 2, 3))) void tf_text_fail(tf_text *text, const char *format, ...);
void tf_text_no_memory(tf_text *text);

/* The next token of this line; false at its end. */
bool tf_text_token(tf_text *text, tf_token *ret_token);

/* Goes to the next token of this or a later line, without taking it; false (no
 * failure) at the end of the file. */
bool tf_text_seek(tf_text *text);

/* Goes to the first token of the next line that has one. */
bool tf_text_row(tf_text *text);

/* Ends the row: fails if tokens are left on this line. */
void tf_text_row_end(tf_text *text);

/* Whether another token stands on this line. */
bool tf_text_more(const tf_text *text);

/* The next token of this line as a finite number; fails, naming `what`, otherwise. */
double tf_text_real(tf_text *text, const char *what);

/* The same as an integer in [low, high]. */
int64_t tf_text_integer(tf_text *text, const char *what, int64_t low, int64_t high);

/* A count of things of which each takes at least `bytes` bytes: fails if so many
 * cannot stand in the rest of the file, so that memory may be had for them. */
size_t tf_text_count(tf_text *text, const char *what, size_t bytes);

/* ASCII case aside. */
bool tf_token_is(tf_token token, const char *word);

/* The number that the whole token is, or false. */
bool tf_token_real(const tf_text *text, tf_token token, double *ret_value);

#endif
