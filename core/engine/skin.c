// SPDX-License-Identifier: Apache-2.0
/* skin.c: see skin.h. Faces are grown to patches, each from its largest face and in that one's
 * plane. An edge between two patches is divided at the vertices of the tetrahedra around it that are beside
 * it; what tetrahedra that are flat against a patch have below its faces are vertices in it. A patch that
 * is no disc is left as its faces. In doubles: the surface stage checks what comes out, exactly. */
#include "engine/skin.h"

#include "base/sort.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define ON_OUTLINE (TET_NONE - 1) /* no face either */

typedef struct skinner {
  tet_ctx *ctx;
  const tet_pieces *p;
  double width, most; /* of the hull; the largest tolerance that the edges at its facets allow */
  double least;       /* tolerances are above that, or doubles hold no distances */
  uint32_t n_faces;
  uint32_t *handle;   /* [n_faces] of a tetrahedron, ascending */
  uint32_t *beside;   /* [n_faces][3] edge handles across; edge j runs from corner j to corner j + 1 */

  /* by one share */
  double tolerance;
  uint32_t *seed;     /* [n_faces] the largest face of its patch */
  uint32_t *patch;    /* [n_faces] the first face of it */
  uint32_t *after;    /* [n_faces] the next face of it, or TET_NONE */
  uint32_t *taken;    /* [n_points] the patch that a vertex is in, or ON_OUTLINE, or TET_NONE */
  uint8_t *listed;    /* [n_points] 1: in `out`, as in a facet */
  uint32_t *seen;     /* [n_tets] the patch whose flat tetrahedra it was last seen with */
  uint32_t *chain;    /* [n_faces][3] of an edge between patches: its vertices in `link` */
  uint32_t *link;     /* a count, and that many vertices, the first but not the last of the edge among them */
  uint32_t *next;     /* [n_points] the patch's outline: edge handle that leaves a vertex, or TET_NONE */
  uint32_t *stack;
  size_t n_vertices; /* in `out` */
  size_t n_link, cap_link, cap_stack, cap_polygon, cap_vertices;
  tet_skin out;
} skinner;

static const double *place(const skinner *s, uint32_t v) { return s->p->points + 3 * (size_t)v; }

static uint32_t corner(const skinner *s, uint32_t face, uint32_t j) {
  uint32_t h = s->handle[face];
  return s->p->tets[(h & ~(size_t)3) + tet_face[h & 3][j % 3]];
}

static uint32_t tail(const skinner *s, uint32_t e) { return corner(s, e / 3, e % 3); }

/* Twice the area times the normal of a face; returns its length. */
static double normal_of(const skinner *s, uint32_t face, double n[3]) {
  double a[3], b[3];
  tet_minus(place(s, corner(s, face, 1)), place(s, corner(s, face, 0)), a);
  tet_minus(place(s, corner(s, face, 2)), place(s, corner(s, face, 0)), b);
  tet_cross(a, b, n);
  return sqrt(tet_square(n));
}

/* Of tetrahedron t, the corner that is none of a, b, x. */
static uint32_t fourth(const skinner *s, uint32_t t, uint32_t a, uint32_t b, uint32_t x) {
  const uint32_t *v = s->p->tets + 4 * (size_t)t;
  return v[0] ^ v[1] ^ v[2] ^ v[3] ^ a ^ b ^ x;
}

/* The face of t opposite its vertex x. */
static uint32_t opposite(const skinner *s, uint32_t t, uint32_t x) { return 4 * t + tet_corner_of(s->p, t, x); }

/* From the tetrahedron at face handle h, around its edge ab, to the other face of the hull there. */
static uint32_t around(const skinner *s, uint32_t h, uint32_t a, uint32_t b) {
  uint32_t out = s->p->tets[h];
  for (;;) {
    uint32_t t = h >> 2, g = opposite(s, t, fourth(s, t, a, b, out));
    if (s->p->adj[g] == TET_NONE) return g;
    h = s->p->adj[g];
    out = s->p->tets[h];
  }
}

