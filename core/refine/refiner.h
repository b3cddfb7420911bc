// SPDX-License-Identifier: Apache-2.0
/* refiner.h: the mesh under refinement and what the files here share.
 *
 * Tetrahedra, subfaces and subsegments as structures of arrays of 32-bit
 * numbers. A face handle is 4t+i (see mesh/pieces.h), a subface edge handle 3s+j:
 * the directed edge from sub_v[3s+j] to sub_v[3s+(j+1)%3].
 *
 * Subfaces that share an edge form a ring: ring[3s+j] is the next edge handle on
 * the same edge, in no order, cyclic. Off the subsegments a ring has two members,
 * both of one patch; at a subsegment it has all, so that every fan of tetrahedra
 * around it, however many there are, begins and ends at a member.
 *
 * A patch is a maximal set of subfaces of one facet joined by edges that are no
 * subsegments: planar, but for the last bits of its Steiner points. What lies in
 * one patch or on one segment is therefore decided by incidence, not by signs.
 */
#ifndef TET_REFINE_REFINER_H
#define TET_REFINE_REFINER_H

#include "exact/points.h"
#include "exact/predicates.h"
#include "refine/refine.h"

/* tet_mark: bits 0 to 3 the cavity's boundary faces, and: */
enum {
  MARK_IN = 16,      /* in the cavity */
  MARK_OUT = 32,     /* tested: not in conflict, or taken out again */
  MARK_NEEDED = 64,  /* at the element being split: may not be taken out */
  MARK_REMOVED = 128 /* taken out: may not come back */
};

enum { EDGE_LOOSE = 64 }; /* tet_edges: some edge is a subsegment of no facet */

/* What a candidate is split for (R1*, 3.4.1). */
typedef enum refine_cause {
  CAUSE_VERTEX, /* an existing vertex encroaches */
  CAUSE_CENTRE  /* the rejected circumcentre of a tetrahedron does */
} refine_cause;

typedef enum refine_outcome {
  OUTCOME_NONE = 0,  /* nothing to do any more */
  OUTCOME_INSERTED,
  OUTCOME_REJECTED
} refine_outcome;

typedef struct refine_patch {
  uint32_t facet;
  int axis;          /* dropped coordinate; the patch's subfaces are positive in it */
  double origin[3];  /* of its plane */
  double normal[3];  /* unit */
} refine_patch;

/* A tetrahedron over a bound, by its vertices: slots are reused. */
typedef struct refine_bad {
  double key; /* least first */
  uint32_t rank, tet, v[4];
} refine_bad;

typedef struct refine_waiting {
  uint32_t item, v[3];
} refine_waiting;

typedef struct refine_list {
  uint32_t *at;
  uint32_t n;
  size_t cap;
} refine_list;

/* The region that a candidate p would retriangulate, and how. */
typedef struct refine_cavity {
  uint32_t p;            /* vertex, the last one */
  uint32_t segment;      /* subsegment being split, or TET_NONE */
  uint32_t sub;          /* subface being split, or TET_NONE */
  int restar;            /* 1: p is a vertex already, its tetrahedra part of the cavity */
  int reshaped;          /* 1: not all of, or more than, the conflict region */
  refine_list tets;      /* in the cavity */
  refine_list touched;   /* marked otherwise */
  refine_list subs;      /* subfaces replaced */
  refine_list rim;       /* edge handles of `subs` that stay */
  refine_list rim_new;   /* the subface that each rim edge spans with p */
  refine_list faces;     /* boundary face handles */
  refine_list faces_new; /* the tetrahedron that each spans with p */
  refine_list vertices;  /* of the boundary */
} refine_cavity;

