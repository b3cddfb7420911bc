// SPDX-License-Identifier: Apache-2.0
// The general cases of dyadic arithmetic: schoolbook, on 64-bit limbs with 128-bit
// products. Numbers here have few limbs (2 to 8 as a rule), where nothing faster
// than schoolbook exists. Nothing is rounded but in tet_dyadic_to_double.
#include "exact/dyadic.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(double) == 8, "IEEE 754 binary64 is assumed");

int tet_double_parts(double x, uint64_t *mantissa, int32_t *exp) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  uint64_t m = bits & ((UINT64_C(1) << 52) - 1);
  int32_t e = (int32_t)((bits >> 52) & 0x7ff);
  if (e != 0) {
    m |= UINT64_C(1) << 52;
  } else {
    if (m == 0) {
      *mantissa = 0;
      *exp = 0;
      return 0;
    }
    e = 1; /* denormals have the exponent of the least normal numbers */
  }
  int zeros = __builtin_ctzll(m);
  *mantissa = m >> zeros;
  *exp = e - 1075 + zeros;
  return (bits >> 63) != 0 ? -1 : 1;
}

/* m 2^shift in w: writes shift/64 zero limbs and one or two of m, m != 0. */
static tet_dyadic place(tet_dyadic_space *w, uint64_t m, uint32_t shift, int32_t exp, int sign) {
  uint64_t *out = w->top;
  uint32_t n = shift / 64, bit = shift % 64;
  memset(out, 0, n * sizeof *out);
  out[n++] = m << bit;
  if (bit != 0 && (m >> (64 - bit)) != 0)
    out[n++] = m >> (64 - bit);
  w->top = out + n;
  return (tet_dyadic){.limb = out, .n = n, .exp = exp, .sign = sign};
}

tet_dyadic tet_dyadic_from_double(tet_dyadic_space *w, double x, int32_t exp) {
  uint64_t m;
  int32_t e;
  int sign = tet_double_parts(x, &m, &e);
  if (sign == 0)
    return tet_dyadic_zero(exp);
  return place(w, m, (uint32_t)(e - exp), exp, sign);
}

tet_dyadic tet_dyadic_from_double_reduced(tet_dyadic_space *w, double x) {
  uint64_t m;
  int32_t e;
  int sign = tet_double_parts(x, &m, &e);
  if (sign == 0)
    return tet_dyadic_zero(0);
  return place(w, m, 0, e, sign);
}

/* The same value at the lower exponent `exp`. */
static tet_dyadic rescale(tet_dyadic_space *w, const tet_dyadic *a, int32_t exp) {
  if (a->sign == 0)
    return tet_dyadic_zero(exp);
  uint32_t shift = (uint32_t)(a->exp - exp), skip = shift / 64, bit = shift % 64;
  uint64_t *out = w->top;
  memset(out, 0, skip * sizeof *out);
  uint32_t n = skip;
  if (bit == 0) {
    memcpy(out + n, a->limb, a->n * sizeof *out);
    n += a->n;
  } else {
    uint64_t low = 0;
    for (uint32_t i = 0; i < a->n; i++) {
      uint64_t limb = a->limb[i];
      out[n++] = limb << bit | low;
      low = limb >> (64 - bit);
    }
    if (low != 0)
      out[n++] = low;
  }
  w->top = out + n;
  return (tet_dyadic){.limb = out, .n = n, .exp = exp, .sign = a->sign};
}

/* Sign of |a| - |b| for equal exponents. */
static int compare_magnitudes(const tet_dyadic *a, const tet_dyadic *b) {
  if (a->n != b->n)
    return a->n < b->n ? -1 : 1;
  for (uint32_t i = a->n; i-- > 0;) {
    if (a->limb[i] != b->limb[i])
      return a->limb[i] < b->limb[i] ? -1 : 1;
  }
  return 0;
}

/* |a| + |b|, a->n >= b->n > 0. */
static tet_dyadic add_magnitudes(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b,
                                 int sign) {
  uint64_t *out = w->top;
  tet_uint128 sum = 0;
  uint32_t i = 0;
  for (; i < b->n; i++) {
    sum += (tet_uint128)a->limb[i] + b->limb[i];
    out[i] = (uint64_t)sum;
    sum >>= 64;
  }
  for (; i < a->n; i++) {
    sum += a->limb[i];
    out[i] = (uint64_t)sum;
    sum >>= 64;
  }
  if (sum != 0)
    out[i++] = (uint64_t)sum;
  w->top = out + i;
  return (tet_dyadic){.limb = out, .n = i, .exp = a->exp, .sign = sign};
}

