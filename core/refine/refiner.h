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
#include "mesh/complex.h"
#include "refine/refine.h"

#include <string.h>

/* mesh.flag of the cavity's tetrahedra, beside the kernel's: the bits are those of its
 * threads, of which there is one here. */
enum {
  FLAG_NEEDED = TET_FLAG_OWNER,     /* at the element being split: may not be taken out */
  FLAG_REMOVED = 2 * TET_FLAG_OWNER /* taken out: may not come back */
};

/* tet_edges, beside the bits of the edges. */
enum {
  EDGES = 63,
  EDGE_LOOSE = 64, /* some edge is a subsegment of no facet */
  TET_QUEUED = 128 /* over a bound: waits to be split, or was and could not be */
};

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

/* How far the cavity of a point on the boundary is grown. */
typedef enum refine_extent {
  EXTENT_WHOLE, /* all in conflict */
  EXTENT_LEAST, /* no more than what the point splits */
  EXTENT_BEGUN, /* that, to be grown from there (refine_grow_or_hit_segs) */
  EXTENT_NEAR   /* all in conflict, and given up where that is more than NEAR, about */
} refine_extent;

/* What a segment has a sharp angle to. */
enum {
  SHARP_PLANE = 1,    /* another segment */
  SHARP_DIHEDRAL = 2, /* between two facets */
  SHARP_FACET = 4     /* a facet that it stands on */
};

/* What a first vertex is an end of. */
enum {
  END_ACUTE = 1, /* segments below 60 degrees to each other */
  END_SHARP = 2  /* a segment that is sharp to others, or between facets */
};

enum {
  MOST_TRIED = 8, /* subsegments or subfaces for one candidate, about */
  NEAREST = 16,   /* tetrahedra of a cavity, from its start on, */
  NEAR = 128      /* and more of them, and subfaces */
};

typedef struct refine_patch {
  uint32_t facet;
  int axis;          /* dropped coordinate; the patch's subfaces are positive in it */
  double origin[3];  /* of its plane */
  double normal[3];  /* unit */
  double along[3], across[3]; /* in the plane: the longest side of its largest triangle, and the height on that */
} refine_patch;

/* Keys are powers of two and 1 << FINE equal parts of each; QUARTER of these are a quarter. */
enum { CHUNK = 30, FINE = 5, QUARTER = 1 << (FINE - 2), KEYS = 1 << (11 + FINE), BUCKETS = 3 * KEYS };

/* Some of a bucket's tetrahedra: their slots, and some bits. */
typedef struct refine_chunk {
  uint32_t next, n, entry[CHUNK];
} refine_chunk;

/* Tetrahedra over a bound by buckets of about equal keys, least first; in a bucket the last
 * comes first. */
typedef struct refine_buckets {
  uint32_t *head;       /* [BUCKETS] first chunk, of those that have any */
  uint64_t *used;       /* [BUCKETS / 64] bits of the buckets that have any */
  uint32_t low;         /* no word of `used` below it has a bit */
  refine_chunk *chunk;
  uint32_t n_chunks, free_chunk;
  size_t cap_chunk;
} refine_buckets;

typedef struct refine_waiting {
  uint32_t item, v[3];
} refine_waiting;

typedef struct refine_list {
  uint32_t *at;
  uint32_t n;
  size_t cap;
} refine_list;

/* What a candidate's cavity is grown for. */
typedef enum refine_wanted {
  WANT_CAVITY, /* to be filled: that something is hit is all there is to know of hits */
  WANT_HITS,   /* to split one of these, the best of those near */
  WANT_EITHER  /* to be filled, or to split the best of those near */
} refine_wanted;

/* What a new tetrahedron has from the one that its border face bounded. */
typedef struct refine_carry {
  uint32_t sub, region;
  uint8_t edges;
} refine_carry;

/* A subface at a vertex made anew, which stays, as the edge opposite. */
typedef struct refine_spoke {
  uint32_t a, b, sub, inner, outer;
} refine_spoke;

