// SPDX-License-Identifier: Apache-2.0
/* dual.c: the shares of all tetrahedra summed for edges and regions; cell volumes from the
 * factors; boundary shares from the subfaces.
 *
 * A cell is made of one pyramid for each of its Voronoi faces, with the cell's vertex as its
 * tip: what lies in the mesh's boundary passes through the vertex and bounds no volume. So
 *
 *   |K| = sum over L of 1/3 |sigma_KL| |x_K - x_L| / 2 = 1/6 sum of factor |x_K - x_L|^2. */
#include "dual/dual.h"

#include "base/sort.h"
#include "base/vector.h"
#include "dual/edges.h"
#include "dual/shares.h"
#include "exact/predicates.h"

#include <math.h>
#include <string.h>

enum { POLL_EVERY = 1024 };

typedef struct work {
  tet_ctx *ctx;
  const tet_mesh *mesh;
  tet_region_edges edges;
  double *factor; /* [edges.n] */
  double *bound;  /* [edges.n] above the factor's rounding error */
  tet_keyed *more; /* (vertex, region) of vertices with several regions */
  size_t n_more, cap_more;
  uint32_t *region;     /* [n_points] the one region of a vertex, or TET_NONE */
  uint32_t *first_cell; /* [n_points + 1] */
  uint32_t n_cells;
  uint32_t *cell_vertex, *cell_region; /* [n_cells] */
  double *volume;                      /* [n_cells] */
  double *share;                       /* [n_subfaces][3] */
} work;

static void work_free(work *w) {
  void *all[] = {w->factor, w->bound, w->more, w->region, w->first_cell, w->cell_vertex, w->cell_region, w->volume,
                 w->share};
  tet_region_edges_free(w->ctx, &w->edges);
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(w->ctx, all[i]);
}

/* Now and then: cancel, deadline, progress. */
static tet_status look_up(const work *w, uint64_t done, uint64_t all) {
  if (done % POLL_EVERY) return TET_OK;
  tet_progress_report(w->ctx, (double)done / (double)all, w->mesh->n_points, w->mesh->n_tetrahedra, done);
  return tet_poll(w->ctx);
}

/* Volumes are lengths to the third. */
static tet_status check_extent(const work *w) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, extent = 0;
  for (size_t v = 0; v < w->mesh->n_points; v++)
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], w->mesh->points[3 * v + (size_t)k]);
      high[k] = fmax(high[k], w->mesh->points[3 * v + (size_t)k]);
    }
  for (int k = 0; k < 3; k++) extent = fmax(extent, high[k] - low[k]);
  if (w->mesh->n_points == 0 || (extent <= 0x1p300 && extent >= 0x1p-300)) return TET_OK;
  return tet_fail(w->ctx, TET_E_NOT_FINITE, "Voronoi volumes of an extent of %g are out of range", extent);
}

/* Of a tetrahedron whose shares cannot be had: its lengths are too unlike, or it should not be there. */
static tet_status refuse(const work *w, size_t t) {
  const double *x = w->mesh->points;
  const uint32_t *v = w->mesh->tetrahedra + 4 * t;
  if (tet_orient3d_xyz(x + 3 * (size_t)v[0], x + 3 * (size_t)v[1], x + 3 * (size_t)v[2], x + 3 * (size_t)v[3]) <= 0)
    return tet_internal(w->ctx, "a tetrahedron is not positive");
  return tet_fail(w->ctx, TET_E_NOT_FINITE, "Voronoi volumes of tetrahedron %zu, by vertex %u, are out of range", t, v[0]);
}

