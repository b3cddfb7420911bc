// SPDX-License-Identifier: Apache-2.0
/* pls.h: a piecewise linear system as the engine takes it.
 *
 * Thesis A.1.2: vertices, facets of several polygons with facet holes, loose
 * segments and points, volume holes, regions. All arrays are the caller's and
 * only read; row-major; indices start at 0. An array whose count is 0 may be
 * NULL, and so may every array marked "or NULL". */
#ifndef TET_PLS_H
#define TET_PLS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* n_loose_points: every vertex that no polygon and no segment uses is one. */
#define TET_LOOSE_ALL_UNUSED UINT32_MAX

typedef struct tet_pls {
  uint32_t n_points;
  const double *points;            /* [n_points][3] */
  uint32_t n_attributes;           /* per vertex */
  const double *point_attributes;  /* [n_points][n_attributes] */
  const int32_t *point_markers;    /* [n_points] or NULL */

  uint32_t n_facets;
  const uint32_t *facet_start;     /* [n_facets + 1] into polygons; NULL: one each */
  uint32_t n_polygons;
  const uint32_t *polygon_start;   /* [n_polygons + 1] into polygon_vertices */
  const uint32_t *polygon_vertices;
  const int32_t *facet_markers;    /* [n_facets] or NULL (all 0) */
  const uint32_t *facet_hole_start; /* [n_facets + 1] into facet_holes, or NULL */
  uint32_t n_facet_holes;
  const double *facet_holes;       /* [n_facet_holes][3] */

  uint32_t n_segments;             /* loose: of no facet */
  const uint32_t *segments;        /* [n_segments][2] */
  const int32_t *segment_markers;  /* [n_segments] or NULL */
  uint32_t n_loose_points;         /* or TET_LOOSE_ALL_UNUSED */
  const uint32_t *loose_points;

  uint32_t n_holes;
  const double *holes;             /* [n_holes][3] */

  uint32_t n_regions;
  const double *region_seeds;        /* [n_regions][3] */
  const int32_t *region_markers;     /* [n_regions] or NULL: 1, 2, ... */
  const double *region_attributes;   /* [n_regions] or NULL: the marker */
  const double *region_max_volumes;  /* [n_regions] or NULL; <= 0: none */
} tet_pls;

#ifdef __cplusplus
}
#endif
#endif
