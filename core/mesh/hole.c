// SPDX-License-Identifier: Apache-2.0
/* hole.c: rows and open faces of a hole, and filling a large one from the Delaunay
 * tetrahedralization of its link. */
#include "mesh/hole.h"

#include <string.h>

#include "mesh/delaunay.h"

tet_status tet_hole_of(tet_complex *c, tet_hole **ret) {
  if (!c->hole) {
    c->hole = tet_calloc(c->ctx, 1, sizeof *c->hole);
    if (!c->hole) return tet_ctx_error(c->ctx)->status;
    tet_complex_init(&c->hole->local, c->ctx, c->points);
  }
  c->hole->local.points = c->points;
  *ret = c->hole;
  return TET_OK;
}

void tet_hole_free(tet_complex *c) {
  tet_hole *e = c->hole;
  if (!e) return;
  void *all[] = {e->key, e->face, e->link, e->row, e->number, e->outside, e->table};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(c->ctx, all[i]);
  tet_complex_free(&e->local);
  tet_free(c->ctx, e);
  c->hole = NULL;
}

static uint64_t mix(uint32_t v) {
  uint64_t h = (v + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15);
  return h ^ h >> 29;
}

static int has(const uint32_t *f, uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; }

/* Joins two sides of a face. */
static void join(tet_hole *e, uint64_t g, uint64_t h) {
  if (g & TET_HOLE_ROW) e->row[(g & ~TET_HOLE_ROW) >> 2].beyond[g & 3] = h;
  if (h & TET_HOLE_ROW) e->row[(h & ~TET_HOLE_ROW) >> 2].beyond[h & 3] = g;
}

static void close_face(tet_hole *e, size_t k, uint64_t inside) {
  join(e, e->face[k].beyond, inside);
  e->n_face--;
  e->face[k] = e->face[e->n_face];
  e->key[k] = e->key[e->n_face];
}

static uint64_t key_of(const uint32_t f[3]) { return mix(f[0]) + mix(f[1]) + mix(f[2]); }

static int same_face(const uint32_t *f, const uint32_t *g) { return has(f, g[0]) && has(f, g[1]) && has(f, g[2]); }

tet_status tet_hole_open(tet_complex *c, tet_hole *e, const uint32_t f[3], uint64_t beyond) {
  tet_status status = TET_OK;
  if (e->n_face == e->cap_face) status = tet_grow(c->ctx, &e->face, &e->cap_face, e->n_face + 1, sizeof *e->face);
  if (status == TET_OK && e->n_face == e->cap_key)
    status = tet_grow(c->ctx, &e->key, &e->cap_key, e->n_face + 1, sizeof *e->key);
  if (status != TET_OK) return status;
  e->key[e->n_face] = key_of(f);
  e->face[e->n_face++] = (tet_open_face){{f[0], f[1], f[2]}, beyond};
  return TET_OK;
}

/* Closes face f, or opens it where its other side is not open. */
static tet_status meet(tet_complex *c, tet_hole *e, const uint32_t f[3], uint64_t beyond) {
  uint64_t key = key_of(f);
  for (size_t k = e->n_face; k-- > 0;)
    if (e->key[k] == key && same_face(f, e->face[k].v)) {
      close_face(e, k, beyond);
      return TET_OK;
    }
  return tet_hole_open(c, e, f, beyond);
}

static tet_status new_row(tet_complex *c, tet_hole *e, const uint32_t v[4], uint64_t *ret_handle) {
  tet_status status = tet_grow(c->ctx, &e->row, &e->cap_row, e->n_row + 1, sizeof *e->row);
  if (status != TET_OK) return status;
  memcpy(e->row[e->n_row].v, v, sizeof e->row->v);
  *ret_handle = TET_HOLE_ROW | (uint64_t)e->n_row++ << 2;
  return TET_OK;
}

tet_status tet_hole_tetrahedron(tet_complex *c, tet_hole *e, size_t k, uint32_t d) {
  const uint32_t *f = e->face[k].v, v[4] = {f[0], f[2], f[1], d}; /* positive; face 3 is f */
  uint64_t h;
  tet_status status = new_row(c, e, v, &h);
  if (status == TET_OK) close_face(e, k, h | 3);
  for (uint32_t i = 0; i < 3 && status == TET_OK; i++) {
    /* as seen from what is still to fill */
    const uint32_t inward[3] = {v[tet_face[i][0]], v[tet_face[i][2]], v[tet_face[i][1]]};
    status = meet(c, e, inward, h | i);
  }
  return status;
}

