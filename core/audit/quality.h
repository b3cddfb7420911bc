// SPDX-License-Identifier: Apache-2.0
/* quality.h: shapes of tetrahedra, in doubles that are right to 1e-10, however flat they are. */
#ifndef TET_AUDIT_QUALITY_H
#define TET_AUDIT_QUALITY_H

#include "base/context.h"

#include <tet/mesh.h>

typedef struct tet_shape {
  double volume;                   /* signed */
  double radius_edge;              /* circumradius / shortest edge; infinite where flat */
  double aspect;                   /* longest edge / shortest height; infinite where flat */
  double cos_smallest, cos_largest; /* of the smallest and the largest dihedral angle */
} tet_shape;

/* Shape of the tetrahedron of vertices v[0..3] of `points`. */
tet_shape tet_shape_of(const double *points, const uint32_t v[4]);

/* Histograms and volume of all tetrahedra of `mesh`. */
tet_status tet_measure_quality(tet_ctx *ctx, const tet_mesh *mesh, tet_quality *ret_quality);

#endif
