// SPDX-License-Identifier: Apache-2.0
/* pieces.c: frees the mesh between two stages. */
#include "mesh/pieces.h"

#include <string.h>

void tet_pieces_free(tet_ctx *ctx, tet_pieces *p) {
  void *all[] = {p->points,  p->origin, p->carrier,        p->tets,          p->adj,
                 p->region,  p->subface, p->subface_facet, p->subseg,        p->subseg_segment,
                 p->segment, p->facet,  p->region_marker,  p->region_attribute, p->region_max_volume};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
  memset(p, 0, sizeof *p);
}
