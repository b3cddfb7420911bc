// SPDX-License-Identifier: Apache-2.0
/* audit.c: orientation, adjacency, the Delaunay and Gabriel properties, subfaces,
 * regions and bounds of a finished mesh (thesis 2.3, 3.2; 2.2 for what a mesh is).
 * What the PLS asks for is in cover.h.
 *
 * Every property is decided by its definition: local Delaunay at each face by
 * the opposite vertex, Gabriel at each subface by both apexes. */
#include "audit/audit.h"

#include "audit/cover.h"
#include "audit/edges.h"
#include "audit/faces.h"
#include "audit/hull.h"
#include "audit/quality.h"
#include "exact/predicates.h"

#include <math.h>
#include <string.h>

enum { FLAT = 1, EXCEPTION = 2, SLIVER = 4 };

typedef struct auditor {
  tet_ctx *ctx;
  const tet_mesh *mesh;
  tet_face_table faces;
  uint8_t *subface; /* [4 n_tetrahedra] 1: the face of this handle is a subface */
  uint8_t *flag;    /* [n_tetrahedra] */
  uint32_t *boundary; /* handles of the boundary faces, where convexity is promised */
  size_t n_boundary, cap_boundary;
  uint32_t *part; /* [n_tetrahedra] union-find over faces off subfaces inside a region */
  tet_audit found;
} auditor;

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

static uint64_t beyond(const uint32_t *index, uint64_t n, uint32_t limit) {
  uint64_t count = 0;
  for (uint64_t i = 0; i < n; i++) count += index[i] >= limit;
  return count;
}

static uint64_t count_bad_indices(const tet_mesh *m) {
  uint64_t bad = beyond(m->tetrahedra, 4 * (uint64_t)m->n_tetrahedra, m->n_points) +
                 beyond(m->tetrahedron_regions, m->n_tetrahedra, m->n_regions) +
                 beyond(m->subfaces, 3 * (uint64_t)m->n_subfaces, m->n_points) +
                 beyond(m->subsegments, 2 * (uint64_t)m->n_subsegments, m->n_points) +
                 beyond(m->exception_tetrahedra, m->n_exceptions, m->n_tetrahedra) +
                 beyond(m->sliver_tetrahedra, m->n_slivers, m->n_tetrahedra) +
                 beyond(m->point_same_as, m->n_input_points, m->n_points);
  for (uint64_t i = 0; m->neighbours && i < 4 * (uint64_t)m->n_tetrahedra; i++)
    bad += m->neighbours[i] >= m->n_tetrahedra && m->neighbours[i] != TET_NONE;
  return bad;
}

/* Orientation, and the bounds of radius-edge ratios, volumes and dihedral angles. */
static tet_status check_shapes(auditor *a) {
  const tet_mesh *m = a->mesh;
  const tet_promise *promised = &m->report.promised;
  const double slack = 1 + 1e-9;
  const double bound = cos(promised->min_dihedral * (M_PI / 180)) + 1e-9;
  for (uint32_t i = 0; i < m->n_exceptions; i++) a->flag[m->exception_tetrahedra[i]] |= EXCEPTION;
  for (uint32_t i = 0; i < m->n_slivers; i++) a->flag[m->sliver_tetrahedra[i]] |= SLIVER;
  for (uint32_t t = 0; t < m->n_tetrahedra; t++) {
    const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
    if (tet_orient3d_xyz(place(m, v[0]), place(m, v[1]), place(m, v[2]), place(m, v[3])) <= 0) {
      a->found.flat_or_inverted++;
      a->flag[t] |= FLAT;
    } else if ((a->flag[t] & (EXCEPTION | SLIVER)) != (EXCEPTION | SLIVER)) {
      tet_shape s = tet_shape_of(m->points, v);
      double own = promised->region_volumes ? m->region_max_volumes[m->tetrahedron_regions[t]] : 0;
      int listed = a->flag[t] & EXCEPTION;
      a->found.over_radius_edge += !listed && promised->radius_edge > 0 && s.radius_edge > promised->radius_edge * slack;
      a->found.over_volume += !listed && ((promised->max_volume > 0 && s.volume > promised->max_volume * slack) ||
                                          (own > 0 && s.volume > own * slack));
      a->found.under_dihedral += !(a->flag[t] & SLIVER) && promised->min_dihedral > 0 && s.cos_smallest > bound;
    }
    tet_status status = (t & 1023) == 0 ? tet_poll(a->ctx) : TET_OK;
    if (status != TET_OK) return status;
  }
  return TET_OK;
}

