// SPDX-License-Identifier: Apache-2.0
/* broken.c: looks for faces of a walled complex that are not locally Delaunay (5.1.4). On
 * the sphere is not inside. Changes nothing. */
#include "exact/predicates.h"
#include "exact/quick.h"
#include "mesh/complex.h"

enum { FAR = 16, NEAR = 8 }; /* slots ahead */

/* Has the memory for slots soon to come brought near: what is beyond the faces, then the places of
 * the vertices. */
static inline void look_ahead(const tet_complex *c, uint32_t t, uint32_t end) {
  if (end - t <= FAR) return;
  const uint32_t *far = c->adj + 4 * (size_t)(t + FAR), *adj = c->adj + 4 * (size_t)(t + NEAR);
  const uint32_t *v = c->v + 4 * (size_t)(t + NEAR);
  for (int i = 0; i < 4; i++) {
    if (far[i] != TET_NONE) __builtin_prefetch(c->v + far[i]);
    if (!tet_is_live(c, t + NEAR)) continue;
    __builtin_prefetch(c->points->x + 3 * (size_t)v[i]);
    if (adj[i] != TET_NONE) __builtin_prefetch(c->points->x + 3 * (size_t)c->v[adj[i]]);
  }
}

/* Those of tetrahedron t that have the lower handle on its side; `doubtful`: and what a look does not settle. */
static inline __attribute__((always_inline)) uint32_t broken_at(const tet_complex *c, uint32_t t, tet_quick_look *look,
                                                                int doubtful) {
  const uint32_t *v = c->v + 4 * (size_t)t, *adj = c->adj + 4 * (size_t)t;
  const double *x = c->points->x, *corner[4];
  uint32_t n = 0;
  for (int i = 0; i < 4; i++) corner[i] = x + 3 * (size_t)v[i];
  for (uint32_t i = 0; i < 4; i++) {
    if (c->wall[t] >> i & 1 || adj[i] < 4 * t + i) continue;
    uint32_t apex = c->v[adj[i]];
    int sign = look(corner[0], corner[1], corner[2], corner[3], x + 3 * (size_t)apex, c->points->grain5);
    if (doubtful) sign = sign >= 0;
    else if (sign == TET_UNSURE) sign = tet_insphere(c->points, v[0], v[1], v[2], v[3], apex);
    n += sign > 0;
  }
  return n;
}

static uint64_t broken_in(const tet_complex *c, uint32_t from, uint32_t end) {
  uint64_t n = 0;
  for (uint32_t t = from; t < end; t++) {
    look_ahead(c, t, end);
    if (tet_is_live(c, t)) n += broken_at(c, t, tet_quick_insphere, 0);
  }
  return n;
}

#if TET_HAVE_AVX2
TET_AVX2 static uint64_t broken_in_avx2(const tet_complex *c, uint32_t from, uint32_t end) {
  uint64_t n = 0;
  for (uint32_t t = from; t < end; t++) {
    look_ahead(c, t, end);
    if (tet_is_live(c, t)) n += broken_at(c, t, tet_quick_insphere_avx2, 0);
  }
  return n;
}
#endif

static uint32_t doubtful_from(const tet_complex *c, uint32_t t) {
  while (t < c->n_slots && !(tet_is_live(c, t) && broken_at(c, t, tet_quick_insphere, 1))) look_ahead(c, ++t, c->n_slots);
  return t;
}

#if TET_HAVE_AVX2
TET_AVX2 static uint32_t doubtful_from_avx2(const tet_complex *c, uint32_t t) {
  while (t < c->n_slots && !(tet_is_live(c, t) && broken_at(c, t, tet_quick_insphere_avx2, 1)))
    look_ahead(c, ++t, c->n_slots);
  return t;
}
#else
#define doubtful_from_avx2 doubtful_from
#endif

uint32_t tet_complex_next_doubtful(const tet_complex *c, uint32_t t) {
  return TET_HAVE_AVX2 && tet_has_avx2() ? doubtful_from_avx2(c, t) : doubtful_from(c, t);
}

tet_status tet_complex_count_broken(const tet_complex *c, uint64_t *ret_n) {
  enum { BLOCK = 4096 };
  uint64_t n = 0;
  for (uint32_t from = 0; from < c->n_slots; from += BLOCK) {
    uint32_t end = c->n_slots - from < BLOCK ? c->n_slots : from + BLOCK;
#if TET_HAVE_AVX2
    n += tet_has_avx2() ? broken_in_avx2(c, from, end) : broken_in(c, from, end);
#else
    n += broken_in(c, from, end);
#endif
    tet_status status = tet_poll(c->ctx);
    if (status != TET_OK) return status;
  }
  *ret_n = n;
  return TET_OK;
}
