// SPDX-License-Identifier: Apache-2.0
/* connection.c: the stream of one client. Sending and requests: requests.c. */
#include "server/daemon/connection.h"

#include <event2/buffer.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/daemon/limits.h"
#include "server/daemon/listener.h"
#include "server/daemon/methods.h"
#include "server/log.h"

size_t connection_waiting(const connection *c) {
  return evbuffer_get_length(bufferevent_get_output(c->bev));
}

/* Whether another request may start. */
static bool may_start(const connection *c) {
  return c->n_requests < c->server->config->limits.max_requests &&
         connection_waiting(c) < OUTPUT_MAX;
}

static void set_reading(connection *c) {
  bool want = !c->dead && !c->input_ended && (c->lingering || c->in_body || may_start(c));
  bool now = bufferevent_get_enabled(c->bev) & EV_READ;
  if (want == now) return;
  if (want) {
    c->last_input = clock_now();
    bufferevent_enable(c->bev, EV_READ);
  } else {
    bufferevent_disable(c->bev, EV_READ);
  }
}

static void take_message(connection *c, const tp_step *step) {
  tp_message message;
  tp_error error;
  c->in_body = step->body > 0;
  if (tp_message_parse(step->json, &message, &error) == TP_OK) {
    methods_handle(c, &message, step->body, step->depth);
  } else if (c->hello_required && !c->hello_done) {
    connection_refuse(c, message.id, TP_E_HELLO_REQUIRED, NULL,
                      "the first request is server.hello");
  } else {
    connection_error(c, message.id, &error, NULL);
  }
  if (c->upload && !c->in_body) submit_complete(c->upload);
  json_decref(step->json);
}

static void take_body(connection *c, const tp_step *step) {
  c->in_body = step->body > 0;
  if (!c->upload) return;
  submit_body(c->upload, step->data, step->size);
  if (!c->in_body) submit_complete(c->upload);
}

/* Takes steps until the input is used up or the connection has enough to do. */
static void process(connection *c) {
  struct evbuffer *input = bufferevent_get_input(c->bev);
  if (c->lingering) evbuffer_drain(input, evbuffer_get_length(input));
  while (!c->dead && !c->lingering && (c->in_body || may_start(c))) {
    struct evbuffer_iovec piece;
    tp_step step;
    if (evbuffer_peek(input, -1, NULL, &piece, 1) < 1 || !piece.iov_len) break;
    switch (tp_reader_next(c->reader, piece.iov_base, piece.iov_len, &step)) {
    case TP_STEP_MESSAGE: take_message(c, &step); break;
    case TP_STEP_BODY: take_body(c, &step); break;
    case TP_STEP_ERROR: connection_error(c, NULL, &step.error, NULL); break;
    case TP_STEP_MORE: break;
    }
    evbuffer_drain(input, step.used);
  }
}

/* A client that sends no more gets what it has asked for. */
static void close_if_over(connection *c) {
  if (!c->input_ended || c->dead || connection_waiting(c)) return;
  if (c->upload) request_end(c->upload); /* the end came in the middle of it */
  if (!c->n_requests) connection_close(c);
}

static void go_on(connection *c) {
  process(c);
  request *r;
  while (!c->dead && connection_waiting(c) < OUTPUT_FETCH && (r = TAILQ_FIRST(&c->fetching))) {
    TAILQ_REMOVE(&c->fetching, r, in_fetching);
    TAILQ_INSERT_TAIL(&c->fetching, r, in_fetching);
    fetch_step(r);
  }
  close_if_over(c);
  if (!c->dead) set_reading(c);
}

static void on_kick(evutil_socket_t fd, short what, void *arg) {
  connection *c = arg;
  (void)fd, (void)what;
  if (c->dead) connection_free(c);
  else go_on(c);
}

static void on_read(struct bufferevent *bev, void *arg) {
  connection *c = arg;
  (void)bev;
  c->last_input = clock_now();
  go_on(c);
}

static void on_written(struct bufferevent *bev, void *arg) {
  connection *c = arg;
  if (c->lingering && !connection_waiting(c)) shutdown(bufferevent_getfd(bev), SHUT_WR);
  go_on(c);
}

static void on_event(struct bufferevent *bev, short what, void *arg) {
  connection *c = arg;
  (void)bev;
  if (c->peer == PEER_INHERITED || c->lingering || !(what & BEV_EVENT_EOF)) {
    connection_close(c);
    return;
  }
  c->input_ended = true;
  go_on(c);
}

