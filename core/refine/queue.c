// SPDX-License-Identifier: Apache-2.0
/* queue.c: what waits to be split. Subsegments and subfaces first come first
 * served, by their vertices, for slots are used again; tetrahedra by key. */
#include "refine/refiner.h"

#include "base/vector.h"

#include <math.h>
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
  q->free_chunk = TET_NONE;
  if (r->o.order != TET_INSERT_RELATIVELY_SHORT) return TET_OK;
  r->round_start = tet_alloc(r->ctx, KEYS, sizeof *r->round_start);
  return r->round_start ? TET_OK : TET_E_MEMORY;
}

/* Positive x by its power of two and the 32nds of that, ascending. */
static inline uint32_t key_of(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return (uint32_t)(bits >> (52 - FINE));
}

/* The same by quarters. */
static inline uint32_t quarter_of(double x) { return key_of(x) & ~(uint32_t)(QUARTER - 1); }

/* Short edges first, by quarters, and of those large ratios, by quarters from the bound on. */
static inline uint32_t usual_key(const refiner *r, const refine_shape *s) {
  double reach = 2 * s->volume6 * r->o.radius_edge, over = tet_square(s->to_centre) / (reach * reach * s->shortest2);
  uint32_t class = over < 4 ? (key_of(over) - key_of(1)) / QUARTER : QUARTER - 1;
  return quarter_of(s->shortest2) | (QUARTER - 1 - (over < 1 ? 0 : class));
}

/* The round that an edge's younger end came before (see TET_INSERT_RELATIVELY_SHORT). */
static uint32_t round_of(const refiner *r, uint32_t t) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  double least = INFINITY;
  uint32_t young = 0, low = 0, high = r->n_rounds;
  for (int e = 0; e < 6; e++) {
    uint32_t a = v[refine_edge[e][0]], b = v[refine_edge[e][1]];
    double length2 = tet_distance2(refine_x(r, a), refine_x(r, b));
    if (!(length2 < least)) continue;
    least = length2;
    young = a > b ? a : b;
  }
  while (low < high) { /* how many rounds had begun when it came */
    uint32_t middle = (low + high) / 2;
    if (r->round_start[middle] <= young) low = middle + 1;
    else high = middle;
  }
  return low < KEYS ? low : KEYS - 1;
}

/* A random key of t, the same as long as it lives. */
static uint32_t random_key(const refiner *r, uint32_t t) {
  uint64_t h = 0;
  for (int i = 0; i < 4; i++) {
    h = (h ^ r->mesh.v[4 * (size_t)t + i]) * 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
  }
  return (uint32_t)(h % KEYS);
}

/* The key among tetrahedra over the radius-edge bound, least first (3.3.5, Table 3.2; 3.3.6). */
static inline uint32_t ratio_key(const refiner *r, uint32_t t, const refine_shape *s) {
  if (r->o.order == TET_INSERT_O2_O1) return usual_key(r, s);
  double x = INFINITY; /* of a tetrahedron that is flat, or whose measures overflow */
  if (s->volume6 > 0) x = tet_square(s->to_centre) / (4 * s->volume6 * s->volume6);
  if (r->o.order == TET_INSERT_O1) x /= s->shortest2;
  if (!(x < INFINITY)) x = INFINITY;
  switch (r->o.order) {
  case TET_INSERT_O3: return key_of(x);
  case TET_INSERT_O1:
  case TET_INSERT_O4: return KEYS - 1 - key_of(x);
  case TET_INSERT_O5: return random_key(r, t);
  case TET_INSERT_RELATIVELY_SHORT: return round_of(r, t);
  default: return key_of(s->shortest2); /* O2 */
  }
}

/* The bucket of t if it is over a bound, else BUCKETS: over the ratio, by the order; over the volume
 * alone, as R3.2 waits for R3.1: large ones first, by powers of two, which keeps what is split next
 * close by. Slivers (3.4.2) come last, the sharpest first. */
static inline uint32_t bucket_of(const refiner *r, uint32_t t, const refine_shape *shape) {
  if (refine_over_ratio(r, shape)) return ratio_key(r, t, shape);
  if (refine_over_volume(r, r->tet_region[t], shape->volume6))
    return 2 * KEYS - 1 - (key_of(shape->volume6) >> FINE << FINE);
  if (!r->watch_slivers) return BUCKETS;
  double sine2 = 1 - refine_sharpest(r, r->mesh.v + 4 * (size_t)t);
  return sine2 < r->sliver_sine2 ? 2 * KEYS + quarter_of(sine2) : BUCKETS;
}

