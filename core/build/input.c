// SPDX-License-Identifier: Apache-2.0
/* input.c: the caller's arrays checked; duplicate vertices, repeated facets
 * found (thesis A.1.2; design 9.5). No geometry but equality. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/soup.h"
#include "exact/predicates.h"

static int in_range(double x) { return x >= -TET_COORDINATE_LIMIT && x <= TET_COORDINATE_LIMIT; }

static tet_status check_coordinates(tet_ctx *ctx, const double *x, uint64_t n, const char *what) {
  if (n > 0 && !x) return tet_fail(ctx, TET_E_ARGUMENT, "%s: no coordinates given", what);
  for (uint64_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (!in_range(x[3 * i + k]))
        return tet_fail(ctx, TET_E_NOT_FINITE, "%s %llu: coordinate %c is %g", what,
                        (unsigned long long)i, 'x' + k, x[3 * i + k]);
  return TET_OK;
}

static tet_status check_starts(tet_ctx *ctx, const uint32_t *start, uint32_t n, const char *what,
                               const char *of) {
  if (!start) return tet_fail(ctx, TET_E_ARGUMENT, "%s: no array given", what);
  if (start[0] != 0) return tet_fail(ctx, TET_E_ARGUMENT, "%s begins with %u, not 0", what, start[0]);
  for (uint32_t i = 0; i < n; i++)
    if (start[i + 1] < start[i])
      return tet_fail(ctx, TET_E_ARGUMENT, "%s falls from %u to %u at %s %u", what, start[i],
                      start[i + 1], of, i);
  return TET_OK;
}

static tet_status check_end(tet_ctx *ctx, const uint32_t *start, uint32_t n, uint32_t end,
                            const char *what) {
  if (start[n] == end) return TET_OK;
  return tet_fail(ctx, TET_E_ARGUMENT, "%s ends with %u, not %u", what, start[n], end);
}

static tet_status check_polygons(tet_ctx *ctx, const tet_pls *pls) {
  tet_status st;
  if (pls->n_polygons == 0) return TET_OK;
  if ((st = check_starts(ctx, pls->polygon_start, pls->n_polygons, "polygon_start", "polygon")) != TET_OK)
    return st;
  if (pls->polygon_start[pls->n_polygons] > 0 && !pls->polygon_vertices)
    return tet_fail(ctx, TET_E_ARGUMENT, "polygon_vertices: no array given");
  for (uint32_t p = 0; p < pls->n_polygons; p++) {
    if (pls->polygon_start[p] == pls->polygon_start[p + 1])
      return tet_fail(ctx, TET_E_ARGUMENT, "polygon %u has no vertices", p);
    for (uint32_t i = pls->polygon_start[p]; i < pls->polygon_start[p + 1]; i++)
      if (pls->polygon_vertices[i] >= pls->n_points)
        return tet_fail(ctx, TET_E_INDEX, "polygon %u names vertex %u of %u", p,
                        pls->polygon_vertices[i], pls->n_points);
  }
  return TET_OK;
}

static tet_status check_facets(tet_ctx *ctx, const tet_pls *pls) {
  tet_status st;
  if (pls->facet_start) {
    if ((st = check_starts(ctx, pls->facet_start, pls->n_facets, "facet_start", "facet")) != TET_OK ||
        (st = check_end(ctx, pls->facet_start, pls->n_facets, pls->n_polygons, "facet_start")) != TET_OK)
      return st;
    for (uint32_t f = 0; f < pls->n_facets; f++)
      if (pls->facet_start[f] == pls->facet_start[f + 1])
        return tet_fail(ctx, TET_E_ARGUMENT, "facet %u has no polygons", f);
  } else if (pls->n_facets != pls->n_polygons) {
    return tet_fail(ctx, TET_E_ARGUMENT, "%u facets and %u polygons, and no facet_start", pls->n_facets,
                    pls->n_polygons);
  }
  if (pls->n_facet_holes == 0) return TET_OK;
  if ((st = check_starts(ctx, pls->facet_hole_start, pls->n_facets, "facet_hole_start", "facet")) != TET_OK ||
      (st = check_end(ctx, pls->facet_hole_start, pls->n_facets, pls->n_facet_holes, "facet_hole_start")) !=
          TET_OK)
    return st;
  return check_coordinates(ctx, pls->facet_holes, pls->n_facet_holes, "facet hole");
}

static tet_status check_loose(tet_ctx *ctx, const tet_pls *pls) {
  if (pls->n_segments > 0 && !pls->segments)
    return tet_fail(ctx, TET_E_ARGUMENT, "segments: no array given");
  for (uint64_t i = 0; i < 2 * (uint64_t)pls->n_segments; i++)
    if (pls->segments[i] >= pls->n_points)
      return tet_fail(ctx, TET_E_INDEX, "segment %u names vertex %u of %u", (uint32_t)(i / 2),
                      pls->segments[i], pls->n_points);
  if (pls->n_loose_points == TET_LOOSE_ALL_UNUSED) return TET_OK;
  if (pls->n_loose_points > 0 && !pls->loose_points)
    return tet_fail(ctx, TET_E_ARGUMENT, "loose_points: no array given");
  for (uint32_t i = 0; i < pls->n_loose_points; i++)
    if (pls->loose_points[i] >= pls->n_points)
      return tet_fail(ctx, TET_E_INDEX, "loose point %u is vertex %u of %u", i, pls->loose_points[i],
                      pls->n_points);
  return TET_OK;
}

tet_status tet_check_pls(tet_ctx *ctx, const tet_pls *pls) {
  tet_status st;
  if (pls->n_points >= (uint32_t)1 << 31)
    return tet_fail(ctx, TET_E_TOO_LARGE, "%u vertices", pls->n_points);
  if ((st = check_coordinates(ctx, pls->points, pls->n_points, "vertex")) != TET_OK ||
      (st = check_polygons(ctx, pls)) != TET_OK || (st = check_facets(ctx, pls)) != TET_OK ||
      (st = check_loose(ctx, pls)) != TET_OK ||
      (st = check_coordinates(ctx, pls->holes, pls->n_holes, "hole")) != TET_OK)
    return st;
  return check_coordinates(ctx, pls->region_seeds, pls->n_regions, "region seed");
}

static uint64_t mix(uint64_t h) {
  h ^= h >> 33;
  h *= 0xff51afd7ed558ccdULL;
  h ^= h >> 33;
  h *= 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33);
}

static uint64_t hash_point(const double *x) {
  uint64_t h = 0;
  for (int k = 0; k < 3; k++) {
    double y = x[k] + 0.0; /* -0 becomes 0 */
    uint64_t bits;
    memcpy(&bits, &y, sizeof bits);
    h = mix(h ^ bits) + 0x9e3779b97f4a7c15ULL;
  }
  return h;
}

