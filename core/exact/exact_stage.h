// SPDX-License-Identifier: Apache-2.0
// The exact stage of the predicates: the same polynomials as the filters, in dyadic
// numbers. Internal to this folder; callers want predicates.h. Every function
// returns the sign of the exact value. Stack: 128 KiB each, mostly untouched.
#ifndef TETRAD_CORE_EXACT_EXACT_STAGE_H
#define TETRAD_CORE_EXACT_EXACT_STAGE_H

#include "exact/exact_points.h"

#ifdef __cplusplus
extern "C" {
#endif

int tet_exact_orient3d(const tet_point_ref point[4]);
int tet_exact_insphere(const tet_point_ref point[5]);
int tet_exact_orient2d(int axis, const tet_point_ref point[3]);
int tet_exact_dot_sign(const tet_point_ref point[3]);
int tet_exact_compare_distance(const tet_point_ref point[3]);
int tet_exact_diametric_ball3(const tet_point_ref point[4]);

#ifdef __cplusplus
}
#endif
#endif