static tet_status sum_factors(work *w) {
  const tet_mesh *m = w->mesh;
  w->factor = tet_calloc(w->ctx, w->edges.n, sizeof *w->factor);
  w->bound = tet_calloc(w->ctx, w->edges.n, sizeof *w->bound);
  if (!w->factor || !w->bound) return tet_ctx_error(w->ctx)->status;
  for (size_t t = 0; t < m->n_tetrahedra; t++) {
    const uint32_t *v = m->tetrahedra + 4 * t;
    tet_shares s;
    tet_status status = look_up(w, t, m->n_tetrahedra);
    if (status != TET_OK) return status;
    if (!tet_shares_of(m->points, v, &s)) return refuse(w, t);
    for (int e = 0; e < 6; e++) {
      uint32_t row = tet_region_edge(&w->edges, v[tet_edge[e][0]], v[tet_edge[e][1]], m->tetrahedron_regions[t]);
      w->factor[row] += s.edge[e];
      w->bound[row] += s.bound;
    }
  }
  return TET_OK;
}

static tet_status note_region(work *w, uint32_t v, uint32_t region) {
  if (w->region[v] == TET_NONE) w->region[v] = region;
  if (w->region[v] == region) return TET_OK;
  tet_status status = tet_grow(w->ctx, &w->more, &w->cap_more, w->n_more + 1, sizeof *w->more);
  if (status == TET_OK) w->more[w->n_more++] = (tet_keyed){v, region};
  return status;
}

/* Which regions each vertex has. */
static tet_status collect_regions(work *w) {
  w->region = tet_alloc(w->ctx, w->mesh->n_points, sizeof *w->region);
  if (!w->region) return tet_ctx_error(w->ctx)->status;
  for (uint32_t v = 0; v < w->mesh->n_points; v++) w->region[v] = TET_NONE;
  tet_status status = TET_OK;
  for (size_t row = 0; row < w->edges.n && status == TET_OK; row++) {
    if (row % POLL_EVERY == 0) status = tet_poll(w->ctx);
    for (size_t k = 0; k < 2 && status == TET_OK; k++)
      status = note_region(w, w->edges.vertices[2 * row + k], w->edges.regions[row]);
  }
  if (status != TET_OK) return status;
  for (size_t i = 0, met = w->n_more; i < met; i++) { /* the first region of each of them too */
    uint32_t v = (uint32_t)w->more[i].key, region = w->region[v];
    if (region == TET_NONE) continue;
    w->region[v] = TET_NONE;
    status = tet_grow(w->ctx, &w->more, &w->cap_more, w->n_more + 1, sizeof *w->more);
    if (status != TET_OK) return status;
    w->more[w->n_more++] = (tet_keyed){v, region};
  }
  tet_sort_keyed(w->more, w->n_more);
  size_t n = 0;
  for (size_t i = 0; i < w->n_more; i++)
    if (i == 0 || w->more[i].key != w->more[i - 1].key || w->more[i].value != w->more[i - 1].value)
      w->more[n++] = w->more[i];
  w->n_more = n;
  return tet_poll(w->ctx);
}

/* The rows (vertex, region), ascending. */
static tet_status make_cells(work *w) {
  uint32_t n_points = w->mesh->n_points;
  uint64_t n = w->n_more;
  for (uint32_t v = 0; v < n_points; v++) n += w->region[v] != TET_NONE;
  if (n >= TET_NONE) return tet_fail(w->ctx, TET_E_TOO_LARGE, "more than 2^32 - 2 Voronoi cells");
  w->first_cell = tet_alloc(w->ctx, (size_t)n_points + 1, sizeof *w->first_cell);
  w->cell_vertex = tet_alloc(w->ctx, n, sizeof *w->cell_vertex);
  w->cell_region = tet_alloc(w->ctx, n, sizeof *w->cell_region);
  w->volume = tet_calloc(w->ctx, n, sizeof *w->volume);
  if (!w->first_cell || !w->cell_vertex || !w->cell_region || !w->volume) return tet_ctx_error(w->ctx)->status;
  size_t i = 0;
  for (uint32_t v = 0; v < n_points; v++) {
    w->first_cell[v] = w->n_cells;
    if (w->region[v] != TET_NONE) {
      w->cell_vertex[w->n_cells] = v;
      w->cell_region[w->n_cells++] = w->region[v];
    }
    for (; i < w->n_more && w->more[i].key == v; i++) {
      w->cell_vertex[w->n_cells] = v;
      w->cell_region[w->n_cells++] = (uint32_t)w->more[i].value;
    }
  }
  w->first_cell[n_points] = w->n_cells;
  return tet_poll(w->ctx);
}

