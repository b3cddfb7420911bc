// SPDX-License-Identifier: Apache-2.0
/* mesh.c: frees a finished mesh. */
#include "base/context.h"

#include <tet/mesh.h>

void tet_mesh_free(tet_mesh *mesh) {
  if (!mesh) return;
  tet_ctx *ctx = mesh->ctx;
  void *all[] = {mesh->points, mesh->point_attributes, mesh->point_markers, mesh->point_origin, mesh->point_same_as,
                 mesh->tetrahedra, mesh->tetrahedron_regions, mesh->neighbours, mesh->facet_same_as, mesh->subfaces,
                 mesh->subface_facets,
                 mesh->subface_markers, mesh->subsegments, mesh->subsegment_segments, mesh->subsegment_markers,
                 mesh->region_markers, mesh->region_attributes, mesh->region_max_volumes, mesh->exception_tetrahedra,
                 mesh->exception_radius_edge, mesh->exception_segments, mesh->sliver_tetrahedra,
                 mesh->sliver_cosines, mesh->sliver_segments, mesh->cell_vertices, mesh->cell_regions,
                 mesh->cell_volumes, mesh->edge_vertices, mesh->edge_regions, mesh->edge_factors, mesh->subface_shares,
                 mesh->voronoi_points, mesh->voronoi_face_start, mesh->voronoi_face_points, mesh->voronoi_face_cells,
                 mesh};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(ctx, all[i]);
}
