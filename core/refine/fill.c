// SPDX-License-Identifier: Apache-2.0
/* fill.c: retriangulates a trimmed cavity: one tetrahedron from p to each boundary
 * face, one subface from p to each rim edge, two subsegments for a split one.
 * Neighbours are found by turning around the boundary's edges through the old
 * tetrahedra, without hashing. */
#include "refine/refiner.h"

/* Face `by` of a new tetrahedron takes the place of face `was`. */
static void take_face(refiner *r, uint32_t by, uint32_t was) {
  uint32_t outer = r->tet_adj[was], s = r->tet_sub[was];
  r->tet_adj[by] = outer;
  if (outer != TET_NONE) r->tet_adj[outer] = by;
  r->tet_sub[by] = s;
  if (s == TET_NONE) return;
  uint32_t *side = r->sub_side + 2 * (size_t)s;
  side[side[0] != was] = by;
}

/* A tetrahedron p, f0, f1, f2 on boundary face h; tet_adj[h] becomes its number. */
static tet_status span_face(refiner *r, uint32_t h) {
  uint32_t n, t = h >> 2;
  tet_status status = refine_new_tet(r, &n);
  if (!status) status = refine_push(r, &r->cavity.faces_new, n);
  if (status) return status;
  const uint8_t *f = tet_face[h & 3];
  size_t at = 4 * (size_t)n;
  r->tet_v[at] = r->cavity.p;
  for (int j = 0; j < 3; j++) r->tet_v[at + 1 + j] = r->tet_v[4 * (size_t)t + f[j]];
  take_face(r, 4 * n, h);
  r->tet_region[n] = r->tet_region[t];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < i; j++)
      if (r->tet_edges[t] >> refine_edge_of[f[i]][f[j]] & 1)
        r->tet_edges[n] |= (uint8_t)(1 << refine_edge_of[i + 1][j + 1]);
  r->tet_adj[h] = n;
  return TET_OK;
}

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

/* Turns from boundary face h through the cavity around the edge of h without its
 * k-th vertex (0 to 2): to the next boundary face, or to a wall, or TET_NONE at the
 * domain's boundary, and over at most one rim edge. 0 if the cavity is folded there. */
static int turn(const refiner *r, uint32_t h, uint32_t k, uint32_t *ret_face, uint32_t *ret_rim) {
  uint32_t t = h >> 2, i = h & 3, j = tet_face[i][k], apex = r->tet_v[4 * (size_t)t + i];
  uint32_t a = r->tet_v[4 * (size_t)t + tet_face[i][(k + 1) % 3]];
  uint32_t b = r->tet_v[4 * (size_t)t + tet_face[i][(k + 2) % 3]];
  *ret_face = *ret_rim = TET_NONE;
  for (;;) {
    size_t exit = 4 * (size_t)t + j;
    if (r->tet_mark[t] >> j & 1) {
      *ret_face = (uint32_t)exit;
      return 1;
    }
    if (refine_is_wall(r, (uint32_t)exit)) {
      *ret_face = (uint32_t)exit;
      return 1;
    }
    if (r->tet_sub[exit] != TET_NONE) {
      if (*ret_rim != TET_NONE) return 0;
      *ret_rim = rim_edge(r, r->tet_sub[exit], a, b);
      if (*ret_rim == TET_NONE) return 0;
    }
    uint32_t next = r->tet_adj[exit];
    if (next == TET_NONE) return *ret_rim != TET_NONE;
    t = next >> 2;
    j = refine_corner(r, t, apex);
    apex = r->tet_v[4 * (size_t)t + (next & 3)];
  }
}

/* *ret_ok = 1 if the rim is one closed star in each patch, cut open at a split
 * subsegment alone, and every rim edge parts the boundary. Rounding can fold a
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
  for (uint32_t q = 0; q < c->faces.n && *ret_ok && !status; q++)
    for (uint32_t k = 0; k < 3 && *ret_ok; k++) {
      uint32_t face, rim;
      *ret_ok = turn(r, c->faces.at[q], k, &face, &rim);
      if (*ret_ok && rim != TET_NONE) c->rim_new.at[rim]++;
    }
  for (uint32_t k = 0; k < c->rim.n && *ret_ok && !status; k++) *ret_ok = c->rim_new.at[k] > 0;
  c->rim_new.n = 0;
  return status;
}

void refine_hang(refiner *r, uint32_t sub, uint32_t h) {
  r->tet_sub[h] = sub;
  uint32_t *side = r->sub_side + 2 * (size_t)sub;
  side[side[0] != TET_NONE] = h;
}

/* Finds what is beyond face k of the tetrahedron n that spans boundary face h: the
 * next boundary face around the edge, and the new subface on the way. */
