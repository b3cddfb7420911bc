// SPDX-License-Identifier: Apache-2.0
// A quick exact stage for points that lie on one grid of at most 2^60 steps, as most
// do: integers of fixed width instead of dyadic numbers. Internal to this folder.
#ifndef TETRAD_CORE_EXACT_GRID_STAGE_H
#define TETRAD_CORE_EXACT_GRID_STAGE_H

#include "exact/exact_points.h"

#ifdef __cplusplus
extern "C" {
#endif

/** As tet_exact_orient3d and tet_exact_insphere, into *ret_sign. Returns 0, with
 * *ret_sign untouched, for points that do not fit. */
int tet_grid_orient3d(const tet_point_ref point[4], int *ret_sign);
int tet_grid_insphere(const tet_point_ref point[5], int *ret_sign);

#ifdef __cplusplus
}
#endif
#endif
