// SPDX-License-Identifier: Apache-2.0
/* build.c: the CDT algorithm of thesis 5.2, step after step. */
#include "build/build.h"

#include <math.h>
#include <string.h>

#include "mesh/delaunay.h"
#include "build/repair.h"
#include "build/soup.h"
#include "build/state.h"

/* Tetrahedra between nearly coplanar facets that are flatter than this part of the
 * box's diagonal are broken up: a build is begun again with break points so many times for
 * them, and in all for them and where rounding fails. Where there is nothing to break,
 * it is begun again with other Steiner points. Interior faces nearer to facets than that are parted
 * from them in the end. */
static const double THIN = 2e-9;
enum { MOST_ROUNDS = 8, MOST_THIN_ROUNDS = 3, MOST_ATTEMPTS = 8 };
/* Degeneracies are removed again so many times after segments were recovered. */
enum { MOST_REMOVALS = 8 };

void tet_build_result_free(tet_ctx *ctx, tet_build_result *r) {
  tet_pieces_free(ctx, &r->pieces);
  tet_free(ctx, r->same_as);
  tet_free(ctx, r->facet_same_as);
  r->same_as = r->facet_same_as = NULL;
}

static double box_diagonal(const tet_points *p) {
  double sum = 0;
  for (size_t j = 0; j < 3; j++) {
    double lo = p->x[j], hi = lo;
    for (size_t v = 1; v < p->n; v++) {
      if (p->x[3 * v + j] < lo) lo = p->x[3 * v + j];
      if (p->x[3 * v + j] > hi) hi = p->x[3 * v + j];
    }
    sum += (hi - lo) * (hi - lo);
  }
  return sqrt(sum);
}

/* D_0 of the vertices with keep[v]. */
static tet_status triangulate_vertices(tet_state *st, const uint8_t *keep, uint32_t threads) {
  uint32_t n = 0, *ids = tet_alloc(st->ctx, st->n_input, sizeof *ids);
  if (!ids) return tet_ctx_error(st->ctx)->status;
  tet_stage_begin(st->ctx, "delaunay");
  for (uint32_t v = 0; v < st->n_input; v++)
    if (keep[v]) ids[n++] = v;
  tet_status status = tet_delaunay(&st->complex, ids, n, threads);
  if (status == TET_OK) tet_stage_counts(st->ctx, st->points.n, st->complex.n_live);
  tet_free(st->ctx, ids);
  return status;
}

/* Delaunay tetrahedralization of all points, facets unseen. */
static tet_status build_delaunay(tet_state *st, uint32_t threads, tet_build_result *r) {
  uint32_t n = st->n_input, *tri = NULL, *part = NULL;
  uint8_t *keep = tet_calloc(st->ctx, n, 1);
  tet_soup soup = {.ctx = st->ctx, .pls = st->pls, .points = &st->points, .same_as = r->same_as};
  tet_status status = keep ? tet_find_duplicates(&soup) : tet_ctx_error(st->ctx)->status;
  for (uint32_t v = 0; v < n && status == TET_OK; v++) keep[v] = r->same_as[v] == v;
  if (status == TET_OK) status = triangulate_vertices(st, keep, threads);
  if (status == TET_OK) {
    part = tet_alloc(st->ctx, st->complex.n_slots, sizeof *part);
    status = part ? TET_OK : tet_ctx_error(st->ctx)->status;
  }
  for (uint32_t t = 0; t < st->complex.n_slots && status == TET_OK; t++) part[t] = 1;
  if (status == TET_OK) status = tet_extract_tetrahedra(st, NULL, part, &r->pieces, &tri);
  tet_pls bare = {.n_points = n};
  if (status == TET_OK) status = tet_apply_seeds(st->ctx, &bare, 1, 2, &r->pieces, tri);
  if (status == TET_OK) status = tet_extract_constraints(st, tri, &r->pieces);
  st->counts.duplicate_vertices = soup.n_duplicates;
  tet_free(st->ctx, keep);
  tet_free(st->ctx, part);
  tet_free(st->ctx, tri);
  return status;
}

static void count_surface(tet_state *st, tet_build_result *r) {
  tet_surface *s = &st->surface;
  r->n_input_facets = st->pls->n_facets;
  r->facet_same_as = s->facet_same_as;
  s->facet_same_as = NULL;
  memcpy(r->same_as, s->same_as, st->n_input * sizeof *r->same_as);
  r->planarity = s->planarity;
  r->merged_angle = s->merged_angle;
  r->merged_distance = s->merged_distance;
  st->counts.duplicate_vertices = s->n_duplicates;
  st->counts.repeated_facets = s->n_repeated_facets;
  st->counts.unused_vertices = s->n_unused;
  st->counts.segments = s->n_segments;
}