/* Four tetrahedra between the new point and the border, lane by lane as refine_shape, in doubles. */
typedef struct refine_shapes {
  double to_centre[3][4], volume6[4], shortest2[4];
  double length2[6][4], room[4]; /* squared, of edges as refine_edge has them, and more than sums of these are off by */
  uint8_t is_sure;     /* bit i: lane i is to be taken for true; else it has to be measured again */
  uint8_t is_over;     /* bit i: lane i is over the radius-edge bound */
  uint8_t is_positive; /* bit i: lane i is positive for certain; else that is not known */
} refine_shapes;

/* What a candidate p would retriangulate, and how, beside mesh.cavity and mesh.border. */
typedef struct refine_cavity {
  uint32_t p;            /* vertex, the last one */
  uint32_t segment;      /* subsegment being split, or TET_NONE */
  uint32_t sub;          /* subface being split, or TET_NONE */
  int restar;            /* 1: p is a vertex already, its tetrahedra part of the cavity */
  int reshaped;          /* 1: not all of, or more than, the conflict region */
  int is_part;           /* 1: the search for the conflict region was given up */
  uint32_t n_made;       /* after the fill: mesh.cavity has so many new tetrahedra */
  int is_listed;         /* 1: `vertices` are those of the border as it is */
  int loses_vertex;      /* 1: not all vertices of the cavity are on the border */
  refine_list removed;   /* tetrahedra taken out */
  refine_list subs;      /* subfaces replaced */
  refine_list rim;       /* edge handles of `subs` that stay */
  refine_list rim_new;   /* the subface that each rim edge spans with p */
  refine_list vertices;  /* of the border */
  refine_carry *carry;   /* [border] */
  refine_spoke *spoke;
  uint32_t n_spokes;
  refine_shapes *shapes; /* [border / 4] of the border as last trimmed */
  size_t cap_carry, cap_spoke, cap_shapes;
} refine_cavity;

typedef struct refiner {
  tet_ctx *ctx;
  tet_refine_options o;
  tet_pieces *out;
  tet_points points; /* a view of out->points */
  size_t cap_x, cap_origin, cap_carrier, cap_size, cap_sharp_size, cap_stamp, cap_vertices;
  uint32_t n_first;  /* vertices of the CDT */
  double *size;       /* [vertex] H_1 (4.5) */
  double *sharp_size; /* [vertex] the same, 0 at vertices on no sharp dihedral angle */
  uint32_t *stamp;    /* [vertex] scratch */
  uint32_t stamp_now;

  tet_complex mesh;  /* walled; TET_NONE beyond the domain; walls are subfaces */
  uint32_t *tet_sub; /* [slots][4] subface at a face that is a wall */
  uint32_t *tet_region;
  uint8_t *tet_edges; /* bit e: edge e (of refine_edge_of) is a subsegment; and more */
  size_t cap_tet_sub, cap_tet_region, cap_tet_edges;

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

  uint8_t *segment_sharp;        /* [segment] SHARP_PLANE and others, or 0 */
  double *segment_sine;          /* [segment] of its least sharp angle; 1: none is */
  uint8_t *facet_thin;           /* [facet] 1: at a dihedral angle of so small a sine as `thin` */
  uint64_t thin_points;          /* that may still be inserted there */
  uint64_t searched, in_vain;    /* tetrahedra of all cavities; of those searched for what was not split */
  uint32_t n_sharp;              /* sharp segments; of these: */
  uint32_t n_crowds, n_wedges;   /* sharp to others or between facets; between facets */
  uint8_t *segment_end;          /* [first vertices] bits: END_ACUTE, END_SHARP */
  double *low;                   /* [first vertices] 0: no segment stands low there; else the least length that the
                                    subsegments there have had of segments that do somewhere */
  uint32_t *vertex_facet_start, *vertex_facet;   /* [first vertices] facets at each */
  uint32_t *segment_facet_start, *segment_facet; /* [segment] facets at each */
  uint32_t *facet_vertex_start, *facet_vertex;   /* [facet] first vertices on each */
  uint32_t *facet_plane; /* [facet] the same number for facets side by side in one plane */

  refine_cavity cavity;
  refine_list hit_segs, hit_subs; /* encroached by a candidate */
  refine_list star;               /* scratch */
  refine_list suspects;           /* face handles after a reshaped cavity */
  refine_list stuck;              /* those that no flip repaired */

  refine_waiting *seg_queue, *sub_queue;
  uint32_t n_seg_queue, at_seg_queue, n_sub_queue, at_sub_queue;
  size_t cap_seg_queue, cap_sub_queue;
  int watch_tets;      /* 1: R3 has begun */
  int watch_slivers;   /* 1: slivers are removed */
  int exact;           /* 1: facets are flat and segments straight to the last bit, every cavity was its conflict region */
  int strict;          /* 1: no cavity is filled that leaves a face that is not locally Delaunay */
  int some_left;       /* 1: something over a bound could not be split */
  int forcing;         /* 1: a face cannot be Delaunay: no ball protects, no gap is too narrow */
  int picking;         /* 1: a sliver is being split: points go near where others would */
  int tracing;         /* 1: nothing is inserted; who rejects is noted */
  uint32_t blamed;     /* sharp subsegment at such a vertex, or TET_NONE */
  uint32_t *sharp_at;  /* [vertex] a sharp subsegment, or TET_NONE */
  double sliver_sine2; /* squared sine of the bound */
  uint64_t last_point; /* vertices at which slivers are given up */
  refine_buckets bad;
  uint8_t *stays;     /* [n_stays] while the rest is mended: 1: not removed, and nothing beside it has changed since */
  uint32_t n_stays;
  uint32_t *some_tet; /* [vertex] that has it, while points are removed; else NULL */
  double *max_volume; /* [region] */
  uint32_t *round_start; /* [KEYS] with TET_INSERT_RELATIVELY_SHORT: vertices there were when each round began */
  uint32_t n_rounds;

  tet_refine_result result;
} refiner;

