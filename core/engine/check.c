// SPDX-License-Identifier: Apache-2.0
/* check.c: options and PLS arrays, before any stage runs. */
#include "engine/check.h"

#include "exact/predicates.h"

#include <math.h>

tet_status tet_check_options(tet_ctx *ctx, const tet_options *o) {
  if (o->stage != TET_STAGE_DELAUNAY && o->stage != TET_STAGE_CDT && o->stage != TET_STAGE_REFINE)
    return tet_fail(ctx, TET_E_ARGUMENT, "there is no stage %d", (int)o->stage);
  if (o->point_order != TET_ORDER_INPUT_FIRST && o->point_order != TET_ORDER_HILBERT)
    return tet_fail(ctx, TET_E_ARGUMENT, "there is no point order %d", (int)o->point_order);
  if (!(o->radius_edge >= 1) || !isfinite(o->radius_edge))
    return tet_fail(ctx, TET_E_ARGUMENT, "a radius-edge bound of %g: it must be at least 1", o->radius_edge);
  if (!(o->max_volume >= 0) || !isfinite(o->max_volume))
    return tet_fail(ctx, TET_E_ARGUMENT, "a largest volume of %g: it must be positive, or 0 for none", o->max_volume);
  if (!(o->min_dihedral >= 0 && o->min_dihedral <= TET_MOST_DIHEDRAL))
    return tet_fail(ctx, TET_E_ARGUMENT, "a smallest dihedral angle of %g degrees: it must be from 0, for none, to %d",
                    o->min_dihedral, TET_MOST_DIHEDRAL);
  if ((int)o->order < TET_INSERT_O2_O1 || o->order > TET_INSERT_RELATIVELY_SHORT)
    return tet_fail(ctx, TET_E_ARGUMENT, "there is no insertion order %d", (int)o->order);
  if (!(o->planarity_tolerance >= 0) || !isfinite(o->planarity_tolerance))
    return tet_fail(ctx, TET_E_ARGUMENT, "a planarity tolerance of %g: it must be positive, or 0 for the default",
                    o->planarity_tolerance);
  if (!(o->merge_angle >= 0 && o->merge_angle <= TET_MOST_MERGE_ANGLE))
    return tet_fail(ctx, TET_E_ARGUMENT, "a merge angle of %g degrees: it must be from 0, for none, to %d",
                    o->merge_angle, TET_MOST_MERGE_ANGLE);
  if (o->break_points && o->stage == TET_STAGE_DELAUNAY)
    return tet_fail(ctx, TET_E_ARGUMENT, "break points are for facets: not of the stage delaunay");
  if (o->threads < 1 || o->threads > TET_MAX_THREADS)
    return tet_fail(ctx, TET_E_ARGUMENT, "%u threads: there can be 1 to %d", o->threads, TET_MAX_THREADS);
  if (o->voronoi != TET_VORONOI_NONE && o->voronoi != TET_VORONOI_FACTORS && o->voronoi != TET_VORONOI_DIAGRAM)
    return tet_fail(ctx, TET_E_ARGUMENT, "there are no Voronoi cells %d", (int)o->voronoi);
  if (o->voronoi && (o->stage == TET_STAGE_DELAUNAY || o->keep_hull))
    return tet_fail(ctx, TET_E_ARGUMENT, "Voronoi cells are cut to facets: not of the stage delaunay or a kept hull");
  if (o->keep_hull && o->stage == TET_STAGE_REFINE)
    return tet_fail(ctx, TET_E_ARGUMENT, "the hull can be kept up to stage cdt: its faces are no facets to refine");
  return TET_OK;
}

static tet_status need(tet_ctx *ctx, uint64_t count, const void *array, const char *name) {
  if (!count || array) return TET_OK;
  return tet_fail(ctx, TET_E_ARGUMENT, "%s: %llu of them, but no array", name, (unsigned long long)count);
}

/* Every value finite and at most 2^500; offenders of `kind` are named. */
static tet_status finite_rows(tet_ctx *ctx, const double *x, uint32_t n, tet_offender_kind kind, const char *name) {
  tet_status status = TET_OK;
  for (uint32_t i = 0; i < n; i++) {
    const double *p = x + 3 * (size_t)i;
    int good = 1;
    for (int k = 0; k < 3; k++) good &= fabs(p[k]) <= TET_COORDINATE_LIMIT; /* false for NaN */
    if (good) continue;
    if (status == TET_OK)
      status = tet_fail(ctx, TET_E_NOT_FINITE, "%s %u is at (%g, %g, %g): not finite, or beyond 2^500", name, i, p[0],
                        p[1], p[2]);
    tet_offence offence = {.kind = {kind, kind}, .index = {i, TET_NONE}, .place = {p[0], p[1], p[2]}};
    tet_offend(ctx, &offence);
  }
  return status;
}

