// SPDX-License-Identifier: Apache-2.0
/* pieces.h: a mesh between two stages: all coordinates doubles, outside gone.
 *
 * What the CDT hands to refinement, and refinement to the output. Plain arrays
 * under the context's budget; no stage keeps private state in it.
 *
 * One positive tetrahedron, v0..v3, seen with v3 towards the reader's back:
 *
 *            v2
 *           /|\          face i is opposite vertex i; outward, right-handed:
 *          / | \           0: v1 v2 v3    1: v0 v3 v2
 *         /  |  \          2: v0 v1 v3    3: v0 v2 v1
 *       v0---+---v1      orient3d(v0,v1,v2,v3) > 0
 *         \  |  /
 *          \ | /         adj[4t+i] = 4t'+i': tetrahedron t' beyond face i, and
 *            v3          the number i' of the same face there; TET_NONE: boundary
 */
#ifndef TET_MESH_PIECES_H
#define TET_MESH_PIECES_H

#include "base/context.h"

#include <tet/mesh.h>
#include <tet/pls.h>

/* The vertices of face i, outward for a positive tetrahedron. */
extern const uint8_t tet_face[4][3];

/* An input segment or one side of a facet, after merging: straight, between two
 * input vertices that stay. */
typedef struct tet_segment {
  uint32_t a, b;
  int32_t marker;
  uint8_t crease; /* a diagonal inside one non-planar input facet, or a side of two
                     merged by an angle: kept for exactness, no sharp segment, not
                     promised Gabriel */
  uint8_t loose;  /* bounds no facet */
} tet_segment;

/* One (merged) facet: patches of triangles in one plane. */
typedef struct tet_facet {
  uint32_t input;   /* lowest input facet in it */
  int32_t marker;
} tet_facet;

typedef struct tet_pieces {
  uint32_t n_points;
  double *points;      /* [n][3] */
  uint8_t *origin;     /* [n] tet_origin */
  uint32_t *carrier;   /* [n] of a Steiner point: its segment or its facet; else TET_NONE */
  size_t cap_points, cap_origin, cap_carrier;
  uint32_t n_input;    /* rows below are input vertices */

  uint32_t n_tets;
  uint32_t *tets;      /* [n][4] */
  uint32_t *adj;       /* [n][4] handles, see above */
  uint32_t *region;    /* [n] row of the region table */

  uint32_t n_subfaces;
  uint32_t *subface;   /* [n][3] */
  uint32_t *subface_facet; /* [n] */

  uint32_t n_subsegs;
  uint32_t *subseg;        /* [n][2] */
  uint32_t *subseg_segment; /* [n] */

  uint32_t n_segments;
  tet_segment *segment;    /* [n] */
  uint32_t n_facets;
  tet_facet *facet;        /* [n] */

  uint32_t n_regions;
  int32_t *region_marker;      /* [n] */
  double *region_attribute;    /* [n] */
  double *region_max_volume;   /* [n]; 0: none */
} tet_pieces;

/* Which corner of tetrahedron t vertex v is, which it has. */
static inline uint32_t tet_corner_of(const tet_pieces *p, uint32_t t, uint32_t v) {
  const uint32_t *w = p->tets + 4 * (size_t)t;
  return w[0] == v ? 0 : w[1] == v ? 1 : w[2] == v ? 2 : 3;
}

/* Frees all arrays of `p` and clears it. */
void tet_pieces_free(tet_ctx *ctx, tet_pieces *p);

#endif
