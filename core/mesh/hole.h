// SPDX-License-Identifier: Apache-2.0
/* hole.h: the hole that a removed vertex leaves, while it is filled. Internal to removal.
 *
 * Rows are tetrahedra to be; the complex is not changed before all are there. */
#ifndef TET_MESH_HOLE_H
#define TET_MESH_HOLE_H

#include "mesh/complex.h"

#define TET_HOLE_ROW ((uint64_t)1 << 40) /* marks a handle 4k+i of row k */

/* A face whose inside is not filled yet; v turns outward, away from what is to fill. */
typedef struct tet_open_face {
  uint32_t v[3];
  uint64_t beyond; /* the handle outside, of the complex or of a row */
} tet_open_face;

typedef struct tet_hole_row {
  uint32_t v[4];
  uint64_t beyond[4];
} tet_hole_row;

struct tet_hole {
  uint64_t *key;       /* [n_face] a symmetric hash of v, apart, as all are looked through */
  tet_open_face *face; /* [n_face] */
  uint32_t *link;      /* [n_link] finite vertices */
  tet_hole_row *row;   /* [n_row] */
  size_t n_face, cap_key, cap_face, n_link, cap_link, n_row, cap_row;
  int has_ghost;       /* the link has the ghost vertex */
  tet_complex local;   /* of a large link */
  uint32_t *number;    /* [local slots] row + 1, or 0 */
  uint64_t *outside;   /* [local faces] handles beyond the hole + 1, or 0 */
  uint32_t *table;     /* of the open faces by key: number + 1, or 0 */
  size_t cap_number, cap_outside, cap_table;
};
typedef struct tet_hole tet_hole;

/* The complex's hole, made at the first call. */
tet_status tet_hole_of(tet_complex *c, tet_hole **ret);
void tet_hole_free(tet_complex *c);

/* Opens face f. */
tet_status tet_hole_open(tet_complex *c, tet_hole *e, const uint32_t f[3], uint64_t beyond);

/* A row on open face k with apex d, TET_GHOST included. */
tet_status tet_hole_tetrahedron(tet_complex *c, tet_hole *e, size_t k, uint32_t d);

/* Fills the hole from the Delaunay tetrahedralization of its link. *ret_flat = 1 and nothing
 * done where the link spans no volume. */
tet_status tet_hole_cut_out(tet_complex *c, tet_hole *e, int *ret_flat);

#endif
