// SPDX-License-Identifier: Apache-2.0
/* outline.c: a facet's border from its polygons (thesis A.1.2), exactly.
 *
 * A facet is what is inside an odd number of turns of any of its polygons. For one polygon that
 * meets each vertex once its sides are the border. Else the sides are cut where vertices of the
 * facet lie on them, and for each part it is asked by crossings whether the facet is just to its
 * left, and just to its right.
 *
 * A hole is taken for all that is inside the same polygons as its seed. It may be less, where others'
 * segments divide that: what is covered of it all the same is looked at in gaps.c. */
#include "audit/outline.h"

#include "base/sort.h"
#include "base/vector.h"
#include "exact/predicates.h"
#include "exact/shape.h"

#include <math.h>
#include <string.h>

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

static uint32_t first_polygon(const tet_pls *pls, uint32_t f) { return pls->facet_start ? pls->facet_start[f] : f; }

/* The corner after which polygon p has repeated none, as a row of the mesh. */
static uint32_t corner(const tet_pls *pls, const tet_mesh *mesh, uint32_t i) {
  return mesh->point_same_as[pls->polygon_vertices[i]];
}

/* The farthest of the facet's corners by distance from v[0] (known 1) or from the line v[0] v[1]
 * (known 2); 1 if three corners are off one line. By coordinates, as the squares of small ones are 0. */
static int spread(const tet_pls *pls, const tet_mesh *mesh, uint32_t from, uint32_t to, uint32_t v[3]) {
  v[0] = v[1] = corner(pls, mesh, from);
  for (int known = 1; known < 3; known++) {
    double most = 0, u[3], d[3], n[3];
    uint32_t best = TET_NONE;
    tet_minus(place(mesh, v[1]), place(mesh, v[0]), u);
    double length = known == 2 ? tet_longest(u) : 1;
    for (int k = 0; k < 3; k++) u[k] /= length;
    for (uint32_t i = from; i < to; i++) {
      uint32_t c = corner(pls, mesh, i);
      tet_minus(place(mesh, c), place(mesh, v[0]), d);
      tet_cross(u, d, n);
      double size = known == 1 ? tet_longest(d) : tet_longest(n);
      if (size > most || best == TET_NONE) {
        if (known == 2 && tet_collinear_xyz(place(mesh, v[0]), place(mesh, v[1]), place(mesh, c))) continue;
        most = size;
        best = c;
      }
    }
    if (best == TET_NONE || (known == 1 && best == v[0])) return 0;
    v[known] = best;
  }
  return 1;
}

void tet_view_facet(const tet_pls *pls, const tet_mesh *mesh, uint32_t f, tet_facet_view *ret_view) {
  uint32_t p = first_polygon(pls, f), q = first_polygon(pls, f + 1);
  tet_facet_view view = {{TET_NONE, TET_NONE, TET_NONE}, 0, 0};
  for (uint32_t k = p; k < q; k++) view.has_area |= pls->polygon_start[k + 1] - pls->polygon_start[k] > 2;
  if (p == q || !spread(pls, mesh, pls->polygon_start[p], pls->polygon_start[q], view.v)) {
    view.v[0] = TET_NONE;
    *ret_view = view;
    return;
  }
  view.axis = (uint8_t)tet_widest_axis(place(mesh, view.v[0]), place(mesh, view.v[1]), place(mesh, view.v[2]));
  *ret_view = view;
}

typedef struct side {
  uint32_t from, to; /* rows of the mesh */
  uint32_t loop;
} side;

typedef struct outline {
  tet_ctx *ctx;
  const tet_pls *pls;
  const tet_mesh *mesh;
  int axis, i, j; /* the dropped axis, and those of the projection */
  side *side;
  size_t n_sides, cap_side;
  uint32_t *vertex;
  size_t n_vertices, cap_vertex;
  uint32_t n_loops;
  double *reach;  /* [n_sides] the highest upper end among the sides of the tree under each, see sort_sides */
  uint64_t *hole; /* the loops around each hole seed, as of inside_of() */
  size_t n_holes;
} outline;

/* The sides of polygon p, if it has three and more vertices. */
static tet_status add_loop(outline *o, uint32_t p) {
  uint32_t from = o->pls->polygon_start[p], n = o->pls->polygon_start[p + 1] - from;
  size_t before = o->n_sides;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < n && status == TET_OK; k++) {
    uint32_t a = corner(o->pls, o->mesh, from + k), b = corner(o->pls, o->mesh, from + (k + 1) % n);
    status = tet_push(o->ctx, &o->vertex, &o->n_vertices, &o->cap_vertex, a);
    if (a == b || status != TET_OK) continue;
    status = tet_grow(o->ctx, &o->side, &o->cap_side, o->n_sides + 1, sizeof *o->side);
    if (status == TET_OK) o->side[o->n_sides++] = (side){a, b, o->n_loops};
  }
  if (o->n_sides - before < 3) o->n_sides = before;
  else o->n_loops++;
  return status;
}

