// SPDX-License-Identifier: Apache-2.0
/* client_internal.h: the connection behind client.h and the one way to use it.
 *
 * One request at a time: tc_call writes it (body included) while it reads, hands
 * notifications on, and ends with the reply. What comes for requests that were given up
 * is dropped. */
#ifndef TETRAD_CLIENT_INTERNAL_H
#define TETRAD_CLIENT_INTERNAL_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

#include "protocol/codec.h"
#include "protocol/frame.h"
#include "tetrad/client.h"

/* A private daemon. */
typedef struct tc_daemon {
    int pidfd; /* -1: none */
    int log;   /* a memfd with the daemon's standard error */
    pid_t pid;
} tc_daemon;

struct tetrad_client {
    int fd;
    int wake; /* eventfd, written by tetrad_interrupt */
    atomic_bool interrupted;
    bool local; /* a Unix socket or a private daemon: bytes are cheap */
    bool broken;
    tc_daemon daemon;
    tp_reader *reader;
    int64_t last_id;
    tp_bytes body; /* of the message being read */
    unsigned char *input;
};

enum { TC_INPUT = 1 << 18, TC_MAX_LINE = 1 << 20, TC_PROGRESS_MS = 50 };

/* What a call does with the notifications that belong to it. take_line sees a message
 * before its body: it sets *ret_limit, the most bytes that body may have (it is 0
 * before), or refuses by returning a status. take_body sees the whole body (also an
 * empty one). NULL: notifications are ignored. */
typedef struct tc_listener {
    tetrad_status (*take_line)(void *user, const tp_message *message, uint64_t *ret_limit,
                               tetrad_error *error);
    tetrad_status (*take_body)(void *user, const unsigned char *body, size_t size,
                               tetrad_error *error);
    void *user;
} tc_listener;

/* Sends a request (params are borrowed, NULL: none) and its body; gives the result (a
 * new reference) in *ret_result. */
tetrad_status tc_call(tetrad_client *client, const char *method, const json_t *params,
                      const tp_bytes *body, const tc_listener *listener, json_t **ret_result,
                      tetrad_error *error);

/* Fills *error (if not NULL) and returns `status`. */
__attribute__((format(printf, 3, 4)))
tetrad_status tc_fail(tetrad_error *error, tetrad_status status, const char *format, ...);

tetrad_status tc_no_memory(tetrad_error *error);

/* Starts a daemon on one end of a socketpair; *ret_fd is the other. */
tetrad_status tc_daemon_start(tc_daemon *ret_daemon, int *ret_fd, tetrad_error *error);

/* Waits for its end (its socket is closed already), for a while; then kills it. */
void tc_daemon_end(tc_daemon *daemon);

/* Keeps the log small. */
void tc_daemon_trim_log(const tc_daemon *daemon);

/* The last line that it logged, in `line`, "" if there is none. */
void tc_daemon_last_words(const tc_daemon *daemon, char *line, size_t size);

#endif
