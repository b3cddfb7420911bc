// SPDX-License-Identifier: Apache-2.0
/* error.h: the closed list of protocol errors, their numbers and names.
 *
 * One list for everything that travels as an error: JSON-RPC's own (negative),
 * refusals of a request (1 to 99), and the ways in which a job fails (from 100).
 * PROTOCOL.md, "Errors", tabulates the same list; names and numbers are stable.
 * This header knows nothing of the engine: 100 + n mirrors the engine's status n
 * so that a worker maps one to the other by addition. */
#ifndef TETRAD_PROTOCOL_ERROR_H
#define TETRAD_PROTOCOL_ERROR_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tp_code {
  TP_OK = 0,

  /* JSON-RPC 2.0 */
  TP_E_PARSE = -32700,            /* parse_error: the line is no JSON object; closes */
  TP_E_REQUEST = -32600,          /* invalid_request: not a request as PROTOCOL.md has it */
  TP_E_METHOD = -32601,           /* method_not_found */
  TP_E_PARAMS = -32602,           /* invalid_params: data.where names the param or array */
  TP_E_INTERNAL = -32603,         /* internal_error: our bug, or our memory */

  /* Refusals of a request */
  TP_E_LINE_TOO_LONG = 1,         /* line_too_long; closes */
  TP_E_BAD_BODY = 2,              /* bad_body: `body` is no integer in [0, 2^53]; closes */
  TP_E_BODY_TOO_LARGE = 3,        /* body_too_large: over max_body */
  TP_E_BUSY = 4,                  /* busy: data.retry_ms */
  TP_E_HELLO_REQUIRED = 5,        /* hello_required; closes */
  TP_E_UNAUTHORIZED = 6,          /* unauthorized; closes */
  TP_E_VERSION = 7,               /* version_unsupported: data.protocols */
  TP_E_JOB_UNKNOWN = 8,           /* job_unknown, deleted or expired, or another principal's */
  TP_E_ELSEWHERE = 9,             /* elsewhere: another instance's job; data.instance */
  TP_E_KEY_CONFLICT = 10,         /* key_conflict: the key names another request; data.job */
  TP_E_JOB_ACTIVE = 11,           /* job_active: cancel it before deleting */
  TP_E_JOB_FAILED = 12,           /* job_failed: nothing to fetch; data.state, data.error */
  TP_E_ARRAY_UNKNOWN = 13,        /* array_unknown: the result has no such array */
  TP_E_CHUNK_RANGE = 14,          /* chunk_range: outside the array's chunks */
  TP_E_REQUEST_CANCELLED = 15,    /* request_cancelled, by request.cancel */
  TP_E_DRAINING = 16,             /* draining: the server is going away */

  /* How jobs fail: 100 + the engine's status */
  TP_E_JOB_ARGUMENT = 101,        /* argument */
  TP_E_JOB_NOT_FINITE = 102,      /* not_finite */
  TP_E_JOB_INDEX = 103,           /* index */
  TP_E_JOB_DEGENERATE = 104,      /* degenerate */
  TP_E_JOB_NOT_PLANAR = 105,      /* not_planar */
  TP_E_JOB_INTERSECTION = 106,    /* intersection */
  TP_E_JOB_OPEN = 107,            /* open */
  TP_E_JOB_SEED = 108,            /* seed */
  TP_E_JOB_MEMORY = 120,          /* memory: the job's budget */
  TP_E_JOB_VERTEX_LIMIT = 121,    /* vertex_limit */
  TP_E_JOB_DEADLINE = 122,        /* deadline */
  TP_E_JOB_CANCELLED = 123,       /* cancelled */
  TP_E_JOB_TOO_LARGE = 124,       /* too_large */
  TP_E_JOB_ROUNDING = 140,        /* rounding */
  TP_E_JOB_INTERNAL = 160,        /* internal: the engine's invariant; data.file, data.line */

  /* How jobs fail outside the engine */
  TP_E_UPLOAD = 180,              /* upload: the body does not decode to a PLS; data.where */
  TP_E_WORKER_KILLED = 181,       /* worker_killed from outside; data.signal */
  TP_E_WORKER_CRASHED = 182,      /* worker_crashed: SIGSEGV, SIGABRT ...; data.signal */
  TP_E_WORKER_MEMORY = 183,       /* worker_memory: the system's limit behind the budget */
  TP_E_WORKER_EXITED = 184,       /* worker_exited in mid-job, or broke the protocol */
  TP_E_WORKER_LOST = 185,         /* worker_lost: its node or daemon, twice */
  TP_E_SPOOL = 186                /* spool: the result does not fit or the disk failed */
} tp_code;

enum { TP_JOB_CODE_BASE = 100 };

/* No integer in JSON goes beyond it, either way. */
#define TP_MAX_INTEGER INT64_C(9007199254740992) /* 2^53 */

enum { TP_ERROR_TEXT = 256, TP_ERROR_WHERE = 64 };

/* What a failing call tells. Filled only on failure; passing NULL is allowed. */
typedef struct tp_error {
  tp_code code;
  char message[TP_ERROR_TEXT]; /* one sentence for people, NUL-terminated */
  char where[TP_ERROR_WHERE];  /* the array, param or member meant; "" if none */
} tp_error;

/* The stable name, as "key_conflict"; "ok" for TP_OK, NULL for a number that is
 * not in the list. */
const char *tp_code_name(int64_t code);

/* The number of a name; TP_OK (0) if there is no such error. */
tp_code tp_code_of(const char *name);

/* The list itself: fills *ret_code and *ret_name with entry i (from 0) and
 * returns 1, or returns 0 past its end. For tests and documentation. */
int tp_code_at(unsigned i, tp_code *ret_code, const char **ret_name);

/* Fills *error (if not NULL) and returns `code`: `return tp_fail(error, ...)`.
 * `where` may be NULL. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
tp_code tp_fail(tp_error *error, tp_code code, const char *where, const char *format, ...);

#ifdef __cplusplus
}
#endif
#endif
