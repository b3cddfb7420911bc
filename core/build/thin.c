// SPDX-License-Identifier: Apache-2.0
/* thin.c: break points for tetrahedra squeezed between nearly coplanar facets.
 *
 * Where two facets meet at almost 180 degrees, the CDT may hold a tetrahedron on
 * both whose other two faces lie on them as well, but for far less than any size
 * that matters. It is exact, and useless. A Steiner point on the common segment,
 * where the tetrahedron's opposite edge passes, takes that edge out of the Delaunay
 * tetrahedralization. These are break points like those of thesis 5.5, chosen for
 * what is nearly degenerate; only lengths decide, in doubles. */
#include "build/thin.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"

/* The distance between lines xy and de, and where on xy they are nearest. */
static double gap(const double *x, const double *y, const double *d, const double *e, double *ret_s) {
  double u[3], v[3], w[3], n[3];
  tet_minus(y, x, u);
  tet_minus(e, d, v);
  tet_minus(d, x, w);
  tet_cross(u, v, n);
  double nn = tet_dot(n, n), wv[3];
  if (!(nn > 0)) return INFINITY;
  tet_cross(w, v, wv);
  *ret_s = tet_dot(wv, n) / nn;
  return fabs(tet_dot(w, n)) / sqrt(nn);
}

/* The place of vertex v on segment g. */
static double parameter(const tet_points *exact, const tet_segment *g, uint32_t v) {
  return v == g->a ? 0 : v == g->b ? 1 : exact->implicit[v - exact->first_implicit].t;
}

/* The subsegment at edge xy of triangle k, or TET_NONE. */
static uint32_t subsegment_of(const tet_surface *s, uint32_t k, uint32_t x, uint32_t y) {
  for (size_t j = 0; j < 3; j++) {
    uint32_t a = s->tri[3 * (size_t)k + j], b = s->tri[3 * (size_t)k + (j + 1) % 3];
    if ((a == x && b == y) || (a == y && b == x)) return s->tri_seg[3 * (size_t)k + j];
  }
  return TET_NONE;
}

static int compare(const void *pa, const void *pb) {
  const tet_break *a = pa, *b = pb;
  if (a->segment != b->segment) return a->segment < b->segment ? -1 : 1;
  return a->t < b->t ? -1 : a->t > b->t;
}

/* If faces i and j of tetrahedron t are subfaces with a subsegment between them and
 * t is flat, sets *ret to the place to break and returns 1. */
static int must_break(const tet_surface *s, const tet_points *exact, const tet_pieces *p, const uint32_t *tri,
                      size_t t, int i, int j, double least, tet_break *ret) {
  uint32_t k = tri[4 * t + (size_t)i], other = tri[4 * t + (size_t)j];
  if (k == TET_NONE || other == TET_NONE) return 0;
  uint32_t xy[2], n = 0, d = p->tets[4 * t + (size_t)i], e = p->tets[4 * t + (size_t)j];
  for (int c = 0; c < 3; c++) {
    uint32_t v = p->tets[4 * t + tet_face[i][c]];
    if (v != e) xy[n++] = v;
  }
  uint32_t sub = subsegment_of(s, k, xy[0], xy[1]);
  double at = 0.5;
  if (sub == TET_NONE) return 0;
  const tet_segment *g = &s->segment[s->subseg_segment[sub]];
  double height = gap(p->points + 3 * (size_t)xy[0], p->points + 3 * (size_t)xy[1], p->points + 3 * (size_t)d,
                      p->points + 3 * (size_t)e, &at);
  if (g->crease && least > 0 && least < 4 * s->planarity) least = 4 * s->planarity; /* as thick as the facet */
  if (!(height < least) || !(at > 0 && at < 1)) return 0;
  double t0 = parameter(exact, g, xy[0]), t1 = parameter(exact, g, xy[1]);
  *ret = (tet_break){s->subseg_segment[sub], t0 + fmin(fmax(at, 0.125), 0.875) * (t1 - t0)};
  return 1;
}

tet_status tet_find_thin(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, const tet_pieces *p,
                         const uint32_t *tri, double least, tet_breaks *breaks, size_t *ret_found) {
  size_t before = breaks->n;
  tet_status status = TET_OK;
  for (size_t t = 0; t < p->n_tets && status == TET_OK; t++)
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4 && status == TET_OK; j++) {
        tet_break b;
        if (!must_break(surface, exact, p, tri, t, i, j, least, &b)) continue;
        status = tet_grow(ctx, &breaks->at, &breaks->cap, breaks->n + 1, sizeof *breaks->at);
        if (status == TET_OK) breaks->at[breaks->n++] = b;
      }
  *ret_found = breaks->n - before;
  if (*ret_found) qsort(breaks->at, breaks->n, sizeof *breaks->at, compare);
  return status;
}
