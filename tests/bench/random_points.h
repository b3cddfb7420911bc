// SPDX-License-Identifier: Apache-2.0
/* random_points.h: the benchmarks' input: points in the unit cube, the same on
 * every machine for one seed. */
#ifndef TETRAD_BENCH_RANDOM_POINTS_H
#define TETRAD_BENCH_RANDOM_POINTS_H

#include <stdint.h>

/* Returns n points [n][3], uniform in the unit cube, to be freed by the caller;
 * ends the program without memory. */
double *random_points(uint32_t n, uint64_t seed);

#endif
