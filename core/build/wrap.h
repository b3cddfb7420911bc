// SPDX-License-Identifier: Apache-2.0
/* wrap.h: constrained Delaunay tetrahedralization of a polyhedron by gift wrapping. */
#ifndef TET_BUILD_WRAP_H
#define TET_BUILD_WRAP_H

#include "base/context.h"
#include "exact/points.h"

/* A face of the polyhedron, or of what is still empty of it: v positive towards the
 * inside. `tag` is the caller's, or 4k+i of a made tetrahedron: then `made` is 1. */
typedef struct tet_front {
  uint32_t v[3], tag;
  int made;
} tet_front;

typedef struct tet_wrap {
  tet_ctx *ctx;
  const tet_points *points;
  tet_front *front;        /* in: the polyhedron's faces, slits twice; empty when done */
  size_t n_front, cap_front;
  uint32_t *vertex;        /* in: its vertices */
  size_t n_vertex;
  uint32_t (*made)[4];     /* out: positive tetrahedra */
  uint32_t (*link)[4];     /* out: 4k+i of the made neighbour; bit 31 set: the caller's tag */
  size_t n_made, cap_made, cap_link;
  int (*may_be_made)(const void *user, const uint32_t t[4]); /* NULL: every positive tetrahedron */
  const void *user;
  uint8_t *tried;
  size_t cap_tried;
} tet_wrap;

#define TET_WRAP_TAG 0x80000000u

/* Fills the polyhedron. Where its edges are Delaunay as segments are after
 * SEGMENTRECOVERY, the filling exists and is unique (Shewchuk's theorem, thesis 5.2.2).
 * Elsewhere it may not exist: then *ret_filled is 0. Cost: faces times vertices and faces. */
tet_status tet_wrap_fill(tet_wrap *w, int *ret_filled);

/* Frees what the wrap made; not `vertex`. */
void tet_wrap_free(tet_wrap *w);

#endif
