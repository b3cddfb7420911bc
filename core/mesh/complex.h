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
 * Bowyer-Watson insertion and location here serve the Delaunay stage and segment
 * recovery; facet recovery cuts and fills through the lower functions.
 */
#ifndef TET_MESH_COMPLEX_H
#define TET_MESH_COMPLEX_H

#include "base/context.h"
#include "exact/points.h"
#include "mesh/pieces.h"

#define TET_GHOST (UINT32_MAX - 1)

enum {
  TET_FLAG_FREE = 1,   /* the slot is unused */
  TET_FLAG_CAVITY = 2, /* in the cavity that is being filled */
  TET_FLAG_MARK = 4,   /* for searches; clear when they end */
  TET_FLAG_BORDER = 16 /* << i: face i bounds the cavity */
};

typedef struct tet_complex {
  tet_ctx *ctx;
  const tet_points *points;
  uint32_t *v;         /* [slots][4] */
  uint32_t *adj;       /* [slots][4] handles */
  uint8_t *flag;       /* [slots] */
  uint32_t n_slots, n_live; /* live: finite and ghost */
  size_t cap_v, cap_adj, cap_flag;
  uint32_t *at;        /* [points] a tetrahedron with the vertex, or TET_NONE */
  size_t cap_at;
  uint32_t *free_slots;
  size_t n_free, cap_free;
  uint32_t last;       /* where the last walk ended */
  uint32_t random;     /* of the walk */
  uint32_t *cavity, *border, *made; /* the last insertion's: old tetrahedra, border
                                       handles (inside), new tetrahedra */
  size_t n_cavity, cap_cavity, n_border, cap_border, n_made, cap_made;
} tet_complex;

void tet_complex_init(tet_complex *c, tet_ctx *ctx, const tet_points *points);
void tet_complex_free(tet_complex *c);

/* A new slot; its entries are undefined. */
tet_status tet_complex_new(tet_complex *c, uint32_t *ret_t);
/* Frees the slot of t. Handles to it must be gone. */
void tet_complex_delete(tet_complex *c, uint32_t t);

/* The first tetrahedron abde (positive) and its four ghosts. */
tet_status tet_complex_first(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e);

/* 1: vertex p is in conflict with t: inside its circumsphere under the symbolic
 * perturbation; for a ghost, beyond its hull face. */
int tet_complex_conflict(const tet_complex *c, uint32_t t, uint32_t p);

/* Walks from t (or where the last walk ended, TET_NONE) to a tetrahedron whose
 * closure holds vertex p, or a ghost that p sees. */
tet_status tet_complex_locate(tet_complex *c, uint32_t from, uint32_t p, uint32_t *ret_t);

/* Inserts vertex p (not yet in the complex, equal to no vertex) by Bowyer-Watson.
 * `from`: a tetrahedron near it or TET_NONE. Then c->cavity, c->border and
 * c->made tell what changed. */
tet_status tet_complex_insert(tet_complex *c, uint32_t p, uint32_t from);

/* A tetrahedron with edge ab, or TET_NONE. */
tet_status tet_complex_find_edge(tet_complex *c, uint32_t a, uint32_t b, uint32_t *ret_t);

/* The handle of face abd, of the tetrahedron on whose side (a,b,d) is outward, or
 * TET_NONE where the face does not exist. The second form starts from a
 * tetrahedron that has edge ab. */
tet_status tet_complex_find_face(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t *ret_handle);
uint32_t tet_complex_face_at_edge(const tet_complex *c, uint32_t t, uint32_t a, uint32_t b, uint32_t d);

/* All tetrahedra around vertex a, ghosts too, into c->made; marks cleared. */
tet_status tet_complex_star(tet_complex *c, uint32_t a);

/* Makes room in `at` for `n` vertices. */
tet_status tet_complex_reserve_vertices(tet_complex *c, uint32_t n);

static inline int tet_is_ghost(const tet_complex *c, uint32_t t) { return c->v[4 * (size_t)t + 3] == TET_GHOST; }
static inline int tet_is_live(const tet_complex *c, uint32_t t) { return !(c->flag[t] & TET_FLAG_FREE); }

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