static tet_status allocate(skinner *s) {
  const tet_pieces *p = s->p;
  size_t n = s->n_faces;
  s->handle = tet_alloc(s->ctx, n, sizeof *s->handle);
  s->beside = tet_alloc(s->ctx, 3 * n, sizeof *s->beside);
  s->chain = tet_alloc(s->ctx, 3 * n, sizeof *s->chain);
  s->seed = tet_alloc(s->ctx, n, sizeof *s->seed);
  s->patch = tet_alloc(s->ctx, n, sizeof *s->patch);
  s->after = tet_alloc(s->ctx, n, sizeof *s->after);
  s->listed = tet_alloc(s->ctx, p->n_points, 1);
  s->taken = tet_alloc(s->ctx, p->n_points, sizeof *s->taken);
  s->next = tet_alloc(s->ctx, p->n_points, sizeof *s->next);
  s->seen = tet_alloc(s->ctx, p->n_tets, sizeof *s->seen);
  s->out.facet_start = tet_alloc(s->ctx, n + 1, sizeof *s->out.facet_start);
  int ok = s->handle && s->beside && s->chain && s->seed && s->patch && s->after && s->listed && s->taken && s->next &&
           s->seen && s->out.facet_start;
  if (!ok) return TET_E_MEMORY;
  memset(s->next, 0xff, p->n_points * sizeof *s->next);
  return tet_grow(s->ctx, &s->out.polygon_start, &s->cap_polygon, 2, sizeof *s->out.polygon_start);
}

/* The hull's faces, and what is across their edges. */
static tet_status list_faces(skinner *s) {
  const uint32_t *adj = s->p->adj;
  size_t n_handles = 4 * (size_t)s->p->n_tets;
  for (size_t h = 0; h < n_handles; h++) s->n_faces += adj[h] == TET_NONE;
  uint32_t *face_of = tet_alloc(s->ctx, n_handles, sizeof *face_of); /* of those handles alone */
  tet_status status = face_of ? allocate(s) : TET_E_MEMORY;
  for (size_t h = 0, n = 0; h < n_handles && !status; h++)
    if (adj[h] == TET_NONE) {
      face_of[h] = (uint32_t)n;
      s->handle[n++] = (uint32_t)h;
    }
  for (uint32_t e = 0; e < 3 * s->n_faces && !status; e++) {
    uint32_t a = tail(s, e), b = corner(s, e / 3, e % 3 + 1);
    uint32_t g = face_of[around(s, s->handle[e / 3], a, b)], j = 0;
    while (corner(s, g, j) != b) j++;
    s->beside[e] = 3 * g + j;
  }
  tet_free(s->ctx, face_of);
  return status;
}

/* The width is about six volumes over the area: 1 of a unit cube; 0 where doubles hold no squares of such lengths. */
static void measure_hull(skinner *s) {
  double volume6 = 0, area2 = 0, size = 0, n[3];
  const double *o = place(s, corner(s, 0, 0));
  for (uint32_t f = 0; f < s->n_faces; f++) {
    double d[3];
    area2 += normal_of(s, f, n);
    tet_minus(place(s, corner(s, f, 0)), o, d);
    volume6 += tet_dot(d, n);
    for (uint32_t j = 0; j < 3; j++) size = fmax(size, tet_longest(place(s, corner(s, f, j))));
  }
  double width = 2 * volume6 / area2;
  s->width = width > 1e-90 && width < 1e90 && area2 < 1e90 ? width : 0;
  s->least = 2 * DBL_EPSILON * size;
}

/* A plane through a face, of unit normal. */
typedef struct plane {
  const double *origin;
  double normal[3];
} plane;

static double height(const plane *at, const double x[3]) {
  double d[3];
  tet_minus(x, at->origin, d);
  return tet_dot(at->normal, d);
}

static int is_near(const skinner *s, const plane *at, uint32_t v) {
  return fabs(height(at, place(s, v))) <= s->tolerance;
}

/* 1 if the face, of which all vertices are near the plane, looks the same way; a face that is a needle looks
 * anywhere. */
static int is_alike(const skinner *s, const plane *at, uint32_t face) {
  double n[3], longest2 = 0;
  double size = normal_of(s, face, n);
  for (uint32_t j = 0; j < 3; j++)
    longest2 = fmax(longest2, tet_distance2(place(s, corner(s, face, j)), place(s, corner(s, face, j + 1))));
  return tet_dot(n, at->normal) > 0 || size <= s->tolerance * sqrt(longest2);
}

static tet_status push(skinner *s, size_t *n, uint32_t value) {
  return tet_push(s->ctx, &s->stack, n, &s->cap_stack, value);
}

