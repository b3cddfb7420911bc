// SPDX-License-Identifier: Apache-2.0
/* seeds.c: are the vertices, holes and regions of the PLS where they should be in the mesh?
 *
 * A vertex that is used may be missing only outside; no hole's seed may be inside; a region's seed
 * is in the region that has its marker, attribute and bound, or in a hole (A.1.2). */
#include "audit/cover.h"
#include "audit/reach.h"

enum { VERTEX, HOLE, REGION };

typedef struct seeds {
  tet_ctx *ctx;
  const tet_pls *pls;
  const tet_mesh *mesh;
  tet_probe *probe;
  size_t n, cap;
} seeds;

static tet_status add(seeds *s, int kind, uint32_t index, const double *x) {
  tet_status status = tet_grow(s->ctx, &s->probe, &s->cap, s->n + 1, sizeof *s->probe);
  if (status == TET_OK)
    s->probe[s->n++] = (tet_probe){{x[0], x[1], x[2]}, (uint64_t)kind << 32 | index, TET_NONE};
  return status;
}

/* Marks 1 the rows that the PLS uses, 2 those that are vertices of tetrahedra. */
static void mark_rows(const seeds *s, uint8_t *row) {
  const tet_pls *pls = s->pls;
  const uint32_t *same = s->mesh->point_same_as;
  uint32_t corners = pls->n_polygons ? pls->polygon_start[pls->n_polygons] : 0;
  for (uint32_t i = 0; i < corners; i++) row[same[pls->polygon_vertices[i]]] = 1;
  for (size_t i = 0; i < 2 * (size_t)pls->n_segments; i++) row[same[pls->segments[i]]] = 1;
  if (pls->n_loose_points == TET_LOOSE_ALL_UNUSED)
    for (uint32_t v = 0; v < pls->n_points; v++) row[same[v]] = 1;
  else
    for (uint32_t i = 0; i < pls->n_loose_points; i++) row[same[pls->loose_points[i]]] = 1;
  for (size_t i = 0; i < 4 * (size_t)s->mesh->n_tetrahedra; i++) row[s->mesh->tetrahedra[i]] = 2;
}

/* Probes for the vertices that are used and in no tetrahedron; counts those that were moved. */
static tet_status add_vertices(seeds *s, tet_audit *found) {
  const tet_mesh *m = s->mesh;
  uint8_t *row = tet_calloc(s->ctx, m->n_points, 1);
  tet_status status = row ? TET_OK : tet_ctx_error(s->ctx)->status;
  if (status == TET_OK) mark_rows(s, row);
  for (uint32_t v = 0; v < s->pls->n_points && status == TET_OK; v++) {
    uint32_t at = m->point_same_as[v];
    const double *x = s->pls->points + 3 * (size_t)v, *y = m->points + 3 * (size_t)at;
    found->lost_vertices += x[0] != y[0] || x[1] != y[1] || x[2] != y[2];
    if (row[at] == 1) {
      row[at] = 0; /* once */
      status = add(s, VERTEX, v, x);
    }
  }
  tet_free(s->ctx, row);
  return status;
}

static int32_t marker_of(const tet_pls *pls, uint32_t i) {
  return pls->region_markers ? pls->region_markers[i] : (int32_t)i + 1;
}

/* Is row r of the region table as seed i says? */
static int is_as_seed_says(const seeds *s, uint32_t r, uint32_t i) {
  double attribute = s->pls->region_attributes ? s->pls->region_attributes[i] : marker_of(s->pls, i);
  double volume = s->pls->region_max_volumes ? s->pls->region_max_volumes[i] : 0;
  return s->mesh->region_markers[r] == marker_of(s->pls, i) && s->mesh->region_attributes[r] == attribute &&
         s->mesh->region_max_volumes[r] == (volume > 0 ? volume : 0);
}

/* Counts what was found where it should not be. `first` [n_regions]: TET_NONE. */
static void judge(const seeds *s, uint32_t *first, tet_audit *found) {
  for (size_t k = 0; k < s->n; k++) {
    const tet_probe *p = &s->probe[k];
    uint32_t index = (uint32_t)p->of, kind = (uint32_t)(p->of >> 32);
    int inside = p->tet != TET_NONE;
    if (kind == VERTEX) found->lost_vertices += (uint64_t)inside;
    if (kind == HOLE) found->wrong_regions += (uint64_t)inside;
    if (kind != REGION) continue;
    found->wrong_regions += !inside && !s->pls->n_holes; /* a hole may have taken its part */
    uint32_t r = inside ? s->mesh->tetrahedron_regions[p->tet] : 0;
    if (inside && index < first[r]) first[r] = index; /* of two seeds in one part the first counts */
  }
  for (uint32_t r = 0; r < s->mesh->n_regions; r++)
    found->wrong_regions += first[r] != TET_NONE && !is_as_seed_says(s, r, first[r]);
}

tet_status tet_audit_seeds(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, tet_audit *found) {
  seeds s = {.ctx = ctx, .pls = pls, .mesh = mesh};
  uint32_t *first = tet_alloc(ctx, mesh->n_regions, sizeof *first);
  tet_status status = first ? add_vertices(&s, found) : tet_ctx_error(ctx)->status;
  for (uint32_t r = 0; r < mesh->n_regions && first; r++) first[r] = TET_NONE;
  for (uint32_t i = 0; i < pls->n_holes && mesh->report.promised.covered && status == TET_OK; i++)
    status = add(&s, HOLE, i, pls->holes + 3 * (size_t)i);
  for (uint32_t i = 0; i < pls->n_regions && status == TET_OK; i++)
    status = add(&s, REGION, i, pls->region_seeds + 3 * (size_t)i);
  if (status == TET_OK) status = tet_find_probes(ctx, mesh, s.probe, s.n);
  if (status == TET_OK) judge(&s, first, found);
  tet_free(ctx, first);
  tet_free(ctx, s.probe);
  return status;
}
