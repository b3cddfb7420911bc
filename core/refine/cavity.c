// SPDX-License-Identifier: Apache-2.0
/* cavity.c: the region that a candidate retriangulates: grown by the kernel's search,
 * bounded by subfaces, and made strictly visible from the candidate: first by taking
 * tetrahedra out, then, where one is needed, by taking the next one in. Changes
 * nothing of the mesh; fill.c does. */
#include "refine/refiner.h"

static void start(refiner *r, uint32_t p) {
  refine_cavity *c = &r->cavity;
  c->p = p;
  c->segment = c->sub = TET_NONE;
  c->reshaped = c->restar = c->is_part = 0;
  c->is_listed = c->loses_vertex = 0;
  c->n_made = c->n_spokes = 0;
  c->removed.n = 0;
  c->subs.n = c->rim.n = c->rim_new.n = c->vertices.n = 0;
  r->mesh.n_cavity = r->mesh.n_border = 0;
}

static tet_status add_tet(refiner *r, uint32_t t, uint8_t flag) {
  tet_complex *m = &r->mesh;
  int is_known = m->flag[t] & TET_FLAG_CAVITY;
  m->flag[t] = (uint8_t)(m->flag[t] | TET_FLAG_CAVITY | flag);
  if (is_known) return TET_OK;
  if (m->n_cavity == m->cap_cavity) {
    tet_status status = tet_grow(r->ctx, &m->cavity, &m->cap_cavity, m->n_cavity + 64, sizeof *m->cavity);
    if (status) return status;
  }
  m->cavity[m->n_cavity++] = t;
  return TET_OK;
}

/* Of `tet` alone, to be grown. */
tet_status refine_cavity_of_tet(refiner *r, uint32_t p, uint32_t tet) {
  start(r, p);
  return add_tet(r, tet, FLAG_NEEDED);
}

/* Adds what the new point splits, in conflict with it or, by rounding and ties, not. */
static tet_status add_needed(refiner *r, uint32_t t) {
  if (r->mesh.flag[t] & TET_FLAG_CAVITY) return TET_OK;
  r->cavity.reshaped |= !tet_complex_conflict(&r->mesh, t, r->cavity.p);
  return add_tet(r, t, FLAG_NEEDED);
}

/* Grows the cavity on from what it has, and gives up where that is more than NEAR, or twice as much. */
static tet_status grow_near(refiner *r) {
  size_t most = 2 * r->mesh.n_cavity > NEAR ? 2 * r->mesh.n_cavity : NEAR, k = 0;
  return tet_complex_grow_to(&r->mesh, r->cavity.p, most, &k, &r->cavity.is_part);
}

/* Both sides of every replaced subface, and of a whole cavity all in conflict from
 * there. */
static tet_status add_sides(refiner *r, refine_extent extent) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < c->subs.n; k++)
    for (int side = 0; side < 2 && !status; side++) {
      uint32_t h = r->sub_side[2 * (size_t)c->subs.at[k] + side];
      if (h != TET_NONE) status = add_needed(r, h >> 2);
    }
  c->reshaped |= extent == EXTENT_LEAST;
  if (status || extent == EXTENT_LEAST || extent == EXTENT_BEGUN) return status;
  status = extent == EXTENT_NEAR ? grow_near(r) : tet_complex_grow(&r->mesh, c->p);
  r->searched += r->mesh.n_cavity;
  return status;
}

static tet_status replace_sub(refiner *r, uint32_t s) {
  if (r->sub_mark[s] & 1) return TET_OK;
  r->sub_mark[s] |= 3;
  return refine_push(r, &r->cavity.subs, s);
}

static int is_listed(const refine_list *list, uint32_t value) {
  for (uint32_t k = 0; k < list->n; k++)
    if (list->at[k] == value) return 1;
  return 0;
}