static tet_status glue(refiner *r, uint32_t h, uint32_t n, uint32_t k) {
  uint32_t face, rim, here = 4 * n + k, there = TET_NONE;
  if (!turn(r, h, k - 1, &face, &rim)) return tet_internal(r->ctx, "a cavity is folded");
  if (face != TET_NONE && !(r->tet_mark[face >> 2] >> (face & 3) & 1)) { /* a wall */
    take_face(r, here, face);
    return TET_OK;
  }
  if (face != TET_NONE) {
    uint32_t m = r->tet_adj[face], corner = 1;
    const uint32_t *v = r->tet_v + 4 * (size_t)n;
    uint32_t a = v[k == 1 ? 2 : 1], b = v[k == 3 ? 2 : 3];
    while (r->tet_v[4 * (size_t)m + corner] == a || r->tet_v[4 * (size_t)m + corner] == b) corner++;
    there = 4 * m + corner;
    r->tet_adj[there] = here;
  }
  r->tet_adj[here] = there;
  if (rim == TET_NONE) return TET_OK;
  refine_hang(r, r->cavity.rim_new.at[rim], here);
  if (there != TET_NONE) refine_hang(r, r->cavity.rim_new.at[rim], there);
  return TET_OK;
}

/* Swaps what follows edge handles g and h: joins or parts their rings. */
void refine_link(refiner *r, uint32_t g, uint32_t h) {
  uint32_t next = r->ring[g];
  r->ring[g] = r->ring[h];
  r->ring[h] = next;
}

/* Edge `h` gives its place in its ring to `by`. */
void refine_replace_edge(refiner *r, uint32_t h, uint32_t by) {
  uint32_t before = h, e = r->sub_seg[h];
  while (r->ring[before] != h) before = r->ring[before];
  if (before != h) {
    r->ring[before] = by;
    r->ring[by] = r->ring[h];
    r->ring[h] = h;
  }
  r->sub_seg[by] = e;
  if (e != TET_NONE && r->seg_sub[e] == h) r->seg_sub[e] = by;
}

/* Puts edge handle h on new subsegment e. */
static void on_segment(refiner *r, uint32_t h, uint32_t e) {
  r->sub_seg[h] = e;
  if (r->seg_sub[e] == TET_NONE) r->seg_sub[e] = h;
  else refine_link(r, r->seg_sub[e], h);
}

static tet_status span_rim(refiner *r) {
  refine_cavity *c = &r->cavity;
  for (uint32_t k = 0; k < c->rim.n; k++) {
    uint32_t h = c->rim.at[k], n;
    tet_status status = refine_new_sub(r, &n);
    if (!status) status = refine_push(r, &c->rim_new, n);
    if (status) return status;
    r->sub_v[3 * (size_t)n] = r->sub_v[h];
    r->sub_v[3 * (size_t)n + 1] = r->sub_v[h - h % 3 + (h + 1) % 3];
    r->sub_v[3 * (size_t)n + 2] = c->p;
    r->sub_patch[n] = r->sub_patch[h / 3];
  }
  return TET_OK;
}

/* Rings of the new subfaces; e and f are the halves of a split subsegment. */
static tet_status link_rim(refiner *r, uint32_t e, uint32_t f) {
  refine_cavity *c = &r->cavity;
  uint32_t a = e == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)e];
  uint32_t b = e == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)f + 1];
  for (uint32_t k = 0; k < c->rim.n; k++) {
    uint32_t n = c->rim_new.at[k], x = r->sub_v[3 * (size_t)n], y = r->sub_v[3 * (size_t)n + 1];
    refine_replace_edge(r, c->rim.at[k], 3 * n);
    if (x == a || x == b) on_segment(r, 3 * n + 2, x == a ? e : f);
    if (y == a || y == b) {
      on_segment(r, 3 * n + 1, y == a ? e : f);
      continue;
    }
    uint32_t m = TET_NONE;
    for (uint32_t i = 0; i < c->rim.n; i++)
      if (r->sub_v[3 * (size_t)c->rim_new.at[i]] == y &&
          r->sub_patch[c->rim_new.at[i]] == r->sub_patch[n]) m = c->rim_new.at[i];
    if (m == TET_NONE || r->ring[3 * m + 2] != 3 * m + 2) return tet_internal(r->ctx, "a facet's cavity is no star");
    refine_link(r, 3 * n + 1, 3 * m + 2);
  }
  return TET_OK;
}

