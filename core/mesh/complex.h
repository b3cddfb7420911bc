// SPDX-License-Identifier: Apache-2.0
/* complex.h: a tetrahedral complex of the whole space, and how it is changed.
 *
 * Finite tetrahedra fill the convex hull; ghost tetrahedra, whose vertex 3 is
 * TET_GHOST, close it, so that every face has two sides. Tetrahedra, faces and
 * edges are as drawn in pieces.h. A handle 4t+i names face i of tetrahedron t.
 * A ghost (a, b, c, TET_GHOST) is beyond hull face abc: orient3d(a,b,c,p) > 0
 * for a p that sees it.
 *
 * Points are seen through the exact predicates alone; implicit ones included.
 * Location, insertion and removal here serve the Delaunay stage and segment recovery;
 * facet recovery cuts and fills through the lower functions.
 *
 * A walled complex is that of a domain, as refinement has it: without ghosts, TET_NONE
 * beyond its boundary, and with walls, the faces that no cavity crosses. Its cavities are
 * grown and filled by the same code (tet_complex_grow, tet_complex_fill).
 */
#ifndef TET_MESH_COMPLEX_H
#define TET_MESH_COMPLEX_H

#include "base/context.h"
#include "exact/points.h"
#include "mesh/pieces.h"

#include <stdatomic.h>

#define TET_GHOST (UINT32_MAX - 1)
#define TET_MOST_TETRAHEDRA (UINT32_MAX >> 2) /* as their faces have numbers as well */

enum {
  TET_FLAG_FREE = 1,   /* the slot is unused */
  TET_FLAG_CAVITY = 2, /* in the cavity that is being filled */
  TET_FLAG_MARK = 4,   /* for searches; clear when they end */
  TET_FLAG_OWNER = 8,  /* times a number, by which threads know what they may change */
  TET_OWNER_BITS = 0xff & ~(TET_FLAG_OWNER - 1)
};

enum {
  TET_OWNERS = 32,       /* numbers that the flags have room for */
  TET_MOST_THREADS = 31, /* with one of them at least */
  TET_SMALL_STAR = 64    /* vertices of a cavity's border that the small edge table holds */
};

/* A face of a cavity's border as the tetrahedron that will stand on it. */
typedef struct tet_border {
  uint32_t v[4];  /* those of the tetrahedron inside, but for the new vertex opposite the face */
  uint32_t outer; /* the handle beyond; TET_NONE at the boundary of a domain */
  uint32_t inner; /* the handle of the same face in the cavity */
} tet_border;

/* A hash table from edges to faces, for cavities of many vertices. */
typedef struct tet_star_map {
  uint64_t *key;
  uint32_t *handle;
  size_t cap_key, cap_handle, mask;
} tet_star_map;

/* Slots that several threads share: those from `next` on, below `end`, are nobody's yet. */
typedef struct tet_slot_pool {
  _Atomic uint32_t next;
  uint32_t end, block; /* the latter: how many a thread takes at a time */
} tet_slot_pool;

