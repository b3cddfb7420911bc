// SPDX-License-Identifier: Apache-2.0
/* engine.c: the pipeline from a PLS to an audited mesh. */
#include <tet/engine.h>

#include "audit/audit.h"
#include "audit/quality.h"
#include "build/build.h"
#include "dual/diagram.h"
#include "dual/dual.h"
#include "engine/check.h"
#include "engine/exceptions.h"
#include "engine/hull.h"
#include "engine/order.h"
#include "engine/pack.h"
#include "refine/refine.h"

#include <math.h>
#include <string.h>

void tet_options_default(tet_options *options) {
  *options = (tet_options){.stage = TET_STAGE_REFINE, .radius_edge = 2.0, .min_dihedral = 5, .order = TET_INSERT_O2_O1,
                           .point_order = TET_ORDER_INPUT_FIRST,
                           .threads = 1};
}

static tet_status refine(tet_ctx *ctx, const tet_options *options, tet_build_result *built, tet_refine_result *ret) {
  tet_refine_options how;
  tet_refine_options_default(&how);
  how.radius_edge = options->radius_edge;
  how.max_volume = options->max_volume;
  how.order = options->order;
  how.min_dihedral = options->min_dihedral;
  tet_stage_begin(ctx, "refine");
  tet_status status = tet_refine(ctx, &built->pieces, &how, ret);
  if (status == TET_OK) tet_stage_counts(ctx, built->pieces.n_points, built->pieces.n_tets);
  return status;
}

/* What the stages claim; the audit then looks whether it is so. */
static tet_promise promise(const tet_options *options, const tet_build_result *built, const tet_refine_result *refined) {
  tet_promise p = {.planarity = built->planarity, .merge_angle = options->merge_angle,
                   .merged_angle = built->merged_angle, .merged_distance = built->merged_distance};
  p.covered = options->stage != TET_STAGE_DELAUNAY && !options->keep_hull;
  p.convex = options->stage == TET_STAGE_DELAUNAY; /* on a kept hull Steiner points round */
  p.constrained_delaunay = refined ? refined->constrained_delaunay : 1;
  p.delaunay = options->stage == TET_STAGE_DELAUNAY;
  if (refined) {
    p.gabriel = refined->gabriel;
    p.delaunay = refined->gabriel && refined->constrained_delaunay; /* Gabriel faces are Delaunay */
    p.radius_edge = options->radius_edge;
    p.radius_edge_proven = tet_refine_is_proven(options->radius_edge);
    p.max_volume = options->max_volume;
    p.min_dihedral = options->min_dihedral;
    p.region_volumes = 1;
  }
  return p;
}

static void count(tet_report *report, const tet_build_result *built, const tet_refine_result *refined) {
  report->counts = built->counts;
  if (!refined) return;
  report->rejected = refined->rejected;
  report->trace = refined->trace;
  report->counts.refine_segment_points = refined->segment_points;
  report->counts.refine_facet_points = refined->facet_points;
  report->counts.refine_volume_points = refined->volume_points;
  report->counts.first_slivers = refined->n_first_slivers;
  report->counts.sliver_points = refined->sliver_points;
  report->counts.sliver_budget = refined->sliver_budget;
  report->counts.thin_points = refined->thin_points;
  report->counts.thin_budget = refined->thin_budget;
}

/* Only of a mesh that is one. */
static tet_status add_voronoi(tet_ctx *ctx, const tet_options *options, tet_mesh *mesh) {
  if (mesh->report.audit.bad_indices || mesh->report.audit.flat_or_inverted)
    return tet_internal(ctx, "no Voronoi cells: the mesh has tetrahedra that are none");
  tet_stage_begin(ctx, "voronoi");
  tet_status status = tet_voronoi_factors(ctx, mesh);
  if (status != TET_OK || options->voronoi != TET_VORONOI_DIAGRAM) return status;
  status = tet_voronoi_diagram(ctx, mesh);
  if (options->neighbours) return status;
  tet_free(ctx, mesh->neighbours); /* they were packed for the diagram alone */
  mesh->neighbours = NULL;
  return status;
}

