// SPDX-License-Identifier: Apache-2.0
#include "solids.h"

#include "exact/predicates.h"

#include <math.h>
#include <string.h>

void solid_prism(solid *s, uint32_t n, const double base[][2], double height, const double turn[2]) {
  memset(s, 0, sizeof *s);
  double c0 = cos(turn[0]), s0 = sin(turn[0]), c1 = cos(turn[1]), s1 = sin(turn[1]);
  for (uint32_t i = 0; i < 2 * n; i++) {
    double x = base[i % n][0], y = base[i % n][1], z = i < n ? 0 : height;
    double u = c0 * x - s0 * y, v = s0 * x + c0 * y;
    s->points[i][0] = u;
    s->points[i][1] = c1 * v - s1 * z;
    s->points[i][2] = s1 * v + c1 * z;
  }
  uint32_t m = 0, p = 0;
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t quad[4] = {i, (i + 1) % n, (i + 1) % n + n, i + n};
    s->polygon_start[p++] = m;
    memcpy(s->polygon_vertices + m, quad, sizeof quad);
    m += 4;
  }
  for (uint32_t end = 0; end < 2; end++) {
    s->polygon_start[p++] = m;
    for (uint32_t i = 0; i < n; i++) s->polygon_vertices[m++] = i + end * n;
  }
  s->polygon_start[p] = m;
  s->pls = (tet_pls){.n_points = 2 * n, .points = s->points[0], .n_facets = p, .n_polygons = p,
                     .polygon_start = s->polygon_start, .polygon_vertices = s->polygon_vertices};
}

void solid_regular(solid *s, uint32_t n, double height, const double turn[2]) {
  double base[SOLID_SIDES][2];
  for (uint32_t i = 0; i < n; i++) {
    base[i][0] = cos(2 * M_PI * i / n);
    base[i][1] = sin(2 * M_PI * i / n);
  }
  solid_prism(s, n, base, height, turn);
}

void solid_wedge(solid *s, double degrees, double height) {
  static const double unturned[2] = {0, 0};
  double half = degrees * M_PI / 360;
  const double base[3][2] = {{0, 0}, {cos(half), -sin(half)}, {cos(half), sin(half)}};
  solid_prism(s, 3, base, height, unturned);
}

void solid_pyramid(solid *s, uint32_t n, double degrees) {
  double radius = sin(degrees * M_PI / 360) / sin(M_PI / n), height = sqrt(1 - radius * radius);
  memset(s, 0, sizeof *s);
  uint32_t m = 0;
  for (uint32_t i = 0; i < n; i++) {
    double out = radius * (1 + 0.01 * sin(7.3 * i));
    const double x[3] = {out * cos(2 * M_PI * i / n), out * sin(2 * M_PI * i / n), -height};
    const uint32_t side[3] = {0, 1 + i, 1 + (i + 1) % n};
    memcpy(s->points[1 + i], x, sizeof x);
    s->polygon_start[i] = m;
    memcpy(s->polygon_vertices + m, side, sizeof side);
    m += 3;
  }
  s->polygon_start[n] = m;
  for (uint32_t i = 0; i < n; i++) s->polygon_vertices[m++] = 1 + i;
  s->polygon_start[n + 1] = m;
  for (int k = 0; k < 3; k++) s->points[n + 1][k] = (k < 2 ? 0.27 : 0.3) * s->points[1][k];
  s->points[n + 1][2] -= 0.006;
  s->pls = (tet_pls){.n_points = n + 2, .points = s->points[0], .n_facets = n + 1, .n_polygons = n + 1,
                     .polygon_start = s->polygon_start, .polygon_vertices = s->polygon_vertices};
}

tet_status solid_build(tet_ctx *ctx, const solid *s, tet_build_result *ret) {
  const tet_build_options how = {.stage = TET_STAGE_CDT};
  return tet_build(ctx, &s->pls, &how, ret);
}

static int is_subface(const tet_pieces *p, const uint32_t *t, uint32_t i) {
  for (uint32_t s = 0; s < p->n_subfaces; s++) {
    int n = 0;
    for (uint32_t j = 0; j < 4; j++)
      for (int k = 0; k < 3; k++) n += j != i && t[j] == p->subface[3 * s + k];
    if (n == 3) return 1;
  }
  return 0;
}

const char *pieces_fault(const tet_pieces *p) {
  const tet_points points = {.x = p->points, .n = p->n_points, .first_implicit = UINT32_MAX};
  for (uint32_t t = 0; t < p->n_tets; t++) {
    const uint32_t *v = p->tets + 4 * t;
    if (tet_orient3d(&points, v[0], v[1], v[2], v[3]) <= 0) return "a tetrahedron is not positive";
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t h = p->adj[4 * t + i];
      if (h == TET_NONE) {
        if (!is_subface(p, v, i)) return "a boundary face is no subface";
        continue;
      }
      if (h >= 4 * p->n_tets || p->adj[h] != 4 * t + i) return "adjacency goes one way";
      if (tet_insphere(&points, v[0], v[1], v[2], v[3], p->tets[h]) > 0 && !is_subface(p, v, i))
        return "a face is not locally Delaunay";
    }
  }
  return NULL;
}

double pieces_volume(const tet_pieces *p) {
  double sum = 0;
  for (uint32_t t = 0; t < p->n_tets; t++) {
    const double *x[4];
    double d[3][3];
    for (int k = 0; k < 4; k++) x[k] = p->points + 3 * (size_t)p->tets[4 * t + k];
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 3; i++) d[k][i] = x[k + 1][i] - x[0][i];
    for (int i = 0; i < 3; i++)
      sum += d[0][i] * (d[1][(i + 1) % 3] * d[2][(i + 2) % 3] - d[1][(i + 2) % 3] * d[2][(i + 1) % 3]) / 6;
  }
  return sum;
}
