// SPDX-License-Identifier: Apache-2.0
/* maker.h: PLSs made from a seed, with what is known about them. */
#ifndef TESTS_MAKER_H
#define TESTS_MAKER_H

#include <tet/pls.h>

enum { MAKER_POINTS = 600, MAKER_FACETS = 400, MAKER_SEEDS = 40 };

typedef struct made_pls {
  tet_pls pls;          /* refers to the arrays below: do not copy */
  double volume;        /* of the domain, holes aside */
  uint32_t n_regions;   /* that the mesh must have */
  double points[MAKER_POINTS][3];
  double attributes[MAKER_POINTS];
  uint32_t polygon_start[MAKER_FACETS + 1];
  uint32_t polygon_vertices[4 * MAKER_FACETS];
  int32_t facet_markers[MAKER_FACETS];
  double holes[MAKER_SEEDS][3];
  double seeds[MAKER_SEEDS][3];
  int32_t region_markers[MAKER_SEEDS];
} made_pls;

typedef struct maker_random {
  uint64_t state;
} maker_random;

/* A number below n. */
uint32_t maker_below(maker_random *r, uint32_t n);
/* A number in [0, 1), of 53 bits. */
double maker_unit(maker_random *r);

/* A box with up to 27 boxes inside, which touch neither it nor each other, on an
 * integer lattice: each is a region with or without a seed, or a hole. */
void make_boxes(uint64_t seed, made_pls *ret);

/* A stack of boxes that share whole walls: one wall is a facet of both. */
void make_stack(uint64_t seed, made_pls *ret);

/* Turns, stretches and moves the points (seeds too) by doubles that round, so that
 * quadrangles are planar no more but within a tolerance; keeps the volume known. */
void make_oblique(uint64_t seed, made_pls *pls);

/* `kind` 0: small integers, with many equal; 1: the same in a plane, 2: on a line,
 * 3: all equal, 4: a lattice sphere, 5: uniform. Points alone. */
void make_points(uint64_t seed, int kind, made_pls *ret);
enum { MAKER_POINT_KINDS = 6 };

#endif
