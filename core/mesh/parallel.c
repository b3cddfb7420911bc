// SPDX-License-Identifier: Apache-2.0
/* parallel.c: insertion of many vertices by several threads, without locks.
 *
 * After Marot, Pellerin, Remacle (2019): the Hilbert curve is cut into as many parts as there are
 * threads. A tetrahedron whose vertices all lie in one part is that thread's, to read and to
 * change; the others are walls to all. A vertex whose walk or cavity, with the tetrahedra
 * around it, meets a wall is put off: to a second pass with the curve cut elsewhere, and
 * then to the caller, alone. The tetrahedra made depend on no order; their slots do. */
#include "mesh/parallel.h"

#include <string.h>

#include "base/threads.h"

enum {
  PASSES = 2,
  NOBODY = TET_MOST_THREADS, /* owner of the walls */
  SCRATCH = 1024,            /* most old tetrahedra and border faces of a cavity that a thread changes */
  HINT = 32,
  POLL = 256,
  LEAST = 1000               /* vertices for each thread that make a pass worth its while */
};

_Static_assert((NOBODY * TET_FLAG_OWNER) >> 8 == 0, "an owner fits the flags");

typedef struct worker {
  tet_complex view;        /* of the shared complex, with lists of its own */
  uint32_t *todo, n_todo;  /* its vertices; after a pass those put off */
  uint32_t near;           /* an earlier vertex near the first of them */
  _Atomic uint32_t tet_near, tet_any; /* tetrahedra of its own: with that vertex, and another */
  tet_status status;
} worker;

typedef struct job {
  tet_complex *c;
  const tet_rounds *rounds;
  uint32_t threads;
  tet_slot_pool pool;
  uint8_t *part;    /* [vertices] whose they are */
  worker *worker;   /* [threads] */
  uint32_t *todo;   /* [n_todo] of all, along the curve */
  uint32_t n_todo;
  _Atomic uint32_t *hint; /* [vertices / HINT] a tetrahedron made of late by one of as many vertices */
} job;

static uint64_t key_of(const job *j, uint32_t v) { return tet_hilbert_key(&j->rounds->box, j->c->points->x + 3 * (size_t)v); }

/* The first vertex from a on, below b, whose key is at least `key`; or b. */
static uint32_t lower_bound(const job *j, uint32_t a, uint32_t b, uint64_t key) {
  while (a < b) {
    uint32_t middle = a + (b - a) / 2;
    if (key_of(j, middle) < key) a = middle + 1;
    else b = middle;
  }
  return a;
}

static void reverse(uint32_t *a, uint32_t n) {
  for (uint32_t i = 0; i < n / 2; i++) {
    uint32_t swap = a[i];
    a[i] = a[n - 1 - i];
    a[n - 1 - i] = swap;
  }
}

/* Deals out what is to do in equal shares, and all vertices of the complex with them. The curve is
 * taken as a ring; in the second pass it begins half a share later. */
static void deal(job *j, int pass) {
  const tet_rounds *r = j->rounds;
  uint32_t turn = pass ? j->n_todo / (2 * j->threads) : 0;
  reverse(j->todo, turn);
  reverse(j->todo + turn, j->n_todo - turn);
  reverse(j->todo, j->n_todo);
  for (uint32_t k = 0; k < r->n; k++) memset(j->part + r->start[k], (int)j->threads - 1, r->start[k + 1] - r->start[k]);
  for (uint32_t i = 0; i < j->threads; i++) {
    worker *w = &j->worker[i];
    uint32_t first = tet_part(j->n_todo, j->threads, i), end = tet_part(j->n_todo, j->threads, i + 1);
    w->todo = j->todo + first;
    w->n_todo = end - first;
    uint64_t key = key_of(j, j->todo[first]), next = i + 1 < j->threads ? key_of(j, j->todo[end]) : UINT64_MAX;
    for (uint32_t k = 0; k < r->n; k++) {
      uint32_t a = lower_bound(j, r->start[k], r->start[k + 1], key);
      uint32_t b = lower_bound(j, r->start[k], r->start[k + 1], next);
      if (a < b) memset(j->part + a, (int)i, b - a);
      if (k + 2 == r->n) w->near = a < r->start[k + 1] ? a : r->start[k + 1] - 1;
    }
  }
}

