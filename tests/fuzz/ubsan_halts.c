// SPDX-License-Identifier: Apache-2.0
// What the undefined behaviour sanitizer finds ends a libFuzzer driver, and so is kept as a crash,
// whatever the environment says: else it would be a line in a log.

const char *__ubsan_default_options(void);

const char *__ubsan_default_options(void) {
  return "print_stacktrace=1:halt_on_error=1";
}