/* A slot's number, which leaves two bits, and there some of a hash of the vertices: most entries that are popped are of a
 * tetrahedron that is gone, and measuring what has its slot now costs more. */
static inline uint32_t entry_of(const refiner *r, uint32_t t) {
  const uint32_t *v = r->mesh.v + 4 * (size_t)t;
  return t | ((v[0] ^ v[1] ^ v[2] ^ v[3]) * UINT32_C(0x9e3779b9) & ~TET_MOST_TETRAHEDRA);
}

static tet_status push(refiner *r, uint32_t b, uint32_t t) {
  refine_buckets *q = &r->bad;
  uint32_t c = q->used[b / 64] >> b % 64 & 1 ? q->head[b] : TET_NONE;
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
  q->chunk[c].entry[q->chunk[c].n++] = entry_of(r, t);
  return TET_OK;
}

/* The last entry of the least bucket; 0: none. */
static int pop(refine_buckets *q, uint32_t *ret_bucket, uint32_t *ret_entry) {
  while (q->low < BUCKETS / 64 && !q->used[q->low]) q->low++;
  if (q->low == BUCKETS / 64) return 0;
  uint32_t b = 64 * q->low + (uint32_t)__builtin_ctzll(q->used[q->low]), c = q->head[b];
  *ret_bucket = b;
  *ret_entry = q->chunk[c].entry[--q->chunk[c].n];
  if (q->chunk[c].n) return 1;
  q->head[b] = q->chunk[c].next;
  if (q->head[b] == TET_NONE) q->used[b / 64] &= ~((uint64_t)1 << b % 64);
  q->chunk[c].next = q->free_chunk;
  q->free_chunk = c;
  return 1;
}

static tet_status queue_shaped(refiner *r, uint32_t t, const refine_shape *shape) {
  uint32_t b = bucket_of(r, t, shape);
  if (b == BUCKETS) return TET_OK;
  r->tet_edges[t] |= TET_QUEUED;
  return push(r, b, t);
}

/* Queues tetrahedron t if it is over a bound. */
tet_status refine_queue_tet(refiner *r, uint32_t t) {
  if (!r->watch_tets) return TET_OK;
  refine_shape shape;
  refine_measure(r, t, &shape);
  return queue_shaped(r, t, &shape);
}

/* The same of all that the last fill made, which were measured before. */
tet_status refine_queue_made(refiner *r) {
  const refine_cavity *c = &r->cavity;
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < c->n_made && r->watch_tets && !status; k++) {
    const refine_shapes *s = &c->shapes[k / 4];
    uint32_t lane = k % 4, t = r->mesh.cavity[k];
    if (!(s->is_sure >> lane & 1)) {
      status = refine_queue_tet(r, t);
      continue;
    }
    if (!(s->is_over >> lane & 1) && !r->watch_slivers && !refine_over_volume(r, r->tet_region[t], s->volume6[lane]))
      continue;
    refine_shape shape = {{s->to_centre[0][lane], s->to_centre[1][lane], s->to_centre[2][lane]},
                          s->volume6[lane], s->shortest2[lane]};
    status = queue_shaped(r, t, &shape);
  }
  return status;
}

/* An entry whose slot has another tetrahedron by now tells by its bits, mostly, and by that not being queued, or not
 * from this bucket. */
int refine_next_tet(refiner *r, uint32_t *ret_tet, refine_shape *ret_shape, int *ret_sliver) {
  uint32_t b, entry;
  while (pop(&r->bad, &b, &entry)) {
    uint32_t t = entry & TET_MOST_TETRAHEDRA;
    if (!refine_alive(r, t) || !(r->tet_edges[t] & TET_QUEUED) || entry_of(r, t) != entry) continue;
    refine_measure(r, t, ret_shape);
    if (bucket_of(r, t, ret_shape) != b) continue;
    if (r->round_start && b == r->n_rounds) r->round_start[r->n_rounds++] = r->points.n;
    *ret_tet = t;
    *ret_sliver = b >= 2 * KEYS;
    return 1;
  }
  return 0;
}
