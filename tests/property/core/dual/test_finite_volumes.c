// SPDX-License-Identifier: Apache-2.0
/* Laws of the dual of generated meshes: cell volumes add up to each region's volume to 1e-12,
 * subface shares to the subfaces' areas; no factor of a boundary conforming Delaunay mesh is
 * negative; a linear function's flux leaves a cell through subfaces alone; the cells are closed
 * polyhedra of the same volumes and faces; a finite-volume solution that is linear in each region
 * comes out to 1e-10. The seed of a failure is printed. TETRAD_RUNS sets how many seeds are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sort.h"
#include "base/vector.h"
#include "maker.h"
#include "polyhedra.h"
#include <tet/engine.h>

enum { MOST_REGIONS = 64 };

static made_pls made;
static struct { double volume, solution; uint32_t tetrahedra; } worst;

static uint64_t runs(uint64_t usual) {
  const char *given = getenv("TETRAD_RUNS");
  return given ? strtoull(given, NULL, 10) : usual;
}

static tet_mesh *mesh_of(tet_ctx *ctx, tet_stage stage, double max_volume, uint64_t seed) {
  tet_options options;
  tet_mesh *m = NULL;
  tet_options_default(&options);
  options.stage = stage;
  options.max_volume = max_volume;
  options.voronoi = TET_VORONOI_DIAGRAM;
  options.point_order = seed % 2 ? TET_ORDER_HILBERT : TET_ORDER_INPUT_FIRST;
  if (tet_mesh_pls(ctx, &made.pls, &options, &m) != TET_OK)
    fail_msg("seed %llu: %s", (unsigned long long)seed, tet_ctx_error(ctx)->message);
  assert_true(m->report.audit.passed && m->report.voronoi.made);
  return m;
}

static const double *point(const tet_mesh *m, uint32_t v) { return m->points + 3 * (size_t)v; }

/* Per region; compared with sums of determinants in longer arithmetic. */
static void check_volumes(const tet_mesh *m, uint64_t seed) {
  long double wanted[MOST_REGIONS] = {0}, sum[MOST_REGIONS] = {0}, size[MOST_REGIONS] = {0};
  assert_true(m->n_regions <= MOST_REGIONS);
  for (size_t t = 0; t < m->n_tetrahedra; t++) {
    const uint32_t *v = m->tetrahedra + 4 * t;
    long double d[3][3];
    for (size_t i = 0; i < 3; i++)
      for (size_t k = 0; k < 3; k++) d[i][k] = (long double)point(m, v[i + 1])[k] - point(m, v[0])[k];
    wanted[m->tetrahedron_regions[t]] +=
        (d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0])) / 6;
  }
  for (uint32_t c = 0; c < m->n_cells; c++) {
    sum[m->cell_regions[c]] += m->cell_volumes[c];
    size[m->cell_regions[c]] += fabs(m->cell_volumes[c]);
  }
  for (uint32_t r = 0; r < m->n_regions; r++) {
    double off = (double)(fabsl(sum[r] - wanted[r]) / (m->report.promised.gabriel ? wanted[r] : size[r]));
    if (off > worst.volume) worst.volume = off;
    if (!(off <= 1e-12)) fail_msg("seed %llu: region %u is off by %g", (unsigned long long)seed, r, off);
  }
}

static void check_shares(const tet_mesh *m) {
  for (size_t s = 0; s < m->n_subfaces; s++) {
    const uint32_t *v = m->subfaces + 3 * s;
    double u[3], w[3], n[3];
    tet_minus(point(m, v[1]), point(m, v[0]), u);
    tet_minus(point(m, v[2]), point(m, v[0]), w);
    tet_cross(u, w, n);
    double area = sqrt(tet_dot(n, n)) / 2, sum = 0, size = tet_dot(u, u) + tet_dot(w, w);
    for (size_t k = 0; k < 3; k++) {
      sum += m->subface_shares[3 * s + k];
      size = fmax(size, fabs(m->subface_shares[3 * s + k])); /* of blunt ones far more than the area */
    }
    assert_true(fabs(sum - area) <= 1e-12 * size);
  }
}

/* The maximum principle's condition (1.1); with the report's count, and without. */
static void check_signs(const tet_mesh *m, uint64_t seed) {
  double extent = 0;
  for (uint32_t v = 1; v < m->n_points; v++)
    for (int k = 0; k < 3; k++) extent = fmax(extent, fabs(point(m, v)[k] - point(m, 0)[k]));
  for (uint32_t row = 0; row < m->n_edges; row++)
    if (m->edge_factors[row] < -1e-12 * extent)
      fail_msg("seed %llu: edge %u %u has %g", (unsigned long long)seed, m->edge_vertices[2 * row],
               m->edge_vertices[2 * row + 1], m->edge_factors[row]);
  assert_int_equal(m->report.voronoi.negative_factors, 0);
}

