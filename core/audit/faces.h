// SPDX-License-Identifier: Apache-2.0
/* faces.h: all faces of the tetrahedra of a mesh, sorted by their vertices. */
#ifndef TET_AUDIT_FACES_H
#define TET_AUDIT_FACES_H

#include "base/context.h"

#include <tet/mesh.h>

/* The vertices of face i, outward for a positive tetrahedron; the audit's own table. */
extern const uint8_t tet_audit_face[4][3];

/* Handles 4t+i (face i of tetrahedron t) ordered by the face's smallest vertex,
 * then the others; the sides of one face stand together. 16 bytes a tetrahedron. */
typedef struct tet_face_table {
  const tet_mesh *mesh;
  uint32_t *start;  /* [n_points + 1] faces whose smallest vertex is v */
  uint32_t *handle; /* [4 n_tetrahedra] */
} tet_face_table;

/* The vertices of face `handle`, ascending; returns 1 if that turns the outward
 * (right-handed) order into an odd permutation, else 0. */
int tet_face_vertices(const tet_mesh *mesh, uint32_t handle, uint32_t ret_v[3]);

/* Builds the table. All vertex indices of `mesh` must be in range. */
tet_status tet_face_table_build(tet_ctx *ctx, const tet_mesh *mesh, tet_face_table *ret_table);

/* The place in table->handle of the first side of the face of vertices v (any
 * order), and the number of its sides in *ret_n: 0 if it is none of the mesh. */
uint32_t tet_face_table_find(const tet_face_table *table, const uint32_t v[3], uint32_t *ret_n);

/* The number of handles from place `i` on that are sides of one face. */
uint32_t tet_face_table_run(const tet_face_table *table, uint32_t i);

void tet_face_table_free(tet_ctx *ctx, tet_face_table *table);

#endif