/* 1 if a replaced subface is beside u, and no subsegment between them. */
static int is_beside_replaced(const refiner *r, uint32_t u) {
  for (uint32_t h = 3 * u; h < 3 * u + 3; h++)
    if (r->sub_seg[h] == TET_NONE && r->sub_mark[r->ring[h] / 3] & 1) return 1;
  return 0;
}

/* Replaces all subfaces of the patch at flat tetrahedra beside those replaced: a crease that is none
 * but for last bits leaves such, and a point on the facet can make none of them anew. */
static tet_status replace_flat(refiner *r) {
  const tet_complex *m = &r->mesh;
  refine_list *flat = &r->star;
  tet_status status = TET_OK;
  flat->n = 0;
  for (uint32_t k = 0, done = 0; k < r->cavity.subs.n && !status; k++) {
    uint32_t s = r->cavity.subs.at[k], facet = r->patch[r->sub_patch[s]].facet;
    for (int side = 0; side < 2 && !status; side++) {
      uint32_t h = r->sub_side[2 * (size_t)s + side];
      if (h != TET_NONE && !is_listed(flat, h >> 2) && refine_all_on_facet(r, m->v + (h & ~(size_t)3), facet))
        status = refine_push(r, flat, h >> 2);
    }
    for (; done < flat->n && !status; done++)
      for (uint32_t h = 4 * flat->at[done]; h < 4 * flat->at[done] + 4 && !status; h++) {
        uint32_t u = refine_sub_at(r, h), t = m->adj[h] >> 2;
        if (u != TET_NONE) {
          if (is_beside_replaced(r, u)) status = replace_sub(r, u);
        } else if (!is_listed(flat, t) && refine_all_on_facet(r, m->v + 4 * (size_t)t, facet)) {
          status = refine_push(r, flat, t);
        }
      }
  }
  return status;
}

/* The cavity of a point in `sub`. */
tet_status refine_cavity_of_sub(refiner *r, uint32_t p, uint32_t sub, refine_extent extent) {
  int least = extent == EXTENT_LEAST;
  start(r, p);
  r->cavity.sub = sub;
  tet_status status = replace_sub(r, sub);
  if (!status) status = replace_flat(r);
  if (!status && !least) status = refine_facet_cavity_grow(r, extent);
  if (status || r->cavity.is_part) return status;
  if (!least && !refine_facet_cavity_trim(r)) refine_facet_cavity_least(r);
  return add_sides(r, extent);
}

tet_status refine_cavity_of_seg(refiner *r, uint32_t p, uint32_t seg, refine_extent extent) {
  int least = extent == EXTENT_LEAST;
  tet_status status = TET_OK;
  start(r, p);
  r->cavity.segment = seg;
  uint32_t first = r->seg_sub[seg], h = first;
  if (first != TET_NONE) do {
    if (!status) status = replace_sub(r, h / 3);
    h = r->ring[h];
  } while (h != first);
  if (!status) status = replace_flat(r);
  if (!status && !least) status = refine_facet_cavity_grow(r, extent);
  if (status || r->cavity.is_part) return status;
  if (!least && !refine_facet_cavity_trim(r)) refine_facet_cavity_least(r);
  r->star.n = 0;
  status = refine_seg_star(r, seg, &r->star);
  for (uint32_t k = 0; k < r->star.n && !status; k++) status = add_needed(r, r->star.at[k]);
  return status ? status : add_sides(r, extent);
}

static tet_status take_out(refiner *r, uint32_t t) {
  r->mesh.flag[t] = TET_FLAG_MARK | FLAG_REMOVED;
  r->cavity.reshaped = 1;
  return refine_push(r, &r->cavity.removed, t);
}

static void forget_removed(refiner *r) {
  refine_list *removed = &r->cavity.removed;
  for (uint32_t k = 0; k < removed->n; k++) r->mesh.flag[removed->at[k]] = 0;
  removed->n = 0;
}