/* The row of a cell that must be there. */
static uint32_t cell_of(const tet_mesh *m, uint32_t v, uint32_t region) {
  uint32_t low = 0, high = m->n_cells;
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    int before = m->cell_vertices[mid] != v ? m->cell_vertices[mid] < v : m->cell_regions[mid] < region;
    if (before) low = mid + 1;
    else high = mid;
  }
  assert_true(low < m->n_cells && m->cell_vertices[low] == v && m->cell_regions[low] == region);
  return low;
}

/* Every pair of a vertex and a region that a tetrahedron has is one cell, and no other. */
static void check_cells(const tet_mesh *m) {
  uint8_t *met = calloc(m->n_cells + 1, 1);
  assert_non_null(met);
  for (size_t i = 0; i < 4 * (size_t)m->n_tetrahedra; i++)
    met[cell_of(m, m->tetrahedra[i], m->tetrahedron_regions[i / 4])] = 1;
  for (uint32_t c = 0; c < m->n_cells; c++) assert_true(met[c]);
  free(met);
}

static tet_keyed face_key(const uint32_t *v, uint64_t row) {
  uint32_t a = v[0], b = v[1], c = v[2], low = a < b ? a : b, high = a < b ? b : a;
  uint32_t least = low < c ? low : c, most = high > c ? high : c, middle = a ^ b ^ c ^ least ^ most;
  return (tet_keyed){(uint64_t)least << 32 | middle, (uint64_t)most << 32 | row};
}

/* The shares of face f of a tetrahedron go into the cells of its region, times the outward normal. */
static void add_face(const tet_mesh *m, const tet_keyed *subface, size_t t, const uint8_t *f, double (*flux)[4]) {
  const uint32_t *v = m->tetrahedra + 4 * t, face[3] = {v[f[0]], v[f[1]], v[f[2]]};
  tet_keyed key = face_key(face, 0);
  uint32_t low = 0, high = m->n_subfaces;
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    if (subface[mid].key < key.key || (subface[mid].key == key.key && subface[mid].value < key.value)) low = mid + 1;
    else high = mid;
  }
  if (low == m->n_subfaces || subface[low].key != key.key || subface[low].value >> 32 != key.value >> 32) return;
  size_t row = (uint32_t)subface[low].value;
  double u[3], w[3], n[3];
  tet_minus(point(m, face[1]), point(m, face[0]), u);
  tet_minus(point(m, face[2]), point(m, face[0]), w);
  tet_cross(u, w, n);
  for (size_t k = 0; k < 3; k++) {
    double *sum = flux[cell_of(m, m->subfaces[3 * row + k], m->tetrahedron_regions[t])];
    double share = m->subface_shares[3 * row + k];
    for (int i = 0; i < 3; i++) sum[i] += share * n[i] / sqrt(tet_dot(n, n));
    sum[3] += fabs(share);
  }
}

/* A linear function's flux out of every cell is that through its part of the borders: the areas of its
 * faces and the shares of subfaces sum to nothing, as vectors. */
static void check_balance(const tet_mesh *m, uint64_t seed) {
  static const uint8_t face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}; /* outward */
  double (*flux)[4] = calloc(m->n_cells + 1, sizeof *flux); /* the sum, and the size of what is in it */
  tet_keyed *subface = malloc((m->n_subfaces + 1) * sizeof *subface);
  assert_true(flux && subface);
  for (uint32_t s = 0; s < m->n_subfaces; s++) subface[s] = face_key(m->subfaces + 3 * (size_t)s, s);
  tet_sort_keyed(subface, m->n_subfaces);
  for (size_t i = 0; i < 4 * (size_t)m->n_tetrahedra; i++) add_face(m, subface, i / 4, face[i % 4], flux);
  for (size_t row = 0; row < m->n_edges; row++)
    for (size_t end = 0; end < 2; end++) {
      const uint32_t *v = m->edge_vertices + 2 * row;
      double d[3], *sum = flux[cell_of(m, v[end], m->edge_regions[row])];
      tet_minus(point(m, v[1 - end]), point(m, v[end]), d);
      for (int i = 0; i < 3; i++) sum[i] += m->edge_factors[row] * d[i];
      sum[3] += fabs(m->edge_factors[row]) * sqrt(tet_dot(d, d));
    }
  for (uint32_t c = 0; c < m->n_cells; c++)
    for (int i = 0; i < 3; i++)
      if (!(fabs(flux[c][i]) <= 1e-11 * flux[c][3])) fail_msg("seed %llu: cell %u leaks", (unsigned long long)seed, c);
  free(flux);
  free(subface);
}

