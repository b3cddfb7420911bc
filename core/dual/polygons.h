// SPDX-License-Identifier: Apache-2.0
/* polygons.h: what the parts of diagram.c share: look-up tables, and polygons as they are
 * collected. Internal to this folder. */
#ifndef TET_DUAL_POLYGONS_H
#define TET_DUAL_POLYGONS_H

#include "base/context.h"
#include "base/sort.h"
#include "dual/edges.h"
#include "mesh/edge_map.h"

/* Numbers of Voronoi points while polygons are collected: circumcentres of tetrahedra, then of
 * subfaces, midpoints of subsegments, vertices; those that nothing uses go in the end. */
typedef struct tet_polygons {
  tet_ctx *ctx;
  const tet_mesh *mesh;
  tet_region_edges edges; /* vertices and regions are the mesh's own */
  uint32_t *first_cell;   /* [n_points + 1] */
  tet_keyed *subface;     /* [n_subfaces] by vertices: (low, middle), (high, row) */
  tet_edge_map subsegment; /* edge to row */
  uint32_t *side;         /* [n_subfaces][2] region behind and before, or TET_NONE; both where no border */

  uint32_t *start, *corner, *cell; /* as the mesh's voronoi_face_start, _points, _cells */
  size_t n_faces, n_corners, cap_start, cap_corner, cap_cell;
} tet_polygons;

/* Numbers of points of each kind. */
static inline uint64_t tet_subface_point(const tet_polygons *p, uint32_t s) {
  return (uint64_t)p->mesh->n_tetrahedra + s;
}

static inline uint64_t tet_subsegment_point(const tet_polygons *p, uint32_t s) {
  return tet_subface_point(p, p->mesh->n_subfaces) + s;
}

static inline uint64_t tet_vertex_point(const tet_polygons *p, uint32_t v) {
  return tet_subsegment_point(p, p->mesh->n_subsegments) + v;
}

/* The cell of a vertex and a region, which must be there; TET_NONE for the region TET_NONE. */
static inline uint32_t tet_cell_of(const tet_polygons *p, uint32_t v, uint32_t region) {
  uint32_t c = p->first_cell[v];
  if (region == TET_NONE) return TET_NONE;
  while (p->mesh->cell_regions[c] != region) c++;
  return c;
}

/* Adds a corner to the polygon that is being made. */
tet_status tet_add_corner(tet_polygons *p, uint64_t point);

/* Ends the polygon that is being made: a face between two cells, counterclockwise seen from the
 * second. The first may not be TET_NONE alone: then the polygon is turned round. */
tet_status tet_end_polygon(tet_polygons *p, uint32_t from, uint32_t to);

/* The row of the subface with these vertices, or TET_NONE. */
uint32_t tet_find_subface(const tet_polygons *p, uint32_t a, uint32_t b, uint32_t c);

/* Fills `side` from the tetrahedra, then adds what the cells have of the borders of regions. */
tet_status tet_find_sides(tet_polygons *p);
tet_status tet_border_polygons(tet_polygons *p);

#endif
