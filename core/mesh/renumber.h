// SPDX-License-Identifier: Apache-2.0
/* renumber.h: slots in an order that depends on the tetrahedra alone. */
#ifndef TET_MESH_RENUMBER_H
#define TET_MESH_RENUMBER_H

#include "mesh/complex.h"

/* Sorts the tetrahedra by their vertices, all below n_vertices, and the vertices of each, and leaves no
 * slot free. `at` means nothing after. Eight bytes a slot while it runs. Errors: limits; then
 * nothing is changed. */
tet_status tet_complex_renumber(tet_complex *c, uint32_t n_vertices);

#endif