/* Near that of a face whose area is no double is nothing. */
static plane plane_of(const skinner *s, uint32_t face) {
  plane at = {place(s, corner(s, face, 0)), {0, 0, 0}};
  double size = normal_of(s, face, at.normal);
  for (int k = 0; k < 3; k++) at.normal[k] = size > 0 ? at.normal[k] / size : NAN;
  return at;
}

/* Gives the faces around `seed`, in its plane, its patch. */
static tet_status grow(skinner *s, uint32_t seed, uint8_t *done) {
  plane at = plane_of(s, seed);
  size_t n = 0;
  done[seed] = 1;
  tet_status status = push(s, &n, seed);
  while (n && !status) {
    uint32_t f = s->stack[--n];
    s->seed[f] = seed;
    for (uint32_t e = 3 * f; e < 3 * f + 3 && !status; e++) {
      uint32_t g = s->beside[e] / 3;
      if (done[g] || !is_near(s, &at, corner(s, g, s->beside[e] % 3 + 2)) || !is_alike(s, &at, g)) continue;
      done[g] = 1;
      status = push(s, &n, g);
    }
  }
  return status;
}

/* Patches, from the largest face on. */
static tet_status make_patches(skinner *s) {
  uint8_t *done = tet_calloc(s->ctx, s->n_faces, 1);
  tet_keyed *item = tet_alloc(s->ctx, s->n_faces, sizeof *item);
  tet_status status = done && item ? TET_OK : TET_E_MEMORY;
  for (uint32_t f = 0; f < s->n_faces && !status; f++) {
    double n[3], size = normal_of(s, f, n);
    uint64_t bits;
    memcpy(&bits, &size, sizeof bits); /* as numbers, these rise as positive doubles do */
    item[f] = (tet_keyed){~bits, f};
  }
  if (!status) tet_sort_keyed(item, s->n_faces);
  for (uint32_t k = 0; k < s->n_faces && !status; k++) {
    if (!done[item[k].value]) status = grow(s, (uint32_t)item[k].value, done);
    if (!status && (k & 1023) == 0) status = tet_poll(s->ctx);
  }
  tet_free(s->ctx, done);
  tet_free(s->ctx, item);
  return status;
}

/* Lists the faces of each patch, and numbers it by the first. */
static void number_patches(skinner *s) {
  memset(s->patch, 0xff, s->n_faces * sizeof *s->patch);
  for (uint32_t f = s->n_faces; f-- > 0;) { /* patch[seed] is the first face so far */
    s->after[f] = s->patch[s->seed[f]];
    s->patch[s->seed[f]] = f;
  }
  for (uint32_t f = 0; f < s->n_faces; f++)
    if (s->seed[f] != f) s->patch[f] = s->patch[s->seed[f]];
}

static int is_between(const skinner *s, uint32_t e) { return s->seed[e / 3] != s->seed[s->beside[e] / 3]; }

/* Sets `next` along the patch's sides, from any on; 1 if these are one closed walk that meets no vertex twice.
 * *ret_first: an edge handle of it. */
static int walk_outline(skinner *s, uint32_t patch, uint32_t *ret_first) {
  uint32_t n = 0, met = 0, first = TET_NONE, twice = 0;
  for (uint32_t f = patch; f != TET_NONE; f = s->after[f])
    for (uint32_t e = 3 * f; e < 3 * f + 3; e++) {
      if (!is_between(s, e)) continue;
      twice |= s->next[tail(s, e)] != TET_NONE;
      s->next[tail(s, e)] = e;
      if (first == TET_NONE) first = e;
      n++;
    }
  uint32_t e = first;
  if (first != TET_NONE && !twice) do {
    met++;
    e = s->next[tail(s, s->beside[e])];
  } while (e != TET_NONE && e != first && met <= n);
  *ret_first = first;
  return n && !twice && met == n && e == first;
}

static void forget_outline(skinner *s, uint32_t patch) {
  for (uint32_t f = patch; f != TET_NONE; f = s->after[f])
    for (uint32_t j = 0; j < 3; j++) s->next[corner(s, f, j)] = TET_NONE;
}

/* Leaves patches that are no discs as their faces. */
static void part_others(skinner *s) {
  for (uint32_t f = 0; f < s->n_faces; f++) {
    uint32_t first;
    if (s->patch[f] != f) continue;
    int is_disc = walk_outline(s, f, &first);
    forget_outline(s, f);
    for (uint32_t g = f; !is_disc && g != TET_NONE;) {
      uint32_t then = s->after[g];
      s->seed[g] = s->patch[g] = g;
      s->after[g] = TET_NONE;
      g = then;
    }
  }
}

