// SPDX-License-Identifier: Apache-2.0
// Delaunay tetrahedralization of random points: one line with the tetrahedra and
// the seconds of each stage.  With a file name the points are written there as a
// .node file first, for the peers.
//
//   bench_delaunay POINTS SEED [FILE.node]

#include "random_points.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <tet/engine.h>

static int write_node(const char *path, const double *points, uint32_t n) {
  FILE *f = fopen(path, "w");
  if (f == NULL) {
    perror(path);
    return 1;
  }
  fprintf(f, "%" PRIu32 " 3 0 0\n", n);
  for (uint32_t i = 0; i < n; ++i) {
    const double *p = points + 3 * (size_t)i;
    fprintf(f, "%" PRIu32 " %.17g %.17g %.17g\n", i, p[0], p[1], p[2]);
  }
  return fclose(f) == 0 ? 0 : 1;
}

int main(int argc, char **argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: bench_delaunay POINTS SEED [FILE.node]\n");
    return 2;
  }
  const uint32_t n = (uint32_t)strtoul(argv[1], NULL, 10);
  double *points = random_points(n, strtoull(argv[2], NULL, 10));
  if (argc > 3 && write_node(argv[3], points, n) != 0) {
    return 1;
  }

  tet_options options;
  tet_options_default(&options);
  options.stage = TET_STAGE_DELAUNAY;
  const tet_pls pls = {.n_points = n, .points = points, .n_loose_points = TET_LOOSE_ALL_UNUSED};
  tet_ctx *ctx = NULL;
  tet_mesh *mesh = NULL;
  if (tet_ctx_create(NULL, &ctx) != TET_OK) {
    fprintf(stderr, "bench_delaunay: no memory\n");
    return 1;
  }
  if (tet_mesh_pls(ctx, &pls, &options, &mesh) != TET_OK) {
    fprintf(stderr, "bench_delaunay: %s\n", tet_ctx_error(ctx)->message);
    tet_ctx_free(ctx);
    return 1;
  }
  printf("tetrahedra %" PRIu32 " peak_bytes %" PRIu64, mesh->n_tetrahedra, mesh->report.peak_bytes);
  for (uint32_t i = 0; i < mesh->report.n_stages; ++i) {
    printf(" %s %.4f", mesh->report.stages[i].name, mesh->report.stages[i].seconds);
  }
  printf("\n");
  tet_mesh_free(mesh);
  tet_ctx_free(ctx);
  free(points);
  return 0;
}
