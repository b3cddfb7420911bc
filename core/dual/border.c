// SPDX-License-Identifier: Apache-2.0
/* border.c: what the Voronoi cells have of the borders of regions: for each vertex of a facet
 * there, the polygon of the circumcentres of its subfaces, in the order in which they lie
 * around it up to the facet's segments. Between two regions it is a face of both cells. */
#include "dual/polygons.h"
#include "mesh/pieces.h"

enum { POLL_EVERY = 1024 };

static tet_status note_side(tet_polygons *p, uint32_t t, const uint8_t corner[3]) {
  const uint32_t *v = p->mesh->tetrahedra + 4 * (size_t)t;
  uint32_t f[3] = {v[corner[0]], v[corner[1]], v[corner[2]]}, s = tet_find_subface(p, f[0], f[1], f[2]);
  if (s == TET_NONE) return tet_internal(p->ctx, "a region ends off the subfaces");
  const uint32_t *g = p->mesh->subfaces + 3 * (size_t)s;
  uint32_t at = g[0] == f[0] ? 0 : g[1] == f[0] ? 1 : 2;
  p->side[2 * (size_t)s + (g[(at + 1) % 3] != f[1])] = p->mesh->tetrahedron_regions[t]; /* f is outward */
  return TET_OK;
}

tet_status tet_find_sides(tet_polygons *p) {
  const tet_mesh *m = p->mesh;
  p->side = tet_alloc(p->ctx, m->n_subfaces, 2 * sizeof *p->side);
  tet_status status = p->side ? TET_OK : tet_ctx_error(p->ctx)->status;
  for (size_t i = 0; p->side && i < 2 * (size_t)m->n_subfaces; i++) p->side[i] = TET_NONE;
  for (uint32_t t = 0; t < m->n_tetrahedra && status == TET_OK; t++) {
    for (size_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t next = m->neighbours[4 * (size_t)t + i];
      if (next == TET_NONE || m->tetrahedron_regions[next] != m->tetrahedron_regions[t])
        status = note_side(p, t, tet_face[i]);
    }
    if (t % POLL_EVERY == 0 && status == TET_OK) status = tet_poll(p->ctx);
  }
  return status;
}

/* The border subfaces around one vertex. */
typedef struct ring {
  const tet_keyed *item; /* values: rows of subfaces */
  size_t n;
  uint32_t v;
} ring;

static int is_border(const tet_polygons *p, uint32_t s) {
  return p->side[2 * (size_t)s] != TET_NONE || p->side[2 * (size_t)s + 1] != TET_NONE;
}

/* The vertex of subface s that is neither a nor b. */
static uint32_t third(const tet_polygons *p, uint32_t s, uint32_t a, uint32_t b) {
  const uint32_t *v = p->mesh->subfaces + 3 * (size_t)s;
  for (int i = 0; i < 2; i++)
    if (v[i] != a && v[i] != b) return v[i];
  return v[2];
}

/* The subface beyond edge vx of s, in the same facet; TET_NONE at a segment. */
static uint32_t beyond(const tet_polygons *p, const ring *r, uint32_t s, uint32_t x) {
  if (tet_edge_map_get(&p->subsegment, r->v, x) != TET_NONE) return TET_NONE;
  for (size_t i = 0; i < r->n; i++) {
    uint32_t other = (uint32_t)r->item[i].value;
    const uint32_t *v = p->mesh->subfaces + 3 * (size_t)other;
    if (other != s && (v[0] == x || v[1] == x || v[2] == x)) return other;
  }
  return TET_NONE;
}

static tet_status add_midpoint(tet_polygons *p, uint32_t v, uint32_t x) {
  uint32_t segment = tet_edge_map_get(&p->subsegment, v, x);
  return segment == TET_NONE ? TET_OK : tet_add_corner(p, tet_subsegment_point(p, segment));
}

/* The polygon of r->v with subface s in it, counterclockwise seen from before s; marks `seen`
 * [n_subfaces], a bit for each corner. */
static tet_status add_ring(tet_polygons *p, const ring *r, uint32_t s, uint8_t *seen) {
  const uint32_t *v = p->mesh->subfaces + 3 * (size_t)s, *side = p->side + 2 * (size_t)s;
  uint32_t corner = v[0] == r->v ? 0 : v[1] == r->v ? 1 : 2, at = s, x = v[(corner + 1) % 3], next;
  tet_status status = TET_OK;
  while ((next = beyond(p, r, at, x)) != TET_NONE && next != s) { /* back to the ring's beginning */
    at = next;
    x = third(p, at, r->v, x);
  }
  int closed = next == s;
  if (closed) {
    at = s;
    x = v[(corner + 1) % 3];
  } else {
    status = tet_add_corner(p, tet_vertex_point(p, r->v));
    if (status == TET_OK) status = add_midpoint(p, r->v, x);
  }
  for (uint32_t begin = at; status == TET_OK;) {
    const uint32_t *w = p->mesh->subfaces + 3 * (size_t)at;
    seen[at] = (uint8_t)(seen[at] | 1 << (w[0] == r->v ? 0 : w[1] == r->v ? 1 : 2));
    status = tet_add_corner(p, tet_subface_point(p, at));
    x = third(p, at, r->v, x);
    next = beyond(p, r, at, x);
    if (next == TET_NONE || next == begin) break;
    at = next;
  }
  if (!closed && status == TET_OK) status = add_midpoint(p, r->v, x);
  if (status != TET_OK) return status;
  return tet_end_polygon(p, tet_cell_of(p, r->v, side[0]), tet_cell_of(p, r->v, side[1]));
}

tet_status tet_border_polygons(tet_polygons *p) {
  const tet_mesh *m = p->mesh;
  tet_keyed *item = tet_alloc(p->ctx, 3 * (size_t)m->n_subfaces, sizeof *item);
  uint8_t *seen = tet_calloc(p->ctx, m->n_subfaces, 1);
  tet_status status = item && seen ? TET_OK : tet_ctx_error(p->ctx)->status;
  size_t n = 0;
  for (uint32_t s = 0; s < m->n_subfaces && status == TET_OK; s++)
    for (size_t k = 0; k < 3 && is_border(p, s); k++) item[n++] = (tet_keyed){m->subfaces[3 * (size_t)s + k], s};
  if (status == TET_OK) tet_sort_keyed(item, n);
  for (size_t i = 0; i < n && status == TET_OK;) {
    ring r = {item + i, 1, (uint32_t)item[i].key};
    while (i + r.n < n && item[i + r.n].key == r.v) r.n++;
    for (size_t k = 0; k < r.n && status == TET_OK; k++) {
      uint32_t s = (uint32_t)r.item[k].value;
      const uint32_t *v = m->subfaces + 3 * (size_t)s;
      if (!(seen[s] >> (v[0] == r.v ? 0 : v[1] == r.v ? 1 : 2) & 1)) status = add_ring(p, &r, s, seen);
      if (k % POLL_EVERY == 0 && status == TET_OK) status = tet_poll(p->ctx);
    }
    i += r.n;
  }
  tet_free(p->ctx, item);
  tet_free(p->ctx, seen);
  return status;
}
