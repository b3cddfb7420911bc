// SPDX-License-Identifier: Apache-2.0
/* cavity.c: the region that a candidate retriangulates (Bowyer-Watson), bounded
 * by subfaces, and made strictly visible from the candidate: first by taking
 * tetrahedra out, then, where one is needed, by taking the next one in. Changes
 * nothing of the mesh; fill.c does. */
#include "refine/refiner.h"

static tet_status start(refiner *r, uint32_t p) {
  refine_cavity *c = &r->cavity;
  c->p = p;
  c->segment = c->sub = TET_NONE;
  c->reshaped = c->restar = 0;
  c->tets.n = c->touched.n = c->subs.n = c->rim.n = c->rim_new.n = 0;
  c->faces.n = c->faces_new.n = c->vertices.n = 0;
  return TET_OK;
}

static tet_status add_tet(refiner *r, uint32_t t, uint8_t mark) {
  if (r->tet_mark[t] & MARK_IN) {
    r->tet_mark[t] |= mark;
    return TET_OK;
  }
  r->tet_mark[t] = (uint8_t)(r->tet_mark[t] | MARK_IN | mark);
  return refine_push(r, &r->cavity.tets, t);
}

/* Adds all tetrahedra in conflict with p that are reached without crossing a
 * subface. */
static tet_status grow(refiner *r) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < c->tets.n && !status; k++) {
    uint32_t t = c->tets.at[k];
    for (uint32_t h = 4 * t; h < 4 * t + 4 && !status; h++) {
      if (r->tet_sub[h] != TET_NONE) continue;
      uint32_t u = r->tet_adj[h] >> 2;
      if (r->tet_mark[u] & (MARK_IN | MARK_OUT)) continue;
      const uint32_t *v = r->tet_v + 4 * (size_t)u;
      if (tet_insphere_sos(&r->points, v[0], v[1], v[2], v[3], c->p) > 0) {
        status = add_tet(r, u, 0);
      } else {
        r->tet_mark[u] |= MARK_OUT;
        status = refine_push(r, &c->touched, u);
      }
    }
  }
  return status;
}

tet_status refine_cavity_of_tet(refiner *r, uint32_t p, uint32_t tet) {
  tet_status status = start(r, p);
  if (!status) status = add_tet(r, tet, MARK_NEEDED);
  return status ? status : grow(r);
}

/* For vertex p anew: its tetrahedra from `tet` on, up to subfaces, which stay, and
 * all in conflict with it. */
tet_status refine_cavity_of_star(refiner *r, uint32_t p, uint32_t tet) {
  refine_cavity *c = &r->cavity;
  tet_status status = start(r, p);
  c->restar = 1;
  if (!status) status = add_tet(r, tet, MARK_NEEDED);
  for (uint32_t k = 0; k < c->tets.n && !status; k++)
    for (uint32_t h = 4 * c->tets.at[k]; h < 4 * c->tets.at[k] + 4 && !status; h++)
      if (r->tet_sub[h] == TET_NONE && r->tet_v[h] != p) {
        uint32_t u = r->tet_adj[h] >> 2;
        if (!(r->tet_mark[u] & MARK_IN)) status = add_tet(r, u, MARK_NEEDED);
      }
  return status ? status : grow(r);
}

/* Both sides of every replaced subface, and unless `least` all in conflict from
 * there. */
static tet_status add_sides(refiner *r, int least) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < c->subs.n; k++)
    for (int side = 0; side < 2 && !status; side++) {
      uint32_t h = r->sub_side[2 * (size_t)c->subs.at[k] + side];
      if (h != TET_NONE) status = add_tet(r, h >> 2, MARK_NEEDED);
    }
  r->cavity.reshaped |= least;
  return status || least ? status : grow(r);
}

static tet_status replace_sub(refiner *r, uint32_t s) {
  if (r->sub_mark[s] & 1) return TET_OK;
  r->sub_mark[s] |= 3;
  return refine_push(r, &r->cavity.subs, s);
}

/* The cavity of a point in `sub`; `least`: of no more than what it splits. */
tet_status refine_cavity_of_sub(refiner *r, uint32_t p, uint32_t sub, int least) {
  tet_status status = start(r, p);
  r->cavity.sub = sub;
  if (!status) status = replace_sub(r, sub);
  if (!status && !least) status = refine_facet_cavity_grow(r);
  if (status) return status;
  if (!least && !refine_facet_cavity_trim(r)) refine_facet_cavity_least(r);
  return add_sides(r, least);
}

