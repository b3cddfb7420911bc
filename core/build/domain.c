// SPDX-License-Identifier: Apache-2.0
/* domain.c: what is inside: the parts that the surface cuts space into, holes and
 * regions by their seeds (thesis 2.4.2, A.1.2).
 *
 * Parts are found by flooding through faces that are no subfaces; a dangling
 * facet bounds nothing. Seeds are located exactly among the rounded tetrahedra. */
#include "build/state.h"

#include <math.h>
#include <string.h>

#include "exact/predicates.h"

/* Floods from slot `from` through faces without a triangle. `stack` has room for
 * all slots. */
static void flood(const tet_complex *c, const uint32_t *face_tri, uint32_t from, uint32_t number,
                  uint32_t *part, uint32_t *stack) {
  size_t n = 0;
  part[from] = number;
  stack[n++] = from;
  while (n) {
    size_t t = stack[--n];
    for (size_t i = 0; i < 4; i++) {
      uint32_t o = c->adj[4 * t + i] >> 2;
      if (face_tri[4 * t + i] != TET_NONE || part[o] != TET_NONE) continue;
      part[o] = number;
      stack[n++] = o;
    }
  }
}

/* TET_E_OPEN; facets that repeat others are listed with them. */
static tet_status encloses_nothing(const tet_state *st) {
  const tet_pls *pls = st->pls;
  const uint32_t *repeats = st->surface.repeats;
  tet_fail(st->ctx, TET_E_OPEN, "the %u facets enclose no volume; %llu of them repeat others", pls->n_facets,
           (unsigned long long)st->surface.n_repeated_facets);
  for (uint32_t f = 0; f < pls->n_facets; f++) {
    if (repeats[f] == TET_NONE) continue;
    const uint32_t pair[2] = {f, repeats[f]};
    tet_offence offence = {.kind = {TET_OFFENDER_FACET, TET_OFFENDER_FACET}, .index = {f, repeats[f]}};
    for (int i = 0; i < 2; i++) offence.marker[i] = pls->facet_markers ? pls->facet_markers[pair[i]] : 0;
    uint32_t polygon = pls->facet_start ? pls->facet_start[f] : f;
    if (polygon < pls->n_polygons && pls->polygon_start[polygon] < pls->polygon_start[polygon + 1])
      memcpy(offence.place, pls->points + 3 * (size_t)pls->polygon_vertices[pls->polygon_start[polygon]],
             sizeof offence.place);
    tet_offend(st->ctx, &offence);
  }
  return TET_E_OPEN;
}

tet_status tet_find_parts(tet_state *st, const uint32_t *face_tri, int keep_hull,
                          uint32_t **ret_part, uint32_t *ret_n_parts) {
  const tet_complex *c = &st->complex;
  uint32_t *part = tet_alloc(st->ctx, c->n_slots, sizeof *part);
  uint32_t *stack = tet_alloc(st->ctx, c->n_slots, sizeof *stack);
  if (!part || !stack) {
    tet_free(st->ctx, part);
    tet_free(st->ctx, stack);
    return tet_ctx_error(st->ctx)->status;
  }
  memset(part, 0xff, c->n_slots * sizeof *part);
  for (uint32_t t = 0; t < c->n_slots; t++) /* the outside first: it is part 0 */
    if (tet_is_live(c, t) && tet_is_ghost(c, t) && part[t] == TET_NONE) {
      part[t] = 0;
      if (!keep_hull) flood(c, face_tri, t, 0, part, stack);
    }
  uint32_t n = 1;
  for (uint32_t t = 0; t < c->n_slots; t++)
    if (tet_is_live(c, t) && part[t] == TET_NONE) flood(c, face_tri, t, n++, part, stack);
  tet_free(st->ctx, stack);
  if (n == 1) {
    tet_free(st->ctx, part);
    return encloses_nothing(st);
  }
  for (uint32_t t = 0; t < c->n_slots; t++)
    if (tet_is_live(c, t) && !tet_is_ghost(c, t)) st->counts.outside_tetrahedra += part[t] == 0;
  *ret_part = part;
  *ret_n_parts = n;
  return TET_OK;
}

/* 1 if x lies in the closed tetrahedron t of p; then *ret_faces has a bit for each
 * face that it lies on. */