/* Regions: parts, rounding, seeds; into r->pieces. With *ret_thin there are thin
 * tetrahedra to break up first, and r->pieces is not complete. */
static tet_status find_domain(tet_state *st, const tet_build_options *o, uint32_t *face_tri, tet_breaks *breaks,
                              double diagonal, double thin, tet_build_result *r, size_t *ret_thin) {
  uint32_t *part = NULL, *tri = NULL, n_parts = 0;
  tet_stage_begin(st->ctx, "regions");
  tet_status status = tet_find_parts(st, face_tri, o->keep_hull, &part, &n_parts);
  if (status == TET_OK) status = tet_extract_tetrahedra(st, face_tri, part, &r->pieces, &tri);
  /* from here on the rounded coordinates are the truth */
  if (status == TET_OK)
    status = tet_repair(st->ctx, &st->surface, &st->points, &r->pieces, &tri, breaks, &st->counts);
  if (status == TET_OK)
    status = tet_find_thin(st->ctx, &st->surface, &st->points, &r->pieces, tri, thin, breaks, ret_thin);
  int done = status == TET_OK && !*ret_thin;
  if (done) status = tet_apply_seeds(st->ctx, st->pls, o->keep_hull, n_parts, &r->pieces, tri);
  if (done && status == TET_OK) status = tet_part_squeezed(st, &r->pieces, &tri, THIN * diagonal, diagonal);
  if (done && status == TET_OK) status = tet_extract_constraints(st, tri, &r->pieces);
  if (done && status == TET_OK) tet_stage_counts(st->ctx, r->pieces.n_points, r->pieces.n_tets);
  tet_free(st->ctx, part);
  tet_free(st->ctx, tri);
  return status;
}

static tet_status recover_segments(tet_state *st) {
  tet_stage_begin(st->ctx, "segments");
  tet_status status = tet_recover_segments(st);
  if (status == TET_OK) tet_stage_counts(st->ctx, st->points.n, st->complex.n_live);
  return status;
}

/* With degeneracies removed before and after: Steiner points on segments may make others. */
static tet_status recover_broken(tet_state *st) {
  for (int round = 0;; round++) {
    size_t added = 0;
    tet_stage_begin(st->ctx, "degeneracies");
    tet_status status = tet_remove_degeneracies(st, round < MOST_REMOVALS && st->may_break, &added);
    if (status == TET_OK) tet_stage_counts(st->ctx, st->points.n, st->complex.n_live);
    if (status == TET_OK && (!round || added)) status = recover_segments(st);
    if (status != TET_OK || (round && !added)) return status;
  }
}

/* The steps of 5.2 once; see find_domain for *ret_thin. */
static tet_status build_cdt(tet_state *st, const tet_build_options *o, tet_breaks *breaks, double thin,
                            tet_build_result *r, size_t *ret_thin) {
  double diagonal = box_diagonal(&st->points);
  double tolerance = o->planarity_tolerance > 0 ? o->planarity_tolerance : 1e-5 * diagonal;
  uint32_t *face_tri = NULL;
  st->breaks = breaks;
  tet_stage_begin(st->ctx, "surface");
  tet_status status = tet_surface_build(st->ctx, st->pls, &st->points, tolerance, o->merge_angle, &st->surface);
  if (status != TET_OK) return status;
  st->planes = (tet_planes){st->surface.plane_start, st->surface.plane};
  st->points.planes = &st->planes;
  if ((status = tet_check_seeds(st)) != TET_OK) return status;
  count_surface(st, r);
  tet_stage_counts(st->ctx, st->n_input, 0);
  st->complex.is_canonical = 1; /* what follows walks in the order of the slots */
  status = triangulate_vertices(st, st->surface.used, o->threads);
  if (status == TET_OK && breaks->n) {
    tet_stage_begin(st->ctx, "segments");
    status = tet_split_breaks(st);
  }
  if (status == TET_OK) status = o->break_points ? recover_broken(st) : recover_segments(st);
  if (status == TET_OK) {
    tet_stage_begin(st->ctx, "facets");
    status = tet_recover_facets(st, &face_tri);
    if (status == TET_OK) tet_stage_counts(st->ctx, st->points.n, st->complex.n_live);
  }
  if (status == TET_OK) status = find_domain(st, o, face_tri, breaks, diagonal, thin * diagonal, r, ret_thin);
  tet_free(st->ctx, face_tri);
  return status;
}