/* Finds every subface among the faces and marks both sides. */
static tet_status match_subfaces(auditor *a) {
  const tet_mesh *m = a->mesh;
  for (uint32_t s = 0; s < m->n_subfaces; s++) {
    uint32_t n, first = tet_face_table_find(&a->faces, m->subfaces + 3 * (size_t)s, &n);
    int again = n && a->subface[a->faces.handle[first]];
    a->found.subfaces_missing += n == 0 || again;
    for (uint32_t i = 0; i < n; i++) a->subface[a->faces.handle[first + i]] = 1;
    tet_status status = (s & 1023) == 0 ? tet_poll(a->ctx) : TET_OK;
    if (status != TET_OK) return status;
  }
  return TET_OK;
}

static uint32_t root(uint32_t *part, uint32_t t) {
  while (part[t] != t) t = part[t] = part[part[t]];
  return t;
}

/* Counts regions that are not one part each, in no tetrahedron or in several parts. */
static tet_status check_regions(auditor *a) {
  const tet_mesh *m = a->mesh;
  uint32_t *parts = tet_calloc(a->ctx, m->n_regions, sizeof *parts);
  if (!parts) return tet_ctx_error(a->ctx)->status;
  for (uint32_t t = 0; t < m->n_tetrahedra; t++) parts[m->tetrahedron_regions[t]] += a->part[t] == t;
  for (uint32_t r = 0; r < m->n_regions; r++) a->found.wrong_regions += parts[r] != 1;
  tet_free(a->ctx, parts);
  return TET_OK;
}

static void check_pair(auditor *a, uint32_t h, uint32_t g) {
  const tet_mesh *m = a->mesh;
  uint32_t t = h / 4, u = g / 4, face[3];
  const uint32_t *v = m->tetrahedra + 4 * (size_t)t, *w = m->tetrahedra + 4 * (size_t)u;
  int one_side = tet_face_vertices(m, h, face) == tet_face_vertices(m, g, face);
  a->found.adjacency += one_side;
  if (!a->subface[h] && m->tetrahedron_regions[t] != m->tetrahedron_regions[u]) a->found.region_leaks++;
  if (!a->subface[h] && m->tetrahedron_regions[t] == m->tetrahedron_regions[u]) {
    uint32_t x = root(a->part, t), y = root(a->part, u);
    a->part[x < y ? y : x] = x < y ? x : y;
  }
  if (one_side || ((a->flag[t] | a->flag[u]) & FLAT)) return;
  if (tet_insphere_xyz(place(m, v[0]), place(m, v[1]), place(m, v[2]), place(m, v[3]), place(m, w[g % 4])) > 0) {
    a->found.not_delaunay++;
    a->found.not_constrained_delaunay += !a->subface[h];
  }
}

/* The `n` sides, from place `i` of the table on, of one face. */
static void check_face(auditor *a, uint32_t i, uint32_t n) {
  const tet_mesh *m = a->mesh;
  const uint32_t *handle = a->faces.handle + i;
  uint32_t v[3];
  int encroached = 0;
  if (n > 2) a->found.adjacency++;
  if (n == 1 && !a->subface[handle[0]]) a->found.uncovered++;
  if (n == 2) check_pair(a, handle[0], handle[1]);
  for (uint32_t k = 0; k < n; k++) {
    uint32_t h = handle[k], apex = m->tetrahedra[h];
    if (m->neighbours) {
      uint32_t other = n == 1 ? TET_NONE : handle[k == 0] / 4;
      a->found.adjacency += m->neighbours[h] != other;
    }
    if (!a->subface[h]) continue;
    tet_face_vertices(m, h, v);
    encroached |= tet_in_diametric_ball3_xyz(place(m, v[0]), place(m, v[1]), place(m, v[2]), place(m, apex)) > 0;
  }
  a->found.subfaces_encroached += (uint64_t)encroached;
}

