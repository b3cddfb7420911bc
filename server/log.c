// SPDX-License-Identifier: Apache-2.0
/* log.c: see log.h. */
#include "server/log.h"

#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct line_buffer {
  char *bytes;
  size_t size;
} line_buffer;

enum { ROOM = LOG_LINE - 1 }; /* the last byte is the '\n' */

static void put_char(line_buffer *line, char c) {
  if (line->size < ROOM) line->bytes[line->size++] = c;
}

static void put_text(line_buffer *line, const char *text) {
  for (; *text; text++) put_char(line, *text);
}

static void put_format(line_buffer *line, const char *format, ...) {
  char text[64];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  put_text(line, text);
}

/* Characters that stand in a value without quotes. */
static bool plain(const char *value) {
  if (!*value) return false;
  for (; *value; value++) {
    unsigned char c = (unsigned char)*value;
    if (c <= ' ' || c == '"' || c == '=' || c == '\\' || c == 0x7f) return false;
  }
  return true;
}

static void put_value(line_buffer *line, const char *value) {
  if (plain(value)) {
    put_text(line, value);
    return;
  }
  put_char(line, '"');
  for (; *value; value++) {
    unsigned char c = (unsigned char)*value;
    if (c == '"' || c == '\\') {
      put_char(line, '\\');
      put_char(line, (char)c);
    } else if (c < ' ' || c == 0x7f) {
      put_format(line, "\\x%02x", c);
    } else {
      put_char(line, (char)c);
    }
  }
  put_char(line, '"');
}

log_field log_text(const char *key, const char *value) {
  return (log_field){LOG_TEXT, key, value, 0, 0.0};
}
log_field log_int(const char *key, int64_t value) {
  return (log_field){LOG_INTEGER, key, NULL, value, 0.0};
}
log_field log_real(const char *key, double value) {
  return (log_field){LOG_REAL, key, NULL, 0, value};
}

size_t log_format(char bytes[LOG_LINE], double seconds, log_level level, const char *message,
                  const log_field *fields) {
  static const char *const names[] = {"info", "warning", "error"};
  line_buffer line = {bytes, 0};
  double whole = floor(seconds);
  time_t at = (time_t)whole;
  struct tm utc;
  char stamp[32];
  gmtime_r(&at, &utc);
  strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
  put_format(&line, "ts=%s.%03dZ", stamp, (int)((seconds - whole) * 1000.0));
  put_format(&line, " level=%s msg=", names[level]);
  put_value(&line, message);
  for (const log_field *f = fields; f->kind != LOG_END; f++) {
    if (f->kind == LOG_TEXT && !f->text) continue;
    put_char(&line, ' ');
    put_text(&line, f->key);
    put_char(&line, '=');
    if (f->kind == LOG_TEXT) put_value(&line, f->text);
    if (f->kind == LOG_INTEGER) put_format(&line, "%lld", (long long)f->integer);
    if (f->kind == LOG_REAL) put_format(&line, "%.6g", f->real);
  }
  bytes[line.size++] = '\n';
  return line.size;
}

void log_write(log_level level, const char *message, const log_field *fields) {
  char line[LOG_LINE];
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  size_t size =
      log_format(line, (double)now.tv_sec + 1e-9 * (double)now.tv_nsec, level, message, fields);
  /* A reader of the log that stalls costs lines, not time: LOG_LINE fits into a pipe
   * that is writable at all. */
  struct pollfd room = {STDERR_FILENO, POLLOUT, 0};
  if (poll(&room, 1, 0) == 1 && write(STDERR_FILENO, line, size) < 0) return; /* nowhere to tell */
}