static void on_input_change(struct evbuffer *buffer, const struct evbuffer_cb_info *info,
                            void *arg) {
  connection *c = arg;
  (void)buffer;
  c->server->totals.received += info->n_added;
}

static void on_output_change(struct evbuffer *buffer, const struct evbuffer_cb_info *info,
                             void *arg) {
  connection *c = arg;
  (void)buffer;
  c->server->totals.sent += info->n_deleted;
  if (info->n_deleted || !info->orig_size) c->last_output = clock_now();
}

/* Who is there, by the socket. TCP peers are told apart by server.hello. */
static bool identify(connection *c, int fd) {
  struct ucred peer;
  socklen_t size = sizeof peer;
  char name[32];
  if (c->peer != PEER_TCP && !getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size)) {
    c->same_uid = peer.uid == geteuid();
    snprintf(name, sizeof name, "uid:%u", (unsigned)peer.uid);
    c->principal = strdup(name);
  } else {
    int on = 1;
    /* Both fail on other streams. The second finds peers that went without a word. */
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    c->principal = strdup("anonymous");
  }
  c->hello_required = !c->same_uid;
  return c->principal;
}

connection *connection_create(server *s, int fd, peer_kind peer) {
  connection *c = calloc(1, sizeof *c);
  if (!c || !(c->bev = bufferevent_socket_new(s->base, fd, BEV_OPT_CLOSE_ON_FREE))) {
    free(c);
    close(fd);
    return NULL;
  }
  c->server = s;
  c->peer = peer;
  c->last_input = c->last_output = clock_now();
  TAILQ_INIT(&c->requests);
  TAILQ_INIT(&c->fetching);
  c->kick = event_new(s->base, -1, 0, on_kick, c);
  TAILQ_INSERT_TAIL(&s->connections, c, link);
  s->n_connections++;
  c->number = ++s->totals.connections;
  if (!c->kick || !identify(c, fd) ||
      tp_reader_create(c->hello_required ? TP_HELLO_LINE : TP_MAX_LINE, &c->reader) != TP_OK ||
      !evbuffer_add_cb(bufferevent_get_input(c->bev), on_input_change, c) ||
      !evbuffer_add_cb(bufferevent_get_output(c->bev), on_output_change, c)) {
    connection_free(c);
    return NULL;
  }
  bufferevent_setcb(c->bev, on_read, on_written, on_event, c);
  bufferevent_setwatermark(c->bev, EV_READ, 0, INPUT_MAX);
  bufferevent_setwatermark(c->bev, EV_WRITE, OUTPUT_LOW, 0);
  bufferevent_set_max_single_read(c->bev, INPUT_MAX);
  bufferevent_set_max_single_write(c->bev, OUTPUT_LOW);
  bufferevent_enable(c->bev, EV_READ | EV_WRITE);
  return c;
}

void connection_close(connection *c) {
  if (c->dead) return;
  c->dead = true;
  bufferevent_disable(c->bev, EV_READ | EV_WRITE);
  event_active(c->kick, EV_TIMEOUT, 1);
}

void connection_free(connection *c) {
  server *s = c->server;
  c->dead = true;
  while (!TAILQ_EMPTY(&c->requests)) request_end(TAILQ_FIRST(&c->requests));
  TAILQ_REMOVE(&s->connections, c, link);
  s->n_connections--;
  if (c->kick) event_free(c->kick);
  bufferevent_free(c->bev);
  tp_reader_free(c->reader);
  bool ends_all = c->peer == PEER_INHERITED;
  free(c->principal);
  free(c);
  listeners_update(s);
  if (ends_all) server_stop(s, 0);
}

void connection_linger(connection *c) {
  if (c->lingering) return;
  c->lingering = true;
  while (!TAILQ_EMPTY(&c->requests)) request_end(TAILQ_FIRST(&c->requests));
}

void connection_check_stall(connection *c, double now) {
  double stall = (double)c->server->config->limits.stall_ms * 1e-3;
  bool waiting = connection_waiting(c) > 0;
  bool reading = bufferevent_get_enabled(c->bev) & EV_READ;
  const char *why = NULL;
  if (waiting && now - c->last_output > stall) why = "does not read";
  else if (!waiting && c->lingering && now - c->last_output > LINGER_MS * 1e-3) connection_close(c);
  else if (reading && !tp_reader_idle(c->reader) && now - c->last_input > stall)
    why = "message half sent";
  if (!why || c->dead) return;
  LOG(LOG_WARNING, "connection stalled", log_int("connection", (int64_t)c->number),
      log_text("principal", c->principal), log_text("why", why));
  connection_close(c);
}
