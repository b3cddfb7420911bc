// SPDX-License-Identifier: Apache-2.0
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/daemon/jobs.h"
#include "server/daemon/store.h"

static job *new_job(unsigned number, const char *principal, const char *key) {
  job *j = calloc(1, sizeof *j);
  assert_non_null(j);
  snprintf(j->id, sizeof j->id, "x.%u", number);
  j->number = number;
  j->principal = strdup(principal);
  j->key = key ? strdup(key) : NULL;
  return j;
}

static void test_find(void **state) {
  (void)state;
  store *s = store_create(job_free);
  job *a = new_job(1, "ann", "k"), *b = new_job(2, "bob", "k"), *c = new_job(3, "ann", NULL);
  assert_non_null(s);
  assert_null(store_first(s));
  store_insert(s, a);
  store_insert(s, b);
  store_insert(s, c);
  assert_ptr_equal(store_find(s, "x.1"), a);
  assert_ptr_equal(store_find(s, "x.3"), c);
  assert_null(store_find(s, "x.4"));
  assert_null(store_find(s, ""));
  assert_ptr_equal(store_find_key(s, "ann", "k"), a);
  assert_ptr_equal(store_find_key(s, "bob", "k"), b);
  assert_null(store_find_key(s, "an", "nk"));
  assert_null(store_find_key(s, "ann", "x.1"));
  store_remove(s, a);
  assert_null(store_find(s, "x.1"));
  assert_null(store_find_key(s, "ann", "k"));
  assert_ptr_equal(store_first(s), b);
  assert_ptr_equal(store_next(b), c);
  assert_null(store_next(c));
  assert_int_equal(store_count(s), 2);
  store_free(s);
}

/* Against a plain list, through growth of the tables and removals all over. */
static void test_many(void **state) {
  (void)state;
  enum { JOBS = 3000 };
  store *s = store_create(job_free);
  char id[JOB_ID_SIZE], key[16];
  for (unsigned i = 0; i < JOBS; i++) {
    snprintf(key, sizeof key, "key%u", i / 2);
    store_insert(s, new_job(i, i % 2 ? "ann" : "bob", key));
  }
  for (unsigned i = 0; i < JOBS; i++) {
    snprintf(id, sizeof id, "x.%u", i * 7 % JOBS);
    if (i % 3 == 0) store_remove(s, store_find(s, id));
  }
  size_t present = 0;
  unsigned last = 0;
  for (unsigned i = 0; i < JOBS; i++) {
    unsigned number = i * 7 % JOBS;
    snprintf(id, sizeof id, "x.%u", number);
    snprintf(key, sizeof key, "key%u", number / 2);
    job *j = store_find(s, id);
    assert_ptr_equal(store_find_key(s, number % 2 ? "ann" : "bob", key), j);
    assert_int_equal(j == NULL, i % 3 == 0);
  }
  for (const job *j = store_first(s); j; j = store_next(j)) {
    assert_true(!present || j->number > last);
    last = (unsigned)j->number;
    present++;
  }
  assert_int_equal(present, store_count(s));
  assert_int_equal(present, JOBS - JOBS / 3);
  store_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_find), cmocka_unit_test(test_many)};
  return cmocka_run_group_tests_name("store", tests, NULL, NULL);
}
