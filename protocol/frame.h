// SPDX-License-Identifier: Apache-2.0
/* frame.h: the framing (one JSON object per line, then `body` bytes) and the
 * JSON-RPC messages on the lines.
 *
 * Independent of sockets: bytes are fed in pieces of any size. The reader keeps
 * at most one unfinished line; bodies are handed on piece by piece out of the
 * caller's own buffer and never held. PROTOCOL.md, "Framing" and "Messages". */
#ifndef TETRAD_PROTOCOL_FRAME_H
#define TETRAD_PROTOCOL_FRAME_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/error.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  TP_MAX_LINE = 65536,    /* bytes of a line, its '\n' included, client and server */
  TP_WORKER_LINE = 1048576, /* between daemon and worker: what 64 KiB become, written anew */
  TP_HELLO_LINE = 4096,   /* before server.hello where that is required */
  TP_MAX_DEPTH = 16,      /* nested objects and lists of a line, the outermost is 1 */
  TP_MAX_ID = 64          /* bytes of a request id that is a string */
};

typedef struct tp_reader tp_reader;

typedef enum tp_step_kind {
  TP_STEP_MORE = 0, /* all bytes were used; feed more */
  TP_STEP_MESSAGE,  /* a line: `json` and `body`; if body > 0, TP_STEP_BODY follow */
  TP_STEP_BODY,     /* a piece of the last message's body; `body` is what remains after it */
  TP_STEP_ERROR     /* the stream is broken: answer with id null and close */
} tp_step_kind;

typedef struct tp_step {
  tp_step_kind kind;
  size_t used;      /* bytes of the fed piece that this step used: skip them */
  json_t *json;     /* MESSAGE: an object, now the caller's (json_decref) */
  uint64_t body;    /* MESSAGE: bytes of the body; BODY: bytes still to come */
  unsigned depth;   /* MESSAGE: depth of nesting; refuse it if over TP_MAX_DEPTH */
  const void *data; /* BODY: the piece, inside the fed bytes */
  size_t size;      /* BODY: its length, at least 1 */
  tp_error error;   /* ERROR: TP_E_LINE_TOO_LONG, TP_E_PARSE, TP_E_BAD_BODY, TP_E_INTERNAL */
} tp_step;

/* A reader for one direction of one connection. `max_line`: bytes of a line with
 * its '\n'. Errors: TP_E_INTERNAL (no memory). Free with tp_reader_free. */
tp_code tp_reader_create(size_t max_line, tp_reader **ret_reader);

/* NULL is fine. */
void tp_reader_free(tp_reader *reader);

/* Changes the limit for lines that are not complete yet (after server.hello). */
void tp_reader_set_max_line(tp_reader *reader, size_t max_line);

/* Takes the next step through `bytes`: fills *ret_step and returns its kind. Call
 * again with the bytes after `used` until it says TP_STEP_MORE (which always uses
 * all). After TP_STEP_ERROR every call gives the same error. A line is refused as
 * soon as it is too long, before it is complete. Lines are parsed with duplicate
 * keys refused. Cost: linear; one copy of each line. */
tp_step_kind tp_reader_next(tp_reader *reader, const void *bytes, size_t size, tp_step *ret_step);

/* Whether the stream may end here: no unfinished line, no body outstanding. */
bool tp_reader_idle(const tp_reader *reader);

/* Nested objects and lists, `json` itself included (a scalar has 0). */
unsigned tp_json_depth(const json_t *json);

typedef enum tp_message_kind {
  TP_REQUEST = 0,  /* id, method, params */
  TP_NOTIFICATION, /* method, params */
  TP_REPLY,        /* id, result */
  TP_ERROR_REPLY   /* id (null allowed), code, text, data */
} tp_message_kind;

/* A view into a parsed line; every pointer lives as long as that json. */
typedef struct tp_message {
  tp_message_kind kind;
  json_t *id;          /* an integer or string; JSON null in some error replies; NULL in notifications */
  const char *method;
  json_t *params;      /* an object, or NULL */
  json_t *result;      /* any JSON */
  int64_t code;        /* of the error */
  const char *name;    /* data.name, else the code's, else "" */
  const char *text;    /* error.message */
  json_t *data;        /* error.data, an object, or NULL */
} tp_message;

/* Reads a line's object as a message. Errors: TP_E_REQUEST for anything that is
 * not one (wrong "jsonrpc", unknown members, id neither an integer within 2^53 nor
 * a string of 1 to 64 bytes, params no object). message->id is set even on failure if a usable
 * id was found, NULL otherwise, so that the error can be answered. */
tp_code tp_message_parse(json_t *json, tp_message *ret_message, tp_error *error);

/* Checks that params (NULL: none) has no member outside `names` (NULL-terminated
 * list). Errors: TP_E_PARAMS, `where` the first unknown one. */
tp_code tp_params_known(const json_t *params, const char *const *names, tp_error *error);

/* Builders. Each gives one line with its '\n' in *ret_line (malloc; the caller
 * frees) and its length; borrows its JSON arguments. `body`: bytes that the caller
 * sends after the line; 0 leaves the member out. Errors: TP_E_INTERNAL (no memory);
 * TP_E_LINE_TOO_LONG (over TP_WORKER_LINE; the caller sees to TP_MAX_LINE where that
 * holds, by *ret_size); outputs untouched. */

/* {"jsonrpc":"2.0","id":ID,"method":M,"body":B,"params":P}. params may be NULL. */
tp_code tp_build_request(const json_t *id, const char *method, const json_t *params, uint64_t body,
                         char **ret_line, size_t *ret_size);

/* As a request, without id. */
tp_code tp_build_notification(const char *method, const json_t *params, uint64_t body,
                              char **ret_line, size_t *ret_size);

/* {"jsonrpc":"2.0","id":ID,"result":R}. */
tp_code tp_build_reply(const json_t *id, const json_t *result, char **ret_line, size_t *ret_size);

/* {"jsonrpc":"2.0","id":ID|null,"error":E}, E as tp_error_json. id and data may be NULL. */
tp_code tp_build_error(const json_t *id, const tp_error *error, const json_t *data, char **ret_line,
                       size_t *ret_size);

/* {"code":C,"message":TEXT,"data":{"name":NAME,"where":WHERE,...data}}: the error
 * object of replies, job.failed and job.status. A new reference; NULL: no memory. */
json_t *tp_error_json(const tp_error *error, const json_t *data);

#ifdef __cplusplus
}
#endif
#endif
