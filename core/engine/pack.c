// SPDX-License-Identifier: Apache-2.0
/* pack.c: takes arrays over from the stages and adds what they do not carry:
 * attributes, markers, neighbours. */
#include "engine/pack.h"

#include <string.h>

/* Moves the array that *from points at to *to. */
static void take(void *to, void *from) {
  memcpy(to, from, sizeof(void *));
  memset(from, 0, sizeof(void *));
}

static tet_status pack_points(tet_ctx *ctx, const tet_pls *pls, tet_build_result *built, tet_mesh *m) {
  tet_pieces *p = &built->pieces;
  m->n_points = p->n_points;
  m->n_input_points = p->n_input;
  m->n_attributes = pls->n_attributes;
  m->point_attributes = tet_calloc(ctx, (size_t)p->n_points * pls->n_attributes, sizeof *m->point_attributes);
  m->point_markers = tet_calloc(ctx, p->n_points, sizeof *m->point_markers);
  if (!m->point_attributes || !m->point_markers) return tet_ctx_error(ctx)->status;
  size_t given = (size_t)p->n_input * pls->n_attributes;
  if (given) memcpy(m->point_attributes, pls->point_attributes, given * sizeof *m->point_attributes);
  tet_status status = tet_interpolate_attributes(ctx, p, pls->n_attributes, m->point_attributes);
  if (status != TET_OK) return status;
  if (pls->point_markers) memcpy(m->point_markers, pls->point_markers, p->n_input * sizeof *m->point_markers);
  for (uint32_t v = p->n_input; v < p->n_points; v++) {
    if (p->origin[v] == TET_ORIGIN_SEGMENT) m->point_markers[v] = p->segment[p->carrier[v]].marker;
    if (p->origin[v] == TET_ORIGIN_FACET) m->point_markers[v] = p->facet[p->carrier[v]].marker;
  }
  take(&m->points, &p->points);
  take(&m->point_origin, &p->origin);
  take(&m->point_same_as, &built->same_as);
  return TET_OK;
}

static void pack_tetrahedra(const tet_options *options, tet_pieces *p, tet_mesh *m) {
  m->n_tetrahedra = p->n_tets;
  take(&m->tetrahedra, &p->tets);
  take(&m->tetrahedron_regions, &p->region);
  if (!options->neighbours && options->voronoi != TET_VORONOI_DIAGRAM) return;
  take(&m->neighbours, &p->adj);
  for (uint64_t i = 0; i < 4 * (uint64_t)m->n_tetrahedra; i++)
    if (m->neighbours[i] != TET_NONE) m->neighbours[i] /= 4;
}

static tet_status pack_constraints(tet_ctx *ctx, tet_build_result *built, tet_mesh *m) {
  tet_pieces *p = &built->pieces;
  m->n_input_facets = built->n_input_facets;
  take(&m->facet_same_as, &built->facet_same_as);
  m->n_subfaces = p->n_subfaces;
  m->n_subsegments = p->n_subsegs;
  m->subface_markers = tet_alloc(ctx, p->n_subfaces, sizeof *m->subface_markers);
  m->subsegment_markers = tet_alloc(ctx, p->n_subsegs, sizeof *m->subsegment_markers);
  if (!m->subface_markers || !m->subsegment_markers) return tet_ctx_error(ctx)->status;
  for (uint32_t s = 0; s < p->n_subsegs; s++) m->subsegment_markers[s] = p->segment[p->subseg_segment[s]].marker;
  for (uint32_t s = 0; s < p->n_subfaces; s++) {
    const tet_facet *facet = &p->facet[p->subface_facet[s]];
    m->subface_markers[s] = facet->marker;
    p->subface_facet[s] = facet->input;
  }
  take(&m->subfaces, &p->subface);
  take(&m->subface_facets, &p->subface_facet);
  take(&m->subsegments, &p->subseg);
  take(&m->subsegment_segments, &p->subseg_segment);
  return TET_OK;
}

static void pack_regions(tet_pieces *p, tet_mesh *m) {
  m->n_regions = p->n_regions;
  take(&m->region_markers, &p->region_marker);
  take(&m->region_attributes, &p->region_attribute);
  take(&m->region_max_volumes, &p->region_max_volume);
}

tet_status tet_pack_mesh(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_build_result *built,
                         tet_refine_result *refined, tet_mesh *mesh) {
  tet_status status = pack_points(ctx, pls, built, mesh);
  if (status == TET_OK) status = pack_constraints(ctx, built, mesh);
  if (status != TET_OK) return status;
  pack_tetrahedra(options, &built->pieces, mesh);
  pack_regions(&built->pieces, mesh);
  if (refined) {
    mesh->n_exceptions = refined->n_exceptions;
    take(&mesh->exception_tetrahedra, &refined->exception_tet);
    take(&mesh->exception_radius_edge, &refined->exception_value);
    take(&mesh->exception_segments, &refined->exception_segment);
    mesh->n_slivers = refined->n_slivers;
    take(&mesh->sliver_tetrahedra, &refined->sliver_tet);
    take(&mesh->sliver_cosines, &refined->sliver_cosine);
    take(&mesh->sliver_segments, &refined->sliver_segment);
  }
  return TET_OK;
}
