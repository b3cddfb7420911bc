// SPDX-License-Identifier: Apache-2.0
/* cavity.h: a missing region Omega and the two cavities beside it (5.4.1). */
#ifndef TET_BUILD_CAVITY_H
#define TET_BUILD_CAVITY_H

#include "build/state.h"

typedef struct tet_cavity {
  tet_state *st;
  uint32_t *face_tri;    /* [4 slots] triangle of the surface at a face, or TET_NONE */
  size_t cap_face_tri;
  uint32_t *omega;       /* triangles of the missing region */
  size_t n_omega, cap_omega;
  uint32_t *crossed;     /* tetrahedra that cross it */
  size_t n_crossed, cap_crossed;
  uint32_t *border[2];   /* handles inside the cavity below (0) and above (1) */
  size_t n_border[2], cap_border[2];

  tet_complex local;     /* Delaunay tetrahedralization of one cavity's vertices */
  uint32_t *vertex;      /* the cavity's vertices */
  size_t n_vertex, cap_vertex;
  uint8_t *has_vertex;   /* [vertices] */
  uint32_t *shown;       /* local handles, inside the cavity, of the faces of Omega and of its border */
  size_t cap_shown;
  uint32_t *image;       /* [local slots] tetrahedron made in the complex, or TET_NONE */
  size_t cap_image;
  uint8_t *blocked;      /* [local slots] bit i: face i is on the cavity's border */
  size_t cap_blocked;
  uint32_t *inside;      /* local tetrahedra inside the cavity */
  size_t n_inside, cap_inside;
  uint32_t *floor;       /* [n_omega] handles made above Omega, to meet those below */
  size_t cap_floor;
} tet_cavity;

tet_status tet_cavity_init(tet_cavity *c, tet_state *st);
void tet_cavity_free(tet_cavity *c);

/* TETRAHEDRALIZECAVITY (Fig. 5.11) above and below c->omega, whose triangles then
 * are faces. `side` of each vertex of the crossed tetrahedra is known. */
tet_status tet_cavity_fill(tet_cavity *c, const int8_t *side);

#endif
