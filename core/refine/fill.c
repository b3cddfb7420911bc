// SPDX-License-Identifier: Apache-2.0
/* fill.c: retriangulates a trimmed cavity: tetrahedra from p to its border by the kernel,
 * one subface from p to each rim edge, two subsegments for a split one; and hands on what
 * the faces, edges and tetrahedra there carry. */
#include "refine/refiner.h"

/* The edges that face i shares, of refine_edge. */
static const uint8_t edges_of_face[4] = {0x38, 0x26, 0x15, 0x0b};

void refine_hang(refiner *r, uint32_t sub, uint32_t h) {
  r->tet_sub[h] = sub;
  r->mesh.wall[h >> 2] |= (uint8_t)(1 << (h & 3));
  uint32_t *side = r->sub_side + 2 * (size_t)sub;
  side[side[0] != TET_NONE] = h;
}

/* Subface s, which face `was` had, is at face h now. */
void refine_take_sub(refiner *r, uint32_t s, uint32_t was, uint32_t h) {
  r->tet_sub[h] = s;
  r->mesh.wall[h >> 2] |= (uint8_t)(1 << (h & 3));
  uint32_t *side = r->sub_side + 2 * (size_t)s;
  side[side[0] != was] = h;
}

/* Notes what the new tetrahedra take over, before their slots are written. */
static tet_status note(refiner *r) {
  refine_cavity *c = &r->cavity;
  const tet_complex *m = &r->mesh;
  tet_status status = tet_grow(r->ctx, &c->carry, &c->cap_carry, m->n_border, sizeof *c->carry);
  for (size_t k = 0; k < m->n_border && !status; k++) {
    uint32_t h = m->border[k].inner, t = h >> 2;
    c->carry[k] = (refine_carry){refine_sub_at(r, h), r->tet_region[t], r->tet_edges[t] & edges_of_face[h & 3]};
  }
  c->n_spokes = 0;
  for (size_t k = 0; k < m->n_cavity && c->restar && !status; k++)
    for (uint32_t h = 4 * m->cavity[k]; h < 4 * m->cavity[k] + 4 && !status; h++) {
      if (!refine_is_spoke(r, h)) continue;
      status = tet_grow(r->ctx, &c->spoke, &c->cap_spoke, (size_t)c->n_spokes + 1, sizeof *c->spoke);
      if (status) break;
      refine_spoke *s = &c->spoke[c->n_spokes++];
      *s = (refine_spoke){TET_NONE, TET_NONE, refine_sub_at(r, h), h, m->adj[h]};
      for (int j = 0; j < 3; j++) {
        uint32_t v = m->v[(h & ~(size_t)3) + tet_face[h & 3][j]];
        if (v != c->p) s->b = s->a, s->a = v;
      }
    }
  return status;
}

/* Gives face h = p, a, b of a new tetrahedron the rim's new subface, or the one that it has had
 * since before. Both are known by the edge ab. */
static tet_status fit_face(refiner *r, uint32_t h, uint32_t a, uint32_t b) {
  refine_cavity *c = &r->cavity;
  for (uint32_t k = 0; k < c->rim.n; k++) {
    const uint32_t s = c->rim_new.at[k], *v = r->sub_v + 3 * (size_t)s;
    if ((v[0] != a || v[1] != b) && (v[0] != b || v[1] != a)) continue;
    if (r->sub_side[2 * (size_t)s + 1] != TET_NONE) return tet_internal(r->ctx, "a subface with three sides");
    refine_hang(r, s, h);
    return TET_OK;
  }
  for (uint32_t k = 0; k < c->n_spokes; k++) {
    const refine_spoke *s = &c->spoke[k];
    if ((s->a != a || s->b != b) && (s->a != b || s->b != a)) continue;
    r->mesh.adj[h] = s->outer;
    if (s->outer != TET_NONE) r->mesh.adj[s->outer] = h;
    refine_take_sub(r, s->sub, s->inner, h);
    return TET_OK;
  }
  return r->mesh.adj[h] == TET_NONE ? tet_internal(r->ctx, "a cavity is folded") : TET_OK;
}