typedef struct refiner {
  tet_ctx *ctx;
  tet_refine_options o;
  tet_pieces *out;
  tet_points points; /* a view of out->points */
  size_t cap_x, cap_origin, cap_carrier, cap_size, cap_sharp_size, cap_stamp;
  uint32_t n_first;  /* vertices of the CDT */
  double *size;       /* [vertex] H_1 (4.5) */
  double *sharp_size; /* [vertex] the same, 0 at vertices on no sharp dihedral angle */
  uint32_t *stamp;    /* [vertex] scratch */
  uint32_t stamp_now;

  uint32_t n_tets, n_free_tets, free_tet;
  uint32_t *tet_v, *tet_adj, *tet_sub; /* [t][4]; tet_sub: subface at the face, or TET_NONE */
  uint32_t *tet_region;
  uint8_t *tet_edges; /* bit e: edge e (of refine_edge_of) is a subsegment */
  uint8_t *tet_mark;
  size_t cap_tet_v, cap_tet_adj, cap_tet_sub, cap_tet_region, cap_tet_edges, cap_tet_mark;

  uint32_t n_subs, free_sub;
  uint32_t *sub_v;     /* [s][3]; sub_v[3s] == TET_NONE: free, next in sub_v[3s+1] */
  uint32_t *sub_side;  /* [s][2] face handles, or TET_NONE */
  uint32_t *sub_seg;   /* [s][3] subsegment at the edge, or TET_NONE */
  uint32_t *ring;      /* [s][3] */
  uint32_t *sub_patch; /* [s] */
  uint8_t *sub_mark;   /* 1: to be replaced; 2: in it from the start; 4: waiting in the queue */
  size_t cap_sub_v, cap_sub_side, cap_sub_seg, cap_ring, cap_sub_patch, cap_sub_mark;
  uint32_t n_patches;
  refine_patch *patch;
  size_t cap_patch;

  uint32_t n_segs;
  uint32_t *seg_v;      /* [e][2] */
  uint32_t *seg_of;     /* [e] segment */
  uint32_t *seg_sub;    /* [e] an edge handle on it, or TET_NONE: loose */
  uint32_t *seg_tet;    /* [e] of a loose one: a tetrahedron at it */
  uint8_t *seg_waiting; /* in the queue */
  size_t cap_seg_v, cap_seg_of, cap_seg_sub, cap_seg_tet, cap_seg_waiting;
  uint32_t *seg_table;  /* open addressing by end points; stale entries fail the comparison */
  uint32_t seg_table_mask, seg_table_used;

  uint8_t *segment_sharp;        /* [segment] bit 0: plane angle, bit 1: dihedral angle */
  uint32_t n_sharp;
  uint8_t *acute_end;            /* [first vertices] 1: end of segments below 60 degrees */
  uint32_t *vertex_facet_start, *vertex_facet;   /* [first vertices] facets at each */
  uint32_t *segment_facet_start, *segment_facet; /* [segment] facets at each */

  refine_cavity cavity;
  refine_list hit_segs, hit_subs; /* encroached by a candidate */
  refine_list star;               /* scratch */
  refine_list suspects;           /* face handles after a reshaped cavity */

  refine_waiting *seg_queue, *sub_queue;
  uint32_t n_seg_queue, at_seg_queue, n_sub_queue, at_sub_queue;
  size_t cap_seg_queue, cap_sub_queue;
  int watch_tets; /* 1: R3 has begun */
  refine_bad *heap;
  uint32_t n_heap;
  size_t cap_heap;

  tet_refine_result result;
} refiner;

/* Vertices of face i, outward; and of edge e; the edge between corners i and j. */
extern const uint8_t refine_edge[6][2];
extern const uint8_t refine_edge_of[4][4];

static inline const double *refine_x(const refiner *r, uint32_t v) { return r->points.x + 3 * (size_t)v; }
static inline int refine_alive(const refiner *r, uint32_t t) { return r->tet_v[4 * (size_t)t] != TET_NONE; }
static inline uint32_t refine_corner(const refiner *r, uint32_t t, uint32_t vertex) {
  const uint32_t *v = r->tet_v + 4 * (size_t)t;
  return v[0] == vertex ? 0 : v[1] == vertex ? 1 : v[2] == vertex ? 2 : v[3] == vertex ? 3 : 4;
}

/* store.c: memory, and to and from the pieces. */
tet_status refine_push(refiner *r, refine_list *list, uint32_t value);
tet_status refine_new_tet(refiner *r, uint32_t *ret_tet);
void refine_free_tet(refiner *r, uint32_t t);
tet_status refine_new_sub(refiner *r, uint32_t *ret_sub);
void refine_free_sub(refiner *r, uint32_t s);
tet_status refine_new_seg(refiner *r, uint32_t *ret_seg);
tet_status refine_add_point(refiner *r, const double x[3], tet_origin origin, uint32_t carrier);
void refine_drop_point(refiner *r);
tet_status refine_unload(refiner *r);
void refine_release(refiner *r);

/* load.c */
tet_status refine_load(refiner *r);

