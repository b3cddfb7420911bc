// SPDX-License-Identifier: Apache-2.0
/* refine.c: the loop of Delaunay refinement (Fig. 3.5 under the accepting rule of
 * 4.1.4): R1 before R2 before R3, until no rule applies. */
#include "refine/refine.h"
#include "refine/refiner.h"

#include <math.h>

void tet_refine_options_default(tet_refine_options *options) {
  *options = (tet_refine_options){.radius_edge = 2.0, .max_volume = 0, .order = TET_INSERT_O2_O1, .min_dihedral = 0,
                                  .sliver_points = 5, .alpha2 = 0.25, .wedge = 100, .thin = 0.1, .thin_points = 4,
                                  .crowd = 0.4, .crowd_facets = 0.3, .floor = 1e-4, .wedge_floor = 2e-2};
}

void tet_refine_result_free(tet_ctx *ctx, tet_refine_result *result) {
  tet_free(ctx, result->exception_tet);
  tet_free(ctx, result->exception_value);
  tet_free(ctx, result->exception_segment);
  tet_free(ctx, result->sliver_tet);
  tet_free(ctx, result->sliver_cosine);
  tet_free(ctx, result->sliver_segment);
  *result = (tet_refine_result){0};
}

/* All that is encroached at the start. */
static tet_status queue_encroached(refiner *r) {
  tet_status status = TET_OK;
  for (uint32_t e = 0; e < r->n_segs && !status; e++) {
    uint32_t by;
    status = refine_seg_encroached(r, e, &by);
    if (!status && by != TET_NONE) status = refine_queue_seg(r, e);
  }
  for (uint32_t s = 0; s < r->n_subs && !status; s++)
    if (r->sub_v[3 * (size_t)s] != TET_NONE && refine_sub_encroached(r, s)) status = refine_queue_sub(r, s);
  return status;
}

/* From here on tetrahedra over a bound are queued: those there now, but for what was already and
 * could not be split, and new ones. */
static tet_status queue_bad(refiner *r) {
  tet_status status = TET_OK;
  r->watch_tets = 1;
  for (uint32_t t = 0; t < r->mesh.n_slots && !status; t++) {
    if (refine_alive(r, t) && !(r->tet_edges[t] & TET_QUEUED)) status = refine_queue_tet(r, t);
    if (!status && (t & 1023) == 0) status = tet_poll(r->ctx);
  }
  return status;
}

/* Applies the first rule that can be; *ret_more = 0 when none is left. What reshaped cavities
 * left to repair waits for R1 and R2, which heal most of it. */
static tet_status step(refiner *r, int *ret_more) {
  uint32_t item;
  refine_shape shape;
  int sliver;
  refine_outcome outcome = OUTCOME_NONE;
  *ret_more = 1;
  if (refine_next_seg(r, &item)) {
    uint32_t by;
    tet_status status = refine_seg_encroached(r, item, &by);
    return status || by == TET_NONE ? status : refine_split_seg(r, item, by, CAUSE_VERTEX, &outcome);
  }
  if (refine_next_sub(r, &item))
    return refine_sub_encroached(r, item) ? refine_split_sub(r, item, CAUSE_VERTEX, &outcome) : TET_OK;
  if (r->stuck.n) return refine_repair_stuck(r);
  if (refine_next_tet(r, &item, &shape, &sliver)) {
    int is_spent = sliver && r->points.n >= r->last_point;
    tet_status status = TET_OK;
    if (is_spent) r->watch_slivers = 0; /* what is queued counts no more */
    else status = refine_split_tet(r, item, &shape, sliver, &outcome);
    r->some_left |= !status && (is_spent || outcome == OUTCOME_REJECTED);
    return status;
  }
  *ret_more = 0;
  return TET_OK;
}

/* Applies rules until none is left. */
static tet_status drain(refiner *r) {
  int more = 1;
  tet_status status = TET_OK;
  while (!status && more) {
    status = step(r, &more);
    if (!status) status = tet_poll(r->ctx);
    const tet_refine_result *n = &r->result;
    uint64_t done = n->segment_points + n->facet_points + n->volume_points;
    if ((done & 127) == 0) tet_progress_report(r->ctx, -1, r->points.n, r->mesh.n_live, done);
  }
  return status;
}

/* While subsegments are encroached, a face need not be able to be Delaunay: so what
 * stuck is repaired when no rule applies, which may let rules apply again. */
static tet_status converge(refiner *r) {
  enum { ROUNDS = 8, FORCED_ROUNDS = 12 };
  tet_status status = TET_OK;
  for (int round = 0; !status; round++) {
    uint64_t flips = r->result.repair_flips, forced = 0;
    status = drain(r);
    if (!status) status = refine_check_delaunay(r);
    if (status || !r->result.n_not_delaunay || round == FORCED_ROUNDS) break;
    if (round < ROUNDS) status = refine_repair_all(r);
    if (!status && (flips == r->result.repair_flips || round >= ROUNDS)) status = refine_repair_by_force(r, &forced);
    if (flips == r->result.repair_flips && !forced) break;
  }
  return status;
}

