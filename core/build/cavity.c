// SPDX-License-Identifier: Apache-2.0
/* cavity.c: TETRAHEDRALIZECAVITY of thesis 5.4.1 (Fig. 5.11), verification and
 * tetrahedralization in one, as in A.3.4.
 *
 * The Delaunay tetrahedralization of the cavity's vertices, under the perturbation
 * of the whole, must hold every face of the cavity's border. Where one is missing
 * the cavity grows by the tetrahedron beyond it. Inside and outside are told apart
 * by flooding from the oriented border, never by centroids. */
#include "build/cavity.h"

#include <string.h>

#include "build/delaunay.h"

static tet_status push(tet_ctx *ctx, uint32_t **array, size_t *n, size_t *cap, uint32_t value) {
  tet_status status = tet_grow(ctx, array, cap, *n + 1, sizeof **array);
  if (status == TET_OK) (*array)[(*n)++] = value;
  return status;
}

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
  void *all[] = {c->face_tri, c->omega, c->crossed, c->border[0], c->border[1], c->lost,  c->vertex,
                 c->has_vertex, c->image, c->blocked, c->inside, c->floor};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  memset(c, 0, sizeof *c);
}

static tet_status add_vertex(tet_cavity *c, uint32_t v) {
  if (c->has_vertex[v]) return TET_OK;
  c->has_vertex[v] = 1;
  return push(c->st->ctx, &c->vertex, &c->n_vertex, &c->cap_vertex, v);
}

/* The vertices of the cavity on one side: those of Omega and those of the crossed
 * tetrahedra not beyond it. */
static tet_status collect_vertices(tet_cavity *c, const int8_t *side, int up) {
  tet_status status = TET_OK;
  c->n_vertex = c->n_inserted = 0;
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

/* Brings the local Delaunay tetrahedralization up to date with the vertices. */
static tet_status insert_vertices(tet_cavity *c) {
  tet_complex *l = &c->local;
  tet_status status = TET_OK;
  if (!c->n_inserted) {
    l->n_slots = l->n_live = 0;
    l->n_free = 0;
    l->last = TET_NONE;
    status = tet_delaunay(l, c->vertex, (uint32_t)c->n_vertex);
  } else {
    for (size_t i = c->n_inserted; i < c->n_vertex && status == TET_OK; i++)
      status = tet_complex_insert(l, c->vertex[i], TET_NONE);
  }
  c->n_inserted = c->n_vertex;
  return status;
}

/* Adds the tetrahedron beyond border face h to the cavity. */
static tet_status grow(tet_cavity *c, uint32_t h, int up) {
  tet_complex *m = &c->st->complex;
  tet_ctx *ctx = c->st->ctx;
  uint32_t t = m->adj[h] >> 2;
  if (tet_is_ghost(m, t)) return tet_internal(ctx, "a cavity grows out of the convex hull");
  if (m->flag[t] & TET_FLAG_CAVITY) return tet_internal(ctx, "a cavity grows into its other half");
  m->flag[t] |= TET_FLAG_CAVITY;
  tet_status status = push(ctx, &c->crossed, &c->n_crossed, &c->cap_crossed, t);
  for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
    uint32_t inner = 4 * t + i, o = m->adj[inner];
    if (m->flag[o >> 2] & (TET_FLAG_BORDER << (o & 3))) { /* was border: now inside */
      m->flag[o >> 2] &= (uint8_t) ~(TET_FLAG_BORDER << (o & 3));
      if (c->face_tri[o] != TET_NONE) status = push(ctx, &c->lost, &c->n_lost, &c->cap_lost, c->face_tri[o]);
    } else {
      m->flag[t] |= (uint8_t)(TET_FLAG_BORDER << i);
      status = push(ctx, &c->border[up], &c->n_border[up], &c->cap_border[up], inner);
    }
    if (status == TET_OK) status = add_vertex(c, m->v[4 * (size_t)t + i]);
  }
  return status;
}

