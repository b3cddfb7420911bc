// SPDX-License-Identifier: Apache-2.0
/* segments.c: finds subsegments by their end points and the tetrahedra around
 * them, in however many fans. */
#include "refine/refiner.h"

static uint32_t slot_of(const refiner *r, uint32_t a, uint32_t b) {
  uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
  key *= 0x9e3779b97f4a7c15u;
  key ^= key >> 32;
  return (uint32_t)key & r->seg_table_mask;
}

/* The subsegment between a and b, or TET_NONE. */
uint32_t refine_find_seg(const refiner *r, uint32_t a, uint32_t b) {
  for (uint32_t i = slot_of(r, a, b);; i = (i + 1) & r->seg_table_mask) {
    uint32_t e = r->seg_table[i];
    if (e == TET_NONE) return TET_NONE;
    const uint32_t *v = r->seg_v + 2 * (size_t)e;
    if ((v[0] == a && v[1] == b) || (v[0] == b && v[1] == a)) return e;
  }
}

static void enter(refiner *r, uint32_t e) {
  uint32_t i = slot_of(r, r->seg_v[2 * (size_t)e], r->seg_v[2 * (size_t)e + 1]);
  while (r->seg_table[i] != TET_NONE) i = (i + 1) & r->seg_table_mask;
  r->seg_table[i] = e;
  r->seg_table_used++;
}

/* Enters all subsegments into a table with room for as many again. */
tet_status refine_build_seg_table(refiner *r) {
  uint64_t size = 64;
  while (size < 4 * (uint64_t)r->n_segs) size *= 2;
  uint32_t *table = tet_alloc(r->ctx, size, sizeof *table);
  if (!table) return TET_E_MEMORY;
  for (uint64_t i = 0; i < size; i++) table[i] = TET_NONE;
  tet_free(r->ctx, r->seg_table);
  r->seg_table = table;
  r->seg_table_mask = (uint32_t)(size - 1);
  r->seg_table_used = 0;
  for (uint32_t i = 0; i < r->n_segs; i++) enter(r, i);
  return TET_OK;
}

/* Makes subsegment e, new or with new ends, known by its ends. */
tet_status refine_enter_seg(refiner *r, uint32_t e) {
  if (2 * (uint64_t)r->seg_table_used >= r->seg_table_mask) return refine_build_seg_table(r);
  enter(r, e);
  return TET_OK;
}

/* Appends the tetrahedra from face h on around edge ab, up to a subface or back
 * to `stop`. */
static tet_status walk_fan(refiner *r, uint32_t h, uint32_t a, uint32_t b, refine_list *list) {
  uint32_t first = h >> 2;
  for (;;) {
    uint32_t t = h >> 2;
    tet_status status = refine_push(r, list, t);
    if (status) return status;
    /* leave through the other face at ab */
    uint32_t i = h & 3, j = 0;
    for (uint32_t k = 0; k < 4; k++)
      if (k != i && r->mesh.v[4 * (size_t)t + k] != a && r->mesh.v[4 * (size_t)t + k] != b) j = k;
    size_t exit = 4 * (size_t)t + j;
    if (refine_sub_at(r, exit) != TET_NONE || r->mesh.adj[exit] == TET_NONE) return TET_OK;
    h = r->mesh.adj[exit];
    if (h >> 2 == first) return TET_OK;
  }
}

/* Appends all tetrahedra at subsegment e to `list`. */
tet_status refine_seg_star(refiner *r, uint32_t e, refine_list *list) {
  uint32_t a = r->seg_v[2 * (size_t)e], b = r->seg_v[2 * (size_t)e + 1];
  uint32_t start = r->seg_sub[e];
  if (start == TET_NONE) {
    uint32_t t = r->seg_tet[e], ca = refine_corner(r, t, a), cb = refine_corner(r, t, b);
    if (t == TET_NONE || ca == 4 || cb == 4) return tet_internal(r->ctx, "a loose subsegment is lost");
    uint32_t i = 0;
    while (i == ca || i == cb) i++;
    return walk_fan(r, 4 * t + i, a, b, list);
  }
  uint32_t edge = start;
  uint32_t from = list->n;
  do {
    uint32_t s = edge / 3;
    for (int side = 0; side < 2; side++) {
      uint32_t h = r->sub_side[2 * (size_t)s + side];
      if (h == TET_NONE) continue;
      int known = 0; /* each fan is met from both of its ends */
      for (uint32_t i = from; i < list->n && !known; i++) known = list->at[i] == h >> 2;
      if (known) continue;
      tet_status status = walk_fan(r, h, a, b, list);
      if (status) return status;
    }
    edge = r->ring[edge];
  } while (edge != start);
  return TET_OK;
}
