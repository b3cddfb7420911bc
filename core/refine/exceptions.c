// SPDX-License-Identifier: Apache-2.0
/* exceptions.c: what is still over a bound, or a sliver, at the end, with the sharp
 * subsegment that trace.c blames or the nearest one; and whether the promises about encroachment hold. */
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

/* Tetrahedra to list: slots, and their rows after packing, which keeps the order of slots. */
typedef struct listing {
  refine_list tet, row;
} listing;

static tet_status note(refiner *r, listing *l, uint32_t t, uint32_t row) {
  tet_status status = refine_push(r, &l->tet, t);
  return status ? status : refine_push(r, &l->row, row);
}

/* Finds those over a bound and the slivers. Each was queued, and is marked so still; slivers
 * only as long as these were being removed. */
static tet_status find(refiner *r, listing *over, listing *slivers) {
  tet_status status = TET_OK;
  refine_shape shape;
  int all = r->result.n_first_slivers && !r->watch_slivers;
  for (uint32_t t = 0, row = 0; t < r->mesh.n_slots && !status; t++) {
    const uint32_t *v = r->mesh.v + 4 * (size_t)t;
    if (!refine_alive(r, t)) continue;
    if (r->tet_edges[t] & TET_QUEUED) {
      refine_measure_corners(r, v, &shape);
      if (refine_over_ratio(r, &shape) || refine_over_volume(r, r->tet_region[t], shape.volume6))
        status = note(r, over, t, row);
    }
    if (!status && (all || r->tet_edges[t] & TET_QUEUED) && refine_is_sliver(r, v)) status = note(r, slivers, t, row);
    if (!status && (t & 4095) == 0) status = tet_poll(r->ctx);
    row++;
  }
  return status;
}

/* Fills the rows, values and segments of a list; label: of each slot the segment. */
static tet_status fill(refiner *r, const listing *l, const uint32_t *label, int is_sliver, uint32_t **ret_tet,
                       double **ret_value, uint32_t **ret_segment) {
  uint32_t n = l->tet.n;
  refine_shape shape;
  uint32_t *tet = *ret_tet = tet_alloc(r->ctx, n, sizeof *tet);
  double *value = *ret_value = tet_alloc(r->ctx, n, sizeof *value);
  uint32_t *segment = *ret_segment = tet_alloc(r->ctx, n, sizeof *segment);
  if (!tet || !value || !segment) return TET_E_MEMORY;
  for (uint32_t k = 0; k < n; k++) {
    tet[k] = l->row.at[k];
    segment[k] = label[l->tet.at[k]];
    if (is_sliver) {
      value[k] = sqrt(refine_sharpest(r, r->mesh.v + 4 * (size_t)l->tet.at[k]));
    } else {
      refine_measure(r, l->tet.at[k], &shape);
      value[k] = refine_radius_edge(&shape);
    }
  }
  return TET_OK;
}

/* Lists what is over a bound, and slivers. */
tet_status refine_list_exceptions(refiner *r) {
  tet_refine_result *ret = &r->result;
  listing over = {{0}, {0}}, slivers = {{0}, {0}};
  uint32_t *label = NULL, *queue = NULL;
  tet_status status = find(r, &over, &slivers);
  if (!status && over.tet.n + slivers.tet.n) {
    label = tet_alloc(r->ctx, r->mesh.n_slots, sizeof *label);
    queue = tet_alloc(r->ctx, r->mesh.n_slots, sizeof *queue);
    status = label && queue ? nearest_sharp(r, label, queue) : TET_E_MEMORY;
  }
  if (!status)
    status = fill(r, &over, label, 0, &ret->exception_tet, &ret->exception_value, &ret->exception_segment);
  if (!status && over.tet.n && r->n_sharp) status = refine_trace(r, over.tet.n, over.tet.at, 0, ret->exception_segment);
  if (!status) status = fill(r, &slivers, label, 1, &ret->sliver_tet, &ret->sliver_cosine, &ret->sliver_segment);
  if (!status && slivers.tet.n && r->n_sharp)
    status = refine_trace(r, slivers.tet.n, slivers.tet.at, 1, ret->sliver_segment);
  if (!status) {
    ret->n_exceptions = over.tet.n;
    ret->n_slivers = slivers.tet.n;
  }
  uint32_t *all[] = {label, queue, over.tet.at, over.row.at, slivers.tet.at, slivers.row.at};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(r->ctx, all[i]);
  return status;
}

/* Looks at every face once more: where facets are bent by rounding, the cavities on their two
 * sides can leave some that are not Delaunay; where none is, none can be (5.1.4). */
tet_status refine_check_delaunay(refiner *r) {
  if (r->exact) return TET_OK;
  tet_status status = tet_complex_count_broken(&r->mesh, &r->result.n_not_delaunay);
  r->result.constrained_delaunay = !r->result.n_not_delaunay;
  return status;
}

/* Looks at every subface and subsegment once more, at these from each tetrahedron around. */
tet_status refine_check_gabriel(refiner *r) {
  tet_refine_result *ret = &r->result;
  ret->gabriel = 1;
  for (uint32_t t = 0; t < r->mesh.n_slots && ret->gabriel; t++) {
    if (!refine_alive(r, t) || !(r->tet_edges[t] & EDGES)) continue;
    for (int e = 0; e < 6 && ret->gabriel; e++) {
      uint32_t seg = refine_hit_seg(r, t, e);
      ret->gabriel = seg == TET_NONE || r->out->segment[r->seg_of[seg]].crease; /* not promised there */
    }
    tet_status status = (t & 4095) == 0 ? tet_poll(r->ctx) : TET_OK;
    if (status) return status;
  }
  for (uint32_t s = 0; s < r->n_subs && ret->gabriel; s++)
    ret->gabriel = r->sub_v[3 * (size_t)s] == TET_NONE || !refine_sub_encroached(r, s);
  return TET_OK;
}
