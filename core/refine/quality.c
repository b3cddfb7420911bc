// SPDX-License-Identifier: Apache-2.0
/* quality.c: circumcentre, radius-edge ratio and volume of a tetrahedron
 * (3.2.1). In doubles: no combinatorial decision is taken here. */
#include "refine/refiner.h"

#include <math.h>

/* Room for rounding between us and whoever measures again. */
static const double slack = 1 + 1e-10;

void refine_measure(const refiner *r, uint32_t t, refine_shape *ret) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  const double *o = refine_x(r, v[0]);
  double d[3][3], n[3][3], l[3];
  for (int k = 0; k < 3; k++) {
    const double *x = refine_x(r, v[k + 1]);
    for (int i = 0; i < 3; i++) d[k][i] = x[i] - o[i];
    l[k] = d[k][0] * d[k][0] + d[k][1] * d[k][1] + d[k][2] * d[k][2];
  }
  ret->shortest2 = l[0];
  ret->short_a = v[0];
  ret->short_b = v[1];
  for (int k = 0; k < 3; k++) {
    const double *a = d[(k + 1) % 3], *b = d[(k + 2) % 3];
    double e2 = 0;
    for (int i = 0; i < 3; i++) {
      n[k][i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
      e2 += (a[i] - b[i]) * (a[i] - b[i]);
    }
    if (l[k] < ret->shortest2) ret->shortest2 = l[k], ret->short_a = v[0], ret->short_b = v[k + 1];
    if (e2 < ret->shortest2) ret->shortest2 = e2, ret->short_a = v[(k + 1) % 3 + 1], ret->short_b = v[(k + 2) % 3 + 1];
  }
  double det = d[0][0] * n[0][0] + d[0][1] * n[0][1] + d[0][2] * n[0][2];
  ret->volume = det / 6;
  ret->radius2 = 0;
  for (int i = 0; i < 3; i++) {
    double c = (l[0] * n[0][i] + l[1] * n[1][i] + l[2] * n[2][i]) / (2 * det);
    ret->radius2 += c * c;
    ret->centre[i] = o[i] + c;
  }
}

int refine_over_ratio(const refiner *r, const refine_shape *s) {
  return !(s->radius2 <= r->o.radius_edge * r->o.radius_edge * s->shortest2 * slack);
}

int refine_over_volume(const refiner *r, uint32_t t, const refine_shape *s) {
  uint32_t region = r->tet_region[t];
  double most = region < r->out->n_regions ? r->out->region_max_volume[region] : 0;
  if (r->o.max_volume > 0 && s->volume > r->o.max_volume * slack) return 1;
  return most > 0 && s->volume > most * slack;
}

/* Order O2 (Table 3.2): short edges first; over the volume alone (R3.2 waits for R3.1):
 * large ones first. */
int refine_is_bad(const refiner *r, uint32_t t, int *ret_late, double *ret_key) {
  refine_shape shape;
  refine_measure(r, t, &shape);
  *ret_late = !refine_over_ratio(r, &shape);
  *ret_key = *ret_late ? 1 / shape.volume : shape.shortest2;
  return !*ret_late || refine_over_volume(r, t, &shape);
}
