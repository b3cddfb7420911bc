// SPDX-License-Identifier: Apache-2.0
/* exchange.c: one request and its reply over the connection, written while it reads
 * (PROTOCOL.md, 2: a client must go on reading while it writes). */
#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/c/client_internal.h"

tetrad_status tc_fail(tetrad_error *error, tetrad_status status, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        memset(error, 0, sizeof *error);
        error->status = status;
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

tetrad_status tc_no_memory(tetrad_error *error) {
    return tc_fail(error, TETRAD_E_MEMORY, "out of memory");
}

typedef struct exchange {
    tetrad_client *client;
    int64_t id;
    const tc_listener *listener;
    struct {
        const char *data;
        size_t size;
    } out[2]; /* line and body, what is left of them */
    size_t line_size; /* whole */
    bool wanted; /* the body being read belongs to this call */
    bool sending_failed;
    bool done;
    json_t *result;
    tetrad_error *error;
} exchange;

static tetrad_status broken(exchange *x, const char *what) {
    x->client->broken = true;
    return tc_fail(x->error, TETRAD_E_PROTOCOL, "the server broke the protocol: %s", what);
}

static tetrad_status lost(exchange *x, const char *why) {
    char words[256];
    x->client->broken = true;
    tc_daemon_last_words(&x->client->daemon, words, sizeof words);
    return tc_fail(x->error, TETRAD_E_CONNECTION, "the connection was lost: %s%s%s", why,
                   words[0] != '\0' ? "; the daemon's last words: " : "", words);
}

static void copy_text(char *to, size_t size, const char *from) {
    snprintf(to, size, "%s", from != NULL ? from : "");
}

// An error reply, to this request or (id null) to the connection.
static tetrad_status refused(exchange *x, const tp_message *message) {
    tc_fail(x->error, TETRAD_E_REFUSED, "%s", message->text);
    if (x->error != NULL) {
        x->error->code = message->code;
        copy_text(x->error->name, sizeof x->error->name, message->name);
        copy_text(x->error->where, sizeof x->error->where,
                  json_string_value(json_object_get(message->data, "where")));
        x->error->retry_ms = json_integer_value(json_object_get(message->data, "retry_ms"));
    }
    x->done = true;
    return TETRAD_E_REFUSED;
}

static bool is_mine(const exchange *x, const json_t *id) {
    return json_is_integer(id) && json_integer_value(id) == x->id;
}

static tetrad_status take_notification(exchange *x, const tp_message *message, uint64_t body,
                                       bool *ret_wants_body) {
    uint64_t limit = 0;
    if (x->listener == NULL || !is_mine(x, json_object_get(message->params, "of"))) {
        return TETRAD_OK;
    }
    const tetrad_status status =
        x->listener->take_line(x->listener->user, message, &limit, x->error);
    if (status == TETRAD_OK && body > limit) {
        return broken(x, "a body is larger than it can be");
    }
    *ret_wants_body = status == TETRAD_OK;
    return status;
}

static tetrad_status finish_body(exchange *x) {
    tp_bytes *body = &x->client->body;
    return x->listener->take_body == NULL
               ? TETRAD_OK
               : x->listener->take_body(x->listener->user, body->data, body->size, x->error);
}

static tetrad_status take_message(exchange *x, const tp_step *step) {
    tp_message message;
    tetrad_status status = TETRAD_OK;
    bool wants_body = false;
    if (tp_message_parse(step->json, &message, NULL) != TP_OK) {
        return broken(x, "a line is no message");
    }
    switch (message.kind) {
    case TP_REPLY:
        if (is_mine(x, message.id)) {
            x->result = json_incref(message.result);
            x->done = true;
        }
        break;
    case TP_ERROR_REPLY:
        if (is_mine(x, message.id)) {
            status = refused(x, &message);
        } else if (json_is_null(message.id)) {
            x->client->broken = true; // it closes the connection
            status = refused(x, &message);
        }
        break;
    case TP_NOTIFICATION: status = take_notification(x, &message, step->body, &wants_body); break;
    case TP_REQUEST: return broken(x, "it sent a request");
    }
    x->client->body.size = 0;
    x->wanted = wants_body;
    return status == TETRAD_OK && wants_body && step->body == 0 ? finish_body(x) : status;
}

static tetrad_status take_piece(exchange *x, const tp_step *step) {
    tp_bytes *body = &x->client->body;
    if (!x->wanted) {
        return TETRAD_OK; // nobody wants it
    }
    if (tp_bytes_reserve(body, step->size) != TP_OK) {
        return tc_no_memory(x->error);
    }
    memcpy(body->data + body->size, step->data, step->size);
    body->size += step->size;
    return step->body == 0 ? finish_body(x) : TETRAD_OK;
}

// Steps through `size` bytes of input, all of them also after a failure, so that the
// stream stays in step; the first failure counts.
static tetrad_status take_input(exchange *x, const unsigned char *bytes, size_t size) {
    tetrad_status first = TETRAD_OK;
    for (;;) {
        tp_step step;
        tetrad_status status = TETRAD_OK;
        const tp_step_kind kind = tp_reader_next(x->client->reader, bytes, size, &step);
        if (kind == TP_STEP_MORE) {
            return first;
        }
        if (kind == TP_STEP_ERROR) {
            return first != TETRAD_OK ? first : broken(x, step.error.message);
        }
        if (kind == TP_STEP_MESSAGE) {
            if (first == TETRAD_OK) {
                status = take_message(x, &step);
            }
            json_decref(step.json);
        } else if (first == TETRAD_OK) {
            status = take_piece(x, &step);
        }
        first = first != TETRAD_OK ? first : status;
        bytes += step.used;
        size -= step.used;
    }
}

static tetrad_status read_some(exchange *x) {
    const ssize_t n = recv(x->client->fd, x->client->input, TC_INPUT, MSG_DONTWAIT);
    if (n > 0) {
        return take_input(x, x->client->input, (size_t)n);
    }
    if (n == 0) {
        return lost(x, "the server closed it");
    }
    return errno == EAGAIN || errno == EINTR ? TETRAD_OK : lost(x, strerror(errno));
}

// Where the server will not read any more, its reply may still be on its way.
static void write_some(exchange *x) {
    for (int i = 0; i < 2; i++) {
        while (x->out[i].size > 0) {
            const ssize_t n =
                send(x->client->fd, x->out[i].data, x->out[i].size, MSG_DONTWAIT | MSG_NOSIGNAL);
            if (n < 0) {
                x->sending_failed = errno != EAGAIN && errno != EINTR;
                return;
            }
            x->out[i].data += n;
            x->out[i].size -= (size_t)n;
        }
    }
}

static bool sending(const exchange *x) {
    return !x->sending_failed && x->out[0].size + x->out[1].size > 0;
}

// Tells the server that nobody waits for this request any more.
static void give_up(exchange *x) {
    char *line;
    size_t size;
    json_t *params = json_pack("{s:I}", "id", (json_int_t)x->id);
    if (params != NULL &&
        tp_build_notification("request.cancel", params, 0, &line, &size) == TP_OK) {
        if (send(x->client->fd, line, size, MSG_DONTWAIT | MSG_NOSIGNAL) != (ssize_t)size) {
            x->client->broken = true;
        }
        free(line);
    }
    json_decref(params);
}

// An interrupted request is given up; one of which nothing is out is as if it had never
// been. Half a message cannot be given up: the connection is useless then. An upload
// that is out is answered at once, and its answer is wanted.
static tetrad_status interrupt(exchange *x, bool upload) {
    uint64_t count;
    if (upload && !sending(x)) {
        return TETRAD_OK;
    }
    if (x->out[0].size == x->line_size) {
        x->out[0].size = x->out[1].size = 0;
    } else if (sending(x)) {
        x->client->broken = true;
    } else {
        give_up(x);
    }
    atomic_store(&x->client->interrupted, false);
    (void)!read(x->client->wake, &count, sizeof count);
    return tc_fail(x->error, TETRAD_E_INTERRUPTED, "interrupted");
}

// The body of a refused request is sent to its end: the server reads and drops it.
static tetrad_status pump(exchange *x, bool upload) {
    tetrad_status status = TETRAD_OK;
    while ((!x->done || sending(x)) && (status == TETRAD_OK || status == TETRAD_E_REFUSED)) {
        if (atomic_load(&x->client->interrupted)) {
            const tetrad_status interrupted = interrupt(x, upload);
            if (interrupted != TETRAD_OK) {
                return interrupted;
            }
        }
        struct pollfd ready[2] = {
            {x->client->fd, (short)(POLLIN | (sending(x) ? POLLOUT : 0)), 0},
            {x->client->wake, POLLIN, 0}};
        // An upload that is out waits for its answer alone.
        const nfds_t n = upload && !sending(x) ? 1 : 2;
        if (poll(ready, n, -1) < 0) {
            if (errno != EINTR) {
                return x->done ? status : lost(x, strerror(errno));
            }
            continue;
        }
        if (ready[0].revents & POLLOUT) {
            write_some(x);
        }
        if (ready[0].revents & (POLLIN | POLLHUP | POLLERR)) {
            const bool done = x->done;
            const tetrad_status got = read_some(x);
            if (done && got != TETRAD_OK) {
                x->sending_failed = true; // the reply stands
            } else if (!done) {
                status = got;
            }
        }
    }
    return status;
}

tetrad_status tc_call(tetrad_client *client, const char *method, const json_t *params,
                      const tp_bytes *body, const tc_listener *listener, json_t **ret_result,
                      tetrad_error *error) {
    char *line = NULL;
    size_t size = 0;
    if (client->broken) {
        return tc_fail(error, TETRAD_E_CONNECTION, "the connection was lost before");
    }
    tc_daemon_trim_log(&client->daemon);
    json_t *id = json_integer(++client->last_id);
    const size_t body_size = body != NULL ? body->size : 0;
    if (id == NULL ||
        tp_build_request(id, method, params, body_size, &line, &size) != TP_OK) {
        json_decref(id);
        return tc_no_memory(error);
    }
    json_decref(id);
    exchange x = {.client = client, .id = client->last_id, .listener = listener, .error = error};
    x.out[0].data = line;
    x.out[0].size = x.line_size = size;
    x.out[1].data = body_size > 0 ? (const char *)body->data : NULL;
    x.out[1].size = body_size;
    const tetrad_status status = pump(&x, body_size > 0);
    free(line);
    // A reply in the middle of sending, or a failure inside a message, leaves the two
    // ends out of step; so does a body that nobody has taken to its end.
    client->broken = client->broken || sending(&x) || x.sending_failed ||
                     status == TETRAD_E_PROTOCOL || status == TETRAD_E_MEMORY;
    if (status != TETRAD_OK) {
        json_decref(x.result);
        return status;
    }
    *ret_result = x.result;
    return TETRAD_OK;
}