static int is_border(const tet_cavity *c, uint32_t h) {
  return (c->st->complex.flag[h >> 2] & (TET_FLAG_BORDER << (h & 3))) != 0;
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

/* Phase (1): grows the cavity until the local tetrahedralization has all of its
 * border. */
static tet_status verify(tet_cavity *c, int up) {
  tet_status status = TET_OK;
  for (int missing = 1; missing && status == TET_OK;) {
    missing = 0;
    status = insert_vertices(c);
    for (size_t k = 0, n = c->n_border[up]; k < n && status == TET_OK; k++) {
      uint32_t h = c->border[up][k], l;
      if (!is_border(c, h)) continue;
      status = find_border(c, h, &l);
      if (status != TET_OK || l != TET_NONE) continue;
      missing = 1;
      status = grow(c, h, up);
    }
    if (status == TET_OK) status = tet_poll(c->st->ctx);
  }
  return status;
}

static tet_status enter(tet_cavity *c, uint32_t local) {
  if (c->image[local] != TET_NONE) return TET_OK;
  if (tet_is_ghost(&c->local, local)) return tet_internal(c->st->ctx, "a cavity leaks");
  c->image[local] = 0;
  return push(c->st->ctx, &c->inside, &c->n_inside, &c->cap_inside, local);
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
  uint32_t l;
  tet_status status = tet_grow(ctx, &c->image, &c->cap_image, n, sizeof *c->image);
  if (status == TET_OK) status = tet_grow(ctx, &c->blocked, &c->cap_blocked, n, 1);
  if (status != TET_OK) return status;
  memset(c->image, 0xff, n * sizeof *c->image);
  memset(c->blocked, 0, n);
  c->n_inside = 0;
  for (size_t k = 0; k < c->n_omega && status == TET_OK; k++) {
    status = find_omega(c, k, up, &l);
    if (status == TET_OK && l == TET_NONE) status = tet_internal(ctx, "a cavity's floor is not Delaunay in it");
    if (status != TET_OK) return status;
    block(c, l);
    status = enter(c, l >> 2);
  }
  for (size_t k = 0; k < c->n_border[up] && status == TET_OK; k++) {
    if (!is_border(c, c->border[up][k])) continue;
    status = find_border(c, c->border[up][k], &l);
    if (status != TET_OK) return status;
    block(c, l);
    status = enter(c, l >> 2);
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

/* Phase (2): fills the cavity on one side and joins it to what surrounds it. */
static tet_status fill_side(tet_cavity *c, const int8_t *side, int up) {
  tet_complex *m = &c->st->complex;
  uint32_t l;
  for (size_t k = 0; k < c->n_border[up]; k++)
    m->flag[c->border[up][k] >> 2] |= (uint8_t)(TET_FLAG_BORDER << (c->border[up][k] & 3));
  tet_status status = collect_vertices(c, side, up);
  if (status == TET_OK) status = verify(c, up);
  for (size_t k = 0; k < c->n_vertex; k++) c->has_vertex[c->vertex[k]] = 0;
  if (status == TET_OK) status = flood_inside(c, up);
  if (status == TET_OK) status = copy_inside(c);
  for (size_t k = 0; k < c->n_border[up] && status == TET_OK; k++) {
    uint32_t h = c->border[up][k];
    if (!is_border(c, h)) continue;
    status = find_border(c, h, &l);
    if (status != TET_OK) return status;
    uint32_t made = 4 * c->image[l >> 2] + (l & 3), outside = m->adj[h];
    c->face_tri[made] = c->face_tri[outside];
    tet_link(m, made, outside);
    m->flag[h >> 2] &= (uint8_t) ~(TET_FLAG_BORDER << (h & 3));
  }
  for (size_t k = 0; k < c->n_omega && status == TET_OK; k++) {
    status = find_omega(c, k, up, &l);
    if (status != TET_OK) return status;
    uint32_t made = 4 * c->image[l >> 2] + (l & 3);
    c->face_tri[made] = c->omega[k];
    if (up) c->floor[k] = made;
    else tet_link(m, made, c->floor[k]);
  }
  return status;
}

tet_status tet_cavity_fill(tet_cavity *c, const int8_t *side) {
  tet_complex *m = &c->st->complex;
  size_t first_crossed = c->n_crossed;
  tet_status status = tet_grow(c->st->ctx, &c->floor, &c->cap_floor, c->n_omega, sizeof *c->floor);
  if (status == TET_OK) status = fill_side(c, side, 1);
  /* what the upper cavity grew by is gone from the lower one's point of view */
  size_t grown = c->n_crossed;
  if (status == TET_OK) {
    c->n_crossed = first_crossed;
    for (size_t k = first_crossed; k < grown; k++) tet_complex_delete(m, c->crossed[k]);
    status = fill_side(c, side, 0);
  }
  if (status != TET_OK) return status;
  for (size_t k = 0; k < c->n_crossed; k++) tet_complex_delete(m, c->crossed[k]);
  return TET_OK;
}
