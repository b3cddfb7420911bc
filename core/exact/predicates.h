// SPDX-License-Identifier: Apache-2.0
// Exact geometric predicates over explicit and implicit points: a floating-point
// filter first (after Shewchuk 1997), and where it cannot tell, exact integers. Each
// returns -1, 0 or +1, always the sign of the exact value.
//
// Accepted coordinates: finite doubles, |x| <= TET_COORDINATE_LIMIT, of any
// granularity down to the denormals. Functions without a suffix take vertex
// numbers and any mix of explicit and implicit points; those with _xyz take
// explicit coordinates, 3 doubles a point. Nothing here allocates, and nothing
// is kept between calls. Cost: 5 to 50 ns where the filter decides; exactly, 50 to
// 500 ns for coordinates on a common grid and up to 2 us for others (README.md).
#ifndef TETRAD_CORE_EXACT_PREDICATES_H
#define TETRAD_CORE_EXACT_PREDICATES_H

#include <stdint.h>

#include "exact/points.h"

#ifdef __cplusplus
extern "C" {
#endif

/** 2^500: the largest |coordinate| that the predicates accept. */
#define TET_COORDINATE_LIMIT 0x1p500

/** Whether the predicates accept x: three numbers, none larger than that. */
int tet_is_place(const double x[3]);

/** Sign of det(b - a, c - a, d - a): positive for a positive tetrahedron. Never
 * perturbed (a perturbed orientation would make flat tetrahedra). */
int tet_orient3d(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
int tet_orient3d_xyz(const double *a, const double *b, const double *c, const double *d);

/** > 0: e is strictly inside the circumsphere of the positive tetrahedron abcd;
 * 0: on it. The sign flips with the orientation of abcd. */
int tet_insphere(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t e);
int tet_insphere_xyz(const double *a, const double *b, const double *c, const double *d,
                     const double *e);

/** tet_insphere with ties broken by a symbolic perturbation of the lifted weights,
 * a function of the vertices' ranks alone (Devillers, Teillaud 2011): no five
 * vertices are cospherical unless they are coplanar. 0 only if all five lie in
 * one plane or a number repeats. Antisymmetric under permutations. */
int tet_insphere_sos(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d,
                     uint32_t e);

/** The sign that the perturbation gives five cospherical vertices: tet_insphere_sos where
 * tet_insphere is 0. */
int tet_insphere_tie(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d,
                     uint32_t e);

/** Orientation in the plane of the coordinates (axis+1)%3, (axis+2)%3, that is
 * with coordinate `axis` (0, 1, 2) dropped: the sign of component `axis` of
 * (b - a) x (c - a). */
int tet_orient2d(const tet_points *p, int axis, uint32_t a, uint32_t b, uint32_t c);
int tet_orient2d_xyz(int axis, const double *a, const double *b, const double *c);

/** 1 if a, b, c lie exactly on one line (coincident points included), else 0. */
int tet_collinear(const tet_points *p, uint32_t a, uint32_t b, uint32_t c);
int tet_collinear_xyz(const double *a, const double *b, const double *c);

/** Sign of (a - c).(b - c): > 0 where the angle at c is acute, < 0 where c is
 * strictly inside the diametric ball of ab, 0 on its sphere. */
int tet_dot_sign(const tet_points *p, uint32_t a, uint32_t b, uint32_t c);
int tet_dot_sign_xyz(const double *a, const double *b, const double *c);

/** Sign of |b - a|^2 - |c - a|^2. */
int tet_compare_distance(const tet_points *p, uint32_t a, uint32_t b, uint32_t c);
int tet_compare_distance_xyz(const double *a, const double *b, const double *c);

/** > 0: d is strictly inside the diametric ball of triangle abc, the ball about
 * the triangle's circumcentre (in its plane) through a, b, c; 0: on its sphere,
 * or the triangle is degenerate; < 0: outside. */
int tet_in_diametric_ball3(const tet_points *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
int tet_in_diametric_ball3_xyz(const double *a, const double *b, const double *c, const double *d);

#ifdef __cplusplus
}
#endif
#endif
