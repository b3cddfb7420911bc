// SPDX-License-Identifier: Apache-2.0
/* repair.c: restores the local Delaunay property off the subfaces where rounding
 * broke it, by exact flips (Lawson): 2-3, 3-2 and 4-4. Subfaces, subsegments and
 * flatness by incidence are respected; what sticks waits for the next insertion
 * beside it. And flips the creases away that rounding has bent facets at. */
#include "refine/refiner.h"

#include <string.h>

enum { MOST = 4 };

/* A few tetrahedra about to be replaced by others of the same union. */
typedef struct flip {
  uint32_t n_old, old[MOST];
  uint32_t n_new, made[MOST], v[MOST][4], region[MOST];
  uint32_t n_subs, old_sub[2], sub[2], sub_v[2][3]; /* a facet's edge flipped as well: 2 */
} flip;

/* The face of tetrahedron u that has the vertices of face i of v, or 4. */
static uint32_t same_face(const refiner *r, uint32_t u, const uint32_t *v, uint32_t i) {
  uint32_t found = 4;
  for (uint32_t k = 0; k < 4; k++) {
    uint32_t w = r->mesh.v[4 * (size_t)u + k];
    if (w == v[tet_face[i][0]] || w == v[tet_face[i][1]] || w == v[tet_face[i][2]]) continue;
    if (found != 4) return 4;
    found = k;
  }
  return found;
}

static int same_sub(const uint32_t *sub, const uint32_t *v, uint32_t i) {
  int n = 0;
  for (int j = 0; j < 3; j++)
    for (int k = 0; k < 3; k++) n += v[tet_face[i][j]] == sub[k];
  return n == 3;
}

/* Gives face h of a new tetrahedron what the old mesh had there, or the other new
 * one that shares it. */
static tet_status join(refiner *r, const flip *f, uint32_t m, uint32_t i) {
  uint32_t h = 4 * f->made[m] + i;
  const uint32_t *v = f->v[m];
  uint32_t s = TET_NONE;
  for (uint32_t k = 0; k < f->n_subs; k++)
    if (same_sub(f->sub_v[k], v, i)) refine_hang(r, s = f->sub[k], h);
  for (uint32_t k = 0; k < f->n_new; k++) {
    uint32_t j = k == m ? 4 : same_face(r, f->made[k], v, i);
    if (j == 4) continue;
    r->mesh.adj[h] = 4 * f->made[k] + j;
    return TET_OK;
  }
  if (s != TET_NONE) return TET_OK; /* nothing beyond */
  for (uint32_t k = 0; k < f->n_old; k++) {
    uint32_t j = same_face(r, f->old[k], v, i);
    if (j == 4) continue;
    uint32_t was = 4 * f->old[k] + j, beyond = r->mesh.adj[was];
    s = refine_sub_at(r, was);
    r->mesh.adj[h] = beyond;
    if (beyond != TET_NONE) r->mesh.adj[beyond] = h;
    if (s != TET_NONE) refine_take_sub(r, s, was, h);
    return TET_OK;
  }
  return tet_internal(r->ctx, "a flip leaves a face open");
}

/* Bits of the subsegments among the edges of a new tetrahedron. */
static uint8_t edges_of(const refiner *r, const flip *f, const uint32_t *v) {
  uint8_t bits = 0;
  for (int e = 0; e < 6; e++)
    for (uint32_t k = 0; k < f->n_old; k++) {
      uint32_t t = f->old[k], x = refine_corner(r, t, v[refine_edge[e][0]]), y = refine_corner(r, t, v[refine_edge[e][1]]);
      if (x == 4 || y == 4 || !(r->tet_edges[t] >> refine_edge_of[x][y] & 1)) continue;
      bits |= (uint8_t)(1 << e | (r->tet_edges[t] & EDGE_LOOSE));
    }
  return bits;
}

/* The edge handle of subface s on ab. */
static uint32_t sub_edge(const refiner *r, uint32_t s, uint32_t a, uint32_t b) {
  uint32_t h = 3 * s;
  for (; h < 3 * s + 2; h++) {
    uint32_t x = r->sub_v[h], y = r->sub_v[3 * s + (h + 1) % 3];
    if ((x == a && y == b) || (x == b && y == a)) break;
  }
  return h;
}

