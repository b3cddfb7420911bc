// SPDX-License-Identifier: Apache-2.0
/* centre.c: the circumcentre of a tetrahedron, wherever its vertices leave it. In doubles that of an
 * almost flat one is noise: four vertices that are all but cocircular have theirs anywhere on the line
 * through their circle's centre. Then it is a quotient of exact polynomials, each rounded once. */
#include "refine/refiner.h"

#include "exact/shape.h"

/* The quotient. */
static void exact_centre(const refiner *r, const uint32_t v[4], double ret[3]) {
  const double *x[4];
  refine_places(r, v, x);
  tet_exact_shape s = tet_shape_exactly(x);
  for (int k = 0; k < 3; k++) ret[k] = x[0][k] + s.to_centre[k] / (2 * s.volume6);
}

/* 1 if x is in the circumball of the tetrahedron v, as its centre is. */
static int is_within(const refiner *r, const uint32_t v[4], const double x[3]) {
  return tet_is_place(x) &&
         tet_insphere_xyz(refine_x(r, v[0]), refine_x(r, v[1]), refine_x(r, v[2]), refine_x(r, v[3]), x) > 0;
}

void refine_circumcentre(const refiner *r, uint32_t t, const refine_shape *s, double ret[3]) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  for (int i = 0; i < 3; i++) ret[i] = refine_x(r, v[0])[i] + s->to_centre[i] / (2 * s->volume6);
  if (!is_within(r, v, ret)) exact_centre(r, v, ret);
}