/* One build from the start; *ret_thin as in find_domain. From attempt MOST_ATTEMPTS on, without break points. */
static tet_status build_once(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options, tet_breaks *breaks,
                             uint32_t attempt, double thin, tet_build_result *ret, size_t *ret_thin) {
  tet_state st;
  tet_build_result r;
  memset(&r, 0, sizeof r);
  *ret_thin = 0;
  tet_status status = tet_state_init(&st, ctx, pls);
  st.attempt = attempt % MOST_ATTEMPTS;
  st.may_break = attempt < MOST_ATTEMPTS;
  if (status == TET_OK) {
    r.same_as = tet_alloc(ctx, pls->n_points, sizeof *r.same_as);
    status = r.same_as ? TET_OK : tet_ctx_error(ctx)->status;
  }
  if (status == TET_OK)
    status = options->stage == TET_STAGE_DELAUNAY ? build_delaunay(&st, options->threads, &r)
                                                  : build_cdt(&st, options, breaks, thin, &r, ret_thin);
  st.counts.input_vertices = pls->n_points;
  st.counts.facets = pls->n_facets;
  r.counts = st.counts;
  tet_state_free(&st);
  if (status == TET_OK && !*ret_thin) *ret = r;
  else tet_build_result_free(ctx, &r);
  return status;
}

/* The build with the fewest thin tetrahedra so far, to be done again where no other holds. */
typedef struct spare {
  tet_breaks breaks;
  uint32_t attempt;
  size_t thin; /* 0: there is none */
} spare;

static tet_status copy_breaks(tet_ctx *ctx, const tet_breaks *from, tet_breaks *to) {
  tet_status status = tet_grow(ctx, &to->at, &to->cap, from->n, sizeof *to->at);
  if (status == TET_OK && from->n) memcpy(to->at, from->at, from->n * sizeof *to->at);
  to->n = from->n;
  return status;
}

/* Builds with Steiner points where the attempt says, again as long as there are thin
 * tetrahedra or rounding fails, and there are places to break. *ret_done: 1 with *ret; else,
 * unless the status is that of another failure, there may be *kept. */
static tet_status build_rounds(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options, uint32_t attempt,
                               spare *kept, tet_build_result *ret, int *ret_done) {
  tet_breaks breaks = {NULL, 0, 0}, tried = {NULL, 0, 0};
  tet_status status = TET_OK;
  for (int round = 0, thin_rounds = 0; round < MOST_ROUNDS && !*ret_done; round++) {
    size_t thin = 0;
    if (round && breaks.n == tried.n) break;
    status = copy_breaks(ctx, &breaks, &tried);
    if (status != TET_OK) break;
    status = build_once(ctx, pls, options, &breaks, attempt, thin_rounds < MOST_THIN_ROUNDS ? THIN : 0, ret, &thin);
    *ret_done = status == TET_OK && !thin;
    if (status != TET_OK && status != TET_E_ROUNDING) break;
    thin_rounds += thin > 0;
    if (!thin || (kept->thin && kept->thin <= thin)) continue;
    status = copy_breaks(ctx, &tried, &kept->breaks);
    kept->attempt = attempt;
    kept->thin = thin;
  }
  tet_free(ctx, breaks.at);
  tet_free(ctx, tried.at);
  return status;
}

tet_status tet_build(tet_ctx *ctx, const tet_pls *pls, const tet_build_options *options,
                     tet_build_result *ret) {
  spare kept = {.thin = 0};
  tet_status status = TET_OK;
  uint32_t most = options->break_points ? 2 * MOST_ATTEMPTS : MOST_ATTEMPTS; /* break points are more to round */
  int done = 0;
  size_t thin;
  for (uint32_t attempt = 0; attempt < most && !done && !kept.thin; attempt++) {
    status = build_rounds(ctx, pls, options, attempt, &kept, ret, &done);
    if (status != TET_OK && status != TET_E_ROUNDING) break;
  }
  if (!done && kept.thin && (status == TET_OK || status == TET_E_ROUNDING)) /* better thin tetrahedra than none */
    status = build_once(ctx, pls, options, &kept.breaks, kept.attempt, 0, ret, &thin);
  tet_free(ctx, kept.breaks.at);
  return status;
}