void refine_cavity_clear(refiner *r) {
  refine_cavity *c = &r->cavity;
  forget_removed(r);
  tet_complex_forget(&r->mesh);
  for (uint32_t k = 0; k < c->subs.n; k++) r->sub_mark[c->subs.at[k]] &= (uint8_t)~3;
  c->subs.n = 0;
}

/* 1 if face h of a star is a subface at its vertex, which stays. */
int refine_is_spoke(const refiner *r, uint32_t h) {
  if (!r->cavity.restar || refine_sub_at(r, h) == TET_NONE) return 0;
  uint32_t corner = refine_corner(r, h >> 2, r->cavity.p);
  return corner != 4 && corner != (h & 3);
}

/* 1 if face h of a cavity tetrahedron bounds the cavity. */
int refine_is_border(const refiner *r, uint32_t h) {
  uint32_t s = refine_sub_at(r, h);
  if (s != TET_NONE) return !(r->sub_mark[s] & 1) && !refine_is_spoke(r, h);
  return !(r->mesh.flag[r->mesh.adj[h] >> 2] & TET_FLAG_CAVITY);
}

/* Rounding can put p a last bit to the right side of a face that lies in its own
 * facet or contains its segment: such a face does not see p. */
static int sees(const refiner *r, uint32_t h, int is_positive) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)(h >> 2);
  const uint8_t *f = tet_face[h & 3];
  uint32_t w[4] = {r->cavity.p, v[f[0]], v[f[1]], v[f[2]]};
  if (r->cavity.restar) return refine_is_positive(r, w); /* p may be on more polytopes than the others */
  if (!is_positive && tet_orient3d(&r->points, w[0], w[1], w[2], w[3]) <= 0) return 0;
  return r->out->origin[w[0]] == TET_ORIGIN_VOLUME || !refine_is_flat(r, w);
}

/* For vertex p anew: its tetrahedra from `tet` on, up to subfaces, which stay, and
 * all in conflict with it. *ret_ok = 0, and the search ends, at a border face that p does not
 * see: most stars of vertices with many tetrahedra end so, and after few of them. */
tet_status refine_cavity_of_star(refiner *r, uint32_t p, uint32_t tet, int *ret_ok) {
  tet_complex *m = &r->mesh;
  start(r, p);
  r->cavity.restar = 1;
  *ret_ok = 0;
  tet_status status = add_tet(r, tet, FLAG_NEEDED);
  for (size_t k = 0; k < m->n_cavity && !status; k++)
    for (uint32_t h = 4 * m->cavity[k]; h < 4 * m->cavity[k] + 4 && !status; h++)
      if (refine_sub_at(r, h) == TET_NONE && m->v[h] != p) status = add_tet(r, m->adj[h] >> 2, FLAG_NEEDED);
  for (size_t k = 0; k < m->n_cavity && !status; k++)
    for (uint32_t h = 4 * m->cavity[k]; h < 4 * m->cavity[k] + 4 && !status; h++) {
      if (!refine_is_border(r, h)) continue;
      if (refine_sub_at(r, h) == TET_NONE && tet_complex_conflict(m, m->adj[h] >> 2, p))
        status = add_tet(r, m->adj[h] >> 2, 0);
      else if (!sees(r, h, 0))
        return TET_OK;
    }
  *ret_ok = 1;
  return status;
}

/* One pass over the border: 1 if the cavity was changed, -1 if it cannot be made visible; a
 * vertex's star made anew may not be changed. */
static int trim_pass(refiner *r, tet_status *ret_status) {
  tet_complex *m = &r->mesh;
  int changed = 0;
  *ret_status = refine_measure_border(r);
  if (*ret_status) return -1;
  for (size_t k = 0; k < m->n_border; k++) {
    uint32_t h = m->border[k].inner, t = h >> 2;
    if (changed && (!(m->flag[t] & TET_FLAG_CAVITY) || !refine_is_border(r, h))) continue;
    if (sees(r, h, r->cavity.shapes[k / 4].is_positive >> k % 4 & 1)) continue;
    if (r->cavity.restar) return -1;
    changed = 1;
    if (!(m->flag[t] & FLAG_NEEDED)) {
      *ret_status = take_out(r, t);
      if (*ret_status) return -1;
      continue;
    }
    if (refine_sub_at(r, h) != TET_NONE) return -1;
    uint32_t u = m->adj[h] >> 2;
    if (m->flag[u] & FLAG_REMOVED) return -1;
    r->cavity.reshaped = 1;
    *ret_status = add_tet(r, u, FLAG_NEEDED);
    if (*ret_status) return -1;
  }
  return changed;
}

