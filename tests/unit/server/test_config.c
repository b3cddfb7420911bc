// SPDX-License-Identifier: Apache-2.0
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/daemon/config.h"

static void refuse_text(const char *text, const char *named) {
  config c;
  char error[CONFIG_ERROR] = "";
  config_init(&c);
  assert_false(config_read_text(&c, text, strlen(text), "file", error));
  if (!strstr(error, named)) fail_msg("\"%s\" does not name %s", error, named);
  config_free(&c);
}

static void test_file(void **state) {
  (void)state;
  static const char text[] =
      "{\"unix\": [\"/a\", \"/b\"], \"tcp\": [\"127.0.0.1:0\"], \"workers\": 3, \"instance\": \"n-1\","
      " \"spool\": \"/s\", \"unix_mode\": \"0660\", \"worker_prefix\": [\"nice\", \"-n5\"],"
      " \"tokens\": {\"ann\": \"secret\"}, \"limits\": {\"max_body\": 4096, \"stall_ms\": 100}}";
  config c;
  char error[CONFIG_ERROR] = "";
  config_init(&c);
  assert_true(config_read_text(&c, text, strlen(text), "file", error));
  assert_true(config_finish(&c, error));
  assert_int_equal(c.unix_paths.count, 2);
  assert_string_equal(c.unix_paths.items[1], "/b");
  assert_string_equal(c.worker_prefix.items[1], "-n5");
  assert_null(c.worker_prefix.items[2]);
  assert_int_equal(c.workers, 3);
  assert_int_equal(c.unix_mode, 0660);
  assert_string_equal(c.instance, "n-1");
  assert_string_equal(c.tokens[0].name, "ann");
  assert_int_equal(c.limits.max_body, 4096);
  assert_int_equal(c.limits.stall_ms, 100);
  assert_true(c.limits.memory_bytes > 0);
  assert_true(c.limits.memory_bytes < c.limits.worker_memory_bytes);
  config_free(&c);
}

static void test_refusals(void **state) {
  (void)state;
  refuse_text("{\"wrokers\": 3}", "wrokers");
  refuse_text("{\"workers\": 0}", "workers");
  refuse_text("{\"workers\": \"3\"}", "workers");
  refuse_text("{\"unix\": \"/a\"}", "unix");
  refuse_text("{\"unix_mode\": \"0999\"}", "unix_mode");
  refuse_text("{\"tokens\": {\"ann\": 3}}", "tokens");
  refuse_text("{\"limits\": {\"max_bod\": 1}}", "max_bod");
  refuse_text("{\"limits\": {\"max_requests\": 0}}", "max_requests");
  refuse_text("{\"limits\": {\"max_body\": 1.5}}", "max_body");
  refuse_text("{\"workers\": 1, \"workers\": 2}", "file:1:");
  refuse_text("{\n\"workers\": \n", "file:");
  refuse_text("[]", "not a JSON object");
}

/* Reads options; on success they must also fit together. */
static bool read_options(config *c, char error[CONFIG_ERROR], int argc, const char *const *argv) {
  char *copy[16] = {NULL};
  for (int i = 0; i < argc; i++) copy[i] = (char *)(uintptr_t)argv[i];
  config_init(c);
  return config_read_options(c, argc, copy, error) && config_finish(c, error);
}

static void refuse_options(int argc, const char *const *argv, const char *named) {
  config c;
  char error[CONFIG_ERROR] = "";
  assert_false(read_options(&c, error, argc, argv));
  if (!strstr(error, named)) fail_msg("\"%s\" does not name %s", error, named);
  config_free(&c);
}

#define REFUSE(named, ...)                                                                         \
  do {                                                                                             \
    const char *const argv[] = {"tetrad", __VA_ARGS__};                                            \
    refuse_options(sizeof argv / sizeof *argv, argv, named);                                       \
  } while (0)

static void test_bad_options(void **state) {
  (void)state;
  REFUSE("listen", "--workers", "2");
  REFUSE("--bogus", "--bogus");
  REFUSE("--unix", "--unix");
  REFUSE("stray", "--unix", "/a", "stray");
  REFUSE("workers", "--unix", "/a", "--workers", "0");
  REFUSE("workers", "--unix", "/a", "--workers", "2x");
  REFUSE("unix-mode", "--unix", "/a", "--unix-mode", "rw");
  REFUSE("token-file", "--unix", "/a", "--token-file", "/nonexistent/tokens");
  REFUSE("--inherit", "--unix", "/a", "--inherit", "3");
  REFUSE("0.0.0.0:1", "--tcp", "0.0.0.0:1");
  REFUSE("Capital", "--unix", "/a", "--instance", "Capital");
  REFUSE("/nonexistent/config", "--config", "/nonexistent/config");
}

static void test_options_after_the_file(void **state) {
  (void)state;
  char path[] = "/tmp/test_config_XXXXXX", tokens[] = "/tmp/test_tokens_XXXXXX";
  char error[CONFIG_ERROR] = "";
  config c;
  int fd = mkstemp(path), token_fd = mkstemp(tokens);
  assert_true(fd >= 0 && token_fd >= 0);
  assert_true(dprintf(fd, "{\"unix\": [\"/a\"], \"workers\": 3, \"spool\": \"/s\"}") > 0);
  assert_true(dprintf(token_fd, "# name secret\n\nann  s3cret\nbob other\n") > 0);
  const char *const argv[] = {"tetrad", "--workers", "5",     "--unix",       "/b",
                              "--tcp",  "0.0.0.0:7", "--config", path, "--token-file", tokens};
  assert_true(read_options(&c, error, sizeof argv / sizeof *argv, argv));
  assert_int_equal(c.workers, 5);
  assert_int_equal(c.unix_paths.count, 2);
  assert_string_equal(c.unix_paths.items[0], "/a");
  assert_string_equal(c.spool, "/s");
  assert_int_equal(c.n_tokens, 2);
  assert_string_equal(c.tokens[0].secret, "s3cret");
  assert_string_equal(c.tokens[1].name, "bob");
  config_free(&c);
  close(fd);
  close(token_fd);
  unlink(path);
  unlink(tokens);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_file),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_bad_options),
      cmocka_unit_test(test_options_after_the_file),
  };
  return cmocka_run_group_tests_name("config", tests, NULL, NULL);
}