/* Lists the boundary faces and looks at the edges between them. */
static tet_status check_hull(auditor *a) {
  tet_status status = TET_OK;
  uint32_t n = 4 * a->mesh->n_tetrahedra;
  for (uint32_t i = 0, run; status == TET_OK && i < n; i += run) {
    run = tet_face_table_run(&a->faces, i);
    if (run != 1) continue;
    status = tet_grow(a->ctx, &a->boundary, &a->cap_boundary, a->n_boundary + 1, sizeof *a->boundary);
    if (status == TET_OK) a->boundary[a->n_boundary++] = a->faces.handle[i];
    if (status == TET_OK && (a->n_boundary & 255) == 0) status = tet_poll(a->ctx);
  }
  if (status != TET_OK) return status;
  return tet_audit_hull(a->ctx, a->mesh, a->boundary, (uint32_t)a->n_boundary, &a->found.reflex);
}

static tet_status check_faces(auditor *a) {
  const tet_mesh *m = a->mesh;
  tet_status status = tet_face_table_build(a->ctx, m, &a->faces);
  if (status == TET_OK) status = match_subfaces(a);
  uint32_t n = 4 * m->n_tetrahedra, step = 0;
  for (uint32_t i = 0, run; status == TET_OK && i < n; i += run) {
    run = tet_face_table_run(&a->faces, i);
    check_face(a, i, run);
    if ((step++ & 1023) == 0) {
      status = tet_poll(a->ctx);
      tet_progress_report(a->ctx, (double)i / n, m->n_points, m->n_tetrahedra, i);
    }
  }
  return status;
}

static int holds(const tet_promise *p, const tet_audit *f) {
  if (f->bad_indices || f->flat_or_inverted || f->adjacency || f->subfaces_missing || f->subsegments_missing) return 0;
  if (f->region_leaks || f->broken_segments || f->facet_slivers || f->over_radius_edge || f->over_volume ||
      f->under_dihedral) return 0;
  if (f->wrong_regions || f->wrong_markers || f->lost_vertices || f->bad_segments || f->bad_facets ||
      f->folded_subfaces) return 0;
  if (p->delaunay && f->not_delaunay) return 0;
  if (p->constrained_delaunay && f->not_constrained_delaunay) return 0;
  if (p->gabriel && (f->subfaces_encroached || f->subsegments_encroached)) return 0;
  if (p->convex && f->reflex) return 0;
  return !(p->covered && f->uncovered);
}

/* Subsegments as edges and as chains, and what the PLS asks for. */
static tet_status check_constraints(auditor *a, const tet_pls *pls) {
  tet_ways ways;
  tet_status status = tet_audit_edges(a->ctx, a->mesh, a->subface, &a->found);
  if (status == TET_OK) status = tet_walk_ways(a->ctx, a->mesh, &ways);
  if (status != TET_OK) return status;
  a->found.broken_segments = ways.broken;
  if (pls) status = tet_audit_cover(a->ctx, pls, a->mesh, &ways, &a->found);
  if (pls && status == TET_OK) status = tet_audit_seeds(a->ctx, pls, a->mesh, &a->found);
  tet_ways_free(a->ctx, &ways);
  return status;
}

tet_status tet_audit_mesh(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, tet_audit *ret_audit) {
  auditor a = {.ctx = ctx, .mesh = mesh, .found.facet = TET_NONE};
  a.found.bad_indices = count_bad_indices(mesh);
  if (pls && !a.found.bad_indices) a.found.bad_indices = tet_count_bad_numbers(pls, mesh);
  tet_status status = TET_OK;
  if (!a.found.bad_indices) {
    a.subface = tet_calloc(ctx, 4 * (size_t)mesh->n_tetrahedra, 1);
    a.flag = tet_calloc(ctx, mesh->n_tetrahedra, 1);
    a.part = tet_alloc(ctx, mesh->n_tetrahedra, sizeof *a.part);
    if (!a.subface || !a.flag || !a.part) status = tet_ctx_error(ctx)->status;
    for (uint32_t t = 0; t < mesh->n_tetrahedra && status == TET_OK; t++) a.part[t] = t;
    if (status == TET_OK) status = check_shapes(&a);
    if (status == TET_OK) status = check_faces(&a);
    if (status == TET_OK) status = check_regions(&a);
    if (status == TET_OK && mesh->report.promised.convex) status = check_hull(&a);
    tet_free(ctx, a.boundary);
    tet_free(ctx, a.flag);
    tet_free(ctx, a.part);
    tet_face_table_free(ctx, &a.faces);
    if (status == TET_OK) status = check_constraints(&a, pls);
    tet_free(ctx, a.subface);
  }
  if (status != TET_OK) return status;
  a.found.passed = holds(&mesh->report.promised, &a.found);
  *ret_audit = a.found;
  return TET_OK;
}
