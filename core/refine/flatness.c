// SPDX-License-Identifier: Apache-2.0
/* flatness.c: what lies on one segment, facet or plane of facets, decided by incidence.
 * Rounded Steiner points are off their line or plane by some last bits, so signs
 * cannot tell; a tetrahedron of four such points has a volume of nothing. And whether any point
 * is off, by signs. */
#include "refine/refiner.h"

#include "base/vector.h"

/* The facets that vertex v is on: from *ret_at to the end returned. */
static const uint32_t *facets_of(const refiner *r, uint32_t v, const uint32_t **ret_at) {
  const uint32_t *start = r->vertex_facet_start, *item = r->vertex_facet;
  uint32_t k = v;
  *ret_at = NULL;
  if (v >= r->n_first) {
    if (r->out->origin[v] == TET_ORIGIN_VOLUME) return NULL;
    *ret_at = &r->out->carrier[v];
    if (r->out->origin[v] == TET_ORIGIN_FACET) return *ret_at + 1;
    start = r->segment_facet_start;
    item = r->segment_facet;
    k = **ret_at;
  }
  *ret_at = item + start[k];
  return item + start[k + 1];
}

int refine_on_facet(const refiner *r, uint32_t v, uint32_t facet) {
  const uint32_t *at, *end = facets_of(r, v, &at);
  while (at < end && *at != facet) at++;
  return at < end;
}

int refine_on_segment(const refiner *r, uint32_t v, uint32_t segment) {
  const tet_segment *s = &r->out->segment[segment];
  return v == s->a || v == s->b || (r->out->origin[v] == TET_ORIGIN_SEGMENT && r->out->carrier[v] == segment);
}

/* 1 if the segments have an end in common. */
int refine_segments_meet(const refiner *r, uint32_t s, uint32_t t) {
  const tet_segment *f = &r->out->segment[s], *g = &r->out->segment[t];
  return f->a == g->a || f->a == g->b || f->b == g->a || f->b == g->b;
}

/* 1 if the facets have a vertex of the CDT in common. */
int refine_facets_meet(const refiner *r, uint32_t f, uint32_t g) {
  const uint32_t *start = r->facet_vertex_start;
  if (start[f + 1] - start[f] > start[g + 1] - start[g]) return refine_facets_meet(r, g, f);
  for (uint32_t i = start[f]; i < start[f + 1]; i++)
    if (refine_on_facet(r, r->facet_vertex[i], g)) return 1;
  return 0;
}

int refine_all_on_facet(const refiner *r, const uint32_t v[4], uint32_t facet) {
  return refine_on_facet(r, v[0], facet) && refine_on_facet(r, v[1], facet) && refine_on_facet(r, v[2], facet) &&
         refine_on_facet(r, v[3], facet);
}

static int on_plane(const refiner *r, uint32_t v, uint32_t plane) {
  const uint32_t *at, *end = facets_of(r, v, &at);
  while (at < end && r->facet_plane[*at] != plane) at++;
  return at < end;
}

static inline int is_in_volume(const refiner *r, uint32_t v) {
  return r->out->origin[v] == TET_ORIGIN_VOLUME && v >= r->n_first;
}

/* 1 if three vertices lie on facets of one plane. */
static int all_on_plane(const refiner *r, const uint32_t v[3], uint32_t plane) {
  return on_plane(r, v[0], plane) && on_plane(r, v[1], plane) && on_plane(r, v[2], plane);
}

/* 1 if four vertices, v[0] the one on the fewest polytopes, lie on facets of one plane, or
 * three of them on one segment: those of v[0]. */
int refine_is_flat(const refiner *r, const uint32_t v[4]) {
  uint8_t origin = r->out->origin[v[0]];
  uint32_t carrier = r->out->carrier[v[0]];
  int on = 0, off = is_in_volume(r, v[1]) || is_in_volume(r, v[2]) || is_in_volume(r, v[3]);
  if (origin == TET_ORIGIN_FACET) return !off && all_on_plane(r, v + 1, r->facet_plane[carrier]);
  if (origin != TET_ORIGIN_SEGMENT) return 0;
  for (int i = 1; i < 4; i++) on += refine_on_segment(r, v[i], carrier);
  if (on > 1) return 1;
  for (uint32_t i = r->segment_facet_start[carrier]; i < r->segment_facet_start[carrier + 1] && !off; i++)
    if (all_on_plane(r, v + 1, r->facet_plane[r->segment_facet[i]])) return 1;
  return 0;
}

/* 1 if v is a positive tetrahedron that rounding alone did not make so. */
int refine_is_positive(const refiner *r, const uint32_t v[4]) {
  if (tet_orient3d(&r->points, v[0], v[1], v[2], v[3]) <= 0) return 0;
  for (int i = 0; i < 4; i++) {
    uint32_t w[4] = {v[i], v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4]};
    if (refine_is_flat(r, w)) return 0;
  }
  return 1;
}

