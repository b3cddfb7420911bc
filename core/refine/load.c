// SPDX-License-Identifier: Apache-2.0
/* load.c: from pieces to the refiner's form: subfaces at their faces, rings at
 * their edges, patches, and which facets each vertex and segment lies on.
 * Takes the arrays of the pieces over; decides nothing about refinement. */
#include "refine/refiner.h"

#include "base/sort.h"
#include "base/vector.h"
#include "exact/shape.h"

#include <math.h>
#include <string.h>

/* Up to three numbers, sorted, to a slot's start. */
static uint64_t mix(uint64_t a, uint64_t b, uint64_t c) {
  uint64_t h = (a * 0x9e3779b97f4a7c15u) ^ (b * 0xc2b2ae3d27d4eb4fu) ^ (c * 0x165667b19e3779f9u);
  return h ^ h >> 29 ^ h >> 43;
}

static uint32_t *new_table(refiner *r, uint64_t items, uint64_t *ret_mask) {
  uint64_t size = 64;
  while (size < 2 * items) size *= 2;
  uint32_t *table = tet_alloc(r->ctx, size, sizeof *table);
  if (table) memset(table, 0xff, size * sizeof *table);
  *ret_mask = size - 1;
  return table;
}

static int same_face(const uint32_t *sorted, const uint32_t *face) {
  uint32_t v[3] = {face[0], face[1], face[2]};
  tet_sort3(v);
  return memcmp(v, sorted, sizeof v) == 0;
}

/* Hangs subfaces on the faces of tetrahedra. */
static tet_status hang_subfaces(refiner *r) {
  uint64_t mask;
  uint32_t *table = new_table(r, r->n_subs, &mask);
  uint8_t *on = tet_calloc(r->ctx, r->points.n, 1);
  tet_status status = table && on ? TET_OK : TET_E_MEMORY;
  for (uint32_t s = 0; s < r->n_subs && !status; s++) {
    uint32_t v[3];
    memcpy(v, r->sub_v + 3 * (size_t)s, sizeof v);
    tet_sort3(v);
    uint64_t i = mix(v[0], v[1], v[2]) & mask;
    while (table[i] != TET_NONE) i = (i + 1) & mask;
    table[i] = s;
    for (int j = 0; j < 3; j++) on[v[j]] = 1;
  }
  for (uint32_t t = 0; t < r->mesh.n_slots && !status; t++)
    for (uint32_t f = 0; f < 4; f++) {
      uint32_t v[3], found = TET_NONE, h = 4 * t + f;
      for (int j = 0; j < 3; j++) v[j] = r->mesh.v[4 * (size_t)t + tet_face[f][j]];
      if (!on[v[0]] || !on[v[1]] || !on[v[2]]) continue;
      tet_sort3(v);
      for (uint64_t i = mix(v[0], v[1], v[2]) & mask; table[i] != TET_NONE; i = (i + 1) & mask)
        if (same_face(v, r->sub_v + 3 * (size_t)table[i])) found = table[i];
      if (found == TET_NONE) continue;
      refine_hang(r, found, h);
    }
  for (size_t h = 0; h < 4 * (size_t)r->mesh.n_slots && !status; h++)
    if (r->mesh.adj[h] == TET_NONE && refine_sub_at(r, h) == TET_NONE)
      status = tet_internal(r->ctx, "a boundary face is no subface");
  for (uint32_t s = 0; s < r->n_subs && !status; s++)
    if (r->sub_side[2 * (size_t)s] == TET_NONE) status = tet_internal(r->ctx, "a subface is no face");
  tet_free(r->ctx, table);
  tet_free(r->ctx, on);
  return status;
}

