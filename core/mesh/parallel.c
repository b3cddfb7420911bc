// SPDX-License-Identifier: Apache-2.0
/* parallel.c: insertion of many vertices by several threads, without locks around tetrahedra.
 *
 * After Marot, Pellerin, Remacle (2019): a Hilbert curve is cut into chunks, and a tetrahedron is
 * the chunk's that most of its vertices lie in. A thread has a run of chunks, half an even one and the rest
 * small, and reads and changes tetrahedra of its chunks alone, the new ones included. A vertex
 * whose walk or cavity, with the tetrahedra around it, leaves them is put off: to another pass, in
 * which the chunks are otherwise given to the threads, and what is left at last to one thread.
 * A thread that is done gets chunks which another has not begun. The tetrahedra made
 * depend on no order; their slots do. */
#include "mesh/parallel.h"

#include <pthread.h>
#include <string.h>

#include "base/threads.h"

enum {
  CHUNKS = TET_OWNERS, /* at most */
  SCRATCH = 1024, /* most old tetrahedra and border faces of a cavity that a thread changes */
  WORTH = 512,    /* vertices for each thread that make another pass worth starting it */
  STEP = 16,      /* of the tetrahedra that are taken for hints */
  NEAR = 8,       /* numbers apart from the last vertex inserted, beyond which a hint is better */
  CELL = 32,      /* vertices to a cell of hints, about */
  MOST_CELLS = 128, /* to a side */
  POLL = 256,
  MOST_PASSES = 4,
  LEAST_BLOCK = 1 << 10, /* slots that a thread takes at a time: */
  MOST_BLOCK = 1 << 15,  /* so many that threads seldom touch new memory side by side */
  APART = 128     /* bytes that keep what two threads write off each other's cache lines */
};

_Static_assert((CHUNKS - 1) * TET_FLAG_OWNER <= TET_OWNER_BITS, "a chunk's number fits the flags");

/* A part of the curve, and of the vertices to insert those in it. */
typedef struct chunk {
  uint32_t *todo, n_todo; /* after a pass those put off */
} chunk;

/* A thread and the chunks it has: those begun and, in order, those to come. */
typedef struct worker {
  tet_complex view; /* of the shared complex, with lists of its own */
  uint8_t plan[CHUNKS];
  uint32_t next, end;
  tet_status status;
  char apart[APART];
} worker;

/* Chunks on their way from one thread to another. */
typedef struct exchange {
  pthread_mutex_t lock;
  pthread_cond_t changed;
  uint8_t offered[CHUNKS];
  uint32_t n_offered, n_working;
  _Atomic uint32_t n_hungry; /* read without the lock, too */
} exchange;

typedef struct job {
  tet_complex *c;
  const tet_rounds *rounds;
  uint32_t threads, per_thread; /* the latter: chunks */
  int is_sharing;       /* chunks change hands */
  tet_slot_pool pool;
  uint8_t *chunk_of;    /* [rounds->start[n - 1]] of the vertices that are in */
  chunk chunk[CHUNKS];  /* [threads * per_thread] along the curve */
  worker *worker;       /* [threads] */
  exchange exchange;
  uint32_t *todo;       /* of all chunks */
  uint32_t n_todo;
  uint32_t cells;       /* to a side of the rounds' cube */
  double cell_scale;    /* cells to a unit of length */
  _Atomic uint32_t *hint; /* [cells^3] some tetrahedron in or near the cell, or TET_NONE */
} job;

static const double *at(const job *j, uint32_t v) { return j->c->points->x + 3 * (size_t)v; }

/* Where chunk i of the n that one thread starts with ends, as a share of its run: the first half is one
 * chunk, as long as nobody will want to share it, and the last are small. */
static double share_end(uint32_t i, uint32_t n) {
  if (n == 1) return 1;
  if (i == 0) return 0.5;
  if (n < 4) return 0.5 + 0.5 * i / (n - 1);
  return 0.7 + 0.3 * (i - 1) / (n - 2);
}

/* The end of chunk k as a share of the curve. Every second run is turned round, so that two have their
 * small chunks side by side. */
static double curve_end(const job *j, uint32_t k) {
  uint32_t n = j->per_thread, run = k / n, i = k % n;
  double end = run % 2 == 0 ? share_end(i, n) : i + 1 < n ? 1 - share_end(n - 2 - i, n) : 1;
  return (run + end) / j->threads;
}

/* The first vertex of round r with a key on the curve of at least that. */
static uint32_t first_at(const job *j, uint32_t r, uint64_t key) {
  uint32_t low = j->rounds->start[r], high = j->rounds->start[r + 1];
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    if (tet_hilbert_key(&j->rounds->box, at(j, mid)) < key) low = mid + 1;
    else high = mid;
  }
  return low;
}

