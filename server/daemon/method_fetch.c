// SPDX-License-Identifier: Apache-2.0
/* method_fetch.c: mesh.fetch. A fetch waits for its job's end, then joins the fetches
 * of its connection, which send one chunk each in turn, out of the spool's file. */
#include <errno.h>
#include <event2/buffer.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/daemon/jobs.h"
#include "server/daemon/methods.h"
#include "server/daemon/result.h"
#include "server/daemon/store.h"

struct fetch {
  char job[JOB_ID_SIZE];
  json_t *names;          /* asked for; NULL: all */
  uint64_t first, count;  /* of each array */
  result *result;         /* when it sends */
  const result_array **arrays;
  size_t n_arrays, at;    /* the array that it sends */
  uint64_t chunk;
  struct evbuffer_file_segment *file; /* NULL: there are no bytes */
  uint64_t sent_chunks, sent_bytes;
};

void fetch_free(fetch *f) {
  json_decref(f->names);
  result_unref(f->result);
  free(f->arrays);
  if (f->file) evbuffer_file_segment_free(f->file);
  free(f);
}

/* A list of different strings. */
static bool names_valid(const json_t *names) {
  if (!json_is_array(names)) return false;
  json_t *seen = json_object();
  bool ok = seen;
  for (size_t i = 0; ok && i < json_array_size(names); i++) {
    const char *name = json_string_value(json_array_get(names, i));
    ok = name && !json_object_get(seen, name) && !json_object_set_new(seen, name, json_true());
  }
  json_decref(seen);
  return ok;
}

void method_fetch(connection *c, const tp_message *m, uint64_t body) {
  static const char *const params[] = {"job", "key", "arrays", "first", "count", NULL};
  json_t *names = json_object_get(m->params, "arrays");
  int64_t first = 0, count = TP_MAX_INTEGER;
  job *j;
  (void)body;
  if (!params_known(c, m, params) || !param_job(c, m, &j) ||
      !param_integer(c, m, "first", 0, TP_MAX_INTEGER, &first) ||
      !param_integer(c, m, "count", 0, TP_MAX_INTEGER, &count))
    return;
  if (names && !names_valid(names)) {
    connection_refuse(c, m->id, TP_E_PARAMS, "arrays", "arrays is no list of different strings");
    return;
  }
  request *r = request_open(c, REQUEST_FETCH, m->id);
  if (!r) return;
  fetch *f = r->fetch = calloc(1, sizeof *f);
  if (!f) {
    connection_refuse(c, m->id, TP_E_INTERNAL, NULL, "no memory for the fetch");
    request_end(r);
    return;
  }
  strcpy(f->job, j->id);
  f->names = json_incref(names);
  f->first = (uint64_t)first;
  f->count = (uint64_t)count;
  if (job_ended(j)) fetch_start(r, j);
  else request_wait_for(r, j);
}

/* Looks up the arrays asked for. */
static tp_code choose_arrays(fetch *f, tp_error *error) {
  const result *from = f->result;
  size_t n = f->names ? json_array_size(f->names) : from->n_arrays;
  f->arrays = calloc(n ? n : 1, sizeof *f->arrays);
  if (!f->arrays) return tp_fail(error, TP_E_INTERNAL, NULL, "no memory for the fetch");
  for (size_t i = 0; i < n; i++) {
    const char *name =
        f->names ? json_string_value(json_array_get(f->names, i)) : from->arrays[i].info.name;
    const result_array *a = result_find(from, name);
    if (!a) return tp_fail(error, TP_E_ARRAY_UNKNOWN, name, "the result has no array \"%s\"", name);
    if (f->first > a->count)
      return tp_fail(error, TP_E_CHUNK_RANGE, name, "%s has %zu chunks: none from %llu on", name,
                     a->count, (unsigned long long)f->first);
    f->arrays[f->n_arrays++] = a;
  }
  f->chunk = f->first;
  return TP_OK;
}

static tp_code open_file(fetch *f, tp_error *error) {
  uint64_t bytes = spool_file_bytes(f->result->file);
  if (!bytes) return TP_OK;
  int fd = spool_file_open(f->result->file);
  if (fd >= 0)
    f->file = evbuffer_file_segment_new(fd, 0, (ev_off_t)bytes, EVBUF_FS_CLOSE_ON_FREE);
  if (f->file) return TP_OK;
  bool full = fd < 0 && (errno == EMFILE || errno == ENFILE);
  tp_code code = tp_fail(error, full ? TP_E_BUSY : TP_E_INTERNAL, NULL,
                         "the result cannot be read now: %s", strerror(errno));
  if (fd >= 0) close(fd);
  return code;
}

void fetch_start(request *r, const job *j) {
  connection *c = r->connection;
  fetch *f = r->fetch;
  tp_error error;
  if (j->state != JOB_DONE) {
    tp_fail(&error, TP_E_JOB_FAILED, NULL, "%s is %s: there is nothing to fetch", j->id,
            job_state_name(j->state));
    connection_error(
        c, r->id, &error,
        json_pack("{s:s, s:O*}", "state", job_state_name(j->state), "error", j->error));
    request_end(r);
    return;
  }
  f->result = result_ref(j->result);
  if (choose_arrays(f, &error) != TP_OK || open_file(f, &error) != TP_OK) {
    bool busy = error.code == TP_E_BUSY;
    json_t *data = busy ? json_pack("{s:i}", "retry_ms", BUSY_RETRY_MS) : NULL;
    connection_error(c, r->id, &error, data);
    request_end(r);
    return;
  }
  r->fetching = true;
  TAILQ_INSERT_TAIL(&c->fetching, r, in_fetching);
  event_active(c->kick, EV_TIMEOUT, 1);
}

static uint64_t last_chunk(const fetch *f, const result_array *a) {
  return a->count - f->first < f->count ? a->count : f->first + f->count;
}

static void send_chunk(request *r, const result_array *a, uint64_t number) {
  connection *c = r->connection;
  fetch *f = r->fetch;
  const result_chunk *chunk = &a->chunks[number];
  json_t *params =
      json_pack("{s:O, s:s, s:I, s:I, s:I, s:I}", "of", r->id, "array", a->info.name, "chunk",
                (json_int_t)number, "row", (json_int_t)(number * a->info.rows_per_chunk), "rows",
                (json_int_t)chunk->rows, "crc32", (json_int_t)chunk->crc32);
  if (!connection_notify(c, "mesh.chunk", params, chunk->bytes)) return;
  if (chunk->bytes && evbuffer_add_file_segment(bufferevent_get_output(c->bev), f->file,
                                                (ev_off_t)chunk->offset, chunk->bytes)) {
    connection_close(c); /* the line is out: without its body the stream is broken */
    return;
  }
  f->sent_chunks++;
  f->sent_bytes += chunk->bytes;
}

void fetch_step(request *r) {
  connection *c = r->connection;
  fetch *f = r->fetch;
  while (f->at < f->n_arrays && f->chunk >= last_chunk(f, f->arrays[f->at])) {
    f->at++;
    f->chunk = f->first;
  }
  if (f->at < f->n_arrays) {
    send_chunk(r, f->arrays[f->at], f->chunk++);
    return;
  }
  job *j = store_find(c->server->store, f->job);
  if (j) jobs_touch(c->server, j);
  connection_reply(c, r->id,
                   json_pack("{s:s, s:I, s:I}", "job", f->job, "chunks", (json_int_t)f->sent_chunks,
                             "bytes", (json_int_t)f->sent_bytes));
  request_end(r);
}