/* Replaces abd and bae by aed and bde; sub_v holds the latter two. */
static tet_status swap_subs(refiner *r, flip *f) {
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < 2 && !status; k++) {
    status = refine_new_sub(r, &f->sub[k]);
    if (status) return status;
    memcpy(r->sub_v + 3 * (size_t)f->sub[k], f->sub_v[k], sizeof f->sub_v[k]);
    r->sub_patch[f->sub[k]] = r->sub_patch[f->old_sub[0]];
  }
  uint32_t a = f->sub_v[0][0], b = f->sub_v[1][0], d = f->sub_v[1][1], e = f->sub_v[0][1];
  refine_replace_edge(r, sub_edge(r, f->old_sub[1], a, e), 3 * f->sub[0]);
  refine_replace_edge(r, sub_edge(r, f->old_sub[0], d, a), 3 * f->sub[0] + 2);
  refine_replace_edge(r, sub_edge(r, f->old_sub[0], b, d), 3 * f->sub[1]);
  refine_replace_edge(r, sub_edge(r, f->old_sub[1], e, b), 3 * f->sub[1] + 2);
  refine_link(r, 3 * f->sub[0] + 1, 3 * f->sub[1] + 1);
  for (uint32_t k = 0; k < 2; k++) refine_free_sub(r, f->old_sub[k]);
  return TET_OK;
}

static tet_status apply(refiner *r, flip *f) {
  tet_status status = f->n_subs ? swap_subs(r, f) : TET_OK;
  for (uint32_t m = 0; m < f->n_new && !status; m++) {
    status = refine_new_tet(r, &f->made[m]);
    if (status) return status;
    memcpy(r->mesh.v + 4 * (size_t)f->made[m], f->v[m], sizeof f->v[m]);
    r->tet_region[f->made[m]] = f->region[m];
    r->tet_edges[f->made[m]] = edges_of(r, f, f->v[m]);
  }
  for (uint32_t m = 0; m < f->n_new; m++)
    for (uint32_t i = 0; i < 4 && !status; i++) status = join(r, f, m, i);
  for (uint32_t m = 0; m < f->n_new && !status; m++) {
    uint32_t n = f->made[m];
    for (int e = 0; e < 6 && r->tet_edges[n] & EDGE_LOOSE; e++) {
      if (!(r->tet_edges[n] >> e & 1)) continue;
      uint32_t g = refine_find_seg(r, f->v[m][refine_edge[e][0]], f->v[m][refine_edge[e][1]]);
      if (r->seg_sub[g] == TET_NONE) r->seg_tet[g] = n;
    }
    for (uint32_t i = 0; i < 4 && !status; i++) status = refine_push(r, &r->suspects, 4 * n + i);
  }
  for (uint32_t k = 0; k < f->n_old; k++) tet_complex_delete(&r->mesh, f->old[k]);
  for (uint32_t m = 0; m < f->n_new && !status; m++) status = refine_look_at(r, f->made[m]);
  r->result.repair_flips++;
  return status;
}

/* Adds abcd, or bacd if `turned`, to the new tetrahedra; 0 unless positive. */
static int propose(const refiner *r, flip *f, int turned, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  uint32_t v[4] = {turned ? b : a, turned ? a : b, c, d};
  f->region[f->n_new] = r->tet_region[f->old[f->n_new < f->n_old ? f->n_new : 0]];
  memcpy(f->v[f->n_new++], v, sizeof v);
  return refine_is_positive(r, v);
}

/* The tetrahedra around edge xy from t on; 0 unless they close up, off subfaces,
 * in at most MOST, and xy is no subsegment. ret_link: the vertices beside xy, the
 * k-th tetrahedron between the k-th and the next. */
