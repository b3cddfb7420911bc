// SPDX-License-Identifier: Apache-2.0
/* tilted.h: boxes that lie along what they hold (Gottschalk, Lin, Manocha 1996). */
#ifndef TET_BUILD_TILTED_H
#define TET_BUILD_TILTED_H

#include <stdint.h>

/* Extents along three axes, orthogonal but for rounding. */
typedef struct tet_tilted {
  double axis[3][3], lo[3], hi[3];
} tet_tilted;

/* The axes from the largest triangle among items of up to three corners: x[3 i] .. x[3 i + 2] of item i,
 * the last repeated where it has fewer. No extents yet. */
void tet_tilted_begin(const double *const *x, uint32_t n, tet_tilted *ret_box);

/* Extends the box to hold p. */
void tet_tilted_add(tet_tilted *box, const double *p);

/* 1: what the boxes hold is apart. In doubles, on the safe side: `most` is the largest of all
 * coordinates. */
int tet_tilted_apart(const tet_tilted *a, const tet_tilted *b, double most);

#endif