/* Cuts the curve, so that what is to do is shared as planned, and tells which chunk the vertices are in
 * that have been inserted. */
static void cut(job *j) {
  uint32_t last = j->rounds->n - 1, n = j->threads * j->per_thread, first = j->rounds->start[last], begin[33];
  memcpy(begin, j->rounds->start, sizeof begin);
  for (uint32_t k = 0; k < n; k++) {
    uint32_t to = k + 1 < n ? (uint32_t)(curve_end(j, k) * j->n_todo) : j->n_todo;
    uint64_t key = to < j->n_todo ? tet_hilbert_key(&j->rounds->box, at(j, first + to)) : UINT64_MAX;
    for (uint32_t r = 0; r < last; r++) {
      uint32_t end = first_at(j, r, key);
      memset(j->chunk_of + begin[r], (int)k, end - begin[r]);
      begin[r] = end;
    }
    j->chunk[k] = (chunk){.todo = j->todo + begin[last] - first, .n_todo = first + to - begin[last]};
    begin[last] = first + to;
  }
}

/* The chunk that most of the vertices lie in. */
static uint32_t owner_of(const job *j, const uint32_t *v) {
  uint32_t a = j->chunk_of[v[0]], b = j->chunk_of[v[1]], c = j->chunk_of[v[2]];
  uint32_t d = v[3] == TET_GHOST ? c : j->chunk_of[v[3]];
  return b == c || b == d ? b : c == d ? c : a;
}

/* The hint of the cell that vertex v is in. */
static _Atomic uint32_t *hint_at(const job *j, uint32_t v) {
  const double *x = at(j, v), *low = j->rounds->box.low;
  uint32_t cell = 0;
  for (int k = 0; k < 3; k++) {
    double place = (x[k] - low[k]) * j->cell_scale;
    cell = cell * j->cells + (place < j->cells ? (uint32_t)place : j->cells - 1);
  }
  return &j->hint[cell];
}

/* Gives one thread's share of the tetrahedra their owners. */
static void own(void *arg, uint32_t i) {
  job *j = arg;
  tet_complex *c = j->c;
  uint32_t t = tet_part(c->n_slots, j->threads, i), end = tet_part(c->n_slots, j->threads, i + 1);
  for (; t < end; t++) {
    const uint32_t *v = c->v + 4 * (size_t)t;
    if (!tet_is_live(c, t)) continue;
    c->flag[t] = (uint8_t)(owner_of(j, v) * TET_FLAG_OWNER);
    if (t % STEP == 0) atomic_store_explicit(hint_at(j, v[0]), t, memory_order_relaxed);
  }
}

static void disown(void *arg, uint32_t i) {
  job *j = arg;
  uint32_t from = tet_part(j->c->n_slots, j->threads, i), end = tet_part(j->c->n_slots, j->threads, i + 1);
  for (uint32_t t = from; t < end; t++) j->c->flag[t] &= TET_FLAG_OWNER - 1;
}

/* Where to start a walk to v: in its cell if there is something of this thread, else TET_NONE. */
static uint32_t hint_for(const job *j, const tet_complex *view, uint32_t v) {
  uint32_t t = atomic_load_explicit(hint_at(j, v), memory_order_relaxed);
  return t != TET_NONE && view->mine[tet_flag(view, t)] ? t : TET_NONE;
}

/* Where the last vertex went, unless that is another thread's now, which may be changing it. */
static void keep_place(tet_complex *view) {
  if (view->last != TET_NONE && !view->mine[tet_flag(view, view->last)]) view->last = TET_NONE;
}

/* Offers half of the chunks that are still to come, those last in line, to who has none. */
static void offer(job *j, worker *w) {
  exchange *e = &j->exchange;
  uint32_t count = (w->end - w->next + 1) / 2;
  pthread_mutex_lock(&e->lock);
  if (!e->n_offered) {
    for (uint32_t i = 0; i < count; i++) {
      uint8_t k = w->plan[--w->end];
      w->view.mine[k * TET_FLAG_OWNER] = 0;
      e->offered[e->n_offered++] = k;
    }
    pthread_cond_signal(&e->changed);
  }
  pthread_mutex_unlock(&e->lock);
  keep_place(&w->view);
}

/* Takes what is offered, or waits until something is; 0: all are done. */
static int take(job *j, worker *w) {
  exchange *e = &j->exchange;
  pthread_mutex_lock(&e->lock);
  w->next = w->end = 0;
  atomic_fetch_add(&e->n_hungry, 1);
  if (--e->n_working == 0) pthread_cond_broadcast(&e->changed);
  while (!e->n_offered && e->n_working) pthread_cond_wait(&e->changed, &e->lock);
  for (uint32_t i = 0; i < e->n_offered; i++) {
    w->plan[w->end++] = e->offered[i];
    w->view.mine[e->offered[i] * TET_FLAG_OWNER] = 1;
  }
  e->n_offered = 0;
  e->n_working += w->end > 0;
  atomic_fetch_sub(&e->n_hungry, 1);
  pthread_mutex_unlock(&e->lock);
  return w->end > 0;
}

