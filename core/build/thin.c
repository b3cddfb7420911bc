// SPDX-License-Identifier: Apache-2.0
/* thin.c: break points, mainly for tetrahedra squeezed between nearly coplanar facets.
 *
 * Where facets meet at almost 180 degrees, the CDT may hold a tetrahedron on
 * them whose other faces lie on them as well, but for far less than any size
 * that matters. It is exact, and useless. Where the facets' own triangulation, were they one
 * plane, would rather have the tetrahedron's other edge, its sphere is mostly outside, and
 * nothing inside the domain helps (else squeezed.c does): a Steiner point on the common segment,
 * where the opposite edge passes, takes that edge out of the Delaunay
 * tetrahedralization. These are break points like those of thesis 5.5, chosen for
 * what is nearly degenerate; only lengths decide, in doubles. */
#include "build/thin.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"

/* A tetrahedron is squeezed where its thickness is less than this part of its edges; those in the
 * tip of a sharp corner are not, however small. */
static const double SQUEEZED = 1e-2;

static double length(const double *points, uint32_t a, uint32_t b) {
  double v[3];
  tet_minus(points + 3 * (size_t)a, points + 3 * (size_t)b, v);
  return sqrt(tet_dot(v, v));
}

/* The distance between lines xy and de, and where on each they are nearest. */
static double distance(const double *x, const double *y, const double *d, const double *e, double at[2]) {
  double u[3], v[3], w[3], n[3], wv[3], wu[3];
  tet_minus(y, x, u);
  tet_minus(e, d, v);
  tet_minus(d, x, w);
  tet_cross(u, v, n);
  double nn = tet_dot(n, n);
  if (!(nn > 0)) return INFINITY;
  tet_cross(w, v, wv);
  tet_cross(w, u, wu);
  at[0] = tet_dot(wv, n) / nn;
  at[1] = tet_dot(wu, n) / nn;
  return fabs(tet_dot(w, n)) / sqrt(nn);
}

/* The subsegment at edge xy of triangle k, or TET_NONE. */
static uint32_t subsegment_of(const tet_surface *s, uint32_t k, uint32_t x, uint32_t y) {
  for (size_t j = 0; j < 3; j++) {
    uint32_t a = s->tri[3 * (size_t)k + j], b = s->tri[3 * (size_t)k + (j + 1) % 3];
    if ((a == x && b == y) || (a == y && b == x)) return s->tri_seg[3 * (size_t)k + j];
  }
  return TET_NONE;
}

void tet_break_consider(const tet_surface *surface, const tet_points *exact, const double *points, uint32_t sub,
                        uint32_t x, uint32_t y, uint32_t d, uint32_t e, tet_break *best, double *gap) {
  const tet_segment *g = &surface->segment[surface->subseg_segment[sub]];
  double at[2] = {0, 0}, h = distance(points + 3 * (size_t)x, points + 3 * (size_t)y, points + 3 * (size_t)d,
                             points + 3 * (size_t)e, at);
  if (!(h < *gap) || !(at[0] > 0 && at[0] < 1 && at[1] > 0 && at[1] < 1)) return;
  double t0 = tet_place_on(exact, g, x), t1 = tet_place_on(exact, g, y);
  *best = (tet_break){surface->subseg_segment[sub], t0 + fmin(fmax(at[0], 0.125), 0.875) * (t1 - t0)};
  *gap = h;
}

static int compare(const void *pa, const void *pb) {
  const tet_break *a = pa, *b = pb;
  if (a->segment != b->segment) return a->segment < b->segment ? -1 : 1;
  return a->t < b->t ? -1 : a->t > b->t;
}

tet_status tet_breaks_add(tet_ctx *ctx, tet_breaks *breaks, const tet_break *b) {
  tet_status status = tet_grow(ctx, &breaks->at, &breaks->cap, breaks->n + 1, sizeof *breaks->at);
  if (status == TET_OK) breaks->at[breaks->n++] = *b;
  return status;
}

void tet_breaks_sort(tet_breaks *breaks) {
  size_t n = 0;
  if (breaks->n) qsort(breaks->at, breaks->n, sizeof *breaks->at, compare);
  for (size_t k = 0; k < breaks->n; k++)
    if (!k || compare(&breaks->at[k], &breaks->at[k - 1]) != 0) breaks->at[n++] = breaks->at[k];
  breaks->n = n;
}

/* 1: the angles at d and e over edge xy are more than 180 degrees together: were xyd and xye flat, their
 * Delaunay triangulation would have de. */
static int is_outside(const double *points, const uint32_t xy[2], uint32_t d, uint32_t e) {
  const double *x = points + 3 * (size_t)xy[0], *y = points + 3 * (size_t)xy[1];
  const uint32_t apex[2] = {d, e};
  double u[2][3], v[2][3], cosine[2], sine[2];
  for (int k = 0; k < 2; k++) {
    tet_minus(x, points + 3 * (size_t)apex[k], u[k]);
    tet_minus(y, points + 3 * (size_t)apex[k], v[k]);
    cosine[k] = tet_dot(u[k], v[k]);
  }
  if (cosine[0] >= 0 && cosine[1] >= 0) return 0;
  for (int k = 0; k < 2; k++) {
    double n[3];
    tet_cross(u[k], v[k], n);
    sine[k] = sqrt(tet_square(n));
  }
  return sine[0] * cosine[1] + cosine[0] * sine[1] < 0;
}

/* If face i of tetrahedron t is a subface, its edge that is not at vertex j a subsegment, and t is
 * squeezed flat between this edge and the opposite one, sets *ret to the place to break and returns 1. */
static int must_break(const tet_surface *s, const tet_points *exact, const tet_pieces *p, const uint32_t *tri,
                      size_t t, int i, int j, double least, tet_break *ret) {
  uint32_t k = tri[4 * t + (size_t)i], xy[2], n = 0, d = p->tets[4 * t + (size_t)i], e = p->tets[4 * t + (size_t)j];
  if (k == TET_NONE || (j < i && tri[4 * t + (size_t)j] != TET_NONE)) return 0; /* the same edge from its other side */
  for (int c = 0; c < 3; c++) {
    uint32_t v = p->tets[4 * t + tet_face[i][c]];
    if (v != e) xy[n++] = v;
  }
  if (!is_outside(p->points, xy, d, e)) return 0;
  uint32_t sub = subsegment_of(s, k, xy[0], xy[1]);
  if (sub == TET_NONE) return 0;
  least = fmin(least, SQUEEZED * fmin(length(p->points, xy[0], xy[1]), length(p->points, d, e)));
  if (s->segment[s->subseg_segment[sub]].crease && least > 0) least = fmax(least, 4 * s->planarity); /* as thick as the facet */
  double gap = least;
  tet_break_consider(s, exact, p->points, sub, xy[0], xy[1], d, e, ret, &gap);
  return gap < least;
}

tet_status tet_find_thin(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, const tet_pieces *p,
                         const uint32_t *tri, double least, tet_breaks *breaks, size_t *ret_found) {
  size_t before = breaks->n;
  tet_status status = TET_OK;
  for (size_t t = 0; t < p->n_tets && status == TET_OK; t++)
    for (int i = 0; i < 4 && least > 0; i++)
      for (int j = 0; j < 4 && tri[4 * t + (size_t)i] != TET_NONE && status == TET_OK; j++) {
        tet_break b;
        if (j != i && must_break(surface, exact, p, tri, t, i, j, least, &b)) status = tet_breaks_add(ctx, breaks, &b);
      }
  *ret_found = breaks->n - before;
  tet_breaks_sort(breaks);
  return status;
}
