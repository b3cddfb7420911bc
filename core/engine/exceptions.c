// SPDX-License-Identifier: Apache-2.0
/* exceptions.c: one pass over all tetrahedra, merged with the list there is. */
#include "engine/exceptions.h"

#include "audit/quality.h"

static int over_bounds(const tet_mesh *m, uint32_t t, tet_shape *ret_shape) {
  const tet_promise *p = &m->report.promised;
  const double slack = 1 + 1e-9;
  *ret_shape = tet_shape_of(m->points, m->tetrahedra + 4 * (size_t)t);
  double own = p->region_volumes ? m->region_max_volumes[m->tetrahedron_regions[t]] : 0;
  return (p->radius_edge > 0 && ret_shape->radius_edge > p->radius_edge * slack) ||
         (p->max_volume > 0 && ret_shape->volume > p->max_volume * slack) ||
         (own > 0 && ret_shape->volume > own * slack);
}

/* Merges into tets, ratios, segments, where these are not NULL; *ret_n: how many. */
static tet_status merge(tet_ctx *ctx, const tet_mesh *m, uint32_t *tets, double *ratios, uint32_t *segments,
                        uint32_t *ret_n) {
  uint32_t n = 0, listed = 0;
  tet_shape shape;
  for (uint32_t t = 0; t < m->n_tetrahedra; t++) {
    tet_status status = (t & 4095) == 0 ? tet_poll(ctx) : TET_OK;
    if (status != TET_OK) return status;
    int known = listed < m->n_exceptions && m->exception_tetrahedra[listed] == t;
    if (!known && !over_bounds(m, t, &shape)) continue;
    if (tets) {
      tets[n] = t;
      ratios[n] = known ? m->exception_radius_edge[listed] : shape.radius_edge;
      segments[n] = known ? m->exception_segments[listed] : TET_NONE;
    }
    listed += known;
    n++;
  }
  *ret_n = n;
  return TET_OK;
}

tet_status tet_complete_exceptions(tet_ctx *ctx, tet_mesh *mesh) {
  uint32_t n = 0;
  tet_status status = merge(ctx, mesh, NULL, NULL, NULL, &n);
  if (status != TET_OK || n == mesh->n_exceptions) return status;
  uint32_t *tets = tet_alloc(ctx, n, sizeof *tets), *segments = tet_alloc(ctx, n, sizeof *segments);
  double *ratios = tet_alloc(ctx, n, sizeof *ratios);
  status = tets && segments && ratios ? merge(ctx, mesh, tets, ratios, segments, &n) : tet_ctx_error(ctx)->status;
  if (status != TET_OK) {
    tet_free(ctx, tets);
    tet_free(ctx, segments);
    tet_free(ctx, ratios);
    return status;
  }
  tet_free(ctx, mesh->exception_tetrahedra);
  tet_free(ctx, mesh->exception_segments);
  tet_free(ctx, mesh->exception_radius_edge);
  mesh->exception_tetrahedra = tets;
  mesh->exception_segments = segments;
  mesh->exception_radius_edge = ratios;
  mesh->n_exceptions = n;
  return TET_OK;
}