/* Inserts what this thread can of chunk k; the others stay in its list. 0: time to stop. */
static int insert_chunk(job *j, worker *w, uint32_t k) {
  tet_complex *view = &w->view;
  chunk *part = &j->chunk[k];
  uint32_t rest = 0, i = 0, before = 0;
  int done = 0, is_stopping = 0;
  view->owner = (uint8_t)(k * TET_FLAG_OWNER);
  keep_place(view);
  for (; i < part->n_todo && w->status == TET_OK && !is_stopping; i++) {
    uint32_t v = part->todo[i], hint = done && v - before <= NEAR ? TET_NONE : hint_for(j, view, v);
    if (hint != TET_NONE) view->last = hint;
    done = 0;
    if (view->last != TET_NONE) w->status = tet_complex_insert_owned(view, v, &done);
    if (!done) part->todo[rest++] = v;
    else if ((before = v) % CELL == 0) atomic_store_explicit(hint_at(j, v), view->last, memory_order_relaxed);
    if (i % POLL < POLL - 1) continue;
    is_stopping = tet_is_stopping(j->c->ctx);
    if (j->is_sharing && w->next < w->end && atomic_load_explicit(&j->exchange.n_hungry, memory_order_relaxed)) offer(j, w);
  }
  for (; i < part->n_todo; i++) part->todo[rest++] = part->todo[i];
  part->n_todo = rest;
  return w->status == TET_OK && !is_stopping;
}

/* Inserts what one thread can. The number of those at work is told as they begin, as the
 * system may refuse to run them at the same time. */
static void insert(void *arg, uint32_t i) {
  job *j = arg;
  worker *w = &j->worker[i];
  pthread_mutex_lock(&j->exchange.lock);
  j->exchange.n_working++;
  pthread_mutex_unlock(&j->exchange.lock);
  int goes_on = 1;
  do {
    while (goes_on && w->next < w->end) goes_on = insert_chunk(j, w, w->plan[w->next++]);
  } while (take(j, w));
}

/* Half of run `run`: the one large chunk, or the small ones. Large first. */
static void plan_half(job *j, worker *w, uint32_t run, int large) {
  uint32_t n = j->per_thread;
  for (uint32_t i = large ? 0 : 1; i < (large ? 1 : n); i++) {
    uint8_t k = (uint8_t)(run * n + (run % 2 == 0 ? i : n - 1 - i));
    w->view.mine[k * TET_FLAG_OWNER] = 1;
    w->plan[w->end++] = k;
  }
}

/* Gives the chunks to the threads: in the first pass and every second after it to each its run, else the
 * second half of a run and the first of the next. */
static void plan(job *j, int pass) {
  for (uint32_t i = 0; i < j->threads; i++) {
    worker *w = &j->worker[i];
    memset(w->view.mine, 0, sizeof w->view.mine);
    w->next = w->end = 0;
    uint32_t next = (i + 1) % j->threads;
    plan_half(j, w, i, pass % 2 == 0 || i % 2);
    plan_half(j, w, pass % 2 == 0 ? i : next, pass % 2 && next % 2 == 0);
  }
}