/* An edge between two patches that is being divided. */
typedef struct ridge {
  plane side[2];
} ridge;

/* 1 if vertex v, on no outline yet, is in the planes of both sides, and beside edge ab between its ends. */
static int is_beside(const skinner *s, const ridge *at, uint32_t v, uint32_t a, uint32_t b) {
  const double reach = 4 * s->tolerance;
  double d[3], p[3], q[3], across[3];
  if (s->taken[v] == ON_OUTLINE || !is_near(s, &at->side[0], v) || !is_near(s, &at->side[1], v)) return 0;
  tet_minus(place(s, b), place(s, a), d);
  tet_minus(place(s, v), place(s, a), p);
  tet_minus(place(s, v), place(s, b), q);
  if (!(tet_dot(p, d) > 0 && tet_dot(q, d) < 0)) return 0;
  tet_cross(p, d, across);
  return tet_square(across) <= reach * reach * tet_square(d);
}

/* A vertex beside edge ab of the tetrahedra around it, of which t is one; TET_NONE: there is none. *t has it. */
static uint32_t find_beside(const skinner *s, const ridge *at, uint32_t a, uint32_t b, uint32_t *t) {
  const uint32_t *v = s->p->tets + 4 * (size_t)*t;
  uint32_t i = 0, start = *t;
  while (v[i] == a || v[i] == b) i++;
  for (uint32_t way = 0; way < 2; way++) {
    uint32_t u = start, x = way ? fourth(s, start, a, b, v[i]) : v[i], y = fourth(s, start, a, b, x);
    for (;;) { /* out through the face of a, b and y */
      uint32_t found = is_beside(s, at, x, a, b) ? x : is_beside(s, at, y, a, b) ? y : TET_NONE;
      if (found != TET_NONE) {
        *t = u;
        return found;
      }
      uint32_t h = s->p->adj[opposite(s, u, x)];
      if (h == TET_NONE) break;
      if (h >> 2 == start) return TET_NONE;
      u = h >> 2;
      x = y;
      y = s->p->tets[h];
    }
  }
  return TET_NONE;
}

static tet_status add_link(skinner *s, uint32_t value) {
  return tet_push(s->ctx, &s->link, &s->n_link, &s->cap_link, value);
}

/* Divides edge e between two patches at all that is beside it. On the stack: the ends to come, each with
 * a tetrahedron that has the edge there. */
static tet_status divide(skinner *s, uint32_t e) {
  const ridge at = {{plane_of(s, s->seed[e / 3]), plane_of(s, s->seed[s->beside[e] / 3])}};
  uint32_t a = tail(s, e), start = (uint32_t)s->n_link;
  size_t n = 0;
  s->chain[e] = s->chain[s->beside[e]] = start;
  tet_status status = add_link(s, 0);
  if (!status) status = push(s, &n, tail(s, s->beside[e]));
  if (!status) status = push(s, &n, s->handle[e / 3] >> 2);
  while (n && !status) {
    uint32_t b = s->stack[n - 2], v = s->tolerance > 0 ? find_beside(s, &at, a, b, &s->stack[n - 1]) : TET_NONE;
    uint32_t t = s->stack[n - 1];
    if (v == TET_NONE) {
      status = add_link(s, a);
      a = b;
      n -= 2;
      continue;
    }
    s->taken[v] = ON_OUTLINE;
    s->out.n_below++;
    status = push(s, &n, v);
    if (!status) status = push(s, &n, t);
  }
  if (!status) s->link[start] = (uint32_t)s->n_link - start - 1;
  return status;
}

static tet_status divide_edges(skinner *s) {
  tet_status status = TET_OK;
  for (uint32_t e = 0; e < 3 * s->n_faces; e++)
    if (is_between(s, e)) s->taken[tail(s, e)] = ON_OUTLINE;
  for (uint32_t e = 0; e < 3 * s->n_faces && !status; e++) {
    if (is_between(s, e) && e < s->beside[e]) status = divide(s, e);
    if (!status && (e & 1023) == 0) status = tet_poll(s->ctx);
  }
  for (uint32_t e = 0; e < 3 * s->n_faces; e++)
    if (s->taken[tail(s, e)] != ON_OUTLINE) s->taken[tail(s, e)] = s->patch[e / 3];
  return status;
}

