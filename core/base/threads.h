// SPDX-License-Identifier: Apache-2.0
/* threads.h: a piece of work done by several threads. */
#ifndef TET_BASE_THREADS_H
#define TET_BASE_THREADS_H

#include <stdint.h>

/* Calls work(arg, i) once for each i < n, all at the same time as far as there are threads to be
 * had, and returns when all are done. The calling thread takes 0, and what others cannot. */
void tet_run_threads(uint32_t n, void (*work)(void *arg, uint32_t i), void *arg);

/* The first item of part i of `parts` equal parts of n items; that of part i + 1 is its end. */
static inline uint32_t tet_part(uint32_t n, uint32_t parts, uint32_t i) { return (uint32_t)((uint64_t)n * i / parts); }

#endif
