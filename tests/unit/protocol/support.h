// SPDX-License-Identifier: Apache-2.0
/* support.h: what the tests of protocol/ share: cmocka with its needs, and a small
 * deterministic generator. */
#ifndef TETRAD_TESTS_PROTOCOL_SUPPORT_H
#define TETRAD_TESTS_PROTOCOL_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* xorshift64*; the state is not 0. */
static inline uint64_t draw(uint64_t *state) {
  *state ^= *state >> 12;
  *state ^= *state << 25;
  *state ^= *state >> 27;
  return *state * UINT64_C(2685821657736338717);
}

#endif
