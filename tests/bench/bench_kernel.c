// SPDX-License-Identifier: Apache-2.0
// The Delaunay kernel alone, on generated points.
//
//   bench_kernel FAMILY POINTS [THREADS]           CPU and wall seconds, tetrahedra, peak bytes
//   bench_kernel FAMILY POINTS 1,2,1,2             the same with each of these numbers of threads, in one
//                                                  process, so that memory's first touch is not measured
//   bench_kernel FAMILY POINTS remove COUNT        the same of removing COUNT vertices
//   bench_kernel FAMILY POINTS write FILE.f8       the points themselves, for peers
//   bench_kernel FAMILY POINTS order FILE.u4       the random order in which vertices are removed

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "exact/tally.h"
#include "mesh/delaunay.h"
#include "point_sets.h"

enum { SEED = 1 };

typedef struct clocks {
  double cpu, wall;
} clocks;

static double seconds(clockid_t id) {
  struct timespec t;
  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static clocks now(void) {
  return (clocks){seconds(CLOCK_PROCESS_CPUTIME_ID), seconds(CLOCK_MONOTONIC)};
}

static void print(const tet_complex *c, clocks start) {
  clocks end = now();
  uint32_t finite = 0;
  for (uint32_t t = 0; t < c->n_slots; t++) finite += tet_is_live(c, t) && !tet_is_ghost(c, t);
  printf("seconds %.6f wall %.6f tetrahedra %" PRIu32 " peak_bytes %" PRIu64 " bytes_per_tetrahedron %.2f\n",
         end.cpu - start.cpu, end.wall - start.wall, finite, tet_ctx_peak_bytes(c->ctx),
         (double)tet_ctx_peak_bytes(c->ctx) / finite);
}

static uint32_t *numbers(uint32_t n) {
  uint32_t *ids = malloc(((size_t)n + 1) * sizeof *ids);
  for (uint32_t i = 0; ids && i < n; i++) ids[i] = i;
  return ids;
}

static uint32_t *random_order(uint32_t n) {
  uint64_t s = 77;
  uint32_t *order = numbers(n);
  for (uint32_t i = n; order && i > 1; i--) {
    uint32_t j = (uint32_t)(point_set_next(&s) % i), swap = order[j];
    order[j] = order[i - 1];
    order[i - 1] = swap;
  }
  return order;
}

static int write_file(const char *path, const void *data, size_t size, size_t count) {
  FILE *f = fopen(path, "wb");
  if (!f || fwrite(data, size, count, f) != count) {
    perror(path);
    return 1;
  }
  return fclose(f) != 0;
}

#if TET_TALLY
static void print_tally(const struct tet_tally *tally) {
  static const char *const names[TET_TALLIED] = {"orient3d", "insphere", "orient3d_exact", "insphere_exact", "dyadic", "tie"};
  for (int i = 0; i < TET_TALLIED; i++) printf("%s %" PRIu64 " ", names[i], tally->count[i]);
  printf("\n");
}
#endif

static int run(double *x, uint32_t n, uint32_t threads, uint32_t removals) {
  static struct tet_tally tally;
  tet_points points = tet_points_explicit(x, n);
  points.tally = &tally;
  tet_complex c;
  tet_ctx *ctx;
  uint32_t *ids = numbers(n), *order = random_order(n);
  if (!ids || !order || tet_ctx_create(NULL, &ctx) != TET_OK) return 1;
  tet_complex_init(&c, ctx, &points);
  clocks start = now();
  tet_status status = tet_delaunay(&c, ids, n, threads);
  if (removals) start = now();
  for (uint32_t i = 0; i < removals && status == TET_OK; i++) status = tet_complex_remove(&c, order[i]);
  if (status == TET_OK) print(&c, start);
  else fprintf(stderr, "bench_kernel: %s\n", tet_ctx_error(ctx)->message);
#if TET_TALLY
  print_tally(&tally);
#endif
  tet_complex_free(&c);
  tet_ctx_free(ctx);
  free(ids);
  free(order);
  return status != TET_OK;
}

/* One run for each number of threads in the list. */
static int run_each(double *x, uint32_t n, char *threads) {
  int failed = 0;
  for (char *end = threads; *threads && !failed; threads = end + (*end == ',')) {
    failed = run(x, n, (uint32_t)strtoul(threads, &end, 10), 0);
    failed |= end == threads || (*end && *end != ',');
  }
  return failed;
}

int main(int argc, char **argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: bench_kernel FAMILY POINTS [THREADS[,THREADS...] | remove COUNT | write FILE | order FILE]\n");
    return 2;
  }
  uint32_t n;
  double *x = point_set(argv[1], (uint32_t)strtoul(argv[2], NULL, 10), SEED, &n);
  if (!x) {
    fprintf(stderr, "bench_kernel: no family %s\n", argv[1]);
    return 2;
  }
  int failed;
  const char *verb = argc > 4 ? argv[3] : "", *what = argc > 4 ? argv[4] : "0";
  uint32_t *order = NULL;
  if (!strcmp(verb, "write")) failed = write_file(what, x, 3 * sizeof *x, n);
  else if (!strcmp(verb, "order")) failed = !(order = random_order(n)) || write_file(what, order, sizeof *order, n);
  else if (argc == 4) failed = run_each(x, n, argv[3]);
  else failed = run(x, n, 1, (uint32_t)strtoul(what, NULL, 10));
  free(order);
  free(x);
  return failed;
}
