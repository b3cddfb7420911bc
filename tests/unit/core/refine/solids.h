// SPDX-License-Identifier: Apache-2.0
/* solids.h: prisms and pyramids, built up to the CDT, for tests of refinement. */
#ifndef TESTS_SOLIDS_H
#define TESTS_SOLIDS_H

#include "build/build.h"

enum { SOLID_SIDES = 12 };

/* A prism over the polygon `base`, of `n` sides, from z = 0 to `height`, turned
 * about two axes by the angles `turn`. */
typedef struct solid {
  tet_pls pls; /* refers to the arrays below: do not copy */
  double points[2 * SOLID_SIDES][3];
  uint32_t polygon_start[SOLID_SIDES + 3];
  uint32_t polygon_vertices[6 * SOLID_SIDES];
} solid;

void solid_prism(solid *s, uint32_t n, const double base[][2], double height, const double turn[2]);

/* A regular prism of n sides, of radius 1. */
void solid_regular(solid *s, uint32_t n, double height, const double turn[2]);

/* A wedge: a prism over an isosceles triangle of legs 1, whose tip has that angle. */
void solid_wedge(solid *s, double degrees, double height);

/* A pyramid over a polygon of n sides, about regular, with plane angles of about that many degrees at its tip, and a loose
 * point in it, close beside one of the edges there. */
void solid_pyramid(solid *s, uint32_t n, double degrees);

/* Its CDT; the caller frees the result. */
tet_status solid_build(tet_ctx *ctx, const solid *s, tet_build_result *ret);

/* NULL, or what is wrong: positive tetrahedra, adjacency both ways, interior faces
 * off the subfaces locally Delaunay, boundary faces subfaces. */
const char *pieces_fault(const tet_pieces *p);

double pieces_volume(const tet_pieces *p);

#endif