static tet_status add_vertex(skinner *s, uint32_t v) {
  return tet_push(s->ctx, &s->out.polygon_vertices, &s->n_vertices, &s->cap_vertices, v);
}

/* What was added since the last one is a polygon. */
static tet_status end_polygon(skinner *s) {
  tet_skin *o = &s->out;
  tet_status status =
      tet_grow(s->ctx, &o->polygon_start, &s->cap_polygon, (size_t)o->n_polygons + 2, sizeof *o->polygon_start);
  if (!status) o->polygon_start[++o->n_polygons] = (uint32_t)s->n_vertices;
  return status;
}

static tet_status add_outline(skinner *s, uint32_t patch) {
  uint32_t first;
  tet_status status = walk_outline(s, patch, &first) ? TET_OK : tet_internal(s->ctx, "a facet that is no disc");
  uint32_t e = first;
  if (!status) do {
    uint32_t start = s->chain[e], n = s->link[start];
    if (s->link[start + 1] == tail(s, e)) {
      for (uint32_t k = 1; k <= n && !status; k++) status = add_vertex(s, s->link[start + k]);
    } else {
      status = add_vertex(s, tail(s, e));
      for (uint32_t k = n; k > 1 && !status; k--) status = add_vertex(s, s->link[start + k]);
    }
    e = s->next[tail(s, s->beside[e])];
  } while (e != first && !status);
  forget_outline(s, patch);
  return status ? status : end_polygon(s);
}

/* 1 if v, seen along the axis, is in the polygon of those vertices. */
static int is_inside(const skinner *s, const uint32_t *polygon, uint32_t n, int axis, uint32_t v) {
  int i = (axis + 1) % 3, j = (axis + 2) % 3, in = 0;
  const double *x = place(s, v), *a = place(s, polygon[n - 1]);
  for (uint32_t k = 0; k < n; k++) {
    const double *b = place(s, polygon[k]);
    if ((a[j] > x[j]) != (b[j] > x[j]) && x[i] < a[i] + (b[i] - a[i]) * ((x[j] - a[j]) / (b[j] - a[j]))) in = !in;
    a = b;
  }
  return in;
}

static tet_status add_point(skinner *s, uint32_t v) {
  s->listed[v] = 1;
  tet_status status = add_vertex(s, v);
  return status ? status : end_polygon(s);
}

/* Adds what flat tetrahedra have below the patch. */
static tet_status add_below(skinner *s, uint32_t patch, const plane *at) {
  uint32_t outline = s->out.facet_start[s->out.n_facets - 1], start = s->out.polygon_start[outline];
  uint32_t n_outline = s->out.polygon_start[outline + 1] - start;
  int axis = tet_longest_axis(at->normal);
  size_t n = 0;
  tet_status status = TET_OK;
  for (uint32_t f = patch; f != TET_NONE && !status; f = s->after[f]) status = push(s, &n, s->handle[f] >> 2);
  for (uint32_t step = 0; n && !status; step++) {
    uint32_t t = s->stack[--n], near = 0;
    const uint32_t *v = s->p->tets + 4 * (size_t)t;
    if (s->seen[t] == patch) continue;
    s->seen[t] = patch;
    for (int k = 0; k < 4; k++) near += (uint32_t)is_near(s, at, v[k]);
    if (near < 4) continue;
    for (uint32_t h = 4 * t; h < 4 * t + 4 && !status; h++) {
      if (s->p->adj[h] != TET_NONE) status = push(s, &n, s->p->adj[h] >> 2);
      uint32_t w = s->p->tets[h];
      if (status || s->taken[w] != TET_NONE) continue;
      if (!is_inside(s, s->out.polygon_vertices + start, n_outline, axis, w)) continue;
      s->taken[w] = patch;
      s->out.n_below++;
      status = add_point(s, w);
    }
    if (!status && (step & 255) == 0) status = tet_poll(s->ctx);
  }
  return status;
}

static tet_status add_facet(skinner *s, uint32_t patch) {
  tet_skin *o = &s->out;
  const plane at = plane_of(s, s->seed[patch]);
  o->facet_start[o->n_facets++] = o->n_polygons;
  tet_status status = add_outline(s, patch);
  for (uint32_t f = patch; f != TET_NONE && !status; f = s->after[f])
    for (uint32_t j = 0; j < 3 && !status; j++) {
      uint32_t v = corner(s, f, j);
      if (s->taken[v] == patch && !s->listed[v]) status = add_point(s, v);
    }
  return status || !(s->tolerance > 0) ? status : add_below(s, patch, &at);
}

