// SPDX-License-Identifier: Apache-2.0
/* memory.c: blocks of memory under the budget of a context.
 *
 * Every block carries its size in a header, so that the budget counts capacity
 * and not use, and freeing needs no size. Small blocks are malloc's. Large ones lie in
 * address space reserved for many times their size, of which as much can be touched as
 * has been asked for: they grow in small steps without being copied and without doubling,
 * and get huge pages, as meshes are read in no order that small pages like. */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

typedef struct block_head {
  size_t bytes;    /* accounted, this header included */
  size_t reserved; /* of address space; 0: from malloc */
} block_head;

_Static_assert(sizeof(block_head) % _Alignof(max_align_t) == 0, "blocks are aligned for any type");

#ifndef __has_feature
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define LARGE SIZE_MAX /* the sanitizer guards what malloc gave */
#else
#define LARGE ((size_t)1 << 21)
#endif
#define HUGE_PAGE ((size_t)1 << 21)
enum { RESERVED_TIMES = 64, STEP_SHIFT = 5 };

static size_t whole_pages(size_t bytes) { return (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE; }

/* Makes the first `bytes` of a reservation usable. What is behind stays out of bounds, so
 * that limits on data (RLIMIT_DATA) do not count it. */
static int commit(block_head *head, size_t bytes) {
  return mprotect(head, whole_pages(bytes), PROT_READ | PROT_WRITE) == 0;
}

/* Address space at a huge page's border, or NULL. */
static void *reserve(size_t bytes) {
  char *at = mmap(NULL, bytes + HUGE_PAGE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (at == MAP_FAILED) return NULL;
  size_t lead = (HUGE_PAGE - (uintptr_t)at % HUGE_PAGE) % HUGE_PAGE;
  if (lead) munmap(at, lead);
  munmap(at + lead + bytes, HUGE_PAGE - lead);
  return at + lead;
}

/* 1 if the process may not have all the address space it likes (RLIMIT_AS). */
static int is_space_short(void) {
  struct rlimit limit;
  return getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
}

/* A large block for `bytes`, with room to grow where there is. */
static block_head *new_large(size_t bytes) {
  for (size_t times = is_space_short() ? 1 : RESERVED_TIMES; times; times /= 4) {
    size_t reserved;
    if (__builtin_mul_overflow(whole_pages(bytes), times, &reserved)) continue;
    block_head *head = reserve(reserved);
    if (!head) continue;
    if (!commit(head, bytes)) {
      munmap(head, reserved);
      return NULL;
    }
    (void)madvise(head, reserved, MADV_HUGEPAGE); /* a wish: small pages serve too */
    head->reserved = reserved;
    return head;
  }
  return NULL;
}

static block_head *new_block(size_t bytes) {
  block_head *head = bytes >= LARGE ? new_large(bytes) : malloc(bytes);
  if (head && bytes < LARGE) head->reserved = 0;
  return head;
}

static void free_block(block_head *head) {
  if (head->reserved) munmap(head, head->reserved);
  else free(head);
}

/* Gives whole pages behind `bytes` back to the system. */
static void give_back(block_head *head, size_t bytes) {
  size_t kept = whole_pages(bytes);
  if (kept < whole_pages(head->bytes)) (void)madvise((char *)head + kept, whole_pages(head->bytes) - kept, MADV_DONTNEED);
}

/* More than was reserved: the pages go elsewhere, uncopied. */
static block_head *move_large(block_head *head, size_t bytes) {
  size_t reserved = whole_pages(bytes);
  if (!commit(head, head->reserved)) return NULL; /* so that it is one mapping */
  block_head *moved = mremap(head, head->reserved, reserved, MREMAP_MAYMOVE);
  if (moved == MAP_FAILED) return NULL;
  moved->reserved = reserved;
  return moved;
}

/* `head` (NULL: none) with room for `bytes`, maybe elsewhere; NULL: as before. */
static block_head *resize_block(block_head *head, size_t bytes) {
  if (!head) return new_block(bytes);
  if (!head->reserved && bytes < LARGE) return realloc(head, bytes);
  if (head->reserved && bytes <= head->bytes) {
    give_back(head, bytes);
    return head;
  }
  if (head->reserved)
    return bytes > head->reserved ? move_large(head, bytes) : commit(head, bytes) ? head : NULL;
  block_head *moved = new_block(bytes);
  if (!moved) return NULL;
  size_t reserved = moved->reserved;
  memcpy(moved, head, head->bytes < bytes ? head->bytes : bytes);
  moved->reserved = reserved;
  free_block(head);
  return moved;
}

static tet_status no_memory(tet_ctx *ctx, size_t bytes) {
  return tet_fail(ctx, TET_E_MEMORY, "the system has no %zu bytes of memory left", bytes);
}

void *tet_alloc(tet_ctx *ctx, size_t count, size_t size) {
  size_t bytes;
  if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2) {
    tet_fail(ctx, TET_E_TOO_LARGE, "an array of %zu items of %zu bytes", count, size);
    return NULL;
  }
  bytes += sizeof(block_head);
  if (tet_account(ctx, 0, bytes) != TET_OK) return NULL;
  block_head *head = new_block(bytes);
  if (!head) {
    tet_account(ctx, bytes, 0);
    no_memory(ctx, bytes);
    return NULL;
  }
  head->bytes = bytes;
  return head + 1;
}

void *tet_calloc(tet_ctx *ctx, size_t count, size_t size) {
  void *block = tet_alloc(ctx, count, size);
  if (block && !((block_head *)block - 1)->reserved) memset(block, 0, count * size); /* new pages are zero */
  return block;
}

void tet_free(tet_ctx *ctx, void *block) {
  if (!block) return;
  block_head *head = (block_head *)block - 1;
  tet_account(ctx, head->bytes, 0);
  free_block(head);
}

/* realloc under the budget; `array` is a pointer to the array pointer. */
static tet_status resize(tet_ctx *ctx, void *array, size_t items, size_t size) {
  void *old;
  memcpy(&old, array, sizeof old);
  block_head *head = old ? (block_head *)old - 1 : NULL;
  size_t before = head ? head->bytes : 0, bytes = items * size + sizeof(block_head);
  tet_status status = tet_account(ctx, before, bytes);
  if (status != TET_OK) return status;
  block_head *moved = resize_block(head, bytes);
  if (!moved) {
    tet_account(ctx, bytes, before);
    return no_memory(ctx, bytes);
  }
  moved->bytes = bytes;
  void *block = moved + 1;
  memcpy(array, &block, sizeof block);
  return TET_OK;
}

tet_status tet_grow(tet_ctx *ctx, void *array, size_t *capacity, size_t need, size_t size) {
  if (need <= *capacity) return TET_OK;
  size_t step = *capacity > LARGE / size ? *capacity >> STEP_SHIFT : *capacity / 2;
  size_t items = *capacity + step + 16;
  if (items < need) items = need;
  if (items > SIZE_MAX / 2 / size) return tet_fail(ctx, TET_E_TOO_LARGE, "an array of %zu items", items);
  while (items > need && !tet_fits(ctx, (items - *capacity) * size)) items = need + (items - need) / 2;
  tet_status status = resize(ctx, array, items, size);
  if (status == TET_OK) *capacity = items;
  return status;
}

tet_status tet_push(tet_ctx *ctx, uint32_t **array, size_t *n, size_t *capacity, uint32_t value) {
  tet_status status = tet_grow(ctx, array, capacity, *n + 1, sizeof **array);
  if (status == TET_OK) (*array)[(*n)++] = value;
  return status;
}

void tet_shrink(tet_ctx *ctx, void *array, size_t *capacity, size_t count, size_t size) {
  if (count >= *capacity) return;
  if (resize(ctx, array, count, size) == TET_OK) *capacity = count;
}
