// SPDX-License-Identifier: Apache-2.0
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <event2/event.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/daemon/spool.h"

typedef struct outcome {
  struct event_base *base;
  int calls, error;
} outcome;

static void on_end(void *user, int error) {
  outcome *o = user;
  o->calls++;
  o->error = error;
  event_base_loopbreak(o->base);
}

static void *block(char letter, size_t size) {
  char *data = malloc(size);
  assert_non_null(data);
  memset(data, letter, size);
  return data;
}

typedef struct fixture {
  char parent[32];
  struct event_base *base;
  spool *spool;
  outcome outcome;
} fixture;

enum { LIMIT = 100000 };

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  strcpy(f->parent, "/tmp/test_spool_XXXXXX");
  if (!mkdtemp(f->parent)) return -1;
  f->base = event_base_new();
  f->spool = spool_create(f->base, f->parent, LIMIT);
  f->outcome.base = f->base;
  *state = f;
  return f->spool ? 0 : -1;
}

/* Nothing may be left in the parent folder: rmdir tells. */
static int tear_down(void **state) {
  fixture *f = *state;
  spool_free(f->spool);
  event_base_free(f->base);
  int left = rmdir(f->parent);
  free(f);
  return left;
}

static void test_written_in_order(void **state) {
  fixture *f = *state;
  char read_back[30];
  uint64_t offset;
  spool_file *file = spool_file_create(f->spool, on_end, &f->outcome);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(spool_file_append(file, block((char)('a' + i), 10), 10, &offset), 0);
    assert_int_equal(offset, 10 * i);
  }
  spool_file_finish(file);
  assert_int_equal(f->outcome.calls, 0);
  event_base_dispatch(f->base);
  assert_int_equal(f->outcome.calls, 1);
  assert_int_equal(f->outcome.error, 0);
  int fd = spool_file_open(file);
  assert_int_equal(read(fd, read_back, sizeof read_back), 30);
  assert_memory_equal(read_back, "aaaaaaaaaabbbbbbbbbbcccccccccc", 30);
  spool_file_drop(file);
  close(fd);
}

static void test_the_limit(void **state) {
  fixture *f = *state;
  uint64_t offset = 7;
  spool_file *file = spool_file_create(f->spool, on_end, &f->outcome);
  assert_int_equal(spool_file_append(file, block('a', LIMIT + 1), LIMIT + 1, &offset), ENOSPC);
  assert_int_equal(offset, 7);
  assert_false(spool_full(f->spool));
  assert_int_equal(spool_file_append(file, block('a', LIMIT), LIMIT, &offset), 0);
  assert_true(spool_full(f->spool));
  assert_int_equal(spool_bytes(f->spool), LIMIT);
  spool_file_drop(file);
  assert_int_equal(spool_bytes(f->spool), 0);
}

static void test_an_empty_file(void **state) {
  fixture *f = *state;
  spool_file *file = spool_file_create(f->spool, on_end, &f->outcome);
  spool_file_finish(file);
  event_base_dispatch(f->base);
  assert_int_equal(f->outcome.error, 0);
  assert_int_equal(spool_file_bytes(file), 0);
  spool_file_drop(file);
}

/* A dropped file is gone and does not call back. */
static void test_dropped(void **state) {
  fixture *f = *state;
  outcome other = {f->base, 0, 0};
  uint64_t offset;
  spool_file *file = spool_file_create(f->spool, on_end, &f->outcome);
  spool_file *last = spool_file_create(f->spool, on_end, &other);
  assert_int_equal(spool_file_append(file, block('a', 10), 10, &offset), 0);
  spool_file_finish(file);
  spool_file_drop(file);
  spool_file_finish(last); /* comes after: operations are in order */
  event_base_dispatch(f->base);
  assert_int_equal(f->outcome.calls, 0);
  assert_int_equal(other.calls, 1);
  spool_file_drop(last);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_written_in_order, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_the_limit, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_an_empty_file, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_dropped, set_up, tear_down),
  };
  return cmocka_run_group_tests_name("spool", tests, NULL, NULL);
}