tet_status refine_cavity_of_seg(refiner *r, uint32_t p, uint32_t seg, int least) {
  refine_cavity *c = &r->cavity;
  tet_status status = start(r, p);
  c->segment = seg;
  uint32_t first = r->seg_sub[seg], h = first;
  if (first != TET_NONE) do {
    if (!status) status = replace_sub(r, h / 3);
    h = r->ring[h];
  } while (h != first);
  if (!status && !least) status = refine_facet_cavity_grow(r);
  if (status) return status;
  if (!least && !refine_facet_cavity_trim(r)) refine_facet_cavity_least(r);
  status = refine_seg_star(r, seg, &c->tets);
  for (uint32_t k = 0; k < c->tets.n; k++) r->tet_mark[c->tets.at[k]] |= MARK_IN | MARK_NEEDED;
  return status ? status : add_sides(r, least);
}

void refine_cavity_clear(refiner *r) {
  refine_cavity *c = &r->cavity;
  for (uint32_t k = 0; k < c->tets.n; k++) r->tet_mark[c->tets.at[k]] = 0;
  for (uint32_t k = 0; k < c->touched.n; k++) r->tet_mark[c->touched.at[k]] = 0;
  for (uint32_t k = 0; k < c->subs.n; k++) r->sub_mark[c->subs.at[k]] &= (uint8_t)~3;
  c->tets.n = c->touched.n = c->subs.n = 0;
}

/* 1 if face h of a star is a subface at its vertex, which stays. */
int refine_is_wall(const refiner *r, uint32_t h) {
  if (!r->cavity.restar || r->tet_sub[h] == TET_NONE) return 0;
  uint32_t corner = refine_corner(r, h >> 2, r->cavity.p);
  return corner != 4 && corner != (h & 3);
}

/* 1 if face h of a cavity tetrahedron bounds the cavity. */
static int is_boundary(const refiner *r, uint32_t h) {
  uint32_t s = r->tet_sub[h];
  if (s != TET_NONE) return !(r->sub_mark[s] & 1) && !refine_is_wall(r, h);
  return !(r->tet_mark[r->tet_adj[h] >> 2] & MARK_IN);
}

/* Rounding can put p a last bit to the right side of a face that lies in its own
 * facet or contains its segment: such a face does not see p. */
static int sees(const refiner *r, uint32_t h) {
  const uint32_t *v = r->tet_v + 4 * (size_t)(h >> 2);
  const uint8_t *f = tet_face[h & 3];
  uint32_t w[4] = {r->cavity.p, v[f[0]], v[f[1]], v[f[2]]};
  if (tet_orient3d(&r->points, w[0], w[1], w[2], w[3]) <= 0) return 0;
  return r->out->origin[w[0]] == TET_ORIGIN_VOLUME || !refine_is_flat(r, w);
}

/* One pass: 1 if the cavity was changed, -1 if it cannot be made visible. */
static int trim_pass(refiner *r, tet_status *ret_status) {
  refine_cavity *c = &r->cavity;
  int changed = 0;
  for (uint32_t k = 0; k < c->tets.n; k++) {
    uint32_t t = c->tets.at[k];
    if (!(r->tet_mark[t] & MARK_IN)) continue;
    for (uint32_t h = 4 * t; h < 4 * t + 4; h++) {
      if (!is_boundary(r, h) || sees(r, h)) continue;
      changed = c->reshaped = 1;
      if (!(r->tet_mark[t] & MARK_NEEDED)) {
        r->tet_mark[t] = MARK_OUT | MARK_REMOVED; /* stays listed, to be cleared */
        break;
      }
      if (r->tet_sub[h] != TET_NONE) return -1;
      uint32_t u = r->tet_adj[h] >> 2;
      if (r->tet_mark[u] & MARK_REMOVED) return -1;
      *ret_status = add_tet(r, u, MARK_NEEDED);
      if (*ret_status) return -1;
    }
  }
  return changed;
}

/* Keeps edge ab, a subsegment with tetrahedra of the cavity all around, on the
 * boundary: takes the one out that is on its far side from p. All in conflict, the
 * edge is encroached and will be split, which heals what is no longer Delaunay.
 * 1 if one was taken out, -1 if none can be. */