/* Sorts the vertices; 1 if each is there once. */
static tet_status sort_vertices(outline *o, int *ret_once) {
  tet_keyed *item = tet_alloc(o->ctx, o->n_vertices, sizeof *item);
  if (!item) return tet_ctx_error(o->ctx)->status;
  for (size_t k = 0; k < o->n_vertices; k++) item[k] = (tet_keyed){o->vertex[k], 0};
  tet_sort_keyed(item, o->n_vertices);
  size_t n = 0;
  for (size_t k = 0; k < o->n_vertices; k++)
    if (k == 0 || item[k].key != item[k - 1].key) o->vertex[n++] = (uint32_t)item[k].key;
  *ret_once = n == o->n_vertices;
  o->n_vertices = n;
  tet_free(o->ctx, item);
  return TET_OK;
}

static int is_before(const outline *o, uint32_t v, uint32_t w) {
  const double *x = place(o->mesh, v), *y = place(o->mesh, w);
  return x[o->i] < y[o->i] || (x[o->i] == y[o->i] && x[o->j] < y[o->j]);
}

/* The turn of the one polygon at its first vertex in the plane's order; 0 where it is straight. */
static int turn(const outline *o) {
  size_t n = o->n_sides, first = 0;
  for (size_t k = 1; k < n; k++)
    if (is_before(o, o->side[k].from, o->side[first].from)) first = k;
  const side *s = o->side + first, *before = o->side + (first + n - 1) % n;
  return tet_orient2d_xyz(o->axis, place(o->mesh, before->from), place(o->mesh, s->from), place(o->mesh, s->to));
}

/* Vertex v strictly between a and b, on their line? */
static int is_between(const outline *o, uint32_t a, uint32_t b, uint32_t v) {
  if (v == a || v == b) return 0;
  const double *x = place(o->mesh, a), *y = place(o->mesh, b), *z = place(o->mesh, v);
  for (int k = 0; k < 3; k++)
    if (z[k] < fmin(x[k], y[k]) || z[k] > fmax(x[k], y[k])) return 0;
  return tet_same_direction(x, y, z);
}

/* The place just beside the middle of the part that leaves a towards b, on its left or right: does
 * a line from it along axis i cross side s? In the order of the plane: first a itself decides, then
 * the way to b, then the side. */
static int crosses(const outline *o, const side *s, uint32_t a, uint32_t b, int left) {
  const double *x = place(o->mesh, a), *y = place(o->mesh, b);
  const double *p = place(o->mesh, s->from), *q = place(o->mesh, s->to);
  if (p[o->j] == q[o->j]) return 0; /* level sides are never crossed */
  if (p[o->j] > q[o->j]) {
    const double *swap = p;
    p = q;
    q = swap;
  }
  int rises = (y[o->j] > x[o->j]) - (y[o->j] < x[o->j]);
  if (!rises) rises = (y[o->i] > x[o->i]) == left ? 1 : -1;
  if (rises > 0 ? !(p[o->j] <= x[o->j] && x[o->j] < q[o->j]) : !(p[o->j] < x[o->j] && x[o->j] <= q[o->j])) return 0;
  int at = tet_orient2d_xyz(o->axis, p, q, x);
  if (!at) at = tet_orient2d_xyz(o->axis, p, q, y);
  if (!at) at = rises > 0 ? (left ? 1 : -1) : (left ? -1 : 1);
  return at > 0; /* the side is to the right, where the line goes */
}

/* Fills `reach` for the sides of a range, the middle one for all; returns that. */
static double set_reach(outline *o, size_t from, size_t to) {
  if (from == to) return -INFINITY;
  size_t mid = from + (to - from) / 2;
  const side *s = o->side + mid;
  double own = fmax(place(o->mesh, s->from)[o->j], place(o->mesh, s->to)[o->j]);
  double low = set_reach(o, from, mid), high = set_reach(o, mid + 1, to);
  return o->reach[mid] = fmax(own, fmax(low, high));
}

/* A number for a loop, so that sums of different loops differ. */
static uint64_t number_of(uint32_t loop) {
  uint64_t h = (loop + 1) * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 27) * 0x94d049bb133111ebu;
  return h ^ h >> 31;
}

static double low_end(const outline *o, const side *s) {
  return fmin(place(o->mesh, s->from)[o->j], place(o->mesh, s->to)[o->j]);
}

