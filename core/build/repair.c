// SPDX-License-Identifier: Apache-2.0
/* repair.c: after the Steiner points were rounded: exact flips that restore positive
 * volumes and the local Delaunay property off the subfaces (design section 4).
 *
 * A flip (2-3, 3-2, 4-4, and 2-2 inside a facet) is made only if all its new
 * tetrahedra are positive, so each one either lowers the number of tetrahedra that
 * are not, or, all being positive, lowers the lifted surface: it ends. */
#include "build/repair.h"

#include <math.h>
#include <string.h>

#include "build/repair_work.h"
#include "exact/predicates.h"

enum { MOST = 4 }; /* tetrahedra before or after one flip */

/* What one flip does. */
typedef struct flip {
  uint32_t old[MOST], made[MOST][4];
  int n_old, n_made;
  int in_facet;            /* edge xy of two subfaces becomes edge de of two others */
  uint32_t x, y, d, e;
  uint32_t facet_tri[2];   /* their triangles, at dex and dey */
} flip;

static int on_patch(const repair *r, uint32_t v, uint32_t patch) {
  for (uint32_t i = r->patch_start[v]; i < r->patch_start[v + 1]; i++)
    if (r->patches[i] == patch) return 1;
  return 0;
}

int tet_repair_may_be_made(const repair *r, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  if (tet_orient3d_xyz(repair_at(r, a), repair_at(r, b), repair_at(r, c), repair_at(r, d)) <= 0) return 0;
  if (tet_orient3d(&r->exact, a, b, c, d) != 0) return 1;
  if (r->strict) return 0;
  if (tet_collinear(&r->exact, a, b, c) || tet_collinear(&r->exact, a, b, d) || tet_collinear(&r->exact, a, c, d) ||
      tet_collinear(&r->exact, b, c, d))
    return 0;
  for (uint32_t i = r->patch_start[a]; i < r->patch_start[a + 1]; i++)
    if (on_patch(r, b, r->patches[i]) && on_patch(r, c, r->patches[i]) && on_patch(r, d, r->patches[i])) return 0;
  return 1;
}

int tet_repair_is_positive(const repair *r, uint32_t t) {
  const uint32_t *v = r->p->tets + 4 * (size_t)t;
  return tet_orient3d_xyz(repair_at(r, v[0]), repair_at(r, v[1]), repair_at(r, v[2]), repair_at(r, v[3])) > 0;
}

static uint32_t tri_at(const repair *r, uint32_t h) { return (*r->tri)[h]; }

static tet_status push(repair *r, uint32_t t) {
  return tet_push(r->ctx, &r->stack, &r->n_stack, &r->cap_stack, t);
}

static int same_face(const uint32_t *a, const uint8_t *fa, const uint32_t *b, const uint8_t *fb) {
  for (int i = 0; i < 3; i++) {
    uint32_t x = a[fa[i]];
    if (x != b[fb[0]] && x != b[fb[1]] && x != b[fb[2]]) return 0;
  }
  return 1;
}

tet_status tet_repair_new_slot(repair *r, uint32_t *ret_t) {
  tet_pieces *p = r->p;
  size_t n = (size_t)p->n_tets + 1;
  tet_status status = tet_grow(r->ctx, &p->tets, &r->cap_tets, 4 * n, sizeof *p->tets);
  if (status == TET_OK) status = tet_grow(r->ctx, &p->adj, &r->cap_adj, 4 * n, sizeof *p->adj);
  if (status == TET_OK) status = tet_grow(r->ctx, &p->region, &r->cap_region, n, sizeof *p->region);
  if (status == TET_OK) status = tet_grow(r->ctx, r->tri, &r->cap_tri, 4 * n, sizeof **r->tri);
  if (status == TET_OK) status = tet_grow(r->ctx, &r->made, &r->cap_made, n, 1);
  if (status != TET_OK) return status;
  p->tets[4 * (n - 1)] = TET_NONE;
  r->made[n - 1] = 1;
  *ret_t = p->n_tets++;
  return TET_OK;
}

tet_status tet_repair_made(repair *r, uint32_t t) {
  r->made[t] = 1;
  return tet_shift_note(r, t);
}

