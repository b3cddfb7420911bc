// SPDX-License-Identifier: Apache-2.0
// The payload codecs on a mesh of random points, in either order of its points:
// per codec, encoded bytes per raw byte and MB/s each way, chunk by chunk as on the
// wire.
//
//   bench_codec POINTS SEED

#include "point_sets.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tet/engine.h>
#include <time.h>

#include "protocol/codec.h"

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct totals {
  uint64_t raw, encoded;
  double encode_seconds, decode_seconds;
} totals;

// Sends one array through a codec in chunks; exits where it does not come back as it went.
static void round_trip(tp_codec codec, tp_dtype dtype, uint64_t columns, uint64_t rows, const void *data,
                       totals *sum) {
  const uint64_t step = tp_chunk_rows(dtype, columns);
  const size_t row_bytes = tp_dtype_size(dtype) * (size_t)columns;
  unsigned char *back = malloc((size_t)step * row_bytes);
  tp_bytes out = TP_BYTES_INIT;
  tp_error error;
  for (uint64_t row = 0; row < rows; row += step) {
    const uint64_t count = rows - row < step ? rows - row : step;
    const unsigned char *chunk = (const unsigned char *)data + (size_t)row * row_bytes;
    uint32_t sent = 0, received = 0;
    out.size = 0;
    const double start = now();
    const tp_code encoded = tp_encode(codec, dtype, columns, count, chunk, &out, &sent);
    const double middle = now();
    if (back == NULL || encoded != 0 ||
        tp_decode(codec, dtype, columns, count, out.data, out.size, back, &received, &error) != 0 ||
        sent != received || memcmp(back, chunk, (size_t)count * row_bytes) != 0) {
      fprintf(stderr, "bench_codec: %s does not come back\n", tp_codec_name(codec));
      exit(1);
    }
    sum->encode_seconds += middle - start;
    sum->decode_seconds += now() - middle;
    sum->raw += (uint64_t)count * row_bytes;
    sum->encoded += out.size;
  }
  tp_bytes_free(&out);
  free(back);
}

static int run(const tet_pls *pls, tet_point_order order, const char *order_name) {
  tet_options options;
  tet_options_default(&options);
  options.stage = TET_STAGE_DELAUNAY;
  options.point_order = order;
  tet_ctx *ctx = NULL;
  tet_mesh *mesh = NULL;
  if (tet_ctx_create(NULL, &ctx) != TET_OK) {
    fprintf(stderr, "bench_codec: no memory\n");
    return 1;
  }
  if (tet_mesh_pls(ctx, pls, &options, &mesh) != TET_OK) {
    fprintf(stderr, "bench_codec: %s\n", tet_ctx_error(ctx)->message);
    tet_ctx_free(ctx);
    return 1;
  }
  for (int codec = 0; codec < TP_CODECS; ++codec) {
    totals sum = {0};
    round_trip((tp_codec)codec, TP_F8, 3, mesh->n_points, mesh->points, &sum);
    round_trip((tp_codec)codec, TP_U4, 4, mesh->n_tetrahedra, mesh->tetrahedra, &sum);
    printf("%s %s raw %" PRIu64 " encoded %" PRIu64 " ratio %.4f encode_MBps %.0f decode_MBps %.0f\n",
           order_name, tp_codec_name((tp_codec)codec), sum.raw, sum.encoded,
           (double)sum.encoded / (double)sum.raw, 1e-6 * (double)sum.raw / sum.encode_seconds,
           1e-6 * (double)sum.raw / sum.decode_seconds);
  }
  tet_mesh_free(mesh);
  tet_ctx_free(ctx);
  return 0;
}

int main(int argc, char **argv) {
  if (argc != 3) {
    fprintf(stderr, "usage: bench_codec POINTS SEED\n");
    return 2;
  }
  uint32_t n = (uint32_t)strtoul(argv[1], NULL, 10);
  double *points = point_set("cube", n, strtoull(argv[2], NULL, 10), &n);
  if (points == NULL) {
    fprintf(stderr, "bench_codec: no memory\n");
    return 1;
  }
  const tet_pls pls = {.n_points = n, .points = points, .n_loose_points = TET_LOOSE_ALL_UNUSED};
  const int failed = run(&pls, TET_ORDER_HILBERT, "hilbert") || run(&pls, TET_ORDER_INPUT_FIRST, "input_first");
  free(points);
  return failed;
}
