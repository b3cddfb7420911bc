// SPDX-License-Identifier: Apache-2.0
/* pieces.c: the faces of a tetrahedron, and freeing the mesh between two stages. */
#include "mesh/pieces.h"

#include <string.h>

const uint8_t tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

void tet_pieces_free(tet_ctx *ctx, tet_pieces *p) {
  void *all[] = {p->points,  p->origin, p->carrier,        p->tets,          p->adj,
                 p->region,  p->subface, p->subface_facet, p->subseg,        p->subseg_segment,
                 p->segment, p->facet,  p->region_marker,  p->region_attribute, p->region_max_volume};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  memset(p, 0, sizeof *p);
}