/* Slots for the new tetrahedra: the old ones' first. */
static tet_status take_slots(repair *r, const flip *f, uint32_t *slot) {
  for (int k = 0; k < f->n_made; k++) {
    if (k < f->n_old) {
      slot[k] = f->old[k];
      continue;
    }
    tet_status status = tet_repair_new_slot(r, &slot[k]);
    if (status != TET_OK) return status;
  }
  return TET_OK;
}

/* If face h of a tetrahedron v is dex or dey it becomes a subface. */
static void mark_subface(repair *r, const flip *f, const uint32_t *v, uint32_t h) {
  const uint8_t *i = tet_face[h & 3];
  for (int side = 0; side < 2; side++) {
    uint32_t want[3] = {f->d, f->e, side ? f->y : f->x};
    static const uint8_t straight[3] = {0, 1, 2};
    if (same_face(want, straight, v, i)) (*r->tri)[h] = f->facet_tri[side];
  }
}

/* Gives face i of new tetrahedron `t` its neighbour: what was outside the same old
 * face, or another new tetrahedron. */
static void join_face(repair *r, const flip *f, const uint32_t *slot, uint32_t before[MOST][3][4], int k, uint32_t i) {
  tet_pieces *p = r->p;
  uint32_t h = 4 * slot[k] + i;
  (*r->tri)[h] = TET_NONE;
  p->adj[h] = TET_NONE;
  for (int q = 0; q < f->n_old; q++)
    for (uint32_t j = 0; j < 4; j++) {
      uint32_t outside = before[q][1][j];
      int inner = 0;
      for (int w = 0; w < f->n_old; w++) inner |= outside != TET_NONE && outside >> 2 == f->old[w];
      if (inner || !same_face(f->made[k], tet_face[i], before[q][0], tet_face[j])) continue;
      p->adj[h] = outside;
      if (outside != TET_NONE) p->adj[outside] = h;
      (*r->tri)[h] = before[q][2][j];
      return;
    }
  for (int q = 0; q < f->n_made; q++)
    for (uint32_t j = 0; j < 4; j++)
      if (q != k && same_face(f->made[k], tet_face[i], f->made[q], tet_face[j])) p->adj[h] = 4 * slot[q] + j;
  if (f->in_facet) mark_subface(r, f, f->made[k], h);
}

static tet_status apply(repair *r, const flip *f) {
  tet_pieces *p = r->p;
  uint32_t slot[MOST], before[MOST][3][4]; /* vertices, neighbours, triangles */
  for (int q = 0; q < f->n_old; q++)
    for (int j = 0; j < 4; j++) {
      size_t h = 4 * (size_t)f->old[q] + (size_t)j;
      before[q][0][j] = p->tets[h];
      before[q][1][j] = p->adj[h];
      before[q][2][j] = (*r->tri)[h];
    }
  uint32_t region[2] = {p->region[f->old[0]], p->region[f->old[f->n_old == 4 ? 2 : 0]]};
  tet_status status = take_slots(r, f, slot);
  if (status != TET_OK) return status;
  for (int k = 0; k < f->n_made; k++) {
    memcpy(p->tets + 4 * (size_t)slot[k], f->made[k], sizeof f->made[k]);
    p->region[slot[k]] = region[k >= 2];
  }
  for (int k = 0; k < f->n_made; k++)
    for (uint32_t i = 0; i < 4; i++) join_face(r, f, slot, before, k, i);
  for (int q = f->n_made; q < f->n_old; q++) p->tets[4 * (size_t)f->old[q]] = TET_NONE;
  r->flips++;
  for (int k = 0; k < f->n_made && status == TET_OK; k++) {
    status = tet_repair_made(r, slot[k]);
    if (status == TET_OK) status = push(r, slot[k]);
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t g = p->adj[4 * (size_t)slot[k] + i];
      if (g != TET_NONE) status = push(r, g >> 2);
    }
  }
  return status;
}

static void add(flip *f, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  uint32_t *v = f->made[f->n_made++];
  v[0] = a;
  v[1] = b;
  v[2] = c;
  v[3] = d;
}

/* Completes a flip that removes edge xy of face xyz (outward from t, apex d; e
 * beyond): 3-2, 4-4 or, on the boundary, 2-2. 0 where xy must stay. */
