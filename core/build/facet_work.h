// SPDX-License-Identifier: Apache-2.0
/* facet_work.h: one facet on its way to triangles; internal to facet_*.c.
 *
 *   facet_plane.c           exactly flat or nearly; which axis to drop
 *   facet_area.c            which triangles of its hull belong to the facet
 *   facet_triangulation.c   the rest
 */
#ifndef TET_BUILD_FACET_WORK_H
#define TET_BUILD_FACET_WORK_H

#include "build/soup.h"

/* A side of a polygon, or a loose or foreign segment, as an edge of the
 * triangulation: local points, lo < hi. */
typedef struct tet_side {
  uint32_t lo, hi;
  uint32_t loop; /* the polygon, or TET_NONE */
  tet_offender_kind kind; /* whose it is */
  uint32_t owner;
} tet_side;

typedef struct tet_frame {
  uint32_t enter; /* edge through which the search came into its triangle */
  uint32_t next;  /* edges of the triangle looked at: 0..3 */
} tet_frame;

/* Arrays are reused from facet to facet. */
typedef struct tet_facet_work {
  tet_soup *s;
  uint32_t facet;
  tet_cdt2d cdt;
  uint32_t *local;    /* [n_points] local number of a vertex, or TET_NONE */
  uint32_t n;
  uint32_t *global;   /* [n] */
  uint32_t n_loops;   /* cleaned polygons: 1 vertex, 2, or 3 and more */
  uint32_t *loop_start; /* [n_loops + 1] into loop */
  uint32_t *loop;     /* vertices */
  uint32_t n_areas;   /* loops of 3 and more */
  int flat, axis;
  uint32_t span[3];   /* three of its vertices, off one line */
  double scale;       /* largest coordinate difference */
  double deviation;   /* from the best plane; 0 if flat */
  double *projected;  /* where not flat: coordinates with the axis zeroed, and one above */
  uint32_t *identity; /* 0, 1, 2 ... */
  tet_points view;    /* of `projected` */
  uint32_t n_sides;
  tet_side *side;     /* sorted */
  uint8_t *kept;      /* [triangles] */
  uint8_t *odd;       /* [n_loops] the search is inside the loop */
  tet_frame *frame;
  uint32_t *flood;
  size_t cap_global, cap_loop_start, cap_loop, cap_projected, cap_identity, cap_side, cap_kept, cap_odd,
      cap_frame, cap_flood;
} tet_facet_work;

/* Sets flat, axis and deviation. *ret_area 0: the facet's vertices are on one line. */
void tet_facet_plane(tet_facet_work *w, int *ret_area);

/* Sets kept: inside an odd number of turns of some polygon; where the facet is made
 * of segments alone, what they enclose; less the facet's holes. */
tet_status tet_facet_area(tet_facet_work *w);

#endif