/* fit_face for all faces at p; most are none that it knows, as their edges have other ends than all of those. */
static tet_status fit_faces(refiner *r) {
  const refine_cavity *c = &r->cavity;
  const tet_complex *m = &r->mesh;
  uint32_t now = ++r->stamp_now;
  for (uint32_t k = 0; k < c->rim.n; k++)
    for (int j = 0; j < 2; j++) r->stamp[r->sub_v[3 * (size_t)c->rim_new.at[k] + j]] = now;
  for (uint32_t k = 0; k < c->n_spokes; k++) r->stamp[c->spoke[k].a] = r->stamp[c->spoke[k].b] = now;
  for (uint32_t k = 0; k < c->n_made; k++) {
    const tet_border *b = &m->border[k];
    const uint8_t *f = tet_face[b->inner & 3];
    for (int j = 0; j < 3; j++) {
      uint32_t h = 4 * m->cavity[k] + f[j], v = b->v[f[(j + 1) % 3]], w = b->v[f[(j + 2) % 3]];
      if (m->adj[h] != TET_NONE && (r->stamp[v] != now || r->stamp[w] != now)) continue;
      tet_status status = fit_face(r, h, v, w);
      if (status) return status;
    }
  }
  return TET_OK;
}

/* Gives the new tetrahedra what belongs to them. */
static tet_status furnish(refiner *r) {
  refine_cavity *c = &r->cavity;
  tet_complex *m = &r->mesh;
  c->n_made = (uint32_t)m->n_border;
  for (uint32_t k = 0; k < c->n_made; k++) {
    const refine_carry *carry = &c->carry[k];
    uint32_t n = m->cavity[k], inner = m->border[k].inner;
    r->tet_region[n] = carry->region;
    r->tet_edges[n] = carry->edges;
    m->wall[n] = 0;
    if (carry->sub != TET_NONE) refine_take_sub(r, carry->sub, inner, 4 * n + (inner & 3));
  }
  return c->rim.n || c->n_spokes ? fit_faces(r) : TET_OK;
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

/* Puts edge handle h, in no ring yet, on subsegment e. */
void refine_on_segment_edge(refiner *r, uint32_t h, uint32_t e) {
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
    if (x == a || x == b) refine_on_segment_edge(r, 3 * n + 2, x == a ? e : f);
    if (y == a || y == b) {
      refine_on_segment_edge(r, 3 * n + 1, y == a ? e : f);
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
  if (e == TET_NONE && !c->restar && !loose) return;
  for (uint32_t k = 0; k < c->n_made; k++) {
    uint32_t n = r->mesh.cavity[k], p = r->mesh.border[k].inner & 3;
    const uint32_t *v = r->mesh.v + 4 * (size_t)n;
    for (uint32_t i = 0; i < 4; i++)
      if (i != p && (v[i] == a || v[i] == b || (c->restar && refine_find_seg(r, c->p, v[i]) != TET_NONE)))
        r->tet_edges[n] |= (uint8_t)(1 << refine_edge_of[p][i]);
    for (int i = 0; i < 6 && loose; i++) {
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
  for (size_t k = 0; k < r->mesh.n_cavity; k++) loose |= r->tet_edges[r->mesh.cavity[k]] & EDGE_LOOSE;
  tet_status status = span_rim(r);
  if (!status) status = note(r);
  if (!status) status = refine_reserve_tets(r, r->mesh.n_border);
  if (!status) status = tet_complex_fill(&r->mesh);
  if (!status) status = furnish(r);
  if (!status && e != TET_NONE) status = halve(r, e, &f);
  if (!status) status = link_rim(r, e, f);
  if (status) return status;
  mark_edges(r, e, f, loose);
  if (!c->restar) refine_shepard(r, c->p, &c->vertices, &r->size[c->p], &r->sharp_size[c->p]);
  for (uint32_t k = 0; k < c->subs.n; k++) refine_free_sub(r, c->subs.at[k]);
  c->subs.n = 0;
  r->mesh.n_cavity = r->mesh.n_border = 0; /* nothing is left to be cleared */
  return TET_OK;
}
