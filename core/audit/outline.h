// SPDX-License-Identifier: Apache-2.0
/* outline.h: where the facets of a PLS end, from its polygons alone. */
#ifndef TET_AUDIT_OUTLINE_H
#define TET_AUDIT_OUTLINE_H

#include "audit/chain.h"

#include <tet/mesh.h>
#include <tet/pls.h>

/* How a facet is looked at: three of its vertices (rows of the mesh) off one line, and the
 * axis along which it is projected. Without area: v[0] is TET_NONE. */
typedef struct tet_facet_view {
  uint32_t v[3];
  uint8_t axis;
  uint8_t has_area; /* a polygon of three and more vertices is among its polygons */
} tet_facet_view;

/* The view of facet f: the first of its vertices, the one farthest from it, and the one
 * that makes the largest triangle with them; the axis of that triangle's largest projection. */
void tet_view_facet(const tet_pls *pls, const tet_mesh *mesh, uint32_t f, tet_facet_view *ret_view);

/* Adds to `chain`, under number `root`, the links around facet f: the facet, what is inside an odd
 * number of turns of any of its polygons (A.1.2), less what is inside the same ones as a hole's
 * seed, is on their left as projected along `axis`. Errors: TET_E_MEMORY, and those of polling. Linear for
 * one polygon that meets each vertex once; else its sides, times those at the level of each. */
tet_status tet_facet_outline(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, uint32_t f, uint32_t root,
                             int axis, tet_chain *chain);

/* Clears *ret_all unless all of the n links have what may be a hole of facet f just to their right. */
tet_status tet_is_hole_beside(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, uint32_t f, int axis,
                              const tet_link *link, size_t n, int *ret_all);

#endif