/* A table of at least 2n slots, all TET_NONE. */
static uint32_t *new_table(tet_ctx *ctx, uint64_t n, uint64_t *ret_mask) {
  uint64_t size = 16;
  while (size < 2 * n) size *= 2;
  uint32_t *table = tet_alloc(ctx, size, sizeof *table);
  if (table) memset(table, 0xff, size * sizeof *table);
  *ret_mask = size - 1;
  return table;
}

tet_status tet_find_duplicates(tet_soup *s) {
  uint64_t mask;
  uint32_t *table = new_table(s->ctx, s->points->n, &mask);
  if (!table) return tet_ctx_error(s->ctx)->status;
  tet_status st = TET_OK;
  for (uint32_t v = 0; v < s->points->n && st == TET_OK; v++) {
    const double *x = tet_soup_x(s, v);
    uint64_t i = hash_point(x) & mask;
    for (; table[i] != TET_NONE; i = (i + 1) & mask) {
      const double *y = tet_soup_x(s, table[i]);
      if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) break;
    }
    if (table[i] == TET_NONE) table[i] = v;
    s->same_as[v] = table[i];
    if (table[i] != v) s->n_duplicates++;
    if (v % 4096 == 4095) st = tet_poll(s->ctx);
  }
  tet_free(s->ctx, table);
  return st;
}

/* One polygon side, or a 1-vertex polygon (a == b). */
typedef struct side {
  uint32_t a, b;
} side;

static int compare_sides(const void *px, const void *py) {
  const side *x = px, *y = py;
  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return x->b < y->b ? -1 : x->b > y->b;
}

