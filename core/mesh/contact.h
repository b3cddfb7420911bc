// SPDX-License-Identifier: Apache-2.0
/* contact.h: whether a tetrahedron and a triangle meet as in a complex. */
#ifndef TET_MESH_CONTACT_H
#define TET_MESH_CONTACT_H

#include "exact/points.h"

/* 1 if positive tetrahedron t and triangle f, given by vertices, meet in their
 * common vertices' simplex and nowhere else; exact. Where f is a face of t that
 * is 1. Neither may be degenerate. */
int tet_meets_in_common_face(const tet_points *p, const uint32_t t[4], const uint32_t f[3]);

#endif
