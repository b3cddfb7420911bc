// SPDX-License-Identifier: Apache-2.0
/* readers.h: one function per format. Each appends to `build`; failures stick in
 * `text` (or go to *error). Memory failures stick in `build`. */
#ifndef TETRAD_FORMATS_READERS_H
#define TETRAD_FORMATS_READERS_H

#include "clients/formats/build.h"
#include "clients/formats/text.h"

/* What a whole PLS file tells besides its arrays: *ret_first is the first index. */
void tf_read_node_text(tf_text *text, tf_build *build, int *ret_first);
/* .poly (`polygons` per facet) and .smesh (one polygon per facet). nodes: the cursor
 * at the .node file where the point count is 0, else NULL. */
void tf_read_poly_text(tf_text *text, tf_text *nodes, bool smesh, tf_build *build, int *ret_first);
void tf_read_off_text(tf_text *text, tf_build *build);
void tf_read_obj_text(tf_text *text, tf_build *build);
void tf_read_medit_text(tf_text *text, tf_build *build);

/* These may be binary. */
tf_status tf_read_stl(const tf_file *file, tf_build *build, tf_error *error);
tf_status tf_read_ply(const tf_file *file, tf_build *build, tf_error *error);

/* Three numbers of this line. */
void tf_text_place(tf_text *text, double place[3]);

#endif
