// SPDX-License-Identifier: Apache-2.0
// Exact coordinates of explicit and implicit points as dyadic numbers, for the
// exact stage of the predicates and for rounding. Internal to this folder.
#ifndef TETRAD_CORE_EXACT_EXACT_POINTS_H
#define TETRAD_CORE_EXACT_EXACT_POINTS_H

#include "exact/dyadic.h"
#include "exact/points.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What the exact stage knows of a point: explicit (a alone), or exactly
 * a + t (b - a) where b is not NULL. */
typedef struct tet_point_ref {
  const double *a, *b;
  double t;
} tet_point_ref;

/** Three coordinates, all of one exponent. */
typedef struct tet_dyadic_point {
  tet_dyadic x[3];
} tet_dyadic_point;

static inline tet_point_ref tet_ref_xyz(const double *x) {
  return (tet_point_ref){.a = x, .b = 0, .t = 0};
}

static inline tet_point_ref tet_ref(const tet_points *p, uint32_t v) {
  if (!tet_is_implicit(p, v))
    return tet_ref_xyz(p->x + 3 * (size_t)v);
  const tet_segment_point *s = p->implicit + (v - p->first_implicit);
  return (tet_point_ref){.a = p->x + 3 * (size_t)s->a, .b = p->x + 3 * (size_t)s->b, .t = s->t};
}

/** The greatest exponent at which all given coordinates are integers. */
int32_t tet_common_exponent(const tet_point_ref *points, int count);

/** The exact point. exp as from tet_common_exponent over points that include it:
 * explicit points get that exponent, implicit ones one less by the length of t. */
tet_dyadic_point tet_exact_point(tet_dyadic_space *w, const tet_point_ref *point, int32_t exp);

#ifdef __cplusplus
}
#endif
#endif
