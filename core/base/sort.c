// SPDX-License-Identifier: Apache-2.0
/* sort.c: introsort (Musser 1997): quicksort, heaps where it degenerates, and
 * insertion for short runs; and a radix sort, highest digits first, until buckets are
 * so short. libc's qsort may allocate outside the budget. */
#include "base/sort.h"

#include <stdatomic.h>
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

enum {
  WIDE = 11,      /* bits of a digit where there are many items, */
  NARROW = 8,     /* and where there are not so many, */
  MANY = 1 << 16, /* as these are */
  FEW = 512,      /* worth no digits */
  RUN = 8         /* buckets that a thread takes at a time */
};

static inline uint32_t digit_of(const tet_keyed *x, int shift, uint32_t mask) { return (uint32_t)(x->key >> shift) & mask; }

/* Sorts the n items of `from`, whose keys differ in their lowest `bits` bits alone, into `to`, or where they
 * are; the other place is scratch. */
static void sort_digits(tet_keyed *from, tet_keyed *to, size_t n, int bits, int is_moving) {
  size_t start[(1 << WIDE) + 1];
  if (n < FEW || bits == 0) {
    tet_sort_keyed(from, n);
    if (is_moving) memcpy(to, from, n * sizeof *to);
    return;
  }
  int width = n < MANY ? NARROW : WIDE, shift = bits > width ? bits - width : 0;
  uint32_t buckets = 1u << (bits - shift), mask = buckets - 1;
  memset(start, 0, (buckets + 1) * sizeof *start);
  for (size_t i = 0; i < n; i++) start[digit_of(from + i, shift, mask) + 1]++;
  for (uint32_t b = 0; b < buckets; b++) start[b + 1] += start[b];
  for (size_t i = 0; i < n; i++) to[start[digit_of(from + i, shift, mask)]++] = from[i];
  for (uint32_t b = 0; b < buckets; b++) { /* now start[b] is where b ends */
    size_t first = b ? start[b - 1] : 0;
    if (start[b] > first) sort_digits(to + first, from + first, start[b] - first, shift, !is_moving);
  }
}

/* What threads share: the first digit's buckets. */
typedef struct sharing {
  tet_keyed *items, *scratch;
  size_t n;
  uint32_t threads;
  size_t at[TET_SORT_THREADS][1 << WIDE]; /* of each thread's items, and where they go */
  size_t end[1 << WIDE];
  _Atomic uint32_t next; /* bucket that nobody has taken */
} sharing;

enum { FIRST_SHIFT = 64 - WIDE, FIRST_MASK = (1 << WIDE) - 1 };

static size_t share_of(const sharing *s, uint32_t i) { return (size_t)((unsigned __int128)s->n * i / s->threads); }

static void count_share(void *arg, uint32_t t) {
  sharing *s = arg;
  memset(s->at[t], 0, sizeof s->at[t]);
  for (size_t i = share_of(s, t); i < share_of(s, t + 1); i++) s->at[t][digit_of(s->items + i, FIRST_SHIFT, FIRST_MASK)]++;
}

static void move_share(void *arg, uint32_t t) {
  sharing *s = arg;
  size_t *at = s->at[t];
  for (size_t i = share_of(s, t), end = share_of(s, t + 1); i < end; i++)
    s->scratch[at[digit_of(s->items + i, FIRST_SHIFT, FIRST_MASK)]++] = s->items[i];
}

static void sort_buckets(void *arg, uint32_t t) {
  sharing *s = arg;
  (void)t;
  for (uint32_t from; (from = atomic_fetch_add(&s->next, RUN)) <= FIRST_MASK;)
    for (uint32_t b = from; b < from + RUN; b++) {
      size_t first = b ? s->end[b - 1] : 0;
      if (s->end[b] > first) sort_digits(s->scratch + first, s->items + first, s->end[b] - first, FIRST_SHIFT, 1);
    }
}

void tet_sort_radix(tet_keyed *items, tet_keyed *scratch, size_t n, uint32_t threads) {
  if (threads < 2 || n < MANY) {
    sort_digits(items, scratch, n, 64, 0);
    return;
  }
  sharing s = {.items = items, .scratch = scratch, .n = n, .threads = threads < TET_SORT_THREADS ? threads : TET_SORT_THREADS};
  size_t sum = 0;
  tet_run_threads(s.threads, count_share, &s);
  for (uint32_t b = 0; b <= FIRST_MASK; b++) {
    for (uint32_t t = 0; t < s.threads; t++) {
      size_t count = s.at[t][b];
      s.at[t][b] = sum;
      sum += count;
    }
    s.end[b] = sum;
  }
  tet_run_threads(s.threads, move_share, &s);
  tet_run_threads(s.threads, sort_buckets, &s);
}
