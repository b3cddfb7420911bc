// SPDX-License-Identifier: Apache-2.0
/* shapes.c: the tetrahedra that a new point will make with the border of its cavity, measured four at a
 * time: before, to know which faces see the point for certain; after, to queue those over a bound. Lane
 * by lane the values are those of refine_measure_roughly, to the last bit. */
#include "base/processor.h"
#include "base/vector.h"
#include "exact/quick.h"
#include "exact/shape.h"
#include "refine/refiner.h"

/* Of the longest edge's square: differences of coordinates are off by 2^-53 of themselves, and differences of these, which
 * are the edges away from the first corner, by that of these: a square by an eighth of the room. Three are compared. */
#define ROOM 1e-14

/* Measures the tetrahedra b[0] to b[3] are to become. */
typedef void measure_four(const refiner *r, const tet_border *const b[4], refine_shapes *ret);

static void measure_one_by_one(const refiner *r, const tet_border *const b[4], refine_shapes *ret) {
  ret->is_sure = ret->is_over = ret->is_positive = 0;
  for (int lane = 0; lane < 4; lane++) {
    refine_shape s;
    const uint32_t *v = b[lane]->v;
    ret->is_sure |= (uint8_t)(refine_measure_roughly(r, v, &s) << lane);
    for (int i = 0; i < 3; i++) ret->to_centre[i][lane] = s.to_centre[i];
    double longest2 = 0;
    for (int e = 0; e < 6; e++) {
      double length2 = tet_distance2(refine_x(r, v[refine_edge[e][0]]), refine_x(r, v[refine_edge[e][1]]));
      ret->length2[e][lane] = length2;
      if (!(length2 <= longest2)) longest2 = length2;
    }
    ret->room[lane] = ROOM * longest2 + TET_QUICK_LEAST;
    ret->volume6[lane] = s.volume6;
    ret->shortest2[lane] = s.shortest2;
    ret->is_over |= (uint8_t)(refine_over_ratio(r, &s) << lane);
    int sign = tet_quick_orient3d(refine_x(r, v[0]), refine_x(r, v[1]), refine_x(r, v[2]), refine_x(r, v[3]), 0);
    ret->is_positive |= (uint8_t)((sign == 1) << lane);
  }
}

#if TET_HAVE_AVX2

/* A vector in each lane. */
typedef struct vectors {
  __m256d c[3];
} vectors;

TET_AVX2 static inline vectors minus(vectors a, vectors b) {
  return (vectors){{_mm256_sub_pd(a.c[0], b.c[0]), _mm256_sub_pd(a.c[1], b.c[1]), _mm256_sub_pd(a.c[2], b.c[2])}};
}

TET_AVX2 static inline __m256d dot(vectors a, vectors b) {
  __m256d xy = _mm256_add_pd(_mm256_mul_pd(a.c[0], b.c[0]), _mm256_mul_pd(a.c[1], b.c[1]));
  return _mm256_add_pd(xy, _mm256_mul_pd(a.c[2], b.c[2]));
}

TET_AVX2 static inline __m256d minor(vectors a, vectors b, int i, int j) {
  return _mm256_sub_pd(_mm256_mul_pd(a.c[i], b.c[j]), _mm256_mul_pd(a.c[j], b.c[i]));
}

TET_AVX2 static inline vectors cross(vectors a, vectors b) {
  return (vectors){{minor(a, b, 1, 2), minor(a, b, 2, 0), minor(a, b, 0, 1)}};
}

/* Corner i of each tetrahedron. */
TET_AVX2 static inline vectors corners(const double *x, const tet_border *const b[4], int i) {
  const double *p = x + 3 * (size_t)b[0]->v[i], *q = x + 3 * (size_t)b[1]->v[i];
  const double *s = x + 3 * (size_t)b[2]->v[i], *t = x + 3 * (size_t)b[3]->v[i];
  __m256d even = _mm256_set_m128d(_mm_loadu_pd(s), _mm_loadu_pd(p));
  __m256d odd = _mm256_set_m128d(_mm_loadu_pd(t), _mm_loadu_pd(q));
  __m128d high = _mm_loadh_pd(_mm_load_sd(s + 2), t + 2), low = _mm_loadh_pd(_mm_load_sd(p + 2), q + 2);
  return (vectors){{_mm256_unpacklo_pd(even, odd), _mm256_unpackhi_pd(even, odd), _mm256_set_m128d(high, low)}};
}

/* The sums and products of refine_measure_roughly, refine_over_ratio and tet_quick_orient3d, in their order and
 * none fused. */