/* Vertices of face i, outward; and of edge e; the edge between corners i and j. */
extern const uint8_t refine_edge[6][2];
extern const uint8_t refine_edge_of[4][4];

static inline const double *refine_x(const refiner *r, uint32_t v) { return r->points.x + 3 * (size_t)v; }
/* Where the corners of v are. */
static inline void refine_places(const refiner *r, const uint32_t v[4], const double *ret[4]) {
  for (int i = 0; i < 4; i++) ret[i] = refine_x(r, v[i]);
}
static inline int refine_alive(const refiner *r, uint32_t t) { return tet_is_live(&r->mesh, t); }
/* The subface at face h, or TET_NONE. */
static inline uint32_t refine_sub_at(const refiner *r, size_t h) {
  return r->mesh.wall[h >> 2] >> (h & 3) & 1 ? r->tet_sub[h] : TET_NONE;
}
static inline uint32_t refine_corner(const refiner *r, uint32_t t, uint32_t vertex) {
  return (uint32_t)tet_index_of(&r->mesh, t, vertex);
}
/* 1 if t still is the tetrahedron v: slots are used again. */
static inline int refine_is_tet(const refiner *r, uint32_t t, const uint32_t v[4]) {
  return refine_alive(r, t) && memcmp(v, r->mesh.v + 4 * (size_t)t, 4 * sizeof *v) == 0;
}

/* 1: there may be what is over a bound or a sliver, and was never queued, as nobody looked for such. */
static inline int refine_has_unwatched(const refiner *r) {
  return !r->watch_tets || (r->o.min_dihedral > 0 && !r->watch_slivers);
}
/* 0 if t is over no bound, and no sliver, as otherwise it would have been queued, or be unwatched. */
static inline int refine_may_be_bad(const refiner *r, uint32_t t, int unwatched) {
  return refine_alive(r, t) && (unwatched || r->tet_edges[t] & TET_QUEUED);
}

/* store.c: memory, and to and from the pieces. */
tet_status refine_push(refiner *r, refine_list *list, uint32_t value);
tet_status refine_reserve_tets(refiner *r, size_t n);
tet_status refine_reserve_vertices(refiner *r, size_t n);
tet_status refine_new_tet(refiner *r, uint32_t *ret_tet);
tet_status refine_new_sub(refiner *r, uint32_t *ret_sub);
void refine_free_sub(refiner *r, uint32_t s);
tet_status refine_new_seg(refiner *r, uint32_t *ret_seg);
tet_status refine_add_point(refiner *r, const double x[3], tet_origin origin, uint32_t carrier);
void refine_drop_point(refiner *r);
tet_status refine_unload(refiner *r);
tet_status refine_copy(refiner *r, tet_pieces *ret);
void refine_restore(refiner *r, tet_pieces *copy);
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
void refine_note_low(refiner *r, uint32_t e);

