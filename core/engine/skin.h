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

/* The hull of a Delaunay tetrahedralization by facets, which are as flat as the points were written. Faces in one plane
 * within a share of the hull's width are of one facet, and vertices as little below are in it, or on an edge between
 * two: points that were turned, or read from a file, lie a rounding beside their plane, and refinement would fill the
 * gaps. The share is that of a double's last bits, a float's, or the sixth digit (3e-5): one by which some points are
 * below the faces, and hardly any by ten times that. exact: the facets are the faces, in the order of their
 * tetrahedra; else they need not be a valid surface. Errors: memory, limits; *ret is untouched then. n log n. */
tet_status tet_skin_build(tet_ctx *ctx, const tet_pieces *pieces, int exact, tet_skin *ret);

void tet_skin_free(tet_ctx *ctx, tet_skin *skin);

#endif
