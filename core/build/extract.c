// SPDX-License-Identifier: Apache-2.0
/* extract.c: from the complex of the whole space to the pieces of the domain. */
#include "build/state.h"

#include <string.h>

#include "mesh/edge_map.h"

/* Copies the tetrahedra of parts other than 0, with the triangle at each face. */
static tet_status copy_tetrahedra(tet_state *st, const uint32_t *face_tri, const uint32_t *part,
                                  tet_pieces *p, uint32_t **ret_tri) {
  const tet_complex *c = &st->complex;
  uint32_t n = 0, *number = tet_alloc(st->ctx, c->n_slots, sizeof *number);
  if (!number) return tet_ctx_error(st->ctx)->status;
  for (uint32_t t = 0; t < c->n_slots; t++)
    number[t] = tet_is_live(c, t) && !tet_is_ghost(c, t) && part[t] ? n++ : TET_NONE;
  p->tets = tet_alloc(st->ctx, 4 * (size_t)n, sizeof *p->tets);
  p->adj = tet_alloc(st->ctx, 4 * (size_t)n, sizeof *p->adj);
  p->region = tet_alloc(st->ctx, n, sizeof *p->region);
  *ret_tri = tet_alloc(st->ctx, 4 * (size_t)n, sizeof **ret_tri);
  tet_status status = p->tets && p->adj && p->region && *ret_tri ? TET_OK : tet_ctx_error(st->ctx)->status;
  for (size_t t = 0; t < c->n_slots && status == TET_OK; t++) {
    size_t to = number[t];
    if (number[t] == TET_NONE) continue;
    for (size_t i = 0; i < 4; i++) {
      uint32_t g = c->adj[4 * t + i];
      p->tets[4 * to + i] = c->v[4 * t + i];
      p->adj[4 * to + i] = number[g >> 2] == TET_NONE ? TET_NONE : 4 * number[g >> 2] + (g & 3);
      (*ret_tri)[4 * to + i] = face_tri ? face_tri[4 * t + i] : TET_NONE;
    }
    p->region[to] = part[t] - 1;
  }
  p->n_tets = n;
  tet_free(st->ctx, number);
  return status;
}

tet_status tet_extract_tetrahedra(tet_state *st, const uint32_t *face_tri, const uint32_t *part,
                                  tet_pieces *p, uint32_t **ret_tri) {
  tet_status status = copy_tetrahedra(st, face_tri, part, p, ret_tri);
  if (status != TET_OK) return status;
  p->points = st->points.x; /* the coordinates change owner */
  p->cap_points = st->cap_x;
  p->n_points = st->points.n;
  p->n_input = st->n_input;
  st->points.x = NULL;
  st->cap_x = 0;
  return TET_OK;
}

/* One subface for each triangle at a face; both sides of the face count once. */
static tet_status collect_subfaces(tet_state *st, const uint32_t *tri, tet_pieces *p) {
  const tet_surface *s = &st->surface;
  size_t n = 0;
  for (size_t h = 0; h < 4 * (size_t)p->n_tets; h++)
    n += tri[h] != TET_NONE && (p->adj[h] == TET_NONE || h < p->adj[h]);
  p->subface = tet_alloc(st->ctx, 3 * n, sizeof *p->subface);
  p->subface_facet = tet_alloc(st->ctx, n, sizeof *p->subface_facet);
  if (!p->subface || !p->subface_facet) return tet_ctx_error(st->ctx)->status;
  for (size_t h = 0; h < 4 * (size_t)p->n_tets; h++) {
    if (tri[h] == TET_NONE || (p->adj[h] != TET_NONE && h > p->adj[h])) continue;
    for (size_t j = 0; j < 3; j++) p->subface[3 * (size_t)p->n_subfaces + j] = p->tets[(h & ~(size_t)3) + tet_face[h & 3][j]];
    p->subface_facet[p->n_subfaces++] = s->patch[s->tri_patch[tri[h]]].facet;
  }
  return TET_OK;
}

/* Marks the subsegments that are no subface's but edges of some tetrahedron: loose segments, and sides of facets
 * that are outside. */
static tet_status find_bare(tet_state *st, const tet_pieces *p, uint8_t *used) {
  const tet_surface *s = &st->surface;
  tet_edge_map edges = {NULL, 0, 0};
  uint8_t *on = tet_calloc(st->ctx, p->n_points, 1);
  tet_status status = on ? TET_OK : tet_ctx_error(st->ctx)->status;
  for (uint32_t e = 0; e < s->n_subsegs && status == TET_OK; e++) {
    const uint32_t *v = s->subseg + 2 * (size_t)e;
    if (used[e]) continue;
    on[v[0]] = on[v[1]] = 1;
    status = tet_edge_map_put(st->ctx, &edges, v[0], v[1], e);
  }
  for (size_t t = 0; t < p->n_tets && edges.n && status == TET_OK; t++)
    for (size_t i = 0; i < 4; i++)
      for (size_t j = i + 1; j < 4; j++) {
        uint32_t a = p->tets[4 * t + i], b = p->tets[4 * t + j];
        uint32_t e = on[a] && on[b] ? tet_edge_map_get(&edges, a, b) : TET_NONE;
        if (e != TET_NONE) used[e] = 1;
      }
  tet_edge_map_free(st->ctx, &edges);
  tet_free(st->ctx, on);
  return status;
}

