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
 * are explicit vertices (the ends of the input segment or, of a point on a facet,
 * any two in its plane) and t is a double with 0 < t < 1. Never nested. */
typedef struct tet_segment_point {
  uint32_t a, b;
  double t;
} tet_segment_point;

/** Planes that are known to hold explicit vertices, exactly: the numbers of those through
 * vertex v are of[start[v]] to of[start[v + 1] - 1], rising. An implicit point is in the
 * planes that both its ends are in. */
typedef struct tet_planes {
  const uint32_t *start, *of;
} tet_planes;

/** Vertex coordinates. Vertices v >= first_implicit are implicit; their entry
 * is implicit[v - first_implicit]. Where there is none, first_implicit is n or
 * more (UINT32_MAX serves) and `implicit` may be NULL. */
typedef struct tet_points {
  double *x;  /* 3 per vertex; for an implicit one what tet_segment_point_round gives */
  uint32_t n; /* vertices */
  uint32_t first_implicit; /* the first implicit vertex */
  tet_segment_point *implicit;
  double max_abs; /* at least the largest |coordinate| of all vertices */
  const uint32_t *rank; /* the number by which a vertex is perturbed; NULL: its own */
  double grain3, grain5; /* third and fifth power of a number of which all explicit
                            coordinates are multiples (tet_points_find_grain); 0: unknown */
  const tet_planes *planes; /* known to hold vertices, exactly; NULL: none is */
  struct tet_tally *tally; /* tally.h: where calls are counted; NULL: nowhere */
} tet_points;

/** A view of n explicit vertices, of unknown grain. */
static inline tet_points tet_points_explicit(double *x, uint32_t n) {
  return (tet_points){.x = x, .n = n, .first_implicit = UINT32_MAX};
}

/** Sets the grain of p's explicit vertices: the largest power of two that divides all their
 * coordinates, where it is large enough against them to be of use. Then a determinant
 * known to be smaller than its grain is known to be zero. */
void tet_points_find_grain(tet_points *p);

/** 1 if the four vertices are known to be coplanar: of one plane of p->planes, or three of them
 * of one segment. */
int tet_are_in_one_plane(const tet_points *p, const uint32_t v[4]);

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
