// SPDX-License-Identifier: Apache-2.0
/* quality.c: radius-edge ratio, volume and dihedral angles of a tetrahedron
 * (3.2.1). In doubles, and where these are noise, rounded from exact values, so that whoever measures again agrees: no
 * combinatorial decision is taken here. */
#include "refine/refiner.h"

#include "base/vector.h"
#include "exact/shape.h"

#include <float.h>
#include <math.h>

static inline double least(double a, double b) { return a < b ? a : b; }

void refine_measure(const refiner *r, uint32_t t, refine_shape *ret) {
  refine_measure_corners(r, r->mesh.v + 4 * (size_t)t, ret);
}

/* In doubles; 1 if these are to be taken for true, though not to the last bit. */
int refine_measure_roughly(const refiner *r, const uint32_t v[4], refine_shape *ret) {
  const double *o = refine_x(r, v[0]);
  double a[3], b[3], c[3], bc[3], ca[3], ab[3], e[3];
  tet_minus(refine_x(r, v[1]), o, a);
  tet_minus(refine_x(r, v[2]), o, b);
  tet_minus(refine_x(r, v[3]), o, c);
  double aa = tet_square(a), bb = tet_square(b), cc = tet_square(c);
  tet_cross(b, c, bc);
  tet_cross(c, a, ca);
  tet_cross(a, b, ab);
  double s = least(least(aa, bb), cc);
  tet_minus(a, b, e);
  s = least(s, tet_square(e));
  tet_minus(b, c, e);
  s = least(s, tet_square(e));
  tet_minus(c, a, e);
  ret->shortest2 = least(s, tet_square(e));
  ret->volume6 = tet_dot(a, bc);
  for (int i = 0; i < 3; i++) ret->to_centre[i] = aa * bc[i] + bb * ca[i] + cc * ab[i];
  return ret->volume6 * ret->volume6 > TET_SURE_SHAPE * (aa * bb * cc);
}

void refine_measure_corners(const refiner *r, const uint32_t v[4], refine_shape *ret) {
  if (refine_measure_roughly(r, v, ret)) return;
  const double *x[4];
  refine_places(r, v, x);
  tet_exact_shape s = tet_shape_exactly(x);
  ret->volume6 = ldexp(s.volume6, -s.scale);
  for (int i = 0; i < 3; i++) ret->to_centre[i] = ldexp(s.to_centre[i], -s.scale);
}

double refine_radius_edge(const refine_shape *s) {
  return sqrt(tet_square(s->to_centre) / s->shortest2) / (2 * s->volume6);
}

/* Compared without a division; what is flat is over. */
int refine_over_ratio(const refiner *r, const refine_shape *s) {
  double reach = 2 * s->volume6 * r->o.radius_edge;
  return !(s->volume6 > 0 && tet_square(s->to_centre) <= reach * reach * s->shortest2 * REFINE_SLACK);
}

int refine_over_volume(const refiner *r, uint32_t region, double volume6) {
  return volume6 > 6 * r->max_volume[region] * REFINE_SLACK;
}

/* 1: subface s is narrower than rounding moves a point of coordinates up to `most`. The corner off its longest side
 * is about as far from that as the lesser of two sides times the sine of their angle. */
int refine_is_narrow(const refiner *r, uint32_t s, double most) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  double d[3], e[3], n[3];
  double length = tet_direction(refine_x(r, v[1]), refine_x(r, v[0]), d);
  length = fmin(length, tet_direction(refine_x(r, v[2]), refine_x(r, v[0]), e));
  tet_cross(d, e, n);
  return tet_longest(n) * length < 4 * DBL_EPSILON * most;
}

/* 1 if all normals of faces, squares nn, are longer than their errors in doubles by far, for edges of squares aa, bb,
 * cc from the first vertex, and these products are normal doubles. */
static inline int are_sure(const double nn[4], double aa, double bb, double cc) {
  double most = fmax(fmax(aa * bb, bb * cc), cc * aa) * TET_SURE_SHAPE;
  if (!(most > 0x1p-450)) most = 0x1p-450;
  for (int i = 0; i < 4; i++)
    if (!(nn[i] > most && nn[i] < 0x1p450)) return 0;
  return 1;
}

/* Squared cosine of the smallest dihedral angle, 1 where a face has no area: by the normals of the faces, which point
 * inwards. */
double refine_sharpest(const refiner *r, const uint32_t v[4]) {
  const double *x[4];
  refine_places(r, v, x);
  double a[3], b[3], c[3], n[4][3], nn[4], most = 0;
  tet_minus(x[1], x[0], a);
  tet_minus(x[2], x[0], b);
  tet_minus(x[3], x[0], c);
  tet_cross(b, c, n[1]);
  tet_cross(c, a, n[2]);
  tet_cross(a, b, n[3]);
  for (int i = 0; i < 3; i++) n[0][i] = -(n[1][i] + n[2][i] + n[3][i]);
  for (int i = 0; i < 4; i++) nn[i] = tet_square(n[i]);
  if (!are_sure(nn, tet_square(a), tet_square(b), tet_square(c))) {
    tet_normals_exactly(x, n);
    for (int i = 0; i < 4; i++) nn[i] = tet_square(n[i]);
  }
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double d = tet_dot(n[i], n[j]); /* minus the cosine, times the lengths */
      if (d < 0 && !(d * d <= most * nn[i] * nn[j])) most = d * d / (nn[i] * nn[j]);
    }
  return most < 1 ? most : 1;
}

int refine_is_sliver(const refiner *r, const uint32_t v[4]) {
  return r->sliver_sine2 > 0 && 1 - refine_sharpest(r, v) < r->sliver_sine2;
}

/* The bounds: of the sine of dihedral angles, and of each region's volumes, INFINITY where there
 * is none. */
tet_status refine_set_bounds(refiner *r) {
  const tet_pieces *p = r->out;
  double sine = tet_sine_of_degrees(r->o.min_dihedral);
  r->sliver_sine2 = sine * sine / REFINE_SLACK;
  r->max_volume = tet_alloc(r->ctx, p->n_regions, sizeof *r->max_volume);
  if (!r->max_volume && p->n_regions) return TET_E_MEMORY;
  for (uint32_t i = 0; i < p->n_regions; i++) {
    double own = p->region_max_volume[i] > 0 ? p->region_max_volume[i] : INFINITY;
    r->max_volume[i] = least(own, r->o.max_volume > 0 ? r->o.max_volume : INFINITY);
  }
  return TET_OK;
}
