// SPDX-License-Identifier: Apache-2.0
// dyadic_vector.h: three-dimensional vectors of dyadic numbers, whose limbs lie in the space of the caller.
#ifndef TETRAD_CORE_EXACT_DYADIC_VECTOR_H
#define TETRAD_CORE_EXACT_DYADIC_VECTOR_H

#include "exact/dyadic.h"

/** ret = a - b */
static inline void tet_dyadic_minus3(tet_dyadic_space *w, const tet_dyadic a[3], const tet_dyadic b[3],
                                     tet_dyadic ret[3]) {
  for (int k = 0; k < 3; k++)
    ret[k] = tet_dyadic_sub(w, a[k], b[k]);
}

/** ret = a x b; ret is neither a nor b */
static inline void tet_dyadic_cross(tet_dyadic_space *w, const tet_dyadic a[3], const tet_dyadic b[3],
                                    tet_dyadic ret[3]) {
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    ret[k] = tet_dyadic_sub(w, tet_dyadic_mul(w, a[i], b[j]), tet_dyadic_mul(w, a[j], b[i]));
  }
}

static inline tet_dyadic tet_dyadic_dot(tet_dyadic_space *w, const tet_dyadic a[3], const tet_dyadic b[3]) {
  tet_dyadic xy = tet_dyadic_add(w, tet_dyadic_mul(w, a[0], b[0]), tet_dyadic_mul(w, a[1], b[1]));
  return tet_dyadic_add(w, xy, tet_dyadic_mul(w, a[2], b[2]));
}

#endif
