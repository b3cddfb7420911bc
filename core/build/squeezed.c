// SPDX-License-Identifier: Apache-2.0
/* squeezed.c: after rounding, Steiner points in the volume where interior faces lie on facets as near as matters.
 *
 * Where facets meet at almost 180 degrees in needles, tetrahedra thinner than anything that matters lie on
 * both of them, and whoever measures takes their inner faces for facets. Points on segments do not help: near the
 * tip of a needle the spheres through its sides are empty however close these are. A point inside such a sphere,
 * off the facets, takes the face out of the Delaunay tetrahedralization (its constrained cavity is filled from it,
 * thesis 3.3.2), and no face with that point lies on a facet: so there are fewer of them after each point.
 * What is flat on a facet because the domain itself is as thin stays. Where points go and which faces
 * are near is decided in doubles; cavities are exact. */
#include "build/repair.h"
#include "build/state.h"

#include <string.h>

#include "base/triangle.h"
#include "exact/predicates.h"
#include "mesh/edge_map.h"

enum { MOST_CAVITY = 512 };
/* All searches together visit no more tetrahedra than so many for each tetrahedron, and so many more: plates that are
 * hardly thicker than what matters have large cavities, and no point. */
static const size_t SEARCHED = 64, SEARCHED_MORE = 100000;

typedef struct squeezed {
  tet_state *st;
  tet_ctx *ctx;
  tet_pieces *p;
  uint32_t **tri;      /* [n_tets][4] triangle of the surface at a face */
  double least;        /* nearer to a facet than this is on it */
  size_t cap_tets, cap_adj, cap_region, cap_tri;
  uint8_t *on_facet;   /* [n_points] */
  size_t cap_on_facet;
  uint32_t *mark;      /* [n_tets] the last search that a tetrahedron was in */
  size_t cap_mark;
  uint32_t search;     /* the number of the last one */
  uint32_t *cavity;    /* tetrahedra, in the order in which a search found them */
  size_t n_cavity, cap_cavity;
  size_t n_searched;   /* tetrahedra in all searches before the last */
  uint32_t *border;    /* handles of the cavity's tetrahedra */
  size_t n_border, cap_border;
  uint32_t (*old)[5];  /* [n_border] outward vertices, the handle beyond, the triangle */
  size_t cap_old;
  uint32_t *slot;      /* [n_border] of the new tetrahedra */
  size_t cap_slot;
  tet_edge_map loose;  /* loose subsegments, which cavities must not lose */
} squeezed;

static const double *at(const squeezed *s, uint32_t v) { return s->p->points + 3 * (size_t)v; }

static const uint32_t *vertices(const squeezed *s, uint32_t t) { return s->p->tets + 4 * (size_t)t; }

static int is_dead(const squeezed *s, uint32_t t) { return *vertices(s, t) == TET_NONE; }

static int is_subface(const squeezed *s, uint32_t h) { return (*s->tri)[h] != TET_NONE; }

/* The outward vertices of face h. */
static void face_of(const squeezed *s, uint32_t h, uint32_t v[3]) {
  for (int i = 0; i < 3; i++) v[i] = vertices(s, h >> 2)[tet_face[h & 3][i]];
}

/* The distance between the nearest two parallel planes that hold t between them and go through a face or
 * through two opposite edges. */
static double width(const squeezed *s, uint32_t t) {
  double e[4][3], n[3], most = 0; /* e[0] is not used */
  const uint32_t *v = vertices(s, t);
  for (int i = 1; i < 4; i++) tet_minus(at(s, v[i]), at(s, v[0]), e[i]);
  for (int i = 1; i < 4; i++) {
    int j = i % 3 + 1, k = j % 3 + 1;
    double d[3], f[3];
    tet_minus(e[k], e[j], d);
    tet_cross(e[i], e[j], n); /* face 0ij */
    most = fmax(most, tet_square(n));
    tet_cross(e[i], d, n); /* edges 0i and jk */
    most = fmax(most, tet_square(n));
    if (i > 1) continue;
    tet_minus(e[i], e[j], f);
    tet_cross(d, f, n);
    most = fmax(most, tet_square(n));
  }
  tet_cross(e[1], e[2], n);
  return most > 0 ? fabs(tet_dot(n, e[3])) / sqrt(most) : 0;
}

