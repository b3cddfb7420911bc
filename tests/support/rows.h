// SPDX-License-Identifier: Apache-2.0
/* rows.h: the tetrahedra of a complex in a form to be compared. Failures are cmocka's. */
#ifndef TETRAD_SUPPORT_ROWS_H
#define TETRAD_SUPPORT_ROWS_H

#include "mesh/complex.h"

/* The tetrahedra, ghosts too, as sorted rows of sorted vertices, to be freed by the caller. */
typedef struct rows {
  uint32_t (*row)[4];
  size_t n;
} rows;
rows sorted_rows(const tet_complex *c);

/* The same without ghosts. */
rows finite_rows(const tet_complex *c);

/* Fails unless both hold the same tetrahedra; frees neither. */
void check_same(const rows *a, const rows *b);

#endif
