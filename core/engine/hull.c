// SPDX-License-Identifier: Apache-2.0
/* hull.c: facets for point clouds (3.3.5): the boundary of their Delaunay tetrahedralization, so
 * that refinement has a domain, whose facets it splits as any other's. */
#include "engine/hull.h"

#include "build/build.h"

#include <string.h>

/* The vertices in use, ascending: all, or those listed and the segments' ends. */
static tet_status list_used(tet_ctx *ctx, const tet_pls *pls, uint32_t **ret_used, uint32_t *ret_n) {
  int all = pls->n_loose_points == TET_LOOSE_ALL_UNUSED;
  uint32_t n = 0, *used = tet_alloc(ctx, pls->n_points, sizeof *used);
  uint8_t *mark = tet_calloc(ctx, pls->n_points, 1);
  tet_status status = used && mark ? TET_OK : tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; !status && !all && i < pls->n_loose_points; i++) mark[pls->loose_points[i]] = 1;
  for (size_t i = 0; !status && i < 2 * (size_t)pls->n_segments; i++) mark[pls->segments[i]] = 1;
  for (uint32_t v = 0; !status && v < pls->n_points; v++)
    if (all || mark[v]) used[n++] = v;
  tet_free(ctx, mark);
  if (status) {
    tet_free(ctx, used);
    return status;
  }
  *ret_used = used;
  *ret_n = n;
  return TET_OK;
}

tet_status tet_close_by_hull(tet_ctx *ctx, const tet_pls *pls, uint32_t threads, int exact, tet_pls *ret_pls,
                             tet_skin *ret_skin) {
  const tet_build_options how = {.stage = TET_STAGE_DELAUNAY, .threads = threads};
  tet_build_result built = {.same_as = NULL};
  tet_pls cloud = {.n_loose_points = TET_LOOSE_ALL_UNUSED};
  tet_skin skin;
  double *x = NULL;
  uint32_t *used = NULL;
  tet_status status = list_used(ctx, pls, &used, &cloud.n_points);
  if (!status) {
    x = tet_alloc(ctx, 3 * (size_t)cloud.n_points, sizeof *x);
    status = x ? TET_OK : tet_ctx_error(ctx)->status;
  }
  for (size_t i = 0; !status && i < cloud.n_points; i++)
    memcpy(x + 3 * i, pls->points + 3 * (size_t)used[i], 3 * sizeof *x);
  cloud.points = x;
  if (!status) status = tet_build(ctx, &cloud, &how, &built);
  if (!status) status = tet_skin_build(ctx, &built.pieces, exact, &skin);
  if (!status) {
    for (uint32_t k = 0; k < skin.polygon_start[skin.n_polygons]; k++)
      skin.polygon_vertices[k] = used[skin.polygon_vertices[k]];
    *ret_pls = *pls;
    ret_pls->n_facets = skin.n_facets;
    ret_pls->facet_start = skin.facet_start;
    ret_pls->n_polygons = skin.n_polygons;
    ret_pls->polygon_start = skin.polygon_start;
    ret_pls->polygon_vertices = skin.polygon_vertices;
    *ret_skin = skin;
  }
  tet_build_result_free(ctx, &built);
  tet_free(ctx, x);
  tet_free(ctx, used);
  return status;
}
