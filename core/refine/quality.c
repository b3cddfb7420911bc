// SPDX-License-Identifier: Apache-2.0
/* quality.c: circumcentre, radius-edge ratio and volume of a tetrahedron
 * (3.2.1). In doubles: no combinatorial decision is taken here. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>

/* Room for rounding between us and whoever measures again. */
static const double slack = 1 + 1e-10;

static inline double least(double a, double b) { return a < b ? a : b; }

void refine_measure(const refiner *r, uint32_t t, refine_shape *ret) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
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
}

void refine_circumcentre(const refiner *r, uint32_t t, const refine_shape *s, double ret[3]) {
  const double *o = refine_x(r, r->mesh.v[4 * (size_t)t]);
  for (int i = 0; i < 3; i++) ret[i] = o[i] + s->to_centre[i] / (2 * s->volume6);
}

double refine_radius_edge(const refine_shape *s) {
  return sqrt(tet_square(s->to_centre) / s->shortest2) / (2 * s->volume6);
}

/* Compared without a division; what is flat is over. */
int refine_over_ratio(const refiner *r, const refine_shape *s) {
  double reach = 2 * s->volume6 * r->o.radius_edge;
  return !(s->volume6 > 0 && tet_square(s->to_centre) <= reach * reach * s->shortest2 * slack);
}

int refine_over_volume(const refiner *r, uint32_t t, const refine_shape *s) {
  return s->volume6 > 6 * r->max_volume[r->tet_region[t]] * slack;
}

/* The bound of each region, INFINITY where there is none. */
tet_status refine_volume_bounds(refiner *r) {
  const tet_pieces *p = r->out;
  r->max_volume = tet_alloc(r->ctx, p->n_regions, sizeof *r->max_volume);
  if (!r->max_volume && p->n_regions) return TET_E_MEMORY;
  for (uint32_t i = 0; i < p->n_regions; i++) {
    double own = p->region_max_volume[i] > 0 ? p->region_max_volume[i] : INFINITY;
    r->max_volume[i] = least(own, r->o.max_volume > 0 ? r->o.max_volume : INFINITY);
  }
  return TET_OK;
}