/* Links the edges of subfaces into rings and finds their subsegments. */
static tet_status link_rings(refiner *r) {
  uint64_t mask;
  uint32_t *table = new_table(r, 3 * (uint64_t)r->n_subs, &mask);
  if (!table) return TET_E_MEMORY;
  for (uint32_t h = 0; h < 3 * r->n_subs; h++) {
    uint32_t base = h - h % 3, a = r->sub_v[h], b = r->sub_v[base + (h + 1) % 3];
    uint64_t i = a < b ? mix(a, b, 7) & mask : mix(b, a, 7) & mask;
    for (; table[i] != TET_NONE; i = (i + 1) & mask) {
      uint32_t o = table[i], c = r->sub_v[o], d = r->sub_v[o - o % 3 + (o + 1) % 3];
      if ((a == c && b == d) || (a == d && b == c)) break;
    }
    if (table[i] == TET_NONE) {
      table[i] = r->ring[h] = h;
    } else {
      r->ring[h] = r->ring[table[i]];
      r->ring[table[i]] = h;
    }
    uint32_t e = refine_find_seg(r, a, b);
    r->sub_seg[h] = e;
    if (e != TET_NONE) r->seg_sub[e] = h;
  }
  tet_free(r->ctx, table);
  return TET_OK;
}

/* The square of twice its area. */
static double area_of(const refiner *r, uint32_t s) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  double d[3], e[3], n[3];
  tet_minus(refine_x(r, v[1]), refine_x(r, v[0]), d);
  tet_minus(refine_x(r, v[2]), refine_x(r, v[0]), e);
  tet_cross(d, e, n);
  return tet_square(n);
}

static void flip_sub(refiner *r, uint32_t s) {
  uint32_t *v = r->sub_v + 3 * (size_t)s, w = v[1];
  v[1] = v[2];
  v[2] = w;
}

/* Normal, axis, origin and directions of the plane of subface s. */
static void set_plane(const refiner *r, uint32_t s, refine_patch *ret) {
  const uint32_t *v = r->sub_v + 3 * (size_t)s;
  double longest2 = -1;
  tet_unit_normal(refine_x(r, v[0]), refine_x(r, v[1]), refine_x(r, v[2]), ret->normal);
  ret->axis = tet_widest_axis(refine_x(r, v[0]), refine_x(r, v[1]), refine_x(r, v[2]));
  for (int i = 0; i < 3; i++) {
    const double *a = refine_x(r, v[i]), *b = refine_x(r, v[(i + 1) % 3]), *c = refine_x(r, v[(i + 2) % 3]);
    double length2 = tet_distance2(a, b), d[3];
    if (length2 <= longest2) continue;
    longest2 = length2;
    memcpy(ret->origin, a, sizeof ret->origin);
    tet_minus(b, a, ret->along);
    tet_minus(c, a, d);
    double share = length2 > 0 ? tet_dot(d, ret->along) / length2 : 0;
    for (int k = 0; k < 3; k++) ret->across[k] = d[k] - share * ret->along[k];
  }
}

/* The patch of subface `first`: all reached over edges that are no subsegments.
 * Its plane is that of its largest triangle. Orients the members in list order. */
static tet_status gather_patch(refiner *r, uint32_t first, const uint32_t *facet, refine_list *list,
                               uint8_t *turned) {
  uint32_t patch = r->n_patches, largest = first;
  double most = -1;
  list->n = 0;
  r->sub_patch[first] = patch;
  tet_status status = refine_push(r, list, first);
  for (uint32_t k = 0; k < list->n && !status; k++) {
    uint32_t s = list->at[k];
    double area = area_of(r, s);
    if (area > most) {
      most = area;
      largest = s;
    }
    for (uint32_t h = 3 * s; h < 3 * s + 3 && !status; h++) {
      if (r->sub_seg[h] != TET_NONE) continue;
      uint32_t o = r->ring[h], u = o / 3;
      if (o == h || r->ring[o] != h || facet[u] != facet[s])
        return tet_internal(r->ctx, "a facet's edge is no subsegment");
      if (r->sub_patch[u] != TET_NONE) continue;
      r->sub_patch[u] = patch;
      turned[u] = turned[s] ^ (r->sub_v[h] == r->sub_v[o]);
      status = refine_push(r, list, u);
    }
  }
  if (status) return status;
  refine_patch p = {.facet = facet[first]};
  set_plane(r, largest, &p);
  const uint32_t *v = r->sub_v + 3 * (size_t)largest;
  int down = tet_orient2d(&r->points, p.axis, v[0], v[1], v[2]) < 0, back = turned[largest] ^ down;
  for (int i = 0; i < 3 && turned[largest]; i++) p.normal[i] = -p.normal[i]; /* the first subface's */
  for (uint32_t k = 0; k < list->n; k++)
    if (turned[list->at[k]] ^ back) flip_sub(r, list->at[k]);
  status = tet_grow(r->ctx, &r->patch, &r->cap_patch, (size_t)patch + 1, sizeof *r->patch);
  if (!status) r->patch[r->n_patches++] = p;
  return status;
}

