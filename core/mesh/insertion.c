// SPDX-License-Identifier: Apache-2.0
/* insertion.c: Bowyer-Watson insertion of one vertex.
 *
 * The in-sphere test is perturbed symbolically and orientation is not (Devillers,
 * Teillaud 2011): the result is the unique regular tetrahedralization of the
 * perturbed lifting, free of flat tetrahedra, whatever the order of insertion.
 * The walls of a walled complex bound the search; facet recovery does its own cutting.
 *
 * This is the hot loop of everything. The cavity is found breadth first; each tetrahedron
 * beside it is tested once. New tetrahedra take the slots of the old ones first, and
 * find each other by a small table of the edges of the cavity's border (as in Marot,
 * Pellerin, Remacle 2019), or by a hash table where that has many vertices. */
#include <string.h>

#include "exact/predicates.h"
#include "exact/quick.h"
#include "exact/tally.h"
#include "mesh/complex.h"

typedef enum outcome {
  DONE,
  ROOM, /* the lists are too short to go on */
  ELSEWHERE /* a tetrahedron of another thread */
} outcome;

/* Whose tetrahedra a search meets. */
typedef enum kind {
  ALONE,  /* one thread's */
  WALLED, /* one thread's, with walls and TET_NONE beyond the boundary */
  SHARED  /* several threads' */
} kind;

enum {
  STEP = 4, /* what one tetrahedron can add to the lists */
  SEARCH = TET_FLAG_CAVITY | TET_FLAG_MARK
};

tet_status tet_complex_first(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e) {
  uint32_t v[4] = {a, b, d, e}, t, ghost[4];
  tet_status status = tet_complex_reserve(c, (uint64_t)c->n_slots + 5); /* so that none or all are made */
  if (status == TET_OK) status = tet_complex_new(c, &t);
  for (int i = 0; i < 4 && status == TET_OK; i++) status = tet_complex_new(c, &ghost[i]);
  if (status != TET_OK) return status;
  for (int i = 0; i < 4; i++) {
    c->v[4 * (size_t)t + i] = v[i];
    if (c->at) c->at[v[i]] = t;
    for (int j = 0; j < 3; j++) c->v[4 * (size_t)ghost[i] + j] = v[tet_face[i][j]];
    c->v[4 * (size_t)ghost[i] + 3] = TET_GHOST;
    tet_link(c, 4 * t + (uint32_t)i, 4 * ghost[i] + 3);
  }
  /* ghosts i and k meet at the edge that faces i and k share: in ghost i that is
     the face opposite vertex k of the tetrahedron */
  for (int i = 0; i < 4; i++)
    for (int k = i + 1; k < 4; k++)
      tet_link(c, 4 * ghost[i] + (uint32_t)tet_index_of(c, ghost[i], v[k]),
               4 * ghost[k] + (uint32_t)tet_index_of(c, ghost[k], v[i]));
  c->last = t;
  return TET_OK;
}

int tet_complex_conflict(const tet_complex *c, uint32_t t, uint32_t p) {
  const uint32_t *v = c->v + 4 * (size_t)t;
  if (v[3] == TET_GHOST) {
    int side = tet_orient3d(c->points, v[0], v[1], v[2], p);
    if (side) return side > 0;
    /* in the hull face's plane: the circumcircle, through the sphere inside */
    v = c->v + 4 * (size_t)(c->adj[4 * (size_t)t + 3] >> 2);
  }
  return tet_insphere_sos(c->points, v[0], v[1], v[2], v[3], p) > 0;
}

enum { UNASKED = 2 }; /* neither in conflict nor not: another thread would have to be asked */

/* tet_complex_conflict of a tetrahedron of this thread, or UNASKED. */
static int owned_conflict(const tet_complex *c, uint32_t t, uint32_t p) {
  if (tet_is_ghost(c, t) && !c->mine[tet_flag(c, c->adj[4 * (size_t)t + 3] >> 2) & TET_OWNER_BITS]) return UNASKED;
  return tet_complex_conflict(c, t, p);
}

