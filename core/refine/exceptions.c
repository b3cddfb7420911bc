// SPDX-License-Identifier: Apache-2.0
/* exceptions.c: what is still over a bound at the end, with the nearest sharp
 * subsegment; and whether the promises about encroachment hold. */
#include "refine/refiner.h"

#include <math.h>
#include <string.h>

/* For every tetrahedron the sharp subsegment fewest faces away, all by one search
 * from all sharp subsegments at once. */
static tet_status nearest_sharp(refiner *r, uint32_t *label, uint32_t *queue) {
  uint32_t n = 0;
  memset(label, 0xff, (size_t)r->mesh.n_slots * sizeof *label);
  refine_list star = {0};
  for (uint32_t e = 0; e < r->n_segs; e++) {
    if (!r->segment_sharp[r->seg_of[e]]) continue;
    star.n = 0;
    tet_status status = refine_seg_star(r, e, &star);
    if (status) {
      tet_free(r->ctx, star.at);
      return status;
    }
    for (uint32_t k = 0; k < star.n; k++)
      if (label[star.at[k]] == TET_NONE) {
        label[star.at[k]] = e;
        queue[n++] = star.at[k];
      }
  }
  tet_free(r->ctx, star.at);
  for (uint32_t k = 0; k < n; k++)
    for (uint32_t h = 4 * queue[k]; h < 4 * queue[k] + 4; h++) {
      uint32_t u = r->mesh.adj[h];
      if (u == TET_NONE || label[u >> 2] != TET_NONE) continue;
      label[u >> 2] = label[queue[k]];
      queue[n++] = u >> 2;
    }
  return TET_OK;
}

/* Lists live tetrahedra over a bound in slot order, which packing keeps: each was queued, and
 * is marked so still. */
tet_status refine_list_exceptions(refiner *r) {
  tet_refine_result *ret = &r->result;
  refine_list bad = {0};
  refine_shape shape;
  tet_status status = TET_OK;
  uint32_t row = 0;
  for (uint32_t t = 0; t < r->mesh.n_slots && !status; t++) {
    if (!refine_alive(r, t)) continue;
    if (r->tet_edges[t] & TET_QUEUED) {
      status = refine_push(r, &bad, t);
      if (!status) status = refine_push(r, &bad, row);
    }
    row++;
  }
  uint32_t n = bad.n / 2;
  uint32_t *label = NULL, *queue = NULL;
  if (!status) {
    ret->exception_tet = tet_alloc(r->ctx, n, sizeof *ret->exception_tet);
    ret->exception_value = tet_alloc(r->ctx, n, sizeof *ret->exception_value);
    ret->exception_segment = tet_alloc(r->ctx, n, sizeof *ret->exception_segment);
    label = tet_alloc(r->ctx, n ? r->mesh.n_slots : 0, sizeof *label);
    queue = tet_alloc(r->ctx, n ? r->mesh.n_slots : 0, sizeof *queue);
    if (!ret->exception_tet || !ret->exception_value || !ret->exception_segment || !label || !queue)
      status = TET_E_MEMORY;
  }
  if (!status && n) status = nearest_sharp(r, label, queue);
  for (uint32_t k = 0; k < n && !status; k++) {
    uint32_t t = bad.at[2 * (size_t)k];
    refine_measure(r, t, &shape);
    ret->exception_tet[k] = bad.at[2 * (size_t)k + 1];
    ret->exception_value[k] = refine_radius_edge(&shape);
    ret->exception_segment[k] = label[t];
  }
  if (!status) ret->n_exceptions = n;
  tet_free(r->ctx, label);
  tet_free(r->ctx, queue);
  tet_free(r->ctx, bad.at);
  return status;
}

/* Looks at every face once more: where facets are bent by rounding, the cavities on their two
 * sides can leave some that are not Delaunay. */
tet_status refine_check_delaunay(refiner *r) {
  tet_status status = tet_complex_count_broken(&r->mesh, &r->result.n_not_delaunay);
  r->result.constrained_delaunay = !r->result.n_not_delaunay;
  return status;
}

/* Looks at every subface and subsegment once more. */
tet_status refine_check_gabriel(refiner *r) {
  tet_refine_result *ret = &r->result;
  ret->gabriel = 1;
  for (uint32_t e = 0; e < r->n_segs && ret->gabriel; e++) {
    uint32_t by;
    if (r->out->segment[r->seg_of[e]].crease) continue; /* not promised */
    tet_status status = refine_seg_encroached(r, e, &by);
    if (status) return status;
    ret->gabriel = by == TET_NONE;
  }
  for (uint32_t s = 0; s < r->n_subs && ret->gabriel; s++)
    ret->gabriel = r->sub_v[3 * (size_t)s] == TET_NONE || !refine_sub_encroached(r, s);
  return TET_OK;
}