/* Sorts the sides by their lower ends into a tree: the middle of a range stands over both halves. */
static tet_status sort_sides(outline *o) {
  tet_keyed *item = tet_alloc(o->ctx, o->n_sides, sizeof *item);
  side *sorted = tet_alloc(o->ctx, o->n_sides, sizeof *sorted);
  o->reach = tet_alloc(o->ctx, o->n_sides, sizeof *o->reach);
  tet_status status = item && sorted && o->reach ? TET_OK : tet_ctx_error(o->ctx)->status;
  if (status == TET_OK) {
    for (size_t k = 0; k < o->n_sides; k++) item[k] = (tet_keyed){tet_ordered_bits(low_end(o, o->side + k)), k};
    tet_sort_keyed(item, o->n_sides);
    for (size_t k = 0; k < o->n_sides; k++) sorted[k] = o->side[item[k].value];
    memcpy(o->side, sorted, o->n_sides * sizeof *sorted);
    set_reach(o, 0, o->n_sides);
  }
  tet_free(o->ctx, item);
  tet_free(o->ctx, sorted);
  return status;
}

/* The loops that go an odd number of turns around the place just left (or right) of the part from a
 * towards b, by the sides of a range: the sum of their numbers, bit by bit; 0: none. Only sides at
 * the level of a can be crossed. */
static uint64_t inside_by(const outline *o, size_t from, size_t to, uint32_t a, uint32_t b, int left) {
  uint64_t sum = 0;
  double level = place(o->mesh, a)[o->j];
  while (from < to) {
    size_t mid = from + (to - from) / 2;
    if (o->reach[mid] < level) break;
    sum ^= inside_by(o, from, mid, a, b, left);
    if (low_end(o, o->side + mid) > level) break;
    if (crosses(o, o->side + mid, a, b, left)) sum ^= number_of(o->side[mid].loop);
    from = mid + 1;
  }
  return sum;
}

static uint64_t inside_of(const outline *o, uint32_t a, uint32_t b, int left) {
  return inside_by(o, 0, o->n_sides, a, b, left);
}

/* Is this the inside of the loops that a hole seed is in? */
static int is_hole(const outline *o, uint64_t loops) {
  for (size_t h = 0; h < o->n_holes; h++)
    if (o->hole[h] == loops) return 1;
  return 0;
}

/* The loops around each hole seed of facet f. */
static tet_status find_holes(outline *o, uint32_t f) {
  const tet_pls *pls = o->pls;
  if (!pls->n_facet_holes) return TET_OK;
  uint32_t first = pls->facet_hole_start[f];
  o->n_holes = pls->facet_hole_start[f + 1] - first;
  if (!o->n_holes) return TET_OK;
  o->hole = tet_calloc(o->ctx, o->n_holes, sizeof *o->hole);
  if (!o->hole) return tet_ctx_error(o->ctx)->status;
  for (size_t h = 0; h < o->n_holes; h++) {
    const double *x = pls->facet_holes + 3 * (first + h);
    for (size_t k = 0; k < o->n_sides; k++) {
      const double *p = place(o->mesh, o->side[k].from), *q = place(o->mesh, o->side[k].to);
      int rises = p[o->j] < q[o->j];
      if (!(rises ? p[o->j] <= x[o->j] && x[o->j] < q[o->j] : q[o->j] <= x[o->j] && x[o->j] < p[o->j])) continue;
      if ((tet_orient2d_xyz(o->axis, p, q, x) > 0) == rises) o->hole[h] ^= number_of(o->side[k].loop);
    }
  }
  return TET_OK;
}

/* Is the facet just left (or right) of the part from a towards b? */
static int is_inside(const outline *o, uint32_t a, uint32_t b, int left) {
  uint64_t loops = inside_of(o, a, b, left);
  return loops && !is_hole(o, loops);
}

/* The facet's vertices by their level: o->vertex sorted, and the keys to find them by. */
static tet_status sort_levels(outline *o, tet_keyed **ret_item) {
  tet_keyed *item = tet_alloc(o->ctx, o->n_vertices, sizeof *item);
  if (!item) return tet_ctx_error(o->ctx)->status;
  for (size_t k = 0; k < o->n_vertices; k++)
    item[k] = (tet_keyed){tet_ordered_bits(place(o->mesh, o->vertex[k])[o->j]), o->vertex[k]};
  tet_sort_keyed(item, o->n_vertices);
  *ret_item = item;
  return TET_OK;
}

/* The first vertex on the way from a straight to b. */
static uint32_t next_on(const outline *o, const tet_keyed *level, uint32_t a, uint32_t b) {
  uint64_t x = tet_ordered_bits(place(o->mesh, a)[o->j]), y = tet_ordered_bits(place(o->mesh, b)[o->j]);
  uint64_t low = x < y ? x : y, high = x < y ? y : x;
  size_t from = 0, to = o->n_vertices;
  while (from < to) {
    size_t mid = from + (to - from) / 2;
    if (level[mid].key < low) from = mid + 1;
    else to = mid;
  }
  for (; from < o->n_vertices && level[from].key <= high; from++)
    if (is_between(o, a, b, (uint32_t)level[from].value)) b = (uint32_t)level[from].value;
  return b;
}