/* A conflict that the first look does not settle. */
static __attribute__((noinline)) int slow_conflict(const tet_complex *c, uint32_t t, uint32_t p, int sign) {
  const uint32_t *v = c->v + 4 * (size_t)t;
  if (v[3] == TET_GHOST || sign == TET_UNSURE) return owned_conflict(c, t, p);
  return tet_insphere_tie(c->points, v[0], v[1], v[2], v[3], p) > 0;
}

/* owned_conflict, by a first look where all points are explicit, NULL where not. */
static inline __attribute__((always_inline)) int in_conflict(const tet_complex *c, uint32_t t, uint32_t p,
                                                             tet_quick_look *look) {
  if (!look) return tet_complex_conflict(c, t, p);
  const uint32_t *v = c->v + 4 * (size_t)t;
  if (__builtin_expect(v[3] == TET_GHOST, 0)) return slow_conflict(c, t, p, TET_UNSURE);
  const double *x = c->points->x;
  int sign = look(x + 3 * (size_t)v[0], x + 3 * (size_t)v[1], x + 3 * (size_t)v[2], x + 3 * (size_t)v[3],
                  x + 3 * (size_t)p, c->points->grain5);
  tet_count(c->points, TET_TALLIED_INSPHERE);
  return __builtin_expect(sign & 1, 1) ? sign > 0 : slow_conflict(c, t, p, sign);
}

/* 1 if a tetrahedron with these flags is to be tested: this thread's and not yet met. */
static inline __attribute__((always_inline)) int is_new(const tet_complex *c, uint8_t flags, kind in) {
  return in == SHARED ? c->mine[flags] : in == WALLED ? !(flags & SEARCH) : flags == 0;
}

static inline __attribute__((always_inline)) uint32_t walls_of(const tet_complex *c, uint32_t t, kind in) {
  return in == WALLED ? c->wall[t] : 0;
}

/* What is beyond face i of t; t itself beyond a wall. */
static inline __attribute__((always_inline)) uint32_t beyond(const tet_complex *c, uint32_t t, uint32_t i, uint32_t wall) {
  uint32_t o = c->adj[4 * (size_t)t + i] >> 2;
  return wall >> i & 1 ? t : o;
}

/* Marks what is beyond the faces of some tetrahedra of the cavity and was not met before, and lists it. Returns 1 if
 * there is something of another thread's. */
static inline __attribute__((always_inline)) int meet(tet_complex *c, const uint32_t *some, size_t n, uint32_t *met,
                                                      uint32_t *ret_n, kind in) {
  uint32_t n_met = 0;
  int elsewhere = 0;
  for (size_t k = 0; k < n; k++) {
    uint32_t t = some[k], wall = walls_of(c, t, in);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t o = beyond(c, t, i, wall);
      uint8_t f = tet_flag(c, o);
      if (in == SHARED && !c->mine[f & TET_OWNER_BITS]) {
        elsewhere = 1;
        continue;
      }
      uint32_t new = (uint32_t)is_new(c, f, in);
      tet_set_flag(c, o, (uint8_t)(f | TET_FLAG_MARK * new));
      __builtin_prefetch(c->v + 4 * (size_t)o);
      met[n_met] = o; /* overwritten if it is not new */
      n_met += new;
    }
  }
  *ret_n = n_met;
  return elsewhere;
}

/* Tests what was met, and adds to the cavity what is in conflict. Returns 1 if another thread would have to be asked. */
static inline __attribute__((always_inline)) int test(tet_complex *c, const uint32_t *met, uint32_t n_met, uint32_t p,
                                                      tet_quick_look *look, kind in) {
  for (uint32_t k = 0; k < n_met; k++) {
    uint32_t o = met[k];
    int conflict = in_conflict(c, o, p, look);
    if (in == SHARED && conflict == UNASKED) return 1;
    tet_set_flag(c, o, tet_flag(c, o) ^ (uint8_t)(SEARCH * conflict)); /* not marked any more, but of the cavity */
    c->cavity[c->n_cavity] = o;
    c->n_cavity += (size_t)conflict;
    __builtin_prefetch(c->adj + 4 * (size_t)o);
  }
  return 0;
}

