// SPDX-License-Identifier: Apache-2.0
/* Circumcentres of tetrahedra that are flat but for the last bits of their coordinates. */
#include "refine/refiner.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define A 0.00062583315273508143
#define B 0.0010126193124118659
#define C 0.0025083591391221365
#define D 0.0040586103430910432

typedef struct flat {
  double x[12], centre[3];
} flat;

static const flat cases[] = {
  {{D, 0, -C, 0, -C, -D, -C, -D, 0, 0, -C, D}, {0, 0, 0}}, /* faces of a dodecahedron about the origin */
  {{A, -B, 0, B, 0, -A, 0, A, B, A, B, 0}, {0, 0, 0}},
  {{2.877, 0, 1.25, 2, 0, 0, 4, 2, 0, 4, 1.123, 1.25}, {2.877, 1.123, 0.3173484}},
};

static void a_flat_tetrahedron_has_the_centre_that_its_bits_leave_it(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double x[12], centre[3], off2 = 0, radius2 = 0;
    uint32_t v[4] = {0, 1, 2, 3};
    refine_shape shape;
    memcpy(x, cases[k].x, sizeof x);
    refiner r = {.points = {.x = x, .n = 4, .first_implicit = TET_NONE}, .mesh = {.v = v}};
    if (tet_orient3d(&r.points, 0, 1, 2, 3) < 0) v[0] = 1, v[1] = 0;
    assert_true(tet_orient3d(&r.points, v[0], v[1], v[2], v[3]) > 0);
    refine_measure(&r, 0, &shape);
    refine_circumcentre(&r, 0, &shape, centre);
    for (int i = 0; i < 3; i++) {
      double off = centre[i] - cases[k].centre[i], reach = x[i] - cases[k].centre[i];
      off2 += off * off;
      radius2 += reach * reach;
    }
    assert_true(off2 < 1e-28 * radius2);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_flat_tetrahedron_has_the_centre_that_its_bits_leave_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
