// SPDX-License-Identifier: Apache-2.0
/* text.c: lines, tokens and numbers of text files. Knows no format. */
#include "clients/formats/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

tf_status tf_text_open(const tf_file *file, bool comments, tf_text *ret_text, tf_error *error) {
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0) {
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", file->name);
    }
    *ret_text = (tf_text){.name = file->name,
                          .at = file->bytes,
                          .end = file->bytes + file->size,
                          .line = 1,
                          .comments = comments,
                          .c_locale = c_locale,
                          .error = error};
    return TF_OK;
}

void tf_text_close(tf_text *text) {
    freelocale(text->c_locale);
}

void tf_text_fail(tf_text *text, const char *format, ...) {
    if (text->failed) {
        return;
    }
    char what[384];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    // At the end of the file the last line is to blame, not the one that would come.
    const bool past_the_last = text->at == text->end && text->line > 1 && text->at[-1] == '\n';
    const unsigned long line = text->line - past_the_last;
    tf_error_set(text->error, TF_E_MALFORMED, "%s:%lu: %s", text->name, line, what);
    text->error->line = line;
    text->failed = true;
}

void tf_text_no_memory(tf_text *text) {
    if (!text->failed) {
        tf_error_set(text->error, TF_E_MEMORY, "%s: no memory", text->name);
        text->failed = true;
    }
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

// Past blanks; at a comment, to the end of its line.
static const char *skip_blanks(const tf_text *text) {
    const char *at = text->at;
    while (at < text->end && is_blank(*at)) {
        at++;
    }
    if (text->comments && at < text->end && *at == '#') {
        const char *newline = memchr(at, '\n', (size_t)(text->end - at));
        at = newline != NULL ? newline : text->end;
    }
    return at;
}

bool tf_text_more(const tf_text *text) {
    const char *at = skip_blanks(text);
    return !text->failed && at < text->end && *at != '\n';
}

bool tf_text_token(tf_text *text, tf_token *ret_token) {
    if (!tf_text_more(text)) {
        return false;
    }
    text->at = skip_blanks(text);
    const char *end = text->at;
    while (end < text->end && !is_blank(*end) && *end != '\n' && !(text->comments && *end == '#')) {
        end++;
    }
    *ret_token = (tf_token){text->at, (size_t)(end - text->at)};
    text->at = end;
    return true;
}

bool tf_text_seek(tf_text *text) {
    while (!text->failed) {
        text->at = skip_blanks(text);
        if (text->at == text->end) {
            return false;
        }
        if (*text->at != '\n') {
            return true;
        }
        text->at++;
        text->line++;
    }
    return false;
}

bool tf_text_row(tf_text *text) {
    if (text->failed) {
        return false;
    }
    const char *newline = memchr(text->at, '\n', (size_t)(text->end - text->at));
    text->at = newline != NULL ? newline : text->end;
    return tf_text_seek(text);
}

void tf_text_row_end(tf_text *text) {
    tf_token token;
    if (tf_text_token(text, &token)) {
        tf_text_fail(text, "'%.*s' is more than belongs on this line",
                     (int)(token.size < 40 ? token.size : 40), token.at);
    }
}

bool tf_token_is(tf_token token, const char *word) {
    return token.size == strlen(word) && strncasecmp(token.at, word, token.size) == 0;
}

bool tf_token_real(const tf_text *text, tf_token token, double *ret_value) {
    for (size_t i = 0; i < token.size; i++) {
        const char c = token.at[i];
        if (!((c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E')) {
            return false;
        }
    }
    // What follows the token (a blank, a comment or the final 0) stops strtod.
    char *end;
    const double value = strtod_l(token.at, &end, text->c_locale);
    if (token.size == 0 || end != token.at + token.size || !isfinite(value)) {
        return false;
    }
    *ret_value = value;
    return true;
}

double tf_text_real(tf_text *text, const char *what) {
    tf_token token;
    double value = 0;
    if (text->failed) {
        return 0;
    }
    if (!tf_text_token(text, &token)) {
        tf_text_fail(text, "%s is missing", what);
    } else if (!tf_token_real(text, token, &value)) {
        tf_text_fail(text, "%s is expected, '%.*s' is no finite number", what,
                     (int)(token.size < 40 ? token.size : 40), token.at);
    }
    return value;
}

int64_t tf_text_integer(tf_text *text, const char *what, int64_t low, int64_t high) {
    const double value = tf_text_real(text, what);
    if (text->failed) {
        return low;
    }
    if (!(value >= -9007199254740992.0 && value <= 9007199254740992.0) ||
        (double)(int64_t)value != value) {
        tf_text_fail(text, "%s is expected, %.17g is no integer", what, value);
        return low;
    }
    const int64_t integer = (int64_t)value;
    if (integer != low && low == high) {
        tf_text_fail(text, "%s is %" PRId64 ", not %" PRId64, what, integer, low);
        return low;
    }
    if (integer < low || integer > high) {
        tf_text_fail(text, "%s is %" PRId64 ", outside %" PRId64 " to %" PRId64, what, integer, low,
                     high);
        return low;
    }
    return integer;
}

size_t tf_text_count(tf_text *text, const char *what, size_t bytes) {
    const size_t count = (size_t)tf_text_integer(text, what, 0, UINT32_MAX - 1);
    // The last of them needs no line end.
    if (!text->failed && count > ((size_t)(text->end - text->at) + 1) / bytes) {
        tf_text_fail(text, "%s is %zu, more than the rest of the file can hold", what, count);
    }
    return text->failed ? 0 : count;
}
