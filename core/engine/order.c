// SPDX-License-Identifier: Apache-2.0
/* order.c: canonical order of the output (design section 5, Codec): neighbours in
 * the arrays are then neighbours in space, which is what compresses. */
#include "engine/order.h"

#include "base/hilbert.h"
#include "base/sort.h"

#include <string.h>

/* Replaces *array (rows of `bytes` bytes) by its rows order[0].value, order[1].value ... */
static tet_status permute(tet_ctx *ctx, void *array, uint32_t n, size_t bytes, const tet_keyed *order) {
  char *old, *moved;
  memcpy(&old, array, sizeof old);
  if (!old || !bytes) return TET_OK;
  moved = tet_alloc(ctx, n, bytes);
  if (!moved) return tet_ctx_error(ctx)->status;
  tet_status status = TET_OK;
  for (uint32_t i = 0; i < n && status == TET_OK; i++) {
    memcpy(moved + i * bytes, old + (uint32_t)order[i].value * bytes, bytes);
    if ((i & 65535) == 0) status = tet_poll(ctx);
  }
  if (status != TET_OK) {
    tet_free(ctx, moved);
    return status;
  }
  memcpy(array, &moved, sizeof moved);
  tet_free(ctx, old);
  return TET_OK;
}

/* row_of[order[i].value] = i. */
static tet_status invert(tet_ctx *ctx, const tet_keyed *order, uint32_t n, uint32_t **ret_row_of) {
  uint32_t *row_of = tet_alloc(ctx, n, sizeof *row_of);
  if (!row_of) return tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; i < n; i++) row_of[(uint32_t)order[i].value] = i;
  *ret_row_of = row_of;
  return TET_OK;
}

static void rename_all(uint32_t *index, uint64_t n, const uint32_t *row_of) {
  for (uint64_t i = 0; i < n; i++)
    if (index[i] != TET_NONE) index[i] = row_of[index[i]];
}

/* Sorts rows of `width` vertices: first by two, then, where those are equal, by
 * the others. */
static void sort_rows(tet_keyed *order, const uint32_t *v, uint32_t n, size_t width) {
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t *row = v + width * i;
    order[i] = (tet_keyed){(uint64_t)row[0] << 32 | row[1], i};
  }
  tet_sort_keyed(order, n);
  if (width == 2) return;
  for (uint32_t i = 0, run; i < n; i += run) {
    for (run = 1; i + run < n && order[i + run].key == order[i].key;) run++;
    if (run == 1) continue;
    for (uint32_t k = i; k < i + run; k++) {
      const uint32_t *row = v + width * order[k].value;
      order[k].key = (uint64_t)row[2] << 32 | row[width - 1];
    }
    tet_sort_keyed(order + i, run);
  }
}

static tet_status order_points(tet_ctx *ctx, tet_mesh *m) {
  uint32_t n = m->n_points, *row_of = NULL;
  tet_keyed *order = tet_alloc(ctx, n, sizeof *order);
  if (!order) return tet_ctx_error(ctx)->status;
  tet_hilbert_box box = tet_hilbert_bound(m->points, NULL, n);
  for (uint32_t i = 0; i < n; i++) order[i] = (tet_keyed){tet_hilbert_key(&box, m->points + 3 * (size_t)i), i};
  tet_sort_keyed(order, n);
  tet_status status = invert(ctx, order, n, &row_of);
  if (status == TET_OK) status = permute(ctx, &m->points, n, 3 * sizeof *m->points, order);
  if (status == TET_OK)
    status = permute(ctx, &m->point_attributes, n, m->n_attributes * sizeof *m->point_attributes, order);
  if (status == TET_OK) status = permute(ctx, &m->point_markers, n, sizeof *m->point_markers, order);
  if (status == TET_OK) status = permute(ctx, &m->point_origin, n, sizeof *m->point_origin, order);
  if (status == TET_OK) {
    rename_all(m->point_same_as, m->n_input_points, row_of);
    rename_all(m->tetrahedra, 4 * (uint64_t)m->n_tetrahedra, row_of);
    rename_all(m->subfaces, 3 * (uint64_t)m->n_subfaces, row_of);
    rename_all(m->subsegments, 2 * (uint64_t)m->n_subsegments, row_of);
  }
  tet_free(ctx, row_of);
  tet_free(ctx, order);
  return status;
}

static void swap(uint32_t *a, uint32_t *b) {
  uint32_t t = *a;
  *a = *b;
  *b = t;
}

/* Vertices of one tetrahedron ascending, but for the last two where that would
 * turn it inside out; `neighbours` (or NULL) along with them. */
static void sort_vertices(uint32_t v[4], uint32_t *neighbours) {
  int odd = 0;
  for (int i = 1; i < 4; i++)
    for (int j = i; j > 0 && v[j] < v[j - 1]; j--) {
      swap(&v[j], &v[j - 1]);
      if (neighbours) swap(&neighbours[j], &neighbours[j - 1]);
      odd ^= 1;
    }
  if (!odd) return;
  swap(&v[2], &v[3]);
  if (neighbours) swap(&neighbours[2], &neighbours[3]);
}

/* Puts a list of n tetrahedra, each at most once, with their values and segments in the order of
 * the new rows; `scratch` has room for all tetrahedra. */