/* Begins a search: nothing is in it. */
static tet_status begin_search(squeezed *s) {
  size_t from = s->cap_mark;
  tet_status status = tet_grow(s->ctx, &s->mark, &s->cap_mark, s->p->n_tets, sizeof *s->mark);
  if (status != TET_OK) return status;
  memset(s->mark + from, 0, (s->cap_mark - from) * sizeof *s->mark);
  s->search++;
  s->n_searched += s->n_cavity;
  s->n_cavity = 0;
  return TET_OK;
}

static int is_found(const squeezed *s, uint32_t t) { return s->mark[t] == s->search; }

static tet_status find(squeezed *s, uint32_t t) {
  if (is_found(s, t)) return TET_OK;
  s->mark[t] = s->search;
  return tet_push(s->ctx, &s->cavity, &s->n_cavity, &s->cap_cavity, t);
}

/* *ret: a subface that x, a point of face h, is near, or TET_NONE: searches what is near from there on. */
static tet_status find_near(squeezed *s, uint32_t h, const double x[3], uint32_t *ret) {
  tet_status status = begin_search(s);
  *ret = TET_NONE;
  if (status == TET_OK) status = find(s, h >> 2);
  if (status == TET_OK) status = find(s, s->p->adj[h] >> 2);
  for (size_t k = 0; k < s->n_cavity && *ret == TET_NONE && status == TET_OK; k++)
    for (uint32_t i = 0; i < 4 && *ret == TET_NONE && status == TET_OK; i++) {
      uint32_t g = 4 * s->cavity[k] + i, v[3];
      face_of(s, g, v);
      if (tet_triangle_distance2(at(s, v[0]), at(s, v[1]), at(s, v[2]), x) > s->least * s->least) continue;
      if (is_subface(s, g)) *ret = g;
      else if (s->p->adj[g] != TET_NONE) status = find(s, s->p->adj[g] >> 2);
    }
  return status;
}

/* Whether face h, no subface, has its vertices on facets, and the middles of its edges and its centre near
 * them. *ret: a subface near the centre; TET_NONE if not. */
static tet_status lies_on_facets(squeezed *s, uint32_t h, uint32_t *ret) {
  uint32_t v[3];
  double centre[3] = {0, 0, 0};
  face_of(s, h, v);
  *ret = TET_NONE;
  if (s->p->adj[h] == TET_NONE || is_subface(s, h) || !s->on_facet[v[0]] || !s->on_facet[v[1]] || !s->on_facet[v[2]])
    return TET_OK;
  for (int i = 0; i < 3; i++) {
    double middle[3];
    for (int j = 0; j < 3; j++) {
      middle[j] = (at(s, v[i])[j] + at(s, v[(i + 1) % 3])[j]) / 2;
      centre[j] += at(s, v[i])[j] / 3;
    }
    tet_status status = find_near(s, h, middle, ret);
    if (status != TET_OK || *ret == TET_NONE) return status;
  }
  return find_near(s, h, centre, ret);
}

static int is_inside_sphere(const squeezed *s, uint32_t t, const double x[3]) {
  const uint32_t *v = vertices(s, t);
  return tet_insphere_xyz(at(s, v[0]), at(s, v[1]), at(s, v[2]), at(s, v[3]), x) > 0;
}

/* 1: x is inside border face h, and not as near to its plane as matters. */
static int is_seen(const squeezed *s, uint32_t h, const double x[3]) {
  uint32_t v[3];
  double p[3], q[3], d[3], n[3];
  face_of(s, h, v);
  const double *a = at(s, v[0]), *b = at(s, v[1]), *c = at(s, v[2]);
  if (tet_orient3d_xyz(c, b, a, x) <= 0) return 0;
  tet_minus(b, a, p);
  tet_minus(c, a, q);
  tet_minus(x, a, d);
  tet_cross(p, q, n);
  return -tet_dot(n, d) > s->least * sqrt(tet_square(n));
}

