// SPDX-License-Identifier: Apache-2.0
/* hilbert.c: cell coordinates to the Hilbert curve's index, after Skilling,
 * "Programming the Hilbert curve" (2004). */
#include "base/hilbert.h"

#include <stddef.h>

#include "base/processor.h"

enum { BITS = 21, LANES = 16 };

tet_hilbert_box tet_hilbert_bound(const double *points, const uint32_t *ids, uint32_t n) {
  double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, side = 0;
  tet_hilbert_box box = {{0, 0, 0}, 0};
  for (uint32_t i = 0; i < n; i++) {
    const double *p = points + 3 * (size_t)(ids ? ids[i] : i);
    for (int k = 0; k < 3; k++) {
      if (i == 0 || p[k] < low[k]) low[k] = p[k];
      if (i == 0 || p[k] > high[k]) high[k] = p[k];
    }
  }
  for (int k = 0; k < 3; k++) {
    box.low[k] = low[k];
    if (high[k] - low[k] > side) side = high[k] - low[k];
  }
  if (side > 0) box.scale = (double)(1 << BITS) / side;
  return box;
}

static inline uint32_t cell(const tet_hilbert_box *box, const double p[3], int k) {
  const double most = (double)((1 << BITS) - 1);
  double at = (p[k] - box->low[k]) * box->scale;
  return at > 0 ? at < most ? (uint32_t)at : (uint32_t)most : 0;
}

/* A word's 21 lowest bits, three apart. */
static inline uint64_t spread(uint32_t word) {
  uint64_t x = word;
  x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
  x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
  x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
  x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
  return (x | x << 2) & UINT64_C(0x1249249249249249);
}

/* From cells to the transposed index, for LANES points at once and without branches, so that the
 * compiler can put them side by side. */
static inline __attribute__((always_inline)) void transpose(uint32_t x[3][LANES]) {
  /* Undo the curve's turns from the largest cube down. */
  for (int bit = BITS - 1; bit > 0; bit--) {
    uint32_t low = (1u << bit) - 1;
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < LANES; i++) {
        uint32_t set = 0 - (x[k][i] >> bit & 1), t = (x[0][i] ^ x[k][i]) & low & ~set;
        x[0][i] ^= (low & set) ^ t;
        x[k][i] ^= k ? t : 0;
      }
  }
  /* Gray code. */
  for (int i = 0; i < LANES; i++) {
    x[1][i] ^= x[0][i];
    x[2][i] ^= x[1][i];
    uint32_t t = x[2][i] >> 1; /* bit b: the parity of the bits above it */
    for (int shift = 1; shift < BITS; shift *= 2) t ^= t >> shift;
    for (int k = 0; k < 3; k++) x[k][i] ^= t;
  }
}

static inline __attribute__((always_inline)) void find_keys(const tet_hilbert_box *box, const double *points,
                                                            const uint32_t *ids, uint32_t n, uint64_t *keys) {
  uint32_t x[3][LANES];
  for (uint32_t from = 0; from < n; from += LANES) {
    uint32_t count = n - from < LANES ? n - from : LANES;
    for (int k = 0; k < 3; k++)
      for (uint32_t i = 0; i < LANES; i++) x[k][i] = i < count ? cell(box, points + 3 * (size_t)(ids ? ids[from + i] : from + i), k) : 0;
    transpose(x);
    for (uint32_t i = 0; i < count; i++)
      keys[from + i] = spread(x[0][i]) << 2 | spread(x[1][i]) << 1 | spread(x[2][i]);
  }
}

#if TET_HAVE_AVX2
TET_AVX2 static void find_keys_avx2(const tet_hilbert_box *box, const double *points, const uint32_t *ids, uint32_t n,
                                    uint64_t *keys) {
  find_keys(box, points, ids, n, keys);
}
#endif

void tet_hilbert_keys(const tet_hilbert_box *box, const double *points, const uint32_t *ids, uint32_t n,
                      uint64_t *keys) {
#if TET_HAVE_AVX2
  if (tet_has_avx2()) {
    find_keys_avx2(box, points, ids, n, keys);
    return;
  }
#endif
  find_keys(box, points, ids, n, keys);
}

uint64_t tet_hilbert_key(const tet_hilbert_box *box, const double p[3]) {
  uint64_t key;
  tet_hilbert_keys(box, p, NULL, 1, &key);
  return key;
}
