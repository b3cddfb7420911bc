// SPDX-License-Identifier: Apache-2.0
/* refill.c: where flips stick after rounding, a cavity is emptied and filled anew with the
 * constrained Delaunay tetrahedralization of what is there, by gift wrapping on the
 * rounded coordinates.
 *
 * The cavity begins with one bad tetrahedron and its bad faces. It grows by what is
 * beyond border faces that turn out not to be locally Delaunay, and by all its neighbours
 * where it cannot be filled; never through subfaces, which are border, slits from both
 * sides. It does not move points: that is left to repair.c. */
#include "build/repair_work.h"

#include <string.h>

#include "build/wrap.h"
#include "exact/predicates.h"

enum { MOST_CAVITY = 600, MOST_TRIES = 24 };

typedef struct refill {
  repair *r;
  tet_wrap wrap;
  uint32_t *cavity;   /* tetrahedra */
  size_t n_cavity, cap_cavity;
  uint32_t *border;   /* handles of the cavity's tetrahedra; the tags of the front */
  size_t n_border, cap_border;
  uint32_t *vertex;
  size_t n_vertex, cap_vertex;
  uint32_t *slot;     /* of what wrapping made */
  size_t cap_slot;
  uint32_t *beyond;   /* at each border handle: the handle outside, or TET_NONE */
  uint32_t *tri;      /* and the triangle of the surface there */
  size_t cap_beyond, cap_tri;
} refill;

static int is_inside(const refill *f, uint32_t t) { return t < f->r->cap_mark && f->r->mark[t] == f->r->cavity; }

static tet_status enter(refill *f, uint32_t t) {
  repair *r = f->r;
  size_t from = r->cap_mark;
  tet_status status = tet_grow(r->ctx, &r->mark, &r->cap_mark, r->p->n_tets, sizeof *r->mark);
  if (status != TET_OK) return status;
  memset(r->mark + from, 0, (r->cap_mark - from) * sizeof *r->mark);
  if (is_inside(f, t)) return TET_OK;
  r->mark[t] = r->cavity;
  return tet_push(r->ctx, &f->cavity, &f->n_cavity, &f->cap_cavity, t);
}

/* 1: the cavity may not go on through face h. */
static int is_wall(const repair *r, uint32_t h) { return r->p->adj[h] == TET_NONE || (*r->tri)[h] != TET_NONE; }

/* Adds the neighbours of the cavity's first n tetrahedra: all, or through bad faces. */
static tet_status grow(refill *f, size_t n, int all) {
  repair *r = f->r;
  tet_status status = TET_OK;
  for (size_t k = 0; k < n && status == TET_OK; k++) {
    uint32_t t = f->cavity[k];
    int ok = tet_repair_is_positive(r, t);
    for (uint32_t h = 4 * t; h < 4 * t + 4 && status == TET_OK; h++)
      if (!is_wall(r, h) && (all || tet_repair_is_bad_face(r, h, ok))) status = enter(f, r->p->adj[h] >> 2);
  }
  return status;
}

static tet_status add_vertex(refill *f, uint32_t v) {
  for (size_t k = 0; k < f->n_vertex; k++)
    if (f->vertex[k] == v) return TET_OK;
  return tet_push(f->r->ctx, &f->vertex, &f->n_vertex, &f->cap_vertex, v);
}

/* The cavity's border and vertices, and the front to be wrapped. */
static tet_status outline(refill *f) {
  repair *r = f->r;
  tet_wrap *w = &f->wrap;
  tet_status status = TET_OK;
  f->n_border = f->n_vertex = 0;
  for (size_t k = 0; k < f->n_cavity && status == TET_OK; k++)
    for (uint32_t h = 4 * f->cavity[k]; h < 4 * f->cavity[k] + 4 && status == TET_OK; h++) {
      status = add_vertex(f, r->p->tets[h]);
      if (status != TET_OK || (!is_wall(r, h) && is_inside(f, r->p->adj[h] >> 2))) continue;
      status = tet_push(r->ctx, &f->border, &f->n_border, &f->cap_border, h);
    }
  if (status == TET_OK) status = tet_grow(r->ctx, &w->front, &w->cap_front, f->n_border, sizeof *w->front);
  if (status != TET_OK) return status;
  w->n_front = f->n_border;
  w->vertex = f->vertex;
  w->n_vertex = f->n_vertex;
  for (uint32_t k = 0; k < f->n_border; k++) {
    const uint8_t *i = tet_face[f->border[k] & 3]; /* outward, so turned */
    const uint32_t *v = r->p->tets + (f->border[k] & ~(size_t)3);
    w->front[k] = (tet_front){.v = {v[i[2]], v[i[1]], v[i[0]]}, .tag = k};
  }
  return TET_OK;
}