static int remove_edge(const repair *r, uint32_t h, uint32_t x, uint32_t y, uint32_t z, flip *f) {
  const tet_pieces *p = r->p;
  uint32_t g = p->adj[h], t = h >> 2, o = g >> 2, d = p->tets[h], e = p->tets[g];
  if (tet_edge_map_get(&r->subsegs, x, y) != TET_NONE) return 0;
  uint32_t a = 4 * t + tet_corner_of(r->p, t, z), b = 4 * o + tet_corner_of(r->p, o, z);
  uint32_t na = p->adj[a], nb = p->adj[b];
  *f = (flip){.old = {t, o}, .n_old = 2, .x = x, .y = y, .d = d, .e = e, .facet_tri = {tri_at(r, a), tri_at(r, b)}};
  f->in_facet = f->facet_tri[0] != TET_NONE;
  if (f->in_facet != (f->facet_tri[1] != TET_NONE)) return 0;
  add(f, d, y, z, e);
  add(f, d, z, x, e);
  if (na == TET_NONE || nb == TET_NONE) return f->in_facet && na == nb;
  if (na >> 2 == nb >> 2) {
    f->old[f->n_old++] = na >> 2;
    return !f->in_facet;
  }
  uint32_t w = p->tets[na], t2 = na >> 2, o2 = nb >> 2, between = 4 * t2 + tet_corner_of(p, t2, d);
  if (p->tets[nb] != w || p->adj[between] != 4 * o2 + tet_corner_of(p, o2, e)) return 0;
  if (tri_at(r, between) != TET_NONE) return 0;
  f->old[f->n_old++] = t2;
  f->old[f->n_old++] = o2;
  add(f, y, d, w, e);
  add(f, w, d, x, e);
  return 1;
}

static int all_may_be_made(const repair *r, const flip *f) {
  for (int k = 0; k < f->n_made; k++) {
    const uint32_t *v = f->made[k];
    if (!tet_repair_may_be_made(r, v[0], v[1], v[2], v[3])) return 0;
  }
  return 1;
}

/* 1: the faces dez and dew that a 2-2 or 4-4 flip makes are locally Delaunay. Where
 * d, x, y, e are coplanar only up to rounding this does not follow, and flips
 * could go back and forth. */
static int stays_flipped(const repair *r, const flip *f) {
  for (int k = 0; k < f->n_made; k += 2) {
    const uint32_t *v = f->made[k];
    if (tet_insphere_xyz(repair_at(r, v[0]), repair_at(r, v[1]), repair_at(r, v[2]), repair_at(r, v[3]), repair_at(r, f->x)) > 0) return 0;
  }
  return 1;
}

/* Tries to flip face h away. */
static tet_status try_face(repair *r, uint32_t h, const tet_surface *surface, int *ret_done) {
  const tet_pieces *p = r->p;
  uint32_t t = h >> 2, g = p->adj[h], d = p->tets[h], e = p->tets[g], v[3];
  flip f = {.old = {t, g >> 2}, .n_old = 2};
  for (int k = 0; k < 3; k++) v[k] = p->tets[4 * (size_t)t + tet_face[h & 3][k]];
  for (int k = 0; k < 3; k++) add(&f, d, v[k], v[(k + 1) % 3], e);
  *ret_done = all_may_be_made(r, &f);
  for (int k = 0; k < 3 && !*ret_done; k++) {
    uint32_t x = v[k], y = v[(k + 1) % 3];
    if (tet_repair_may_be_made(r, d, x, y, e) || !remove_edge(r, h, x, y, v[(k + 2) % 3], &f)) continue;
    if (f.in_facet && surface->tri_patch[f.facet_tri[0]] != surface->tri_patch[f.facet_tri[1]]) continue;
    if (f.in_facet && (tet_collinear(&r->exact, d, e, x) || tet_collinear(&r->exact, d, e, y))) continue;
    *ret_done = all_may_be_made(r, &f) && (f.n_old == 3 || stays_flipped(r, &f));
  }
  return *ret_done ? apply(r, &f) : TET_OK;
}

int tet_repair_is_bad_face(const repair *r, uint32_t h, int t_positive) {
  const tet_pieces *p = r->p;
  uint32_t g = p->adj[h], t = h >> 2;
  if (g == TET_NONE || tri_at(r, h) != TET_NONE) return 0;
  if (!t_positive || !tet_repair_is_positive(r, g >> 2)) return 1;
  const uint32_t *v = p->tets + 4 * (size_t)t;
  return tet_insphere_xyz(repair_at(r, v[0]), repair_at(r, v[1]), repair_at(r, v[2]), repair_at(r, v[3]), repair_at(r, p->tets[g])) > 0;
}