/* All sides of facet f, sorted, into *sides (grown). */
static tet_status sorted_sides(const tet_soup *s, uint32_t f, side **sides, size_t *cap, uint32_t *ret_n) {
  const tet_pls *pls = s->pls;
  uint32_t p0 = tet_first_polygon(pls, f), p1 = tet_first_polygon(pls, f + 1), n = 0;
  tet_status st = tet_grow(s->ctx, sides, cap, pls->polygon_start[p1] - pls->polygon_start[p0], sizeof **sides);
  if (st != TET_OK) return st;
  for (uint32_t p = p0; p < p1; p++) {
    uint32_t i0 = pls->polygon_start[p], i1 = pls->polygon_start[p + 1], before = n;
    for (uint32_t i = i0; i < i1; i++) {
      uint32_t a = s->same_as[pls->polygon_vertices[i]];
      uint32_t b = s->same_as[pls->polygon_vertices[i + 1 < i1 ? i + 1 : i0]];
      if (a == b) continue;
      (*sides)[n++] = a < b ? (side){a, b} : (side){b, a};
    }
    uint32_t v = s->same_as[pls->polygon_vertices[i0]];
    if (n == before) (*sides)[n++] = (side){v, v};
  }
  qsort(*sides, n, sizeof **sides, compare_sides);
  *ret_n = n;
  return TET_OK;
}

static int same_holes(const tet_pls *pls, uint32_t f, uint32_t g) {
  if (pls->n_facet_holes == 0) return 1;
  uint32_t nf = pls->facet_hole_start[f + 1] - pls->facet_hole_start[f];
  uint32_t ng = pls->facet_hole_start[g + 1] - pls->facet_hole_start[g];
  return nf == ng && (nf == 0 || memcmp(pls->facet_holes + 3 * (size_t)pls->facet_hole_start[f],
                                        pls->facet_holes + 3 * (size_t)pls->facet_hole_start[g],
                                        nf * 3 * sizeof(double)) == 0);
}

typedef struct repeat_work {
  side *mine, *other;
  size_t cap_mine, cap_other;
  uint32_t *table;
  uint64_t mask;
  uint64_t *hash; /* [n_facets] */
} repeat_work;

static tet_status find_repeat(tet_soup *s, repeat_work *w, uint32_t f) {
  uint32_t n, m;
  tet_status st = sorted_sides(s, f, &w->mine, &w->cap_mine, &n);
  if (st != TET_OK) return st;
  uint64_t h = n;
  for (uint32_t i = 0; i < n; i++) h = mix(h ^ ((uint64_t)w->mine[i].a << 32 | w->mine[i].b)) + 1;
  w->hash[f] = h;
  uint64_t i = h & w->mask;
  for (; w->table[i] != TET_NONE; i = (i + 1) & w->mask) {
    uint32_t g = w->table[i];
    if (w->hash[g] != h || !same_holes(s->pls, f, g)) continue;
    if ((st = sorted_sides(s, g, &w->other, &w->cap_other, &m)) != TET_OK) return st;
    if (m != n || (n > 0 && memcmp(w->mine, w->other, n * sizeof *w->mine) != 0)) continue;
    s->repeats[f] = g;
    s->n_repeated_facets++;
    return TET_OK;
  }
  w->table[i] = f;
  return TET_OK;
}

tet_status tet_find_repeated_facets(tet_soup *s) {
  repeat_work w = {0};
  tet_status st = TET_OK;
  w.table = new_table(s->ctx, s->pls->n_facets, &w.mask);
  w.hash = tet_alloc(s->ctx, s->pls->n_facets, sizeof *w.hash);
  if (!w.table || !w.hash) st = tet_ctx_error(s->ctx)->status;
  for (uint32_t f = 0; f < s->pls->n_facets && st == TET_OK; f++) {
    if (f % 1024 == 0) st = tet_poll(s->ctx);
    if (st == TET_OK) st = find_repeat(s, &w, f);
  }
  tet_free(s->ctx, w.mine);
  tet_free(s->ctx, w.other);
  tet_free(s->ctx, w.table);
  tet_free(s->ctx, w.hash);
  return st;
}
