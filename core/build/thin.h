// SPDX-License-Identifier: Apache-2.0
/* thin.h: tetrahedra squeezed between nearly coplanar facets. */
#ifndef TET_BUILD_THIN_H
#define TET_BUILD_THIN_H

#include "build/surface.h"

/* A place on a segment where a Steiner point is wanted from the start. */
typedef struct tet_break {
  uint32_t segment;
  double t;
} tet_break;

typedef struct tet_breaks {
  tet_break *at; /* sorted by segment and t */
  size_t n, cap;
} tet_breaks;

/* Looks for tetrahedra flatter than `least` (at a crease: than its facet is out of
 * plane) between two subfaces that share a subsegment, and adds the place on it
 * nearest to their opposite edge; least 0 finds none. tri: the surface's triangle at
 * each face of `p`. *ret_found: how many were added. */
tet_status tet_find_thin(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, const tet_pieces *p,
                         const uint32_t *tri, double least, tet_breaks *breaks, size_t *ret_found);

#endif
