// SPDX-License-Identifier: Apache-2.0
/* rows.c: the tetrahedra of a complex in a form to be compared. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "rows.h"

static int compare(const void *a, const void *b) {
  const uint32_t *x = a, *y = b;
  for (int i = 0; i < 4; i++)
    if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
  return 0;
}

static rows gather(const tet_complex *c, int ghosts) {
  rows r = {malloc(((size_t)c->n_slots + 1) * sizeof *r.row), 0};
  assert_non_null(r.row);
  for (uint32_t t = 0; t < c->n_slots; t++) {
    uint32_t *v = r.row[r.n];
    if (!tet_is_live(c, t) || (!ghosts && tet_is_ghost(c, t))) continue;
    memcpy(v, c->v + 4 * (size_t)t, sizeof *r.row);
    for (int i = 1; i < 4; i++)
      for (int j = i; j > 0 && v[j - 1] > v[j]; j--) {
        uint32_t swap = v[j];
        v[j] = v[j - 1];
        v[j - 1] = swap;
      }
    r.n++;
  }
  qsort(r.row, r.n, sizeof *r.row, compare);
  return r;
}

rows sorted_rows(const tet_complex *c) { return gather(c, 1); }
rows finite_rows(const tet_complex *c) { return gather(c, 0); }

void check_same(const rows *a, const rows *b) {
  assert_int_equal(a->n, b->n);
  assert_int_equal(memcmp(a->row, b->row, a->n * sizeof *a->row), 0);
}
