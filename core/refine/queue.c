// SPDX-License-Identifier: Apache-2.0
/* queue.c: what waits to be split. Subsegments and subfaces first come first
 * served; tetrahedra by key. Entries hold vertices, for slots are used again. */
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

/* Order O2 (Table 3.2): short edges first; over the volume alone: after all
 * those over the ratio, large ones first. Ties by vertices, so that slots do not
 * matter. */
static int before(const refine_bad *a, const refine_bad *b) {
  if (a->rank != b->rank) return a->rank < b->rank;
  if (a->key != b->key) return a->key < b->key;
  return memcmp(a->v, b->v, sizeof a->v) < 0;
}

static tet_status push(refiner *r, refine_bad item) {
  tet_status status = tet_grow(r->ctx, &r->heap, &r->cap_heap, (size_t)r->n_heap + 1, sizeof *r->heap);
  if (status) return status;
  uint32_t i = r->n_heap++;
  while (i && before(&item, &r->heap[(i - 1) / 2])) {
    r->heap[i] = r->heap[(i - 1) / 2];
    i = (i - 1) / 2;
  }
  r->heap[i] = item;
  return TET_OK;
}

static refine_bad pop(refiner *r) {
  refine_bad top = r->heap[0], last = r->heap[--r->n_heap];
  uint32_t i = 0;
  for (;;) {
    uint32_t child = 2 * i + 1;
    if (child >= r->n_heap) break;
    if (child + 1 < r->n_heap && before(&r->heap[child + 1], &r->heap[child])) child++;
    if (!before(&r->heap[child], &last)) break;
    r->heap[i] = r->heap[child];
    i = child;
  }
  if (r->n_heap) r->heap[i] = last;
  return top;
}

/* Queues tetrahedron t if it is over a bound. */
tet_status refine_queue_tet(refiner *r, uint32_t t) {
  if (!r->watch_tets) return TET_OK;
  refine_shape shape;
  refine_measure(r, t, &shape);
  refine_bad item = {shape.shortest2, 0, t, {0}};
  if (!refine_over_ratio(r, &shape)) {
    if (!refine_over_volume(r, t, &shape)) return TET_OK;
    item.rank = 1; /* R3.2 waits for R3.1 */
    item.key = -shape.volume;
  }
  memcpy(item.v, r->tet_v + 4 * (size_t)t, sizeof item.v);
  return push(r, item);
}

int refine_next_tet(refiner *r, uint32_t *ret_tet) {
  while (r->n_heap) {
    refine_bad item = pop(r);
    if (memcmp(item.v, r->tet_v + 4 * (size_t)item.tet, sizeof item.v) != 0) continue;
    *ret_tet = item.tet;
    return 1;
  }
  return 0;
}
