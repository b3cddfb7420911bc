// SPDX-License-Identifier: Apache-2.0
/* input.c: see input.h. Shapes, dtypes and CSR arrays have been validated by the
 * schema; what vertex indices and coordinates mean is the engine's to check. */
#include "server/worker/input.h"

#include <stdlib.h>

/* The data of an array and its rows as the engine counts them. */
static const void *rows_of(const tp_arrays *set, const char *name, uint32_t *ret_rows, bool *fits) {
  uint64_t rows;
  const void *data = tp_arrays_data(set, name, &rows);
  if (rows >= UINT32_MAX) *fits = false;
  *ret_rows = (uint32_t)rows;
  return data;
}

static const void *data_of(const tp_arrays *set, const char *name) {
  return tp_arrays_data(set, name, NULL);
}

/* Each row of `triangles` is a polygon of three vertices and a facet of its own. */
static uint32_t *triangle_starts(uint32_t n) {
  uint32_t *starts = malloc(((size_t)n + 1) * sizeof *starts);
  for (uint32_t i = 0; starts && i <= n; i++) starts[i] = 3 * i;
  return starts;
}

tp_code input_view(const tp_arrays *set, tet_pls *ret_pls, uint32_t **ret_starts, tp_error *error) {
  tet_pls pls = {0};
  bool fits = true;
  uint32_t n_triangles, n_starts, *starts = NULL;
  pls.points = rows_of(set, "points", &pls.n_points, &fits);
  const tp_array *attributes = tp_arrays_find(set, "point_attributes");
  if (attributes) {
    if (attributes->shape[1] >= UINT32_MAX) fits = false;
    pls.n_attributes = (uint32_t)attributes->shape[1];
    pls.point_attributes = attributes->data;
  }
  pls.point_markers = data_of(set, "point_markers");
  const uint32_t *triangles = rows_of(set, "triangles", &n_triangles, &fits);
  pls.polygon_start = rows_of(set, "polygon_start", &n_starts, &fits);
  pls.polygon_vertices = data_of(set, "polygon_vertices");
  pls.n_polygons = n_starts ? n_starts - 1 : 0;
  pls.facet_start = rows_of(set, "facet_start", &n_starts, &fits);
  pls.n_facets = pls.facet_start ? n_starts - 1 : pls.n_polygons;
  if (triangles) {
    if (n_triangles >= UINT32_MAX / 3) fits = false;
    else if (!(starts = triangle_starts(n_triangles)))
      return tp_fail(error, TP_E_JOB_MEMORY, NULL, "no memory for the facets");
    pls.n_facets = pls.n_polygons = n_triangles;
    pls.polygon_start = starts;
    pls.polygon_vertices = triangles;
  }
  pls.facet_markers = data_of(set, "facet_markers");
  pls.facet_hole_start = data_of(set, "facet_hole_start");
  pls.facet_holes = rows_of(set, "facet_holes", &pls.n_facet_holes, &fits);
  pls.segments = rows_of(set, "segments", &pls.n_segments, &fits);
  pls.segment_markers = data_of(set, "segment_markers");
  pls.loose_points = rows_of(set, "loose_points", &pls.n_loose_points, &fits);
  if (!tp_arrays_find(set, "loose_points")) pls.n_loose_points = TET_LOOSE_ALL_UNUSED;
  pls.holes = rows_of(set, "holes", &pls.n_holes, &fits);
  pls.region_seeds = rows_of(set, "region_seeds", &pls.n_regions, &fits);
  pls.region_markers = data_of(set, "region_markers");
  pls.region_attributes = data_of(set, "region_attributes");
  pls.region_max_volumes = data_of(set, "region_max_volumes");
  if (!fits) {
    free(starts);
    return tp_fail(error, TP_E_JOB_TOO_LARGE, NULL,
                   "an array has more rows than the engine counts");
  }
  *ret_pls = pls;
  *ret_starts = starts;
  return TP_OK;
}

void input_options(const tp_options *from, tet_options *ret_options) {
  static const tet_stage stages[] = {[TP_STAGE_DELAUNAY] = TET_STAGE_DELAUNAY,
                                     [TP_STAGE_CDT] = TET_STAGE_CDT,
                                     [TP_STAGE_REFINE] = TET_STAGE_REFINE};
  static const tet_voronoi voronoi[] = {[TP_VORONOI_NONE] = TET_VORONOI_NONE,
                                        [TP_VORONOI_FACTORS] = TET_VORONOI_FACTORS,
                                        [TP_VORONOI_DIAGRAM] = TET_VORONOI_DIAGRAM};
  static const tet_insertion orders[] = {
      [TP_INSERT_O2_O1] = TET_INSERT_O2_O1, [TP_INSERT_O1] = TET_INSERT_O1, [TP_INSERT_O2] = TET_INSERT_O2, [TP_INSERT_O3] = TET_INSERT_O3,
      [TP_INSERT_O4] = TET_INSERT_O4, [TP_INSERT_O5] = TET_INSERT_O5,
      [TP_INSERT_RELATIVELY_SHORT] = TET_INSERT_RELATIVELY_SHORT};
  tet_options_default(ret_options);
  ret_options->stage = stages[from->stage];
  ret_options->radius_edge = from->radius_edge;
  ret_options->max_volume = from->max_volume;
  ret_options->min_dihedral = from->min_dihedral;
  ret_options->order = orders[from->order];
  ret_options->keep_hull = from->keep_hull;
  ret_options->planarity_tolerance = from->planarity_tolerance;
  ret_options->merge_angle = from->merge_angle;
  ret_options->break_points = from->break_points;
  ret_options->neighbours = from->neighbours;
  ret_options->voronoi = voronoi[from->voronoi];
  ret_options->seed = from->seed;
  ret_options->threads = (uint32_t)from->threads;
  ret_options->point_order =
      from->point_order == TP_ORDER_HILBERT ? TET_ORDER_HILBERT : TET_ORDER_INPUT_FIRST;
}