/* Adds to the border those faces of some tetrahedra of the cavity that are walls, or that nothing of it is beyond. */
static inline __attribute__((always_inline)) void add_border(tet_complex *c, const uint32_t *some, size_t n, uint32_t p,
                                                             kind in) {
  tet_border *b = c->border + c->n_border;
  for (size_t k = 0; k < n; k++) {
    uint32_t t = some[k], wall = walls_of(c, t, in);
    const uint32_t *v = c->v + 4 * (size_t)t;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t o = beyond(c, t, i, wall);
      memcpy(b->v, v, sizeof b->v);
      b->v[i] = p;
      b->outer = c->adj[4 * (size_t)t + i];
      b->inner = 4 * t + i;
      __builtin_prefetch(c->adj + 4 * (size_t)o, 1);
      b += (wall >> i & 1) | !(tet_flag(c, o) & TET_FLAG_CAVITY); /* else overwritten */
    }
  }
  c->n_border = (size_t)(b - c->border);
}

/* Takes the marks of a search away from t; what is one thread's has no others. */
static inline void end_search(tet_complex *c, uint32_t t) {
  tet_set_flag(c, t, c->pool ? tet_flag(c, t) & TET_OWNER_BITS : 0);
}

/* Goes on with the search for the cavity of p from its *k-th tetrahedron: some are looked at together, first for what is
 * beside them, then for what of that is in conflict, then for which of their faces are border. So no branch waits for
 * a test, as nobody can foretell what comes out. */
static inline __attribute__((always_inline)) outcome search(tet_complex *c, size_t *k, uint32_t p, tet_quick_look *look,
                                                            kind in) {
  enum { MANY = 16 };
  uint32_t met[STEP * MANY], n_met;
  while (*k < c->n_cavity) {
    size_t room = c->cap_cavity - c->n_cavity, border_room = c->cap_border - c->n_border, n = c->n_cavity - *k;
    if (room < STEP || border_room < STEP) return ROOM;
    if (n > room / STEP) n = room / STEP;
    if (n > border_room / STEP) n = border_room / STEP;
    if (n > MANY) n = MANY;
    const uint32_t *some = c->cavity + *k;
    if (meet(c, some, n, met, &n_met, in) || test(c, met, n_met, p, look, in)) {
      while (n_met--) end_search(c, met[n_met]);
      return ELSEWHERE;
    }
    add_border(c, some, n, p, in);
    *k += n;
  }
  return DONE;
}

typedef outcome search_fn(tet_complex *c, size_t *k, uint32_t p);

static outcome search_any(tet_complex *c, size_t *k, uint32_t p) { return search(c, k, p, NULL, ALONE); }
static outcome search_explicit(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere, ALONE);
}
static outcome search_walled(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere, WALLED);
}
static outcome search_shared(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere, SHARED);
}
#if TET_HAVE_AVX2
TET_AVX2 static outcome search_avx2(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere_avx2, ALONE);
}
TET_AVX2 static outcome search_walled_avx2(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere_avx2, WALLED);
}
TET_AVX2 static outcome search_shared_avx2(tet_complex *c, size_t *k, uint32_t p) {
  return search(c, k, p, tet_quick_insphere_avx2, SHARED);
}
#else
#define search_avx2 search_explicit
#define search_walled_avx2 search_walled
#define search_shared_avx2 search_shared
#endif

/* The search of this kind for this processor. */
static search_fn *search_for(const tet_complex *c, kind in) {
  static search_fn *const all[][2] = {{search_explicit, search_avx2},
                                      {search_walled, search_walled_avx2},
                                      {search_shared, search_shared_avx2}};
  if (c->points->first_implicit < c->points->n && in == ALONE) return search_any;
  return all[in][TET_HAVE_AVX2 && tet_has_avx2()];
}

