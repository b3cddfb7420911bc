// SPDX-License-Identifier: Apache-2.0
/* point_sets.c: see the header. Random numbers by splitmix64 (Steele, Lea, Flood 2014). */
#include "point_sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const point_set_families[] = {"cube", "clusters", "planes", "grid", "lattice", "sphere", "circle", NULL};

uint64_t point_set_next(uint64_t *state) {
  uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

double point_set_uniform(uint64_t *state) { return (double)(point_set_next(state) >> 11) * 0x1p-53; }

/* Box and Muller's pair, one of it. */
static double gaussian(uint64_t *s) {
  double r = sqrt(-2 * log(1 - point_set_uniform(s)));
  return r * cos(6.283185307179586 * point_set_uniform(s));
}

static void clusters(double *x, uint32_t n, uint64_t *s) {
  double centre[3] = {0, 0, 0};
  for (uint32_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      if (i % 1000 == 0) centre[k] = point_set_uniform(s);
      x[3 * (size_t)i + k] = centre[k] + 0.002 * gaussian(s);
    }
}

static void planes(double *x, uint32_t n, uint64_t *s) {
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < 3; k++) x[3 * (size_t)i + k] = k == i % 3 ? 0.5 : point_set_uniform(s);
}

static void grid(double *x, uint32_t side, double step) {
  for (uint32_t i = 0; i < side; i++)
    for (uint32_t j = 0; j < side; j++)
      for (uint32_t k = 0; k < side; k++, x += 3) {
        x[0] = i * step;
        x[1] = j * step;
        x[2] = k * step;
      }
}

static void sphere(double *x, uint32_t n, uint64_t *s) {
  for (uint32_t i = 0; i < n; i++, x += 3) {
    double r;
    for (int k = 0; k < 3; k++) x[k] = gaussian(s);
    r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int k = 0; k < 3; k++) x[k] /= r;
  }
}

static void circle(double *x, uint32_t n) {
  uint32_t half = n / 2;
  for (uint32_t i = 0; i < n; i++, x += 3) {
    double at = i < half ? (i + 0.5) / half : 6.283185307179586 * (i - half) / (n - half);
    x[0] = i < half ? 0 : cos(at);
    x[1] = i < half ? 0 : sin(at);
    x[2] = i < half ? 2 * at - 1 : 0;
  }
}

static void shuffle(double *x, uint32_t n, uint64_t *s) {
  for (uint32_t i = n; i > 1; i--) {
    uint32_t j = (uint32_t)(point_set_next(s) % i);
    for (int k = 0; k < 3; k++) {
      double swap = x[3 * (size_t)j + k];
      x[3 * (size_t)j + k] = x[3 * (size_t)(i - 1) + k];
      x[3 * (size_t)(i - 1) + k] = swap;
    }
  }
}

double *point_set(const char *family, uint32_t n, uint64_t seed, uint32_t *ret_n) {
  uint64_t s = seed;
  uint32_t side = (uint32_t)cbrt(n + 0.5);
  int is_grid = !strcmp(family, "grid"), is_lattice = !strcmp(family, "lattice");
  if (is_grid || is_lattice) n = side * side * side;
  double *x = malloc(((size_t)n + 1) * 3 * sizeof *x);
  if (!x) return NULL;
  if (!strcmp(family, "cube")) {
    for (size_t i = 0; i < 3 * (size_t)n; i++) x[i] = point_set_uniform(&s);
  } else if (!strcmp(family, "clusters")) {
    clusters(x, n, &s);
  } else if (!strcmp(family, "planes")) {
    planes(x, n, &s);
  } else if (is_grid || is_lattice) {
    grid(x, side, is_grid || side < 2 ? 1 : 1.0 / (side - 1));
  } else if (!strcmp(family, "sphere")) {
    sphere(x, n, &s);
  } else if (!strcmp(family, "circle")) {
    circle(x, n);
  } else {
    free(x);
    return NULL;
  }
  if (!is_grid) shuffle(x, n, &s);
  *ret_n = n;
  return x;
}