/* segments.c: subsegments by their end points, and the tetrahedra around them. */
uint32_t refine_find_seg(const refiner *r, uint32_t a, uint32_t b);
tet_status refine_build_seg_table(refiner *r);
tet_status refine_enter_seg(refiner *r, uint32_t e);
tet_status refine_seg_star(refiner *r, uint32_t e, refine_list *list);

/* sharp.c */
tet_status refine_find_sharp(refiner *r);

/* sizing.c */
tet_status refine_lfs(refiner *r);
void refine_shepard(const refiner *r, uint32_t p, const refine_list *neighbours, double *ret_size,
                    double *ret_sharp);
int refine_accepts(const refiner *r, uint32_t p, const uint32_t *vertices, uint32_t n, double alpha, refine_cause cause);
int refine_crowded(const refiner *r, const uint32_t *vertices, uint32_t n);

/* flatness.c: three points of a segment, four of a facet, by incidence. */
int refine_on_segment(const refiner *r, uint32_t v, uint32_t segment);
int refine_on_facet(const refiner *r, uint32_t v, uint32_t facet);
int refine_is_flat(const refiner *r, const uint32_t v[4]);
int refine_is_positive(const refiner *r, const uint32_t v[4]);

/* cavity.c, facet_cavity.c, fill.c */
tet_status refine_cavity_of_tet(refiner *r, uint32_t p, uint32_t tet);
tet_status refine_cavity_of_star(refiner *r, uint32_t p, uint32_t tet);
tet_status refine_cavity_of_sub(refiner *r, uint32_t p, uint32_t sub, int least);
tet_status refine_cavity_of_seg(refiner *r, uint32_t p, uint32_t seg, int least);
tet_status refine_cavity_trim(refiner *r, int *ret_ok);
int refine_is_wall(const refiner *r, uint32_t h);
void refine_cavity_clear(refiner *r);
tet_status refine_facet_cavity_grow(refiner *r);
int refine_facet_cavity_trim(refiner *r);
void refine_facet_cavity_least(refiner *r);
tet_status refine_facet_cavity_rim(refiner *r);
tet_status refine_cavity_is_sound(refiner *r, int *ret_ok);
tet_status refine_fill(refiner *r);
void refine_hang(refiner *r, uint32_t sub, uint32_t h);
void refine_link(refiner *r, uint32_t g, uint32_t h);
void refine_replace_edge(refiner *r, uint32_t h, uint32_t by);

/* encroach.c */
int refine_seg_hit_by(const refiner *r, uint32_t e, uint32_t vertex);
int refine_sub_hit_by(const refiner *r, uint32_t s, uint32_t vertex);
tet_status refine_seg_encroached(refiner *r, uint32_t e, uint32_t *ret_by);
int refine_sub_encroached(const refiner *r, uint32_t s);
tet_status refine_collect_hits(refiner *r, int subfaces);
tet_status refine_look_at(refiner *r, uint32_t n);

/* queue.c */
tet_status refine_queue_seg(refiner *r, uint32_t e);
tet_status refine_queue_sub(refiner *r, uint32_t s);
int refine_next_seg(refiner *r, uint32_t *ret_seg);
int refine_next_sub(refiner *r, uint32_t *ret_sub);
tet_status refine_queue_tet(refiner *r, uint32_t t);
int refine_next_tet(refiner *r, uint32_t *ret_tet);

/* quality.c */
typedef struct refine_shape {
  double centre[3]; /* circumcentre */
  double radius2, shortest2, volume;
  uint32_t short_a, short_b; /* ends of the shortest edge */
} refine_shape;
void refine_measure(const refiner *r, uint32_t t, refine_shape *ret);
int refine_over_ratio(const refiner *r, const refine_shape *s);
int refine_over_volume(const refiner *r, uint32_t t, const refine_shape *s);

/* split_segment.c, split_facet.c, split_tet.c: R1, R2, R3. */
tet_status refine_insert(refiner *r, int *ret_ok);
tet_status refine_split_seg(refiner *r, uint32_t e, uint32_t by, refine_cause cause, refine_outcome *ret);
tet_status refine_split_sub(refiner *r, uint32_t s, refine_cause cause, refine_outcome *ret);
tet_status refine_split_tet(refiner *r, uint32_t t, refine_outcome *ret);

/* repair.c */
tet_status refine_repair(refiner *r);
tet_status refine_repair_all(refiner *r);

/* exceptions.c */
tet_status refine_list_exceptions(refiner *r);
tet_status refine_check(refiner *r);

#endif
