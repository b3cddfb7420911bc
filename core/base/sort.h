// SPDX-License-Identifier: Apache-2.0
/* sort.h: sorting of keyed items, in place and without allocating.
 *
 * The order is total, by key and then by value, so that the result depends on
 * nothing but the items. Other item types are sorted through their keys. */
#ifndef TET_BASE_SORT_H
#define TET_BASE_SORT_H

#include <stddef.h>
#include <stdint.h>

enum { TET_SORT_THREADS = 16 }; /* at most */

typedef struct tet_keyed {
  uint64_t key;
  uint64_t value;
} tet_keyed;

static inline void tet_sort2(uint32_t *a, uint32_t *b) {
  uint32_t lower = *a < *b ? *a : *b;
  *b = *a < *b ? *b : *a;
  *a = lower;
}

static inline void tet_sort3(uint32_t v[3]) {
  tet_sort2(&v[0], &v[1]);
  tet_sort2(&v[1], &v[2]);
  tet_sort2(&v[0], &v[1]);
}

/* Sorts `n` items by (key, value). n log n in the worst case. */
void tet_sort_keyed(tet_keyed *items, size_t n);

/* The same for many items, shared by `threads` (any number): `scratch` holds `n` more. Time in
 * proportion to n where not many keys are equal. */
void tet_sort_radix(tet_keyed *items, tet_keyed *scratch, size_t n, uint32_t threads);

#endif
