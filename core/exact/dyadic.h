// SPDX-License-Identifier: Apache-2.0
// Dyadic numbers (integer times a power of two) of any length that predicates
// need: exact add, subtract, multiply and sign. There is no division, no
// rounding (but for one conversion to the nearest double) and no allocation:
// limbs come from a space on the caller's stack, taken in a row and given back
// all at once, so that only the limbs in use are ever touched.
//
// Numbers are values that refer to limbs in their space: cheap to copy, never
// changed once made.
#ifndef TETRAD_CORE_EXACT_DYADIC_H
#define TETRAD_CORE_EXACT_DYADIC_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

__extension__ typedef unsigned __int128 tet_uint128;

/** sign * (sum limb[i] 2^(64 i)) * 2^exp. Zero: sign == 0 and n == 0. Otherwise
 * limb[n-1] != 0. A zero has an exponent too, so that sums of terms of equal
 * exponents need no shift. */
typedef struct tet_dyadic {
  const uint64_t *limb;
  uint32_t n;
  int32_t exp;
  int32_t sign;
} tet_dyadic;

/** Limbs for the largest evaluation of a predicate: insphere of five implicit
 * points. Such a point spans at most 1024 + 2148 bits, 50 limbs, whatever finite
 * doubles define it (51 after a subtraction). In limbs: five points of 3 (50 + 50 +
 * 2 * 51 + shift 51), 12 differences of 102, 6 minors of 3 * 102, 4 determinants
 * of 5 * 154, 4 lifts of 5 * 103, and 4 products and 3 sums of at most 3 * 260 with
 * their shifts: under 15000. */
enum { TET_DYADIC_SPACE = 16384 };

typedef struct tet_dyadic_space {
  uint64_t *top; /* the first free limb */
  uint64_t limb[TET_DYADIC_SPACE];
} tet_dyadic_space;

/** Must be called once before use; touches one word. */
static inline void tet_dyadic_begin(tet_dyadic_space *w) {
  w->top = w->limb;
}

/** The parts of a finite double: x = sign * mantissa * 2^exp with an odd mantissa.
 * Returns the sign; 0 leaves mantissa 0 and exp 0. */
int tet_double_parts(double x, uint64_t *mantissa, int32_t *exp);

/** The finite double x, as an integer times 2^exp. exp must not exceed the
 * exponent of the lowest bit set in x. */
tet_dyadic tet_dyadic_from_double(tet_dyadic_space *w, double x, int32_t exp);

/** The same for an x at its own exponent (an odd integer times 2^exp). */
tet_dyadic tet_dyadic_from_double_reduced(tet_dyadic_space *w, double x);

/** The nearest double, ties to even; an infinity if too large. */
double tet_dyadic_to_double(const tet_dyadic *a);

/* The general cases of the operations below. */
tet_dyadic tet_dyadic_mul_long(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b);
tet_dyadic tet_dyadic_add_long(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b,
                               int32_t sign_b);

static inline tet_dyadic tet_dyadic_zero(int32_t exp) {
  return (tet_dyadic){.limb = 0, .n = 0, .exp = exp, .sign = 0};
}

static inline tet_dyadic tet_dyadic_neg(tet_dyadic a) {
  a.sign = -a.sign;
  return a;
}

/** a b, with exponent a.exp + b.exp. */
static inline tet_dyadic tet_dyadic_mul(tet_dyadic_space *w, tet_dyadic a, tet_dyadic b) {
  if (a.n != 1 || b.n != 1)
    return tet_dyadic_mul_long(w, &a, &b);
  tet_uint128 r = (tet_uint128)a.limb[0] * b.limb[0];
  uint64_t *out = w->top, high = (uint64_t)(r >> 64);
  out[0] = (uint64_t)r;
  out[1] = high;
  uint32_t n = 1u + (high != 0);
  w->top = out + n;
  return (tet_dyadic){.limb = out, .n = n, .exp = a.exp + b.exp, .sign = a.sign * b.sign};
}

/** a + b, with the lesser of the two exponents. */
static inline tet_dyadic tet_dyadic_add(tet_dyadic_space *w, tet_dyadic a, tet_dyadic b) {
  return tet_dyadic_add_long(w, &a, &b, b.sign);
}

/** a - b, with the lesser of the two exponents. */
static inline tet_dyadic tet_dyadic_sub(tet_dyadic_space *w, tet_dyadic a, tet_dyadic b) {
  return tet_dyadic_add_long(w, &a, &b, -b.sign);
}

#ifdef __cplusplus
}
#endif
#endif
