// SPDX-License-Identifier: Apache-2.0
/* centre.c: the circumcentre of a tetrahedron, wherever its vertices leave it. In doubles that of an
 * almost flat one is noise: four vertices that are all but cocircular have theirs anywhere on the line
 * through their circle's centre. Then it is a quotient of exact polynomials, each rounded once. */
#include "refine/refiner.h"

#include "exact/dyadic.h"

#include <math.h>

typedef tet_dyadic_space space;
typedef tet_dyadic num;

static num cross_at(space *w, const num a[3], const num b[3], int k) {
  int i = (k + 1) % 3, j = (k + 2) % 3;
  return tet_dyadic_sub(w, tet_dyadic_mul(w, a[i], b[j]), tet_dyadic_mul(w, a[j], b[i]));
}

static num dot(space *w, const num a[3], const num b[3]) {
  num xy = tet_dyadic_add(w, tet_dyadic_mul(w, a[0], b[0]), tet_dyadic_mul(w, a[1], b[1]));
  return tet_dyadic_add(w, xy, tet_dyadic_mul(w, a[2], b[2]));
}

/* With a, b, c from the first vertex to the others, (|a|^2 b x c + |b|^2 c x a + |c|^2 a x b) / (2 a.(b x c)). */
static void exact_centre(const refiner *r, const uint32_t v[4], double ret[3]) {
  space store, *w = &store;
  num from[3][3], normal[3][3], square[3];
  tet_dyadic_begin(w);
  for (int k = 0; k < 3; k++) {
    num o = tet_dyadic_from_double_reduced(w, refine_x(r, v[0])[k]);
    for (int i = 0; i < 3; i++)
      from[i][k] = tet_dyadic_sub(w, tet_dyadic_from_double_reduced(w, refine_x(r, v[i + 1])[k]), o);
  }
  for (int i = 0; i < 3; i++) {
    square[i] = dot(w, from[i], from[i]);
    for (int k = 0; k < 3; k++) normal[k][i] = cross_at(w, from[(i + 1) % 3], from[(i + 2) % 3], k);
  }
  num column[3] = {normal[0][0], normal[1][0], normal[2][0]}, volume = dot(w, from[0], column);
  int32_t scale = volume.exp + 64 * (int32_t)volume.n; /* neither part is too large or small for a double */
  volume.exp -= scale;
  for (int k = 0; k < 3; k++) {
    num q = dot(w, square, normal[k]);
    q.exp -= scale;
    ret[k] = refine_x(r, v[0])[k] + tet_dyadic_to_double(&q) / (2 * tet_dyadic_to_double(&volume));
  }
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
