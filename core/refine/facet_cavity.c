// SPDX-License-Identifier: Apache-2.0
/* facet_cavity.c: the part of a cavity that lies in facets: which subfaces a
 * point on a segment or facet replaces. In-facet conflicts are insphere tests of
 * an adjacent tetrahedron, so that they agree with those in the volume, ties
 * included. The volume's part is in cavity.c. */
#include "refine/refiner.h"

static int in_conflict(const refiner *r, uint32_t s, uint32_t p) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)(r->sub_side[2 * (size_t)s] >> 2);
  return tet_insphere_sos(&r->points, v[0], v[1], v[2], v[3], p) > 0;
}

/* Adds the subfaces in conflict with p that are reached from those at hand
 * without crossing a subsegment. */
tet_status refine_facet_cavity_grow(refiner *r, refine_extent extent) {
  refine_cavity *c = &r->cavity;
  for (uint32_t k = 0; k < c->subs.n; k++) {
    c->is_part = extent == EXTENT_NEAR && c->subs.n > NEAR;
    if (c->is_part) break;
    uint32_t s = c->subs.at[k];
    for (uint32_t h = 3 * s; h < 3 * s + 3; h++) {
      if (r->sub_seg[h] != TET_NONE) continue;
      uint32_t u = r->ring[h] / 3;
      if (r->sub_mark[u] & 1 || !in_conflict(r, u, c->p)) continue;
      tet_status status = refine_push(r, &c->subs, u);
      if (status) return status;
      r->sub_mark[u] |= 1;
    }
  }
  r->searched += c->subs.n;
  return TET_OK;
}

/* 1 if edge h of a replaced subface stays an edge and must see p. */
static int on_rim(const refiner *r, uint32_t h) {
  if (r->sub_seg[h] != TET_NONE) return r->sub_seg[h] != r->cavity.segment;
  return !(r->sub_mark[r->ring[h] / 3] & 1);
}

static int sees(const refiner *r, uint32_t h) {
  uint32_t s = h / 3, p = r->cavity.p, a = r->sub_v[h], b = r->sub_v[3 * s + (h + 1) % 3];
  if (tet_orient2d(&r->points, r->patch[r->sub_patch[s]].axis, a, b, p) <= 0) return 0;
  if (r->cavity.segment == TET_NONE) return 1;
  uint32_t segment = r->seg_of[r->cavity.segment];
  return !(refine_on_segment(r, a, segment) && refine_on_segment(r, b, segment));
}

/* Takes subfaces out until every rim edge sees p strictly; 0 if one of the first
 * subfaces would have to go. */
int refine_facet_cavity_trim(refiner *r) {
  refine_cavity *c = &r->cavity;
  int again = 1;
  while (again) {
    again = 0;
    uint32_t n = 0;
    for (uint32_t k = 0; k < c->subs.n; k++) {
      uint32_t s = c->subs.at[k];
      int ok = 1;
      for (uint32_t h = 3 * s; h < 3 * s + 3 && ok; h++) ok = !on_rim(r, h) || sees(r, h);
      if (!ok && r->sub_mark[s] & 2) {
        r->exact = 0;
        for (; k < c->subs.n; k++) c->subs.at[n++] = c->subs.at[k];
        c->subs.n = n;
        return 0;
      }
      if (ok) {
        c->subs.at[n++] = s;
      } else {
        r->sub_mark[s] &= (uint8_t)~1;
        r->exact = 0;
        again = 1;
      }
    }
    c->subs.n = n;
  }
  return 1;
}

/* Leaves the first subfaces alone. */
void refine_facet_cavity_least(refiner *r) {
  refine_cavity *c = &r->cavity;
  uint32_t n = 0;
  for (uint32_t k = 0; k < c->subs.n; k++) {
    uint32_t s = c->subs.at[k];
    if (r->sub_mark[s] & 2) c->subs.at[n++] = s;
    else r->sub_mark[s] &= (uint8_t)~1;
  }
  c->subs.n = n;
}

tet_status refine_facet_cavity_rim(refiner *r) {
  refine_cavity *c = &r->cavity;
  c->rim.n = 0;
  for (uint32_t k = 0; k < c->subs.n; k++)
    for (uint32_t h = 3 * c->subs.at[k]; h < 3 * c->subs.at[k] + 3; h++) {
      if (!on_rim(r, h)) continue;
      tet_status status = refine_push(r, &c->rim, h);
      if (status) return status;
    }
  return TET_OK;
}
