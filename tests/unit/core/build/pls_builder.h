// SPDX-License-Identifier: Apache-2.0
/* pls_builder.h: a small PLS written by hand in a test, and its surface. */
#ifndef TESTS_PLS_BUILDER_H
#define TESTS_PLS_BUILDER_H

#include "build/surface.h"

enum { BUILDER_POINTS = 4096, BUILDER_FACETS = 4096, BUILDER_INDICES = 32768 };

/* `pls` is kept complete after every call. */
typedef struct pls_builder {
  tet_pls pls;
  tet_points points;
  double x[3 * BUILDER_POINTS];
  uint32_t facet_start[BUILDER_FACETS + 1], polygon_start[BUILDER_FACETS + 1];
  uint32_t polygon_vertices[BUILDER_INDICES];
  uint32_t facet_hole_start[BUILDER_FACETS + 1];
  int32_t facet_markers[BUILDER_FACETS];
  double facet_holes[3 * BUILDER_FACETS];
  uint32_t segments[2 * BUILDER_FACETS];
  int32_t segment_markers[BUILDER_FACETS];
} pls_builder;

/* An empty PLS, in which every unused vertex is a loose point. */
pls_builder *pls_new(void);
void pls_free(pls_builder *b);

uint32_t pls_point(pls_builder *b, double x, double y, double z);
/* A facet without polygons yet; returns its number. */
uint32_t pls_facet(pls_builder *b, int32_t marker);
/* A polygon of the last facet. */
void pls_polygon(pls_builder *b, int n, const uint32_t *v);
void pls_hole(pls_builder *b, double x, double y, double z);
/* A facet of one polygon of 3 or 4 vertices. */
uint32_t pls_triangle(pls_builder *b, int32_t marker, uint32_t p, uint32_t q, uint32_t r);
uint32_t pls_quad(pls_builder *b, int32_t marker, uint32_t p, uint32_t q, uint32_t r, uint32_t s);
void pls_segment(pls_builder *b, int32_t marker, uint32_t p, uint32_t q);
/* The eight corners and six sides of a box, markers first .. first+5 (z0 z1 y0 y1 x0
 * x1); returns the first vertex. Corner i is at x of i&1, y of i>>1&1, z of i>>2. */
uint32_t pls_box(pls_builder *b, int32_t first, const double lo[3], const double hi[3]);

/* tet_surface_build with tolerance 1e-9. */
tet_status pls_surface(pls_builder *b, tet_ctx *ctx, tet_surface *ret);

/* NULL, or what is wrong with a surface: numbering, orientation, adjacency, rings,
 * exact planarity of patches, constrained Delaunay property, chains of subsegments.
 * `points` may hold implicit ones. */
const char *surface_fault(const tet_surface *s, const tet_points *points);

/* Areas of all triangles, summed. */
double surface_area(const tet_surface *s, const tet_points *points);

#endif
