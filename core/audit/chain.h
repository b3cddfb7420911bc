// SPDX-License-Identifier: Apache-2.0
/* chain.h: 1-chains of straight links between input vertices, one chain a facet. */
#ifndef TET_AUDIT_CHAIN_H
#define TET_AUDIT_CHAIN_H

#include "base/context.h"

/* `n` times the way from vertex `from` straight to vertex `to`. */
typedef struct tet_link {
  uint32_t facet, from, to;
  int32_t n;
} tet_link;

typedef struct tet_chain {
  tet_link *link;
  size_t n, cap;
} tet_chain;

/* Appends a link. */
tet_status tet_chain_add(tet_ctx *ctx, tet_chain *chain, uint32_t facet, uint32_t from, uint32_t to, int32_t n);

/* Adds up, exactly, what links of one facet lie on each other, wholly or in part: what is left
 * are links that overlap in none, none of them 0, sorted by facet. A chain whose links cancel
 * becomes empty, however they are cut. `points` as in tet_mesh; vertices have distinct places.
 * n log n, where links on one line are few or follow each other. */
tet_status tet_chain_reduce(tet_ctx *ctx, const double *points, uint32_t n_facets, tet_chain *chain);

/* A key that orders as the number does. */
uint64_t tet_ordered_bits(double x);

/* 1 if b and c lie in exactly the same direction from a. */
int tet_same_direction(const double *a, const double *b, const double *c);

void tet_chain_free(tet_ctx *ctx, tet_chain *chain);

#endif