/* Subsegment e = ab becomes ap, and pb is *ret_half. */
static tet_status halve(refiner *r, uint32_t e, uint32_t *ret_half) {
  uint32_t f, p = r->cavity.p;
  tet_status status = refine_new_seg(r, &f);
  if (status) return status;
  r->seg_of[f] = r->seg_of[e];
  r->seg_v[2 * (size_t)f] = p;
  r->seg_v[2 * (size_t)f + 1] = r->seg_v[2 * (size_t)e + 1];
  r->seg_v[2 * (size_t)e + 1] = p;
  r->seg_sub[e] = TET_NONE;
  *ret_half = f;
  status = refine_enter_seg(r, e);
  return status ? status : refine_enter_seg(r, f);
}

/* Marks the subsegments at p in the new tetrahedra, and keeps the loose ones'
 * tetrahedra up to date. */
static void mark_edges(refiner *r, uint32_t e, uint32_t f, int loose) {
  refine_cavity *c = &r->cavity;
  uint32_t a = e == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)e];
  uint32_t b = e == TET_NONE ? TET_NONE : r->seg_v[2 * (size_t)f + 1];
  for (uint32_t k = 0; k < c->faces_new.n; k++) {
    uint32_t n = c->faces_new.at[k];
    const uint32_t *v = r->tet_v + 4 * (size_t)n;
    for (int i = 1; i < 4 && (e != TET_NONE || c->restar); i++)
      if (v[i] == a || v[i] == b || (c->restar && refine_find_seg(r, c->p, v[i]) != TET_NONE)) r->tet_edges[n] |= (uint8_t)(1 << refine_edge_of[0][i]);
    if (!loose) continue;
    for (int i = 0; i < 6; i++) {
      if (!(r->tet_edges[n] >> i & 1)) continue;
      uint32_t g = refine_find_seg(r, v[refine_edge[i][0]], v[refine_edge[i][1]]);
      if (r->seg_sub[g] != TET_NONE) continue;
      r->seg_tet[g] = n;
      r->tet_edges[n] |= EDGE_LOOSE;
    }
  }
}

/* Inserts p for good. */
tet_status refine_fill(refiner *r) {
  refine_cavity *c = &r->cavity;
  uint32_t e = c->segment, f = TET_NONE;
  int loose = 0;
  for (uint32_t k = 0; k < c->tets.n; k++)
    if (r->tet_mark[c->tets.at[k]] & MARK_IN) loose |= r->tet_edges[c->tets.at[k]] & EDGE_LOOSE;
  tet_status status = span_rim(r);
  for (uint32_t k = 0; k < c->faces.n && !status; k++) status = span_face(r, c->faces.at[k]);
  for (uint32_t q = 0; q < c->faces.n && !status; q++)
    for (uint32_t k = 1; k < 4 && !status; k++) {
      uint32_t here = 4 * c->faces_new.at[q] + k;
      if (r->tet_adj[here] == TET_NONE && r->tet_sub[here] == TET_NONE)
        status = glue(r, c->faces.at[q], c->faces_new.at[q], k);
    }
  if (!status && e != TET_NONE) status = halve(r, e, &f);
  if (!status) status = link_rim(r, e, f);
  if (status) return status;
  mark_edges(r, e, f, loose);
  if (!c->restar) refine_shepard(r, c->p, &c->vertices, &r->size[c->p], &r->sharp_size[c->p]);
  for (uint32_t k = 0; k < c->tets.n; k++) {
    uint32_t t = c->tets.at[k];
    if (r->tet_mark[t] & MARK_IN) refine_free_tet(r, t);
    else r->tet_mark[t] = 0;
  }
  for (uint32_t k = 0; k < c->touched.n; k++) r->tet_mark[c->touched.at[k]] = 0;
  for (uint32_t k = 0; k < c->subs.n; k++) refine_free_sub(r, c->subs.at[k]);
  c->touched.n = c->tets.n = c->subs.n = 0;
  return TET_OK;
}