static int holds(const tet_pieces *p, uint32_t t, const double *x, int *ret_faces) {
  const double *v[4];
  for (int i = 0; i < 4; i++) v[i] = p->points + 3 * (size_t)p->tets[4 * (size_t)t + (size_t)i];
  for (int j = 0; j < 3; j++) { /* its box */
    double lo = v[0][j], hi = v[0][j];
    for (int i = 1; i < 4; i++) {
      if (v[i][j] < lo) lo = v[i][j];
      if (v[i][j] > hi) hi = v[i][j];
    }
    if (x[j] < lo || x[j] > hi) return 0;
  }
  *ret_faces = 0;
  for (int i = 0; i < 4; i++) {
    int side = tet_orient3d_xyz(v[tet_face[i][0]], v[tet_face[i][1]], v[tet_face[i][2]], x);
    if (side > 0) return 0;
    if (side == 0) *ret_faces |= 1 << i;
  }
  return 1;
}

static tet_status bad_seed(tet_ctx *ctx, tet_offender_kind kind, uint32_t index, const double *x, const char *where) {
  tet_offence offence = {.kind = {kind, kind}, .index = {index, TET_NONE}, .place = {x[0], x[1], x[2]}};
  tet_fail(ctx, TET_E_SEED, "the seed of %s %u at (%.17g, %.17g, %.17g) lies %s",
           kind == TET_OFFENDER_HOLE ? "hole" : "region", index, x[0], x[1], x[2], where);
  tet_offend(ctx, &offence);
  return TET_E_SEED;
}

/* 1: x lies in the closed triangle abc. */
static int is_on(const double *a, const double *b, const double *c, const double *x) {
  for (int j = 0; j < 3; j++)
    if (x[j] < fmin(fmin(a[j], b[j]), c[j]) || x[j] > fmax(fmax(a[j], b[j]), c[j])) return 0;
  if (tet_orient3d_xyz(a, b, c, x) != 0) return 0;
  int axis = 0, turn;
  while ((turn = tet_orient2d_xyz(axis, a, b, c)) == 0) axis++;
  return turn * tet_orient2d_xyz(axis, a, b, x) >= 0 && turn * tet_orient2d_xyz(axis, b, c, x) >= 0 &&
         turn * tet_orient2d_xyz(axis, c, a, x) >= 0;
}

static tet_status check_seed(const tet_state *st, tet_offender_kind kind, uint32_t index, const double *x) {
  const tet_surface *s = &st->surface;
  const double *p = st->points.x;
  for (size_t k = 0; k < s->n_tris; k++) {
    const uint32_t *v = s->tri + 3 * k;
    if (is_on(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2], x))
      return bad_seed(st->ctx, kind, index, x, "on a facet");
  }
  return tet_poll(st->ctx);
}

tet_status tet_check_seeds(const tet_state *st) {
  const tet_pls *pls = st->pls;
  tet_status status = TET_OK;
  for (uint32_t i = 0; i < pls->n_holes && status == TET_OK; i++)
    status = check_seed(st, TET_OFFENDER_HOLE, i, pls->holes + 3 * (size_t)i);
  for (uint32_t i = 0; i < pls->n_regions && status == TET_OK; i++)
    status = check_seed(st, TET_OFFENDER_REGION, i, pls->region_seeds + 3 * (size_t)i);
  return status;
}

/* The region (part - 1) that holds seed x; an error where none does or it lies on the
 * border of one. At an edge or a vertex several tetrahedra hold it, and each is asked. */
static tet_status locate_seed(tet_ctx *ctx, const tet_pieces *p, const double *x, tet_offender_kind kind,
                              uint32_t index, uint32_t *ret_region) {
  int faces = 0, on_facet = 0;
  uint32_t found = TET_NONE;
  for (uint32_t t = 0; t < p->n_tets && !on_facet; t++) {
    if (!holds(p, t, x, &faces)) continue;
    found = t;
    for (int i = 0; i < 4; i++) {
      if (!(faces >> i & 1)) continue;
      uint32_t g = p->adj[4 * (size_t)t + (size_t)i];
      on_facet |= g == TET_NONE || p->region[g >> 2] != p->region[t];
    }
  }
  if (found != TET_NONE && !on_facet) {
    *ret_region = p->region[found];
    return TET_OK;
  }
  return bad_seed(ctx, kind, index, x, on_facet ? "on a facet" : "outside the domain");
}

