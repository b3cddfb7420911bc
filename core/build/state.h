// SPDX-License-Identifier: Apache-2.0
/* state.h: what the steps of the CDT algorithm (thesis 5.2) work on together. */
#ifndef TET_BUILD_STATE_H
#define TET_BUILD_STATE_H

#include "build/build.h"
#include "build/surface.h"
#include "build/thin.h"
#include "mesh/complex.h"

typedef struct tet_state {
  tet_ctx *ctx;
  const tet_pls *pls;
  tet_planes planes;   /* of the surface's patches */
  tet_points points;   /* owned; vertices from n_input on are Steiner points */
  size_t cap_x, cap_implicit, cap_segment;
  uint32_t n_input;
  uint32_t *steiner_segment; /* [points.n - n_input] the segment a Steiner point splits */
  tet_complex complex;
  tet_surface surface;
  tet_counts counts;
  const tet_breaks *breaks; /* Steiner points wanted from the start */
  uint32_t attempt;         /* how often rounding failed: Steiner points go elsewhere then */
  int coarse;               /* the axis along which doubles are much farther apart than along
                               the others, as parts of the box's sides; -1: there is none */
  double step;              /* how far */
} tet_state;

/* Appends the Steiner point a + t (b - a) of segment s. */
tet_status tet_state_add_steiner(tet_state *st, uint32_t s, double t, uint32_t *ret_v);

/* SEGMENTRECOVERY (5.3): afterwards every subsegment of st->surface is an edge of
 * the Delaunay tetrahedralization st->complex. st->breaks are split first. */
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

/* Takes the holes out of `pieces` and `tri`, and makes the region table (A.1.2). */
tet_status tet_apply_seeds(tet_ctx *ctx, const tet_pls *pls, int keep_hull, uint32_t n_parts,
                           tet_pieces *pieces, uint32_t *tri);

/* Adds subfaces, subsegments, segments and facets, and drops unused Steiner points. */
tet_status tet_extract_constraints(tet_state *st, const uint32_t *tri, tet_pieces *pieces);

#endif
