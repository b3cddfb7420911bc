// SPDX-License-Identifier: Apache-2.0
// The circumcentre and the faces' normals of a tetrahedron, exact but for one rounding of each number; the
// normal of a triangle, and along which axis it is seen largest. For what doubles measure as noise:
// tetrahedra almost flat, faces almost without area. Four vertices that are all but cocircular may have any
// circumradius to doubles, and the angles at an edge whose face is a needle depend on which vertex one begins
// with.
#ifndef TETRAD_CORE_EXACT_SHAPE_H
#define TETRAD_CORE_EXACT_SHAPE_H

#include <stdint.h>

/** With a, b, c from the first vertex to the others. */
typedef struct tet_exact_shape {
  double to_centre[3]; /* 2^scale (|a|^2 b x c + |b|^2 c x a + |c|^2 a x b) */
  double volume6;      /* 2^scale a . (b x c), below 1 in size; the centre is at their quotient / 2 from the first */
  int32_t scale;
} tet_exact_shape;

/** Below this, the squared volume6 / (|a| |b| |c|), or of a face's normal over the product of two such lengths, nothing
 * that doubles say of either is taken: their relative errors are below 2^-53 * 40 * 2^13, about 4e-11, where
 * it is above. */
#define TET_SURE_SHAPE 0x1p-26

/** The tetrahedron of the points v[0] to v[3], finite. Microseconds. */
tet_exact_shape tet_shape_exactly(const double *const v[4]);

/** The normals of the faces opposite v[0] to v[3], which point inwards where v is positive, each times a
 * power of two that brings its largest coordinate to about 1; of a face without area 0. Microseconds. */
void tet_normals_exactly(const double *const v[4], double ret[4][3]);

/** The unit normal of triangle abc, of any size: exact but for rounding where doubles are unsure; without area 0. */
void tet_unit_normal(const double a[3], const double b[3], const double c[3], double ret[3]);

/** The axis along which triangle abc, not collinear, has the largest projection; of several the first. Exact, so that
 * all who look at a facet look at it from the same side, whichever vertex they begin with. */
int tet_widest_axis(const double a[3], const double b[3], const double c[3]);

#endif