/* |a| - |b| for |a| > |b|. */
static tet_dyadic subtract_magnitudes(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b,
                                      int sign) {
  uint64_t *out = w->top;
  uint64_t borrow = 0;
  uint32_t i = 0;
  for (; i < b->n; i++) {
    tet_uint128 d = (tet_uint128)a->limb[i] - b->limb[i] - borrow;
    out[i] = (uint64_t)d;
    borrow = (uint64_t)(d >> 64) & 1;
  }
  for (; i < a->n; i++) {
    tet_uint128 d = (tet_uint128)a->limb[i] - borrow;
    out[i] = (uint64_t)d;
    borrow = (uint64_t)(d >> 64) & 1;
  }
  while (out[i - 1] == 0)
    i--; /* ends: the difference is not zero */
  w->top = out + i;
  return (tet_dyadic){.limb = out, .n = i, .exp = a->exp, .sign = sign};
}

tet_dyadic tet_dyadic_add_long(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b,
                               int32_t sign_b) {
  tet_dyadic u = *a, v = *b;
  v.sign = sign_b;
  if (u.exp > v.exp) {
    u = rescale(w, &u, v.exp);
  } else if (v.exp > u.exp) {
    v = rescale(w, &v, u.exp);
  }
  if (v.sign == 0)
    return u;
  if (u.sign == 0)
    return v;
  if (u.sign == v.sign) {
    return u.n >= v.n ? add_magnitudes(w, &u, &v, u.sign) : add_magnitudes(w, &v, &u, u.sign);
  }
  int order = compare_magnitudes(&u, &v);
  if (order == 0)
    return tet_dyadic_zero(u.exp);
  return order > 0 ? subtract_magnitudes(w, &u, &v, u.sign)
                   : subtract_magnitudes(w, &v, &u, v.sign);
}

tet_dyadic tet_dyadic_mul_long(tet_dyadic_space *w, const tet_dyadic *a, const tet_dyadic *b) {
  if (a->sign == 0 || b->sign == 0)
    return tet_dyadic_zero(a->exp + b->exp);
  if (a->n > b->n) {
    const tet_dyadic *t = a;
    a = b;
    b = t;
  }
  uint64_t *out = w->top;
  tet_uint128 carry = 0;
  for (uint32_t j = 0; j < b->n; j++) {
    carry += (tet_uint128)a->limb[0] * b->limb[j];
    out[j] = (uint64_t)carry;
    carry >>= 64;
  }
  out[b->n] = (uint64_t)carry;
  for (uint32_t i = 1; i < a->n; i++) {
    uint64_t ai = a->limb[i];
    carry = 0;
    for (uint32_t j = 0; j < b->n; j++) {
      carry += (tet_uint128)ai * b->limb[j] + out[i + j]; /* at most 2^128 - 1 */
      out[i + j] = (uint64_t)carry;
      carry >>= 64;
    }
    out[i + b->n] = (uint64_t)carry;
  }
  uint32_t n = a->n + b->n;
  if (out[n - 1] == 0)
    n--;
  w->top = out + n;
  return (tet_dyadic){.limb = out, .n = n, .exp = a->exp + b->exp, .sign = a->sign * b->sign};
}

double tet_dyadic_to_double(const tet_dyadic *a) {
  if (a->sign == 0)
    return 0.0;
  int64_t bits = 64 * (int64_t)a->n - __builtin_clzll(a->limb[a->n - 1]);
  int64_t top = bits + a->exp; /* 2^(top-1) <= |value| < 2^top */
  if (top > 1024)
    return a->sign * (double)INFINITY;
  /* Keep 53 bits, or as many as lie above the last place of the denormals. */
  int64_t last = top - 53 > -1074 ? top - 53 : -1074;
  int64_t drop = last - a->exp; /* the places below it */
  uint64_t m = 0;
  if (drop <= 0) { /* exact: at most 53 bits, all of them in the lowest limb */
    m = a->limb[0] << -drop;
  } else if (drop <= bits) {
    uint64_t whole = (uint64_t)drop / 64, bit = (uint64_t)drop % 64;
    if (whole < a->n)
      m = a->limb[whole] >> bit;
    if (bit != 0 && whole + 1 < a->n)
      m |= a->limb[whole + 1] << (64 - bit);
    uint64_t half = (uint64_t)drop - 1;
    int up = (int)(a->limb[half / 64] >> (half % 64) & 1);
    int rest = (a->limb[half / 64] & ((UINT64_C(1) << (half % 64)) - 1)) != 0;
    for (uint64_t i = 0; i < half / 64 && !rest; i++)
      rest = a->limb[i] != 0;
    m += (uint64_t)(up && (rest || (m & 1)));
  } /* else less than half of the least denormal */
  /* The leading bit of m, where it has all 53, adds one to the exponent field; so
   * does a carry to 2^53. Denormals have neither. */
  uint64_t pattern = ((uint64_t)(last + 1074) << 52) + m;
  double x;
  memcpy(&x, &pattern, sizeof x);
  return a->sign < 0 ? -x : x;
}
