// SPDX-License-Identifier: Apache-2.0
/* pick.c: where a point goes that is inserted for a sliver: somewhere near the place of R1, R2
 * or R3, elsewhere for each point. In symmetric places slivers beget slivers, as between two
 * facets that are triangulated alike. After the picking regions of Li and Teng (3.4.2); no
 * candidate is tried here. */
#include "refine/refiner.h"

#include <math.h>

/* From -1/2 to 1/2, another number for each vertex to be and k. */
double refine_chance(const refiner *r, uint32_t k) {
  uint32_t h = r->points.n * 4 + k;
  h = (h ^ h >> 16) * 0x7feb352du;
  h = (h ^ h >> 15) * 0x846ca68bu;
  return ((h ^ h >> 16) >> 8) * 0x1p-24 - 0.5;
}

/* Moves x by up to a fifth of an edge, of squared length shortest2, if a sliver is being split. */
void refine_pick(const refiner *r, double shortest2, double x[3]) {
  static const double reach = 0.2;
  if (!r->picking) return;
  for (uint32_t i = 0; i < 3; i++) x[i] += reach * sqrt(shortest2) * refine_chance(r, i);
}