/* Says of this thread's share of all tetrahedra whose they are. */
static void own(void *arg, uint32_t i) {
  job *j = arg;
  tet_complex *c = j->c;
  for (uint32_t t = tet_part(c->n_slots, j->threads, i), end = tet_part(c->n_slots, j->threads, i + 1); t < end; t++) {
    const uint32_t *v = c->v + 4 * (size_t)t;
    if (!tet_is_live(c, t)) continue;
    uint32_t owner = j->part[v[0]], fourth = v[3] == TET_GHOST ? owner : j->part[v[3]];
    if (j->part[v[1]] != owner || j->part[v[2]] != owner || fourth != owner) owner = NOBODY;
    c->flag[t] = (uint8_t)(owner * TET_FLAG_OWNER);
    if (owner == NOBODY) continue;
    worker *w = &j->worker[owner];
    int is_near = v[0] == w->near || v[1] == w->near || v[2] == w->near || v[3] == w->near;
    atomic_store_explicit(is_near ? &w->tet_near : &w->tet_any, t, memory_order_relaxed);
  }
}

static void disown(void *arg, uint32_t i) {
  job *j = arg;
  uint32_t from = tet_part(j->c->n_slots, j->threads, i), end = tet_part(j->c->n_slots, j->threads, i + 1);
  for (uint32_t t = from; t < end; t++) j->c->flag[t] &= TET_FLAG_OWNER - 1;
}

/* Where to start a walk to v: near it if there is something of this thread, else TET_NONE. */
static uint32_t hint_for(const job *j, const tet_complex *view, uint32_t v) {
  uint32_t t = atomic_load_explicit(&j->hint[v / HINT], memory_order_relaxed);
  return t != TET_NONE && tet_flag(view, t) == view->owner ? t : TET_NONE;
}

/* Inserts what one thread can; the others stay in its list. */
static void insert(void *arg, uint32_t i) {
  job *j = arg;
  worker *w = &j->worker[i];
  uint32_t rest = 0, k = 0, near = atomic_load(&w->tet_near), before = TET_NONE;
  w->view.last = near != TET_NONE ? near : atomic_load(&w->tet_any);
  for (; w->view.last != TET_NONE && k < w->n_todo && w->status == TET_OK; k++) {
    int done = 0;
    uint32_t v = w->todo[k], hint = v - before > 1 ? hint_for(j, &w->view, v) : TET_NONE;
    if (k % POLL == POLL - 1 && tet_is_stopping(j->c->ctx)) break;
    if (hint != TET_NONE) w->view.last = hint;
    w->status = tet_complex_insert_owned(&w->view, v, &done);
    if (done) before = v;
    else w->todo[rest++] = v;
    if (done && v % HINT == 0) atomic_store_explicit(&j->hint[v / HINT], w->view.last, memory_order_relaxed);
  }
  for (; k < w->n_todo; k++) w->todo[rest++] = w->todo[k];
  w->n_todo = rest;
}

/* What a thread sees of the complex, and lists of its own. */
static tet_status begin_view(job *j, uint32_t i) {
  tet_complex *c = j->c, *view = &j->worker[i].view;
  tet_complex_init(view, c->ctx, c->points);
  view->v = c->v;
  view->adj = c->adj;
  view->flag = c->flag;
  view->owner = (uint8_t)(i * TET_FLAG_OWNER);
  view->pool = &j->pool;
  if (i == 0) {
    view->free_slot = c->free_slot;
    view->n_free = c->n_free;
  }
  tet_status status = tet_grow(c->ctx, &view->cavity, &view->cap_cavity, SCRATCH, sizeof *view->cavity);
  if (status == TET_OK) status = tet_grow(c->ctx, &view->border, &view->cap_border, SCRATCH, sizeof *view->border);
  view->place = tet_calloc(c->ctx, c->cap_place, 1);
  view->cap_place = c->cap_place;
  return status == TET_OK && !view->place ? tet_ctx_error(c->ctx)->status : status;
}

