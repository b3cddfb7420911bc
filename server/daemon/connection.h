// SPDX-License-Identifier: Apache-2.0
/* connection.h: one client's stream: reading messages, open requests, sending.
 *
 * Knows framing, limits and order; what a method does is methods.h. A connection is
 * never freed inside a call: it is marked dead and freed from the loop, so callers
 * may go on using it until they return. */
#ifndef TETRAD_DAEMON_CONNECTION_H
#define TETRAD_DAEMON_CONNECTION_H

#include <event2/bufferevent.h>
#include <jansson.h>

#include "protocol/frame.h"
#include "server/daemon/server.h"

TAILQ_HEAD(request_list, request);

typedef enum peer_kind { PEER_UNIX, PEER_TCP, PEER_INHERITED } peer_kind;

typedef struct submission submission; /* method_submit.c */
typedef struct fetch fetch;           /* method_fetch.c */

typedef enum request_kind {
  REQUEST_SUBMIT,
  REQUEST_WAIT,
  REQUEST_CANCEL,
  REQUEST_FETCH
} request_kind;

/* A request that could not be answered at once. It is in its connection's list until
 * request_end, and in the waiting list of `job` if that is not NULL. */
struct request {
  TAILQ_ENTRY(request) in_connection, in_job, in_fetching;
  connection *connection;
  request_kind kind;
  json_t *id;
  job *job;
  /* REQUEST_WAIT */
  double every;        /* seconds between notifications; 0: none */
  double last;         /* monotonic, of the last one */
  uint64_t told;       /* job->changes that the last one told */
  struct event *timer; /* pending: tells what changed meanwhile */
  /* REQUEST_SUBMIT */
  submission *submission;
  /* REQUEST_FETCH */
  fetch *fetch;
  bool fetching; /* it is in the connection's list of that name */
};

struct connection {
  TAILQ_ENTRY(connection) link;
  server *server;
  struct bufferevent *bev;
  tp_reader *reader;
  uint64_t number;
  peer_kind peer;
  bool same_uid;       /* a Unix peer of the daemon's uid: its operator */
  char *principal;
  bool hello_required, hello_done;
  struct request_list requests;
  struct request_list fetching; /* fetches that send, in turn */
  unsigned n_requests;
  request *upload;     /* whose body arrives; NULL: bodies are dropped */
  bool in_body;
  bool input_ended, lingering, dead;
  double last_input, last_output; /* monotonic: progress */
  struct event *kick;  /* goes on with what is in the input */
};

/* Takes a connected, non-blocking socket, also on failure. NULL: no memory. */
connection *connection_create(server *server, int fd, peer_kind peer);

/* Ends it now: open requests are forgotten, jobs stay. */
void connection_close(connection *c);

/* Frees what connection_close has marked; for the end of the daemon. */
void connection_free(connection *c);

/* Ends it after what was sent has arrived. Nothing is read any more. */
void connection_linger(connection *c);

/* Closes it if it made no progress for stall_ms. */
void connection_check_stall(connection *c, double now);

/* Bytes that wait to be sent. */
size_t connection_waiting(const connection *c);

/* Sends a reply; `result` is taken (NULL: no memory, an error is sent). */
void connection_reply(connection *c, const json_t *id, json_t *result);

/* Sends an error; `data` is taken and may be NULL. id NULL: null. */
void connection_error(connection *c, const json_t *id, const tp_error *error, json_t *data);

/* The same with a message made here. */
__attribute__((format(printf, 5, 6))) void connection_refuse(connection *c, const json_t *id,
                                                             tp_code code, const char *where,
                                                             const char *format, ...);

/* Sends a notification with `body` bytes to follow; `params` is taken. */
bool connection_notify(connection *c, const char *method, json_t *params, uint64_t body);

/* Opens a request; NULL: no memory (answered). */
request *request_open(connection *c, request_kind kind, const json_t *id);

/* Forgets a request that has been answered, and reads on. */
void request_end(request *r);

/* The open request of that id, or NULL. */
request *request_find(const connection *c, const json_t *id);

/* Makes a request wait for the end of a job: methods.h is called then. */
void request_wait_for(request *r, job *job);

#endif
