// SPDX-License-Identifier: Apache-2.0
/* contact.c: exact contact of a tetrahedron and a triangle, by their number of
 * common vertices. Around a common simplex only directions matter: the two meet
 * properly if the cones that they span from it share nothing else. */
#include "mesh/contact.h"

#include "exact/predicates.h"
#include "mesh/pieces.h"

/* A coordinate whose removal keeps xyz from being flat. */
static int axis_of(const tet_points *p, uint32_t x, uint32_t y, uint32_t z) {
  int axis = 0;
  while (axis < 2 && tet_orient2d(p, axis, x, y, z) == 0) axis++;
  return axis;
}

/* 1: q, in the plane of s, a, b, lies in the closed wedge from s through a and b. */
static int in_wedge(const tet_points *p, uint32_t s, uint32_t a, uint32_t b, uint32_t q) {
  int axis = axis_of(p, s, a, b), turn = tet_orient2d(p, axis, s, a, b);
  return tet_orient2d(p, axis, s, a, q) * turn >= 0 && tet_orient2d(p, axis, s, q, b) * turn >= 0;
}

/* Common edge st: t has a, b beside it, f has q. (s, t, a, b) is positive. */
static int proper_at_edge(const tet_points *p, uint32_t s, uint32_t t, uint32_t a, uint32_t b, uint32_t q) {
  return tet_orient3d(p, s, t, a, q) < 0 || tet_orient3d(p, s, t, q, b) < 0;
}

/* Common vertex s: t has a[3] beside it, (s, a0, a1, a2) positive; f has b, c. */
static int proper_at_vertex(const tet_points *p, uint32_t s, const uint32_t a[3], uint32_t b, uint32_t c) {
  int in_b = 1, in_c = 1, side[3];
  for (int i = 0; i < 3; i++) {
    uint32_t x = a[i], y = a[(i + 1) % 3];
    int at_b = tet_orient3d(p, s, x, y, b), at_c = tet_orient3d(p, s, x, y, c);
    if (at_b < 0 && at_c < 0) return 1; /* that face's plane parts the two */
    in_b &= at_b >= 0;
    in_c &= at_c >= 0;
  }
  if (in_b || in_c) return 0;
  for (int i = 0; i < 3; i++) side[i] = tet_orient3d(p, s, b, c, a[i]);
  if (side[0] && side[0] == side[1] && side[1] == side[2]) return 1;
  for (int i = 0; i < 3; i++) {
    if (side[i] == 0 && in_wedge(p, s, b, c, a[i])) return 0;
  }
  for (int i = 0; i < 3; i++) { /* a face of the cone and the wedge cross in a ray */
    int j = (i + 1) % 3;
    if (side[i] * side[j] >= 0) continue;
    int of_b = tet_orient3d(p, s, a[i], a[j], b), of_c = tet_orient3d(p, s, a[i], a[j], c);
    if (of_b * of_c < 0 && of_b * side[i] < 0) return 0;
  }
  return 1;
}

/* 1: q, in the plane of triangle xyz, lies in it (closed). */
static int in_triangle(const tet_points *p, int axis, uint32_t x, uint32_t y, uint32_t z, uint32_t q) {
  int turn = tet_orient2d(p, axis, x, y, z);
  return tet_orient2d(p, axis, x, y, q) * turn >= 0 && tet_orient2d(p, axis, y, z, q) * turn >= 0 &&
         tet_orient2d(p, axis, z, x, q) * turn >= 0;
}

/* 1: coplanar closed segments pq and xy meet. */
static int segments_meet(const tet_points *p, int axis, uint32_t a, uint32_t b, uint32_t x, uint32_t y) {
  int ax = tet_orient2d(p, axis, x, y, a), bx = tet_orient2d(p, axis, x, y, b);
  int xa = tet_orient2d(p, axis, a, b, x), ya = tet_orient2d(p, axis, a, b, y);
  if (ax == 0 && bx == 0) return 0; /* on one line: an end in the triangle tells */
  return ax * bx <= 0 && xa * ya <= 0;
}

/* 1: closed segment ab meets closed triangle f. */
static int segment_meets_triangle(const tet_points *p, uint32_t a, uint32_t b, const uint32_t f[3]) {
  int sa = tet_orient3d(p, f[0], f[1], f[2], a), sb = tet_orient3d(p, f[0], f[1], f[2], b);
  if (sa * sb > 0) return 0;
  if (sa == 0 && sb == 0) {
    int axis = axis_of(p, f[0], f[1], f[2]);
    if (in_triangle(p, axis, f[0], f[1], f[2], a) || in_triangle(p, axis, f[0], f[1], f[2], b)) return 1;
    for (int i = 0; i < 3; i++)
      if (segments_meet(p, axis, a, b, f[i], f[(i + 1) % 3])) return 1;
    return 0;
  }
  int lo = 0, hi = 0;
  for (int i = 0; i < 3; i++) {
    int side = tet_orient3d(p, a, b, f[i], f[(i + 1) % 3]);
    lo |= side < 0;
    hi |= side > 0;
  }
  return !lo || !hi;
}

/* No common vertex. */
static int disjoint(const tet_points *p, const uint32_t t[4], const uint32_t f[3]) {
  int inside = 1, behind = 0, before = 0;
  for (int i = 0; i < 4; i++) {
    int out = 0;
    for (int j = 0; j < 3 && out == j; j++)
      out += tet_orient3d(p, t[tet_face[i][0]], t[tet_face[i][1]], t[tet_face[i][2]], f[j]) > 0;
    if (out == 3) return 1; /* that face's plane parts the two */
    inside &= out == 0;
    int side = tet_orient3d(p, f[0], f[1], f[2], t[i]);
    behind += side < 0;
    before += side > 0;
  }
  if (inside) return 0;
  if (behind == 4 || before == 4) return 1;
  for (int i = 0; i < 4; i++) {
    uint32_t g[3] = {t[tet_face[i][0]], t[tet_face[i][1]], t[tet_face[i][2]]};
    for (int j = 0; j < 3; j++)
      if (segment_meets_triangle(p, f[j], f[(j + 1) % 3], g)) return 0;
    for (int j = i + 1; j < 4; j++)
      if (segment_meets_triangle(p, t[i], t[j], f)) return 0;
  }
  return 1;
}

/* Brings the vertices of t that f has to the front, t staying positive; those of f
 * likewise. Returns how many. */
static int sort_common(const tet_points *p, uint32_t t[4], uint32_t f[3]) {
  int n = 0;
  for (int i = 0; i < 4; i++)
    for (int j = n; j < 3; j++)
      if (t[i] == f[j]) {
        uint32_t v = f[j];
        f[j] = f[n];
        f[n] = v;
        t[i] = t[n];
        t[n++] = v;
        break;
      }
  if (tet_orient3d(p, t[0], t[1], t[2], t[3]) < 0) {
    uint32_t v = t[2];
    t[2] = t[3];
    t[3] = v;
  }
  return n;
}

int tet_meets_in_common_face(const tet_points *p, const uint32_t tetrahedron[4], const uint32_t triangle[3]) {
  uint32_t t[4] = {tetrahedron[0], tetrahedron[1], tetrahedron[2], tetrahedron[3]};
  uint32_t f[3] = {triangle[0], triangle[1], triangle[2]};
  switch (sort_common(p, t, f)) {
    case 3: return 1;
    case 2: return proper_at_edge(p, t[0], t[1], t[2], t[3], f[2]);
    case 1: return proper_at_vertex(p, t[0], t + 1, f[1], f[2]);
    default: return disjoint(p, t, f);
  }
}
