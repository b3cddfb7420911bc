// SPDX-License-Identifier: Apache-2.0
/* hilbert.c: cell coordinates to the Hilbert curve's index, after Skilling,
 * "Programming the Hilbert curve" (2004). */
#include "base/hilbert.h"

enum { BITS = 21 };

tet_hilbert_box tet_hilbert_bound(const double *points, uint32_t n) {
  tet_hilbert_box box = {{0, 0, 0}, 0};
  double side = 0;
  for (int k = 0; n && k < 3; k++) {
    double low = points[k], high = low;
    for (const double *p = points + k, *end = p + 3 * (uint64_t)n; p < end; p += 3) {
      if (*p < low) low = *p;
      if (*p > high) high = *p;
    }
    box.low[k] = low;
    if (high - low > side) side = high - low;
  }
  if (side > 0) box.scale = (double)(1 << BITS) / side;
  return box;
}

uint64_t tet_hilbert_key(const tet_hilbert_box *box, const double p[3]) {
  const double most = (double)((1 << BITS) - 1);
  uint32_t x[3];
  for (int k = 0; k < 3; k++) {
    double cell = (p[k] - box->low[k]) * box->scale;
    x[k] = cell > 0 ? cell < most ? (uint32_t)cell : (uint32_t)most : 0;
  }
  /* Undo the curve's turns from the largest cube down. */
  for (uint32_t q = 1u << (BITS - 1); q > 1; q >>= 1) {
    for (int k = 0; k < 3; k++) {
      if (x[k] & q) {
        x[0] ^= q - 1;
      } else {
        uint32_t t = (x[0] ^ x[k]) & (q - 1);
        x[0] ^= t;
        x[k] ^= t;
      }
    }
  }
  /* Gray code. */
  x[1] ^= x[0];
  x[2] ^= x[1];
  uint32_t t = 0;
  for (uint32_t q = 1u << (BITS - 1); q > 1; q >>= 1)
    if (x[2] & q) t ^= q - 1;
  uint64_t key = 0;
  for (int bit = BITS - 1; bit >= 0; bit--)
    for (int k = 0; k < 3; k++) key = key << 1 | (((x[k] ^ t) >> bit) & 1);
  return key;
}