/* 1 if every patch is flat to the last bit. */
int refine_facets_are_flat(const refiner *r) {
  for (uint32_t h = 0; h < 3 * r->n_subs; h++) {
    uint32_t g = r->ring[h];
    if (r->sub_v[3 * (h / 3)] == TET_NONE || r->sub_seg[h] != TET_NONE || g < h) continue;
    const uint32_t *v = r->sub_v + 3 * (size_t)(h / 3);
    if (tet_orient3d(&r->points, v[0], v[1], v[2], r->sub_v[3 * (g / 3) + (g + 2) % 3]) != 0) return 0;
  }
  return 1;
}

/* 1 if the trimmed cavity is the conflict region of its point, which lies exactly in what it
 * splits. */
int refine_cavity_is_exact(const refiner *r) {
  const refine_cavity *c = &r->cavity;
  if (c->reshaped) return 0;
  for (uint32_t k = 0; k < c->subs.n; k++) {
    const uint32_t *v = r->sub_v + 3 * (size_t)c->subs.at[k];
    if (tet_orient3d(&r->points, v[0], v[1], v[2], c->p) != 0) return 0;
  }
  if (c->segment == TET_NONE) return 1;
  uint32_t a = r->seg_v[2 * (size_t)c->segment], b = r->seg_v[2 * (size_t)c->segment + 1];
  for (int axis = 0; axis < 3; axis++)
    if (tet_orient2d(&r->points, axis, a, b, c->p) != 0) return 0;
  return 1;
}

/* Three input vertices of facet f that are far from collinear; 0: there are none, as of one that another
 * takes the place of. */
static int base_of(const refiner *r, uint32_t f, uint32_t ret[3]) {
  double far2[2] = {0, 0};
  ret[0] = ret[1] = ret[2] = 0;
  for (int step = 0; step < 3; step++)
    for (uint32_t i = r->facet_vertex_start[f]; i < r->facet_vertex_start[f + 1]; i++) {
      uint32_t v = r->facet_vertex[i];
      if (v >= r->out->n_input) continue;
      if (!step) {
        ret[0] = v;
        break;
      }
      const double *a = refine_x(r, ret[0]), *x = refine_x(r, v);
      double reach2 = tet_distance2(a, x);
      if (step == 2) {
        double e[3], d[3], n[3];
        tet_minus(refine_x(r, ret[1]), a, e);
        tet_minus(x, a, d);
        tet_cross(e, d, n);
        reach2 = tet_square(n);
      }
      if (reach2 <= far2[step - 1 > 0]) continue;
      far2[step - 1 > 0] = reach2;
      ret[step] = v;
    }
  return far2[0] > 0 && far2[1] > 0;
}

/* 1 if all input vertices of facet f are exactly in the plane of the three. */
static int is_in_plane(const refiner *r, uint32_t f, const uint32_t base[3]) {
  for (uint32_t i = r->facet_vertex_start[f]; i < r->facet_vertex_start[f + 1]; i++) {
    uint32_t v = r->facet_vertex[i];
    if (v >= r->out->n_input || v == base[0] || v == base[1] || v == base[2]) continue;
    if (tet_orient3d(&r->points, base[0], base[1], base[2], v) != 0) return 0;
  }
  return 1;
}

/* The first of the facets joined with f; halves the way there. */
static uint32_t plane_of(uint32_t *plane, uint32_t f) {
  for (; plane[f] != f; f = plane[f]) plane[f] = plane[plane[f]];
  return f;
}

/* Facets that are exactly coplanar and share a segment have the same plane, as those of two markers do
 * side by side: what rounding makes of four points on them is no tetrahedron either. */
tet_status refine_find_planes(refiner *r) {
  uint32_t n = r->out->n_facets, *plane = r->facet_plane = tet_alloc(r->ctx, n, sizeof *plane);
  uint32_t(*base)[3] = tet_alloc(r->ctx, n, sizeof *base);
  uint8_t *is_plane = tet_calloc(r->ctx, n, 1);
  tet_status status = plane && base && is_plane ? tet_poll(r->ctx) : TET_E_MEMORY;
  for (uint32_t f = 0; f < n && !status; f++) {
    plane[f] = f;
    is_plane[f] = base_of(r, f, base[f]) && is_in_plane(r, f, base[f]);
  }
  for (uint32_t s = 0; s < r->out->n_segments && !status; s++)
    for (uint32_t i = r->segment_facet_start[s]; i < r->segment_facet_start[s + 1]; i++)
      for (uint32_t j = r->segment_facet_start[s]; j < i && is_plane[r->segment_facet[i]]; j++) {
        uint32_t f = plane_of(plane, r->segment_facet[i]), g = plane_of(plane, r->segment_facet[j]);
        if (f != g && is_plane[g] && is_in_plane(r, g, base[f])) plane[f < g ? g : f] = f < g ? f : g;
      }
  for (uint32_t f = 0; f < n && !status; f++) plane[f] = plane_of(plane, f);
  tet_free(r->ctx, base);
  tet_free(r->ctx, is_plane);
  return status;
}
