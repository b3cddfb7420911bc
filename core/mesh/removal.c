// SPDX-License-Identifier: Apache-2.0
/* removal.c: taking a vertex out of a Delaunay complex.
 *
 * The star of the vertex is a hole bounded by the faces of its link. Without the vertex,
 * the hole is filled by the Delaunay tetrahedra of the link's vertices (Devillers, Teillaud
 * 2011), under the same perturbation: so the complex becomes that of the other vertices, to
 * the last tie. A small hole is wrapped: behind each open face stands the one vertex whose
 * sphere with it holds no other. For a large one, where that would be quadratic, the link is
 * tetrahedralized by itself and the part within the hole is cut out (hole.c). */
#include "mesh/hole.h"

#include <string.h>

#include "exact/predicates.h"
#include "exact/quick.h"

/* Vertices of a link above which it is tetrahedralized by itself. */
enum { MOST_WRAPPED = 96 };

/* The star of p in c->made, its finite link vertices and outer faces in the hole. */
static tet_status open_hole(tet_complex *c, tet_hole *e, uint32_t p) {
  tet_status status = tet_complex_star(c, p);
  e->n_face = e->n_link = e->n_row = 0;
  e->has_ghost = 0;
  if (status == TET_OK) status = tet_grow(c->ctx, &e->link, &e->cap_link, 4 * c->n_made, sizeof *e->link);
  for (size_t k = 0; k < c->n_made && status == TET_OK; k++) {
    const uint32_t *v = c->v + 4 * (size_t)c->made[k];
    uint32_t i = (uint32_t)tet_index_of(c, c->made[k], p);
    const uint8_t *f = tet_face[i];
    const uint32_t face[3] = {v[f[0]], v[f[1]], v[f[2]]};
    status = tet_hole_open(c, e, face, c->adj[4 * (size_t)c->made[k] + i]);
    for (int j = 0; j < 3; j++) {
      if (face[j] == TET_GHOST) {
        e->has_ghost = 1;
      } else if (!c->place[face[j]]) {
        c->place[face[j]] = 1;
        e->link[e->n_link++] = face[j];
      }
    }
  }
  for (size_t k = 0; k < e->n_link; k++) c->place[e->link[k]] = 0;
  return status;
}

/* 1 if every finite tetrahedron has the vertex, so that nothing finite may be left. */
static int is_all(const tet_complex *c, const tet_hole *e) {
  for (size_t k = 0; k < e->n_face; k++)
    if (!tet_is_ghost(c, (uint32_t)(e->face[k].beyond >> 2))) return 0;
  return 1;
}

/* The vertex of the link that stands behind face f, inside the hole; or TET_GHOST. */
static uint32_t apex_of(const tet_complex *c, const tet_hole *e, const uint32_t f[3]) {
  const tet_points *p = c->points;
  const double *x = p->x;
  int is_explicit = p->first_implicit >= p->n;
  tet_quick_plane plane = tet_quick_plane_of(x + 3 * (size_t)f[0], x + 3 * (size_t)f[1], x + 3 * (size_t)f[2]);
  uint32_t best = TET_GHOST;
  for (size_t k = 0; k < e->n_link; k++) {
    uint32_t d = e->link[k];
    if (d == f[0] || d == f[1] || d == f[2]) continue;
    int side = is_explicit ? tet_quick_side(&plane, x + 3 * (size_t)d) : TET_UNSURE;
    if (side == TET_UNSURE) side = tet_orient3d(p, f[0], f[1], f[2], d);
    if (side >= 0) continue;
    if (best == TET_GHOST || tet_insphere_sos(p, f[0], f[2], f[1], best, d) > 0) best = d;
  }
  return best;
}

/* Fills the hole face by face. What is left at the end are the outer faces of ghosts, which have met
 * each other: none is open. */
static tet_status wrap(tet_complex *c, tet_hole *e) {
  tet_status status = TET_OK;
  size_t k = e->n_face;
  while (k > 0 && status == TET_OK) {
    const tet_open_face *o = &e->face[k - 1];
    if (o->v[0] == TET_GHOST || o->v[1] == TET_GHOST || o->v[2] == TET_GHOST) {
      k--; /* a ghost on a finite face behind will close it */
      continue;
    }
    uint32_t d = apex_of(c, e, o->v);
    if (d == TET_GHOST && !e->has_ghost) return tet_internal(c->ctx, "a hole leaks");
    if (e->n_row > 2 * e->n_link * e->n_link + 64) return tet_internal(c->ctx, "a hole is never full");
    status = tet_hole_tetrahedron(c, e, k - 1, d);
    k = e->n_face;
    if ((e->n_row & 1023) == 1023 && status == TET_OK) status = tet_poll(c->ctx);
  }
  return status == TET_OK && e->n_face ? tet_internal(c->ctx, "a hole stays open") : status;
}

/* Puts the rows of the hole in the place of the star. */
static tet_status close_hole(tet_complex *c, tet_hole *e, uint32_t p) {
  size_t have = c->n_made;
  tet_status status = tet_grow(c->ctx, &c->made, &c->cap_made, e->n_row, sizeof *c->made);
  for (; have < e->n_row && status == TET_OK; have += status == TET_OK) status = tet_complex_new(c, &c->made[have]);
  if (status != TET_OK) {
    while (have > c->n_made) tet_complex_delete(c, c->made[--have]);
    return status;
  }
  for (size_t k = 0; k < e->n_row; k++) {
    const tet_hole_row *row = &e->row[k];
    uint32_t t = c->made[k];
    memcpy(c->v + 4 * (size_t)t, row->v, sizeof row->v);
    c->flag[t] = c->owner;
    for (uint32_t i = 0; i < 4; i++) {
      uint64_t beyond = row->beyond[i];
      if (beyond & TET_HOLE_ROW) c->adj[4 * (size_t)t + i] = 4 * c->made[(beyond & ~TET_HOLE_ROW) >> 2] + (beyond & 3);
      else tet_link(c, 4 * t + i, (uint32_t)beyond);
      if (row->v[i] != TET_GHOST) c->at[row->v[i]] = t;
    }
  }
  for (size_t k = e->n_row; k < c->n_made; k++) tet_complex_delete(c, c->made[k]);
  c->last = c->made[0];
  c->at[p] = TET_NONE;
  return TET_OK;
}

tet_status tet_complex_remove(tet_complex *c, uint32_t p) {
  tet_hole *e;
  tet_status status = tet_hole_of(c, &e);
  if (status == TET_OK) status = open_hole(c, e, p);
  if (status != TET_OK) return status;
  int all = is_all(c, e), wrapped = e->n_link <= MOST_WRAPPED;
  if (!wrapped) status = tet_hole_cut_out(c, e, &wrapped);
  if (status == TET_OK && wrapped) status = wrap(c, e);
  int finite = !all;
  for (size_t k = 0; k < e->n_row && !finite; k++) finite = e->row[k].v[3] != TET_GHOST;
  if (status == TET_OK && !finite)
    return tet_fail(c->ctx, TET_E_DEGENERATE, "without vertex %u the others span no volume", p);
  return status == TET_OK ? close_hole(c, e, p) : status;
}
