// SPDX-License-Identifier: Apache-2.0
/* location.c: finding the place of a vertex by walking through the complex.
 *
 * A visibility walk that remembers where it came from (Devillers, Pion, Teillaud 2002). It
 * goes by rounded signs first, as a conflict is all that insertion needs and is decided
 * exactly; where these lead astray, the exact walk goes on from there. */
#include "exact/predicates.h"
#include "exact/quick.h"
#include "mesh/complex.h"

/* Steps after which the rough walk is given up: more than any sensible one takes. */
enum { ROUGH_STEPS = 1 << 14 };

static inline uint32_t next_random(uint32_t *state) {
  uint32_t x = *state;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  return *state = x;
}

/* The finite tetrahedron from which to walk; a ghost where that is another thread's. */
static uint32_t start(const tet_complex *c, uint32_t from) {
  uint32_t t = from != TET_NONE ? from : c->last;
  if (!tet_is_ghost(c, t)) return t;
  uint32_t inner = c->adj[4 * (size_t)t + 3] >> 2;
  return c->mine[tet_flag(c, inner)] ? inner : t;
}

uint32_t tet_complex_approach(tet_complex *c, uint32_t from, uint32_t p) {
  const double *x = c->points->x, *xp = x + 3 * (size_t)p;
  uint32_t t = start(c, from), entered = 4;
  for (int steps = 0; steps < ROUGH_STEPS && !tet_is_ghost(c, t); steps++) {
    const uint32_t *v = c->v + 4 * (size_t)t, *adj = c->adj + 4 * (size_t)t;
    uint32_t i = 0;
    for (; i < 4; i++) {
      const uint8_t *f = tet_face[i];
      if (i == entered) continue;
      if (tet_rough_orient3d(x + 3 * (size_t)v[f[0]], x + 3 * (size_t)v[f[1]], x + 3 * (size_t)v[f[2]], xp) > 0 &&
          c->mine[tet_flag(c, adj[i] >> 2)]) break;
    }
    if (i == 4) break;
    t = adj[i] >> 2;
    entered = adj[i] & 3;
  }
  return t;
}

/* Which face of t the walk leaves through, or 4 when p is in the closure. The
 * first face looked at is random: a visibility walk may cycle once facets are
 * in, a random one ends. */
static int leave_through(tet_complex *c, uint32_t t, uint32_t p, int entered) {
  uint32_t first = next_random(&c->random);
  const uint32_t *v = c->v + 4 * (size_t)t;
  for (uint32_t k = 0; k < 4; k++) {
    int i = (int)((first + k) & 3);
    if (i == entered) continue;
    const uint8_t *f = tet_face[i];
    if (tet_orient3d(c->points, v[f[0]], v[f[1]], v[f[2]], p) > 0) return i;
  }
  return 4;
}

tet_status tet_complex_locate(tet_complex *c, uint32_t from, uint32_t p, uint32_t *ret_t) {
  uint32_t t = start(c, from);
  int entered = 4;
  for (uint64_t steps = 0; steps < (uint64_t)1 << 34; steps++) {
    int i = leave_through(c, t, p, entered);
    if (i == 4) break;
    uint32_t h = c->adj[4 * (size_t)t + i];
    t = h >> 2;
    entered = (int)(h & 3);
    if (tet_is_ghost(c, t)) break;
    if ((steps & 1023) == 1023) {
      tet_status status = tet_poll(c->ctx);
      if (status != TET_OK) return status;
    }
  }
  c->last = t;
  *ret_t = t;
  return TET_OK;
}