/* Keeps edge ab, a subsegment with tetrahedra of the cavity all around, on the
 * border: takes the one out that is on its far side from p. All in conflict, the
 * edge is encroached and will be split, which heals what is no longer Delaunay.
 * 1 if one was taken out, -1 if none can be. */
static int keep_edge(refiner *r, uint32_t a, uint32_t b, tet_status *ret_status) {
  const tet_complex *m = &r->mesh;
  uint32_t far = TET_NONE, p = r->cavity.p;
  if (a == p || b == p) return 0;
  for (size_t k = 0; k < m->n_cavity; k++) {
    uint32_t t = m->cavity[k], x = refine_corner(r, t, a), y = refine_corner(r, t, b);
    if (x == 4 || y == 4 || !(m->flag[t] & TET_FLAG_CAVITY)) continue;
    int behind = !(m->flag[t] & FLAG_NEEDED);
    for (uint32_t i = 0; i < 4; i++) {
      if (i == x || i == y) continue;
      if (refine_is_border(r, 4 * t + i)) return 0;
      const uint32_t *v = m->v + 4 * (size_t)t;
      const uint8_t *f = tet_face[i];
      behind = behind && tet_orient3d(&r->points, p, v[f[0]], v[f[1]], v[f[2]]) < 0;
    }
    if (behind) far = t;
  }
  if (far == TET_NONE || r->cavity.restar) return -1;
  *ret_status = take_out(r, far);
  return *ret_status ? -1 : 1;
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
static int keep_edges(refiner *r, tet_status *ret_status) {
  refine_cavity *c = &r->cavity;
  const tet_complex *m = &r->mesh;
  int changed = 0;
  for (uint32_t k = 0; k < 3 * c->subs.n && changed >= 0; k++) {
    uint32_t s = c->subs.at[k / 3], h = 3 * s + k % 3, e = r->sub_seg[h];
    if (e == TET_NONE || e == c->segment || !all_replaced(r, e)) continue;
    int kept = keep_edge(r, r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1], ret_status);
    changed = kept < 0 ? -1 : changed | kept;
  }
  for (size_t k = 0; k < m->n_cavity && changed >= 0; k++) {
    uint32_t t = m->cavity[k];
    if (!(r->tet_edges[t] & EDGE_LOOSE) || !(m->flag[t] & TET_FLAG_CAVITY)) continue;
    for (int i = 0; i < 6 && changed >= 0; i++) {
      if (!(r->tet_edges[t] >> i & 1)) continue;
      const uint32_t *v = m->v + 4 * (size_t)t;
      uint32_t e = refine_find_seg(r, v[refine_edge[i][0]], v[refine_edge[i][1]]);
      if (e == c->segment || r->seg_sub[e] != TET_NONE) continue;
      int kept = keep_edge(r, v[refine_edge[i][0]], v[refine_edge[i][1]], ret_status);
      changed = kept < 0 ? -1 : changed | kept;
    }
  }
  return changed;
}