static void generated_meshes(void **state) {
  (void)state;
  uint64_t conforming = 0;
  for (uint64_t seed = 1; seed <= runs(30); seed++) {
    tet_ctx *ctx;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    if (seed % 2) make_boxes(seed, &made);
    else make_stack(seed, &made);
    if (seed % 4 < 2) make_oblique(seed, &made);
    tet_mesh *m = mesh_of(ctx, TET_STAGE_REFINE, made.volume / 500, seed);
    check_volumes(m, seed);
    if (m->report.promised.delaunay && m->report.promised.gabriel) {
      check_signs(m, seed);
      conforming++;
    }
    check_shares(m);
    check_cells(m);
    check_balance(m, seed);
    check_polyhedra(m, 1e-12);
    worst.tetrahedra += m->n_tetrahedra;
    tet_mesh_free(m);
    m = mesh_of(ctx, TET_STAGE_CDT, 0, seed); /* promises no signs */
    check_volumes(m, seed);
    check_shares(m);
    check_cells(m);
    check_polyhedra_closed(m);
    assert_null(m->neighbours);
    tet_mesh_free(m);
    assert_int_equal(tet_ctx_bytes(ctx), 0);
    tet_ctx_free(ctx);
  }
  assert_true(conforming >= runs(30) * 9 / 10);
  printf("%u tetrahedra, volumes to %.2g\n", worst.tetrahedra, worst.volume);
}

/* ---- div(D grad u) = 0 in a stack of layers, D constant in each ---- */

typedef struct problem {
  const tet_mesh *m;
  double conductivity[MOST_REGIONS]; /* by region row */
  double *exact, *u, *r, *p, *q, *diagonal; /* [n_points] */
  uint8_t *fixed;                           /* [n_points] on the outer boundary */
} problem;

/* q = A p for free vertices: the sum over edges of D factor (p_K - p_L), from (1.3). */
static void apply(const problem *w, const double *p, double *q) {
  const tet_mesh *m = w->m;
  memset(q, 0, m->n_points * sizeof *q);
  for (size_t row = 0; row < m->n_edges; row++) {
    uint32_t k = m->edge_vertices[2 * row], l = m->edge_vertices[2 * row + 1];
    double flux = w->conductivity[m->edge_regions[row]] * m->edge_factors[row] * (p[k] - p[l]);
    q[k] += flux;
    q[l] -= flux;
  }
  for (uint32_t v = 0; v < m->n_points; v++)
    if (w->fixed[v]) q[v] = 0;
}

