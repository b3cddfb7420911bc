// SPDX-License-Identifier: Apache-2.0
// Fuzz target of tet_mesh_pls: bytes become a small PLS, mostly on a coarse lattice, where
// points coincide and facets touch and cross in every way. Any refusal is fine; what is
// never fine, and ends the program: an internal error, a mesh whose audit did not pass, an input
// vertex that lost its bits, memory still accounted for after the mesh is freed.
//
// Bytes: flags (stage 0-2, keep hull, neighbours, order, Voronoi cells, coordinates as doubles, break points);
// count and coordinates of points; count and polygons of facets (length, vertices);
// loose segments; holes; regions. Past the end all bytes are 0.

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tet/engine.h>

enum { MAX_POINTS = 40, MAX_FACETS = 48, MAX_CORNERS = 6, MAX_SEEDS = 3, MAX_SEGMENTS = 4 };

typedef struct reader {
  const uint8_t *at, *end;
} reader;

typedef struct input {
  tet_pls pls;
  double points[MAX_POINTS][3];
  uint32_t polygon_start[MAX_FACETS + 1];
  uint32_t polygon_vertices[MAX_FACETS * MAX_CORNERS];
  uint32_t segments[MAX_SEGMENTS][2];
  double holes[MAX_SEEDS][3];
  double regions[MAX_SEEDS][3];
} input;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static unsigned next_byte(reader *r) {
  return r->at < r->end ? *r->at++ : 0;
}

static uint32_t next_below(reader *r, uint32_t bound) {
  return next_byte(r) % bound;
}

static double next_coordinate(reader *r, int as_double) {
  if (!as_double) {
    return (double)next_below(r, 16);
  }
  uint8_t bytes[8];
  double x;
  for (int i = 0; i < 8; ++i) {
    bytes[i] = (uint8_t)next_byte(r);
  }
  memcpy(&x, bytes, sizeof x);
  return x;
}

// A seed in the middle of a lattice cell.
static void next_seed(reader *r, double seed[3]) {
  for (int i = 0; i < 3; ++i) {
    seed[i] = (double)next_below(r, 16) + 0.5;
  }
}

static void read_input(reader *r, unsigned flags, input *in) {
  tet_pls *pls = &in->pls;
  pls->n_points = next_below(r, MAX_POINTS + 1);
  for (uint32_t i = 0; i < pls->n_points; ++i) {
    for (int j = 0; j < 3; ++j) {
      in->points[i][j] = next_coordinate(r, (flags & 64U) != 0);
    }
  }
  pls->n_facets = pls->n_polygons = next_below(r, MAX_FACETS + 1);
  uint32_t n = 0;
  for (uint32_t f = 0; f < pls->n_facets; ++f) {
    const uint32_t corners = 1 + next_below(r, MAX_CORNERS);
    in->polygon_start[f] = n;
    for (uint32_t i = 0; i < corners; ++i) {
      in->polygon_vertices[n++] = next_byte(r);  // also past the points
    }
  }
  in->polygon_start[pls->n_facets] = n;
  pls->n_segments = next_below(r, MAX_SEGMENTS + 1);
  for (uint32_t s = 0; s < pls->n_segments; ++s) {
    in->segments[s][0] = next_byte(r);
    in->segments[s][1] = next_byte(r);
  }
  pls->n_holes = next_below(r, MAX_SEEDS + 1);
  for (uint32_t i = 0; i < pls->n_holes; ++i) {
    next_seed(r, in->holes[i]);
  }
  pls->n_regions = next_below(r, MAX_SEEDS + 1);
  for (uint32_t i = 0; i < pls->n_regions; ++i) {
    next_seed(r, in->regions[i]);
  }
  pls->points = in->points[0];
  pls->polygon_start = in->polygon_start;
  pls->polygon_vertices = in->polygon_vertices;
  pls->segments = in->segments[0];
  pls->holes = in->holes[0];
  pls->region_seeds = in->regions[0];
  pls->n_loose_points = TET_LOOSE_ALL_UNUSED;
}

static void give_up(const char *what) {
  fprintf(stderr, "fuzz_mesh_pls: %s\n", what);
  abort();
}

static void check_mesh(const input *in, const tet_options *options, const tet_mesh *mesh) {
  if (!mesh->report.audit.passed) {
    give_up("the audit did not pass");
  }
  if (options->point_order == TET_ORDER_INPUT_FIRST && in->pls.n_points > 0 &&
      memcmp(mesh->points, in->points, in->pls.n_points * sizeof in->points[0]) != 0) {
    give_up("an input vertex lost its bits");
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  reader r = {data, data + size};
  const unsigned flags = next_byte(&r);
  input in = {0};
  read_input(&r, flags, &in);

  tet_options options;
  tet_options_default(&options);
  options.stage = (tet_stage)((flags & 3U) % 3U);
  options.keep_hull = (flags & 4U) != 0;
  options.neighbours = (flags & 8U) != 0;
  options.point_order = (flags & 16U) != 0 ? TET_ORDER_HILBERT : TET_ORDER_INPUT_FIRST;
  if ((flags & 32U) != 0 && options.stage != TET_STAGE_DELAUNAY && !options.keep_hull) {
    options.voronoi = TET_VORONOI_DIAGRAM;
  }
  options.break_points = (flags & 128U) != 0 && options.stage != TET_STAGE_DELAUNAY;
  const tet_limits limits = {.memory_bytes = UINT64_C(256) << 20, .max_vertices = 3000, .deadline_seconds = 2};

  tet_ctx *ctx = NULL;
  if (tet_ctx_create(&limits, &ctx) != TET_OK) {
    return 0;
  }
  const uint64_t before = tet_ctx_bytes(ctx);
  tet_mesh *mesh = NULL;
  if (tet_mesh_pls(ctx, &in.pls, &options, &mesh) == TET_OK) {
    check_mesh(&in, &options, mesh);
    tet_mesh_free(mesh);
  } else if (tet_ctx_error(ctx)->status == TET_E_INTERNAL) {
    fprintf(stderr, "%s:%d: ", tet_ctx_error(ctx)->file, tet_ctx_error(ctx)->line);
    give_up(tet_ctx_error(ctx)->message);
  }
  if (tet_ctx_bytes(ctx) != before) {
    give_up("memory is still held");
  }
  tet_ctx_free(ctx);
  return 0;
}
