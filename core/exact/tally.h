// SPDX-License-Identifier: Apache-2.0
// How often each stage of the predicates was asked and how often it knew the answer, counted in
// builds with -DTET_TALLY=1 (a debug build) into what tet_points.tally points to. Elsewhere
// nothing of it is left.
#ifndef TETRAD_CORE_EXACT_TALLY_H
#define TETRAD_CORE_EXACT_TALLY_H

#include "exact/points.h"

#ifndef TET_TALLY
#define TET_TALLY 0
#endif

typedef enum tet_tallied {
  TET_TALLIED_ORIENT3D,       /* asked of the first look */
  TET_TALLIED_INSPHERE,
  TET_TALLIED_ORIENT3D_EXACT, /* of these not known by it */
  TET_TALLIED_INSPHERE_EXACT,
  TET_TALLIED_DYADIC,         /* of these not on the grid of the second stage */
  TET_TALLIED_TIE,            /* cospherical, decided by the perturbation */
  TET_TALLIED
} tet_tallied;

struct tet_tally {
  _Atomic uint64_t count[TET_TALLIED];
};

static inline void tet_count(const tet_points *p, tet_tallied what) {
#if TET_TALLY
  if (p && p->tally)
    __atomic_fetch_add((uint64_t *)&p->tally->count[what], 1, __ATOMIC_RELAXED);
#else
  (void)p;
  (void)what;
#endif
}

#endif
