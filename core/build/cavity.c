// SPDX-License-Identifier: Apache-2.0
/* cavity.c: TETRAHEDRALIZECAVITY of thesis 5.4.1 (Fig. 5.11), verification and
 * tetrahedralization in one, as in A.3.4.
 *
 * The Delaunay tetrahedralization of the cavity's vertices, under the perturbation
 * of the whole, mostly holds every face of the cavity's border; inside and outside
 * are then told apart by flooding from the oriented border, never by centroids. Where
 * a face is missing, vertices that do not see each other are in the way, and the
 * cavity is wrapped (wrap.c). The thesis lets it grow instead, at the price of
 * subfaces to recover again; the result is the same CDT. */
#include "build/cavity.h"

#include <string.h>

#include "mesh/delaunay.h"
#include "build/wrap.h"

/* Room for the faces of all slots; new entries are TET_NONE. */
static tet_status cover_slots(tet_cavity *c) {
  size_t from = c->cap_face_tri;
  tet_status status =
      tet_grow(c->st->ctx, &c->face_tri, &c->cap_face_tri, 4 * (size_t)c->st->complex.n_slots, sizeof *c->face_tri);
  for (size_t i = from; status == TET_OK && i < c->cap_face_tri; i++) c->face_tri[i] = TET_NONE;
  return status;
}

tet_status tet_cavity_init(tet_cavity *c, tet_state *st) {
  memset(c, 0, sizeof *c);
  c->st = st;
  tet_complex_init(&c->local, st->ctx, &st->points);
  tet_status status = tet_complex_reserve_vertices(&c->local, st->points.n);
  c->has_vertex = tet_calloc(st->ctx, st->points.n, 1);
  if (status == TET_OK && !c->has_vertex) status = tet_ctx_error(st->ctx)->status;
  return status == TET_OK ? cover_slots(c) : status;
}

void tet_cavity_free(tet_cavity *c) {
  if (!c->st) return;
  tet_ctx *ctx = c->st->ctx;
  tet_complex_free(&c->local);
  void *all[] = {c->face_tri, c->omega, c->crossed, c->border[0], c->border[1], c->vertex,
                 c->has_vertex, c->shown, c->image, c->blocked, c->inside, c->floor};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  memset(c, 0, sizeof *c);
}

static tet_status add_vertex(tet_cavity *c, uint32_t v) {
  if (c->has_vertex[v]) return TET_OK;
  c->has_vertex[v] = 1;
  return tet_push(c->st->ctx, &c->vertex, &c->n_vertex, &c->cap_vertex, v);
}

/* The vertices of the cavity on one side: those of Omega and those of the crossed
 * tetrahedra not beyond it. */
static tet_status collect_vertices(tet_cavity *c, const int8_t *side, int up) {
  tet_status status = TET_OK;
  c->n_vertex = 0;
  for (size_t k = 0; k < c->n_omega; k++)
    for (int j = 0; j < 3 && status == TET_OK; j++)
      status = add_vertex(c, c->st->surface.tri[3 * (size_t)c->omega[k] + (size_t)j]);
  for (size_t k = 0; k < c->n_crossed; k++)
    for (int j = 0; j < 4 && status == TET_OK; j++) {
      uint32_t v = c->st->complex.v[4 * (size_t)c->crossed[k] + (size_t)j];
      if (side[v] == (up ? 1 : -1)) status = add_vertex(c, v);
    }
  return status;
}

/* The local Delaunay tetrahedralization of the vertices. */
static tet_status triangulate(tet_cavity *c) {
  tet_complex *l = &c->local;
  tet_complex_clear(l);
  return tet_delaunay(l, c->vertex, (uint32_t)c->n_vertex, 1);
}

/* The local handle, inside the cavity, of the face that border handle h shows. */
static tet_status find_border(tet_cavity *c, uint32_t h, uint32_t *ret) {
  const uint32_t *v = c->st->complex.v + 4 * (size_t)(h >> 2);
  const uint8_t *f = tet_face[h & 3];
  return tet_complex_find_face(&c->local, v[f[0]], v[f[1]], v[f[2]], ret);
}

/* The same of triangle k of Omega, seen from above or below. */
static tet_status find_omega(tet_cavity *c, size_t k, int up, uint32_t *ret) {
  const uint32_t *v = c->st->surface.tri + 3 * (size_t)c->omega[k];
  return tet_complex_find_face(&c->local, v[0], v[up ? 2 : 1], v[up ? 1 : 2], ret);
}

/* Phase (1): whether the local tetrahedralization has all of the cavity's faces; and where, into
 * c->shown. */