/* Lists the cavity and its border anew, after either was changed. */
static tet_status list_again(refiner *r) {
  tet_complex *m = &r->mesh;
  size_t n = 0;
  for (size_t k = 0; k < m->n_border; k++) {
    uint32_t outer = m->border[k].outer;
    if (outer != TET_NONE && !(m->flag[outer >> 2] & (TET_FLAG_CAVITY | FLAG_REMOVED))) m->flag[outer >> 2] = 0;
  }
  m->n_border = 0;
  r->cavity.is_listed = 0;
  for (size_t k = 0; k < m->n_cavity; k++) {
    uint32_t t = m->cavity[k];
    m->cavity[n] = t;
    n += (m->flag[t] & TET_FLAG_CAVITY) != 0;
  }
  for (size_t k = 0; k < n; k++) {
    tet_status status = tet_grow(r->ctx, &m->border, &m->cap_border, m->n_border + 4, sizeof *m->border);
    if (status) return status;
    for (uint32_t h = 4 * m->cavity[k]; h < 4 * m->cavity[k] + 4; h++) {
      if (!refine_is_border(r, h)) continue;
      tet_border *b = &m->border[m->n_border++];
      memcpy(b->v, m->v + (h & ~(size_t)3), sizeof b->v);
      b->v[h & 3] = r->cavity.p;
      b->inner = h;
      b->outer = m->adj[h];
    }
  }
  m->n_cavity = n;
  return TET_OK;
}

/* Lists the vertices of the border, and says whether one would be lost inside. */
tet_status refine_cavity_vertices(refiner *r) {
  refine_cavity *c = &r->cavity;
  const tet_complex *m = &r->mesh;
  uint32_t now = ++r->stamp_now, *stamp = r->stamp, n = 0;
  tet_status status = tet_grow(r->ctx, &c->vertices.at, &c->vertices.cap, 3 * m->n_border + 1, sizeof *c->vertices.at);
  if (status) return status;
  uint32_t *at = c->vertices.at;
  stamp[c->p] = now;
  for (size_t k = 0; k < m->n_border; k++)
    for (int j = 0; j < 4; j++) {
      uint32_t v = m->border[k].v[j];
      at[n] = v; /* overwritten where it is not new */
      n += stamp[v] != now;
      stamp[v] = now;
    }
  c->vertices.n = n;
  c->loses_vertex = 0;
  c->is_listed = 1;
  for (size_t k = 0; k < m->n_cavity; k++) {
    const uint32_t *v = m->v + 4 * (size_t)m->cavity[k];
    c->loses_vertex |= (stamp[v[0]] != now) | (stamp[v[1]] != now) | (stamp[v[2]] != now) | (stamp[v[3]] != now);
  }
  return TET_OK;
}

/* 1 if the cavity has both sides of a subface at a vertex made anew. */
static int has_two_sided_spoke(const refiner *r) {
  const tet_complex *m = &r->mesh;
  for (size_t k = 0; k < m->n_cavity && r->cavity.restar; k++)
    for (uint32_t h = 4 * m->cavity[k]; h < 4 * m->cavity[k] + 4; h++)
      if (m->adj[h] != TET_NONE && m->flag[m->adj[h] >> 2] & TET_FLAG_CAVITY && refine_is_spoke(r, h)) return 1;
  return 0;
}

/* Makes the cavity strictly visible from p and lists its border. *ret_ok = 0 if
 * that cannot be had without losing a subface, subsegment or vertex. */
tet_status refine_cavity_trim(refiner *r, int *ret_ok) {
  refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  int pass;
  *ret_ok = 0;
  if (c->subs.n || c->restar) status = list_again(r); /* the search stopped at what is replaced */
  do {
    if (status) return status;
    pass = trim_pass(r, &status);
    if (!pass) pass = keep_edges(r, &status);
    if (pass > 0) status = list_again(r);
  } while (pass > 0);
  if (status || pass < 0) return status;
  forget_removed(r);
  if (!c->is_listed && (c->reshaped || c->subs.n || refine_needs_sizes(r))) status = refine_cavity_vertices(r);
  *ret_ok = !c->loses_vertex && !has_two_sided_spoke(r);
  if (status || !c->subs.n || !*ret_ok) return status;
  status = refine_facet_cavity_rim(r);
  return status ? status : refine_cavity_is_sound(r, ret_ok);
}