void tet_complex_forget(tet_complex *c) {
  for (size_t k = 0; k < c->n_cavity; k++) end_search(c, c->cavity[k]);
  for (size_t k = 0; k < c->n_border; k++)
    if (c->border[k].outer != TET_NONE) end_search(c, c->border[k].outer >> 2);
  c->n_cavity = c->n_border = 0;
}

static tet_status make_room(tet_complex *c) {
  tet_status status = tet_grow(c->ctx, &c->cavity, &c->cap_cavity, c->n_cavity + 64, sizeof *c->cavity);
  if (status == TET_OK)
    status = tet_grow(c->ctx, &c->border, &c->cap_border, c->n_border + 64, sizeof *c->border);
  return status;
}

/* The cavity of p around t, which is in conflict with it. */
static outcome collect(tet_complex *c, uint32_t t, uint32_t p, size_t *k, kind in) {
  if (*k == 0) {
    c->n_border = 0;
    c->n_cavity = 1;
    c->cavity[0] = t;
    tet_set_flag(c, t, tet_flag(c, t) | TET_FLAG_CAVITY);
  }
  return search_for(c, in)(c, k, p);
}

/* The number of vertex v in the small table. Numbers are given as vertices come, without a
 * branch, as nobody can foretell which ones have come before. */
static inline uint32_t place_of(tet_complex *c, uint32_t v, uint32_t *n_round) {
  uint32_t ghost = (uint32_t)c->cap_place - 1, at = v < ghost ? v : ghost, place = c->place[at];
  c->round[*n_round] = at;
  *n_round += !place;
  place = place ? place : *n_round;
  c->place[at] = (uint8_t)place;
  return place - 1;
}

/* Joins the new tetrahedra: each edge of the border is passed once in either direction, and the
 * faces above the two passages meet; but for an open border, where one may be missing. 0: that has too many vertices,
 * and nothing is done. */
static inline __attribute__((always_inline)) int join_small(tet_complex *c, const uint32_t *slot, int is_open) {
  uint32_t n_round = 0;
  for (size_t k = 0; k < c->n_border; k++) {
    if (is_open && n_round + 3 > TET_SMALL_STAR) {
      while (n_round--) c->place[c->round[n_round]] = 0;
      return 0;
    }
    const tet_border *b = &c->border[k];
    const uint8_t *f = tet_face[b->inner & 3];
    uint32_t place[3];
    for (int m = 0; m < 3; m++) place[m] = place_of(c, b->v[f[m]], &n_round);
    for (int m = 0; m < 3; m++) {
      uint32_t from = place[m], to = place[(m + 1) % 3];
      if (!is_open) c->edge[from][to] = 4 * slot[k] + f[(m + 2) % 3];
      else c->edge[to][from] = TET_NONE;
      c->back[3 * k + (size_t)m] = (uint16_t)(to * TET_SMALL_STAR + from);
    }
  }
  for (size_t k = 0; k < c->n_border && is_open; k++) {
    const uint8_t *f = tet_face[c->border[k].inner & 3];
    for (size_t m = 0; m < 3; m++) {
      uint32_t back = c->back[3 * k + m], to = back / TET_SMALL_STAR, from = back % TET_SMALL_STAR;
      c->edge[from][to] = 4 * slot[k] + f[(m + 2) % 3];
    }
  }
  for (size_t k = 0; k < c->n_border; k++) {
    const uint8_t *f = tet_face[c->border[k].inner & 3];
    for (size_t m = 0; m < 3; m++) c->adj[4 * (size_t)slot[k] + f[(m + 2) % 3]] = (&c->edge[0][0])[c->back[3 * k + m]];
  }
  for (uint32_t k = 0; k < n_round; k++) c->place[c->round[k]] = 0;
  return 1;
}