/* sizing.c */
tet_status refine_lfs(refiner *r);
void refine_shepard(const refiner *r, uint32_t p, const refine_list *neighbours, double *ret_size,
                    double *ret_sharp);
int refine_needs_sizes(const refiner *r);
int refine_accepts(refiner *r, uint32_t p, const uint32_t *vertices, uint32_t n, double alpha, refine_cause cause);
int refine_is_thin(const refiner *r, uint32_t p);
int refine_crowded(refiner *r, const uint32_t *vertices, uint32_t n);

/* flatness.c: three points of a segment, four of a facet, by incidence. */
int refine_on_segment(const refiner *r, uint32_t v, uint32_t segment);
int refine_segments_meet(const refiner *r, uint32_t s, uint32_t t);
int refine_facets_meet(const refiner *r, uint32_t f, uint32_t g);
int refine_on_facet(const refiner *r, uint32_t v, uint32_t facet);
int refine_all_on_facet(const refiner *r, const uint32_t v[4], uint32_t facet);
tet_status refine_find_planes(refiner *r);
int refine_is_flat(const refiner *r, const uint32_t v[4]);
int refine_is_positive(const refiner *r, const uint32_t v[4]);
int refine_facets_are_flat(const refiner *r);
int refine_cavity_is_exact(const refiner *r);

/* cavity.c, facet_cavity.c, sound.c, fill.c */
tet_status refine_cavity_of_tet(refiner *r, uint32_t p, uint32_t tet);
tet_status refine_cavity_of_star(refiner *r, uint32_t p, uint32_t tet, int *ret_ok);
tet_status refine_cavity_of_sub(refiner *r, uint32_t p, uint32_t sub, refine_extent extent);
tet_status refine_cavity_of_seg(refiner *r, uint32_t p, uint32_t seg, refine_extent extent);
tet_status refine_cavity_vertices(refiner *r);
tet_status refine_cavity_trim(refiner *r, int *ret_ok);
int refine_is_spoke(const refiner *r, uint32_t h);
int refine_is_border(const refiner *r, uint32_t h);
void refine_cavity_clear(refiner *r);
tet_status refine_facet_cavity_grow(refiner *r, refine_extent extent);
int refine_facet_cavity_trim(refiner *r);
void refine_facet_cavity_least(refiner *r);
tet_status refine_facet_cavity_rim(refiner *r);
tet_status refine_cavity_is_sound(refiner *r, int *ret_ok);
int refine_cavity_is_delaunay(const refiner *r);
tet_status refine_fill(refiner *r);
void refine_hang(refiner *r, uint32_t sub, uint32_t h);
void refine_take_sub(refiner *r, uint32_t s, uint32_t was, uint32_t h);
void refine_on_segment_edge(refiner *r, uint32_t h, uint32_t e);
void refine_link(refiner *r, uint32_t g, uint32_t h);
void refine_replace_edge(refiner *r, uint32_t h, uint32_t by);

/* encroach.c */
int refine_seg_hit_by(const refiner *r, uint32_t e, uint32_t vertex);
int refine_sub_hit_by(const refiner *r, uint32_t s, uint32_t vertex);
uint32_t refine_hit_seg(const refiner *r, uint32_t t, int e);
tet_status refine_seg_encroached(refiner *r, uint32_t e, uint32_t *ret_by);
int refine_sub_encroached(const refiner *r, uint32_t s);
tet_status refine_collect_segs(refiner *r);
tet_status refine_grow_or_hit_segs(refiner *r);
int refine_gives_up(const refiner *r, refine_cause cause);
int refine_is_spent(const refiner *r);
tet_status refine_grow_or_hit(refiner *r, uint32_t p, uint32_t tet, refine_wanted wanted);
tet_status refine_look_at(refiner *r, uint32_t n);
tet_status refine_look_at_made(refiner *r);

