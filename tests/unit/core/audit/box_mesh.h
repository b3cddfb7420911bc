// SPDX-License-Identifier: Apache-2.0
/* box_mesh.h: a mesh made by hand that keeps every promise, for tests to spoil. */
#ifndef TESTS_BOX_MESH_H
#define TESTS_BOX_MESH_H

#include <tet/mesh.h>

/* The box [0, 2n] x [0, n] x [0, n] of unit cubes, each in six tetrahedra along its
 * diagonal (Kuhn). The wall x = n parts two regions; subfaces are the box's sides
 * and the wall; segments the 12 edges of the box and the 4 of the wall. All
 * neighbours are filled; delaunay, gabriel, covered and a radius-edge bound of 1
 * are promised. */
tet_mesh *box_mesh(tet_ctx *ctx, uint32_t n);

#endif