static tet_status order_listed(tet_ctx *ctx, uint32_t n, const uint32_t *row_of, tet_keyed *scratch, uint32_t **tets,
                               double **values, uint32_t **segments) {
  rename_all(*tets, n, row_of);
  for (uint32_t i = 0; i < n; i++) scratch[i] = (tet_keyed){(*tets)[i], i};
  tet_sort_keyed(scratch, n);
  tet_status status = permute(ctx, tets, n, sizeof **tets, scratch);
  if (status == TET_OK) status = permute(ctx, values, n, sizeof **values, scratch);
  if (status == TET_OK) status = permute(ctx, segments, n, sizeof **segments, scratch);
  return status;
}

static tet_status order_tetrahedra(tet_ctx *ctx, tet_mesh *m) {
  uint32_t n = m->n_tetrahedra, *row_of = NULL;
  tet_keyed *order = tet_alloc(ctx, n, sizeof *order);
  if (!order) return tet_ctx_error(ctx)->status;
  for (size_t t = 0; t < n; t++) sort_vertices(m->tetrahedra + 4 * t, m->neighbours ? m->neighbours + 4 * t : NULL);
  sort_rows(order, m->tetrahedra, n, 4);
  tet_status status = invert(ctx, order, n, &row_of);
  if (status == TET_OK) status = permute(ctx, &m->tetrahedra, n, 4 * sizeof *m->tetrahedra, order);
  if (status == TET_OK) status = permute(ctx, &m->tetrahedron_regions, n, sizeof *m->tetrahedron_regions, order);
  if (status == TET_OK) status = permute(ctx, &m->neighbours, n, 4 * sizeof *m->neighbours, order);
  if (status == TET_OK) {
    if (m->neighbours) rename_all(m->neighbours, 4 * (uint64_t)n, row_of);
    status = order_listed(ctx, m->n_exceptions, row_of, order, &m->exception_tetrahedra, &m->exception_radius_edge,
                          &m->exception_segments);
  }
  if (status == TET_OK)
    status = order_listed(ctx, m->n_slivers, row_of, order, &m->sliver_tetrahedra, &m->sliver_cosines,
                          &m->sliver_segments);
  tet_free(ctx, row_of);
  tet_free(ctx, order);
  return status;
}

static tet_status order_subfaces(tet_ctx *ctx, tet_mesh *m) {
  uint32_t n = m->n_subfaces;
  tet_keyed *order = tet_alloc(ctx, n, sizeof *order);
  if (!order) return tet_ctx_error(ctx)->status;
  for (size_t s = 0; s < n; s++) {
    uint32_t *v = m->subfaces + 3 * s, w[3] = {v[0], v[1], v[2]};
    size_t least = w[0] < w[1] ? w[0] < w[2] ? 0 : 2 : w[1] < w[2] ? 1 : 2;
    for (size_t k = 0; k < 3; k++) v[k] = w[(least + k) % 3];
  }
  sort_rows(order, m->subfaces, n, 3);
  tet_status status = permute(ctx, &m->subfaces, n, 3 * sizeof *m->subfaces, order);
  if (status == TET_OK) status = permute(ctx, &m->subface_facets, n, sizeof *m->subface_facets, order);
  if (status == TET_OK) status = permute(ctx, &m->subface_markers, n, sizeof *m->subface_markers, order);
  tet_free(ctx, order);
  return status;
}

static tet_status order_subsegments(tet_ctx *ctx, tet_mesh *m) {
  uint32_t n = m->n_subsegments, *row_of = NULL;
  tet_keyed *order = tet_alloc(ctx, n, sizeof *order);
  if (!order) return tet_ctx_error(ctx)->status;
  for (size_t s = 0; s < n; s++)
    if (m->subsegments[2 * s] > m->subsegments[2 * s + 1]) swap(&m->subsegments[2 * s], &m->subsegments[2 * s + 1]);
  sort_rows(order, m->subsegments, n, 2);
  tet_status status = invert(ctx, order, n, &row_of);
  if (status == TET_OK) status = permute(ctx, &m->subsegments, n, 2 * sizeof *m->subsegments, order);
  if (status == TET_OK) status = permute(ctx, &m->subsegment_segments, n, sizeof *m->subsegment_segments, order);
  if (status == TET_OK) status = permute(ctx, &m->subsegment_markers, n, sizeof *m->subsegment_markers, order);
  if (status == TET_OK) rename_all(m->exception_segments, m->n_exceptions, row_of);
  if (status == TET_OK) rename_all(m->sliver_segments, m->n_slivers, row_of);
  tet_free(ctx, row_of);
  tet_free(ctx, order);
  return status;
}

tet_status tet_order_mesh(tet_ctx *ctx, tet_mesh *mesh, tet_point_order order) {
  tet_status status = order == TET_ORDER_HILBERT ? order_points(ctx, mesh) : TET_OK;
  if (status == TET_OK) status = tet_poll(ctx);
  if (status == TET_OK) status = order_subsegments(ctx, mesh);
  if (status == TET_OK) status = order_subfaces(ctx, mesh);
  if (status == TET_OK) status = tet_poll(ctx);
  return status == TET_OK ? order_tetrahedra(ctx, mesh) : status;
}
