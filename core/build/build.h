// SPDX-License-Identifier: Apache-2.0
/* build.h: from a PLS to its Delaunay or constrained Delaunay tetrahedralization.
 *
 * The algorithm of thesis 5.2: Delaunay tetrahedralization D_0 of the vertices,
 * surface mesh, LOCALDEGENERACYREMOVAL (5.5) where asked for, SEGMENTRECOVERY (5.3), FACETRECOVERY (5.4), removal of what is
 * outside and of holes, regions. Steiner points stay implicit until the last
 * facet is in; rounding them comes last (design section 4). */
#ifndef TET_BUILD_BUILD_H
#define TET_BUILD_BUILD_H

#include "mesh/pieces.h"

#include <tet/engine.h>

typedef struct tet_build_options {
  tet_stage stage;            /* TET_STAGE_DELAUNAY, else the CDT */
  int keep_hull;              /* outside and holes stay (2.4.2) */
  double planarity_tolerance; /* absolute; 0: 1e-5 of the box's diagonal */
  uint32_t threads;           /* of the Delaunay stage, at least 1 */
  double merge_angle;         /* degrees; see surface.h */
  int break_points;           /* LOCALDEGENERACYREMOVAL (5.5) */
} tet_build_options;

typedef struct tet_build_result {
  tet_pieces pieces;
  uint32_t *same_as;   /* [n_input] survivor of a merged duplicate, else itself */
  uint32_t n_input_facets; /* 0 of the stage delaunay */
  uint32_t *facet_same_as; /* [n_input_facets] lowest facet merged with it, or that it repeats, else itself */
  double planarity;    /* largest deviation of a polygon from its plane */
  double merged_angle, merged_distance; /* see surface.h */
  tet_counts counts;   /* of these stages; the others 0 */
} tet_build_result;

/* Builds; stages "delaunay", "surface", "degeneracies", "segments", "facets", "regions" are
 * begun on the context as they come. On failure *ret is untouched. */
tet_status tet_build(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options,
                     tet_build_result *ret);

void tet_build_result_free(tet_ctx *ctx, tet_build_result *r);

#endif