static tet_status gather_patches(refiner *r, const uint32_t *facet) {
  refine_list list = {0};
  uint8_t *turned = tet_calloc(r->ctx, r->n_subs, 1);
  tet_status status = turned ? TET_OK : TET_E_MEMORY;
  for (uint32_t s = 0; s < r->n_subs; s++) r->sub_patch[s] = TET_NONE;
  for (uint32_t s = 0; s < r->n_subs && !status; s++)
    if (r->sub_patch[s] == TET_NONE) status = gather_patch(r, s, facet, &list, turned);
  tet_free(r->ctx, turned);
  tet_free(r->ctx, list.at);
  return status;
}

/* Marks the subsegments among the edges of tetrahedra. */
static tet_status mark_edges(refiner *r) {
  uint8_t *on = tet_calloc(r->ctx, r->points.n, 1);
  if (!on) return TET_E_MEMORY;
  for (size_t i = 0; i < 2 * (size_t)r->n_segs; i++) on[r->seg_v[i]] = 1;
  for (uint32_t t = 0; t < r->mesh.n_slots; t++)
    for (int e = 0; e < 6; e++) {
      uint32_t a = r->mesh.v[4 * (size_t)t + refine_edge[e][0]], b = r->mesh.v[4 * (size_t)t + refine_edge[e][1]];
      if (!on[a] || !on[b]) continue;
      uint32_t g = refine_find_seg(r, a, b);
      if (g == TET_NONE) continue;
      r->tet_edges[t] |= (uint8_t)(1 << e);
      if (r->seg_sub[g] != TET_NONE) continue;
      r->tet_edges[t] |= EDGE_LOOSE;
      r->seg_tet[g] = t;
    }
  tet_free(r->ctx, on);
  for (uint32_t e = 0; e < r->n_segs; e++)
    if (r->seg_sub[e] == TET_NONE && r->seg_tet[e] == TET_NONE)
      return tet_internal(r->ctx, "a subsegment is no edge");
  return TET_OK;
}

/* Lists, without repeats, the items of each owner: pairs are (owner, item). */
static tet_status tabulate(refiner *r, uint32_t n_owners, const uint32_t *pairs, size_t n_pairs,
                           uint32_t **ret_start, uint32_t **ret_item) {
  uint32_t *start = *ret_start = tet_calloc(r->ctx, (size_t)n_owners + 2, sizeof *start);
  uint32_t *item = *ret_item = tet_alloc(r->ctx, n_pairs, sizeof *item);
  if (!start || !item) return TET_E_MEMORY;
  for (size_t i = 0; i < n_pairs; i++) start[pairs[2 * i] + 2]++;
  for (uint32_t i = 0; i < n_owners; i++) start[i + 2] += start[i + 1];
  for (size_t i = 0; i < n_pairs; i++) item[start[pairs[2 * i] + 1]++] = pairs[2 * i + 1];
  uint32_t to = 0; /* start[i + 1] is now the end of i's items */
  for (uint32_t i = 0, from = 0; i < n_owners; i++) {
    uint32_t first = to, end = start[i + 1];
    for (; from < end; from++) {
      uint32_t k = first;
      while (k < to && item[k] != item[from]) k++;
      if (k == to) item[to++] = item[from];
    }
    start[i] = first;
  }
  start[n_owners] = to;
  return TET_OK;
}