typedef struct tet_complex {
  tet_ctx *ctx;
  const tet_points *points;
  uint32_t *v;         /* [slots][4] */
  uint32_t *adj;       /* [slots][4] handles */
  uint8_t *flag;       /* [slots] */
  uint8_t *wall;       /* [slots] of a walled complex: bit i, face i is a wall; else NULL */
  uint32_t n_slots, n_live; /* live: finite and ghost */
  size_t cap_v, cap_adj, cap_flag, cap_wall, cap_slots; /* the last: what all hold */
  uint32_t *at;        /* [points] a tetrahedron with the vertex, or TET_NONE; NULL while
                          many are inserted */
  size_t cap_at;
  uint32_t free_slot, n_free; /* first of the free slots, chained through v[4t]; or TET_NONE */
  uint32_t last;       /* where the last walk ended */
  uint32_t random;     /* of the walk */
  tet_slot_pool *pool; /* where a thread among several gets its slots; else NULL */
  uint8_t owner;       /* TET_FLAG_OWNER times the number of new tetrahedra; 0 but for several threads */
  uint8_t mine[256];   /* 1: tetrahedra with these flags are this thread's, and in no search */
  uint8_t keep_old;    /* 1: insertions fill `old` */
  uint8_t is_walled;   /* 1: a domain's, with walls and without ghosts */
  uint8_t is_canonical; /* 1: bulk insertion is to leave slots that do not depend on threads */

  /* Scratch, and what the last change did. */
  uint32_t *cavity;    /* [n_cavity] the slots of the old tetrahedra, which new ones take */
  uint32_t (*old)[4];  /* [n_cavity] their vertices, if keep_old */
  tet_border *border;  /* [n_border] */
  uint32_t *made;      /* [n_made] of tet_complex_star */
  size_t n_cavity, cap_cavity, cap_old, n_border, cap_border, n_made, cap_made;
  uint8_t *place;      /* [points and more] 1 + place in `round`, 0: not in the star; the last
                          is the ghost vertex's */
  size_t cap_place;
  uint32_t round[TET_SMALL_STAR + 1];
  uint32_t edge[TET_SMALL_STAR][TET_SMALL_STAR]; /* face above the edge between two places */
  uint16_t back[6 * TET_SMALL_STAR];       /* where the other face at an edge will be */
  tet_star_map map;
  struct tet_hole *hole; /* of removals; NULL before the first */
} tet_complex;

void tet_complex_init(tet_complex *c, tet_ctx *ctx, const tet_points *points);
void tet_complex_free(tet_complex *c);

/* Takes all tetrahedra out; keeps the memory. `at` means nothing for vertices that are not
 * inserted again. */
void tet_complex_clear(tet_complex *c);

/* A new slot; its entries are undefined. */
tet_status tet_complex_new(tet_complex *c, uint32_t *ret_t);
/* Frees the slot of t. Handles to it must be gone. */
void tet_complex_delete(tet_complex *c, uint32_t t);
/* Makes sure of room for n slots. */
tet_status tet_complex_reserve(tet_complex *c, uint64_t n);

/* Replaces a thread's fresh slots, which become free ones, by the next of its pool, at least n;
 * 0: none left. */
int tet_complex_take_block(tet_complex *c, size_t n);

/* A thread's fresh slots become free ones. */
void tet_complex_give_up(tet_complex *c);

/* The first tetrahedron abde (positive) and its four ghosts. */
tet_status tet_complex_first(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e);

/* 1: vertex p is in conflict with t: inside its circumsphere under the symbolic
 * perturbation; for a ghost, beyond its hull face. */
int tet_complex_conflict(const tet_complex *c, uint32_t t, uint32_t p);

/* Walks from t (or where the last walk ended, TET_NONE) to a tetrahedron whose
 * closure holds vertex p, or a ghost that p sees. */
tet_status tet_complex_locate(tet_complex *c, uint32_t from, uint32_t p, uint32_t *ret_t);

/* The same by rounded signs, and only among tetrahedra of this thread: any
 * tetrahedron likely to be in conflict with p. Ends; cheap. */
uint32_t tet_complex_approach(tet_complex *c, uint32_t from, uint32_t p);

/* Inserts vertex p (not yet in the complex, equal to no vertex) by Bowyer-Watson.
 * `from`: a tetrahedron near it or TET_NONE. Then c->old, if asked for, tells
 * what was there. Expected cost for evenly spread points: that of about
 * 50 insphere tests and 27 new tetrahedra, and the walk. */
tet_status tet_complex_insert(tet_complex *c, uint32_t p, uint32_t from);

/* The same within what this thread owns and has room for: *ret_done = 0 and nothing
 * changed where that is not enough. Never allocates. */
tet_status tet_complex_insert_owned(tet_complex *c, uint32_t p, int *ret_done);