static double dot(const double *a, const double *b, uint32_t n) {
  double sum = 0;
  for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Conjugate gradients with the diagonal; fixed vertices have no part in it. */
static void solve(problem *w) {
  uint32_t n = w->m->n_points;
  double *z = calloc(n, sizeof *z), first = 0, before = 0;
  assert_non_null(z);
  apply(w, w->u, w->r);
  for (uint32_t v = 0; v < n; v++) w->r[v] = -w->r[v];
  for (int i = 0; i < 5000; i++) {
    for (uint32_t v = 0; v < n; v++) z[v] = w->fixed[v] ? 0 : w->r[v] / w->diagonal[v];
    double rz = dot(w->r, z, n);
    if (i == 0) first = rz;
    if (rz <= 1e-30 * first) break;
    for (uint32_t v = 0; v < n; v++) w->p[v] = z[v] + (i ? rz / before * w->p[v] : 0);
    before = rz;
    apply(w, w->p, w->q);
    double step = rz / dot(w->p, w->q, n);
    for (uint32_t v = 0; v < n; v++) {
      w->u[v] += step * w->p[v];
      w->r[v] -= step * w->q[v];
    }
  }
  free(z);
}

/* How high x is over the stack's bottom. */
static double height(const double *x) {
  double up[3], d[3];
  tet_minus(made.points[4], made.points[0], up);
  tet_minus(x, made.points[0], d);
  return tet_dot(up, d) / sqrt(tet_dot(up, up));
}

/* Of slope 1 / D in each layer, and continuous: the flux is 1 everywhere. */
static double exact_at(double z, const double *conductivity) {
  double u = 0, low = 0;
  for (uint32_t layer = 0; layer < made.n_regions; layer++) {
    double high = height(made.points[4 * (layer + 1)]);
    if (z <= high || layer + 1 == made.n_regions) return u + (z - low) / conductivity[layer];
    u += (high - low) / conductivity[layer];
    low = high;
  }
  return u;
}

static uint32_t layer_at(double z) {
  uint32_t layer = 0;
  while (layer + 1 < made.n_regions && z > height(made.points[4 * (layer + 1)])) layer++;
  return layer;
}

/* Conductivities by layer, and by the mesh's region rows. */
static void conduct(problem *w, uint64_t seed, double by_layer[MOST_REGIONS]) {
  maker_random r = {seed};
  for (uint32_t i = 0; i < made.n_regions; i++) by_layer[i] = exp(6 * maker_unit(&r) - 3);
  for (size_t t = 0; t < w->m->n_tetrahedra; t++) {
    double z = 0;
    for (size_t k = 0; k < 4; k++) z += height(point(w->m, w->m->tetrahedra[4 * t + k])) / 4;
    w->conductivity[w->m->tetrahedron_regions[t]] = by_layer[layer_at(z)];
  }
}

static void allocate(problem *w) {
  double **all[] = {&w->exact, &w->u, &w->r, &w->p, &w->q, &w->diagonal};
  for (size_t i = 0; i < 6; i++) assert_non_null(*all[i] = calloc(w->m->n_points, sizeof **all[i]));
  assert_non_null(w->fixed = calloc(w->m->n_points, 1));
}

static void release(problem *w) {
  void *all[] = {w->exact, w->u, w->r, w->p, w->q, w->diagonal, w->fixed};
  for (size_t i = 0; i < 7; i++) free(all[i]);
}

/* The outer walls of a stack have markers 1 to 3 over a multiple of ten; the interfaces are the
 * tops (1) of all layers but the last. */
static int is_interface(int32_t marker) {
  return marker % 10 == 1 && marker != 1 && marker != 10 * ((int32_t)made.n_regions - 1) + 1;
}

static double error_of(const problem *w) {
  double off = 0, size = 0;
  for (uint32_t v = 0; v < w->m->n_points; v++) {
    if (w->diagonal[v] == 0) continue; /* of no cell */
    off = fmax(off, fabs(w->u[v] - w->exact[v]));
    size = fmax(size, fabs(w->exact[v]));
  }
  return off / size;
}

static void piecewise_linear_solutions(void **state) {
  (void)state;
  for (uint64_t seed = 100; seed < 100 + runs(20); seed++) {
    tet_ctx *ctx;
    double by_layer[MOST_REGIONS];
    uint32_t free_vertices = 0;
    assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
    make_stack(seed, &made);
    if (seed % 2) make_oblique(seed, &made);
    problem w = {.m = mesh_of(ctx, TET_STAGE_REFINE, made.volume / 4000, seed)};
    const tet_mesh *m = w.m;
    allocate(&w);
    conduct(&w, seed, by_layer);
    for (size_t row = 0; row < m->n_edges; row++)
      for (size_t k = 0; k < 2; k++)
        w.diagonal[m->edge_vertices[2 * row + k]] += w.conductivity[m->edge_regions[row]] * m->edge_factors[row];
    for (size_t i = 0; i < 3 * (size_t)m->n_subfaces; i++)
      if (!is_interface(m->subface_markers[i / 3])) w.fixed[m->subfaces[i]] = 1;
    for (uint32_t v = 0; v < m->n_points; v++) {
      w.exact[v] = exact_at(height(point(m, v)), by_layer);
      w.u[v] = w.fixed[v] ? w.exact[v] : 0;
      free_vertices += !w.fixed[v] && w.diagonal[v] > 0;
    }
    assert_true(free_vertices > 0);
    solve(&w);
    double off = error_of(&w);
    if (off > worst.solution) worst.solution = off;
    if (!(off <= 1e-10)) fail_msg("seed %llu: off by %g", (unsigned long long)seed, off);
    release(&w);
    tet_mesh *mesh;
    memcpy(&mesh, &w.m, sizeof mesh);
    tet_mesh_free(mesh);
    tet_ctx_free(ctx);
  }
  printf("solutions to %.2g\n", worst.solution);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(generated_meshes), cmocka_unit_test(piecewise_linear_solutions)};
  return cmocka_run_group_tests_name("finite_volumes", tests, NULL, NULL);
}
