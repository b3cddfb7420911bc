// SPDX-License-Identifier: Apache-2.0
/* Random PLSs on a small integer lattice, where everything touches everything.
 *
 * What the surface stage accepts is checked by integer arithmetic of its own: any two
 * of its vertices, edges and triangles have disjoint interiors, and the facets' area
 * is all there. Of what it refuses, the pair that it names must meet improperly. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "pls_builder.h"

typedef int64_t vec[3];

static uint64_t rng_state;
static double scale = 1; /* of the lattice, a power of two */

static uint32_t rng(uint32_t n) {
  rng_state = rng_state * 6364136223846793005ULL + 1442695040888963407ULL;
  return (uint32_t)((rng_state >> 33) % n);
}

static void get(const double *x, uint32_t v, vec p) {
  for (int k = 0; k < 3; k++) p[k] = (int64_t)x[3 * (size_t)v + (size_t)k];
}

static void sub(const vec a, const vec b, vec d) {
  for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

static void cross(const vec a, const vec b, vec n) {
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
}

static int64_t dot(const vec a, const vec b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static int is_zero(const vec a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; }
static int sign(int64_t x) { return (x > 0) - (x < 0); }

/* v in the open segment ab. */
static int vertex_in_segment(const vec v, const vec a, const vec b) {
  vec d, e, n;
  sub(b, a, d);
  sub(v, a, e);
  cross(d, e, n);
  return is_zero(n) && dot(d, e) > 0 && dot(d, e) < dot(d, d);
}

/* Sides of v of the three edges of abc, for v in its plane; all positive: inside. */
static void edge_sides(const vec v, const vec t[3], int s[3]) {
  vec n, u, w;
  sub(t[1], t[0], u);
  sub(t[2], t[0], w);
  cross(u, w, n);
  for (int j = 0; j < 3; j++) {
    vec d, e, m;
    sub(t[(j + 1) % 3], t[j], d);
    sub(v, t[j], e);
    cross(d, e, m);
    s[j] = sign(dot(m, n));
  }
}

static int height(const vec v, const vec t[3]) {
  vec n, u, w;
  sub(t[1], t[0], u);
  sub(t[2], t[0], w);
  cross(u, w, n);
  sub(v, t[0], u);
  return sign(dot(n, u));
}

static int vertex_in_triangle(const vec v, const vec t[3]) {
  int s[3];
  if (height(v, t) != 0) return 0;
  edge_sides(v, t, s);
  return s[0] > 0 && s[1] > 0 && s[2] > 0;
}

/* Open segments ab and cd meet. */
static int segments_meet(const vec a, const vec b, const vec c, const vec d) {
  vec u, w, n, e, m;
  sub(b, a, u);
  sub(d, c, w);
  sub(c, a, e);
  cross(u, w, n);
  if (is_zero(n)) { /* parallel: on one line, their parameters along ab overlap */
    cross(u, e, m);
    if (!is_zero(m)) return 0;
    vec g;
    sub(d, a, g);
    int64_t p = dot(u, e), q = dot(u, g), lo = p < q ? p : q, hi = p < q ? q : p;
    return lo < dot(u, u) && hi > 0;
  }
  if (dot(n, e) != 0) return 0;
  int64_t nn = dot(n, n);
  cross(e, w, m);
  int64_t s = dot(m, n);
  cross(e, u, m);
  int64_t t = dot(m, n);
  return s > 0 && s < nn && t > 0 && t < nn;
}

/* Open segment ab and open triangle meet. */
static int segment_meets_triangle(const vec a, const vec b, const vec t[3]) {
  int ha = height(a, t), hb = height(b, t);
  if (ha * hb > 0 || (ha == 0) != (hb == 0)) return 0;
  if (ha != 0) { /* across: the volumes over the three edges have one sign */
    int s[3];
    for (int j = 0; j < 3; j++) {
      const vec *q = t;
      vec u, v, w, n;
      sub(b, a, u);
      sub(q[j], a, v);
      sub(q[(j + 1) % 3], a, w);
      cross(v, w, n);
      s[j] = sign(dot(u, n));
    }
    return s[0] != 0 && s[0] == s[1] && s[1] == s[2];
  }
  /* In the plane: cut the parameter interval by the three edges. */
  vec n, u, w;
  sub(t[1], t[0], u);
  sub(t[2], t[0], w);
  cross(u, w, n);
  int64_t lo_n = 0, lo_d = 1, hi_n = 1, hi_d = 1;
  for (int j = 0; j < 3; j++) {
    vec d, ea, eb, m;
    sub(t[(j + 1) % 3], t[j], d);
    sub(a, t[j], ea);
    sub(b, t[j], eb);
    cross(d, ea, m);
    int64_t fa = dot(m, n);
    cross(d, eb, m);
    int64_t fb = dot(m, n);
    if (fa <= 0 && fb <= 0) return 0;
    if (fa >= 0 && fb >= 0) continue;
    int64_t num = fa < 0 ? -fa : fa, den = fa < fb ? fb - fa : fa - fb; /* zero at num/den */
    if (fa < 0) {
      if (num * lo_d > lo_n * den) {
        lo_n = num;
        lo_d = den;
      }
    } else if (num * hi_d < hi_n * den) {
      hi_n = num;
      hi_d = den;
    }
  }
  return lo_n * hi_d < hi_n * lo_d;
}

/* The simplices of a surface: used vertices, edges, triangles. */
typedef struct cells {
  const double *x;
  uint32_t n_v, n_e, n_t;
  uint32_t *v, *e, *t;
} cells;

static void triangle_of(const cells *c, uint32_t i, vec t[3]) {
  for (int k = 0; k < 3; k++) get(c->x, c->t[3 * i + (uint32_t)k], t[k]);
}

static int has(const uint32_t *a, int n, uint32_t v) {
  for (int i = 0; i < n; i++)
    if (a[i] == v) return 1;
  return 0;
}

static const char *cell_fault(const cells *c) {
  vec a, b, p, q, t[3];
  for (uint32_t i = 0; i < c->n_e; i++) {
    get(c->x, c->e[2 * i], a);
    get(c->x, c->e[2 * i + 1], b);
    for (uint32_t j = 0; j < c->n_v; j++) {
      get(c->x, c->v[j], p);
      if (vertex_in_segment(p, a, b)) return "a vertex in an edge";
    }
    for (uint32_t j = 0; j < i; j++) {
      get(c->x, c->e[2 * j], p);
      get(c->x, c->e[2 * j + 1], q);
      if (segments_meet(a, b, p, q)) return "two edges cross";
    }
    for (uint32_t j = 0; j < c->n_t; j++) {
      triangle_of(c, j, t);
      if (segment_meets_triangle(a, b, t)) return "an edge in a triangle";
    }
  }
  for (uint32_t j = 0; j < c->n_t; j++) {
    triangle_of(c, j, t);
    for (uint32_t i = 0; i < c->n_v; i++) {
      get(c->x, c->v[i], p);
      if (vertex_in_triangle(p, t)) return "a vertex in a triangle";
    }
    for (uint32_t i = 0; i < j; i++)
      if (has(c->t + 3 * i, 3, c->t[3 * j]) && has(c->t + 3 * i, 3, c->t[3 * j + 1]) &&
          has(c->t + 3 * i, 3, c->t[3 * j + 2]))
        return "a triangle twice";
  }
  return NULL;
}

static int compare_edges(const void *p, const void *q) {
  const uint32_t *a = p, *b = q;
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return a[1] < b[1] ? -1 : a[1] > b[1];
}

static const char *complex_fault(const tet_surface *s, const pls_builder *b) {
  cells c = {.x = b->x, .n_t = s->n_tris, .t = s->tri};
  c.v = malloc((b->pls.n_points + 1) * sizeof *c.v);
  c.e = malloc((3 * (size_t)s->n_tris + s->n_segments + 1) * 2 * sizeof *c.e);
  assert_non_null(c.v);
  assert_non_null(c.e);
  for (uint32_t v = 0; v < b->pls.n_points; v++)
    if (s->used[v]) c.v[c.n_v++] = v;
  uint32_t m = 0;
  for (uint32_t h = 0; h < 3 * s->n_tris; h++) {
    uint32_t u = s->tri[h], w = s->tri[h % 3 == 2 ? h - 2 : h + 1];
    c.e[2 * m] = u < w ? u : w;
    c.e[2 * m++ + 1] = u < w ? w : u;
  }
  for (uint32_t i = 0; i < s->n_segments; i++) {
    c.e[2 * m] = s->segment[i].a;
    c.e[2 * m++ + 1] = s->segment[i].b;
  }
  qsort(c.e, m, 2 * sizeof *c.e, compare_edges);
  for (uint32_t i = 0; i < m; i++)
    if (i == 0 || compare_edges(c.e + 2 * i, c.e + 2 * (c.n_e - 1)) != 0) {
      c.e[2 * c.n_e] = c.e[2 * i];
      c.e[2 * c.n_e++ + 1] = c.e[2 * i + 1];
    }
  const char *fault = cell_fault(&c);
  free(c.v);
  free(c.e);
  return fault;
}

/* Three vertices on one line? */
static int collinear3(const pls_builder *b, uint32_t u, uint32_t v, uint32_t w) {
  vec p, q, r, d, e, n;
  get(b->x, u, p);
  get(b->x, v, q);
  get(b->x, w, r);
  sub(q, p, d);
  sub(r, p, e);
  cross(d, e, n);
  return is_zero(n);
}

static uint32_t random_point(pls_builder *b, uint32_t size) {
  double p[3];
  for (int k = 0; k < 3; k++) p[k] = rng(size + 1);
  return pls_point(b, p[0], p[1], p[2]);
}

/* Adds a random triangle, parallelogram (maybe with a parallelogram hole), segment or
 * point of the lattice. Returns its area. */
static double add_random(pls_builder *b, uint32_t size) {
  uint32_t kind = rng(8);
  double o[3], u[3] = {0}, w[3] = {0};
  uint32_t p = random_point(b, size);
  memcpy(o, b->x + 3 * p, sizeof o);
  if (kind == 0) return 0;
  if (kind <= 4 || kind == 7) {
    uint32_t q = random_point(b, size);
    if (kind == 7) {
      pls_segment(b, 1, p, q);
      return 0;
    }
    uint32_t r = random_point(b, size);
    if (collinear3(b, p, q, r)) return 0;
    pls_triangle(b, (int32_t)rng(2), p, q, r);
    for (int k = 0; k < 3; k++) {
      u[k] = b->x[3 * q + (uint32_t)k] - o[k];
      w[k] = b->x[3 * r + (uint32_t)k] - o[k];
    }
    double n[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  int axis = (int)rng(3), x = (axis + 1) % 3, y = (axis + 2) % 3;
  u[x] = 1 + rng(size);
  w[y] = 1 + rng(size);
  uint32_t v[3];
  v[0] = pls_point(b, o[0] + u[0], o[1] + u[1], o[2] + u[2]);
  v[1] = pls_point(b, o[0] + u[0] + w[0], o[1] + u[1] + w[1], o[2] + u[2] + w[2]);
  v[2] = pls_point(b, o[0] + w[0], o[1] + w[1], o[2] + w[2]);
  pls_quad(b, (int32_t)rng(2), p, v[0], v[1], v[2]);
  double area = u[x] * w[y];
  if (kind != 5 || u[x] < 3 || w[y] < 3) return area;
  double c[4][3], hole[3];
  for (int i = 0; i < 4; i++) {
    memcpy(c[i], o, sizeof o);
    c[i][x] += 1 + (i == 1 || i == 2);
    c[i][y] += 1 + (i >= 2);
  }
  uint32_t r[4];
  for (int i = 0; i < 4; i++) r[i] = pls_point(b, c[i][0], c[i][1], c[i][2]);
  pls_polygon(b, 4, r);
  memcpy(hole, o, sizeof o);
  hole[x] += 1.25;
  hole[y] += 1.5;
  pls_hole(b, hole[0], hole[1], hole[2]);
  return area - 1;
}

/* The triangles of a facet of the test, which is a triangle, a parallelogram or one
 * with a parallelogram cut out; `turn` says by which diagonal. A hole is not cut out. */
static int facet_triangles(const pls_builder *b, uint32_t f, uint32_t turn, vec t[2][3]) {
  uint32_t p = b->facet_start[f], i0 = b->polygon_start[p], n = b->polygon_start[p + 1] - i0;
  for (uint32_t k = 0; k + 2 < n; k++) {
    get(b->x, b->polygon_vertices[i0 + turn], t[k][0]);
    get(b->x, b->polygon_vertices[i0 + (turn + k + 1) % n], t[k][1]);
    get(b->x, b->polygon_vertices[i0 + (turn + k + 2) % n], t[k][2]);
  }
  return (int)n - 2;
}

static int vertex_in_closed(const vec v, const vec t[3]) {
  int s[3];
  if (height(v, t) != 0) return 0;
  edge_sides(v, t, s);
  return s[0] >= 0 && s[1] >= 0 && s[2] >= 0;
}

/* The line between two common vertices runs inside both triangles. */
static int cross_between_vertices(const vec t[3], const vec u[3]) {
  vec at[6], t2[3], u2[3], mid;
  int n = 0;
  for (int j = 0; j < 3; j++) {
    if (vertex_in_closed(t[j], u)) memcpy(at[n++], t[j], sizeof mid);
    if (vertex_in_closed(u[j], t)) memcpy(at[n++], u[j], sizeof mid);
    for (int k = 0; k < 3; k++) {
      t2[j][k] = 2 * t[j][k];
      u2[j][k] = 2 * u[j][k];
    }
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) {
      for (int k = 0; k < 3; k++) mid[k] = at[i][k] + at[j][k];
      if (vertex_in_triangle(mid, (const vec *)t2) && vertex_in_triangle(mid, (const vec *)u2)) return 1;
    }
  return 0;
}

/* The sides pq of one triangle and rs of another cross. */
static int sides_cross(const vec p, const vec q, const vec r, const vec s) {
  vec u, w, n;
  sub(q, p, u);
  sub(s, r, w);
  cross(u, w, n);
  return !is_zero(n) && segments_meet(p, q, r, s);
}

/* Two triangles overlap, one goes through the other, or sides cross: not if they
 * only touch, nor if a side of one lies in the other. */
static int improper(const vec t[3], const vec u[3]) {
  int coplanar = !height(t[0], u) && !height(t[1], u) && !height(t[2], u);
  for (int j = 0; j < 3; j++) {
    const vec *p[2] = {t, u};
    for (int k = 0; k < 2; k++) {
      const vec *q = p[k], *r = p[1 - k];
      int in_plane = !height(q[j], r) && !height(q[(j + 1) % 3], r);
      if ((coplanar || !in_plane) && segment_meets_triangle(q[j], q[(j + 1) % 3], r)) return 1;
      for (int i = 0; i < 3; i++)
        if (sides_cross(q[j], q[(j + 1) % 3], r[i], r[(i + 1) % 3])) return 1;
    }
  }
  return cross_between_vertices(t, u);
}

/* A side of facet f, one of a hole too, crosses a side of facet g. */
static int borders_cross(const pls_builder *b, uint32_t f, uint32_t g) {
  uint32_t facet[2] = {f, g}, n[2] = {0};
  vec side[2][16][2];
  for (int k = 0; k < 2; k++)
    for (uint32_t p = b->facet_start[facet[k]]; p < b->facet_start[facet[k] + 1]; p++) {
      uint32_t i0 = b->polygon_start[p], m = b->polygon_start[p + 1] - i0;
      for (uint32_t i = 0; i < m; i++, n[k]++) {
        get(b->x, b->polygon_vertices[i0 + i], side[k][n[k]][0]);
        get(b->x, b->polygon_vertices[i0 + (i + 1) % m], side[k][n[k]][1]);
      }
    }
  for (uint32_t i = 0; i < n[0]; i++)
    for (uint32_t j = 0; j < n[1]; j++)
      if (sides_cross(side[0][i][0], side[0][i][1], side[1][j][0], side[1][j][1])) return 1;
  return 0;
}

static void check_refusal(const pls_builder *b, const tet_error *e, uint32_t seed) {
  assert_true(e->n_offences >= 1 && e->n_listed >= 1);
  for (uint32_t i = 0; i < e->n_listed; i++) {
    const tet_offence *o = &e->offences[i];
    if (o->kind[0] != TET_OFFENDER_FACET || o->kind[1] != TET_OFFENDER_FACET) continue;
    vec t[2][3], u[2][3];
    int found = borders_cross(b, o->index[0], o->index[1]);
    for (uint32_t turns = 0; turns < 4; turns++) {
      int n = facet_triangles(b, o->index[0], turns & 1, t), m = facet_triangles(b, o->index[1], turns >> 1, u);
      for (int j = 0; j < n; j++)
        for (int k = 0; k < m; k++) found |= improper((const vec *)t[j], (const vec *)u[k]);
    }
    if (!found) fail_msg("seed %u: facets %u and %u do not cross", seed, o->index[0], o->index[1]);
  }
}

/* One random PLS; returns 1 if it was accepted. */
static int one(uint32_t seed, uint32_t items, uint32_t size) {
  tet_ctx *ctx;
  tet_surface s;
  rng_state = seed * 0x9e3779b97f4a7c15ULL + 1;
  for (int i = 0; i < 8; i++) rng(2);
  pls_builder *b = pls_new();
  double area = 0;
  for (uint32_t i = 0; i < items; i++) area += add_random(b, size);
  pls_point(b, 0, 0, 0);
  pls_point(b, 50, 0, 0);
  pls_point(b, 0, 50, 0);
  pls_point(b, 0, 0, 50);
  double *scaled = malloc(3 * b->pls.n_points * sizeof *scaled); /* b->x stays the lattice */
  assert_non_null(scaled);
  for (uint32_t i = 0; i < 3 * b->pls.n_points; i++) scaled[i] = b->x[i] * scale;
  b->pls.points = b->points.x = scaled;
  for (uint32_t i = 0; i < 3 * b->pls.n_facet_holes; i++) b->facet_holes[i] *= scale;
  b->points.max_abs *= scale;
  assert_int_equal(tet_ctx_create(NULL, &ctx), TET_OK);
  tet_status st = pls_surface(b, ctx, &s);
  if (st == TET_OK) {
    const char *fault = surface_fault(&s, &b->points);
    if (!fault) fault = complex_fault(&s, b);
    if (!fault && scale == 1 && s.n_repeated_facets == 0 && fabs(surface_area(&s, &b->points) - area) > 1e-9) fault = "area lost";
    if (fault) fail_msg("seed %u, %u items, size %u: %s", seed, items, size, fault);
    tet_surface_free(ctx, &s);
  } else if (st == TET_E_INTERSECTION) {
    check_refusal(b, tet_ctx_error(ctx), seed);
  } else {
    fail_msg("seed %u, %u items, size %u: %s", seed, items, size, tet_ctx_error(ctx)->message);
  }
  assert_int_equal(tet_ctx_bytes(ctx), 0);
  tet_ctx_free(ctx);
  pls_free(b);
  free(scaled);
  return st == TET_OK;
}

static uint32_t run(uint32_t cases) {
  uint32_t accepted = 0;
  for (uint32_t seed = 0; seed < cases; seed++) accepted += (uint32_t)one(seed, 2 + seed % 5, 2 + seed / 5 % 4);
  return accepted;
}

static void lattice(void **state) {
  const char *more = getenv("TETRAD_CASES");
  uint32_t cases = more ? (uint32_t)strtoul(more, NULL, 10) : 6000, accepted = run(cases);
  (void)state;
  print_message("%u of %u accepted\n", accepted, cases);
  assert_true(accepted > cases / 10 && accepted < cases);
}

/* Nothing depends on the size of the coordinates, up to the limit and down to where
 * a quarter of the lattice's step is the least double. */
static void other_scales(void **state) {
  static const double scales[] = {0x1p494, 0x1p-300, 0x1p-1070};
  uint32_t expected = run(500);
  (void)state;
  for (int i = 0; i < 3; i++) {
    scale = scales[i];
    assert_int_equal(run(500), expected);
  }
  scale = 1;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(lattice), cmocka_unit_test(other_scales)};
  return cmocka_run_group_tests_name("surface random", tests, NULL, NULL);
}