/* The same by hashing edges, for any number of vertices. map.mask + 1 slots, twice the edges. */
static void join_large(tet_complex *c, const uint32_t *slot) {
  tet_star_map *m = &c->map;
  memset(m->key, 0, (m->mask + 1) * sizeof *m->key);
  for (size_t k = 0; k < c->n_border; k++) {
    const tet_border *b = &c->border[k];
    uint32_t n = slot[k];
    const uint8_t *f = tet_face[b->inner & 3];
    for (int j = 0; j < 3; j++) {
      uint32_t x = b->v[f[j]], y = b->v[f[(j + 1) % 3]], h = 4 * n + f[(j + 2) % 3];
      uint64_t key = x < y ? (uint64_t)y << 32 | x : (uint64_t)x << 32 | y; /* never 0: x != y */
      size_t i = (key * UINT64_C(0x9e3779b97f4a7c15) >> 32) & m->mask;
      while (m->key[i] && m->key[i] != key) i = (i + 1) & m->mask;
      if (m->key[i]) tet_link(c, h, m->handle[i]);
      else c->adj[h] = TET_NONE; /* where the border is open, for good */
      m->key[i] = key;
      m->handle[i] = h;
    }
  }
}

/* A closed surface of triangles has two of them for each vertex but two; an open one may have more vertices, but
 * no more than triangles and two. */
static int is_small(const tet_complex *c) { return c->n_border / 2 + 2 <= TET_SMALL_STAR; }
static int is_small_if_open(const tet_complex *c) { return c->n_border + 5 <= TET_SMALL_STAR; }

/* Memory for join_large. */
static tet_status make_map(tet_complex *c) {
  tet_star_map *m = &c->map;
  size_t slots = 512;
  while (slots < 3 * c->n_border) slots *= 2;
  m->mask = slots - 1;
  tet_status status = tet_grow(c->ctx, &m->key, &m->cap_key, slots, sizeof *m->key);
  if (status == TET_OK) status = tet_grow(c->ctx, &m->handle, &m->cap_handle, slots, sizeof *m->handle);
  return status;
}

/* Replaces the cavity by tetrahedra from the vertex to its border, in the slots c->cavity has now
 * one for each of. */
static inline __attribute__((always_inline)) void fill(tet_complex *c, kind in) {
  uint32_t *slot = c->cavity;
  for (size_t k = 0; k < c->n_border; k++) {
    const tet_border *b = &c->border[k];
    uint32_t n = slot[k], h = 4 * n + (b->inner & 3);
    memcpy(c->v + 4 * (size_t)n, b->v, sizeof b->v);
    tet_set_flag(c, n, c->owner);
    c->adj[h] = b->outer;
    if (in == WALLED && b->outer == TET_NONE) continue;
    tet_set_flag(c, b->outer >> 2, in == SHARED ? tet_flag(c, b->outer >> 2) & TET_OWNER_BITS : 0);
    c->adj[b->outer] = h;
  }
  if (!is_small(c) || !join_small(c, slot, in == WALLED)) join_large(c, slot);
  for (size_t k = c->n_border; k < c->n_cavity; k++) tet_complex_delete(c, slot[k]);
  c->last = slot[0];
  for (size_t k = 0; c->at && k < c->n_border; k++)
    for (int i = 0; i < 4; i++)
      if (c->border[k].v[i] != TET_GHOST) c->at[c->border[k].v[i]] = slot[k];
}

/* Everything that a fill needs: slots for all of the border behind those of the cavity, the
 * map for a large one, and a copy of the old tetrahedra if one is asked for. */
static tet_status prepare(tet_complex *c) {
  size_t have = c->n_cavity;
  tet_status status = tet_grow(c->ctx, &c->cavity, &c->cap_cavity, c->n_border, sizeof *c->cavity);
  if (status == TET_OK && !(c->is_walled ? is_small_if_open(c) : is_small(c))) status = make_map(c);
  if (status == TET_OK && c->keep_old)
    status = tet_grow(c->ctx, &c->old, &c->cap_old, c->n_cavity, sizeof *c->old);
  for (; have < c->n_border && status == TET_OK; have += status == TET_OK)
    status = tet_complex_new(c, &c->cavity[have]);
  if (status != TET_OK) {
    while (have > c->n_cavity) tet_complex_delete(c, c->cavity[--have]);
    return status;
  }
  for (size_t k = 0; c->keep_old && k < c->n_cavity; k++)
    memcpy(c->old[k], c->v + 4 * (size_t)c->cavity[k], sizeof *c->old);
  return TET_OK;
}

