// SPDX-License-Identifier: Apache-2.0
/* spool.c: see spool.h. Two queues under one mutex: operations to the thread, and
 * the same objects back to the loop, which is woken through an eventfd. */
#include "server/daemon/spool.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/queue.h>
#include <unistd.h>

#include "server/daemon/limits.h"
#include "server/daemon/spool_folder.h"

typedef enum op_kind { OP_WRITE, OP_FINISH, OP_DROP } op_kind;

typedef struct op {
  STAILQ_ENTRY(op) link;
  op_kind kind;
  spool_file *file;
  void *data;
  size_t size;
  int error; /* what the thread found */
} op;

STAILQ_HEAD(op_list, op);

struct spool_file {
  spool *spool;
  spool_file_fn fn; /* NULL once called or dropped */
  void *user;
  uint64_t number; /* its name */
  uint64_t bytes;
  int fd;    /* the thread's: -1 not open */
  int error; /* the thread's: the first failure; later writes are skipped */
};

struct spool {
  spool_folder folder;
  uint64_t limit, bytes, files;
  size_t waiting; /* bytes handed to the thread and not yet back */
  bool crowded;
  spool_room_fn room;
  void *room_user;
  int wake;
  struct event *woken;
  pthread_t thread;
  pthread_mutex_t mutex;
  pthread_cond_t work;
  struct op_list todo, done; /* under the mutex */
  bool stop;                 /* under the mutex */
};

/* ---- the thread ---- */