static uint32_t cell_of(const work *w, uint32_t v, uint32_t region) {
  uint32_t c = w->first_cell[v];
  while (w->cell_region[c] != region) c++;
  return c;
}

static tet_status sum_volumes(work *w) {
  for (size_t row = 0; row < w->edges.n; row++) {
    const uint32_t *v = w->edges.vertices + 2 * row;
    double d[3];
    tet_status status = row % POLL_EVERY ? TET_OK : tet_poll(w->ctx);
    if (status != TET_OK) return status;
    tet_minus(w->mesh->points + 3 * (size_t)v[1], w->mesh->points + 3 * (size_t)v[0], d);
    double part = tet_dot(d, d) * w->factor[row] / 6;
    if (!isfinite(part)) return tet_fail(w->ctx, TET_E_NOT_FINITE, "a Voronoi face at vertex %u is out of range", v[0]);
    for (int k = 0; k < 2; k++) w->volume[cell_of(w, v[k], w->edges.regions[row])] += part;
  }
  return TET_OK;
}

static tet_status share_subfaces(work *w) {
  const tet_mesh *m = w->mesh;
  w->share = tet_alloc(w->ctx, m->n_subfaces, 3 * sizeof *w->share);
  if (!w->share) return tet_ctx_error(w->ctx)->status;
  for (size_t s = 0; s < m->n_subfaces; s++) {
    const double *x[3];
    for (size_t k = 0; k < 3; k++) x[k] = m->points + 3 * (size_t)m->subfaces[3 * s + k];
    tet_corner_shares(x[0], x[1], x[2], w->share + 3 * s, NULL);
    tet_status status = s % POLL_EVERY ? TET_OK : tet_poll(w->ctx);
    if (status != TET_OK) return status;
  }
  return TET_OK;
}

/* What is below 0 by more than rounding. */
static tet_voronoi_report judge(const work *w) {
  tet_voronoi_report r = {.made = 1};
  for (size_t row = 0; row < w->edges.n; row++) {
    double factor = w->factor[row];
    if (factor >= -w->bound[row]) continue;
    r.negative_factors++;
    if (factor >= r.worst_factor) continue;
    r.worst_factor = factor;
    r.worst_edge[0] = w->edges.vertices[2 * row];
    r.worst_edge[1] = w->edges.vertices[2 * row + 1];
    r.worst_region = w->edges.regions[row];
  }
  return r;
}

/* Moves the array that *from points at to *to. */
static void *take(void *from) {
  void *array;
  memcpy(&array, from, sizeof array);
  memset(from, 0, sizeof array);
  return array;
}

static void hand_over(work *w, tet_mesh *m) {
  m->report.voronoi = judge(w);
  m->n_cells = w->n_cells;
  m->cell_vertices = take(&w->cell_vertex);
  m->cell_regions = take(&w->cell_region);
  m->cell_volumes = take(&w->volume);
  m->n_edges = w->edges.n;
  m->edge_vertices = take(&w->edges.vertices);
  m->edge_regions = take(&w->edges.regions);
  m->edge_factors = take(&w->factor);
  m->subface_shares = take(&w->share);
}

tet_status tet_voronoi_factors(tet_ctx *ctx, tet_mesh *mesh) {
  work w = {.ctx = ctx, .mesh = mesh};
  tet_status status = check_extent(&w);
  if (status == TET_OK) status = tet_region_edges_of(ctx, mesh, &w.edges);
  if (status == TET_OK) status = sum_factors(&w);
  if (status == TET_OK) status = collect_regions(&w);
  if (status == TET_OK) status = make_cells(&w);
  if (status == TET_OK) status = sum_volumes(&w);
  if (status == TET_OK) status = share_subfaces(&w);
  if (status == TET_OK) hand_over(&w, mesh);
  work_free(&w);
  return status;
}
