// SPDX-License-Identifier: Apache-2.0
// Uniform points by splitmix64 (Steele, Lea, Flood 2014).

#include "random_points.h"

#include <stdio.h>
#include <stdlib.h>

double *random_points(uint32_t n, uint64_t seed) {
  double *points = malloc((size_t)n * 3 * sizeof *points);
  if (points == NULL) {
    perror("random_points");
    exit(1);
  }
  for (size_t i = 0; i < (size_t)n * 3; ++i) {
    uint64_t z = (seed += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    points[i] = (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  return points;
}
