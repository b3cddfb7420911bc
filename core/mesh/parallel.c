// SPDX-License-Identifier: Apache-2.0
/* parallel.c: insertion of many vertices by several threads, without locks.
 *
 * After Marot, Pellerin, Remacle (2019): a Hilbert curve is cut into as many parts as there are
 * threads, and every tetrahedron is the part's that most of its vertices lie in. A thread reads and
 * changes tetrahedra of its part alone, the new ones included. A vertex whose walk or cavity, with
 * the tetrahedra around it, leaves the part is put off: to another pass, with a curve that
 * is cut elsewhere, and what is left after the last to one thread. The tetrahedra made
 * depend on no order; their slots do. */
#include "mesh/parallel.h"

#include <string.h>

#include "base/sort.h"
#include "base/threads.h"

enum {
  PASSES = 4,
  SCRATCH = 1024, /* most old tetrahedra and border faces of a cavity that a thread changes */
  WORTH = 256,    /* slots that are looked through in the time that one vertex takes */
  STEP = 16,      /* of the tetrahedra that are taken for hints */
  NEAR = 8,       /* numbers apart from the last vertex inserted, beyond which a hint is better */
  CELL = 32,      /* vertices to a cell of hints, about */
  MOST_CELLS = 128, /* to a side */
  POLL = 256,
  KEYS = 256
};

_Static_assert((TET_MOST_THREADS * TET_FLAG_OWNER) >> 8 == 0, "an owner fits the flags");

/* A thread and its part of the curve. */
typedef struct worker {
  tet_complex view;       /* of the shared complex, with lists of its own */
  uint32_t *todo, n_todo; /* the vertices of the part; after a pass those put off */
  uint64_t cut;           /* the first key of the part, 0 for the first part */
  tet_status status;
} worker;

typedef struct job {
  tet_complex *c;
  const tet_rounds *rounds;
  tet_hilbert_box box;  /* of this pass's curve */
  uint32_t threads, n_vertices;
  tet_slot_pool pool;
  uint8_t *part_of;     /* [n_vertices] */
  worker *worker;       /* [threads] */
  uint32_t *todo;       /* [n_todo] of all, along the curve */
  uint32_t n_todo;
  uint32_t cells;       /* to a side of the rounds' cube */
  double cell_scale;    /* cells to a unit of length */
  _Atomic uint32_t *hint; /* [cells^3] some tetrahedron in or near the cell, or TET_NONE */
} job;

static const double *at(const job *j, uint32_t v) { return j->c->points->x + 3 * (size_t)v; }

/* Another curve for each pass: the first is the one of the rounds; the cubes of the others lie
 * so that no large cells have walls in common. */
static tet_hilbert_box curve_of(const tet_hilbert_box *first, int pass) {
  static const double larger[PASSES] = {1, 1.5, 1.8, 1.3}, back[PASSES] = {0, 0.155, 0.456, 0.23};
  tet_hilbert_box box = *first;
  for (int k = 0; k < 3 && box.scale > 0; k++) box.low[k] -= back[pass] * TET_HILBERT_CELLS / box.scale;
  box.scale /= larger[pass];
  return box;
}

/* Sorts what is to do along the curve of this pass. */
static tet_status sort_todo(job *j) {
  tet_keyed *item = tet_alloc(j->c->ctx, j->n_todo, sizeof *item);
  tet_keyed *scratch = tet_alloc(j->c->ctx, j->n_todo, sizeof *scratch);
  uint64_t key[KEYS];
  tet_status status = item && scratch ? TET_OK : tet_ctx_error(j->c->ctx)->status;
  for (uint32_t i = 0; i < j->n_todo && status == TET_OK; i++) {
    if (i % KEYS == 0)
      tet_hilbert_keys(&j->box, at(j, 0), j->todo + i, j->n_todo - i < KEYS ? j->n_todo - i : KEYS, key);
    item[i] = (tet_keyed){key[i % KEYS], j->todo[i]};
  }
  if (status == TET_OK) tet_sort_radix(item, scratch, j->n_todo, j->threads);
  for (uint32_t i = 0; i < j->n_todo && status == TET_OK; i++) j->todo[i] = (uint32_t)item[i].value;
  tet_free(j->c->ctx, item);
  tet_free(j->c->ctx, scratch);
  return status;
}

/* Deals out what is to do in equal parts. */
static void deal(job *j) {
  for (uint32_t i = 0; i < j->threads; i++) {
    worker *w = &j->worker[i];
    uint32_t first = tet_part(j->n_todo, j->threads, i);
    w->todo = j->todo + first;
    w->n_todo = tet_part(j->n_todo, j->threads, i + 1) - first;
    w->cut = i ? tet_hilbert_key(&j->box, at(j, j->todo[first])) : 0;
  }
}

/* Of one thread's share of the vertices, the parts. */
static void part_vertices(void *arg, uint32_t i) {
  job *j = arg;
  uint64_t key[KEYS];
  uint32_t v = tet_part(j->n_vertices, j->threads, i), end = tet_part(j->n_vertices, j->threads, i + 1);
  while (v < end) {
    uint32_t count = end - v < KEYS ? end - v : KEYS;
    tet_hilbert_keys(&j->box, at(j, v), NULL, count, key);
    for (uint32_t k = 0; k < count; k++) {
      uint32_t p = 0;
      while (p + 1 < j->threads && key[k] >= j->worker[p + 1].cut) p++;
      j->part_of[v + k] = (uint8_t)p;
    }
    v += count;
  }
}

