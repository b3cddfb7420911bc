// SPDX-License-Identifier: Apache-2.0
/* refine.h: Delaunay refinement of a constrained Delaunay tetrahedralization.
 *
 * Thesis chapter 3 (rules R1, R2, R3) under chapter 4's point accepting rule.
 * Takes the CDT of a domain and makes of it a mesh of bounded radius-edge ratio
 * that is still an exact CDT, boundary conforming Delaunay where no input
 * dihedral angle is sharp. */
#ifndef TET_REFINE_REFINE_H
#define TET_REFINE_REFINE_H

#include "base/context.h"
#include "mesh/pieces.h"

#include <tet/engine.h>

enum { TET_REFINE_MOST_DIHEDRAL = 30 }; /* degrees */

/* 1 if refinement to this bound ends by itself away from sharp segments (3.3.1): 1.414 counts as sqrt(2). */
static inline int tet_refine_is_proven(double radius_edge) { return radius_edge >= 1.414; }

typedef struct tet_refine_options {
  double radius_edge; /* bound rho_0, >= 1 */
  double max_volume;  /* of every tetrahedron; 0: none. Regions: pieces->region_max_volume */
  tet_insertion order; /* of what is over the radius-edge bound */
  double min_dihedral; /* degrees, to 30; with a dihedral angle below it a tetrahedron is a sliver; 0: none is */
  double sliver_points; /* slivers are given up when their removal has inserted so many vertices
                           for each that there was, and 250 */
  double alpha2;      /* scales the protecting balls near sharp segments (4.1.2) */
  double wedge;       /* times alpha2: at sharp dihedral angles, where existing vertices force
                         a split */
  double thin;        /* what the vertices of two facets force upon each other, where they meet at
                         a dihedral angle whose sine is below it, ends after */
  double thin_points; /* so many points for each vertex of the CDT, and 500 */
  double crowd;       /* a gap to the next segment below this share of the distance to what it
                         splits keeps a rejected circumcentre from splitting that */
  double crowd_facets; /* the same, for the gap to the next facet at sharp dihedral angles */
  double floor;       /* scales those of all vertices; far below what angles that are
                         not sharp can cause, it ends every other cascade */
  double wedge_floor; /* the same where there are sharp dihedral angles, and no subface is
                         promised to be Gabriel */
} tet_refine_options;

typedef struct tet_refine_result {
  tet_rejections rejected;
  uint64_t segment_points, facet_points, volume_points; /* inserted, and not removed again */
  uint64_t repair_flips;         /* that restored Delaunay after rounding */
  uint32_t n_sharp_segments;     /* below 60 degrees to a segment, 69.3 between facets, or on a facet below what
                                    the bound takes */
  uint64_t n_first_slivers;      /* before their removal */
  uint64_t removed_points;       /* inserted and removed again */
  uint64_t sliver_points;        /* vertices that their removal inserted */
  uint64_t sliver_budget;        /* at which it ended, or would have */
  uint64_t thin_points, thin_budget; /* inserted in thin facets, and how many may be */
  tet_trace trace;               /* of the exceptions */
  uint32_t n_exceptions;         /* tetrahedra over a bound */
  uint32_t *exception_tet;       /* [n] ascending; row of pieces->tets */
  double *exception_value;       /* [n] radius-edge ratio */
  uint32_t *exception_segment;   /* [n] row of pieces->subseg, sharp, or TET_NONE */
  uint32_t n_slivers;            /* that are left */
  uint32_t *sliver_tet;          /* [n] ascending; row of pieces->tets */
  double *sliver_cosine;         /* [n] of the smallest dihedral angle */
  uint32_t *sliver_segment;      /* [n] as exception_segment */
  uint64_t n_not_delaunay;       /* faces off the subfaces that stayed not locally Delaunay */
  int constrained_delaunay;      /* 1: every face off the subfaces is locally Delaunay */
  int gabriel;                   /* 1: no subface or subsegment is encroached */
} tet_refine_result;

/* Bound 2.0, no volume bound, and the protecting balls that measurements chose. */
void tet_refine_options_default(tet_refine_options *options);

/* Refines `pieces` in place. Input vertices keep their rows; new ones are
 * appended with origin and carrier. Ends on every input: near sharp segments the
 * accepting rule leaves tetrahedra over the bound, all listed in `ret`, whose
 * arrays are the caller's (tet_refine_result_free).
 * Errors: limits, TET_E_MEMORY, TET_E_INTERNAL where `pieces` is no CDT; then
 * `ret` is untouched and `pieces` is fit for tet_pieces_free alone.
 * Cost: about 10 microseconds for each point inserted; with sharp dihedral angles a copy of the pieces, and
 * where facets all but touch maybe twice the time. */
tet_status tet_refine(tet_ctx *ctx, tet_pieces *pieces, const tet_refine_options *options,
                      tet_refine_result *ret);

void tet_refine_result_free(tet_ctx *ctx, tet_refine_result *result);

#endif
