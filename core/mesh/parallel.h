// SPDX-License-Identifier: Apache-2.0
/* parallel.h: insertion of many vertices by several threads. Internal to bulk insertion. */
#ifndef TET_MESH_PARALLEL_H
#define TET_MESH_PARALLEL_H

#include "base/hilbert.h"
#include "mesh/complex.h"

/* A complex whose vertices are numbered by rounds, each in order along the same curve. */
typedef struct tet_rounds {
  uint32_t n;            /* begun so far, the one to insert included */
  uint32_t start[33];    /* of round r its first vertex; start[n]: the end */
  tet_hilbert_box box;   /* of the curve */
} tet_rounds;

/* Inserts the vertices of the last round that begins in `rounds` into `c`, which holds those of the
 * rounds before. Points are explicit. Errors: limits; then vertices are missing. */
tet_status tet_insert_round(tet_complex *c, const tet_rounds *rounds, uint32_t threads);

#endif
