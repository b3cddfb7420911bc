// SPDX-License-Identifier: Apache-2.0
/* gaps.h: may a facet be uncovered where it is? */
#ifndef TET_AUDIT_GAPS_H
#define TET_AUDIT_GAPS_H

#include "audit/chain.h"
#include "audit/outline.h"
#include "audit/ways.h"

/* What the parts of the audit that look at the PLS work on. */
typedef struct tet_pls_view {
  tet_ctx *ctx;
  const tet_pls *pls;
  const tet_mesh *mesh;
  const tet_ways *ways;
  const tet_facet_view *facet; /* [n_facets] */
  uint8_t *bad;                /* [n_facets] out: 1: the facet of that number is not covered as it should be */
} tet_pls_view;

/* `missing`, reduced: the border of the facets less that of what covers them, so that what is not
 * covered lies on the left of each link, and what is covered too much on the right. Sets bad[f] unless
 * what is not covered is outside the mesh, and what is too much may be there: a share of a hole (A.1.2)
 * that others' segments part from its seed, or what a facet made of segments alone encloses. */
tet_status tet_judge_gaps(const tet_pls_view *view, const tet_chain *missing);

/* Counts the loose segments, and polygons of two vertices, that the mesh's segments do not cover as far as the
 * mesh reaches. */
tet_status tet_judge_segments(const tet_pls_view *view, uint64_t *ret_count);

#endif
