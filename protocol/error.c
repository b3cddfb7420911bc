// SPDX-License-Identifier: Apache-2.0
/* error.c: the table of error numbers and names (PROTOCOL.md, "Errors"). */
#include "protocol/error.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef struct entry {
  tp_code code;
  const char *name;
} entry;

static const entry table[] = {
    {TP_OK, "ok"},
    {TP_E_PARSE, "parse_error"},
    {TP_E_REQUEST, "invalid_request"},
    {TP_E_METHOD, "method_not_found"},
    {TP_E_PARAMS, "invalid_params"},
    {TP_E_INTERNAL, "internal_error"},
    {TP_E_LINE_TOO_LONG, "line_too_long"},
    {TP_E_BAD_BODY, "bad_body"},
    {TP_E_BODY_TOO_LARGE, "body_too_large"},
    {TP_E_BUSY, "busy"},
    {TP_E_HELLO_REQUIRED, "hello_required"},
    {TP_E_UNAUTHORIZED, "unauthorized"},
    {TP_E_VERSION, "version_unsupported"},
    {TP_E_JOB_UNKNOWN, "job_unknown"},
    {TP_E_ELSEWHERE, "elsewhere"},
    {TP_E_KEY_CONFLICT, "key_conflict"},
    {TP_E_JOB_ACTIVE, "job_active"},
    {TP_E_JOB_FAILED, "job_failed"},
    {TP_E_ARRAY_UNKNOWN, "array_unknown"},
    {TP_E_CHUNK_RANGE, "chunk_range"},
    {TP_E_REQUEST_CANCELLED, "request_cancelled"},
    {TP_E_DRAINING, "draining"},
    {TP_E_JOB_ARGUMENT, "argument"},
    {TP_E_JOB_NOT_FINITE, "not_finite"},
    {TP_E_JOB_INDEX, "index"},
    {TP_E_JOB_DEGENERATE, "degenerate"},
    {TP_E_JOB_NOT_PLANAR, "not_planar"},
    {TP_E_JOB_INTERSECTION, "intersection"},
    {TP_E_JOB_OPEN, "open"},
    {TP_E_JOB_SEED, "seed"},
    {TP_E_JOB_MEMORY, "memory"},
    {TP_E_JOB_VERTEX_LIMIT, "vertex_limit"},
    {TP_E_JOB_DEADLINE, "deadline"},
    {TP_E_JOB_CANCELLED, "cancelled"},
    {TP_E_JOB_TOO_LARGE, "too_large"},
    {TP_E_JOB_ROUNDING, "rounding"},
    {TP_E_JOB_INTERNAL, "internal"},
    {TP_E_UPLOAD, "upload"},
    {TP_E_WORKER_KILLED, "worker_killed"},
    {TP_E_WORKER_CRASHED, "worker_crashed"},
    {TP_E_WORKER_MEMORY, "worker_memory"},
    {TP_E_WORKER_EXITED, "worker_exited"},
    {TP_E_WORKER_LOST, "worker_lost"},
    {TP_E_SPOOL, "spool"},
};

enum { ENTRIES = sizeof table / sizeof table[0] };

const char *tp_code_name(int64_t code) {
  for (unsigned i = 0; i < ENTRIES; i++) {
    if (table[i].code == code) return table[i].name;
  }
  return NULL;
}

tp_code tp_code_of(const char *name) {
  for (unsigned i = 0; i < ENTRIES; i++) {
    if (strcmp(table[i].name, name) == 0) return table[i].code;
  }
  return TP_OK;
}

int tp_code_at(unsigned i, tp_code *ret_code, const char **ret_name) {
  if (i >= ENTRIES) return 0;
  *ret_code = table[i].code;
  *ret_name = table[i].name;
  return 1;
}

/* Texts may echo what a peer sent, cut within a character: what is left of one
 * becomes '?', so that the text can always stand in JSON. */
static void mend(char *text) {
  for (unsigned char *at = (unsigned char *)text; *at != '\0';) {
    const size_t more = *at < 0x80 ? 0 : *at >= 0xf0 ? 3 : *at >= 0xe0 ? 2 : *at >= 0xc0 ? 1 : 4;
    size_t have = 0;
    while (have < more && (at[have + 1] & 0xc0) == 0x80) have++;
    if (more == 4 || have < more) {
      *at++ = '?';
    } else {
      at += more + 1;
    }
  }
}

tp_code tp_fail(tp_error *error, tp_code code, const char *where, const char *format, ...) {
  if (error != NULL) {
    error->code = code;
    snprintf(error->where, sizeof error->where, "%s", where != NULL ? where : "");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    mend(error->where);
    mend(error->message);
  }
  return code;
}