/* 1 if vertex p is where a vertex of t is: no cavity is sound then. */
static int is_taken(const tet_complex *c, uint32_t t, uint32_t p) {
  const double *x = c->points->x, *xp = x + 3 * (size_t)p;
  if (tet_is_implicit(c->points, p)) return 0;
  for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4; h++) {
    uint32_t v = c->v[h];
    if (v == TET_GHOST || tet_is_implicit(c->points, v)) continue;
    const double *xv = x + 3 * (size_t)v;
    if (xv[0] == xp[0] && xv[1] == xp[1] && xv[2] == xp[2]) return 1;
  }
  return 0;
}

tet_status tet_complex_insert(tet_complex *c, uint32_t p, uint32_t from) {
  size_t k = 0;
  uint32_t t = tet_complex_approach(c, from, p);
  int found = tet_complex_conflict(c, t, p);
  tet_status status = found ? TET_OK : tet_complex_locate(c, t, p, &t);
  if (status == TET_OK && !c->cap_border) status = make_room(c);
  if (status != TET_OK) return status;
  if (is_taken(c, t, p)) return tet_internal(c->ctx, "a vertex where another is");
  if (!found && !tet_complex_conflict(c, t, p)) return tet_internal(c->ctx, "a located vertex without conflict");
  while (status == TET_OK && collect(c, t, p, &k, ALONE) == ROOM) status = make_room(c);
  if (status == TET_OK) status = prepare(c);
  if (status == TET_OK) fill(c, ALONE);
  else tet_complex_forget(c);
  return status;
}

/* 1 if prepare has nothing to ask the context for. */
static int has_room(tet_complex *c) {
  size_t more = c->n_border > c->n_cavity ? c->n_border - c->n_cavity : 0;
  if (!is_small(c) || c->n_border > c->cap_cavity) return 0;
  return more <= (c->cap_slots - c->n_slots) + (size_t)c->n_free || tet_complex_take_block(c, more);
}

tet_status tet_complex_insert_owned(tet_complex *c, uint32_t p, int *ret_done) {
  size_t k = 0;
  uint32_t t = c->last = tet_complex_approach(c, c->last, p);
  *ret_done = 0;
  if (is_taken(c, t, p) || owned_conflict(c, t, p) != 1) return TET_OK;
  if (collect(c, t, p, &k, SHARED) != DONE || !has_room(c)) {
    tet_complex_forget(c);
    return TET_OK;
  }
  tet_status status = prepare(c);
  if (status != TET_OK) return status;
  fill(c, SHARED);
  *ret_done = 1;
  return TET_OK;
}

tet_status tet_complex_grow_to(tet_complex *c, uint32_t p, size_t most, size_t *k, int *ret_more) {
  tet_status status = TET_OK;
  *ret_more = 0;
  if (!*k) c->n_border = 0;
  while (status == TET_OK) {
    size_t cap = c->cap_cavity;
    int is_least = most < cap;
    if (is_least) c->cap_cavity = most; /* the search sees no more room than that */
    outcome found = search_for(c, WALLED)(c, k, p);
    c->cap_cavity = cap;
    if (found != ROOM) break;
    *ret_more = is_least && most < c->n_cavity + STEP;
    if (*ret_more) break;
    status = make_room(c);
  }
  return status;
}

tet_status tet_complex_grow(tet_complex *c, uint32_t p) {
  size_t k = 0;
  int more;
  return tet_complex_grow_to(c, p, SIZE_MAX, &k, &more);
}

tet_status tet_complex_fill(tet_complex *c) {
  tet_status status = prepare(c);
  if (status == TET_OK) fill(c, WALLED);
  return status;
}
