// SPDX-License-Identifier: Apache-2.0
/* hull.c: facets for point clouds (3.3.5): the boundary of their Delaunay tetrahedralization, so
 * that refinement has a domain, whose facets it splits as any other's. */
#include "engine/hull.h"

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

tet_status tet_hull_build(tet_ctx *ctx, const tet_pls *pls, uint32_t threads, tet_hull *ret) {
  const tet_build_options how = {.stage = TET_STAGE_DELAUNAY, .threads = threads};
  tet_hull hull = {.used = NULL};
  tet_pls cloud = {.n_loose_points = TET_LOOSE_ALL_UNUSED};
  double *x = NULL;
  tet_status status = list_used(ctx, pls, &hull.used, &cloud.n_points);
  if (!status) {
    x = tet_alloc(ctx, 3 * (size_t)cloud.n_points, sizeof *x);
    status = x ? TET_OK : tet_ctx_error(ctx)->status;
  }
  for (size_t i = 0; !status && i < cloud.n_points; i++)
    memcpy(x + 3 * i, pls->points + 3 * (size_t)hull.used[i], 3 * sizeof *x);
  cloud.points = x;
  if (!status) status = tet_build(ctx, &cloud, &how, &hull.built);
  tet_free(ctx, x);
  if (status) tet_free(ctx, hull.used);
  else *ret = hull;
  return status;
}

/* How many points are in facets, or on edges, that are no corners of the hull's faces. */
static tet_status count_below(tet_ctx *ctx, const tet_pieces *pieces, double share, uint32_t *ret) {
  tet_skin skin;
  tet_status status = tet_skin_build(ctx, pieces, share, &skin);
  if (status) return status;
  *ret = skin.n_below;
  tet_skin_free(ctx, &skin);
  return TET_OK;
}

/* The share of the width within which some points are below the hull's faces, and within ten or more times that not a
 * tenth more; of several the least, but for such as have twice the points; that of doubles if there is none. */
static tet_status choose_share(tet_ctx *ctx, const tet_pieces *pieces, double *ret) {
  static const double share[] = {1e-12, 1e-9, 1e-6, 3e-5, 3e-4};
  enum { LAST = sizeof share / sizeof *share - 1 };
  uint32_t n = 0, most = 0, all, more;
  *ret = share[0];
  tet_status status = count_below(ctx, pieces, share[LAST], &all);
  if (status || !all) return status; /* mostly nothing is near */
  for (int k = 0; k <= LAST && !status; k++) {
    more = all;
    if (k < LAST) status = count_below(ctx, pieces, share[k], &more);
    if (!status && n && n / 2 >= most && more <= n + n / 10) {
      *ret = share[k - 1];
      most = n;
    }
    n = more;
  }
  return status;
}

tet_status tet_hull_close(tet_ctx *ctx, const tet_pls *pls, const tet_hull *hull, int exact, tet_pls *ret_pls,
                          tet_skin *ret_skin) {
  tet_skin skin;
  double share = 0;
  tet_status status = exact ? TET_OK : choose_share(ctx, &hull->built.pieces, &share);
  if (!status) status = tet_skin_build(ctx, &hull->built.pieces, share, &skin);
  if (status) return status;
  for (uint32_t k = 0; k < skin.polygon_start[skin.n_polygons]; k++)
    skin.polygon_vertices[k] = hull->used[skin.polygon_vertices[k]];
  *ret_pls = *pls;
  ret_pls->n_facets = skin.n_facets;
  ret_pls->facet_start = skin.facet_start;
  ret_pls->n_polygons = skin.n_polygons;
  ret_pls->polygon_start = skin.polygon_start;
  ret_pls->polygon_vertices = skin.polygon_vertices;
  *ret_skin = skin;
  return TET_OK;
}

void tet_hull_free(tet_ctx *ctx, tet_hull *hull) {
  tet_build_result_free(ctx, &hull->built);
  tet_free(ctx, hull->used);
  hull->used = NULL;
}
