// SPDX-License-Identifier: Apache-2.0
/* state.h: what the steps of the CDT algorithm (thesis 5.2) work on together. */
#ifndef TET_BUILD_STATE_H
#define TET_BUILD_STATE_H

#include "build/build.h"
#include "build/surface.h"
#include "build/thin.h"
#include "base/vector.h"
#include "mesh/complex.h"

#include <math.h>

/* What a Steiner point is on: a segment or, a break point (5.5), a facet. */
typedef struct tet_carrier {
  uint8_t origin; /* tet_origin: SEGMENT or FACET */
  uint32_t number;
} tet_carrier;

typedef struct tet_steiner {
  tet_segment_point at; /* on a segment: of its ends */
  tet_carrier carrier;
} tet_steiner;

typedef struct tet_state {
  tet_ctx *ctx;
  const tet_pls *pls;
  tet_planes planes;   /* of the surface's patches */
  tet_points points;   /* owned; vertices from n_input on are Steiner points */
  size_t cap_x, cap_implicit, cap_carrier;
  uint32_t n_input;
  tet_carrier *carrier; /* [points.n - n_input] of each Steiner point */
  tet_complex complex;
  tet_surface surface;
  tet_counts counts;
  const tet_breaks *breaks; /* Steiner points wanted from the start */
  uint32_t attempt;         /* how often rounding failed: Steiner points go elsewhere then */
  int may_break;            /* break points may be added, where they are asked for */
  int coarse;               /* the axis along which doubles are much farther apart than along
                               the others, as parts of the box's sides; -1: there is none */
  double step;              /* how far */
} tet_state;

/* Begins with the points of `pls`, and no tetrahedra and no surface yet. *st is to be freed, also on
 * failure. */
tet_status tet_state_init(tet_state *st, tet_ctx *ctx, const tet_pls *pls);
void tet_state_free(tet_state *st);

/* Later attempts do without fine places: points so close that they have few such places are bent off
 * their line there. */
enum { TET_LAST_FINE = 3 };

/* Nearer to others than this part of the largest coordinate, a Steiner point would be noise. */
static const double TET_LEAST_GAP = 0x1p-36;

/* That, as a part of the way from a to b. */
static inline double tet_state_least(const tet_state *st, uint32_t a, uint32_t b) {
  const double *x = st->points.x;
  return TET_LEAST_GAP * st->points.max_abs / sqrt(tet_distance2(x + 3 * (size_t)a, x + 3 * (size_t)b));
}

/* Appends a Steiner point to the points alone. */
tet_status tet_state_add_steiner(tet_state *st, const tet_steiner *p, uint32_t *ret_v);

/* The place nearest to t on the way from a to b that is a double along the axis that is rounded
 * most, if it is nearer than `most`: a point there hardly leaves its facets when it is rounded. */
double tet_state_fine_place(const tet_state *st, uint32_t a, uint32_t b, double t, double most);

/* Splits subsegment e at t of its segment, in the complex and the surface; see tet_surface_split.
 * Errors: TET_E_ROUNDING where that is one of its ends as doubles go. */
tet_status tet_state_split(tet_state *st, uint32_t e, double t, uint32_t *ret_v);

/* Splits segments where thin.c asks for it, but not twice in one place: subsegments still are whole
 * segments. */
tet_status tet_split_breaks(tet_state *st);

/* LOCALDEGENERACYREMOVAL (5.5): with may_break, adds break points to the patches and their
 * subsegments, as implicit points, until no two of their triangles that share an inner edge have four
 * exactly cocircular vertices, or no place or no budget is left: that is symbolic perturbation's
 * then. Adds to counts.break_points and sets degeneracies_left. *ret_added: how many. Cost: an exact
 * test for each pair of triangles; about constant for each break point. */
tet_status tet_remove_degeneracies(tet_state *st, int may_break, size_t *ret_added);

/* One of 64 bits, by which most vertices are told apart from a few others. */
static inline uint64_t tet_vertex_bit(uint32_t v) { return UINT64_C(1) << (v * 0x9E3779B1u >> 26); }

/* *ret_face, the caller's: [triangles of the surface] a handle of the face of st->complex that each is, or
 * TET_NONE. Cost: that of a look at each tetrahedron or, where that is less, at the smallest star of each triangle. */
tet_status tet_match_triangles(tet_state *st, uint32_t **ret_face);

/* SEGMENTRECOVERY (5.3): afterwards every subsegment of st->surface is an edge of
 * the Delaunay tetrahedralization st->complex. */
tet_status tet_recover_segments(tet_state *st);

/* FACETRECOVERY (5.4): afterwards every triangle of st->surface is a face. On
 * return *ret_face_tri, the caller's, maps each face handle to its triangle or
 * TET_NONE. */
tet_status tet_recover_facets(tet_state *st, uint32_t **ret_face_tri);

/* TET_E_SEED where a hole's or region's seed lies on a triangle of the surface; to be asked
 * before segments are split, whose Steiner points are rounded in the end. */
tet_status tet_check_seeds(const tet_state *st);

/* The parts into which the surface cuts space: the part of each slot of the
 * complex, 0 the outside. Errors: TET_E_OPEN where the facets enclose nothing
 * (unless keep_hull, when the finite outside is a part like others). */
tet_status tet_find_parts(tet_state *st, const uint32_t *face_tri, int keep_hull,
                          uint32_t **ret_part, uint32_t *ret_n_parts);

/* Copies what is not outside into pieces: tetrahedra, region = part - 1, and
 * points, which change owner. *ret_tri, the caller's, has the triangle of the
 * surface at each face; face_tri may be NULL. */
tet_status tet_extract_tetrahedra(tet_state *st, const uint32_t *face_tri, const uint32_t *part,
                                  tet_pieces *pieces, uint32_t **ret_tri);

/* Adds Steiner points in the volume to the rounded `pieces`, so that interior faces lie nearer to the facets than
 * `least` only where the domain is as thin; stays a CDT. No point is farther from what it is for than `diagonal`.
 * *tri ([n_tets][4], may move) is kept. Fills squeezed_points. About constant for each tetrahedron, and for each
 * point its cavity. */
tet_status tet_part_squeezed(tet_state *st, tet_pieces *p, uint32_t **tri, double least, double diagonal);

/* Takes the holes out of `pieces` and `tri`, and makes the region table (A.1.2). */
tet_status tet_apply_seeds(tet_ctx *ctx, const tet_pls *pls, int keep_hull, uint32_t n_parts,
                           tet_pieces *pieces, uint32_t *tri);

/* Adds subfaces, subsegments, segments and facets, and drops unused Steiner points. */
tet_status tet_extract_constraints(tet_state *st, const uint32_t *tri, tet_pieces *pieces);

#endif