/* The constrained cavity of x, from face h on. *ret_fits: x sees all of its border. */
static tet_status find_cavity(squeezed *s, uint32_t h, const double x[3], int *ret_fits) {
  const tet_pieces *p = s->p;
  tet_status status = begin_search(s);
  s->n_border = 0;
  *ret_fits = 1;
  if (status == TET_OK) status = find(s, h >> 2);
  for (size_t k = 0; k < s->n_cavity && *ret_fits && status == TET_OK; k++)
    for (uint32_t g = 4 * s->cavity[k]; g < 4 * s->cavity[k] + 4 && *ret_fits && status == TET_OK; g++) {
      uint32_t o = p->adj[g];
      int is_wall = o == TET_NONE || is_subface(s, g);
      if (!is_wall && (is_found(s, o >> 2) || is_inside_sphere(s, o >> 2, x))) {
        status = find(s, o >> 2);
        continue;
      }
      status = tet_push(s->ctx, &s->border, &s->n_border, &s->cap_border, g);
      *ret_fits = is_seen(s, g, x) && s->n_cavity <= MOST_CAVITY;
    }
  *ret_fits &= is_found(s, p->adj[h] >> 2);
  return status;
}

/* 1: the faces of x with the edges of border face h that an earlier face has, by `first`, are locally
 * Delaunay: mostly, but for those at a subsegment that x encroaches upon. */
static int are_delaunay(const squeezed *s, const tet_edge_map *first, uint32_t h, const double x[3]) {
  uint32_t v[3], w[3];
  face_of(s, h, v);
  for (uint32_t j = 0; j < 3; j++) {
    uint32_t a = v[j], b = v[(j + 1) % 3], g = tet_edge_map_get(first, a, b);
    if (g == TET_NONE) continue;
    face_of(s, g, w);
    uint32_t i = 0;
    while (w[i] == a || w[i] == b) i++;
    if (tet_insphere_xyz(at(s, v[2]), at(s, v[1]), at(s, v[0]), x, at(s, w[i])) > 0) return 0;
  }
  return 1;
}

/* *ret_so: filled from x the cavity would be constrained Delaunay, and no loose subsegment lost. */
static tet_status check_fill(squeezed *s, const double x[3], int *ret_so) {
  tet_edge_map first = {NULL, 0, 0};
  tet_status status = TET_OK;
  *ret_so = 1;
  for (size_t k = 0; k < s->n_border && status == TET_OK && *ret_so; k++) {
    uint32_t v[3];
    face_of(s, s->border[k], v);
    *ret_so = are_delaunay(s, &first, s->border[k], x);
    for (uint32_t j = 0; j < 3 && status == TET_OK; j++)
      status = tet_edge_map_put(s->ctx, &first, v[j], v[(j + 1) % 3], s->border[k]);
  }
  for (size_t k = 0; k < s->n_cavity && s->loose.n && status == TET_OK && *ret_so; k++) {
    const uint32_t *v = vertices(s, s->cavity[k]);
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++)
        *ret_so &= tet_edge_map_get(&s->loose, v[i], v[j]) == TET_NONE || tet_edge_map_get(&first, v[i], v[j]) != TET_NONE;
  }
  tet_edge_map_free(s->ctx, &first);
  return status;
}

static tet_status add_point(squeezed *s, const double x[3]) {
  tet_state *st = s->st;
  tet_pieces *p = s->p;
  size_t n = p->n_points, from = st->n_input;
  if ((uint64_t)n + 1 > tet_vertex_limit(s->ctx))
    return tet_fail(s->ctx, TET_E_VERTEX_LIMIT, "the vertex limit of %llu is reached",
                    (unsigned long long)tet_vertex_limit(s->ctx));
  tet_status status = tet_grow(s->ctx, &p->points, &p->cap_points, 3 * (n + 1), sizeof *p->points);
  if (status == TET_OK) status = tet_grow(s->ctx, &st->carrier, &st->cap_carrier, n + 1 - from, sizeof *st->carrier);
  if (status == TET_OK) status = tet_grow(s->ctx, &s->on_facet, &s->cap_on_facet, n + 1, 1);
  if (status != TET_OK) return status;
  memcpy(p->points + 3 * n, x, 3 * sizeof *x);
  st->carrier[n - from] = (tet_carrier){TET_ORIGIN_VOLUME, TET_NONE};
  s->on_facet[n] = 0;
  st->counts.squeezed_points++;
  p->n_points++;
  return TET_OK;
}