static tet_status verify(tet_cavity *c, int up, int *ret_all) {
  size_t n = c->n_omega + c->n_border[up];
  tet_status status = tet_poll(c->st->ctx);
  if (status == TET_OK) status = tet_grow(c->st->ctx, &c->shown, &c->cap_shown, n, sizeof *c->shown);
  *ret_all = 1;
  for (size_t k = 0; k < n && *ret_all && status == TET_OK; k++) {
    uint32_t *l = &c->shown[k];
    status = k < c->n_omega ? find_omega(c, k, up, l) : find_border(c, c->border[up][k - c->n_omega], l);
    *ret_all = status != TET_OK || *l != TET_NONE;
  }
  return status;
}

static tet_status enter(tet_cavity *c, uint32_t local) {
  if (c->image[local] != TET_NONE) return TET_OK;
  if (tet_is_ghost(&c->local, local)) return tet_internal(c->st->ctx, "a cavity leaks");
  c->image[local] = 0;
  return tet_push(c->st->ctx, &c->inside, &c->n_inside, &c->cap_inside, local);
}

static void block(tet_cavity *c, uint32_t l) {
  uint32_t o = c->local.adj[l];
  c->blocked[l >> 2] |= (uint8_t)(1 << (l & 3));
  c->blocked[o >> 2] |= (uint8_t)(1 << (o & 3));
}

/* Finds the local tetrahedra inside the cavity by flooding from its border. */
static tet_status flood_inside(tet_cavity *c, int up) {
  tet_ctx *ctx = c->st->ctx;
  size_t n = c->local.n_slots;
  tet_status status = tet_grow(ctx, &c->image, &c->cap_image, n, sizeof *c->image);
  if (status == TET_OK) status = tet_grow(ctx, &c->blocked, &c->cap_blocked, n, 1);
  if (status != TET_OK) return status;
  memset(c->image, 0xff, n * sizeof *c->image);
  memset(c->blocked, 0, n);
  c->n_inside = 0;
  for (size_t k = 0; k < c->n_omega + c->n_border[up] && status == TET_OK; k++) {
    block(c, c->shown[k]);
    status = enter(c, c->shown[k] >> 2);
  }
  for (size_t k = 0; k < c->n_inside && status == TET_OK; k++) {
    uint32_t t = c->inside[k];
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++)
      if (!(c->blocked[t] >> i & 1)) status = enter(c, c->local.adj[4 * (size_t)t + i] >> 2);
  }
  return status;
}

/* Copies the inside tetrahedra into the complex and links them to each other. */
static tet_status copy_inside(tet_cavity *c) {
  tet_complex *m = &c->st->complex;
  const tet_complex *l = &c->local;
  tet_status status = TET_OK;
  for (size_t k = 0; k < c->n_inside && status == TET_OK; k++) {
    status = tet_complex_new(m, &c->image[c->inside[k]]);
    if (status == TET_OK) status = cover_slots(c);
  }
  if (status != TET_OK) return status;
  for (size_t k = 0; k < c->n_inside; k++) {
    size_t t = c->inside[k], n = c->image[t];
    for (size_t i = 0; i < 4; i++) {
      m->v[4 * n + i] = l->v[4 * t + i];
      m->at[m->v[4 * n + i]] = (uint32_t)n;
      c->face_tri[4 * n + i] = TET_NONE;
      uint32_t g = l->adj[4 * t + i];
      if (!(c->blocked[t] >> i & 1)) m->adj[4 * n + i] = 4 * c->image[g >> 2] + (g & 3);
    }
  }
  return TET_OK;
}

/* Joins face `made` of a new tetrahedron to what is beyond the cavity's border h: at a
 * slit, to the crossed tetrahedron there until its own turn comes, which finds `made`. */
static void join_border(tet_cavity *c, uint32_t made, uint32_t h) {
  tet_complex *m = &c->st->complex;
  uint32_t outside = m->adj[h];
  c->face_tri[made] = c->face_tri[outside];
  tet_link(m, made, outside);
}

/* Makes face `made` triangle k of Omega; the one below meets the one above. */
static void join_omega(tet_cavity *c, uint32_t made, size_t k, int up) {
  c->face_tri[made] = c->omega[k];
  if (up) c->floor[k] = made;
  else tet_link(&c->st->complex, made, c->floor[k]);
}

/* Phase (2): fills the cavity from the local tetrahedralization. */
static tet_status fill_from_local(tet_cavity *c, int up) {
  tet_status status = flood_inside(c, up);
  if (status == TET_OK) status = copy_inside(c);
  for (size_t k = 0; k < c->n_omega + c->n_border[up] && status == TET_OK; k++) {
    uint32_t l = c->shown[k], made = 4 * c->image[l >> 2] + (l & 3);
    if (k < c->n_omega) join_omega(c, made, k, up);
    else join_border(c, made, c->border[up][k - c->n_omega]);
  }
  return status;
}

