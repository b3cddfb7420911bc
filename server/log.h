// SPDX-License-Identifier: Apache-2.0
/* log.h: logfmt lines on standard error, for the daemon and its workers.
 *
 *   LOG(LOG_INFO, "job ended", log_text("job", id), log_real("seconds", s));
 *   ts=2026-01-31T12:00:00.123Z level=info msg="job ended" job=k3v9x.1 seconds=0.120
 *
 * One write(2) per line, so that lines of several processes do not mix; a line that
 * would have to wait is lost. Values with other than plain characters are quoted and
 * escaped; a line over LOG_LINE bytes is cut. */
#ifndef TETRAD_SERVER_LOG_H
#define TETRAD_SERVER_LOG_H

#include <stddef.h>
#include <stdint.h>

typedef enum log_level { LOG_INFO = 0, LOG_WARNING, LOG_ERROR } log_level;
enum { LOG_LINE = 2048 };

typedef enum log_kind { LOG_END = 0, LOG_TEXT, LOG_INTEGER, LOG_REAL } log_kind;

typedef struct log_field {
  log_kind kind;
  const char *key;
  const char *text;
  int64_t integer;
  double real;
} log_field;

log_field log_text(const char *key, const char *value); /* NULL: the field is left out */
log_field log_int(const char *key, int64_t value);
log_field log_real(const char *key, double value);

/* Formats one line with its '\n' into `line`; returns its length. `fields` ends
 * with kind LOG_END. `seconds`: since 1970. */
size_t log_format(char line[LOG_LINE], double seconds, log_level level, const char *message,
                  const log_field *fields);

/* Formats with the present time and writes to standard error; errors are ignored. */
void log_write(log_level level, const char *message, const log_field *fields);

#define LOG(level, ...) LOG_FIELDS(level, __VA_ARGS__, (log_field){LOG_END, NULL, NULL, 0, 0.0})
#define LOG_FIELDS(level, message, ...) log_write(level, message, (const log_field[]){__VA_ARGS__})

#endif