/* Takes back what the thread has of the complex. */
static void end_view(job *j, uint32_t i) {
  tet_complex *c = j->c, *view = &j->worker[i].view;
  tet_complex_give_up(view);
  c->n_live += view->n_live; /* its change, of either sign */
  while (view->free_slot != TET_NONE) {
    uint32_t t = view->free_slot;
    view->free_slot = c->v[4 * (size_t)t];
    c->v[4 * (size_t)t] = c->free_slot;
    c->free_slot = t;
    c->n_free++;
  }
  view->v = view->adj = NULL;
  view->flag = NULL;
  tet_complex_free(view);
}

static tet_status insert_pass(job *j, int pass) {
  tet_complex *c = j->c;
  tet_status status = TET_OK;
  uint32_t begun = 0, rest = 0;
  deal(j, pass);
  j->pool.end = (uint32_t)c->cap_slots;
  atomic_store(&j->pool.next, c->n_slots);
  for (; begun < j->threads && status == TET_OK; begun++) {
    j->worker[begun].status = TET_OK;
    atomic_store(&j->worker[begun].tet_near, TET_NONE);
    atomic_store(&j->worker[begun].tet_any, TET_NONE);
    status = begin_view(j, begun);
  }
  if (status == TET_OK) {
    tet_run_threads(j->threads, own, j);
    tet_run_threads(j->threads, insert, j);
    c->n_slots = atomic_load(&j->pool.next);
    tet_run_threads(j->threads, disown, j);
    c->free_slot = TET_NONE;
    c->n_free = 0;
  }
  for (uint32_t i = 0; i < begun; i++) {
    worker *w = &j->worker[i];
    if (status == TET_OK) {
      memmove(j->todo + rest, w->todo, w->n_todo * sizeof *w->todo);
      rest += w->n_todo;
      status = w->status;
      if (w->view.last != TET_NONE) c->last = w->view.last;
      end_view(j, i);
    }
  }
  if (status == TET_OK) j->n_todo = rest;
  return status == TET_OK ? tet_poll(c->ctx) : status;
}

/* What no thread could insert, one by one. */
static tet_status insert_alone(job *j) {
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < j->n_todo && status == TET_OK; k++) {
    status = tet_complex_insert(j->c, j->todo[k], hint_for(j, j->c, j->todo[k]));
    if (status == TET_OK && k % POLL == 0) status = tet_poll(j->c->ctx);
  }
  return status;
}

tet_status tet_insert_round(tet_complex *c, const tet_rounds *rounds, uint32_t threads) {
  job j = {.c = c, .rounds = rounds, .threads = threads};
  uint32_t first = rounds->start[rounds->n - 1], end = rounds->start[rounds->n];
  tet_status status = TET_OK;
  j.part = tet_alloc(c->ctx, end, 1);
  j.worker = tet_calloc(c->ctx, threads, sizeof *j.worker);
  j.todo = tet_alloc(c->ctx, end - first, sizeof *j.todo);
  j.hint = tet_alloc(c->ctx, end / HINT + 1, sizeof *j.hint);
  if (!j.part || !j.worker || !j.todo || !j.hint) status = tet_ctx_error(c->ctx)->status;
  for (uint32_t i = 0; i <= end / HINT && status == TET_OK; i++) atomic_init(&j.hint[i], TET_NONE);
  for (uint32_t v = first; v < end && status == TET_OK; v++) j.todo[j.n_todo++] = v;
  for (int pass = 0; pass < PASSES && j.n_todo > LEAST * threads && status == TET_OK; pass++)
    status = insert_pass(&j, pass);
  tet_free(c->ctx, j.part);
  tet_free(c->ctx, j.worker);
  if (status == TET_OK) status = insert_alone(&j);
  tet_free(c->ctx, j.hint);
  tet_free(c->ctx, j.todo);
  return status;
}
