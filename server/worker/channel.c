// SPDX-License-Identifier: Apache-2.0
/* channel.c: see channel.h. */
#include "server/worker/channel.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/frame.h"
#include "server/log.h"

struct channel {
  pthread_mutex_t mutex;
  pthread_cond_t arrived;
  task *current;  /* NULL: idle */
  bool complete;  /* its body is here */
  bool taken;     /* the main thread has it */
  tet_ctx *ctx;
  tp_reader *reader; /* the control thread's */
};

_Noreturn static void broken(const char *what) {
  LOG(LOG_ERROR, "the daemon broke the protocol", log_int("pid", getpid()), log_text("what", what));
  _exit(WORKER_BROKEN);
}

/* ---- the control thread ---- */

static void take_run(channel *ch, json_t *params, uint64_t body) {
  const char *id = json_string_value(json_object_get(params, "job"));
  if (!id || ch->current) broken("job.run without an id, or during another job");
  task *t = calloc(1, sizeof *t);
  if (!t) broken("no memory for a task");
  atomic_init(&t->cancelled, false);
  t->id = id;
  t->params = json_incref(params);
  t->body_room = body;
  t->body = malloc(body ? body : 1);
  t->lost = !t->body;
  ch->current = t;
  ch->complete = ch->taken = false;
}

static void take_cancel(channel *ch, const json_t *params) {
  const char *id = json_string_value(json_object_get(params, "job"));
  task *t = ch->current;
  if (!t || !id || strcmp(id, t->id)) return; /* it has ended meanwhile */
  atomic_store(&t->cancelled, true);
  if (ch->ctx) tet_cancel(ch->ctx);
}

static void complete(channel *ch) {
  ch->complete = true;
  pthread_cond_signal(&ch->arrived);
}

static void take_step(channel *ch, tp_step *step) {
  tp_message m;
  if (step->kind == TP_STEP_ERROR) broken(step->error.message);
  if (step->kind == TP_STEP_BODY) {
    task *t = ch->current;
    if (!t->lost) memcpy(t->body + t->body_size, step->data, step->size);
    t->body_size += step->size;
    if (!step->body) complete(ch);
  }
  if (step->kind != TP_STEP_MESSAGE) return;
  if (tp_message_parse(step->json, &m, NULL) != TP_OK || m.kind != TP_NOTIFICATION)
    broken("no notification");
  if (!strcmp(m.method, "job.run")) {
    take_run(ch, m.params, step->body);
    if (!step->body) complete(ch);
  } else if (!strcmp(m.method, "job.cancel") && !step->body) {
    take_cancel(ch, m.params);
  } else {
    broken("an unknown message");
  }
  json_decref(step->json);
}

static void *control_main(void *arg) {
  enum { PIECE = 1 << 18 };
  channel *ch = arg;
  unsigned char *bytes = malloc(PIECE);
  if (!bytes) broken("no memory to read");
  for (;;) {
    ssize_t n = read(STDIN_FILENO, bytes, PIECE);
    if (n < 0 && errno == EINTR) continue;
    pthread_mutex_lock(&ch->mutex);
    if (n <= 0 && !ch->current) exit(0); /* with what is done at the end, as looking for leaks */
    if (n <= 0) _exit(0);
    for (size_t at = 0; at < (size_t)n;) {
      tp_step step;
      tp_reader_next(ch->reader, bytes + at, (size_t)n - at, &step);
      take_step(ch, &step);
      at += step.used;
    }
    pthread_mutex_unlock(&ch->mutex);
  }
}

/* ---- the main thread ---- */

channel *channel_create(void) {
  pthread_t thread;
  channel *ch = calloc(1, sizeof *ch);
  if (!ch) return NULL;
  pthread_mutex_init(&ch->mutex, NULL);
  pthread_cond_init(&ch->arrived, NULL);
  if (tp_reader_create(TP_WORKER_LINE, &ch->reader) == TP_OK &&
      !pthread_create(&thread, NULL, control_main, ch)) {
    pthread_detach(thread); /* it lives as long as the process */
    return ch;
  }
  tp_reader_free(ch->reader);
  free(ch);
  return NULL;
}

task *channel_next(channel *ch) {
  pthread_mutex_lock(&ch->mutex);
  while (!ch->current || !ch->complete || ch->taken) pthread_cond_wait(&ch->arrived, &ch->mutex);
  ch->taken = true;
  task *t = ch->current;
  pthread_mutex_unlock(&ch->mutex);
  return t;
}

void channel_set_context(channel *ch, tet_ctx *ctx) {
  pthread_mutex_lock(&ch->mutex);
  ch->ctx = ctx;
  if (ctx && atomic_load(&ch->current->cancelled)) tet_cancel(ctx);
  pthread_mutex_unlock(&ch->mutex);
}

void channel_drop_body(task *t) {
  free(t->body);
  t->body = NULL;
}

static void write_all(const void *data, size_t size) {
  const char *at = data;
  while (size) {
    ssize_t n = write(STDOUT_FILENO, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) _exit(0);
    at += n;
    size -= (size_t)n;
  }
}

/* The caller frees; takes `params`. */
static char *build(const task *t, const char *method, json_t *params, size_t body,
                   size_t *ret_length) {
  char *line;
  if (t) json_object_set_new(params, "job", json_string(t->id));
  if (!params || tp_build_notification(method, params, body, &line, ret_length) != TP_OK) {
    LOG(LOG_ERROR, "no memory for a message", log_int("pid", getpid()), log_text("method", method));
    _exit(EXIT_FAILURE); /* the daemon would wait for it for ever */
  }
  json_decref(params);
  return line;
}

void channel_send(channel *ch, const char *method, json_t *params, const void *body, size_t size) {
  size_t length;
  char *line = build(ch->current, method, params, size, &length);
  write_all(line, length);
  write_all(body, size);
  free(line);
}

void channel_done(channel *ch, const char *method, json_t *params) {
  size_t length;
  char *line = build(ch->current, method, params, 0, &length);
  pthread_mutex_lock(&ch->mutex);
  task *t = ch->current;
  ch->current = NULL; /* before the daemon can send the next one */
  pthread_mutex_unlock(&ch->mutex);
  channel_drop_body(t);
  json_decref(t->params);
  free(t);
  write_all(line, length);
  free(line);
}