/* The cavity's faces, positive towards its inside; tags: Omega's, then the border's. */
static tet_status make_front(tet_cavity *c, int up, tet_wrap *w) {
  const tet_complex *m = &c->st->complex;
  w->n_front = c->n_omega + c->n_border[up];
  tet_status status = tet_grow(w->ctx, &w->front, &w->cap_front, w->n_front, sizeof *w->front);
  for (size_t k = 0; k < w->n_front && status == TET_OK; k++) {
    tet_front *f = &w->front[k];
    *f = (tet_front){.tag = (uint32_t)k};
    if (k < c->n_omega) {
      const uint32_t *v = c->st->surface.tri + 3 * (size_t)c->omega[k];
      f->v[0] = v[0];
      f->v[1] = v[up ? 1 : 2];
      f->v[2] = v[up ? 2 : 1];
    } else {
      uint32_t h = c->border[up][k - c->n_omega];
      const uint8_t *i = tet_face[h & 3]; /* outward there, so turned */
      for (int j = 0; j < 3; j++) f->v[j] = m->v[4 * (size_t)(h >> 2) + i[2 - j]];
    }
  }
  return status;
}

/* Copies what wrapping made into the complex. */
static tet_status copy_wrapped(tet_cavity *c, int up, const tet_wrap *w) {
  tet_complex *m = &c->st->complex;
  tet_status status = tet_grow(w->ctx, &c->image, &c->cap_image, w->n_made, sizeof *c->image);
  for (size_t k = 0; k < w->n_made && status == TET_OK; k++) {
    status = tet_complex_new(m, &c->image[k]);
    if (status == TET_OK) status = cover_slots(c);
  }
  for (size_t k = 0; k < w->n_made && status == TET_OK; k++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t h = 4 * c->image[k] + i, link = w->link[k][i];
      m->v[h] = w->made[k][i];
      m->at[m->v[h]] = c->image[k];
      c->face_tri[h] = TET_NONE;
      if (!(link & TET_WRAP_TAG)) m->adj[h] = 4 * c->image[link >> 2] + (link & 3);
    }
  for (size_t k = 0; k < w->n_made && status == TET_OK; k++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t h = 4 * c->image[k] + i, tag = w->link[k][i] & ~TET_WRAP_TAG;
      if (!(w->link[k][i] & TET_WRAP_TAG)) continue;
      if (tag < c->n_omega) join_omega(c, h, tag, up);
      else join_border(c, h, c->border[up][tag - c->n_omega]);
    }
  return status;
}

/* Phase (2) where phase (1) fails: the cavity's constrained Delaunay
 * tetrahedralization by gift wrapping. */
static tet_status fill_by_wrapping(tet_cavity *c, int up) {
  tet_wrap w = {.ctx = c->st->ctx, .points = &c->st->points, .vertex = c->vertex, .n_vertex = c->n_vertex};
  tet_status status = make_front(c, up, &w);
  int filled = 0;
  if (status == TET_OK) status = tet_wrap_fill(&w, &filled);
  if (status == TET_OK && !filled) status = tet_internal(w.ctx, "a cavity's face has no apex");
  if (status == TET_OK) status = copy_wrapped(c, up, &w);
  tet_wrap_free(&w);
  return status;
}

/* Fills the cavity on one side and joins it to what surrounds it. */
static tet_status fill_side(tet_cavity *c, const int8_t *side, int up) {
  int all;
  tet_status status = collect_vertices(c, side, up);
  for (size_t k = 0; k < c->n_vertex; k++) c->has_vertex[c->vertex[k]] = 0;
  if (status == TET_OK) status = triangulate(c);
  if (status == TET_OK) status = verify(c, up, &all);
  if (status != TET_OK) return status;
  return all ? fill_from_local(c, up) : fill_by_wrapping(c, up);
}

tet_status tet_cavity_fill(tet_cavity *c, const int8_t *side) {
  tet_complex *m = &c->st->complex;
  tet_status status = tet_grow(c->st->ctx, &c->floor, &c->cap_floor, c->n_omega, sizeof *c->floor);
  if (status == TET_OK) status = fill_side(c, side, 1);
  if (status == TET_OK) status = fill_side(c, side, 0);
  if (status != TET_OK) return status;
  for (size_t k = 0; k < c->n_crossed; k++) tet_complex_delete(m, c->crossed[k]);
  return TET_OK;
}
