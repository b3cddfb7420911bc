// SPDX-License-Identifier: Apache-2.0
/* repair_work.h: what the two ways of repairing a rounded mesh work on together. */
#ifndef TET_BUILD_REPAIR_WORK_H
#define TET_BUILD_REPAIR_WORK_H

#include "build/surface.h"
#include "mesh/edge_map.h"

typedef struct repair {
  tet_ctx *ctx;
  tet_pieces *p;
  const tet_surface *surface;
  tet_points exact;        /* the Steiner points as they were: implicit */
  tet_points rounded;      /* all points as they are: explicit */
  int strict;              /* nothing that was coplanar before rounding is made */
  uint32_t **tri;          /* [n_tets][4] triangle of the surface at a face */
  size_t cap_tets, cap_adj, cap_region, cap_tri;
  tet_edge_map subsegs;
  uint32_t *patch_start;   /* [vertices + 1] into patches */
  uint32_t *patches;       /* the patches of each vertex */
  uint8_t *made;           /* [n_tets] 1: not as it was before rounding */
  size_t cap_made;
  uint32_t *stack;         /* tetrahedra to look at */
  size_t n_stack, cap_stack;
  uint32_t *star;          /* shift.c: the tetrahedra of a vertex */
  size_t n_star, cap_star;
  uint32_t *beside;        /* [Steiner points][2] shift.c: the vertices before and after it on its segment */
  double *reach;           /* [Steiner points] shift.c: the distance of its nearest neighbour on its facets */
  uint32_t *first;         /* [Steiner points] its newest entry, or TET_NONE */
  uint32_t (*entry)[2];    /* a tetrahedron that it had or has, and the entry before */
  size_t n_entries, cap_entries;
  uint32_t *mark;          /* [n_tets] refill.c: the last cavity a tetrahedron was in */
  size_t cap_mark;
  uint32_t cavity;         /* the number of the last one */
  uint64_t flips, refills, moves;
} repair;

static inline const double *repair_at(const repair *r, uint32_t v) { return r->p->points + 3 * (size_t)v; }

/* Flips and refills leave gaps among the tetrahedra. */
static inline int repair_is_dead(const repair *r, uint32_t t) { return r->p->tets[4 * (size_t)t] == TET_NONE; }

/* 1: abcd is positive as rounded, and neither are its vertices all on one patch nor three of
 * them on one line: those are coplanar, whatever rounding made of them. With r->strict, nor
 * are they coplanar by chance. */
int tet_repair_may_be_made(const repair *r, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

/* 1: t is positive as rounded. */
int tet_repair_is_positive(const repair *r, uint32_t t);

/* 1: face h is interior, no subface, and not locally Delaunay or beside a
 * tetrahedron that is not positive; t_positive: of the one that h is of. */
int tet_repair_is_bad_face(const repair *r, uint32_t h, int t_positive);

/* 1: t is not positive or has a bad face. */
int tet_repair_is_bad(const repair *r, uint32_t t);

/* A slot for one more tetrahedron, not live yet. */
tet_status tet_repair_new_slot(repair *r, uint32_t *ret_t);

/* Notes a new tetrahedron, or one with new vertices. */
tet_status tet_repair_made(repair *r, uint32_t t);

/* The same, for shift.c's own lists alone. */
tet_status tet_shift_note(repair *r, uint32_t t);

/* Tries to move Steiner point v along its segment, by as little as will do, so that
 * fewer of the faces of its tetrahedra are bad and none turns. *ret_done: 1 if it did. */
tet_status tet_shift(repair *r, uint32_t v, int *ret_done);

/* Tries to replace the bad tetrahedron t and what is round it by the constrained
 * Delaunay tetrahedralization of the place, as rounded (wrap.h). *ret_done: 1 if it
 * did; then nothing made is bad, nor any face on the border. */
tet_status tet_refill(repair *r, uint32_t t, int *ret_done);

/* The same at bad face h, with one of its edges that is inside a facet flipped there, which
 * fills the places on both sides of the facet anew. */
tet_status tet_refill_facet(repair *r, uint32_t h, int *ret_done);

#endif