/* The part that most of the vertices lie in. */
static uint32_t owner_of(const job *j, const uint32_t *v) {
  uint32_t a = j->part_of[v[0]], b = j->part_of[v[1]], c = j->part_of[v[2]];
  uint32_t d = v[3] == TET_GHOST ? c : j->part_of[v[3]];
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

/* Where to start a walk to v: in its cell if there is something of this part, else TET_NONE. */
static uint32_t hint_for(const job *j, const tet_complex *view, uint32_t v) {
  uint32_t t = atomic_load_explicit(hint_at(j, v), memory_order_relaxed);
  return t != TET_NONE && tet_flag(view, t) == view->owner ? t : TET_NONE;
}

/* Inserts what one thread can; the others stay in its list. */
static void insert(void *arg, uint32_t i) {
  job *j = arg;
  worker *w = &j->worker[i];
  tet_complex *view = &w->view;
  uint32_t rest = 0, k = 0, before = 0;
  int done = 0;
  for (; k < w->n_todo && w->status == TET_OK; k++) {
    uint32_t v = w->todo[k], hint = done && v - before <= NEAR ? TET_NONE : hint_for(j, view, v);
    if (k % POLL == POLL - 1 && tet_is_stopping(j->c->ctx)) break;
    if (hint != TET_NONE) view->last = hint;
    done = 0;
    if (view->last != TET_NONE) w->status = tet_complex_insert_owned(view, v, &done);
    if (!done) w->todo[rest++] = v;
    else if ((before = v) % CELL == 0) atomic_store_explicit(hint_at(j, v), view->last, memory_order_relaxed);
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

static void free_view(tet_complex *view) {
  view->v = view->adj = NULL; /* the complex's */
  view->flag = NULL;
  tet_complex_free(view);
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
  free_view(view);
}

/* All threads at work on what is dealt out. */
static tet_status run_threads(job *j) {
  tet_complex *c = j->c;
  tet_status status = TET_OK;
  uint32_t begun = 0;
  for (; begun < j->threads && status == TET_OK; begun++) status = begin_view(j, begun);
  if (status != TET_OK) {
    for (uint32_t i = 0; i < begun; i++) free_view(&j->worker[i].view);
    return status;
  }
  tet_run_threads(j->threads, part_vertices, j);
  tet_run_threads(j->threads, own, j);
  tet_run_threads(j->threads, insert, j);
  c->n_slots = atomic_load(&j->pool.next);
  tet_run_threads(j->threads, disown, j);
  c->free_slot = TET_NONE;
  c->n_free = 0;
  for (uint32_t i = 0; i < j->threads; i++) {
    if (status == TET_OK) status = j->worker[i].status;
    if (j->worker[i].view.last != TET_NONE) c->last = j->worker[i].view.last;
    end_view(j, i);
  }
  return status == TET_OK ? tet_poll(c->ctx) : status;
}

static tet_status insert_pass(job *j, int pass) {
  uint32_t rest = 0;
  j->box = curve_of(&j->rounds->box, pass);
  tet_status status = pass ? sort_todo(j) : TET_OK;
  if (status != TET_OK) return status;
  deal(j);
  j->pool.end = (uint32_t)j->c->cap_slots;
  atomic_store(&j->pool.next, j->c->n_slots);
  status = run_threads(j);
  for (uint32_t i = 0; i < j->threads && status == TET_OK; i++) {
    memmove(j->todo + rest, j->worker[i].todo, j->worker[i].n_todo * sizeof *j->todo);
    rest += j->worker[i].n_todo;
  }
  if (status == TET_OK) j->n_todo = rest;
  return status;
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

/* Passes as long as one costs less than to insert what is left alone, and puts off less than half. */
static tet_status insert_all(job *j) {
  tet_status status = TET_OK;
  uint32_t before = UINT32_MAX;
  for (int pass = 0; pass < PASSES && status == TET_OK; pass++) {
    if ((uint64_t)j->n_todo * WORTH * j->threads < j->c->n_slots || j->n_todo > before / 2) break;
    before = j->n_todo;
    status = insert_pass(j, pass);
  }
  return status == TET_OK ? insert_alone(j) : status;
}

tet_status tet_insert_round(tet_complex *c, const tet_rounds *rounds, uint32_t threads) {
  uint32_t first = rounds->start[rounds->n - 1], end = rounds->start[rounds->n];
  job j = {.c = c, .rounds = rounds, .threads = threads, .n_vertices = end};
  /* as many slots a vertex as so far, and some */
  tet_status status = tet_complex_reserve(c, (uint64_t)c->n_slots * end / first / 64 * 65 + 4096 * threads);
  if (status != TET_OK) return status;
  j.part_of = tet_alloc(c->ctx, end, 1);
  j.worker = tet_calloc(c->ctx, threads, sizeof *j.worker);
  j.todo = tet_alloc(c->ctx, end - first, sizeof *j.todo);
  while (j.cells < MOST_CELLS && (uint64_t)j.cells * j.cells * j.cells * CELL < end) j.cells++;
  uint32_t n_cells = j.cells * j.cells * j.cells;
  j.cell_scale = j.cells / TET_HILBERT_CELLS * rounds->box.scale;
  j.hint = tet_alloc(c->ctx, n_cells, sizeof *j.hint);
  if (!j.part_of || !j.worker || !j.todo || !j.hint) status = tet_ctx_error(c->ctx)->status;
  for (uint32_t i = 0; i < n_cells && status == TET_OK; i++) atomic_init(&j.hint[i], TET_NONE);
  for (uint32_t v = first; v < end && status == TET_OK; v++) j.todo[j.n_todo++] = v;
  if (status == TET_OK) status = insert_all(&j);
  tet_free(c->ctx, j.part_of);
  tet_free(c->ctx, j.worker);
  tet_free(c->ctx, j.hint);
  tet_free(c->ctx, j.todo);
  return status;
}
