// SPDX-License-Identifier: Apache-2.0
/* mesh_view.h: the mesh array set as typed pointers, for the writers. */
#ifndef TETRAD_FORMATS_MESH_VIEW_H
#define TETRAD_FORMATS_MESH_VIEW_H

#include <stdint.h>
#include <stdio.h>

#include "clients/formats/format.h"

/* Pointers into the set; NULL (and 0 rows) where an array is absent. */
typedef struct tf_mesh {
    uint64_t n_points, n_attributes, n_tetrahedra, n_subfaces, n_subsegments, n_regions;
    const double *points, *point_attributes, *region_attributes;
    const int32_t *point_markers, *subface_markers, *subsegment_markers, *region_markers;
    const uint8_t *point_origin;
    const uint32_t *tetrahedra, *tetrahedron_regions, *neighbours, *subfaces, *subsegments;
    uint64_t n_cells, n_edges, n_voronoi_points, n_voronoi_faces; /* of the dual */
    const uint32_t *cell_vertices, *cell_regions, *edge_vertices, *edge_regions;
    const double *cell_volumes, *edge_factors, *subface_shares, *voronoi_points;
    const uint32_t *voronoi_face_start, *voronoi_face_points, *voronoi_face_cells;
} tf_mesh;

/* The arrays of the dual are all there with their factors, or with the diagram too, or all
 * NULL. Errors: TF_E_MALFORMED (points or tetrahedra are absent, an index is out of range). */
tf_status tf_mesh_view(const tp_arrays *set, const char *path, tf_mesh *ret_mesh, tf_error *error);

/* The region's attribute (or marker, where attributes are absent) of tetrahedron t. */
double tf_region_attribute(const tf_mesh *mesh, uint64_t t);
int32_t tf_region_marker(const tf_mesh *mesh, uint64_t t);

/* The marker of a row of the region table; 0 where there is none. */
int32_t tf_marker_of(const tf_mesh *mesh, uint32_t region);

/* Circumradius over shortest edge (thesis 3.2.1), in doubles. */
double tf_radius_edge(const tf_mesh *mesh, uint64_t t);

/* The smallest dihedral angle, in degrees. */
double tf_least_dihedral(const tf_mesh *mesh, uint64_t t);

/* The writers: text or bytes to `file`; write errors show in its error flag. */
void tf_write_node(FILE *file, const tf_mesh *mesh, int first);
void tf_write_ele(FILE *file, const tf_mesh *mesh, int first);
void tf_write_face(FILE *file, const tf_mesh *mesh, int first);
void tf_write_edge(FILE *file, const tf_mesh *mesh, int first);
void tf_write_neigh(FILE *file, const tf_mesh *mesh, int first);
void tf_write_volumes(FILE *file, const tf_mesh *mesh, int first);
void tf_write_factors(FILE *file, const tf_mesh *mesh, int first);
void tf_write_shares(FILE *file, const tf_mesh *mesh, int first);
void tf_write_voronoi_node(FILE *file, const tf_mesh *mesh, int first);
void tf_write_medit(FILE *file, const tf_mesh *mesh);
void tf_write_off(FILE *file, const tf_mesh *mesh);
tf_status tf_write_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error);

/* The faces of every cell: face[start[c]] .. face[start[c + 1] - 1] are, times two, polygons,
 * and odd where the cell is on their second side. To be freed with free. Errors: TF_E_MEMORY. */
tf_status tf_voronoi_cells(const tf_mesh *mesh, uint64_t **ret_start, uint64_t **ret_face,
                           tf_error *error);

/* The polyhedra of the Voronoi diagram. Errors: TF_E_MEMORY. */
tf_status tf_write_voronoi_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error);

/* TetGen's .v.edge, .v.face and .v.cell, whose numbers depend on each other. Errors: TF_E_MEMORY. */
tf_status tf_write_voronoi(FILE *edge, FILE *face, FILE *cell, const tf_mesh *mesh, int first, tf_error *error);

#endif