static int ring_of(const refiner *r, uint32_t t, uint32_t x, uint32_t y, flip *f, uint32_t ret_link[MOST]) {
  uint32_t cx = refine_corner(r, t, x), cy = refine_corner(r, t, y), i = 0;
  if (r->tet_edges[t] >> refine_edge_of[cx][cy] & 1) return 0;
  while (i == cx || i == cy) i++;
  uint32_t h = 4 * t + i; /* enter through face i, leave opposite the other */
  f->n_old = 0;
  do {
    if (f->n_old == MOST) return 0;
    uint32_t u = h >> 2, in = h & 3, out = 6 - in - refine_corner(r, u, x) - refine_corner(r, u, y);
    ret_link[f->n_old] = r->mesh.v[4 * (size_t)u + out];
    f->old[f->n_old++] = u;
    if (refine_sub_at(r, 4 * (size_t)u + out) != TET_NONE) return 0;
    h = r->mesh.adj[4 * (size_t)u + out];
  } while (h >> 2 != t);
  return 1;
}

/* Flips face i of t away, beyond which is apex e; 0 if that cannot be. */
static int flip_face(const refiner *r, uint32_t t, uint32_t i, flip *f) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  uint32_t d = v[i], u = r->mesh.adj[4 * (size_t)t + i] >> 2, e = r->mesh.v[r->mesh.adj[4 * (size_t)t + i]];
  uint32_t p[3] = {v[tet_face[i][0]], v[tet_face[i][1]], v[tet_face[i][2]]}, link[MOST];
  int side[3], all = 1;
  /* d sees the outward face p0 p1 p2 from behind: > 0 where de passes inside */
  for (int k = 0; k < 3; k++) {
    side[k] = tet_orient3d(&r->points, d, p[k], p[(k + 1) % 3], e);
    all = all && side[k] > 0;
  }
  f->n_new = 0;
  if (all) {
    f->n_old = 2;
    f->old[0] = t;
    f->old[1] = u;
    for (int k = 0; k < 3; k++)
      if (!propose(r, f, 0, d, p[k], p[(k + 1) % 3], e)) return 0;
    return 1;
  }
  for (int k = 0; k < 3; k++) {
    uint32_t x = p[k], y = p[(k + 1) % 3];
    if (side[k] > 0 || !ring_of(r, t, x, y, f, link)) continue;
    f->n_new = 0;
    /* an old tetrahedron x y l0 l1 tells how the new ones are turned */
    int odd = tet_orient3d(&r->points, x, y, link[0], link[1]) < 0;
    if (f->n_old == 3) {
      if (propose(r, f, odd, link[2], y, link[0], link[1]) && propose(r, f, odd, x, link[2], link[0], link[1])) return 1;
      continue;
    }
    uint32_t o = link[0] == d || link[0] == e ? 0 : 1; /* d and e are opposite in the link */
    uint32_t l0 = link[o], l1 = link[o + 1], l2 = link[o + 2], l3 = link[(o + 3) % 4];
    if (propose(r, f, odd, x, l2, l0, l1) && propose(r, f, odd, l2, y, l0, l1) && propose(r, f, odd, x, l0, l2, l3) &&
        propose(r, f, odd, l0, y, l2, l3)) return 1;
  }
  return 0;
}

/* Flips edge xy of a facet under face i of t: the tetrahedra on both sides of that
 * face stand on subfaces xyd and xye. 0 if that cannot be. */