/* *ret_stuck: 1 where there was something bad without a flip that helps; else nothing bad is left. */
static tet_status flip_all(repair *r, const tet_surface *surface, int *ret_stuck) {
  tet_status status = TET_OK;
  *ret_stuck = 0;
  while (r->n_stack && status == TET_OK) {
    uint32_t t = r->stack[--r->n_stack];
    if (repair_is_dead(r, t)) continue;
    int ok = tet_repair_is_positive(r, t), bad = !ok, done = 0;
    for (uint32_t i = 0; i < 4 && !done && status == TET_OK; i++) {
      if (!tet_repair_is_bad_face(r, 4 * t + i, ok)) continue;
      bad = 1;
      status = try_face(r, 4 * t + i, surface, &done);
    }
    *ret_stuck |= bad && !done;
    if (status == TET_OK) status = tet_poll(r->ctx);
  }
  return status;
}

void tet_close_gaps(tet_pieces *p, uint32_t *tri) {
  for (uint32_t t = 0; t < p->n_tets;) {
    if (p->tets[4 * (size_t)t] != TET_NONE) {
      t++;
      continue;
    }
    uint32_t last = --p->n_tets;
    if (last == t || p->tets[4 * (size_t)last] == TET_NONE) continue;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t g = p->adj[4 * (size_t)last + i];
      p->tets[4 * (size_t)t + i] = p->tets[4 * (size_t)last + i];
      p->adj[4 * (size_t)t + i] = g;
      tri[4 * (size_t)t + i] = tri[4 * (size_t)last + i];
      if (g != TET_NONE) p->adj[g] = 4 * t + i;
    }
    p->region[t] = p->region[last];
    p->tets[4 * (size_t)last] = TET_NONE;
  }
}

static int has_steiner_point(const repair *r, uint32_t t) {
  const uint32_t *v = r->p->tets + 4 * (size_t)t;
  uint32_t first = r->exact.first_implicit;
  return v[0] >= first || v[1] >= first || v[2] >= first || v[3] >= first;
}

/* 0: t and, once something was made, what is beside it are as before rounding, which moved none of their vertices. */
static int may_be_bad(const repair *r, uint32_t t) {
  if (r->made[t] || has_steiner_point(r, t)) return 1;
  for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4 && (r->flips || r->refills); h++) {
    uint32_t g = r->p->adj[h];
    if (g != TET_NONE && (r->made[g >> 2] || r->p->tets[g] >= r->exact.first_implicit)) return 1;
  }
  return 0;
}

int tet_repair_is_bad(const repair *r, uint32_t t) {
  if (!may_be_bad(r, t)) return 0;
  int ok = tet_repair_is_positive(r, t), bad = !ok;
  for (uint32_t i = 0; i < 4 && !bad; i++) bad = tet_repair_is_bad_face(r, 4 * t + i, ok);
  return bad;
}

/* Mends bad tetrahedron t where it stands: by a shift of a Steiner point near it, or by
 * filling its place anew. */
static tet_status mend(repair *r, uint32_t t, int *ret_done) {
  uint32_t near[8], n = 0;
  tet_status status = TET_OK;
  int ok = tet_repair_is_positive(r, t);
  for (uint32_t i = 0; i < 4; i++) {
    near[n++] = r->p->tets[4 * (size_t)t + i];
    if (tet_repair_is_bad_face(r, 4 * t + i, ok)) near[n++] = r->p->tets[r->p->adj[4 * (size_t)t + i]];
  }
  *ret_done = 0;
  for (uint32_t k = 0; k < n && !*ret_done && status == TET_OK; k++)
    if (near[k] >= r->exact.first_implicit) status = tet_shift(r, near[k], ret_done);
  if (status == TET_OK && !*ret_done) status = tet_refill(r, t, ret_done);
  for (uint32_t i = 0; i < 4 && !*ret_done && status == TET_OK; i++)
    if (tet_repair_is_bad_face(r, 4 * t + i, ok)) status = tet_refill_facet(r, 4 * t + i, ret_done);
  return status;
}

