// SPDX-License-Identifier: Apache-2.0
/* triangle.h: triangles and edges in doubles, for what decides no sign. Points are 3 doubles each. */
#ifndef TET_BASE_TRIANGLE_H
#define TET_BASE_TRIANGLE_H

/* Squared distance of x from the edge ab. */
double tet_edge_distance2(const double *a, const double *b, const double *x);

/* Squared distance of x from the triangle abc. */
double tet_triangle_distance2(const double *a, const double *b, const double *c, const double *x);

/* The circumcentre of triangle 0uw, of any size. Returns its normal's square, |u x w|^2, as near as a positive double
 * is (or infinite); 0 where there is no normal or no double as large as the centre: then it is not set. */
double tet_triangle_centre(const double u[3], const double w[3], double ret_centre[3]);

#endif
