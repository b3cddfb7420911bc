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
} tf_mesh;

/* Errors: TF_E_MALFORMED (points or tetrahedra are absent, an index is out of range). */
tf_status tf_mesh_view(const tp_arrays *set, const char *path, tf_mesh *ret_mesh, tf_error *error);

/* The region's attribute (or marker, where attributes are absent) of tetrahedron t. */
double tf_region_attribute(const tf_mesh *mesh, uint64_t t);
int32_t tf_region_marker(const tf_mesh *mesh, uint64_t t);

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
void tf_write_medit(FILE *file, const tf_mesh *mesh);
void tf_write_off(FILE *file, const tf_mesh *mesh);
tf_status tf_write_vtu(FILE *file, const tf_mesh *mesh, const char *path, tf_error *error);

#endif
