// SPDX-License-Identifier: Apache-2.0
/* processor.h: what the processor may have beyond its architecture's least. It is compiled for one
 * function at a time (TET_AVX2) and called only where it is there (tet_has_avx2). */
#ifndef TET_BASE_PROCESSOR_H
#define TET_BASE_PROCESSOR_H

#if defined(__x86_64__)
#include <immintrin.h>
#define TET_HAVE_AVX2 1
#define TET_AVX2 __attribute__((target("avx2,fma")))
static inline int tet_has_avx2(void) { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
#else
#define TET_HAVE_AVX2 0
#endif

#endif