static int flip_facet(const refiner *r, uint32_t t, uint32_t i, flip *f) {
  uint32_t u = r->mesh.adj[4 * (size_t)t + i] >> 2, d = r->mesh.v[4 * (size_t)t + i];
  uint32_t e = r->mesh.v[r->mesh.adj[4 * (size_t)t + i]];
  for (int k = 0; k < 3; k++) {
    uint32_t x = r->mesh.v[4 * (size_t)t + tet_face[i][k]], y = r->mesh.v[4 * (size_t)t + tet_face[i][(k + 1) % 3]];
    uint32_t z = r->mesh.v[4 * (size_t)t + tet_face[i][(k + 2) % 3]];
    uint32_t ft = 4 * t + refine_corner(r, t, z), fu = 4 * u + refine_corner(r, u, z);
    uint32_t s = refine_sub_at(r, ft), q = refine_sub_at(r, fu), bt = r->mesh.adj[ft], bu = r->mesh.adj[fu];
    if (s == TET_NONE || q == TET_NONE || r->sub_patch[s] != r->sub_patch[q] ||
        r->sub_seg[sub_edge(r, s, x, y)] != TET_NONE || (bt == TET_NONE) != (bu == TET_NONE)) continue;
    *f = (flip){.n_old = 2, .old = {t, u}, .n_subs = 2, .old_sub = {s, q}};
    uint32_t edge = sub_edge(r, s, x, y), a = r->sub_v[edge], b = r->sub_v[3 * s + (edge + 1) % 3];
    const uint32_t n[2][3] = {{a, e, d}, {b, d, e}};
    memcpy(f->sub_v, n, sizeof n);
    int axis = r->patch[r->sub_patch[s]].axis, odd = tet_orient3d(&r->points, x, y, z, d) < 0;
    if (tet_orient2d(&r->points, axis, a, e, d) <= 0 || tet_orient2d(&r->points, axis, b, d, e) <= 0) continue;
    if (!propose(r, f, odd, x, e, z, d) || !propose(r, f, odd, e, y, z, d)) continue;
    if (bt == TET_NONE) return 1;
    uint32_t w = r->mesh.v[bt], over = 4 * (bt >> 2) + refine_corner(r, bt >> 2, d);
    if (r->mesh.v[bu] != w || refine_sub_at(r, over) != TET_NONE || r->mesh.adj[over] >> 2 != bu >> 2) continue;
    f->old[2] = bt >> 2;
    f->old[3] = bu >> 2;
    f->n_old = 4;
    odd = tet_orient3d(&r->points, x, y, w, d) < 0;
    if (!propose(r, f, odd, x, e, w, d) || !propose(r, f, odd, e, y, w, d)) continue;
    /* bent by rounding, the two sides may want different edges: not to and fro */
    const uint32_t *v = f->v[2];
    if (tet_insphere_sos(&r->points, v[0], v[1], v[2], v[3], y) <= 0) return 1;
  }
  f->n_subs = 0;
  return 0;
}

/* Flips edge xy, of corners x and y of t, of the facet that t = xyde stands on with subfaces xyd and xye: t
 * spans a crease of nothing but last bits there. Beyond, either nothing or two tetrahedra have that edge. 0 if
 * that cannot be. */
static int flip_bend(const refiner *r, uint32_t t, uint32_t x, uint32_t y, flip *f, uint32_t ret_behind[2]) {
  uint32_t d = 0, e;
  while (d == x || d == y) d++;
  e = 6 - x - y - d;
  uint32_t s = refine_sub_at(r, 4 * (size_t)t + e), q = refine_sub_at(r, 4 * (size_t)t + d);
  if (s == TET_NONE || q == TET_NONE || r->sub_patch[s] != r->sub_patch[q] ||
      refine_sub_at(r, 4 * (size_t)t + x) != TET_NONE || refine_sub_at(r, 4 * (size_t)t + y) != TET_NONE ||
      r->tet_edges[t] >> refine_edge_of[d][e] & 1) return 0;
  const uint32_t *v = r->mesh.v + 4 * (size_t)t, *adj = r->mesh.adj + 4 * (size_t)t;
  uint32_t edge = sub_edge(r, s, v[x], v[y]), bt = adj[e], bu = adj[d];
  if (r->sub_seg[edge] != TET_NONE || (bt == TET_NONE) != (bu == TET_NONE)) return 0;
  uint32_t a = r->sub_v[edge], b = r->sub_v[3 * s + (edge + 1) % 3];
  *f = (flip){.n_old = 1, .old = {t}, .n_subs = 2, .old_sub = {s, q}, .sub_v = {{a, v[e], v[d]}, {b, v[d], v[e]}}};
  ret_behind[0] = adj[a == v[x] ? y : x];
  ret_behind[1] = adj[a == v[x] ? x : y];
  int axis = r->patch[r->sub_patch[s]].axis;
  for (int k = 0; k < 2; k++) {
    const uint32_t *n = f->sub_v[k];
    if (tet_orient2d(&r->points, axis, n[0], n[1], n[2]) <= 0) return 0;
  }
  if (bt == TET_NONE) return 1;
  uint32_t w = r->mesh.v[bt], over = 4 * (bt >> 2) + refine_corner(r, bt >> 2, v[d]);
  if (r->mesh.v[bu] != w || refine_sub_at(r, over) != TET_NONE || r->mesh.adj[over] >> 2 != bu >> 2) return 0;
  f->n_old = 3;
  f->old[0] = bt >> 2;
  f->old[1] = bu >> 2;
  f->old[2] = t;
  int odd = tet_orient3d(&r->points, v[x], v[y], w, v[d]) < 0;
  return propose(r, f, odd, v[x], v[e], w, v[d]) && propose(r, f, odd, v[e], v[y], w, v[d]);
}

