// SPDX-License-Identifier: Apache-2.0
/* delaunay.h: the Delaunay tetrahedralization D_0 of given vertices (A.3.1). */
#ifndef TET_MESH_DELAUNAY_H
#define TET_MESH_DELAUNAY_H

#include "mesh/complex.h"

/* Inserts the `n` vertices `ids` (distinct points, none in the complex) into complex `c`,
 * which is empty or holds a Delaunay tetrahedralization, in rounds of growing size, each
 * along a Hilbert curve (BRIO: Amenta, Choi, Rote 2003). `ids` is permuted. The tetrahedra
 * depend on neither the order of `ids` nor `threads` (1 and more); their slots do, but with
 * c->is_canonical in an empty complex not on `threads`.
 * Errors: TET_E_DEGENERATE where all lie in one plane; limits; after one the complex is
 * empty or, where it was not so before, holds some of the vertices. Expected cost n log n. */
tet_status tet_delaunay(tet_complex *c, uint32_t *ids, uint32_t n, uint32_t threads);

#endif