static tet_status ascending(tet_ctx *ctx, const uint32_t *start, uint32_t n, uint32_t total, const char *name) {
  uint32_t last = 0;
  for (uint64_t i = 0; i <= n; i++) {
    if ((i == 0 && start[0] != 0) || start[i] < last || start[i] > total || (i == n && start[i] != total))
      return tet_fail(ctx, TET_E_INDEX, "%s[%llu] is %u: the starts must ascend from 0 to %u", name,
                      (unsigned long long)i, start[i], total);
    last = start[i];
  }
  return TET_OK;
}

static tet_status in_range(tet_ctx *ctx, const uint32_t *index, uint64_t n, uint32_t limit, const char *name) {
  for (uint64_t i = 0; i < n; i++)
    if (index[i] >= limit)
      return tet_fail(ctx, TET_E_INDEX, "%s[%llu] is %u, but there are %u vertices", name, (unsigned long long)i,
                      index[i], limit);
  return TET_OK;
}

static tet_status check_points(tet_ctx *ctx, const tet_pls *p) {
  if (p->n_points > tet_vertex_limit(ctx))
    return tet_fail(ctx, TET_E_VERTEX_LIMIT, "the PLS has %u vertices, the limit is %llu", p->n_points,
                    (unsigned long long)tet_vertex_limit(ctx));
  if (p->n_points < 4)
    return tet_fail(ctx, TET_E_DEGENERATE, "%u vertices enclose nothing: a tetrahedron has four", p->n_points);
  tet_status status = need(ctx, p->n_points, p->points, "vertices");
  if (status == TET_OK)
    status = need(ctx, (uint64_t)p->n_points * p->n_attributes, p->point_attributes, "vertex attributes");
  if (status == TET_OK) status = finite_rows(ctx, p->points, p->n_points, TET_OFFENDER_VERTEX, "vertex");
  return status;
}

static tet_status check_facets(tet_ctx *ctx, const tet_pls *p) {
  if (!p->facet_start && p->n_facets != p->n_polygons)
    return tet_fail(ctx, TET_E_ARGUMENT, "%u facets of one polygon each, but %u polygons", p->n_facets, p->n_polygons);
  tet_status status = need(ctx, p->n_polygons, p->polygon_start, "polygons");
  if (status == TET_OK && p->facet_start)
    status = ascending(ctx, p->facet_start, p->n_facets, p->n_polygons, "facet_start");
  if (status != TET_OK) return status;
  uint32_t n_corners = p->n_polygons ? p->polygon_start[p->n_polygons] : 0;
  status = need(ctx, n_corners, p->polygon_vertices, "polygon vertices");
  if (status == TET_OK && p->n_polygons)
    status = ascending(ctx, p->polygon_start, p->n_polygons, n_corners, "polygon_start");
  if (status == TET_OK) status = in_range(ctx, p->polygon_vertices, n_corners, p->n_points, "polygon_vertices");
  if (status == TET_OK) status = need(ctx, p->n_facet_holes, p->facet_holes, "facet holes");
  if (status == TET_OK) status = need(ctx, p->n_facet_holes, p->facet_hole_start, "facet hole starts");
  if (status == TET_OK && p->facet_hole_start)
    status = ascending(ctx, p->facet_hole_start, p->n_facets, p->n_facet_holes, "facet_hole_start");
  if (status == TET_OK && p->n_facet_holes)
    status = finite_rows(ctx, p->facet_holes, p->n_facet_holes, TET_OFFENDER_HOLE, "facet hole");
  return status;
}

static tet_status check_loose(tet_ctx *ctx, const tet_pls *p) {
  tet_status status = need(ctx, p->n_segments, p->segments, "segments");
  if (status == TET_OK) status = in_range(ctx, p->segments, 2 * (uint64_t)p->n_segments, p->n_points, "segments");
  if (status != TET_OK || p->n_loose_points == TET_LOOSE_ALL_UNUSED) return status;
  status = need(ctx, p->n_loose_points, p->loose_points, "loose points");
  return status == TET_OK ? in_range(ctx, p->loose_points, p->n_loose_points, p->n_points, "loose_points") : status;
}

static tet_status check_seeds(tet_ctx *ctx, const tet_pls *p) {
  tet_status status = need(ctx, p->n_holes, p->holes, "holes");
  if (status == TET_OK) status = finite_rows(ctx, p->holes, p->n_holes, TET_OFFENDER_HOLE, "hole");
  if (status == TET_OK) status = need(ctx, p->n_regions, p->region_seeds, "regions");
  if (status == TET_OK) status = finite_rows(ctx, p->region_seeds, p->n_regions, TET_OFFENDER_REGION, "region seed");
  for (uint32_t i = 0; status == TET_OK && p->region_max_volumes && i < p->n_regions; i++)
    if (isnan(p->region_max_volumes[i]))
      status = tet_fail(ctx, TET_E_ARGUMENT, "the largest volume of region %u is not a number", i);
  return status;
}

tet_status tet_check_arrays(tet_ctx *ctx, const tet_pls *pls) {
  tet_status status = check_points(ctx, pls);
  if (status == TET_OK) status = check_facets(ctx, pls);
  if (status == TET_OK) status = check_loose(ctx, pls);
  return status == TET_OK ? check_seeds(ctx, pls) : status;
}
