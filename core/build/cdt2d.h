// SPDX-License-Identifier: Apache-2.0
/* cdt2d.h: constrained Delaunay triangulation of points in a plane.
 *
 * The kernel of facet triangulation (thesis A.3.2): sweep insertion with Lawson
 * flips, then constraints by edge flips (Lawson; Sloan 1993). Points are numbered
 * locally 0..n-1 and name vertices of a tet_points view. orient2d drops one axis;
 * the in-circle test is insphere with a point off the plane (design 9.4), so that
 * ties are broken as in the Delaunay tetrahedralization. It knows nothing of
 * polygons, holes and facets: the triangulation fills the convex hull.
 */
#ifndef TET_BUILD_CDT2D_H
#define TET_BUILD_CDT2D_H

#include "base/context.h"
#include "exact/points.h"
#include "mesh/pieces.h"

/* Directed edge j of triangle s, handle h = 3s+j, goes from tri[h] to
 * tri[next(h)]; triangles are counter-clockwise in the projection. */
typedef struct tet_cdt2d {
  tet_ctx *ctx;
  const tet_points *points;
  const uint32_t *id; /* [n] vertex of the view for each local point; not owned */
  uint32_t n;
  int axis;           /* coordinate to drop */
  uint32_t off;       /* vertex of the view off the plane */
  int side;           /* sign of orient3d(a,b,c,off) of a counter-clockwise abc */
  uint32_t n_tris;
  uint32_t *tri, *adj; /* [n_tris][3]; adj: handle across, or TET_NONE */
  uint8_t *fixed;      /* [n_tris][3] 1: a constraint, never flipped */
  uint32_t *at;        /* [n] a handle whose origin is the point, or TET_NONE */
  uint32_t *hull_next, *hull_prev, *hull_edge; /* [n] while sweeping */
  uint32_t *stack;
  uint32_t *queue;     /* pairs of points: edges that cross a constraint */
  void *order;
  size_t cap_tri, cap_adj, cap_fixed, cap_at, cap_hull_next, cap_hull_prev, cap_hull_edge;
  size_t cap_stack, cap_queue, cap_order;
  uint32_t n_stack;
} tet_cdt2d;

static inline uint32_t tet_next3(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static inline uint32_t tet_prev3(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/* Delaunay triangulation of the n points. ret_same: two local points that
 * coincide in the projection (then nothing is triangulated), else TET_NONE.
 * Without three points off one line there are no triangles. */
tet_status tet_cdt2d_points(tet_cdt2d *c, const tet_points *points, const uint32_t *id, uint32_t n,
                            int axis, uint32_t off, uint32_t ret_same[2]);

/* Makes the edge from p towards q a constraint, as far as the first point *ret_end
 * that lies on it (q, mostly). Where it would cross a constraint, nothing changes,
 * *ret_end is TET_NONE and ret_cross holds that constraint's ends. */
tet_status tet_cdt2d_constrain(tet_cdt2d *c, uint32_t p, uint32_t q, uint32_t *ret_end,
                               uint32_t ret_cross[2]);

/* The handle of edge p to q, or of q to p on the hull; TET_NONE if there is none. */
uint32_t tet_cdt2d_find(const tet_cdt2d *c, uint32_t p, uint32_t q);

/* A triangle that holds the projection of x (its border included), or TET_NONE. */
uint32_t tet_cdt2d_locate(const tet_cdt2d *c, const double *x);

void tet_cdt2d_free(tet_cdt2d *c);

#endif
