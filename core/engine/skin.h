// SPDX-License-Identifier: Apache-2.0
/* skin.h: facets of a convex hull that is flat but for rounding. */
#ifndef TET_ENGINE_SKIN_H
#define TET_ENGINE_SKIN_H

#include "mesh/pieces.h"

/* Facets as a PLS has them: the first polygon of each is its outline, the others are vertices in it. */
typedef struct tet_skin {
  uint32_t n_facets, n_polygons;
  uint32_t *facet_start;      /* [n_facets + 1] polygons */
  uint32_t *polygon_start;    /* [n_polygons + 1] vertices */
  uint32_t *polygon_vertices; /* numbers of the points of the pieces */
  double tolerance;           /* how far from the plane of a facet its vertices may be; 0: not at all */
  uint32_t n_below;           /* vertices in facets that are below the hull's faces, or beside its edges */
} tet_skin;

/* The hull of a Delaunay tetrahedralization by facets. Faces of the hull, and vertices below, that are in one plane
 * within a `share` of the hull's width are of one facet, and vertices as near to an edge between two facets are on it: points
 * that were turned, or read from a file, lie a rounding beside their plane, and refinement would
 * fill the gaps. A share of 0: its faces, in the order of their tetrahedra. What comes out need not be a valid surface
 * where gaps are about as wide as the share. Errors: memory, limits; *ret is untouched then. n log n. */
tet_status tet_skin_build(tet_ctx *ctx, const tet_pieces *pieces, double share, tet_skin *ret);

void tet_skin_free(tet_ctx *ctx, tet_skin *skin);

#endif
