// SPDX-License-Identifier: Apache-2.0
/* delaunay.h: the Delaunay tetrahedralization D_0 of given vertices (A.3.1). */
#ifndef TET_BUILD_DELAUNAY_H
#define TET_BUILD_DELAUNAY_H

#include "mesh/complex.h"

/* Inserts the `n` vertices `ids` (distinct points) into the empty complex `c`, in
 * rounds of growing size, each along a Hilbert curve (BRIO: Amenta, Choi, Rote
 * 2003). `ids` is permuted. Errors: TET_E_DEGENERATE where all lie in one plane;
 * limits. Expected cost n log n. */
tet_status tet_delaunay(tet_complex *c, uint32_t *ids, uint32_t n);

#endif