/* Applies a flip_bend: the tetrahedra behind t stand on the new subfaces. */
static tet_status apply_bend(refiner *r, flip *f, const uint32_t behind[2]) {
  tet_status status = apply(r, f);
  for (uint32_t k = 0; k < 2 && !status; k++) {
    uint32_t over = r->sub_side[2 * (size_t)f->sub[k]];
    r->mesh.adj[behind[k]] = over;
    if (over != TET_NONE) r->mesh.adj[over] = behind[k];
    refine_hang(r, f->sub[k], behind[k]);
  }
  return status;
}

/* Flips the edges away that a facet bent by rounding has as creases: refinement knows of no such, and the
 * flat tetrahedra that span them would stand in the way of points on the facet. */
tet_status refine_unbend(refiner *r) {
  tet_status status = TET_OK;
  for (int changed = 1; changed && !status;) {
    changed = 0;
    for (uint32_t t = 0; t < r->mesh.n_slots && !status; t++)
      for (uint32_t e = 0; e < 6 && !status && refine_alive(r, t) && __builtin_popcount(r->mesh.wall[t]) > 1; e++) {
        flip f;
        uint32_t behind[2];
        if (!flip_bend(r, t, refine_edge[e][0], refine_edge[e][1], &f, behind)) continue;
        status = apply_bend(r, &f, behind);
        changed = 1;
      }
    if (!status) status = tet_poll(r->ctx);
  }
  return status ? status : refine_repair(r);
}

static int is_delaunay(const refiner *r, uint32_t h) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)(h >> 2);
  return tet_insphere_sos(&r->points, v[0], v[1], v[2], v[3], r->mesh.v[r->mesh.adj[h]]) <= 0;
}

/* Triangulates the surroundings of vertex p, a corner of t, anew from p, if that
 * makes all of them locally Delaunay. */
static tet_status restar(refiner *r, uint32_t p, uint32_t t, int *ret_ok) {
  tet_status status = refine_cavity_of_star(r, p, t, ret_ok);
  if (!status && *ret_ok) status = refine_cavity_trim(r, ret_ok);
  if (status) return status;
  if (!*ret_ok) {
    refine_cavity_clear(r);
    return TET_OK;
  }
  status = refine_fill(r);
  if (!status) status = refine_look_at_made(r);
  r->result.repair_flips++;
  return status;
}

/* Makes face h, which is not Delaunay, go: by a flip, or if `thorough` by a star made anew. */
static tet_status repair_face(refiner *r, uint32_t h, int thorough) {
  flip f = {0};
  int ok;
  if (flip_face(r, h >> 2, h & 3, &f) || flip_facet(r, h >> 2, h & 3, &f)) return apply(r, &f);
  if (!thorough) return refine_push(r, &r->stuck, h);
  tet_status status = restar(r, r->mesh.v[h], h >> 2, &ok);
  if (status || ok) return status;
  return restar(r, r->mesh.v[r->mesh.adj[h]], r->mesh.adj[h] >> 2, &ok);
}

static int is_broken(const refiner *r, uint32_t h) {
  return refine_alive(r, h >> 2) && refine_sub_at(r, h) == TET_NONE && !is_delaunay(r, h);
}