/* Slots for as many tetrahedra as the border has faces, the cavity's first. */
static tet_status take_slots(squeezed *s) {
  tet_pieces *p = s->p;
  size_t more = s->n_border > s->n_cavity ? s->n_border - s->n_cavity : 0, n = p->n_tets + more;
  tet_status status = tet_grow(s->ctx, &p->tets, &s->cap_tets, 4 * n, sizeof *p->tets);
  if (status == TET_OK) status = tet_grow(s->ctx, &p->adj, &s->cap_adj, 4 * n, sizeof *p->adj);
  if (status == TET_OK) status = tet_grow(s->ctx, &p->region, &s->cap_region, n, sizeof *p->region);
  if (status == TET_OK) status = tet_grow(s->ctx, s->tri, &s->cap_tri, 4 * n, sizeof **s->tri);
  if (status == TET_OK) status = tet_grow(s->ctx, &s->slot, &s->cap_slot, s->n_border, sizeof *s->slot);
  if (status == TET_OK) status = tet_grow(s->ctx, &s->old, &s->cap_old, s->n_border, sizeof *s->old);
  for (size_t k = 0; k < s->n_border && status == TET_OK; k++)
    s->slot[k] = k < s->n_cavity ? s->cavity[k] : p->n_tets++;
  return status;
}

/* Fills the cavity from vertex x. */
static tet_status fill_cavity(squeezed *s, uint32_t x) {
  tet_pieces *p = s->p;
  tet_edge_map open = {NULL, 0, 0};
  uint32_t region = p->region[s->cavity[0]];
  tet_status status = take_slots(s);
  if (status != TET_OK) return status;
  for (size_t k = 0; k < s->n_border; k++) {
    uint32_t h = s->border[k];
    face_of(s, h, s->old[k]);
    s->old[k][3] = p->adj[h];
    s->old[k][4] = (*s->tri)[h];
  }
  for (size_t k = 0; k < s->n_cavity; k++) p->tets[4 * (size_t)s->cavity[k]] = TET_NONE;
  for (size_t k = 0; k < s->n_border && status == TET_OK; k++) {
    uint32_t h = 4 * s->slot[k], *v = p->tets + h;
    const uint32_t *o = s->old[k];
    for (int i = 0; i < 3; i++) v[i] = o[2 - i];
    v[3] = x;
    p->region[h >> 2] = region;
    p->adj[h + 3] = o[3];
    (*s->tri)[h + 3] = o[4];
    if (o[3] != TET_NONE) p->adj[o[3]] = h + 3;
    for (uint32_t i = 0; i < 3 && status == TET_OK; i++) {
      uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3], g = tet_edge_map_get(&open, a, b);
      (*s->tri)[h + i] = TET_NONE;
      p->adj[h + i] = g;
      if (g != TET_NONE) p->adj[g] = h + i;
      else status = tet_edge_map_put(s->ctx, &open, a, b, h + i);
    }
  }
  tet_edge_map_free(s->ctx, &open);
  return status;
}

/* Inserts x if it takes face h out. */
static tet_status try_point(squeezed *s, uint32_t h, const double x[3], int *ret_done) {
  *ret_done = 0;
  if (!tet_is_place(x)) return TET_OK;
  if (!is_inside_sphere(s, h >> 2, x) || !is_inside_sphere(s, s->p->adj[h] >> 2, x)) return TET_OK;
  tet_status status = find_cavity(s, h, x, ret_done);
  if (status == TET_OK && *ret_done) status = check_fill(s, x, ret_done);
  if (status == TET_OK && *ret_done) status = add_point(s, x);
  return status == TET_OK && *ret_done ? fill_cavity(s, s->p->n_points - 1) : status;
}

