// SPDX-License-Identifier: Apache-2.0
/* sound.c: whether a trimmed cavity of a point in facets can be filled: its rim a star in
 * each patch, its border parted by the rim. Decides by incidence; changes nothing. And whether
 * what fills a trimmed cavity is constrained Delaunay. */
#include "refine/refiner.h"

/* The rim edge ab of replaced subface s, or TET_NONE. */
static uint32_t rim_edge(const refiner *r, uint32_t s, uint32_t a, uint32_t b) {
  const refine_cavity *c = &r->cavity;
  for (uint32_t k = 0; k < c->rim.n; k++) {
    uint32_t h = c->rim.at[k];
    if (h / 3 != s) continue;
    uint32_t x = r->sub_v[h], y = r->sub_v[3 * s + (h + 1) % 3];
    if ((x == a && y == b) || (x == b && y == a)) return k;
  }
  return TET_NONE;
}

/* Turns from border face h through the cavity around the edge of h without its k-th
 * vertex (0 to 2), to the next border face, *ret_end, or the domain's boundary, TET_NONE, and over at
 * most one rim edge, *ret_rim. 0 if the cavity is folded there. */
static int turn(const refiner *r, uint32_t h, uint32_t k, uint32_t *ret_rim, uint32_t *ret_end) {
  uint32_t t = h >> 2, i = h & 3, j = tet_face[i][k], apex = r->mesh.v[4 * (size_t)t + i];
  uint32_t a = r->mesh.v[4 * (size_t)t + tet_face[i][(k + 1) % 3]];
  uint32_t b = r->mesh.v[4 * (size_t)t + tet_face[i][(k + 2) % 3]];
  *ret_rim = *ret_end = TET_NONE;
  for (;;) {
    uint32_t exit = 4 * t + j;
    if (refine_is_border(r, exit)) {
      *ret_end = exit;
      return 1;
    }
    if (refine_sub_at(r, exit) != TET_NONE) {
      if (*ret_rim != TET_NONE) return 0;
      *ret_rim = rim_edge(r, refine_sub_at(r, exit), a, b);
      if (*ret_rim == TET_NONE) return 0;
    }
    uint32_t next = r->mesh.adj[exit];
    if (next == TET_NONE) return *ret_rim != TET_NONE;
    t = next >> 2;
    j = refine_corner(r, t, apex);
    apex = r->mesh.v[4 * (size_t)t + (next & 3)];
  }
}

/* Stamps the vertices of replaced subfaces. */
static void mark_replaced(refiner *r) {
  uint32_t now = ++r->stamp_now;
  for (uint32_t k = 0; k < r->cavity.subs.n; k++)
    for (size_t h = 3 * (size_t)r->cavity.subs.at[k]; h < 3 * (size_t)r->cavity.subs.at[k] + 3; h++)
      r->stamp[r->sub_v[h]] = now;
}

/* 0 if border face b shares its edge without its k-th vertex with no replaced subface, and so with nothing that a turn
 * around it could find. */
static int may_turn(const refiner *r, const tet_border *b, uint32_t k) {
  const uint8_t *f = tet_face[b->inner & 3];
  return r->stamp[b->v[f[(k + 1) % 3]]] == r->stamp_now && r->stamp[b->v[f[(k + 2) % 3]]] == r->stamp_now;
}

/* *ret_ok = 1 if the rim is one closed star in each patch, cut open at a split
 * subsegment alone, and every rim edge parts the border. Rounding can fold a
 * cavity at needles; such a one is not filled. Changes rim_new. */
tet_status refine_cavity_is_sound(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  uint32_t a = c->segment == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)c->segment];
  uint32_t b = c->segment == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)c->segment + 1];
  *ret_ok = 1;
  c->rim_new.n = 0;
  for (uint32_t k = 0; k < c->rim.n && !status; k++) {
    uint32_t h = c->rim.at[k], s = h / 3, x = r->sub_v[h], y = r->sub_v[3 * s + (h + 1) % 3], before = 0, after = 0;
    for (uint32_t i = 0; i < c->rim.n; i++) {
      uint32_t g = c->rim.at[i], u = g / 3;
      if (r->sub_patch[u] != r->sub_patch[s]) continue;
      after += r->sub_v[g] == y;
      before += r->sub_v[3 * u + (g + 1) % 3] == x;
    }
    if ((y != a && y != b && after != 1) || (x != a && x != b && before != 1)) *ret_ok = 0;
    status = refine_push(r, &c->rim_new, 0);
  }
  mark_replaced(r);
  for (size_t q = 0; q < r->mesh.n_border && *ret_ok && !status; q++)
    for (uint32_t k = 0; k < 3 && *ret_ok; k++) {
      uint32_t rim, end;
      if (!may_turn(r, &r->mesh.border[q], k)) continue;
      *ret_ok = turn(r, r->mesh.border[q].inner, k, &rim, &end);
      if (*ret_ok && rim != TET_NONE) c->rim_new.at[rim]++;
    }
  for (uint32_t k = 0; k < c->rim.n && *ret_ok && !status; k++) *ret_ok = c->rim_new.at[k] > 0;
  c->rim_new.n = 0;
  return status;
}

/* 1 if every face that filling the trimmed cavity makes, but for subfaces, is locally Delaunay: its border, beyond which
 * tetrahedra in conflict can be left, and what its tetrahedra share. */
int refine_cavity_is_delaunay(const refiner *r) {
  const tet_complex *m = &r->mesh;
  for (size_t q = 0; q < m->n_border; q++) {
    const tet_border *b = &m->border[q];
    uint32_t t = b->inner >> 2;
    const uint8_t *f = tet_face[b->inner & 3];
    if (refine_sub_at(r, b->inner) == TET_NONE && tet_complex_conflict(m, b->outer >> 2, r->cavity.p)) return 0;
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t rim, end;
      if (!turn(r, b->inner, k, &rim, &end)) return 0;
      if (rim != TET_NONE || end == TET_NONE) continue;
      const uint32_t *v = m->v + 4 * (size_t)(end >> 2);
      const uint8_t *g = tet_face[end & 3];
      uint32_t apex = v[g[0]] ^ v[g[1]] ^ v[g[2]]; /* of the two that they share, and this */
      for (uint32_t j = 1; j < 3; j++) apex ^= m->v[4 * (size_t)t + f[(k + j) % 3]];
      if (tet_insphere_sos(&r->points, b->v[0], b->v[1], b->v[2], b->v[3], apex) > 0) return 0;
    }
  }
  return 1;
}