TET_AVX2 static void measure_avx2(const refiner *r, const tet_border *const b[4], refine_shapes *ret) {
  const double *x = r->points.x;
  vectors o = corners(x, b, 0), A = minus(corners(x, b, 1), o), B = minus(corners(x, b, 2), o);
  vectors C = minus(corners(x, b, 3), o), bc = cross(B, C), ca = cross(C, A), ab = cross(A, B), e[3];
  __m256d aa = dot(A, A), bb = dot(B, B), cc = dot(C, C);
  e[0] = minus(A, B);
  e[1] = minus(C, A);
  e[2] = minus(B, C);
  __m256d least = _mm256_min_pd(_mm256_min_pd(aa, bb), cc), shortest = least, length2[6] = {aa, bb, cc};
  for (int i = 0; i < 3; i++) shortest = _mm256_min_pd(shortest, length2[3 + i] = dot(e[i], e[i]));
  for (int i = 0; i < 6; i++) _mm256_storeu_pd(ret->length2[i], length2[i]);
  __m256d longest = _mm256_max_pd(_mm256_max_pd(length2[3], length2[4]), _mm256_max_pd(length2[5], _mm256_max_pd(aa, bb)));
  longest = _mm256_mul_pd(_mm256_max_pd(longest, cc), _mm256_set1_pd(ROOM));
  _mm256_storeu_pd(ret->room, _mm256_add_pd(longest, _mm256_set1_pd(TET_QUICK_LEAST)));
  __m256d volume6 = dot(A, bc);
  vectors centre;
  for (int i = 0; i < 3; i++) {
    __m256d sum = _mm256_add_pd(_mm256_mul_pd(aa, bc.c[i]), _mm256_mul_pd(bb, ca.c[i]));
    centre.c[i] = _mm256_add_pd(sum, _mm256_mul_pd(cc, ab.c[i]));
    _mm256_storeu_pd(ret->to_centre[i], centre.c[i]);
  }
  _mm256_storeu_pd(ret->volume6, volume6);
  _mm256_storeu_pd(ret->shortest2, shortest);

  __m256d zero = _mm256_setzero_pd(), is_up = _mm256_cmp_pd(volume6, zero, _CMP_GT_OQ);
  __m256d reach = _mm256_mul_pd(_mm256_mul_pd(_mm256_set1_pd(2), volume6), _mm256_set1_pd(r->o.radius_edge));
  __m256d bound = _mm256_mul_pd(_mm256_mul_pd(_mm256_mul_pd(reach, reach), shortest), _mm256_set1_pd(REFINE_SLACK));
  __m256d holds = _mm256_and_pd(is_up, _mm256_cmp_pd(dot(centre, centre), bound, _CMP_LE_OQ));
  ret->is_over = (uint8_t)(~_mm256_movemask_pd(holds) & 15);

  __m256d volume2 = _mm256_mul_pd(volume6, volume6), most = _mm256_mul_pd(_mm256_mul_pd(aa, bb), cc);
  __m256d least_sure = _mm256_mul_pd(_mm256_set1_pd(TET_SURE_SHAPE), most);
  ret->is_sure = (uint8_t)_mm256_movemask_pd(_mm256_cmp_pd(volume2, least_sure, _CMP_GT_OQ));

  __m256d limit = _mm256_mul_pd(_mm256_set1_pd(TET_QUICK_ORIENT3D), most);
  limit = _mm256_add_pd(limit, _mm256_set1_pd(TET_QUICK_LEAST));
  __m256d is_sure = _mm256_cmp_pd(volume2, limit, _CMP_GT_OQ);
  is_sure = _mm256_and_pd(is_sure, _mm256_cmp_pd(least, _mm256_set1_pd(TET_QUICK_ORIENT3D_ROW), _CMP_GT_OQ));
  ret->is_positive = (uint8_t)_mm256_movemask_pd(_mm256_and_pd(is_sure, is_up));
}

#else
#define measure_avx2 measure_one_by_one
#endif

/* Fills r->cavity.shapes for the border as it is. */
tet_status refine_measure_border(refiner *r) {
  const tet_complex *m = &r->mesh;
  refine_cavity *c = &r->cavity;
  size_t n = (m->n_border + 3) / 4;
  measure_four *measure = TET_HAVE_AVX2 && tet_has_avx2() ? measure_avx2 : measure_one_by_one;
  tet_status status = tet_grow(r->ctx, &c->shapes, &c->cap_shapes, n, sizeof *c->shapes);
  for (size_t k = 0; k < n && !status; k++) {
    const tet_border *b[4];
    for (size_t lane = 0; lane < 4; lane++) /* the last ones stand in for those that are not there */
      b[lane] = &m->border[4 * k + lane < m->n_border ? 4 * k + lane : m->n_border - 1];
    measure(r, b, &c->shapes[k]);
  }
  return status;
}
