// SPDX-License-Identifier: Apache-2.0
/* sort.c: introsort (Musser 1997): quicksort, heaps where it degenerates, and
 * insertion for short runs; and a radix sort, lowest digits first. libc's qsort may
 * allocate outside the budget. */
#include "base/sort.h"

#include <string.h>

#include "base/threads.h"

enum { SHORT_RUN = 24 };

static inline int less(const tet_keyed *a, const tet_keyed *b) {
  return a->key != b->key ? a->key < b->key : a->value < b->value;
}

static inline void swap(tet_keyed *a, tet_keyed *b) {
  tet_keyed t = *a;
  *a = *b;
  *b = t;
}

static void insertion(tet_keyed *x, size_t n) {
  for (size_t i = 1; i < n; i++) {
    tet_keyed item = x[i];
    size_t j = i;
    for (; j > 0 && less(&item, &x[j - 1]); j--) x[j] = x[j - 1];
    x[j] = item;
  }
}

static void sift(tet_keyed *x, size_t root, size_t n) {
  for (size_t child; (child = 2 * root + 1) < n; root = child) {
    if (child + 1 < n && less(&x[child], &x[child + 1])) child++;
    if (!less(&x[root], &x[child])) return;
    swap(&x[root], &x[child]);
  }
}

static void heap(tet_keyed *x, size_t n) {
  for (size_t i = n / 2; i-- > 0;) sift(x, i, n);
  for (size_t i = n; i-- > 1;) {
    swap(&x[0], &x[i]);
    sift(x, 0, i);
  }
}

/* Parts x around the median of three; returns where the right part begins. */
static size_t part(tet_keyed *x, size_t n) {
  tet_keyed *mid = &x[n / 2], *last = &x[n - 1];
  if (less(mid, x)) swap(mid, x);
  if (less(last, x)) swap(last, x);
  if (less(last, mid)) swap(last, mid);
  tet_keyed pivot = *mid;
  size_t i = 0, j = n - 1;
  for (;;) {
    while (less(&x[i], &pivot)) i++;
    while (less(&pivot, &x[j])) j--;
    if (i >= j) return i;
    swap(&x[i++], &x[j--]);
  }
}

static void sort(tet_keyed *x, size_t n, int depth) {
  while (n > SHORT_RUN) {
    if (depth-- == 0) {
      heap(x, n);
      return;
    }
    size_t right = part(x, n);
    if (right < n - right) { /* recursion on the smaller part bounds the stack */
      sort(x, right, depth);
      x += right;
      n -= right;
    } else {
      sort(x + right, n - right, depth);
      n = right;
    }
  }
  insertion(x, n);
}

void tet_sort_keyed(tet_keyed *items, size_t n) {
  int depth = 2;
  for (size_t k = n; k > 1; k /= 2) depth += 2;
  sort(items, n, depth);
}

enum { DIGIT = 11, DIGITS = 6, BUCKETS = 1 << DIGIT }; /* 66 bits and more than a key has */

static uint32_t digit_of(uint64_t key, int d) { return (uint32_t)(key >> d * DIGIT & (BUCKETS - 1)); }

/* Where each bucket of digit d begins, and the end. 1 if all items are in one bucket. */
static int find_starts(const tet_keyed *x, size_t n, int d, size_t start[BUCKETS + 1]) {
  memset(start, 0, (BUCKETS + 1) * sizeof *start);
  for (size_t i = 0; i < n; i++) start[digit_of(x[i].key, d) + 1]++;
  int is_one = n && start[digit_of(x[0].key, d) + 1] == n;
  for (int b = 0; b < BUCKETS; b++) start[b + 1] += start[b];
  return is_one;
}

/* Digit after digit, the lowest first. */
static void sort_digits(tet_keyed *items, tet_keyed *scratch, size_t n) {
  size_t start[BUCKETS + 1];
  tet_keyed *from = items, *to = scratch;
  for (int d = 0; d < DIGITS; d++) {
    if (find_starts(from, n, d, start)) continue;
    for (size_t i = 0; i < n; i++) to[start[digit_of(from[i].key, d)]++] = from[i];
    tet_keyed *other = from;
    from = to;
    to = other;
  }
  if (from != items) memcpy(items, from, n * sizeof *items);
}

typedef struct shares {
  tet_keyed *items, *scratch;
  size_t end[TET_SORT_THREADS + 1]; /* of share i end[i + 1]; from end[i] on */
} shares;

static void sort_share(void *arg, uint32_t i) {
  shares *s = arg;
  size_t at = s->end[i], n = s->end[i + 1] - at;
  sort_digits(s->scratch + at, s->items + at, n);
  memcpy(s->items + at, s->scratch + at, n * sizeof *s->items);
}

void tet_sort_radix(tet_keyed *items, tet_keyed *scratch, size_t n, uint32_t threads) {
  size_t start[BUCKETS + 1];
  shares s = {.items = items, .scratch = scratch};
  if (threads > TET_SORT_THREADS) threads = TET_SORT_THREADS;
  if (threads < 2 || find_starts(items, n, DIGITS - 1, start)) {
    sort_digits(items, scratch, n);
    return;
  }
  /* Whole buckets of the highest digit, about as many items to each thread. */
  for (int b = 0, i = 1; b < BUCKETS; b++)
    while (i < (int)threads && start[b + 1] >= n / threads * (size_t)i) s.end[i++] = start[b + 1];
  s.end[threads] = n;
  for (size_t i = 0; i < n; i++) scratch[start[digit_of(items[i].key, DIGITS - 1)]++] = items[i];
  tet_run_threads(threads, sort_share, &s);
}
