// SPDX-License-Identifier: Apache-2.0
/* cover.h: does a mesh hold the PLS that it is of? */
#ifndef TET_AUDIT_COVER_H
#define TET_AUDIT_COVER_H

#include "audit/ways.h"

#include <tet/mesh.h>
#include <tet/pls.h>

/* The indices of `mesh` into `pls` that are out of range, and facet_same_as that lead nowhere. */
uint64_t tet_count_bad_numbers(const tet_pls *pls, const tet_mesh *mesh);

/* Counts into *found: bad_facets and facet, folded_subfaces, bad_segments, wrong_markers. All indices
 * must be in range. n log n in the subfaces and facets; one pass over the tetrahedra where something
 * is not covered. */
tet_status tet_audit_cover(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, const tet_ways *ways,
                           tet_audit *found);

/* Counts into *found: lost_vertices, and wrong_regions by their seeds. One pass over the tetrahedra. */
tet_status tet_audit_seeds(tet_ctx *ctx, const tet_pls *pls, const tet_mesh *mesh, tet_audit *found);

#endif
