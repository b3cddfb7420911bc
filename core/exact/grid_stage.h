// SPDX-License-Identifier: Apache-2.0
// A quick exact stage for points that lie on one grid of at most 2^60 steps, as most
// do: integers of fixed width instead of dyadic numbers. Internal to this folder.
#ifndef TETRAD_CORE_EXACT_GRID_STAGE_H
#define TETRAD_CORE_EXACT_GRID_STAGE_H

#include "exact/exact_points.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As the functions of exact_stage.h, with the sign in *ret_sign. They return 0, with
 * *ret_sign untouched, for points that do not fit; else not 0. */
int tet_grid_orient3d(const tet_point_ref point[4], int *ret_sign);
int tet_grid_insphere(const tet_point_ref point[5], int *ret_sign);
int tet_grid_orient2d(int axis, const tet_point_ref point[3], int *ret_sign);
int tet_grid_dot_sign(const tet_point_ref point[3], int *ret_sign);
int tet_grid_compare_distance(const tet_point_ref point[3], int *ret_sign);
int tet_grid_diametric_ball3(const tet_point_ref point[4], int *ret_sign);

#ifdef __cplusplus
}
#endif
#endif