static tet_status add_facets(skinner *s) {
  tet_skin *o = &s->out;
  tet_status status = TET_OK;
  for (uint32_t f = 0; f < s->n_faces && !status; f++) {
    if (s->patch[f] == f) status = add_facet(s, f);
    if (!status && (f & 1023) == 0) status = tet_poll(s->ctx);
  }
  if (!status) o->facet_start[o->n_facets] = o->n_polygons;
  return status;
}

/* Fills `out` anew, by a share of the width; 0: with the faces. */
static tet_status try_share(skinner *s, double share) {
  tet_skin *o = &s->out;
  double tolerance = fmin(share * s->width, s->most);
  s->tolerance = o->tolerance = tolerance > s->least ? tolerance : 0;
  o->n_facets = o->n_polygons = o->n_below = o->polygon_start[0] = 0;
  s->n_vertices = s->n_link = 0;
  memset(s->taken, 0xff, s->p->n_points * sizeof *s->taken);
  memset(s->listed, 0, s->p->n_points);
  memset(s->seen, 0xff, s->p->n_tets * sizeof *s->seen);
  for (uint32_t f = 0; f < s->n_faces; f++) s->seed[f] = f;
  tet_status status = s->tolerance > 0 ? make_patches(s) : TET_OK;
  if (status) return status;
  number_patches(s);
  part_others(s);
  status = divide_edges(s);
  return status ? status : add_facets(s);
}

/* The square of the shortest edge at a vertex of a facet. */
static double shortest2(const skinner *s) {
  double least2 = INFINITY;
  for (size_t t = 0; t < s->p->n_tets; t++) {
    const uint32_t *v = s->p->tets + 4 * t;
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < i; j++)
        if (s->taken[v[i]] != TET_NONE || s->taken[v[j]] != TET_NONE)
          least2 = fmin(least2, tet_distance2(place(s, v[i]), place(s, v[j])));
  }
  return least2;
}

/* The same. What is smaller than a tolerance is in every plane: so that is less than any edge at the facets, if need be
 * less than by the share. */
static tet_status build(skinner *s, double share) {
  for (;;) {
    tet_status status = try_share(s, share);
    if (!status) status = tet_poll(s->ctx);
    if (status || !(s->tolerance > 0)) return status;
    double most = sqrt(shortest2(s)) / 8;
    if (!(s->tolerance > most)) return TET_OK;
    s->most = most;
  }
}

/* The share of the width within which some points are below the hull's faces, and within ten or more times that not a
 * tenth more; of several the least, but for such as have twice the points; that of doubles if there is none. */
static tet_status choose_share(skinner *s, double *ret) {
  static const double share[] = {1e-12, 1e-9, 1e-6, 3e-5, 3e-4};
  enum { LAST = sizeof share / sizeof *share - 1 };
  tet_status status = build(s, share[LAST]);
  uint32_t n = 0, most = 0, all = s->out.n_below;
  *ret = share[0];
  if (status || !all) return status; /* mostly nothing is near */
  for (int k = 0; k <= LAST && !status; k++) {
    if (k < LAST) status = build(s, share[k]);
    uint32_t more = k < LAST ? s->out.n_below : all;
    if (!status && n && n / 2 >= most && more <= n + n / 10) {
      *ret = share[k - 1];
      most = n;
    }
    n = more;
  }
  return status;
}

tet_status tet_skin_build(tet_ctx *ctx, const tet_pieces *pieces, int exact, tet_skin *ret) {
  skinner s = {.ctx = ctx, .p = pieces, .most = INFINITY};
  double share = 0;
  tet_status status = list_faces(&s);
  if (!status) measure_hull(&s);
  if (!status && !exact) status = choose_share(&s, &share);
  if (!status) status = build(&s, share);
  void *all[] = {s.handle, s.beside, s.seed,  s.patch, s.after, s.taken,
                 s.listed, s.seen,   s.chain, s.link,  s.next,  s.stack};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  if (status) tet_skin_free(ctx, &s.out);
  else *ret = s.out;
  return status;
}

void tet_skin_free(tet_ctx *ctx, tet_skin *skin) {
  tet_free(ctx, skin->facet_start);
  tet_free(ctx, skin->polygon_start);
  tet_free(ctx, skin->polygon_vertices);
  *skin = (tet_skin){0};
}