/* Which facets each vertex and each segment lies on, and the vertices of each facet. */
static tet_status tabulate_facets(refiner *r, const uint32_t *facet) {
  size_t n = 3 * (size_t)r->n_subs, m = 0;
  uint32_t *pairs = tet_alloc(r->ctx, 2 * n, sizeof *pairs);
  if (!pairs) return TET_E_MEMORY;
  for (size_t h = 0; h < n; h++) {
    pairs[2 * h] = r->sub_v[h];
    pairs[2 * h + 1] = facet[h / 3];
  }
  tet_status status = tabulate(r, r->points.n, pairs, n, &r->vertex_facet_start, &r->vertex_facet);
  for (size_t h = 0; h < n; h++) {
    pairs[2 * h] = facet[h / 3];
    pairs[2 * h + 1] = r->sub_v[h];
  }
  if (!status) status = tabulate(r, r->out->n_facets, pairs, n, &r->facet_vertex_start, &r->facet_vertex);
  for (size_t h = 0; h < n; h++)
    if (r->sub_seg[h] != TET_NONE) {
      pairs[2 * m] = r->seg_of[r->sub_seg[h]];
      pairs[2 * m++ + 1] = facet[h / 3];
    }
  if (!status)
    status = tabulate(r, r->out->n_segments, pairs, m, &r->segment_facet_start, &r->segment_facet);
  tet_free(r->ctx, pairs);
  return status;
}

/* memset, but an array without elements may be NULL. */
static void set_bytes(void *array, int byte, size_t n) {
  if (n > 0) memset(array, byte, n);
}

/* Takes the arrays over and makes room for what belongs to each element. */
static tet_status take_over(refiner *r) {
  tet_pieces *p = r->out;
  uint32_t n = p->n_points;
  r->n_first = n;
  r->points = (tet_points){.x = p->points, .n = n, .first_implicit = TET_NONE};
  for (size_t i = 0; i < 3 * (size_t)n; i++)
    if (fabs(p->points[i]) > r->points.max_abs) r->points.max_abs = fabs(p->points[i]);
  r->cap_x = 3 * (size_t)n;
  r->cap_origin = r->cap_carrier = n;
  tet_complex_init(&r->mesh, r->ctx, &r->points);
  r->mesh.is_walled = 1;
  r->mesh.v = p->tets;
  r->mesh.adj = p->adj;
  r->mesh.n_slots = r->mesh.n_live = p->n_tets;
  r->mesh.cap_v = r->mesh.cap_adj = 4 * (size_t)p->n_tets;
  r->tet_region = p->region;
  r->cap_tet_region = p->n_tets;
  r->sub_v = p->subface;
  r->n_subs = p->n_subfaces;
  r->cap_sub_v = 3 * (size_t)p->n_subfaces;
  r->seg_v = p->subseg;
  r->seg_of = p->subseg_segment;
  r->n_segs = p->n_subsegs;
  r->cap_seg_v = 2 * (size_t)p->n_subsegs;
  r->cap_seg_of = p->n_subsegs;
  p->tets = p->adj = p->region = p->subface = p->subseg = p->subseg_segment = NULL;
  p->n_tets = p->n_subfaces = p->n_subsegs = 0;
  r->free_sub = TET_NONE;

  size_t t = r->mesh.n_slots, s = r->n_subs, e = r->n_segs;
  tet_status status = refine_reserve_vertices(r, n);
  if (!status) status = refine_reserve_tets(r, 0);
  if (!status) status = tet_grow(r->ctx, &r->sub_side, &r->cap_sub_side, 2 * s, sizeof *r->sub_side);
  if (!status) status = tet_grow(r->ctx, &r->sub_seg, &r->cap_sub_seg, 3 * s, sizeof *r->sub_seg);
  if (!status) status = tet_grow(r->ctx, &r->ring, &r->cap_ring, 3 * s, sizeof *r->ring);
  if (!status) status = tet_grow(r->ctx, &r->sub_patch, &r->cap_sub_patch, s, sizeof *r->sub_patch);
  if (!status) status = tet_grow(r->ctx, &r->sub_mark, &r->cap_sub_mark, s, 1);
  if (!status) status = tet_grow(r->ctx, &r->seg_sub, &r->cap_seg_sub, e, sizeof *r->seg_sub);
  if (!status) status = tet_grow(r->ctx, &r->seg_tet, &r->cap_seg_tet, e, sizeof *r->seg_tet);
  if (!status) status = tet_grow(r->ctx, &r->seg_waiting, &r->cap_seg_waiting, e, 1);
  if (status) return status;
  set_bytes(r->size, 0, n * sizeof *r->size);
  set_bytes(r->sharp_size, 0, n * sizeof *r->sharp_size);
  set_bytes(r->stamp, 0, n * sizeof *r->stamp);
  set_bytes(r->mesh.flag, 0, t);
  set_bytes(r->mesh.wall, 0, t);
  set_bytes(r->tet_edges, 0, t);
  set_bytes(r->sub_side, 0xff, 2 * s * sizeof *r->sub_side);
  set_bytes(r->sub_mark, 0, s);
  set_bytes(r->seg_sub, 0xff, e * sizeof *r->seg_sub);
  set_bytes(r->seg_tet, 0xff, e * sizeof *r->seg_tet);
  set_bytes(r->seg_waiting, 0, e);
  return TET_OK;
}