/* Where flips stick. Each shift and each refill leaves fewer bad faces. */
static tet_status mend_all(repair *r) {
  tet_status status = TET_OK;
  for (int any = 1; any && status == TET_OK;) {
    any = 0;
    for (uint32_t t = 0; t < r->p->n_tets && status == TET_OK; t++) {
      int done = 0;
      if (repair_is_dead(r, t) || !tet_repair_is_bad(r, t)) continue;
      status = mend(r, t, &done);
      any |= done;
      if (status == TET_OK) status = tet_poll(r->ctx);
    }
  }
  return status;
}

/* Puts what is bad still on the stack. */
static tet_status push_bad(repair *r) {
  tet_status status = TET_OK;
  for (uint32_t t = r->p->n_tets; t-- > 0 && status == TET_OK;)
    if (!repair_is_dead(r, t) && tet_repair_is_bad(r, t)) status = push(r, t);
  return status;
}

/* First without tetrahedra whose vertices were coplanar before rounding: they are as thin as
 * rounding is, and points that move a little mostly make do without them. */
static tet_status flip_and_mend(repair *r) {
  tet_status status = TET_OK;
  for (int strict = 1; strict >= 0 && r->n_stack && status == TET_OK; strict--) {
    int stuck;
    r->strict = strict;
    status = flip_all(r, r->surface, &stuck);
    if (status == TET_OK && stuck) status = mend_all(r);
    if (status == TET_OK && stuck && strict) status = push_bad(r);
  }
  return status;
}

/* The best place to break a subsegment that keeps bad tetrahedron t from being flipped: where
 * the edge that would replace it passes. One break for each subsegment is enough: `taken`. */
static tet_status break_at(const repair *r, uint32_t t, uint8_t *taken, tet_breaks *breaks) {
  const uint32_t *v = r->p->tets + 4 * (size_t)t;
  int ok = tet_repair_is_positive(r, t);
  double gap = INFINITY;
  uint32_t which = TET_NONE;
  tet_break best = {0, 0};
  for (uint32_t i = 0; i < 4; i++) {
    int bad = tet_repair_is_bad_face(r, 4 * t + i, ok);
    for (int k = 0; k < 3; k++) {
      uint32_t x = v[tet_face[i][k]], y = v[tet_face[i][(k + 1) % 3]], z = v[tet_face[i][(k + 2) % 3]];
      uint32_t sub = tet_edge_map_get(&r->subsegs, x, y), over = bad ? r->p->tets[r->p->adj[4 * t + i]] : z;
      double before = gap;
      if (sub == TET_NONE || (!bad && ok)) continue;
      tet_break_consider(r->surface, &r->exact, r->p->points, sub, x, y, v[i], over, &best, &gap);
      if (gap < before) which = sub;
    }
  }
  if (which == TET_NONE || taken[which]) return TET_OK;
  taken[which] = 1;
  return tet_breaks_add(r->ctx, breaks, &best);
}

/* 1: face h is a subface that rounding has turned over, or made flat, in its facet's projection. */
static int is_folded(const repair *r, uint32_t h) {
  const uint32_t *t = r->p->tets + (h & ~(size_t)3);
  uint32_t k = tri_at(r, h), a = t[tet_face[h & 3][0]], b = t[tet_face[h & 3][1]], c = t[tet_face[h & 3][2]];
  if (k == TET_NONE) return 0;
  uint32_t first = r->exact.first_implicit;
  if (a < first && b < first && c < first) return 0;
  int axis = r->surface->patch[r->surface->tri_patch[k]].axis;
  return tet_orient2d_xyz(axis, repair_at(r, a), repair_at(r, b), repair_at(r, c)) != tet_orient2d(&r->exact, axis, a, b, c);
}

static tet_status verify_subfaces(const repair *r) {
  uint64_t n = 0;
  const double *place_of = NULL;
  for (uint32_t h = 0; h < 4 * r->p->n_tets; h++) {
    if (!is_folded(r, h)) continue;
    n++;
    place_of = repair_at(r, r->p->tets[(h & ~3U) + tet_face[h & 3][0]]);
  }
  if (!n) return TET_OK;
  return tet_fail(r->ctx, TET_E_ROUNDING,
                  "facets closer than doubles hold: rounding turns %llu sides of subfaces over, near (%.17g, %.17g, %.17g)",
                  (unsigned long long)n, place_of[0], place_of[1], place_of[2]);
}

