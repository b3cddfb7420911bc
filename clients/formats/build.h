// SPDX-License-Identifier: Apache-2.0
/* build.h: a PLS growing while it is read, row by row.
 *
 * What a reader appends is turned into the array set of the schema at the end. */
#ifndef TETRAD_FORMATS_BUILD_H
#define TETRAD_FORMATS_BUILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/formats/format.h"

/* Growable items of one size. */
typedef struct tf_list {
    unsigned char *data;
    size_t count, capacity;
} tf_list;

typedef struct tf_build {
    size_t n_attributes;
    bool surface; /* a surface format: vertices that nothing uses are no part of the PLS */
    tf_list points, point_attributes, point_markers; /* f8 x 3, f8 (flat), i4 */
    tf_list polygon_vertices, polygon_start;         /* u4, u4 */
    tf_list facet_start, facet_markers;              /* u4, i4 */
    tf_list facet_holes, facet_hole_start;           /* f8 x 3, u4 */
    tf_list segments, segment_markers;               /* u4 x 2, i4 */
    tf_list holes;                                   /* f8 x 3 */
    tf_list region_seeds, region_attributes, region_max_volumes; /* f8 x 3, f8, f8 */
    bool no_memory;
} tf_build;

void tf_build_free(tf_build *build);

void tf_build_point(tf_build *build, const double place[3]);
void tf_build_attribute(tf_build *build, double value);
void tf_build_point_marker(tf_build *build, int32_t marker);
void tf_build_polygon_vertex(tf_build *build, uint32_t vertex);
void tf_build_polygon_end(tf_build *build);
void tf_build_facet_hole(tf_build *build, const double place[3]);
/* Ends the facet of the polygons and holes since the last one. */
void tf_build_facet_end(tf_build *build, int32_t marker);
void tf_build_segment(tf_build *build, uint32_t a, uint32_t b, int32_t marker);
void tf_build_hole(tf_build *build, const double place[3]);
/* max_volume <= 0: none. */
void tf_build_region(tf_build *build, const double seed[3], double attribute, double max_volume);

/* Moves everything into *ret_arrays. Errors: TF_E_MEMORY (also from earlier calls). */
tf_status tf_build_finish(tf_build *build, tp_arrays *ret_arrays, tf_error *error);

#endif
