// SPDX-License-Identifier: Apache-2.0
/* polyhedra.c: see polyhedra.h. */
#include "polyhedra.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "base/sort.h"
#include "base/vector.h"

static double extent_of(const tet_mesh *m) {
  double extent = 0;
  for (size_t i = 3; i < 3 * (size_t)m->n_points; i++) extent = fmax(extent, fabs(m->points[i] - m->points[i % 3]));
  return extent;
}

static const double *place(const tet_mesh *m, size_t corner) {
  return m->voronoi_points + 3 * (size_t)m->voronoi_face_points[corner];
}

/* The area of face f as a vector. */
static void area_of(const tet_mesh *m, size_t f, double area[3]) {
  size_t low = m->voronoi_face_start[f], high = m->voronoi_face_start[f + 1];
  area[0] = area[1] = area[2] = 0;
  for (size_t i = low + 1; i + 1 < high; i++) {
    double u[3], w[3], n[3];
    tet_minus(place(m, i), place(m, low), u);
    tet_minus(place(m, i + 1), place(m, low), w);
    tet_cross(u, w, n);
    for (int k = 0; k < 3; k++) area[k] += 0.5 * n[k];
  }
}

/* Every side, once for each cell; the value tells which way it goes. */
void check_polyhedra_closed(const tet_mesh *m) {
  size_t n = 0, corners = m->voronoi_face_start[m->n_voronoi_faces];
  tet_keyed *side = malloc((2 * corners + 1) * sizeof *side);
  assert_non_null(side);
  for (int turned = 0; turned < 2; turned++)
    for (size_t f = 0; f < m->n_voronoi_faces; f++) {
      uint32_t cell = m->voronoi_face_cells[2 * f + (size_t)turned];
      size_t low = m->voronoi_face_start[f], high = m->voronoi_face_start[f + 1];
      for (size_t i = low; i < high && cell != TET_NONE; i++) {
        uint64_t a = m->voronoi_face_points[i], b = m->voronoi_face_points[i + 1 < high ? i + 1 : low];
        assert_true(a != b);
        uint64_t less = a < b ? a : b, more = a < b ? b : a;
        side[n++] = (tet_keyed){(uint64_t)cell << 32 | less, more << 1 | ((a < b) ^ turned)};
      }
    }
  tet_sort_keyed(side, n);
  assert_true(n % 2 == 0);
  for (size_t i = 0; i < n;) {
    int balance = 0;
    size_t j = i;
    for (; j < n && side[j].key == side[i].key && side[j].value >> 1 == side[i].value >> 1; j++)
      balance += side[j].value & 1 ? 1 : -1;
    if (balance != 0) fail_msg("cell %llu is open", (unsigned long long)(side[i].key >> 32));
    i = j;
  }
  free(side);
}

static void check_volumes(const tet_mesh *m, double slack) {
  double *volume = calloc(m->n_cells + 1, sizeof *volume);
  assert_non_null(volume);
  for (size_t f = 0; f < m->n_voronoi_faces; f++) {
    double area[3], d[3];
    area_of(m, f, area);
    for (size_t k = 0; k < 2; k++) {
      uint32_t c = m->voronoi_face_cells[2 * f + k];
      if (c == TET_NONE) continue;
      tet_minus(place(m, m->voronoi_face_start[f]), m->points + 3 * (size_t)m->cell_vertices[c], d);
      volume[c] += (k ? -1 : 1) * tet_dot(area, d) / 3;
    }
  }
  for (size_t c = 0; c < m->n_cells; c++)
    if (!(fabs(volume[c] - m->cell_volumes[c]) <= slack))
      fail_msg("cell %zu has the volume %.17g, not %.17g", c, volume[c], m->cell_volumes[c]);
  free(volume);
}

static int is_face_of(const tet_mesh *m, size_t row, uint32_t a, uint32_t b) {
  return m->edge_vertices[2 * row] == m->cell_vertices[a] && m->edge_vertices[2 * row + 1] == m->cell_vertices[b] &&
         m->edge_regions[row] == m->cell_regions[a];
}

static void check_edges(const tet_mesh *m, double slack) {
  double *sum = calloc(3 * ((size_t)m->n_edges + 1), sizeof *sum);
  assert_non_null(sum);
  for (size_t f = 0; f < m->n_voronoi_faces; f++) {
    uint32_t a = m->voronoi_face_cells[2 * f], b = m->voronoi_face_cells[2 * f + 1];
    if (b == TET_NONE || m->cell_regions[a] != m->cell_regions[b]) {
      assert_true(f >= m->n_edges);
      continue;
    }
    size_t row = f;
    if (f >= m->n_edges) row = 0; /* a further one: of whichever row it is */
    while (f >= m->n_edges && !is_face_of(m, row, a, b)) row++;
    assert_true(is_face_of(m, row, a, b));
    double area[3];
    area_of(m, f, area);
    for (size_t k = 0; k < 3; k++) sum[3 * row + k] += area[k];
  }
  for (size_t row = 0; row < m->n_edges; row++) {
    double d[3];
    const uint32_t *v = m->edge_vertices + 2 * row;
    tet_minus(m->points + 3 * (size_t)v[1], m->points + 3 * (size_t)v[0], d);
    for (size_t k = 0; k < 3; k++) assert_true(fabs(sum[3 * row + k] - m->edge_factors[row] * d[k]) <= slack);
  }
  free(sum);
}

static void check_indices(const tet_mesh *m) {
  size_t corners = m->voronoi_face_start[m->n_voronoi_faces];
  uint8_t *used = calloc(m->n_voronoi_points + 1, 1);
  assert_non_null(used);
  assert_int_equal(m->voronoi_face_start[0], 0);
  for (size_t f = 0; f < m->n_voronoi_faces; f++) {
    assert_true(m->voronoi_face_start[f + 1] >= m->voronoi_face_start[f] + 3);
    assert_true(m->voronoi_face_cells[2 * f] < m->n_cells);
    assert_true(m->voronoi_face_cells[2 * f + 1] < m->n_cells || m->voronoi_face_cells[2 * f + 1] == TET_NONE);
  }
  for (size_t i = 0; i < corners; i++) {
    assert_true(m->voronoi_face_points[i] < m->n_voronoi_points);
    used[m->voronoi_face_points[i]] = 1;
  }
  for (size_t i = 0; i < m->n_voronoi_points; i++) assert_true(used[i]);
  free(used);
}

void check_polyhedra(const tet_mesh *mesh, double slack) {
  double extent = extent_of(mesh);
  check_indices(mesh);
  check_polyhedra_closed(mesh);
  check_volumes(mesh, slack * extent * extent * extent);
  check_edges(mesh, slack * extent * extent);
}