static int keep_edge(refiner *r, uint32_t a, uint32_t b) {
  refine_cavity *c = &r->cavity;
  uint32_t far = TET_NONE;
  if (a == c->p || b == c->p) return 0;
  for (uint32_t k = 0; k < c->tets.n; k++) {
    uint32_t t = c->tets.at[k], x = refine_corner(r, t, a), y = refine_corner(r, t, b);
    if (x == 4 || y == 4 || !(r->tet_mark[t] & MARK_IN)) continue;
    int behind = !(r->tet_mark[t] & MARK_NEEDED);
    for (uint32_t i = 0; i < 4; i++) {
      if (i == x || i == y) continue;
      if (is_boundary(r, 4 * t + i)) return 0;
      const uint32_t *v = r->tet_v + 4 * (size_t)t;
      const uint8_t *f = tet_face[i];
      behind = behind && tet_orient3d(&r->points, c->p, v[f[0]], v[f[1]], v[f[2]]) < 0;
    }
    if (behind) far = t;
  }
  if (far == TET_NONE) return -1;
  r->tet_mark[far] = MARK_OUT | MARK_REMOVED;
  c->reshaped = 1;
  return 1;
}

/* 1 if every subface at subsegment e is replaced, so that none keeps it. */
static int all_replaced(const refiner *r, uint32_t e) {
  uint32_t first = r->seg_sub[e], h = first;
  if (first != TET_NONE) do {
    if (!(r->sub_mark[h / 3] & 1)) return 0;
    h = r->ring[h];
  } while (h != first);
  return 1;
}

/* keep_edge for all subsegments that could be lost. */
static int keep_edges(refiner *r) {
  refine_cavity *c = &r->cavity;
  int changed = 0;
  for (uint32_t k = 0; k < 3 * c->subs.n && changed >= 0; k++) {
    uint32_t s = c->subs.at[k / 3], h = 3 * s + k % 3, e = r->sub_seg[h];
    if (e == TET_NONE || e == c->segment || !all_replaced(r, e)) continue;
    int kept = keep_edge(r, r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1]);
    changed = kept < 0 ? -1 : changed | kept;
  }
  for (uint32_t k = 0; k < c->tets.n && changed >= 0; k++) {
    uint32_t t = c->tets.at[k];
    if (!(r->tet_edges[t] & EDGE_LOOSE) || !(r->tet_mark[t] & MARK_IN)) continue;
    for (int i = 0; i < 6 && changed >= 0; i++) {
      if (!(r->tet_edges[t] >> i & 1)) continue;
      const uint32_t *v = r->tet_v + 4 * (size_t)t;
      uint32_t e = refine_find_seg(r, v[refine_edge[i][0]], v[refine_edge[i][1]]);
      if (e == c->segment || r->seg_sub[e] != TET_NONE) continue;
      int kept = keep_edge(r, v[refine_edge[i][0]], v[refine_edge[i][1]]);
      changed = kept < 0 ? -1 : changed | kept;
    }
  }
  return changed;
}

/* Lists boundary faces and vertices; *ret_ok = 0 if a vertex would be lost inside. */
static tet_status list_boundary(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  uint32_t now = ++r->stamp_now;
  tet_status status = TET_OK;
  c->faces.n = c->vertices.n = 0;
  r->stamp[c->p] = now;
  for (uint32_t k = 0; k < c->tets.n; k++) {
    uint32_t t = c->tets.at[k];
    if (!(r->tet_mark[t] & MARK_IN)) continue;
    for (uint32_t i = 0; i < 4 && !status; i++) {
      if (!is_boundary(r, 4 * t + i)) continue;
      r->tet_mark[t] |= (uint8_t)(1 << i);
      status = refine_push(r, &c->faces, 4 * t + i);
      for (int j = 0; j < 3 && !status; j++) {
        uint32_t v = r->tet_v[4 * (size_t)t + tet_face[i][j]];
        if (r->stamp[v] == now) continue;
        r->stamp[v] = now;
        status = refine_push(r, &c->vertices, v);
      }
    }
  }
  for (uint32_t k = 0; k < c->tets.n && !status; k++) {
    uint32_t t = c->tets.at[k];
    if (!(r->tet_mark[t] & MARK_IN)) continue;
    const uint32_t *v = r->tet_v + 4 * (size_t)t;
    for (int i = 0; i < 4; i++)
      if (r->stamp[v[i]] != now) *ret_ok = 0;
  }
  return status;
}

/* Makes the cavity strictly visible from p and lists its boundary. *ret_ok = 0 if
 * that cannot be had without losing a subface, subsegment or vertex. */
tet_status refine_cavity_trim(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  int pass;
  *ret_ok = 0;
  do {
    pass = trim_pass(r, &status);
    if (!pass) pass = keep_edges(r);
  } while (pass > 0);
  if (status || pass < 0) return status;
  *ret_ok = 1;
  status = list_boundary(r, ret_ok);
  if (status || !c->subs.n || !*ret_ok) return status;
  status = refine_facet_cavity_rim(r);
  return status ? status : refine_cavity_is_sound(r, ret_ok);
}
