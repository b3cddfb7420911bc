// SPDX-License-Identifier: Apache-2.0
// CGAL's Delaunay triangulation of points (doubles, three a point): CPU seconds and
// tetrahedra; with a number, that many vertices are removed after, those whose rows stand
// in the order file (32-bit numbers).
//
//   peer_cgal POINTS.f8 [ORDER.u4 COUNT]

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>
#include <vector>

template <class T>
static std::vector<T> read_all(const char* path) {
  std::vector<T> items;
  T item;
  std::FILE* f = std::fopen(path, "rb");
  if (!f) {
    std::perror(path);
    std::exit(1);
  }
  while (std::fread(&item, sizeof item, 1, f) == 1) items.push_back(item);
  std::fclose(f);
  return items;
}

static double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

using K = CGAL::Exact_predicates_inexact_constructions_kernel;

static int triangulate(const std::vector<K::Point_3>& points) {
  const double start = cpu_seconds();
  const CGAL::Delaunay_triangulation_3<K> mesh(points.begin(), points.end());
  std::printf("seconds %.6f tetrahedra %zu\n", cpu_seconds() - start, (size_t)mesh.number_of_finite_cells());
  return 0;
}

// Vertices know their rows here, so that those to remove are found.
static int remove_some(const std::vector<K::Point_3>& points, const std::vector<uint32_t>& order, size_t count) {
  using Vb = CGAL::Triangulation_vertex_base_with_info_3<uint32_t, K>;
  using Mesh = CGAL::Delaunay_triangulation_3<K, CGAL::Triangulation_data_structure_3<Vb>>;
  std::vector<std::pair<K::Point_3, uint32_t>> rows;
  for (size_t i = 0; i < points.size(); i++) rows.emplace_back(points[i], (uint32_t)i);
  Mesh mesh(rows.begin(), rows.end());
  std::vector<Mesh::Vertex_handle> at(points.size());
  for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v) at[v->info()] = v;
  const double start = cpu_seconds();
  for (size_t i = 0; i < count; i++) mesh.remove(at[order[i]]);
  std::printf("seconds %.6f removed %zu tetrahedra %zu\n", cpu_seconds() - start, count,
              (size_t)mesh.number_of_finite_cells());
  return 0;
}

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4) return 2;
  const std::vector<double> x = read_all<double>(argv[1]);
  std::vector<K::Point_3> points;
  for (size_t i = 0; i + 2 < x.size(); i += 3) points.emplace_back(x[i], x[i + 1], x[i + 2]);
  if (argc == 2) return triangulate(points);
  return remove_some(points, read_all<uint32_t>(argv[2]), std::strtoul(argv[3], nullptr, 10));
}