/* Takes the tetrahedra with drop[region] out; renumbers the rest. */
static tet_status drop_regions(tet_ctx *ctx, tet_pieces *p, uint32_t *tri, const uint8_t *drop) {
  uint32_t *number = tet_alloc(ctx, p->n_tets, sizeof *number), n = 0;
  if (!number) return tet_ctx_error(ctx)->status;
  for (uint32_t t = 0; t < p->n_tets; t++) number[t] = drop[p->region[t]] ? TET_NONE : n++;
  for (size_t t = 0; t < p->n_tets; t++) {
    size_t to = number[t];
    if (number[t] == TET_NONE) continue;
    for (size_t i = 0; i < 4; i++) {
      uint32_t g = p->adj[4 * t + i];
      p->tets[4 * to + i] = p->tets[4 * t + i];
      tri[4 * to + i] = tri[4 * t + i];
      p->adj[4 * to + i] = g == TET_NONE || number[g >> 2] == TET_NONE ? TET_NONE : 4 * number[g >> 2] + (g & 3);
    }
    p->region[to] = p->region[t];
  }
  tet_free(ctx, number);
  p->n_tets = n;
  return TET_OK;
}

/* Parts with a seed come first, of two seeds in one part the first counts; parts
 * without a seed are numbered on. */
static tet_status make_table(tet_ctx *ctx, const tet_pls *pls, tet_pieces *p, uint32_t n_parts,
                             const uint32_t *seed_of, const uint8_t *drop) {
  uint32_t *row = tet_alloc(ctx, n_parts, sizeof *row), n = 0;
  int32_t most = 0;
  p->region_marker = tet_calloc(ctx, n_parts, sizeof *p->region_marker);
  p->region_attribute = tet_calloc(ctx, n_parts, sizeof *p->region_attribute);
  p->region_max_volume = tet_calloc(ctx, n_parts, sizeof *p->region_max_volume);
  if (!row || !p->region_marker || !p->region_attribute || !p->region_max_volume) {
    tet_free(ctx, row);
    return tet_ctx_error(ctx)->status;
  }
  for (uint32_t i = 0; i < pls->n_regions; i++) {
    int32_t marker = pls->region_markers ? pls->region_markers[i] : (int32_t)i + 1;
    if (marker > most) most = marker;
  }
  for (int seeded = 1; seeded >= 0; seeded--)
    for (uint32_t k = 0; k + 1 < n_parts; k++) {
      if (drop[k] || (seed_of[k] != TET_NONE) != seeded) continue;
      uint32_t s = seed_of[k];
      p->region_marker[n] = !seeded ? ++most : pls->region_markers ? pls->region_markers[s] : (int32_t)s + 1;
      p->region_attribute[n] = seeded && pls->region_attributes ? pls->region_attributes[s] : p->region_marker[n];
      double volume = seeded && pls->region_max_volumes ? pls->region_max_volumes[s] : 0;
      p->region_max_volume[n] = volume > 0 ? volume : 0;
      row[k] = n++;
    }
  for (uint32_t t = 0; t < p->n_tets; t++) p->region[t] = row[p->region[t]];
  p->n_regions = n;
  tet_free(ctx, row);
  return TET_OK;
}

tet_status tet_apply_seeds(tet_ctx *ctx, const tet_pls *pls, int keep_hull, uint32_t n_parts,
                           tet_pieces *p, uint32_t *tri) {
  uint8_t *drop = tet_calloc(ctx, n_parts, 1);
  uint32_t *seed_of = tet_alloc(ctx, n_parts, sizeof *seed_of), k;
  tet_status status = drop && seed_of ? TET_OK : tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; i < n_parts && status == TET_OK; i++) seed_of[i] = TET_NONE;
  for (uint32_t i = 0; i < pls->n_holes && status == TET_OK; i++) {
    status = locate_seed(ctx, p, pls->holes + 3 * (size_t)i, TET_OFFENDER_HOLE, i, &k);
    if (status == TET_OK && !keep_hull) drop[k] = 1;
  }
  for (uint32_t i = 0; i < pls->n_regions && status == TET_OK; i++) {
    status = locate_seed(ctx, p, pls->region_seeds + 3 * (size_t)i, TET_OFFENDER_REGION, i, &k);
    if (status == TET_OK && seed_of[k] == TET_NONE) seed_of[k] = i;
  }
  if (status == TET_OK) status = drop_regions(ctx, p, tri, drop);
  if (status == TET_OK && !p->n_tets)
    status = tet_fail(ctx, TET_E_OPEN, "every part that the facets enclose is a hole");
  if (status == TET_OK) status = make_table(ctx, pls, p, n_parts, seed_of, drop);
  tet_free(ctx, drop);
  tet_free(ctx, seed_of);
  return status;
}