/* Inserts a point that takes face h out, as far inside from subface g as there is one: off the face's middle, where
 * the spheres on its two sides are, or where subsegments are in the way of that off others of its points. */
static tet_status part(squeezed *s, uint32_t h, uint32_t g, double farthest, int *ret_done) {
  static const double share[][3] = {{1, 1, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}};
  uint32_t v[3], w[3];
  double p[3], q[3], n[3];
  face_of(s, h, v);
  face_of(s, g, w);
  tet_minus(at(s, w[1]), at(s, w[0]), p);
  tet_minus(at(s, w[2]), at(s, w[0]), q);
  tet_cross(q, p, n);
  const double *a = at(s, v[0]), *b = at(s, v[1]), *c = at(s, v[2]);
  double length = sqrt(tet_square(n));
  tet_status status = TET_OK;
  *ret_done = 0;
  for (size_t k = 0; k < sizeof share / sizeof *share && length > 0; k++)
    for (double way = farthest; way > s->least; way /= 2) {
      double x[3], all = share[k][0] + share[k][1] + share[k][2];
      for (int i = 0; i < 3; i++)
        x[i] = (share[k][0] * a[i] + share[k][1] * b[i] + share[k][2] * c[i]) / all + way / length * n[i];
      status = try_point(s, h, x, ret_done);
      if (status != TET_OK || *ret_done) return status;
    }
  return status;
}

static tet_status prepare(squeezed *s) {
  const tet_surface *surface = &s->st->surface;
  size_t n = s->p->n_tets;
  s->cap_tets = s->cap_adj = s->cap_tri = 4 * n;
  s->cap_region = n;
  s->cap_on_facet = s->p->n_points;
  s->on_facet = tet_calloc(s->ctx, s->p->n_points, 1);
  if (!s->on_facet) return tet_ctx_error(s->ctx)->status;
  for (size_t i = 0; i < 3 * (size_t)surface->n_tris; i++) s->on_facet[surface->tri[i]] = 1;
  tet_status status = TET_OK;
  for (size_t e = 0; e < surface->n_subsegs && status == TET_OK; e++)
    if (surface->segment[surface->subseg_segment[e]].loose)
      status = tet_edge_map_put(s->ctx, &s->loose, surface->subseg[2 * e], surface->subseg[2 * e + 1], (uint32_t)e);
  return status;
}

tet_status tet_part_squeezed(tet_state *st, tet_pieces *p, uint32_t **tri, double least, double diagonal) {
  squeezed s = {.st = st, .ctx = st->ctx, .p = p, .tri = tri, .least = least};
  tet_status status = TET_OK;
  size_t most = SEARCHED * p->n_tets + SEARCHED_MORE;
  for (int any = 1; any && status == TET_OK;) {
    any = 0;
    for (uint32_t t = 0; t < p->n_tets && s.n_searched < most && status == TET_OK; t++) {
      /* what is between such a face and its facet is as thin */
      if (is_dead(&s, t) || width(&s, t) > 2 * least) continue;
      if (!s.on_facet) status = prepare(&s);
      int done = 0;
      for (uint32_t h = 4 * t; h < 4 * t + 4 && !done && status == TET_OK; h++) {
        uint32_t on = TET_NONE;
        status = lies_on_facets(&s, h, &on);
        if (status == TET_OK && on != TET_NONE) status = part(&s, h, on, diagonal, &done);
      }
      any |= done;
      if (status == TET_OK) status = tet_poll(st->ctx);
    }
  }
  if (status == TET_OK) tet_close_gaps(p, *tri);
  void *all[] = {s.on_facet, s.mark, s.cavity, s.border, s.old, s.slot};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(st->ctx, all[i]);
  tet_edge_map_free(st->ctx, &s.loose);
  return status;
}
