// SPDX-License-Identifier: Apache-2.0
/* status.h: the closed list of outcomes of every engine call.
 *
 * Values are stable: they travel in job errors and appear in clients. New ones
 * are added at the end of their group. Follows design sections 2 and 4. */
#ifndef TET_STATUS_H
#define TET_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tet_status {
  TET_OK = 0,

  /* The input is refused; the error names the elements and a place. */
  TET_E_ARGUMENT = 1,        /* an option or array makes no sense by itself */
  TET_E_NOT_FINITE = 2,      /* a coordinate is NaN, infinite or out of range */
  TET_E_INDEX = 3,           /* an index points outside its array */
  TET_E_DEGENERATE = 4,      /* all points coplanar, a facet without area, ... */
  TET_E_NOT_PLANAR = 5,      /* a polygon farther out of plane than the tolerance */
  TET_E_INTERSECTION = 6,    /* facets or segments cross or overlap */
  TET_E_OPEN = 7,            /* the facets enclose no volume */
  TET_E_SEED = 8,            /* a hole or region seed on a facet or outside */

  /* A limit that the caller gave was reached. */
  TET_E_MEMORY = 20,         /* the memory budget, or the system's memory */
  TET_E_VERTEX_LIMIT = 21,
  TET_E_DEADLINE = 22,
  TET_E_CANCELLED = 23,
  TET_E_TOO_LARGE = 24,      /* an index type would overflow */

  /* Doubles cannot hold the result: facets too close, with the place. */
  TET_E_ROUNDING = 40,

  /* An invariant of ours broke: our bug, with file and line. */
  TET_E_INTERNAL = 60
} tet_status;

/* A short lower-case name, as "intersection"; never NULL. */
const char *tet_status_name(tet_status status);

/* One sentence for people; never NULL. */
const char *tet_status_text(tet_status status);

#ifdef __cplusplus
}
#endif
#endif
