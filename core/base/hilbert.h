// SPDX-License-Identifier: Apache-2.0
/* hilbert.h: places along a three-dimensional Hilbert curve. */
#ifndef TET_BASE_HILBERT_H
#define TET_BASE_HILBERT_H

#include <stdint.h>

#define TET_HILBERT_CELLS 0x1p21 /* to a side of the cube */

/* A cube that the curve fills. */
typedef struct tet_hilbert_box {
  double low[3];
  double scale; /* cells per unit length */
} tet_hilbert_box;

/* The smallest cube around `n` points of three coordinates each: rows ids[0 .. n-1], or with
 * NULL rows 0 .. n-1. */
tet_hilbert_box tet_hilbert_bound(const double *points, const uint32_t *ids, uint32_t n);

/* The place on the curve of the cell (2^21 to a side) that holds p: 63 bits.
 * Points out of the box get the nearest cell's. */
uint64_t tet_hilbert_key(const tet_hilbert_box *box, const double p[3]);

/* The keys of `n` points, those of rows ids[0 .. n-1] of `points`, or with NULL of the first n:
 * several times as fast. */
void tet_hilbert_keys(const tet_hilbert_box *box, const double *points, const uint32_t *ids, uint32_t n,
                      uint64_t *keys);

#endif
