// SPDX-License-Identifier: Apache-2.0
// The vertices that predicates see: explicit ones, whose doubles are the truth,
// and implicit Steiner points on segments (Diazzi, Panozzo, Vaxman, Attene 2023;
// Attene 2020), which are exactly a + t (b - a). This is a view: whoever fills
// it owns the memory. Nothing here allocates.
#ifndef TETRAD_CORE_EXACT_POINTS_H
#define TETRAD_CORE_EXACT_POINTS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** An implicit Steiner point on a segment: exactly a + t (b - a), where a and b
 * are explicit vertices (the ends of the input segment) and t is a double with
 * 0 < t < 1. Never nested. */
typedef struct tet_segment_point {
  uint32_t a, b;
  double t;
} tet_segment_point;

/** Vertex coordinates. Vertices v >= first_implicit are implicit; their entry
 * is implicit[v - first_implicit]. Where there is none, first_implicit is n or
 * more (UINT32_MAX serves) and `implicit` may be NULL. */
typedef struct tet_points {
  double *x;  /* 3 per vertex; for an implicit one what tet_segment_point_round gives */
  uint32_t n; /* vertices */
  uint32_t first_implicit; /* the first implicit vertex */
  tet_segment_point *implicit;
  double max_abs; /* at least the largest |coordinate| of all vertices */
} tet_points;

/** The doubles that stand for an implicit point in p->x: each coordinate is the
 * double nearest to the exact a + t (b - a), ties to even. Deterministic. Reads
 * the coordinates of s->a and s->b alone. */
void tet_segment_point_round(const tet_points *p, const tet_segment_point *s, double out[3]);

static inline int tet_is_implicit(const tet_points *p, uint32_t v) {
  return v >= p->first_implicit;
}

#ifdef __cplusplus
}
#endif
#endif