/* The parts of all sides, ascending by their vertices, each once. */
static tet_status cut_sides(outline *o, tet_keyed **ret_part, size_t *ret_n) {
  tet_keyed *part = NULL, *level = NULL;
  size_t n = 0, cap = 0, distinct = 0;
  tet_status status = sort_levels(o, &level);
  for (size_t k = 0; k < o->n_sides && status == TET_OK; k++) {
    uint32_t from = o->side[k].from, to = o->side[k].to;
    if ((k & 63) == 0) status = tet_poll(o->ctx);
    while (from != to && status == TET_OK) {
      uint32_t next = next_on(o, level, from, to);
      status = tet_grow(o->ctx, &part, &cap, n + 1, sizeof *part);
      uint32_t low = from < next ? from : next, high = from < next ? next : from;
      if (status == TET_OK) part[n++] = (tet_keyed){(uint64_t)low << 32 | high, 0};
      from = next;
    }
  }
  tet_sort_keyed(part, n);
  for (size_t k = 0; k < n; k++)
    if (k == 0 || part[k].key != part[distinct - 1].key) part[distinct++] = part[k];
  tet_free(o->ctx, level);
  *ret_part = part;
  *ret_n = distinct;
  return status;
}

static tet_status add_parts(outline *o, uint32_t root, tet_chain *chain) {
  tet_keyed *part = NULL;
  size_t n = 0;
  tet_status status = sort_sides(o);
  if (status == TET_OK) status = cut_sides(o, &part, &n);
  for (size_t k = 0; k < n && status == TET_OK; k++) {
    uint32_t a = (uint32_t)(part[k].key >> 32), b = (uint32_t)part[k].key;
    int net = is_inside(o, a, b, 1) - is_inside(o, a, b, 0);
    if (net) status = tet_chain_add(o->ctx, chain, root, a, b, net);
    if (status == TET_OK && (k & 63) == 0) status = tet_poll(o->ctx);
  }
  tet_free(o->ctx, part);
  return status;
}

/* The loops of facet f, and the holes. */
static tet_status begin(outline *o, uint32_t f) {
  tet_status status = TET_OK;
  for (uint32_t p = first_polygon(o->pls, f); p < first_polygon(o->pls, f + 1) && status == TET_OK; p++) {
    size_t vertices = o->n_vertices;
    uint32_t loops = o->n_loops;
    status = add_loop(o, p);
    if (o->n_loops == loops) o->n_vertices = vertices; /* a loose segment or point bounds nothing */
  }
  return status == TET_OK ? find_holes(o, f) : status;
}

static void end(outline *o) {
  tet_free(o->ctx, o->side);
  tet_free(o->ctx, o->vertex);
  tet_free(o->ctx, o->reach);
  tet_free(o->ctx, o->hole);
}

tet_status tet_is_hole_beside(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, uint32_t f, int axis,
                              const tet_link *link, size_t n, int *ret_all) {
  outline o = {.ctx = ctx, .pls = pls, .mesh = mesh, .axis = axis, .i = (axis + 1) % 3, .j = (axis + 2) % 3};
  tet_status status = begin(&o, f);
  if (status == TET_OK) status = sort_sides(&o);
  for (size_t k = 0; k < n && *ret_all && status == TET_OK; k++)
    *ret_all = is_hole(&o, inside_of(&o, link[k].from, link[k].to, 0));
  end(&o);
  return status;
}

tet_status tet_facet_outline(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, uint32_t f, uint32_t root,
                             int axis, tet_chain *chain) {
  outline o = {.ctx = ctx, .pls = pls, .mesh = mesh, .axis = axis, .i = (axis + 1) % 3, .j = (axis + 2) % 3};
  tet_status status = begin(&o, f);
  int once = 0, sense = 0;
  if (status == TET_OK && o.n_loops == 1) {
    sense = turn(&o);
    status = sort_vertices(&o, &once);
  } else if (status == TET_OK && o.n_loops) {
    status = sort_vertices(&o, &once);
  }
  int simple = o.n_loops == 1 && once && sense && !o.n_holes;
  for (size_t k = 0; simple && k < o.n_sides && status == TET_OK; k++)
    status = tet_chain_add(ctx, chain, root, o.side[k].from, o.side[k].to, sense);
  if (!simple && o.n_loops && status == TET_OK) status = add_parts(&o, root, chain);
  end(&o);
  return status;
}