static int file_write(spool_file *file, const char *data, size_t size) {
  if (file->fd < 0) {
    char name[SPOOL_NAME];
    spool_name(file->number, name);
    file->fd = openat(file->spool->folder.fd, name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file->fd < 0) return errno;
  }
  while (size) {
    ssize_t n = write(file->fd, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    data += n;
    size -= (size_t)n;
  }
  return 0;
}

static void file_close(spool_file *file) {
  if (file->fd >= 0 && close(file->fd) && !file->error) file->error = errno;
  file->fd = -1;
}

static void op_run(op *o) {
  spool_file *file = o->file;
  if (o->kind == OP_WRITE && !file->error) file->error = file_write(file, o->data, o->size);
  if (o->kind == OP_FINISH) file_close(file);
  if (o->kind == OP_DROP) {
    char name[SPOOL_NAME];
    spool_name(file->number, name);
    file_close(file);
    unlinkat(file->spool->folder.fd, name, 0); /* absent if nothing was written */
  }
  o->error = file->error;
}

static void *spool_main(void *arg) {
  spool *s = arg;
  pthread_mutex_lock(&s->mutex);
  for (;;) {
    while (STAILQ_EMPTY(&s->todo) && !s->stop) pthread_cond_wait(&s->work, &s->mutex);
    if (STAILQ_EMPTY(&s->todo)) break;
    op *o = STAILQ_FIRST(&s->todo);
    STAILQ_REMOVE_HEAD(&s->todo, link);
    pthread_mutex_unlock(&s->mutex);
    op_run(o);
    free(o->data);
    o->data = NULL;
    pthread_mutex_lock(&s->mutex);
    STAILQ_INSERT_TAIL(&s->done, o, link);
    if (eventfd_write(s->wake, 1)) continue; /* full counter: it is awake anyway */
  }
  pthread_mutex_unlock(&s->mutex);
  return NULL;
}

/* ---- the loop ---- */

static void file_tell(spool_file *file, int error) {
  spool_file_fn fn = file->fn;
  file->fn = NULL;
  if (fn) fn(file->user, error);
}

static void take_done(spool *s) {
  struct op_list done = STAILQ_HEAD_INITIALIZER(done);
  pthread_mutex_lock(&s->mutex);
  STAILQ_CONCAT(&done, &s->done);
  pthread_mutex_unlock(&s->mutex);
  op *o;
  while ((o = STAILQ_FIRST(&done))) {
    STAILQ_REMOVE_HEAD(&done, link);
    if (o->kind == OP_WRITE) s->waiting -= o->size;
    if (o->kind == OP_FINISH || (o->kind == OP_WRITE && o->error)) file_tell(o->file, o->error);
    if (o->kind == OP_DROP) free(o->file);
    free(o);
  }
}

static void on_wake(evutil_socket_t fd, short what, void *arg) {
  spool *s = arg;
  eventfd_t count;
  (void)what;
  if (eventfd_read((int)fd, &count)) return;
  take_done(s);
  if (s->crowded && s->waiting < SPOOL_QUEUE_LOW) {
    s->crowded = false;
    if (s->room) s->room(s->room_user);
  }
}

static void give(spool *s, op *o) {
  pthread_mutex_lock(&s->mutex);
  STAILQ_INSERT_TAIL(&s->todo, o, link);
  pthread_cond_signal(&s->work);
  pthread_mutex_unlock(&s->mutex);
}

static op *op_new(op_kind kind, spool_file *file) {
  op *o = calloc(1, sizeof *o);
  if (!o) return NULL;
  o->kind = kind;
  o->file = file;
  return o;
}

spool *spool_create(struct event_base *base, const char *parent, uint64_t limit) {
  spool *s = calloc(1, sizeof *s);
  if (!s) return NULL;
  s->limit = limit;
  STAILQ_INIT(&s->todo);
  STAILQ_INIT(&s->done);
  pthread_mutex_init(&s->mutex, NULL);
  pthread_cond_init(&s->work, NULL);
  s->wake = -1;
  if (!spool_folder_create(&s->folder, parent)) goto fail;
  s->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (s->wake < 0) goto fail_folder;
  s->woken = event_new(base, s->wake, EV_READ | EV_PERSIST, on_wake, s);
  if (!s->woken || event_add(s->woken, NULL)) goto fail_folder;
  errno = pthread_create(&s->thread, NULL, spool_main, s);
  if (errno) goto fail_folder;
  return s;

fail_folder:
  if (s->woken) event_free(s->woken);
  if (s->wake >= 0) close(s->wake);
  spool_folder_remove(&s->folder);
fail:
  free(s);
  return NULL;
}

void spool_free(spool *s) {
  if (!s) return;
  pthread_mutex_lock(&s->mutex);
  s->stop = true;
  pthread_cond_signal(&s->work);
  pthread_mutex_unlock(&s->mutex);
  pthread_join(s->thread, NULL);
  take_done(s);
  event_free(s->woken);
  close(s->wake);
  spool_folder_remove(&s->folder);
  pthread_cond_destroy(&s->work);
  pthread_mutex_destroy(&s->mutex);
  free(s);
}

void spool_on_room(spool *s, spool_room_fn fn, void *user) {
  s->room = fn;
  s->room_user = user;
}

bool spool_crowded(spool *s) {
  if (s->waiting >= SPOOL_QUEUE_MAX) s->crowded = true;
  return s->crowded;
}

bool spool_full(const spool *s) { return s->limit - s->bytes < s->limit / 16 + 1; }
uint64_t spool_bytes(const spool *s) { return s->bytes; }

spool_file *spool_file_create(spool *s, spool_file_fn fn, void *user) {
  spool_file *file = calloc(1, sizeof *file);
  if (!file) return NULL;
  file->spool = s;
  file->fn = fn;
  file->user = user;
  file->number = s->files++;
  file->fd = -1;
  return file;
}

int spool_file_append(spool_file *file, void *data, size_t size, uint64_t *ret_offset) {
  spool *s = file->spool;
  op *o = NULL;
  if (s->bytes + size > s->limit) {
    free(data);
    return ENOSPC;
  }
  if (!(o = op_new(OP_WRITE, file))) {
    free(data);
    return ENOMEM;
  }
  o->data = data;
  o->size = size;
  *ret_offset = file->bytes;
  file->bytes += size;
  s->bytes += size;
  s->waiting += size;
  give(s, o);
  return 0;
}

void spool_file_finish(spool_file *file) {
  op *o = op_new(OP_FINISH, file);
  if (o) give(file->spool, o);
  else file_tell(file, ENOMEM);
}

void spool_file_drop(spool_file *file) {
  if (!file) return;
  file->fn = NULL;
  file->spool->bytes -= file->bytes;
  op *o = op_new(OP_DROP, file);
  if (o) give(file->spool, o); /* without memory the file stays until the folder goes */
}

int spool_file_open(const spool_file *file) {
  char name[SPOOL_NAME];
  spool_name(file->number, name);
  return openat(file->spool->folder.fd, name, O_RDONLY | O_CLOEXEC);
}

uint64_t spool_file_bytes(const spool_file *file) { return file->bytes; }
