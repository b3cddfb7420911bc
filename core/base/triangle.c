// SPDX-License-Identifier: Apache-2.0
/* triangle.c: distances from triangles, and their circumcentres. No sign is decided here. */
#include "base/triangle.h"

#include <float.h>
#include <math.h>

#include "base/vector.h"

double tet_edge_distance2(const double *a, const double *b, const double *x) {
  double e2 = 0, ex = 0, sum = 0;
  for (int i = 0; i < 3; i++) {
    e2 += (b[i] - a[i]) * (b[i] - a[i]);
    ex += (b[i] - a[i]) * (x[i] - a[i]);
  }
  double t = e2 > 0 ? ex / e2 : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  for (int i = 0; i < 3; i++) {
    double d = x[i] - a[i] - t * (b[i] - a[i]);
    sum += d * d;
  }
  return sum;
}

/* That of its plane if x is above it, else of its edges. */
double tet_triangle_distance2(const double *a, const double *b, const double *c, const double *x) {
  const double *corner[3] = {a, b, c};
  double n[3], n2 = 0, height = 0;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    n2 += n[i] * n[i];
  }
  int above = n2 > 0;
  for (int s = 0; s < 3 && above; s++) {
    const double *p = corner[s], *q = corner[(s + 1) % 3];
    double side = 0;
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      side += n[i] * ((q[j] - p[j]) * (x[k] - p[k]) - (q[k] - p[k]) * (x[j] - p[j]));
    }
    above = side >= 0;
  }
  if (above) {
    for (int i = 0; i < 3; i++) height += n[i] * (x[i] - a[i]);
    return height * height / n2;
  }
  double least = INFINITY;
  for (int s = 0; s < 3; s++) {
    double d = tet_edge_distance2(corner[s], corner[(s + 1) % 3], x);
    if (d < least) least = d;
  }
  return least;
}

double tet_triangle_centre(const double u[3], const double w[3], double ret_centre[3]) {
  double most = 0, us[3], ws[3], n[3], v[3], c[3];
  for (int i = 0; i < 3; i++) most = fmax(most, fmax(fabs(u[i]), fabs(w[i])));
  if (!(most > 0) || isinf(most)) return 0;
  int e;
  frexp(most, &e);
  if (e < -1000) e = -1000;
  double scale = ldexp(0.5, -e); /* exact; no product of six lengths is too large then */
  for (int i = 0; i < 3; i++) {
    us[i] = scale * u[i];
    ws[i] = scale * w[i];
  }
  double uu = tet_square(us), ww = tet_square(ws);
  tet_cross(us, ws, n);
  double nn = tet_square(n);
  if (!(nn > 0)) return 0;
  for (int i = 0; i < 3; i++) v[i] = uu * ws[i] - ww * us[i];
  tet_cross(v, n, c);
  for (int i = 0; i < 3; i++) c[i] /= 2 * nn * scale;
  if (!isfinite(c[0]) || !isfinite(c[1]) || !isfinite(c[2])) return 0;
  for (int i = 0; i < 3; i++) ret_centre[i] = c[i];
  return fmax(ldexp(nn, 4 * (e + 1)), DBL_MIN);
}