/* 1: one of what was made has the edge ab. */
static int has_edge(const refill *f, uint32_t a, uint32_t b) {
  for (size_t k = 0; k < f->wrap.n_made; k++) {
    int both = 0;
    for (int i = 0; i < 4; i++) both += f->wrap.made[k][i] == a || f->wrap.made[k][i] == b;
    if (both == 2) return 1;
  }
  return 0;
}

/* 1: no vertex and no subsegment of the cavity has been lost. */
static int is_whole(const refill *f) {
  const repair *r = f->r;
  for (size_t k = 0; k < f->n_vertex; k++) {
    int found = 0;
    for (size_t q = 0; q < f->wrap.n_made && !found; q++)
      for (int i = 0; i < 4; i++) found |= f->wrap.made[q][i] == f->vertex[k];
    if (!found) return 0;
  }
  for (size_t k = 0; k < f->n_cavity; k++) {
    const uint32_t *v = r->p->tets + 4 * (size_t)f->cavity[k];
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++)
        if (tet_edge_map_get(&r->subsegs, v[i], v[j]) != TET_NONE && !has_edge(f, v[i], v[j])) return 0;
  }
  return 1;
}

/* 1: the faces between what was made are locally Delaunay: they are not where a vertex
 * that would have to be seen is hidden. */
static int is_delaunay(const refill *f) {
  for (size_t k = 0; k < f->wrap.n_made; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = f->wrap.link[k][i], *v = f->wrap.made[k];
      if (link & TET_WRAP_TAG || link >> 2 < k) continue;
      if (tet_insphere(&f->r->rounded, v[0], v[1], v[2], v[3], f->wrap.made[link >> 2][link & 3]) > 0) return 0;
    }
  return 1;
}

/* Adds what is beyond border faces that are not locally Delaunay as they would be now.
 * *ret_fits: there are none. */
static tet_status check_border(refill *f, int *ret_fits) {
  repair *r = f->r;
  tet_status status = TET_OK;
  *ret_fits = 1;
  for (size_t k = 0; k < f->wrap.n_made; k++)
    for (int i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t link = f->wrap.link[k][i], *v = f->wrap.made[k];
      if (!(link & TET_WRAP_TAG)) continue;
      uint32_t h = f->border[link & ~TET_WRAP_TAG], g = r->p->adj[h];
      if (is_wall(r, h)) continue;
      if (tet_repair_is_positive(r, g >> 2) && tet_insphere(&r->rounded, v[0], v[1], v[2], v[3], r->p->tets[g]) <= 0) continue;
      *ret_fits = 0;
      status = enter(f, g >> 2);
    }
  return status;
}

/* The new handle of the border face with tag k. */
static uint32_t handle_of(const refill *f, uint32_t tag) {
  for (size_t k = 0; k < f->wrap.n_made; k++)
    for (uint32_t i = 0; i < 4; i++)
      if (f->wrap.link[k][i] == (tag | TET_WRAP_TAG)) return 4 * f->slot[k] + i;
  return TET_NONE;
}

