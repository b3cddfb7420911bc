// SPDX-License-Identifier: Apache-2.0
/* soup.h: what the steps of tet_surface_build hand each other.
 *
 *   input.c                 arrays checked, duplicates and repeats found
 *   surface.c               rounds of the next two, until nothing joins anything
 *   facet_triangulation.c   each facet -> triangles        } again, while vertices or
 *   intersections.c         pairs that meet: joins, faults } segments join facets
 *   patches.c               triangles -> patches and segments of the surface
 */
#ifndef TET_BUILD_SOUP_H
#define TET_BUILD_SOUP_H

#include "build/cdt2d.h"
#include "build/surface.h"

/* Flags of a triangle's edge inside its facet. */
enum {
  TET_EDGE_FIXED = 1, /* a constraint of the facet's triangulation */
  TET_EDGE_BORDER = 2 /* a side of one of its polygons (fixed, too) */
};

/* A loose segment, or a part of one between vertices that lie on it. */
typedef struct tet_piece {
  uint32_t a, b;
  uint32_t facet;   /* whose 2-vertex polygon it is, or TET_NONE */
  uint32_t segment; /* row of pls->segments, or TET_NONE */
} tet_piece;

/* A vertex that lies on a facet and becomes one of its vertices. */
typedef struct tet_join {
  uint32_t facet, vertex;
} tet_join;

/* A foreign segment in a facet's plane that becomes a constraint there. */
typedef struct tet_constraint {
  uint32_t facet, a, b;
  tet_offender_kind kind; /* whose segment it is, for errors */
  uint32_t owner;
} tet_constraint;

/* A vertex on a piece, which is to be split there. */
typedef struct tet_piece_split {
  uint32_t piece, vertex;
} tet_piece_split;

/* An offence and the kind of error that it makes. */
typedef struct tet_fault {
  tet_status status;
  tet_offence offence;
  double amount; /* not planar: the deviation */
  const char *what; /* completes "facet 12 ...", or "facets 12 and 15 ..."; NULL: cross */
} tet_fault;

typedef struct tet_soup {
  tet_ctx *ctx;
  const tet_pls *pls;
  const tet_points *points;
  double tolerance;
  double merge_angle; /* degrees */
  uint32_t *same_as; /* [n_points] */
  uint8_t *used;     /* [n_points] */
  uint32_t *repeats; /* [n_facets] the earlier facet that is the same, for which it is
                        left out, or TET_NONE */
  uint32_t corner[4]; /* four vertices in no plane */
  uint64_t n_duplicates, n_repeated_facets, n_unused;
  double planarity;

  uint32_t n_tris;
  uint32_t *tri;     /* [n][3] counter-clockwise with the facet's axis dropped */
  uint8_t *edge;     /* [n][3] flags */
  uint32_t *facet;   /* [n] input facet */
  size_t cap_tri, cap_edge, cap_facet;
  uint32_t *first;   /* [n_facets + 1] first triangle of each facet */
  uint8_t *axis;     /* [n_facets] dropped coordinate */
  uint8_t *flat;     /* [n_facets] all its vertices exactly in one plane */

  uint32_t n_pieces;
  tet_piece *piece;
  uint32_t n_loose;
  uint32_t *loose;   /* vertices used by themselves */
  uint32_t n_joins;
  tet_join *join;    /* sorted by facet, vertex */
  uint32_t n_constraints;
  tet_constraint *constraint; /* sorted by facet, a, b */
  uint32_t n_faults;
  tet_fault *fault;
  size_t cap_piece, cap_loose, cap_join, cap_constraint, cap_fault;

  /* found by one round of intersections */
  uint32_t n_new_joins;
  tet_join *new_join;
  uint32_t n_splits;
  tet_piece_split *split;
  uint32_t n_new_constraints;
  tet_constraint *new_constraint;
  size_t cap_new_join, cap_split, cap_new_constraint;
} tet_soup;

/* input.c */

/* Checks index ranges, starts and coordinates of `pls`. */
tet_status tet_check_pls(tet_ctx *ctx, const tet_pls *pls);

/* Fills same_as: the lowest vertex of equal coordinates survives (-0 equals 0). */
tet_status tet_find_duplicates(tet_soup *s);

/* Marks facets that repeat an earlier one: the same polygon sides and holes. */
tet_status tet_find_repeated_facets(tet_soup *s);

/* facet_plane.c */

/* Twice the area vector of abc, up to a positive factor that depends on the three
 * alone; never overflows. Inexact: for choices that exact tests then check. */
void tet_soup_normal(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c, double ret_n[3]);

/* The axis to drop for triangle abc, and its orientation then; 0: no area. */
int tet_projection_axis(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c, int *ret_axis);

/* A corner off the plane of abc. */
uint32_t tet_corner_off(const tet_soup *s, uint32_t a, uint32_t b, uint32_t c);

/* Four used vertices in no plane into s->corner. TET_E_DEGENERATE if all are. */
tet_status tet_find_corners(tet_soup *s);

/* facet_triangulation.c */

/* Triangulates all facets with what has joined them. Faulty ones get no triangles. In
 * the first round, polygon sides that bound no triangle are added to the pieces. */
tet_status tet_triangulate_facets(tet_soup *s, int first_round);

/* intersections.c */

/* Tests all triangles, pieces and loose points against each other exactly. Fills
 * new_join, split, new_constraint, and adds faults. */
tet_status tet_find_intersections(tet_soup *s);

/* patches.c */

/* Makes the surface (but same_as, used and counts) of a soup without faults. */
tet_status tet_make_patches(tet_soup *s, tet_surface *r);

/* split.c */

/* Flips all edges that are not locally Delaunay, off segments. */
tet_status tet_surface_flip_all(tet_ctx *ctx, tet_surface *s, const tet_points *points);

/* faults.c */

/* Records a fault of one or two elements. */
tet_status tet_soup_fault(tet_soup *s, const tet_fault *fault);

/* Fails with the recorded faults, of one status, sorted, each pair once. */
tet_status tet_soup_fail(tet_soup *s);

static inline int32_t tet_facet_marker(const tet_pls *pls, uint32_t f) {
  return pls->facet_markers ? pls->facet_markers[f] : 0;
}

static inline const double *tet_soup_x(const tet_soup *s, uint32_t v) {
  return s->points->x + 3 * (size_t)v;
}

/* The polygons of facet f: first and one past the last. */
static inline uint32_t tet_first_polygon(const tet_pls *pls, uint32_t f) {
  return pls->facet_start ? pls->facet_start[f] : f;
}

#endif