/* 1 if the two subfaces at crease e are of one facet and in one plane but for last bits. */
static int is_flat_crease(const refiner *r, uint32_t e) {
  static const double tolerance = 1e-12;
  uint32_t h = r->seg_sub[e], o = h == TET_NONE ? h : r->ring[h];
  if (h == o || r->ring[o] != h || r->out->subface_facet[h / 3] != r->out->subface_facet[o / 3]) return 0;
  const uint32_t *v = r->sub_v + 3 * (size_t)(h / 3);
  uint32_t apex = r->sub_v[o - o % 3 + (o + 2) % 3];
  const double *a = refine_x(r, v[0]), *d = refine_x(r, apex);
  double n[3], reach[3];
  tet_unit_normal(a, refine_x(r, v[1]), refine_x(r, v[2]), n);
  tet_direction(d, a, reach);
  return fabs(tet_dot(n, reach)) <= tolerance * sqrt(tet_square(reach));
}

/* Drops the creases that are flat all along: inside one input facet they are no
 * bounds to anything. */
static tet_status drop_creases(refiner *r) {
  uint8_t *keep = tet_calloc(r->ctx, r->out->n_segments, 1);
  if (!keep) return TET_E_MEMORY;
  for (uint32_t e = 0; e < r->n_segs; e++) {
    uint32_t s = r->seg_of[e];
    if (!r->out->segment[s].crease || !is_flat_crease(r, e)) keep[s] = 1;
  }
  uint32_t n = 0;
  for (uint32_t e = 0; e < r->n_segs; e++) {
    if (!keep[r->seg_of[e]]) continue;
    memmove(r->seg_v + 2 * (size_t)n, r->seg_v + 2 * (size_t)e, 2 * sizeof *r->seg_v);
    r->seg_of[n++] = r->seg_of[e];
  }
  int dropped = n < r->n_segs;
  r->n_segs = n;
  tet_free(r->ctx, keep);
  if (!dropped) return TET_OK;
  memset(r->seg_sub, 0xff, n * sizeof *r->seg_sub);
  return refine_build_seg_table(r);
}

tet_status refine_load(refiner *r) {
  tet_status status = take_over(r);
  if (!status) status = refine_build_seg_table(r);
  if (!status) status = hang_subfaces(r);
  if (!status) status = link_rings(r);
  if (!status) status = drop_creases(r);
  if (!status) status = link_rings(r);
  const uint32_t *facet = r->out->subface_facet;
  if (!status) status = gather_patches(r, facet);
  if (!status) status = link_rings(r); /* patches turned some subfaces */
  if (!status) status = mark_edges(r);
  if (!status) status = tabulate_facets(r, facet);
  if (!status) status = refine_find_planes(r);
  if (!status) {
    tet_free(r->ctx, r->out->subface_facet);
    r->out->subface_facet = NULL;
  }
  return status;
}