/* Slots for what was made, the cavity's first, and what is beyond its border. */
static tet_status prepare(refill *f) {
  repair *r = f->r;
  size_t n = f->wrap.n_made;
  tet_status status = tet_grow(r->ctx, &f->slot, &f->cap_slot, n, sizeof *f->slot);
  if (status == TET_OK) status = tet_grow(r->ctx, &f->beyond, &f->cap_beyond, f->n_border, sizeof *f->beyond);
  if (status == TET_OK) status = tet_grow(r->ctx, &f->tri, &f->cap_tri, f->n_border, sizeof *f->tri);
  for (size_t k = 0; k < n && status == TET_OK; k++)
    if (k < f->n_cavity) f->slot[k] = f->cavity[k];
    else status = tet_repair_new_slot(r, &f->slot[k]);
  for (size_t k = 0; k < f->n_border && status == TET_OK; k++) {
    f->beyond[k] = r->p->adj[f->border[k]];
    f->tri[k] = (*r->tri)[f->border[k]];
  }
  return status;
}

/* Puts what was made into the mesh. */
static tet_status commit(refill *f) {
  repair *r = f->r;
  tet_pieces *p = r->p;
  tet_status status = prepare(f);
  if (status != TET_OK) return status;
  uint32_t region = p->region[f->cavity[0]];
  for (size_t k = 0; k < f->n_border; k++) { /* slits: to the new handle on the other side */
    uint32_t g = f->beyond[k], tag = 0;
    if (g == TET_NONE || !is_inside(f, g >> 2)) continue;
    while (f->border[tag] != g) tag++;
    f->beyond[k] = handle_of(f, tag);
  }
  for (size_t k = 0; k < f->n_cavity; k++) p->tets[4 * (size_t)f->cavity[k]] = TET_NONE;
  for (size_t k = 0; k < f->wrap.n_made; k++) {
    size_t t = f->slot[k];
    memcpy(p->tets + 4 * t, f->wrap.made[k], sizeof f->wrap.made[k]);
    p->region[t] = region;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = f->wrap.link[k][i], tag = link & ~TET_WRAP_TAG, h = 4 * (uint32_t)t + i;
      int is_border = (link & TET_WRAP_TAG) != 0;
      (*r->tri)[h] = is_border ? f->tri[tag] : TET_NONE;
      p->adj[h] = is_border ? f->beyond[tag] : 4 * f->slot[link >> 2] + (link & 3);
      if (is_border && p->adj[h] != TET_NONE) p->adj[p->adj[h]] = h;
    }
  }
  return TET_OK;
}

static int may_be_made(const void *user, const uint32_t t[4]) {
  return tet_repair_may_be_made(user, t[0], t[1], t[2], t[3]);
}

/* Wraps and checks; *ret_done: it is in the mesh. Else the cavity has grown, if it can. */
static tet_status try_once(refill *f, int *ret_done) {
  size_t before = f->n_cavity;
  int fits = 0, filled = 0;
  tet_status status = outline(f);
  if (status == TET_OK) status = tet_wrap_fill(&f->wrap, &filled);
  if (status != TET_OK) return status;
  if (filled && is_whole(f) && is_delaunay(f)) {
    status = check_border(f, &fits);
    if (status == TET_OK && fits) {
      *ret_done = 1;
      return commit(f);
    }
    if (status != TET_OK || f->n_cavity > before) return status;
  }
  return grow(f, before, 1);
}

tet_status tet_refill(repair *r, uint32_t t, int *ret_done) {
  refill f = {.r = r, .wrap = {.ctx = r->ctx, .points = &r->rounded, .may_be_made = may_be_made, .user = r}};
  tet_status status = TET_OK;
  *ret_done = 0;
  r->cavity++;
  status = enter(&f, t);
  if (status == TET_OK) status = grow(&f, 1, 0);
  for (int i = 0; i < MOST_TRIES && !*ret_done && f.n_cavity <= MOST_CAVITY && status == TET_OK; i++) {
    size_t before = f.n_cavity;
    status = try_once(&f, ret_done);
    if (f.n_cavity == before) break; /* all there is */
  }
  tet_wrap_free(&f.wrap);
  void *all[] = {f.cavity, f.border, f.vertex, f.slot, f.beyond, f.tri};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(r->ctx, all[i]);
  return status;
}