/* The first handle from h on at a face that is not Delaunay, the lower of its two, or that behind all slots. */
static uint32_t next_broken(const refiner *r, uint32_t h) {
  const tet_complex *m = &r->mesh;
  for (; h < 4 * m->n_slots; h++) {
    if (!(h & 3)) h = 4 * tet_complex_next_doubtful(m, h / 4);
    if (h < 4 * m->n_slots && m->adj[h] >= h && is_broken(r, h)) return h;
  }
  return 4 * m->n_slots;
}

/* Repairs the suspects. A 4-4 or 2-3 flip must not undo what another did: the total is bounded. */
static tet_status repair(refiner *r, int thorough) {
  refine_list *suspects = &r->suspects;
  tet_status status = TET_OK;
  uint32_t n = 0;
  for (uint32_t k = 0; k < suspects->n; k++)
    if (is_broken(r, suspects->at[k])) suspects->at[n++] = suspects->at[k];
  suspects->n = n;
  for (uint32_t budget = 100 + 10 * n; suspects->n && budget && !status; budget--) {
    uint32_t h = suspects->at[--suspects->n];
    if (is_broken(r, h)) status = repair_face(r, h, thorough);
  }
  suspects->n = 0;
  return status;
}

/* Repairs by flips alone; what sticks waits for refine_repair_stuck, as R1 and R2 heal most of it. */
tet_status refine_repair(refiner *r) { return r->suspects.n ? repair(r, 0) : TET_OK; }

tet_status refine_repair_stuck(refiner *r) {
  refine_list list = r->suspects;
  r->suspects = r->stuck;
  r->stuck = list;
  r->stuck.n = 0;
  return repair(r, 1);
}

/* Splits a subsegment or subface of tetrahedron t that one of its corners encroaches upon,
 * whatever protects it; else t itself. */
static tet_status split_at(refiner *r, uint32_t t, int *ret_done) {
  tet_status status = TET_OK;
  refine_outcome outcome = OUTCOME_REJECTED;
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  for (int e = 0; e < 6 && !status && outcome != OUTCOME_INSERTED && refine_alive(r, t); e++) {
    uint32_t by;
    if (!(r->tet_edges[t] >> e & 1)) continue;
    uint32_t seg = refine_find_seg(r, v[refine_edge[e][0]], v[refine_edge[e][1]]);
    status = refine_seg_encroached(r, seg, &by);
    if (!status && by != TET_NONE) status = refine_split_seg(r, seg, by, CAUSE_VERTEX, &outcome);
  }
  for (uint32_t h = 4 * t; h < 4 * t + 4 && !status && outcome != OUTCOME_INSERTED && refine_alive(r, t); h++) {
    uint32_t s = refine_sub_at(r, h);
    if (s != TET_NONE && refine_sub_encroached(r, s)) status = refine_split_sub(r, s, CAUSE_VERTEX, &outcome);
  }
  if (!status && outcome != OUTCOME_INSERTED && refine_alive(r, t)) {
    refine_shape shape;
    refine_measure(r, t, &shape);
    status = refine_split_tet(r, t, &shape, 0, &outcome);
  }
  *ret_done = outcome == OUTCOME_INSERTED;
  return status;
}

/* What keeps a face from being Delaunay that no flip repairs is an encroached subsegment or
 * subface, held off by protecting balls: the mesh being constrained Delaunay comes first. */
tet_status refine_repair_by_force(refiner *r, uint64_t *ret_done) {
  tet_status status = TET_OK;
  *ret_done = 0;
  r->forcing = 1;
  for (uint32_t h = next_broken(r, 0); h < 4 * r->mesh.n_slots && !status; h = next_broken(r, h + 1)) {
    int done = 0;
    status = split_at(r, h >> 2, &done);
    if (!status && !done && is_broken(r, h)) status = split_at(r, r->mesh.adj[h] >> 2, &done);
    *ret_done += (uint64_t)done;
  }
  r->forcing = 0;
  return status;
}

/* Repairs wherever there is something to repair. */
tet_status refine_repair_all(refiner *r) {
  tet_status status = TET_OK;
  for (uint32_t h = next_broken(r, 0); h < 4 * r->mesh.n_slots && !status; h = next_broken(r, h + 1)) {
    status = refine_push(r, &r->suspects, h);
    if (!status) status = repair(r, 1);
  }
  return status;
}
