// SPDX-License-Identifier: Apache-2.0
/* point_sets.h: families of points for benchmarks and property tests, the same on
 * every machine for one seed. */
#ifndef TETRAD_SUPPORT_POINT_SETS_H
#define TETRAD_SUPPORT_POINT_SETS_H

#include <stdint.h>

/* Returns about n points [*ret_n][3] of a family, to be freed by the caller; NULL where the
 * family is unknown or there is no memory. In a random order but for `grid`. Families:
 *   cube      uniform in the unit cube
 *   clusters  Gaussian clusters, 1000 points each, of deviation 0.002 around uniform centres
 *   planes    uniform on three orthogonal unit squares that cross in their middles
 *   grid      integer points of a cube of floor(cbrt(n)) to a side, row after row
 *   lattice   the same scaled to the unit cube: coordinates rounded, shuffled
 *   sphere    on the unit sphere, rounded
 *   circle    half of them evenly on a line, half on a circle around it */
double *point_set(const char *family, uint32_t n, uint64_t seed, uint32_t *ret_n);

/* The names above, ending with NULL. */
extern const char *const point_set_families[];

/* The next number of a stream (splitmix64), and one in [0, 1). */
uint64_t point_set_next(uint64_t *state);
double point_set_uniform(uint64_t *state);

#endif
