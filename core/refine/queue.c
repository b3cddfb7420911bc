// SPDX-License-Identifier: Apache-2.0
/* queue.c: what waits to be split. Subsegments and subfaces first come first
 * served, by their vertices, for slots are used again; tetrahedra by key. */
#include "refine/refiner.h"

#include <string.h>

tet_status refine_queue_seg(refiner *r, uint32_t e) {
  if (r->seg_waiting[e]) return TET_OK;
  if (r->at_seg_queue && r->at_seg_queue == r->n_seg_queue) r->at_seg_queue = r->n_seg_queue = 0;
  tet_status status = tet_grow(r->ctx, &r->seg_queue, &r->cap_seg_queue, (size_t)r->n_seg_queue + 1,
                               sizeof *r->seg_queue);
  if (status) return status;
  const uint32_t *v = r->seg_v + 2 * (size_t)e;
  r->seg_queue[r->n_seg_queue++] = (refine_waiting){e, {v[0], v[1], TET_NONE}};
  r->seg_waiting[e] = 1;
  return TET_OK;
}

int refine_next_seg(refiner *r, uint32_t *ret_seg) {
  if (r->at_seg_queue == r->n_seg_queue) return 0;
  uint32_t e = r->seg_queue[r->at_seg_queue++].item;
  r->seg_waiting[e] = 0;
  *ret_seg = e;
  return 1;
}

tet_status refine_queue_sub(refiner *r, uint32_t s) {
  if (r->sub_mark[s] & 4) return TET_OK;
  if (r->at_sub_queue && r->at_sub_queue == r->n_sub_queue) r->at_sub_queue = r->n_sub_queue = 0;
  tet_status status = tet_grow(r->ctx, &r->sub_queue, &r->cap_sub_queue, (size_t)r->n_sub_queue + 1,
                               sizeof *r->sub_queue);
  if (status) return status;
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  r->sub_queue[r->n_sub_queue++] = (refine_waiting){s, {v[0], v[1], v[2]}};
  r->sub_mark[s] |= 4;
  return TET_OK;
}

int refine_next_sub(refiner *r, uint32_t *ret_sub) {
  while (r->at_sub_queue < r->n_sub_queue) {
    refine_waiting w = r->sub_queue[r->at_sub_queue++];
    if (memcmp(w.v, r->sub_v + 3 * (size_t)w.item, sizeof w.v) != 0) continue;
    r->sub_mark[w.item] &= (uint8_t)~4;
    *ret_sub = w.item;
    return 1;
  }
  return 0;
}

tet_status refine_open_queue(refiner *r) {
  refine_buckets *q = &r->bad;
  q->head = tet_alloc(r->ctx, BUCKETS, sizeof *q->head);
  q->used = tet_calloc(r->ctx, BUCKETS / 64, sizeof *q->used);
  if (!q->head || !q->used) return TET_E_MEMORY;
  for (int b = 0; b < BUCKETS; b++) q->head[b] = TET_NONE;
  q->free_chunk = TET_NONE;
  return TET_OK;
}

/* The bucket of t if it is over a bound, else BUCKETS. Order O2 (Table 3.2): short edges first,
 * keys within a quarter of their power of two being alike; over the volume alone, as R3.2 waits
 * for R3.1: large ones first, by powers of two, which keeps what is split next close by. Slivers
 * (3.4.2) come last, the sharpest first. */
static inline uint32_t bucket_of(const refiner *r, uint32_t t, refine_shape *ret_shape) {
  uint64_t bits;
  refine_measure(r, t, ret_shape);
  int over_ratio = refine_over_ratio(r, ret_shape);
  if (over_ratio || refine_over_volume(r, t, ret_shape)) {
    memcpy(&bits, over_ratio ? &ret_shape->shortest2 : &ret_shape->volume6, sizeof bits);
    return over_ratio ? (uint32_t)(bits >> 50) : 2 * KEYS - 1 - (uint32_t)(bits >> 52 << 2);
  }
  if (!r->watch_slivers) return BUCKETS;
  double sine2 = 1 - refine_sharpest(r, t);
  if (!(sine2 < r->sliver_sine2)) return BUCKETS;
  memcpy(&bits, &sine2, sizeof bits);
  return 2 * KEYS + (uint32_t)(bits >> 50);
}

static tet_status push(refiner *r, uint32_t b, uint32_t t) {
  refine_buckets *q = &r->bad;
  uint32_t c = q->head[b];
  if (c == TET_NONE || q->chunk[c].n == CHUNK) {
    uint32_t n = q->free_chunk;
    if (n != TET_NONE) {
      q->free_chunk = q->chunk[n].next;
    } else {
      tet_status status = tet_grow(r->ctx, &q->chunk, &q->cap_chunk, (size_t)q->n_chunks + 1, sizeof *q->chunk);
      if (status) return status;
      n = q->n_chunks++;
    }
    q->chunk[n].next = c;
    q->chunk[n].n = 0;
    q->head[b] = c = n;
    q->used[b / 64] |= (uint64_t)1 << b % 64;
    if (b / 64 < q->low) q->low = b / 64;
  }
  q->chunk[c].tet[q->chunk[c].n++] = t;
  return TET_OK;
}

/* The last of the least bucket; 0: none. */
static int pop(refine_buckets *q, uint32_t *ret_bucket, uint32_t *ret_tet) {
  while (q->low < BUCKETS / 64 && !q->used[q->low]) q->low++;
  if (q->low == BUCKETS / 64) return 0;
  uint32_t b = 64 * q->low + (uint32_t)__builtin_ctzll(q->used[q->low]), c = q->head[b];
  *ret_bucket = b;
  *ret_tet = q->chunk[c].tet[--q->chunk[c].n];
  if (q->chunk[c].n) return 1;
  q->head[b] = q->chunk[c].next;
  if (q->head[b] == TET_NONE) q->used[b / 64] &= ~((uint64_t)1 << b % 64);
  q->chunk[c].next = q->free_chunk;
  q->free_chunk = c;
  return 1;
}

/* Queues tetrahedron t if it is over a bound. */
tet_status refine_queue_tet(refiner *r, uint32_t t) {
  if (!r->watch_tets) return TET_OK;
  refine_shape shape;
  uint32_t b = bucket_of(r, t, &shape);
  if (b == BUCKETS) return TET_OK;
  r->tet_edges[t] |= TET_QUEUED;
  return push(r, b, t);
}

/* Entries are numbers alone: one whose slot has another tetrahedron by now tells by that
 * not being queued, or not from this bucket. */
int refine_next_tet(refiner *r, uint32_t *ret_tet, refine_shape *ret_shape, int *ret_sliver) {
  uint32_t b, t;
  while (pop(&r->bad, &b, &t)) {
    if (!refine_alive(r, t) || !(r->tet_edges[t] & TET_QUEUED) || bucket_of(r, t, ret_shape) != b) continue;
    *ret_tet = t;
    *ret_sliver = b >= 2 * KEYS;
    return 1;
  }
  return 0;
}
