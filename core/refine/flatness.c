// SPDX-License-Identifier: Apache-2.0
/* flatness.c: what lies on one segment or one facet, decided by incidence.
 * Rounded Steiner points are off their line or plane by some last bits, so signs
 * cannot tell; a tetrahedron of four such points has a volume of nothing. And whether any point
 * is off, by signs. */
#include "refine/refiner.h"

int refine_on_facet(const refiner *r, uint32_t v, uint32_t facet) {
  const uint32_t *at, *end;
  if (v < r->n_first) {
    at = r->vertex_facet + r->vertex_facet_start[v];
    end = r->vertex_facet + r->vertex_facet_start[v + 1];
  } else if (r->out->origin[v] == TET_ORIGIN_FACET) {
    return r->out->carrier[v] == facet;
  } else if (r->out->origin[v] == TET_ORIGIN_SEGMENT) {
    uint32_t segment = r->out->carrier[v];
    at = r->segment_facet + r->segment_facet_start[segment];
    end = r->segment_facet + r->segment_facet_start[segment + 1];
  } else {
    return 0;
  }
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

/* 1 if four vertices, v[0] the one on the fewest polytopes, lie on one facet, or
 * three of them on one segment. */
int refine_is_flat(const refiner *r, const uint32_t v[4]) {
  uint8_t origin = r->out->origin[v[0]];
  uint32_t carrier = r->out->carrier[v[0]];
  if (origin == TET_ORIGIN_FACET) return refine_all_on_facet(r, v, carrier);
  if (origin == TET_ORIGIN_SEGMENT) {
    int on = 0;
    for (int i = 0; i < 4; i++) on += refine_on_segment(r, v[i], carrier);
    if (on > 2) return 1;
    for (uint32_t i = r->segment_facet_start[carrier]; i < r->segment_facet_start[carrier + 1]; i++)
      if (refine_all_on_facet(r, v, r->segment_facet[i])) return 1;
  }
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
