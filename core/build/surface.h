// SPDX-License-Identifier: Apache-2.0
/* surface.h: the triangulated boundary of a PLS, validated (thesis A.3.2).
 *
 * From the caller's facets to flat patches of triangles, each patch exactly
 * planar and a 2D constrained Delaunay triangulation, joined by segments.
 *
 *   input facet   as uploaded: polygons, holes, loose segments and points
 *   patch         exactly coplanar triangles of one (merged) facet; the unit
 *                 of facet recovery
 *   segment       an edge where patches meet, a patch ends, a loose segment, or
 *                 a crease (between two patches of one input facet)
 *
 * Vertex indices are the caller's; merged duplicates are replaced by their
 * survivor everywhere. Steiner points come in later: of segments through
 * tet_surface_split, break points on facets through tet_surface_add.
 */
#ifndef TET_BUILD_SURFACE_H
#define TET_BUILD_SURFACE_H

#include "base/context.h"
#include "exact/points.h"
#include "mesh/pieces.h"

typedef struct tet_patch {
  uint32_t facet;      /* into facets */
  uint8_t axis;        /* coordinate to drop for orient2d */
  int8_t side;         /* sign of orient3d(t, off_plane) for all its triangles t */
  uint32_t off_plane;  /* an explicit vertex off its plane: with it in-facet
                          incircle tests are insphere tests (design 9.4) */
} tet_patch;

/* Directed edge j of triangle s goes from tri[3s+j] to tri[3s+(j+1)%3]. */
typedef struct tet_surface {
  uint32_t n_patches;
  tet_patch *patch;
  uint32_t n_tris;
  uint32_t *tri;        /* [n][3]; counter-clockwise in the dropped-axis projection */
  uint32_t *tri_adj;    /* [n][3] handle 3s'+j' across edge j inside the patch; TET_NONE
                           at a subsegment */
  uint32_t *tri_seg;    /* [n][3] subsegment at edge j, or TET_NONE */
  uint32_t *tri_patch;  /* [n] */
  size_t cap_tri, cap_tri_adj, cap_tri_seg, cap_tri_patch;
  uint32_t *plane_start;    /* [n_input + 1] into plane */
  uint32_t *plane;          /* the patches of each input vertex, rising: the planes that it is in */

  uint32_t n_facets;
  tet_facet *facet;
  uint32_t n_segments;
  tet_segment *segment;     /* a < b */
  uint32_t n_subsegs;       /* = n_segments before any split */
  uint32_t *subseg;         /* [n][2]; directed like its segment */
  uint32_t *subseg_segment; /* [n] */
  uint32_t *subseg_tri;     /* [n] some triangle edge handle 3s+j on it, or TET_NONE; the
                               others follow through tri_ring */
  uint32_t *tri_ring;       /* [n_tris][3] next edge handle on the same subsegment (cyclic);
                               TET_NONE off subsegments */
  size_t cap_subseg, cap_subseg_segment, cap_subseg_tri, cap_tri_ring;

  uint32_t *same_as;        /* [n_input] survivor of a merged duplicate */
  uint8_t *used;            /* [n_input] 1: vertex of the triangulation (facet, segment,
                               loose point); survivors only */
  uint32_t *repeats;        /* [n_facets] the earlier input facet that is the same, or TET_NONE */
  uint32_t *facet_same_as;  /* [n_facets] lowest input facet merged with it, or that it repeats, else itself */
  double planarity;         /* largest distance of a polygon vertex from its facet's plane */
  double merged_angle;      /* degrees: the largest angle off flat at which two facets were merged; 0: none were so */
  double merged_distance;   /* largest distance of a triangle's vertex there from the other one's plane */
  uint64_t n_duplicates, n_repeated_facets, n_unused;
} tet_surface;

/* The place of vertex v on its segment s, from 0 at a to 1 at b. */
static inline double tet_place_on(const tet_points *points, const tet_segment *s, uint32_t v) {
  return v == s->a ? 0 : v == s->b ? 1 : points->implicit[v - points->first_implicit].t;
}

/* Builds and validates the surface of `pls`. `points` views the input's vertices
 * (no implicit ones). `tolerance`: absolute planarity tolerance (> 0). `merge_angle`: degrees, below
 * 90: how far from flat facets of one marker may meet, at a side that only they have, for it to be a
 * crease; 0: none is.
 * Resolved: duplicates (lowest index survives), a vertex exactly on a segment or
 * facet (splits or joins it), repeated facets (one kept, counted), coplanar facets
 * of one marker that share an edge only they have (merged).
 * Refused: crossing or overlapping facets and segments, vertices or polygons out
 * of range, polygons out of plane, facets without area; with all offending pairs
 * up to TET_MAX_OFFENDERS in the error. About n log n. */
tet_status tet_surface_build(tet_ctx *ctx, const tet_pls *pls, const tet_points *points,
                             double tolerance, double merge_angle, tet_surface *ret_surface);

/* Splits subsegment `e` at vertex `v` (on it, index beyond all earlier ones),
 * in every incident patch, and restores the patches' constrained Delaunay
 * property by flips. The half towards the segment's `a` end keeps number e, the
 * other is appended: n_subsegs - 1. */
tet_status tet_surface_split(tet_ctx *ctx, tet_surface *s, const tet_points *points, uint32_t e, uint32_t v);

/* Adds vertex `v` (index beyond all earlier ones) strictly inside the triangle of edge h or, with
 * on_edge, on h, which is no subsegment; restores the constrained Delaunay property. Triangle h / 3
 * has v then. */
tet_status tet_surface_add(tet_ctx *ctx, tet_surface *s, const tet_points *points, uint32_t h, int on_edge, uint32_t v);

void tet_surface_free(tet_ctx *ctx, tet_surface *s);

#endif