/* The subsegments that are edges of some tetrahedron. Flips inside a facet leave the subsegments of their
 * two triangles to these. */
static tet_status collect_subsegments(tet_state *st, const uint32_t *tri, tet_pieces *p) {
  const tet_surface *s = &st->surface;
  uint8_t *used = tet_calloc(st->ctx, s->n_subsegs, 1);
  p->subseg = tet_alloc(st->ctx, 2 * (size_t)s->n_subsegs, sizeof *p->subseg);
  p->subseg_segment = tet_alloc(st->ctx, s->n_subsegs, sizeof *p->subseg_segment);
  tet_status status = used && p->subseg && p->subseg_segment ? TET_OK : tet_ctx_error(st->ctx)->status;
  for (size_t h = 0; h < 4 * (size_t)p->n_tets && status == TET_OK; h++)
    for (size_t j = 0; j < 3 && tri[h] != TET_NONE; j++) {
      uint32_t e = s->tri_seg[3 * (size_t)tri[h] + j];
      if (e != TET_NONE) used[e] = 1;
    }
  if (status == TET_OK) status = find_bare(st, p, used);
  for (uint32_t e = 0; e < s->n_subsegs && status == TET_OK; e++) {
    if (!used[e]) continue;
    memcpy(p->subseg + 2 * (size_t)p->n_subsegs, s->subseg + 2 * (size_t)e, 2 * sizeof *p->subseg);
    p->subseg_segment[p->n_subsegs++] = s->subseg_segment[e];
  }
  tet_free(st->ctx, used);
  return status;
}

/* Leaves out Steiner points that nothing uses; fills origin and carrier. */
static tet_status compact_points(tet_state *st, tet_pieces *p) {
  uint32_t n = p->n_input, *number = tet_alloc(st->ctx, p->n_points, sizeof *number);
  if (number) memset(number, 0xff, p->n_points * sizeof *number);
  for (size_t i = 0; number && i < 4 * (size_t)p->n_tets; i++) number[p->tets[i]] = 0;
  for (uint32_t v = 0; number && v < p->n_points; v++)
    if (v < p->n_input) number[v] = v;
    else if (number[v] != TET_NONE) number[v] = n++;
  p->origin = tet_calloc(st->ctx, n, 1);
  p->carrier = tet_alloc(st->ctx, n, sizeof *p->carrier);
  if (!number || !p->origin || !p->carrier) {
    tet_free(st->ctx, number);
    return tet_ctx_error(st->ctx)->status;
  }
  p->cap_origin = p->cap_carrier = n;
  for (size_t v = 0; v < p->n_points; v++) {
    if (number[v] == TET_NONE) continue;
    memmove(p->points + 3 * (size_t)number[v], p->points + 3 * v, 3 * sizeof *p->points);
    tet_carrier on = v < p->n_input ? (tet_carrier){TET_ORIGIN_INPUT, TET_NONE} : st->carrier[v - p->n_input];
    p->origin[number[v]] = on.origin;
    p->carrier[number[v]] = on.number;
  }
  for (size_t i = 0; i < 4 * (size_t)p->n_tets; i++) p->tets[i] = number[p->tets[i]];
  for (size_t i = 0; i < 3 * (size_t)p->n_subfaces; i++) p->subface[i] = number[p->subface[i]];
  for (size_t i = 0; i < 2 * (size_t)p->n_subsegs; i++) p->subseg[i] = number[p->subseg[i]];
  p->n_points = n;
  tet_free(st->ctx, number);
  return TET_OK;
}

tet_status tet_extract_constraints(tet_state *st, const uint32_t *tri, tet_pieces *p) {
  tet_status status = collect_subfaces(st, tri, p);
  if (status == TET_OK) status = collect_subsegments(st, tri, p);
  if (status == TET_OK) status = compact_points(st, p);
  if (status != TET_OK) return status;
  tet_surface *s = &st->surface;
  p->segment = s->segment;
  p->n_segments = s->n_segments;
  p->facet = s->facet;
  p->n_facets = s->n_facets;
  s->segment = NULL;
  s->facet = NULL;
  return TET_OK;
}