/* What a thread sees of the complex, and lists of its own. */
static tet_status begin_view(job *j, uint32_t i) {
  tet_complex *c = j->c, *view = &j->worker[i].view;
  tet_complex_init(view, c->ctx, c->points);
  view->v = c->v;
  view->adj = c->adj;
  view->flag = c->flag;
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

static void free_view(tet_complex *view) {
  view->v = view->adj = NULL; /* the complex's */
  view->flag = NULL;
  tet_complex_free(view);
}

/* Takes back what the thread has of the complex. */
static void end_view(job *j, uint32_t i) {
  tet_complex *c = j->c, *view = &j->worker[i].view;
  if (view->last != TET_NONE) c->last = view->last;
  tet_complex_give_up(view);
  c->n_live += view->n_live; /* its change, of either sign */
  while (view->free_slot != TET_NONE) {
    uint32_t t = view->free_slot;
    view->free_slot = c->v[4 * (size_t)t];
    c->v[4 * (size_t)t] = c->free_slot;
    c->free_slot = t;
    c->n_free++;
  }
  free_view(view);
}

/* One pass of all threads; then j->todo holds what is left. */
static tet_status insert_pass(job *j, int pass) {
  tet_status status = TET_OK;
  uint32_t rest = 0;
  plan(j, pass);
  j->is_sharing = pass == 0; /* later there is less to win than lies at the walls of what is given away */
  tet_run_threads(j->threads, insert, j);
  for (uint32_t i = 0; i < j->threads && status == TET_OK; i++) status = j->worker[i].status;
  for (uint32_t k = 0; k < j->threads * j->per_thread; k++) {
    chunk *part = &j->chunk[k];
    memmove(j->todo + rest, part->todo, part->n_todo * sizeof *j->todo);
    part->todo = j->todo + rest;
    rest += part->n_todo;
  }
  j->n_todo = rest;
  return status == TET_OK ? tet_poll(j->c->ctx) : status;
}

/* Inserts with all threads what they can. */
static tet_status insert_together(job *j) {
  tet_complex *c = j->c;
  tet_status status = TET_OK;
  uint32_t begun = 0;
  cut(j);
  for (; begun < j->threads && status == TET_OK; begun++) status = begin_view(j, begun);
  if (status != TET_OK) {
    for (uint32_t i = 0; i < begun; i++) free_view(&j->worker[i].view);
    return status;
  }
  j->pool.end = (uint32_t)c->cap_slots;
  atomic_store(&j->pool.next, c->n_slots);
  tet_run_threads(j->threads, own, j);
  status = insert_pass(j, 0);
  for (int pass = 1; pass < MOST_PASSES && status == TET_OK && j->n_todo > WORTH * j->threads; pass++)
    status = insert_pass(j, pass);
  c->n_slots = atomic_load(&j->pool.next);
  tet_run_threads(j->threads, disown, j);
  c->free_slot = TET_NONE;
  c->n_free = 0;
  for (uint32_t i = 0; i < j->threads; i++) end_view(j, i);
  return status;
}

/* What no thread could insert, one by one. */
static tet_status insert_alone(job *j) {
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < j->n_todo && status == TET_OK; k++) {
    uint32_t v = j->todo[k], from = k && v - j->todo[k - 1] <= NEAR ? TET_NONE : hint_for(j, j->c, v);
    status = tet_complex_insert(j->c, v, from);
    if (status == TET_OK && v % CELL == 0) atomic_store_explicit(hint_at(j, v), j->c->last, memory_order_relaxed);
    if (status == TET_OK && k % POLL == 0) status = tet_poll(j->c->ctx);
  }
  return status;
}

/* The grid of hints, empty. */
static tet_status make_hints(job *j, uint32_t n_vertices) {
  while (j->cells < MOST_CELLS && (uint64_t)j->cells * j->cells * j->cells * CELL < n_vertices) j->cells++;
  uint32_t n_cells = j->cells * j->cells * j->cells;
  j->cell_scale = j->cells / TET_HILBERT_CELLS * j->rounds->box.scale;
  j->hint = tet_alloc(j->c->ctx, n_cells, sizeof *j->hint);
  for (uint32_t i = 0; i < n_cells && j->hint; i++) atomic_init(&j->hint[i], TET_NONE);
  return j->hint ? TET_OK : tet_ctx_error(j->c->ctx)->status;
}

tet_status tet_insert_round(tet_complex *c, const tet_rounds *rounds, uint32_t threads) {
  uint32_t first = rounds->start[rounds->n - 1], end = rounds->start[rounds->n];
  job j = {.c = c, .rounds = rounds, .threads = threads, .per_thread = CHUNKS / threads,
           .pool = {.block = LEAST_BLOCK}};
  uint64_t slots = (uint64_t)c->n_slots * end / first; /* as many a vertex as so far */
  while (j.pool.block < MOST_BLOCK && 256 * (uint64_t)j.pool.block * threads < slots) j.pool.block *= 2;
  tet_status status = tet_complex_reserve(c, slots / 64 * 65 + 2 * (uint64_t)j.pool.block * threads);
  if (status == TET_OK) status = make_hints(&j, end);
  if (status != TET_OK) return status;
  j.chunk_of = tet_alloc(c->ctx, first, 1);
  j.worker = tet_calloc(c->ctx, threads, sizeof *j.worker);
  j.todo = tet_alloc(c->ctx, end - first, sizeof *j.todo);
  if (!j.chunk_of || !j.worker || !j.todo) status = tet_ctx_error(c->ctx)->status;
  pthread_mutex_init(&j.exchange.lock, NULL);
  pthread_cond_init(&j.exchange.changed, NULL);
  for (uint32_t v = first; v < end && status == TET_OK; v++) j.todo[j.n_todo++] = v;
  if (status == TET_OK) status = insert_together(&j);
  if (status == TET_OK) status = insert_alone(&j);
  pthread_cond_destroy(&j.exchange.changed);
  pthread_mutex_destroy(&j.exchange.lock);
  tet_free(c->ctx, j.chunk_of);
  tet_free(c->ctx, j.worker);
  tet_free(c->ctx, j.hint);
  tet_free(c->ctx, j.todo);
  return status;
}
