// SPDX-License-Identifier: Apache-2.0
/* store.c: slots of tetrahedra, subfaces, subsegments and points, and the way
 * back into pieces. Freed slots are chained and used again; no geometry here. */
#include "refine/refiner.h"

const uint8_t refine_edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
const uint8_t refine_edge_of[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

tet_status refine_push(refiner *r, refine_list *list, uint32_t value) {
  if (list->n == list->cap) {
    tet_status status = tet_grow(r->ctx, &list->at, &list->cap, (size_t)list->n + 1, sizeof *list->at);
    if (status) return status;
  }
  list->at[list->n++] = value;
  return TET_OK;
}

/* Makes sure of n more tetrahedra. */
tet_status refine_reserve_tets(refiner *r, size_t n) {
  tet_complex *m = &r->mesh;
  n = m->n_free < n ? (size_t)m->n_slots + n - m->n_free : m->n_slots;
  if (n <= m->cap_slots && n <= r->cap_tet_edges) return TET_OK;
  tet_status status = tet_complex_reserve(m, n);
  n = m->cap_slots;
  if (!status) status = tet_grow(r->ctx, &r->tet_sub, &r->cap_tet_sub, 4 * n, sizeof *r->tet_sub);
  if (!status) status = tet_grow(r->ctx, &r->tet_region, &r->cap_tet_region, n, sizeof *r->tet_region);
  if (!status) status = tet_grow(r->ctx, &r->tet_edges, &r->cap_tet_edges, n, 1);
  return status;
}

tet_status refine_new_tet(refiner *r, uint32_t *ret_tet) {
  tet_status status = refine_reserve_tets(r, 1);
  if (!status) status = tet_complex_new(&r->mesh, ret_tet);
  if (status) return status;
  for (size_t h = 4 * (size_t)*ret_tet; h < 4 * (size_t)*ret_tet + 4; h++) r->mesh.adj[h] = TET_NONE;
  r->tet_edges[*ret_tet] = r->mesh.wall[*ret_tet] = 0;
  return TET_OK;
}

tet_status refine_new_sub(refiner *r, uint32_t *ret_sub) {
  uint32_t s = r->free_sub;
  if (s != TET_NONE) {
    r->free_sub = r->sub_v[3 * (size_t)s + 1];
  } else {
    size_t n = (size_t)r->n_subs + 1;
    tet_status status = tet_grow(r->ctx, &r->sub_v, &r->cap_sub_v, 3 * n, sizeof *r->sub_v);
    if (!status) status = tet_grow(r->ctx, &r->sub_side, &r->cap_sub_side, 2 * n, sizeof *r->sub_side);
    if (!status) status = tet_grow(r->ctx, &r->sub_seg, &r->cap_sub_seg, 3 * n, sizeof *r->sub_seg);
    if (!status) status = tet_grow(r->ctx, &r->ring, &r->cap_ring, 3 * n, sizeof *r->ring);
    if (!status) status = tet_grow(r->ctx, &r->sub_patch, &r->cap_sub_patch, n, sizeof *r->sub_patch);
    if (!status) status = tet_grow(r->ctx, &r->sub_mark, &r->cap_sub_mark, n, 1);
    if (status) return status;
    s = r->n_subs++;
  }
  r->sub_mark[s] = 0;
  r->sub_side[2 * (size_t)s] = r->sub_side[2 * (size_t)s + 1] = TET_NONE;
  for (int j = 0; j < 3; j++) {
    r->sub_seg[3 * (size_t)s + j] = TET_NONE;
    r->ring[3 * (size_t)s + j] = 3 * s + (uint32_t)j;
  }
  *ret_sub = s;
  return TET_OK;
}

void refine_free_sub(refiner *r, uint32_t s) {
  r->sub_v[3 * (size_t)s] = TET_NONE;
  r->sub_v[3 * (size_t)s + 1] = r->free_sub;
  r->sub_mark[s] = 0;
  r->free_sub = s;
}

tet_status refine_new_seg(refiner *r, uint32_t *ret_seg) {
  size_t n = (size_t)r->n_segs + 1;
  tet_status status = tet_grow(r->ctx, &r->seg_v, &r->cap_seg_v, 2 * n, sizeof *r->seg_v);
  if (!status) status = tet_grow(r->ctx, &r->seg_of, &r->cap_seg_of, n, sizeof *r->seg_of);
  if (!status) status = tet_grow(r->ctx, &r->seg_sub, &r->cap_seg_sub, n, sizeof *r->seg_sub);
  if (!status) status = tet_grow(r->ctx, &r->seg_tet, &r->cap_seg_tet, n, sizeof *r->seg_tet);
  if (!status) status = tet_grow(r->ctx, &r->seg_waiting, &r->cap_seg_waiting, n, 1);
  if (status) return status;
  uint32_t e = r->n_segs++;
  r->seg_sub[e] = r->seg_tet[e] = TET_NONE;
  r->seg_waiting[e] = 0;
  *ret_seg = e;
  return TET_OK;
}

/* Makes room for n vertices. */
tet_status refine_reserve_vertices(refiner *r, size_t n) {
  tet_pieces *p = r->out;
  tet_status status = tet_grow(r->ctx, &p->points, &r->cap_x, 3 * n, sizeof *p->points);
  if (!status) status = tet_grow(r->ctx, &p->origin, &r->cap_origin, n, sizeof *p->origin);
  if (!status) status = tet_grow(r->ctx, &p->carrier, &r->cap_carrier, n, sizeof *p->carrier);
  if (!status) status = tet_grow(r->ctx, &r->size, &r->cap_size, n, sizeof *r->size);
  if (!status) status = tet_grow(r->ctx, &r->sharp_size, &r->cap_sharp_size, n, sizeof *r->sharp_size);
  if (!status) status = tet_grow(r->ctx, &r->stamp, &r->cap_stamp, n, sizeof *r->stamp);
  if (!status) status = tet_complex_reserve_places(&r->mesh, (uint32_t)n);
  r->points.x = p->points;
  if (!status) r->cap_vertices = n;
  return status;
}

/* Appends a candidate, the vertex that the predicates see until it is dropped. */
tet_status refine_add_point(refiner *r, const double x[3], tet_origin origin, uint32_t carrier) {
  size_t n = (size_t)r->points.n + 1;
  tet_pieces *p = r->out;
  if (n > tet_vertex_limit(r->ctx))
    return tet_fail(r->ctx, TET_E_VERTEX_LIMIT, "the limit of %llu vertices",
                    (unsigned long long)tet_vertex_limit(r->ctx));
  tet_status status = n > r->cap_vertices ? refine_reserve_vertices(r, n + 256) : TET_OK;
  if (status) return status;
  memcpy(p->points + 3 * (n - 1), x, 3 * sizeof *x);
  p->origin[n - 1] = (uint8_t)origin;
  p->carrier[n - 1] = carrier;
  r->stamp[n - 1] = 0;
  r->size[n - 1] = r->sharp_size[n - 1] = 0;
  r->points.n = (uint32_t)n;
  p->n_points = (uint32_t)n;
  return TET_OK;
}

void refine_drop_point(refiner *r) { r->out->n_points = --r->points.n; }

/* Numbers the vertices anew that are left, in their order: Steiner points may have been removed. */
static tet_status pack_points(refiner *r) {
  tet_pieces *p = r->out;
  uint32_t n = r->n_first, *map = r->result.removed_points ? tet_alloc(r->ctx, p->n_points, sizeof *map) : NULL;
  if (!map) return r->result.removed_points ? TET_E_MEMORY : TET_OK;
  for (uint32_t v = 0; v < p->n_points; v++) map[v] = v < r->n_first ? v : TET_NONE;
  for (size_t h = 0; h < 4 * (size_t)r->mesh.n_slots; h++)
    if (refine_alive(r, (uint32_t)(h / 4))) map[r->mesh.v[h]] = r->mesh.v[h];
  for (uint32_t v = r->n_first; v < p->n_points; v++) {
    if (map[v] == TET_NONE) continue;
    memmove(p->points + 3 * (size_t)n, p->points + 3 * (size_t)v, 3 * sizeof *p->points);
    p->origin[n] = p->origin[v];
    p->carrier[n] = p->carrier[v];
    map[v] = n++;
  }
  p->n_points = r->points.n = n;
  for (size_t h = 0; h < 4 * (size_t)r->mesh.n_slots; h++)
    if (refine_alive(r, (uint32_t)(h / 4))) r->mesh.v[h] = map[r->mesh.v[h]];
  for (size_t h = 0; h < 3 * (size_t)r->n_subs; h++)
    if (r->sub_v[h - h % 3] != TET_NONE) r->sub_v[h] = map[r->sub_v[h]];
  for (size_t h = 0; h < 2 * (size_t)r->n_segs; h++) r->seg_v[h] = map[r->seg_v[h]];
  tet_free(r->ctx, map);
  return TET_OK;
}

/* Moves live tetrahedra to the front, in order; map[old] = new. What refinement alone needs
 * does not come along. */
static void pack_tets(refiner *r, uint32_t *map) {
  uint32_t n = 0;
  for (uint32_t t = 0; t < r->mesh.n_slots; t++) map[t] = refine_alive(r, t) ? n++ : TET_NONE;
  for (uint32_t t = 0; t < r->mesh.n_slots; t++) {
    if (map[t] == TET_NONE) continue;
    size_t to = map[t];
    for (size_t i = 0; i < 4; i++) {
      uint32_t h = r->mesh.adj[4 * (size_t)t + i];
      r->mesh.v[4 * to + i] = r->mesh.v[4 * (size_t)t + i];
      r->mesh.adj[4 * to + i] = h == TET_NONE ? h : 4 * map[h >> 2] + (h & 3);
    }
    r->tet_region[to] = r->tet_region[t];
  }
  r->mesh.n_slots = n;
}

/* Packs everything back into the pieces, which own the arrays again. */
tet_status refine_unload(refiner *r) {
  tet_pieces *p = r->out;
  uint32_t *map = tet_alloc(r->ctx, r->mesh.n_slots, sizeof *map);
  uint32_t *facet = tet_alloc(r->ctx, r->n_subs, sizeof *facet);
  if (!map || !facet) {
    tet_free(r->ctx, map);
    tet_free(r->ctx, facet);
    return TET_E_MEMORY;
  }
  tet_status status = pack_points(r);
  if (status) {
    tet_free(r->ctx, map);
    tet_free(r->ctx, facet);
    return status;
  }
  pack_tets(r, map);
  tet_free(r->ctx, map);
  uint32_t n = 0;
  for (uint32_t s = 0; s < r->n_subs; s++) {
    if (r->sub_v[3 * (size_t)s] == TET_NONE) continue;
    memmove(r->sub_v + 3 * (size_t)n, r->sub_v + 3 * (size_t)s, 3 * sizeof *r->sub_v);
    facet[n++] = r->patch[r->sub_patch[s]].facet;
  }
  p->n_subfaces = n;
  p->subface = r->sub_v;
  p->subface_facet = facet;
  p->n_tets = r->mesh.n_slots;
  p->tets = r->mesh.v;
  p->adj = r->mesh.adj;
  p->region = r->tet_region;
  p->n_subsegs = r->n_segs;
  p->subseg = r->seg_v;
  p->subseg_segment = r->seg_of;
  p->cap_points = p->cap_origin = p->cap_carrier = p->n_points;
  r->sub_v = r->mesh.v = r->mesh.adj = r->tet_region = r->seg_v = r->seg_of = NULL;
  return TET_OK;
}

static void *duplicate(refiner *r, const void *from, size_t n, size_t size) {
  void *to = tet_alloc(r->ctx, n, size);
  if (to && n) memcpy(to, from, n * size);
  return to;
}

/* Copies what refinement changes of the pieces, as loaded: all slots are in use. */
tet_status refine_copy(refiner *r, tet_pieces *ret) {
  const tet_pieces *p = r->out;
  size_t n = r->points.n, t = r->mesh.n_slots, s = r->n_subs, e = r->n_segs;
  *ret = (tet_pieces){.n_points = (uint32_t)n, .n_tets = (uint32_t)t, .n_subfaces = (uint32_t)s, .n_subsegs = (uint32_t)e};
  ret->cap_points = 3 * n;
  ret->cap_origin = ret->cap_carrier = n;
  ret->points = duplicate(r, p->points, 3 * n, sizeof *ret->points);
  ret->origin = duplicate(r, p->origin, n, 1);
  ret->carrier = duplicate(r, p->carrier, n, sizeof *ret->carrier);
  ret->tets = duplicate(r, r->mesh.v, 4 * t, sizeof *ret->tets);
  ret->adj = duplicate(r, r->mesh.adj, 4 * t, sizeof *ret->adj);
  ret->region = duplicate(r, r->tet_region, t, sizeof *ret->region);
  ret->subface = duplicate(r, r->sub_v, 3 * s, sizeof *ret->subface);
  ret->subface_facet = tet_alloc(r->ctx, s, sizeof *ret->subface_facet);
  ret->subseg = duplicate(r, r->seg_v, 2 * e, sizeof *ret->subseg);
  ret->subseg_segment = duplicate(r, r->seg_of, e, sizeof *ret->subseg_segment);
  for (uint32_t i = 0; i < s && ret->subface_facet; i++) ret->subface_facet[i] = r->patch[r->sub_patch[i]].facet;
  int got = ret->points && ret->origin && ret->carrier && ret->tets && ret->adj && ret->region && ret->subface &&
            ret->subface_facet && ret->subseg && ret->subseg_segment;
  return got ? TET_OK : TET_E_MEMORY;
}

/* Gives the pieces of a released refiner what was copied of them. */
void refine_restore(refiner *r, tet_pieces *copy) {
  tet_pieces *p = r->out, keep = *p;
  tet_free(r->ctx, p->points);
  tet_free(r->ctx, p->origin);
  tet_free(r->ctx, p->carrier);
  *p = *copy;
  *copy = (tet_pieces){0};
  p->n_input = keep.n_input;
  p->n_segments = keep.n_segments;
  p->segment = keep.segment;
  p->n_facets = keep.n_facets;
  p->facet = keep.facet;
  p->n_regions = keep.n_regions;
  p->region_marker = keep.region_marker;
  p->region_attribute = keep.region_attribute;
  p->region_max_volume = keep.region_max_volume;
}

/* Frees what the refiner still owns. */
void refine_release(refiner *r) {
  refine_cavity *c = &r->cavity;
  void *all[] = {r->size, r->sharp_size, r->stamp, r->tet_sub, r->tet_region, r->tet_edges, r->sub_v, r->sub_side,
                 r->sub_seg, r->ring, r->sub_patch, r->sub_mark, r->patch, r->seg_v, r->seg_of, r->seg_sub,
                 r->seg_tet, r->seg_waiting, r->seg_table, r->segment_sharp, r->segment_sine, r->facet_thin, r->segment_end,
                 r->vertex_facet_start, r->vertex_facet, r->segment_facet_start, r->segment_facet, r->facet_vertex_start,
                 r->facet_vertex, r->facet_plane, c->removed.at, c->subs.at, c->rim.at,
                 c->rim_new.at, c->vertices.at, c->carry, c->spoke, c->shapes, r->hit_segs.at, r->hit_subs.at, r->star.at,
                 r->suspects.at, r->stuck.at, r->seg_queue, r->sub_queue, r->bad.head, r->bad.used, r->bad.chunk, r->max_volume,
                 r->low, r->sharp_at, r->round_start};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) tet_free(r->ctx, all[i]);
  tet_complex_free(&r->mesh);
}