/* Slivers go the way of all that is badly shaped (3.4.2). That this ends is seen, not proven: so
 * it has a budget. */
static tet_status remove_slivers(refiner *r) {
  enum { MORE_SLIVER_POINTS = 250 }; /* some dozens may need more each than thousands do on the average */
  uint64_t n = 0, before = r->points.n;
  tet_status polled = TET_OK;
  for (uint32_t t = 0; t < r->mesh.n_slots && !polled; t++) {
    n += refine_alive(r, t) && refine_is_sliver(r, r->mesh.v + 4 * (size_t)t);
    if ((t & 4095) == 0) polled = tet_poll(r->ctx);
  }
  if (polled) return polled;
  r->result.n_first_slivers = n;
  r->result.sliver_budget = (uint64_t)fmax(r->o.sliver_points * (double)n, 0) + MORE_SLIVER_POINTS;
  r->last_point = before + r->result.sliver_budget;
  r->watch_slivers = 1;
  tet_status status = n ? queue_bad(r) : TET_OK;
  if (!status && n) status = converge(r);
  r->result.sliver_points = r->points.n - before;
  return status;
}

static tet_status run(refiner *r) {
  enum { LEAST_THIN_POINTS = 500 };
  r->result.thin_budget = r->thin_points = (uint64_t)(r->o.thin_points * r->n_first) + LEAST_THIN_POINTS;
  tet_status status = refine_unbend(r);
  if (!status) status = refine_check_delaunay(r);
  r->exact = !r->result.n_not_delaunay && refine_facets_are_flat(r);
  if (!status) status = queue_encroached(r);
  if (!status) status = drain(r); /* R1 and R2 first: few tetrahedra outlive that */
  if (!status) status = queue_bad(r);
  if (!status) status = converge(r);
  if (!status && r->o.min_dihedral > 0) status = remove_slivers(r);
  if (!status && r->some_left) status = refine_mend(r);
  return status;
}

/* From pieces to where rules can be applied. */
static tet_status begin(refiner *r) {
  tet_status status = refine_load(r);
  if (!status) status = refine_open_queue(r);
  if (!status) status = refine_set_bounds(r);
  if (!status) status = refine_find_sharp(r);
  return status ? status : refine_lfs(r);
}

/* Refines; and where that ends with faces that are not Delaunay, once more from the start, strictly. A split that
 * leaves such faces is healed as a rule by those that it asks for, and being strict from the start would leave more over
 * the bounds; but between facets that all but touch protecting balls reject these, and there is
 * no constrained Delaunay tetrahedralization then. */
static tet_status refine(refiner *r, tet_pieces *copy) {
  tet_status status = begin(r);
  if (!status && r->n_wedges) status = refine_copy(r, copy);
  if (!status) status = run(r);
  if (status || !r->n_wedges || !r->result.n_not_delaunay) return status;
  refiner again = {.ctx = r->ctx, .o = r->o, .out = r->out, .strict = 1};
  refine_release(r);
  *r = again;
  refine_restore(r, copy);
  status = begin(r);
  return status ? status : run(r);
}

tet_status tet_refine(tet_ctx *ctx, tet_pieces *pieces, const tet_refine_options *options,
                      tet_refine_result *ret) {
  if (!(options->radius_edge >= 1) || !(options->max_volume >= 0) ||
      !(options->min_dihedral >= 0 && options->min_dihedral <= TET_REFINE_MOST_DIHEDRAL))
    return tet_fail(ctx, TET_E_ARGUMENT, "a radius-edge bound of %g, a volume bound of %g, a dihedral bound of %g",
                    options->radius_edge, options->max_volume, options->min_dihedral);
  if ((int)options->order < TET_INSERT_O2_O1 || options->order > TET_INSERT_RELATIVELY_SHORT)
    return tet_fail(ctx, TET_E_ARGUMENT, "there is no insertion order %d", (int)options->order);
  refiner r = {.ctx = ctx, .o = *options, .out = pieces};
  tet_pieces copy = {0};
  tet_status status = refine(&r, &copy);
  tet_pieces_free(ctx, &copy);
  if (!status) status = refine_list_exceptions(&r);
  if (!status) status = refine_check_gabriel(&r);
  if (!status) status = refine_unload(&r);
  if (status) {
    tet_refine_result_free(ctx, &r.result);
  } else {
    r.result.n_sharp_segments = r.n_sharp;
    r.result.thin_points = r.result.thin_budget - r.thin_points;
    *ret = r.result;
  }
  refine_release(&r);
  return status;
}