/* TET_E_ROUNDING, with places to break; without gaps. */
static tet_status fail(repair *r, tet_breaks *breaks) {
  uint64_t n = 0;
  const double *place_of = NULL;
  uint8_t *taken = tet_calloc(r->ctx, r->surface->n_subsegs, 1);
  tet_status status = taken ? TET_OK : tet_ctx_error(r->ctx)->status;
  memset(r->made, 1, r->p->n_tets); /* others have taken the places of those */
  for (uint32_t t = 0; t < r->p->n_tets && status == TET_OK; t++) {
    if (!tet_repair_is_bad(r, t)) continue;
    n++;
    place_of = repair_at(r, r->p->tets[4 * (size_t)t]);
    status = break_at(r, t, taken, breaks);
  }
  tet_free(r->ctx, taken);
  if (status != TET_OK) return status;
  tet_breaks_sort(breaks);
  return tet_fail(r->ctx, TET_E_ROUNDING,
                  "facets closer than doubles hold: rounding leaves %llu tetrahedra inverted or not locally Delaunay, "
                  "near (%.17g, %.17g, %.17g)",
                  (unsigned long long)n, place_of[0], place_of[1], place_of[2]);
}

/* Closes the gaps; an error where something bad is left. */
static tet_status verify(repair *r, tet_breaks *breaks) {
  int bad = 0;
  for (uint32_t t = 0; t < r->p->n_tets && !bad; t++) bad = !repair_is_dead(r, t) && tet_repair_is_bad(r, t);
  tet_close_gaps(r->p, *r->tri);
  return bad ? fail(r, breaks) : verify_subfaces(r);
}

/* Fills the lists of patches at each vertex. */
static tet_status list_patches(repair *r, const tet_surface *s) {
  size_t n = (size_t)r->p->n_points + 2;
  r->patch_start = tet_calloc(r->ctx, n, sizeof *r->patch_start);
  r->patches = tet_alloc(r->ctx, 3 * (size_t)s->n_tris, sizeof *r->patches);
  if (!r->patch_start || !r->patches) return tet_ctx_error(r->ctx)->status;
  for (size_t i = 0; i < 3 * (size_t)s->n_tris; i++) r->patch_start[s->tri[i] + 2]++;
  for (size_t v = 2; v < n; v++) r->patch_start[v] += r->patch_start[v - 1];
  for (size_t i = 0; i < 3 * (size_t)s->n_tris; i++) r->patches[r->patch_start[s->tri[i] + 1]++] = s->tri_patch[i / 3];
  return TET_OK;
}

tet_status tet_repair(tet_ctx *ctx, const tet_surface *surface, const tet_points *exact, tet_pieces *p,
                      uint32_t **tri, tet_breaks *breaks, tet_counts *counts) {
  size_t n = p->n_tets;
  repair r = {.ctx = ctx, .p = p, .surface = surface, .exact = *exact, .tri = tri, .cap_tets = 4 * n, .cap_adj = 4 * n, .cap_region = n, .cap_tri = 4 * n};
  tet_status status = TET_OK;
  r.exact.x = p->points; /* moved there */
  r.rounded = tet_points_explicit(p->points, p->n_points);
  r.rounded.max_abs = r.exact.max_abs;
  r.made = tet_calloc(ctx, n, 1);
  r.cap_made = n;
  if (!r.made) status = tet_ctx_error(ctx)->status;
  for (uint32_t t = (uint32_t)n; t-- > 0 && status == TET_OK;)
    if (has_steiner_point(&r, t)) status = push(&r, t);
  for (uint32_t e = 0; e < surface->n_subsegs && r.n_stack && status == TET_OK; e++)
    status = tet_edge_map_put(ctx, &r.subsegs, surface->subseg[2 * (size_t)e], surface->subseg[2 * (size_t)e + 1], e);
  if (status == TET_OK) status = list_patches(&r, surface);
  if (status == TET_OK) status = flip_and_mend(&r);
  if (status == TET_OK) status = verify(&r, breaks);
  counts->rounding_flips = r.flips + r.refills;
  counts->rounding_moves = r.moves;
  tet_edge_map_free(ctx, &r.subsegs);
  void *all[] = {r.made, r.mark, r.star, r.beside, r.reach, r.first, r.entry, r.patch_start, r.patches, r.stack};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  return status;
}
