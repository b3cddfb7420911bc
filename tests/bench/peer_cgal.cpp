// SPDX-License-Identifier: Apache-2.0
// CGAL's Delaunay triangulation of a .node file's points: seconds and tetrahedra.
//
//   peer_cgal FILE.node

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <vector>

int main(int argc, char** argv) {
  using K = CGAL::Exact_predicates_inexact_constructions_kernel;
  if (argc != 2) return 2;
  std::ifstream in(argv[1]);
  size_t n, dimension, attributes, markers, index;
  if (!(in >> n >> dimension >> attributes >> markers)) return 1;
  std::vector<K::Point_3> points(n);
  for (auto& p : points) {
    double x, y, z;
    in >> index >> x >> y >> z;
    p = K::Point_3(x, y, z);
  }
  const auto start = std::chrono::steady_clock::now();
  const CGAL::Delaunay_triangulation_3<K> mesh(points.begin(), points.end());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("tetrahedra %zu delaunay %.4f\n", (size_t)mesh.number_of_finite_cells(), seconds.count());
}
