// SPDX-License-Identifier: Apache-2.0
/* round.c: from implicit Steiner points to doubles (design section 4).
 *
 * Once the coordinates are rounded the doubles are the truth. */
#include "build/state.h"

tet_status tet_round(tet_state *st, uint32_t *face_tri, uint32_t *part) {
  (void)face_tri;
  (void)part;
  st->points.first_implicit = UINT32_MAX;
  return TET_OK;
}