/* pick.c */
double refine_chance(const refiner *r, uint32_t k);
void refine_pick(const refiner *r, double shortest2, double x[3]);

/* quality.c */
#define REFINE_SLACK (1 + 1e-10) /* room for rounding between us and whoever measures again */
typedef struct refine_shape {
  double to_centre[3]; /* from the first vertex to the circumcentre, times 2 volume6 */
  double volume6;      /* six times the volume */
  double shortest2;    /* squared length of the shortest edge */
} refine_shape;
void refine_measure(const refiner *r, uint32_t t, refine_shape *ret);
void refine_measure_corners(const refiner *r, const uint32_t v[4], refine_shape *ret);
int refine_measure_roughly(const refiner *r, const uint32_t v[4], refine_shape *ret);
double refine_radius_edge(const refine_shape *s);
double refine_sharpest(const refiner *r, const uint32_t v[4]);
int refine_is_narrow(const refiner *r, uint32_t s, double most);
int refine_is_sliver(const refiner *r, const uint32_t v[4]);
int refine_over_ratio(const refiner *r, const refine_shape *s);
int refine_over_volume(const refiner *r, uint32_t region, double volume6);
tet_status refine_set_bounds(refiner *r);

/* shapes.c */
tet_status refine_measure_border(refiner *r);

/* centre.c */
void refine_circumcentre(const refiner *r, uint32_t t, const refine_shape *s, double ret[3]);

/* queue.c */
tet_status refine_queue_seg(refiner *r, uint32_t e);
tet_status refine_queue_sub(refiner *r, uint32_t s);
int refine_next_seg(refiner *r, uint32_t *ret_seg);
int refine_next_sub(refiner *r, uint32_t *ret_sub);
tet_status refine_queue_tet(refiner *r, uint32_t t);
tet_status refine_queue_made(refiner *r);
int refine_next_tet(refiner *r, uint32_t *ret_tet, refine_shape *ret_shape, int *ret_sliver);
tet_status refine_open_queue(refiner *r);

/* cut.c */
double refine_off_tie(const refiner *r, double most);
double refine_cut(const refiner *r, uint32_t e, uint32_t by, double length);

/* split_segment.c, split_facet.c, split_tet.c: R1, R2, R3. */
tet_status refine_insert(refiner *r, int *ret_ok);
void refine_spend(refiner *r);
tet_status refine_split_seg(refiner *r, uint32_t e, uint32_t by, refine_cause cause, refine_outcome *ret);
tet_status refine_split_hit_segs(refiner *r, refine_cause cause, refine_outcome *ret);
tet_status refine_split_sub(refiner *r, uint32_t s, refine_cause cause, refine_outcome *ret);
int refine_shortest_edge(const refiner *r, uint32_t t);
tet_status refine_split_tet(refiner *r, uint32_t t, const refine_shape *shape, int is_sliver, refine_outcome *ret);

/* repair.c */
tet_status refine_repair(refiner *r);
tet_status refine_unbend(refiner *r);
tet_status refine_repair_stuck(refiner *r);
tet_status refine_repair_all(refiner *r);
tet_status refine_repair_by_force(refiner *r, uint64_t *ret_done);

/* mend.c, remove.c: when no rule applies any more. */
typedef struct refine_faults {
  uint32_t over, slivers;
  double worst2; /* squared, of the radius-edge ratios over the bound; infinite for what is flat */
} refine_faults;
void refine_count_faults(const refiner *r, const uint32_t v[4], uint32_t region, refine_faults *sum);
tet_status refine_mend(refiner *r);
void refine_note_change(refiner *r, uint32_t t);
tet_status refine_remove(refiner *r, uint32_t p, uint32_t tet, int *ret_done);
tet_status refine_remove_points(refiner *r);

/* trace.c */
void refine_note_blame(refiner *r, uint32_t v);
tet_status refine_trace(refiner *r, uint32_t n, const uint32_t *tet, int is_sliver, uint32_t *segment);

/* exceptions.c */
tet_status refine_list_exceptions(refiner *r);
tet_status refine_check_delaunay(refiner *r);
tet_status refine_check_gabriel(refiner *r);

#endif