/* For a walled complex: grows the cavity of vertex p from c->cavity, whose tetrahedra the caller
 * has listed and flagged TET_FLAG_CAVITY, by all that are in conflict with p and reached without
 * crossing a wall, and lists the border, walls included. Flags of OWNER and above are the
 * caller's. Then either tet_complex_forget or, once flags are but those of the cavity and its
 * border, and every face of the border sees p, tet_complex_fill: the tetrahedron above border
 * face k gets slot c->cavity[k], and TET_NONE is beyond faces at p where the border is open.
 * On failure of the latter nothing is changed. */
tet_status tet_complex_grow(tet_complex *c, uint32_t p);
/* The same by and by: from *k = 0 on, to a cavity of about `most` tetrahedra, and *ret_more = 1 if there
 * is more. Then it may be gone on with, or forgotten. */
tet_status tet_complex_grow_to(tet_complex *c, uint32_t p, size_t most, size_t *k, int *ret_more);
void tet_complex_forget(tet_complex *c);
tet_status tet_complex_fill(tet_complex *c);

/* Counts the faces of a walled complex, walls aside, with the apex beyond inside the
 * circumsphere: those that are not locally Delaunay. */
tet_status tet_complex_count_broken(const tet_complex *c, uint64_t *ret_n);

/* The first slot from t on with a face, walls aside, whose apex beyond is not outside for certain, or c->n_slots. Of the
 * two sides of a face the one with the lower handle counts. */
uint32_t tet_complex_next_doubtful(const tet_complex *c, uint32_t t);

/* Removes vertex p: its star is filled with the Delaunay tetrahedra of its link, under
 * the same perturbation, so that the complex is that of the other vertices. Errors:
 * TET_E_DEGENERATE where the others span no volume (nothing is changed); limits. */
tet_status tet_complex_remove(tet_complex *c, uint32_t p);

/* A tetrahedron with edge ab, or TET_NONE. Cost: that of the smaller star. */
tet_status tet_complex_find_edge(tet_complex *c, uint32_t a, uint32_t b, uint32_t *ret_t);

/* The handle of face abd, of the tetrahedron on whose side (a,b,d) is outward, or
 * TET_NONE where the face does not exist. Cost: that of the smallest star. The second form starts
 * from a tetrahedron that has edge ab and turns round it. */
tet_status tet_complex_find_face(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t *ret_handle);
uint32_t tet_complex_face_at_edge(const tet_complex *c, uint32_t t, uint32_t a, uint32_t b, uint32_t d);

/* All tetrahedra around vertex a, ghosts too, into c->made; marks cleared. */
tet_status tet_complex_star(tet_complex *c, uint32_t a);

/* Makes room for `n` vertices: in `at` and for insertion, or for insertion alone. */
tet_status tet_complex_reserve_vertices(tet_complex *c, uint32_t n);
tet_status tet_complex_reserve_places(tet_complex *c, uint32_t n);

static inline int tet_is_ghost(const tet_complex *c, uint32_t t) { return c->v[4 * (size_t)t + 3] == TET_GHOST; }
static inline int tet_is_live(const tet_complex *c, uint32_t t) { return !(c->flag[t] & TET_FLAG_FREE); }

/* The flags of t, which may be another thread's: such a one has an owner's number that is not
 * mine, whatever else it is. Only the owner changes them. */
static inline uint8_t tet_flag(const tet_complex *c, uint32_t t) { return __atomic_load_n(&c->flag[t], __ATOMIC_RELAXED); }
static inline void tet_set_flag(tet_complex *c, uint32_t t, uint8_t flag) {
  __atomic_store_n(&c->flag[t], flag, __ATOMIC_RELAXED);
}

/* Joins two face handles. */
static inline void tet_link(tet_complex *c, uint32_t h, uint32_t g) {
  c->adj[h] = g;
  c->adj[g] = h;
}

/* The place of vertex a in t, or 4. */
static inline int tet_index_of(const tet_complex *c, uint32_t t, uint32_t a) {
  const uint32_t *v = c->v + 4 * (size_t)t;
  return v[0] == a ? 0 : v[1] == a ? 1 : v[2] == a ? 2 : v[3] == a ? 3 : 4;
}

#endif