/* 1 if g turns the same way as f, of the same vertices. */
static int turns_alike(const uint32_t f[3], const uint32_t g[3]) {
  int j = g[0] == f[0] ? 0 : g[1] == f[0] ? 1 : 2;
  return g[(j + 1) % 3] == f[1];
}

/* Marks the local faces that are the hole's outer ones, on the inside, with what is beyond. */
static tet_status find_outer_faces(tet_complex *c, tet_hole *e) {
  const tet_complex *l = &e->local;
  size_t mask = 255, found = 0;
  while (mask < 3 * e->n_face) mask = 2 * mask + 1;
  tet_status status = tet_grow(c->ctx, &e->table, &e->cap_table, mask + 1, sizeof *e->table);
  if (status != TET_OK) return status;
  memset(e->table, 0, (mask + 1) * sizeof *e->table);
  for (size_t k = 0; k < e->n_face; k++) {
    size_t i = e->key[k] >> 20 & mask;
    while (e->table[i]) i = (i + 1) & mask;
    e->table[i] = (uint32_t)k + 1;
  }
  for (uint32_t h = 0; h < 4 * l->n_slots; h++) {
    const uint32_t *v = l->v + (h & ~3u);
    const uint8_t *f = tet_face[h & 3];
    const uint32_t face[3] = {v[f[0]], v[f[1]], v[f[2]]};
    if (!tet_is_live(l, h >> 2)) continue;
    uint64_t key = key_of(face);
    for (size_t i = key >> 20 & mask; e->table[i]; i = (i + 1) & mask) {
      const tet_open_face *o = &e->face[e->table[i] - 1];
      if (e->key[e->table[i] - 1] != key || !same_face(face, o->v) || !turns_alike(face, o->v)) continue;
      e->outside[h] = o->beyond + 1;
      found++;
      break;
    }
  }
  return found == e->n_face ? TET_OK : tet_internal(c->ctx, "a face of a hole is not in its link");
}

/* Makes local tetrahedron t a row, once. */
static tet_status enter(tet_complex *c, tet_hole *e, uint32_t t) {
  uint64_t h;
  if (e->number[t]) return TET_OK;
  tet_status status = new_row(c, e, e->local.v + 4 * (size_t)t, &h);
  if (status != TET_OK) return status;
  e->number[t] = (uint32_t)e->n_row;
  e->row[e->n_row - 1].beyond[0] = t; /* until it is joined */
  return TET_OK;
}

/* Floods the local tetrahedra from the outer faces inwards. */
static tet_status flood(tet_complex *c, tet_hole *e) {
  tet_status status = TET_OK;
  for (uint32_t h = 0; h < 4 * e->local.n_slots && status == TET_OK; h++)
    if (e->outside[h]) status = enter(c, e, h >> 2);
  for (size_t k = 0; k < e->n_row && status == TET_OK; k++) {
    uint32_t t = (uint32_t)e->row[k].beyond[0];
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t h = 4 * t + i, g = e->local.adj[h];
      if (!e->outside[h]) status = enter(c, e, g >> 2);
      if (status == TET_OK)
        e->row[k].beyond[i] = e->outside[h] ? e->outside[h] - 1
                                            : TET_HOLE_ROW | (uint64_t)(e->number[g >> 2] - 1) << 2 | (g & 3);
    }
  }
  return status;
}

tet_status tet_hole_cut_out(tet_complex *c, tet_hole *e, int *ret_flat) {
  tet_complex *l = &e->local;
  tet_complex_clear(l);
  tet_status status = tet_delaunay(l, e->link, (uint32_t)e->n_link, 1);
  *ret_flat = status == TET_E_DEGENERATE;
  if (*ret_flat) return TET_OK;
  size_t n = l->n_slots;
  if (status == TET_OK) status = tet_grow(c->ctx, &e->number, &e->cap_number, n, sizeof *e->number);
  if (status == TET_OK) status = tet_grow(c->ctx, &e->outside, &e->cap_outside, 4 * n, sizeof *e->outside);
  if (status != TET_OK) return status;
  memset(e->number, 0, n * sizeof *e->number);
  memset(e->outside, 0, 4 * n * sizeof *e->outside);
  status = find_outer_faces(c, e);
  return status == TET_OK ? flood(c, e) : status;
}
