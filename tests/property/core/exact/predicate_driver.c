// SPDX-License-Identifier: Apache-2.0
// Evaluates predicates on cases read from standard input, for test_predicates.py.
// A line: name axis count, then `count` points: "e x y z" (explicit) or
// "i ax ay az bx by bz t" (implicit on a segment). Numbers are hexadecimal floats.
// The answer is a line with the sign; for "round" the rounded first point. Where all
// points are explicit, the variant on raw coordinates must agree, and the exact stage
// with dyadic numbers, which the quick ones before it hide, always; else "differ".
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "exact/exact_stage.h"
#include "exact/predicates.h"

enum { MAX_POINTS = 5 };

typedef struct instance {
  char name[32];
  int axis, count, explicit_only;
  double x[3 * 3 * MAX_POINTS];
  tet_segment_point implicit[MAX_POINTS];
  uint32_t v[MAX_POINTS]; /* the vertex number of each point */
  tet_points points;
} instance;

static int read_numbers(double *x, int n) {
  for (int i = 0; i < n; i++) {
    if (scanf("%la", &x[i]) != 1)
      return 0;
  }
  return 1;
}

/* Explicit vertices first: those given, and the ends of the segments. */
static int read_instance(instance *c) {
  if (scanf("%31s %d %d", c->name, &c->axis, &c->count) != 3)
    return 0;
  if (c->count < 1 || c->count > MAX_POINTS)
    exit(2);
  uint32_t n = 0, implicit = 0;
  int is_implicit[MAX_POINTS] = {0};
  for (int i = 0; i < c->count; i++) {
    char kind[2];
    if (scanf("%1s", kind) != 1)
      exit(2);
    is_implicit[i] = kind[0] == 'i';
    if (!read_numbers(c->x + 3 * n, is_implicit[i] ? 6 : 3))
      exit(2);
    if (is_implicit[i]) {
      tet_segment_point *s = &c->implicit[implicit];
      s->a = n++;
      s->b = n++;
      if (!read_numbers(&s->t, 1))
        exit(2);
      c->v[i] = implicit++;
    } else {
      c->v[i] = n++;
    }
  }
  c->explicit_only = implicit == 0;
  c->points = (tet_points){
      .x = c->x, .n = n + implicit, .first_implicit = n, .implicit = c->implicit, .max_abs = 0};
  for (uint32_t i = 0; i < implicit; i++) {
    tet_segment_point_round(&c->points, &c->implicit[i], c->x + 3 * (n + i));
  }
  for (int i = 0; i < c->count; i++) {
    if (is_implicit[i])
      c->v[i] += n;
  }
  return 1;
}

static int evaluate(const instance *c, int *ret_raw) {
  const tet_points *p = &c->points;
  const uint32_t *v = c->v;
  const double *q[MAX_POINTS] = {0};
  for (int i = 0; i < c->count; i++)
    q[i] = p->x + 3 * v[i];
  if (strcmp(c->name, "orient3d") == 0) {
    *ret_raw = tet_orient3d_xyz(q[0], q[1], q[2], q[3]);
    return tet_orient3d(p, v[0], v[1], v[2], v[3]);
  }
  if (strcmp(c->name, "insphere") == 0) {
    *ret_raw = tet_insphere_xyz(q[0], q[1], q[2], q[3], q[4]);
    return tet_insphere(p, v[0], v[1], v[2], v[3], v[4]);
  }
  if (strcmp(c->name, "orient2d") == 0) {
    *ret_raw = tet_orient2d_xyz(c->axis, q[0], q[1], q[2]);
    return tet_orient2d(p, c->axis, v[0], v[1], v[2]);
  }
  if (strcmp(c->name, "collinear") == 0) {
    *ret_raw = tet_collinear_xyz(q[0], q[1], q[2]);
    return tet_collinear(p, v[0], v[1], v[2]);
  }
  if (strcmp(c->name, "dot_sign") == 0) {
    *ret_raw = tet_dot_sign_xyz(q[0], q[1], q[2]);
    return tet_dot_sign(p, v[0], v[1], v[2]);
  }
  if (strcmp(c->name, "compare_distance") == 0) {
    *ret_raw = tet_compare_distance_xyz(q[0], q[1], q[2]);
    return tet_compare_distance(p, v[0], v[1], v[2]);
  }
  if (strcmp(c->name, "in_diametric_ball3") == 0) {
    *ret_raw = tet_in_diametric_ball3_xyz(q[0], q[1], q[2], q[3]);
    return tet_in_diametric_ball3(p, v[0], v[1], v[2], v[3]);
  }
  exit(2);
}

/* 1 where the last stage, asked alone, says the same. */
static int last_stage_agrees(const instance *c, int sign) {
  tet_point_ref ref[MAX_POINTS];
  for (int i = 0; i < c->count; i++)
    ref[i] = tet_ref(&c->points, c->v[i]);
  if (strcmp(c->name, "orient3d") == 0)
    return tet_exact_orient3d(ref) == sign;
  if (strcmp(c->name, "insphere") == 0)
    return tet_exact_insphere(ref) == sign;
  if (strcmp(c->name, "orient2d") == 0)
    return tet_exact_orient2d(c->axis, ref) == sign;
  if (strcmp(c->name, "dot_sign") == 0)
    return tet_exact_dot_sign(ref) == sign;
  if (strcmp(c->name, "compare_distance") == 0)
    return tet_exact_compare_distance(ref) == sign;
  if (strcmp(c->name, "in_diametric_ball3") == 0)
    return tet_exact_diametric_ball3(ref) == sign;
  return 1; /* collinear has no stage of its own */
}

int main(void) {
  static instance c;
  while (read_instance(&c)) {
    if (strcmp(c.name, "round") == 0) {
      const double *x = c.x + 3 * c.v[0];
      printf("%a %a %a\n", x[0], x[1], x[2]);
      continue;
    }
    int raw, sign = evaluate(&c, &raw);
    if ((c.explicit_only && raw != sign) || !last_stage_agrees(&c, sign)) {
      printf("differ\n");
    } else {
      printf("%d\n", sign);
    }
  }
  return 0;
}
