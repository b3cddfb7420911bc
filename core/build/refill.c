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

enum { MOST_CAVITY = 64, MOST_TRIES = 4 };

/* Subfaces xyd and xye are to become dex and dey: an edge flip inside a facet. */
typedef struct edge_flip {
  uint32_t x, y, d, e;
} edge_flip;

typedef struct refill {
  repair *r;
  uint32_t number;       /* r->mark of its cavity's tetrahedra */
  const edge_flip *flip; /* or NULL */
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

static int is_inside(const refill *f, uint32_t t) { return t < f->r->cap_mark && f->r->mark[t] == f->number; }

static tet_status enter(refill *f, uint32_t t) {
  repair *r = f->r;
  size_t from = r->cap_mark;
  tet_status status = tet_grow(r->ctx, &r->mark, &r->cap_mark, r->p->n_tets, sizeof *r->mark);
  if (status != TET_OK) return status;
  memset(r->mark + from, 0, (r->cap_mark - from) * sizeof *r->mark);
  if (is_inside(f, t)) return TET_OK;
  r->mark[t] = f->number;
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

static int is_face(const uint32_t *v, uint32_t a, uint32_t b, uint32_t c) {
  int n = 0;
  for (int i = 0; i < 3; i++) n += v[i] == a || v[i] == b || v[i] == c;
  return n == 3;
}

/* Replaces one of the two subfaces of a flip, seen from any side. */
static void flip_face(const edge_flip *f, uint32_t v[3]) {
  int first = is_face(v, f->x, f->y, f->d), second = is_face(v, f->x, f->y, f->e);
  for (int i = 0; i < 3; i++) {
    if (first && v[i] == f->y) v[i] = f->e;
    else if (second && v[i] == f->x) v[i] = f->d;
  }
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
    if (f->flip && (*r->tri)[f->border[k]] != TET_NONE) flip_face(f->flip, w->front[k].v);
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
  r->refills++;
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
    if ((status = tet_repair_made(r, (uint32_t)t)) != TET_OK) return status;
  }
  return TET_OK;
}

static int may_be_made(const void *user, const uint32_t t[4]) {
  return tet_repair_may_be_made(user, t[0], t[1], t[2], t[3]);
}

/* Wraps and checks; *ret_ready: it may be committed. Else the cavity has grown, if it can. */
static tet_status try_once(refill *f, int *ret_ready) {
  size_t before = f->n_cavity;
  int filled = 0;
  tet_status status = outline(f);
  if (status == TET_OK) status = tet_wrap_fill(&f->wrap, &filled);
  if (status != TET_OK) return status;
  if (filled && is_whole(f) && is_delaunay(f)) {
    status = check_border(f, ret_ready);
    if (status != TET_OK || *ret_ready || f->n_cavity > before) return status;
  }
  return grow(f, before, 1);
}

static tet_status try_all(refill *f, int *ret_ready) {
  tet_status status = TET_OK;
  *ret_ready = 0;
  for (int i = 0; i < MOST_TRIES && !*ret_ready && f->n_cavity <= MOST_CAVITY && status == TET_OK; i++) {
    size_t before = f->n_cavity;
    status = try_once(f, ret_ready);
    if (f->n_cavity == before) break; /* all there is */
  }
  return status;
}

static refill begin(repair *r, const edge_flip *flip) {
  return (refill){.r = r, .number = ++r->cavity, .flip = flip,
                  .wrap = {.ctx = r->ctx, .points = &r->rounded, .may_be_made = may_be_made, .user = r}};
}

static void end(refill *f) {
  void *all[] = {f->cavity, f->border, f->vertex, f->slot, f->beyond, f->tri};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(f->r->ctx, all[i]);
  tet_wrap_free(&f->wrap);
}

tet_status tet_refill(repair *r, uint32_t t, int *ret_done) {
  refill f = begin(r, NULL);
  *ret_done = 0;
  tet_status status = enter(&f, t);
  if (status == TET_OK) status = grow(&f, 1, 0);
  if (status == TET_OK) status = try_all(&f, ret_done);
  if (status == TET_OK && *ret_done) status = commit(&f);
  end(&f);
  return status;
}

/* The place in tetrahedron t of vertex v. */
static uint32_t place(const repair *r, uint32_t t, uint32_t v) {
  uint32_t i = 0;
  while (r->p->tets[4 * (size_t)t + i] != v) i++;
  return i;
}

/* Enters the tetrahedra round edge xy from face h (of one of them) on to the next wall. */
static tet_status enter_round(refill *f, uint32_t h, uint32_t x, uint32_t y) {
  const tet_pieces *p = f->r->p;
  for (;;) {
    uint32_t t = h >> 2, i = 0;
    tet_status status = enter(f, t);
    if (status != TET_OK) return status;
    while (i == (h & 3) || p->tets[4 * (size_t)t + i] == x || p->tets[4 * (size_t)t + i] == y) i++;
    if (is_wall(f->r, 4 * t + i)) return TET_OK;
    h = p->adj[4 * (size_t)t + i];
  }
}

/* Makes the edge flip: both sides of the facet are filled anew, or none. under: the handle
 * beyond subface xyd, TET_NONE on the boundary. */
static tet_status refill_sides(repair *r, const edge_flip *flip, uint32_t t, uint32_t under, int *ret_done) {
  int ready = 0, ready_under = under == TET_NONE;
  refill f = begin(r, flip), g = {.r = r};
  tet_status status = enter(&f, t);
  if (status == TET_OK) status = grow(&f, 1, 0);
  if (status == TET_OK) status = try_all(&f, &ready);
  if (status == TET_OK && ready && under != TET_NONE) {
    g = begin(r, flip);
    status = enter_round(&g, under, flip->x, flip->y);
    if (status == TET_OK) status = try_all(&g, &ready_under);
    for (size_t k = 0; k < f.n_cavity; k++) ready_under &= !is_inside(&g, f.cavity[k]); /* round the facet's rim */
  }
  *ret_done = ready && ready_under;
  if (status == TET_OK && *ret_done && under != TET_NONE) status = commit(&g);
  if (status == TET_OK && *ret_done) status = commit(&f);
  end(&f);
  end(&g);
  return status;
}

tet_status tet_refill_facet(repair *r, uint32_t h, int *ret_done) {
  const tet_pieces *p = r->p;
  uint32_t t = h >> 2, o = p->adj[h] >> 2;
  tet_status status = TET_OK;
  *ret_done = 0;
  for (int k = 0; k < 3 && !*ret_done && status == TET_OK; k++) {
    const uint8_t *i = tet_face[h & 3];
    uint32_t z = p->tets[4 * (size_t)t + i[k]];
    edge_flip flip = {p->tets[4 * (size_t)t + i[(k + 1) % 3]], p->tets[4 * (size_t)t + i[(k + 2) % 3]], p->tets[h],
                      p->tets[p->adj[h]]};
    uint32_t a = 4 * t + i[k], b = 4 * o + place(r, o, z), on_a = (*r->tri)[a], on_b = (*r->tri)[b];
    if (on_a == TET_NONE || on_b == TET_NONE || r->surface->tri_patch[on_a] != r->surface->tri_patch[on_b]) continue;
    if (tet_edge_map_get(&r->subsegs, flip.x, flip.y) != TET_NONE) continue;
    int side = tet_orient3d(&r->exact, flip.x, flip.y, flip.d, z); /* the quadrangle is convex, exactly */
    if (!side || tet_orient3d(&r->exact, flip.x, flip.e, flip.d, z) != side ||
        tet_orient3d(&r->exact, flip.e, flip.y, flip.d, z) != side)
      continue;
    status = refill_sides(r, &flip, t, p->adj[a], ret_done);
  }
  return status;
}