/* Packs, orders, audits and adds the dual; ends the last stage. */
static tet_status finish(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_build_result *built,
                         tet_refine_result *refined, tet_mesh *mesh) {
  tet_report *report = &mesh->report;
  tet_status status = tet_pack_mesh(ctx, pls, options, built, refined, mesh);
  if (status == TET_OK) status = tet_order_mesh(ctx, mesh, options->point_order);
  if (status != TET_OK) return status;
  report->promised = promise(options, built, refined);
  count(report, built, refined);
  if (refined) status = tet_complete_exceptions(ctx, mesh);
  if (status != TET_OK) return status;
  tet_stage_begin(ctx, "audit");
  status = tet_audit_mesh(ctx, options->stage == TET_STAGE_DELAUNAY ? NULL : pls, mesh, &report->audit);
  if (status == TET_OK) status = tet_measure_quality(ctx, mesh, &report->quality);
  if (status == TET_OK && options->voronoi) status = add_voronoi(ctx, options, mesh);
  if (status != TET_OK) return status;
  tet_stage_end(ctx);
  const tet_stage_report *stages = tet_stages(ctx, &report->n_stages);
  memcpy(report->stages, stages, report->n_stages * sizeof *stages);
  report->peak_bytes = tet_ctx_peak_bytes(ctx);
  return TET_OK;
}

/* From checked input to *ret_mesh. */
static tet_status run(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_mesh **ret_mesh) {
  tet_build_options how = {options->stage, options->keep_hull, options->planarity_tolerance, options->threads,
                           options->merge_angle, options->break_points};
  tet_build_result built;
  tet_refine_result refined = {.n_exceptions = 0};
  int refining = options->stage == TET_STAGE_REFINE;
  tet_status status = tet_build(ctx, pls, &how, &built);
  if (status != TET_OK) return status;
  if (refining) status = refine(ctx, options, &built, &refined);
  tet_mesh *mesh = NULL;
  if (status == TET_OK) {
    mesh = tet_calloc(ctx, 1, sizeof *mesh);
    status = mesh ? TET_OK : tet_ctx_error(ctx)->status;
  }
  if (status == TET_OK) {
    mesh->ctx = ctx;
    status = finish(ctx, pls, options, &built, refining ? &refined : NULL, mesh);
  }
  tet_build_result_free(ctx, &built);
  tet_refine_result_free(ctx, &refined);
  if (status == TET_OK)
    *ret_mesh = mesh;
  else
    tet_mesh_free(mesh);
  return status;
}

/* 1 if what failed is the surface that was made of a hull, and not the run. */
static int is_no_surface(tet_status status) {
  return status == TET_E_DEGENERATE || status == TET_E_NOT_PLANAR || status == TET_E_INTERSECTION ||
         status == TET_E_OPEN || status == TET_E_SEED || status == TET_E_ROUNDING;
}

/* The same for points without facets, whose convex hull is refined. Where its facets as the points are meant give no
 * surface, they are the faces of the hull, whatever is right below. */
static tet_status run_cloud(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_mesh **ret_mesh) {
  tet_status status = TET_OK;
  for (int exact = 0; exact < 2; exact++) {
    tet_pls closed;
    tet_skin skin;
    tet_options own = *options;
    status = tet_close_by_hull(ctx, pls, options->threads, exact, &closed, &skin);
    if (status != TET_OK) break;
    own.planarity_tolerance = fmax(options->planarity_tolerance, 16 * skin.tolerance);
    status = run(ctx, &closed, &own, ret_mesh);
    tet_skin_free(ctx, &skin);
    if (!is_no_surface(status)) break;
  }
  return status;
}

tet_status tet_mesh_pls(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_mesh **ret_mesh) {
  tet_stages_clear(ctx);
  tet_status status = tet_check_options(ctx, options);
  if (status == TET_OK) status = tet_check_arrays(ctx, pls);
  int is_cloud = options->stage == TET_STAGE_REFINE && status == TET_OK && !pls->n_facets;
  if (status == TET_OK) status = is_cloud ? run_cloud(ctx, pls, options, ret_mesh) : run(ctx, pls, options, ret_mesh);
  tet_stage_end(ctx);
  return status;
}
