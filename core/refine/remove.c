// SPDX-License-Identifier: Apache-2.0
/* remove.c: takes a Steiner point out of the mesh where that does no harm. Its star is filled with Delaunay
 * tetrahedra of its link, fan by fan of tetrahedra between subfaces (as core/mesh/removal.c); subfaces at it are
 * replaced by faces of these, and the two subsegments at it by one.
 *
 * All is found out before anything is changed: whether each part can be filled, the two sides of each facet agree,
 * everything is locally Delaunay and nothing encroached, and what is over a bound before and after. Points of loose
 * segments stay. */
#include "mesh/hole.h"
#include "refine/refiner.h"

#include <string.h>

enum { MOST_TETS = 96, MOST_SUBS = 48, MOST_FANS = 8, MOST_LINK = 64 };

/* Subfaces at the point, joined by edges that are no subsegments: a polygon, the point in it or on its side. */
typedef struct fan {
  uint32_t n_sides, side[MOST_SUBS];  /* edge handles opposite the point */
  uint32_t n_corners, corner[MOST_SUBS + 1];
  uint32_t n_new, made[MOST_SUBS][3]; /* the subfaces to be, turned as those of the patch */
  uint64_t inner[MOST_SUBS][2];       /* handles of rows at them */
  uint32_t sub[MOST_SUBS];            /* once they are */
  uint32_t patch;
  int n_seen;                         /* sides that have been filled */
} fan;

typedef struct removal {
  uint32_t p;
  uint32_t n_tets, tet[MOST_TETS], part[MOST_TETS]; /* the star; parted by subfaces */
  uint32_t n_parts;
  uint32_t n_subs, sub[MOST_SUBS], fan_of[MOST_SUBS];
  uint32_t n_fans;
  fan fan[MOST_FANS];
  uint32_t seg[2], end[2]; /* of a point on a segment: the subsegments end[0] p and p end[1] */
  uint32_t row_part[2 * MOST_TETS];
  int has_segs;            /* some edge of the star is a subsegment */
  refine_faults before, after;
} removal;

/* Lists the star of p from tet on; 0: too large. */
static int collect_star(refiner *r, removal *g, uint32_t tet) {
  tet_complex *m = &r->mesh;
  int ok = 1;
  g->n_tets = g->n_parts = g->n_subs = g->n_fans = 0;
  g->has_segs = 0;
  g->tet[g->n_tets++] = tet;
  m->flag[tet] |= TET_FLAG_MARK;
  for (uint32_t k = 0; k < g->n_tets && ok; k++)
    for (uint32_t h = 4 * g->tet[k]; h < 4 * g->tet[k] + 4 && ok; h++) {
      uint32_t u = m->adj[h];
      if (m->v[h] == g->p || u == TET_NONE || m->flag[u >> 2] & TET_FLAG_MARK) continue;
      ok = g->n_tets < MOST_TETS;
      if (!ok) break;
      m->flag[u >> 2] |= TET_FLAG_MARK;
      g->tet[g->n_tets++] = u >> 2;
    }
  for (uint32_t k = 0; k < g->n_tets; k++) {
    m->flag[g->tet[k]] &= (uint8_t)~TET_FLAG_MARK;
    g->part[k] = TET_NONE;
    if (r->tet_edges[g->tet[k]] & EDGE_LOOSE) ok = 0;
    g->has_segs |= r->tet_edges[g->tet[k]] & EDGES;
  }
  return ok;
}

static uint32_t place_of(const uint32_t *list, uint32_t n, uint32_t value) {
  uint32_t k = 0;
  while (k < n && list[k] != value) k++;
  return k;
}

/* Numbers the parts of the star that subfaces at p part. */
static void part_star(const refiner *r, removal *g) {
  for (uint32_t from = 0; from < g->n_tets; from++) {
    if (g->part[from] != TET_NONE) continue;
    uint32_t stack[MOST_TETS], n = 0;
    g->part[from] = g->n_parts;
    stack[n++] = from;
    while (n) {
      uint32_t t = g->tet[stack[--n]];
      for (uint32_t h = 4 * t; h < 4 * t + 4; h++) {
        if (r->mesh.v[h] == g->p || refine_sub_at(r, h) != TET_NONE || r->mesh.adj[h] == TET_NONE) continue;
        uint32_t k = place_of(g->tet, g->n_tets, r->mesh.adj[h] >> 2);
        if (k == g->n_tets || g->part[k] != TET_NONE) continue;
        g->part[k] = g->n_parts;
        stack[n++] = k;
      }
    }
    g->n_parts++;
  }
}

/* Lists the subfaces at p, once each; 0: too many. */
static int collect_subs(const refiner *r, removal *g) {
  for (uint32_t k = 0; k < g->n_tets; k++)
    for (uint32_t h = 4 * g->tet[k]; h < 4 * g->tet[k] + 4; h++) {
      uint32_t s = r->mesh.v[h] == g->p ? TET_NONE : refine_sub_at(r, h);
      if (s == TET_NONE || place_of(g->sub, g->n_subs, s) < g->n_subs) continue;
      if (g->n_subs == MOST_SUBS) return 0;
      g->fan_of[g->n_subs] = TET_NONE;
      g->sub[g->n_subs++] = s;
    }
  return 1;
}

/* Adds the corners of a fan's sides, and that of a point on a segment the side that closes it. */
static int close_fan(const refiner *r, removal *g, fan *f) {
  for (uint32_t k = 0; k < f->n_sides; k++) {
    uint32_t s = f->side[k] / 3, a = r->sub_v[f->side[k]], b = r->sub_v[3 * s + (f->side[k] + 1) % 3];
    const uint32_t ends[2] = {a, b};
    for (int i = 0; i < 2; i++) {
      if (place_of(f->corner, f->n_corners, ends[i]) < f->n_corners) continue;
      if (f->n_corners > MOST_SUBS) return 0;
      f->corner[f->n_corners++] = ends[i];
    }
  }
  /* an open chain has a corner more than sides, and its ends are those of the subsegments */
  if (g->seg[0] == TET_NONE) return f->n_corners == f->n_sides;
  return f->n_corners == f->n_sides + 1 && place_of(f->corner, f->n_corners, g->end[0]) < f->n_corners &&
         place_of(f->corner, f->n_corners, g->end[1]) < f->n_corners;
}

/* Parts the subfaces into fans. 0: it cannot be done. */
static int collect_fans(const refiner *r, removal *g) {
  for (uint32_t from = 0; from < g->n_subs; from++) {
    if (g->fan_of[from] != TET_NONE) continue;
    if (g->n_fans == MOST_FANS) return 0;
    fan *f = &g->fan[g->n_fans];
    f->n_sides = f->n_corners = f->n_new = 0;
    f->n_seen = 0;
    f->patch = r->sub_patch[g->sub[from]];
    uint32_t stack[MOST_SUBS], n = 0;
    g->fan_of[from] = g->n_fans;
    stack[n++] = from;
    while (n) {
      uint32_t s = g->sub[stack[--n]];
      for (uint32_t h = 3 * s; h < 3 * s + 3; h++) {
        uint32_t a = r->sub_v[h], b = r->sub_v[3 * s + (h + 1) % 3];
        if (a != g->p && b != g->p) {
          f->side[f->n_sides++] = h;
        } else if (r->sub_seg[h] == TET_NONE) {
          uint32_t k = place_of(g->sub, g->n_subs, r->ring[h] / 3);
          if (k == g->n_subs) return 0;
          if (g->fan_of[k] != TET_NONE) continue;
          g->fan_of[k] = g->n_fans;
          stack[n++] = k;
        }
      }
    }
    if (!close_fan(r, g, f)) return 0;
    g->n_fans++;
  }
  return g->seg[0] == TET_NONE ? g->n_fans <= 1 : g->n_fans > 0;
}

/* 1 if all subfaces at subsegment e are listed: where the domain meets itself in a segment alone, the star that
 * faces lead to is not all of it. */
static int has_ring(const refiner *r, const removal *g, uint32_t e) {
  uint32_t first = r->seg_sub[e], h = first;
  do {
    if (place_of(g->sub, g->n_subs, h / 3) == g->n_subs) return 0;
    h = r->ring[h];
  } while (h != first);
  return 1;
}

/* The two subsegments at p, of a point on a segment. */
static int find_segs(const refiner *r, removal *g) {
  uint32_t n = 0;
  g->seg[0] = g->seg[1] = TET_NONE;
  for (uint32_t k = 0; k < g->n_subs; k++)
    for (uint32_t h = 3 * g->sub[k]; h < 3 * g->sub[k] + 3; h++) {
      uint32_t a = r->sub_v[h], b = r->sub_v[3 * g->sub[k] + (h + 1) % 3], e = r->sub_seg[h];
      if (e == TET_NONE || (a != g->p && b != g->p) || place_of(g->seg, n, e) < n) continue;
      if (n == 2 || !has_ring(r, g, e)) return 0;
      g->end[n] = a == g->p ? b : a;
      g->seg[n++] = e;
    }
  if (r->out->origin[g->p] != TET_ORIGIN_SEGMENT) return n == 0;
  return n == 2 && r->seg_of[g->seg[0]] == r->seg_of[g->seg[1]];
}

/* The fan that has all corners of face v, or TET_NONE. */
static uint32_t fan_with(const removal *g, const uint32_t v[3]) {
  for (uint32_t i = 0; i < g->n_fans; i++) {
    const fan *f = &g->fan[i];
    int has = 1;
    for (int j = 0; j < 3 && has; j++) has = place_of(f->corner, f->n_corners, v[j]) < f->n_corners;
    if (has) return i;
  }
  return TET_NONE;
}

/* 1 if d is too flat on f for rounding to say on which side it is. */
static int is_flat_on(const refiner *r, const uint32_t f[3], uint32_t d) {
  const uint32_t v[4] = {f[0], f[2], f[1], d};
  return !refine_is_positive(r, v);
}

/* The vertex of the link behind open face f, or TET_NONE. */
static uint32_t apex_of(const refiner *r, const tet_hole *e, const uint32_t f[3]) {
  uint32_t best = TET_NONE;
  for (size_t k = 0; k < e->n_link; k++) {
    uint32_t d = e->link[k];
    if (d == f[0] || d == f[1] || d == f[2] || tet_orient3d(&r->points, f[0], f[1], f[2], d) >= 0) continue;
    if (best != TET_NONE && tet_insphere_sos(&r->points, f[0], f[2], f[1], best, d) <= 0) continue;
    if (!is_flat_on(r, f, d)) best = d;
  }
  return best;
}

/* Opens the hole of a part: outer faces by the handles of the star's own, and the vertices around it. */
static tet_status open_part(refiner *r, const removal *g, tet_hole *e, uint32_t part) {
  tet_complex *m = &r->mesh;
  uint32_t now = ++r->stamp_now;
  tet_status status = tet_grow(r->ctx, &e->link, &e->cap_link, 4 * (size_t)g->n_tets, sizeof *e->link);
  e->n_face = e->n_link = 0;
  for (uint32_t k = 0; k < g->n_tets && !status; k++) {
    if (g->part[k] != part) continue;
    uint32_t h = 4 * g->tet[k] + refine_corner(r, g->tet[k], g->p);
    const uint32_t *v = m->v + 4 * (size_t)g->tet[k];
    const uint8_t *f = tet_face[h & 3];
    const uint32_t face[3] = {v[f[0]], v[f[1]], v[f[2]]};
    status = tet_hole_open(m, e, face, h);
    for (int j = 0; j < 3; j++) {
      if (r->stamp[face[j]] == now) continue;
      r->stamp[face[j]] = now;
      e->link[e->n_link++] = face[j];
    }
  }
  return status;
}

/* Notes an open face that is left as a side of a subface to be; 0: it is none, or not that of the other side. */
static int note_face(const refiner *r, removal *g, const tet_open_face *o) {
  uint32_t i = fan_with(g, o->v);
  if (i == TET_NONE || !(o->beyond & TET_HOLE_ROW)) return 0;
  fan *f = &g->fan[i];
  for (uint32_t k = 0; k < f->n_new; k++) {
    int same = 0;
    for (int j = 0; j < 3; j++) same += place_of(f->made[k], 3, o->v[j]) < 3;
    if (same < 3) continue;
    if (f->inner[k][1]) return 0;
    f->inner[k][1] = o->beyond;
    return 1;
  }
  int sign = tet_orient2d(&r->points, r->patch[f->patch].axis, o->v[0], o->v[1], o->v[2]);
  if (!sign || f->n_new == MOST_SUBS) return 0;
  uint32_t *v = f->made[f->n_new];
  v[0] = o->v[0];
  v[1] = o->v[sign > 0 ? 1 : 2];
  v[2] = o->v[sign > 0 ? 2 : 1];
  f->inner[f->n_new][0] = o->beyond;
  f->inner[f->n_new++][1] = 0;
  return 1;
}

/* 1 unless more is over a bound after than before, or far more over it. */
static int may_do(const refine_faults *after, const refine_faults *before) {
  return after->over <= before->over && after->over + after->slivers <= before->over + before->slivers &&
         after->worst2 <= 4 * before->worst2;
}

/* 1 if that is worth it: there is less over a bound, or as much, none of it farther, and fewer tetrahedra. */
static int is_worth(const refine_faults *after, const refine_faults *before, int is_fewer) {
  if (after->over == before->over && after->worst2 > before->worst2) return 0;
  return after->over + after->slivers < before->over + before->slivers || is_fewer;
}

/* Fills one part; *ret_ok = 0: it cannot be. */
static tet_status fill_part(refiner *r, removal *g, tet_hole *e, uint32_t part, int *ret_ok) {
  size_t from = e->n_row;
  uint32_t region = r->tet_region[g->tet[place_of(g->part, g->n_tets, part)]];
  tet_status status = open_part(r, g, e, part);
  *ret_ok = 0;
  if (e->n_link > MOST_LINK) return status;
  for (size_t k = e->n_face; k > 0 && !status;) {
    if (fan_with(g, e->face[k - 1].v) != TET_NONE && e->face[k - 1].beyond & TET_HOLE_ROW) {
      k--;
      continue;
    }
    uint32_t d = apex_of(r, e, e->face[k - 1].v);
    if (d == TET_NONE || e->n_row - from >= MOST_TETS || e->n_row >= 2 * MOST_TETS) return TET_OK;
    g->row_part[e->n_row] = part;
    status = tet_hole_tetrahedron(&r->mesh, e, k - 1, d);
    if (!status) refine_count_faults(r, e->row[e->n_row - 1].v, region, &g->after);
    if (!may_do(&g->after, &g->before)) return status;
    k = e->n_face;
  }
  *ret_ok = !status;
  for (size_t k = 0; k < e->n_face && *ret_ok; k++) *ret_ok = note_face(r, g, &e->face[k]);
  return status;
}

/* How many times edge ab, in that sense, is a side of the fan, the side of the new subsegment included. */
static int count_side(const refiner *r, const removal *g, const fan *f, uint32_t a, uint32_t b) {
  int n = 0, starts = 0, ends = 0;
  for (uint32_t k = 0; k < f->n_sides; k++) {
    uint32_t x = r->sub_v[f->side[k]], y = r->sub_v[f->side[k] - f->side[k] % 3 + (f->side[k] + 1) % 3];
    n += x == a && y == b;
    starts += x == a;
    ends += y == b;
  }
  if (g->seg[0] == TET_NONE) return n;
  return n + ((a == g->end[0] || a == g->end[1]) && (b == g->end[0] || b == g->end[1]) && a != b && !starts && !ends);
}

/* 1 if the new subfaces of the fan tile its polygon, and have all sides that the old ones have. */
static int tiles(const refiner *r, const removal *g, const fan *f) {
  if (f->n_new + 2 != f->n_corners) return 0;
  int two_sided = r->sub_side[2 * (size_t)(f->side[0] / 3) + 1] != TET_NONE;
  for (uint32_t k = 0; k < f->n_new; k++) {
    if ((f->inner[k][1] != 0) != two_sided) return 0;
    for (int j = 0; j < 3; j++) {
      uint32_t a = f->made[k][j], b = f->made[k][(j + 1) % 3];
      int same = 0, back = 0;
      for (uint32_t i = 0; i < 3 * f->n_new; i++) {
        uint32_t x = f->made[i / 3][i % 3], y = f->made[i / 3][(i % 3 + 1) % 3];
        same += x == a && y == b;
        back += x == b && y == a;
      }
      if (same != 1 || back + count_side(r, g, f, a, b) != 1) return 0;
    }
  }
  return 1;
}

/* The other corner of the row or tetrahedron beyond face i of row k, or TET_NONE at a subface to be. */
static uint32_t beyond_of(const refiner *r, const tet_hole *e, size_t k, uint32_t i) {
  uint64_t h = e->row[k].beyond[i];
  if (h == UINT64_MAX) return TET_NONE;
  if (h & TET_HOLE_ROW) return e->row[(h & ~TET_HOLE_ROW) >> 2].v[h & 3];
  uint32_t outer = r->mesh.adj[h];
  return outer == TET_NONE ? TET_NONE : r->mesh.v[outer];
}

/* 1 if the rows are Delaunay up to subfaces and none of these, nor a subsegment, is encroached. */
static int is_clean(const refiner *r, const removal *g, const tet_hole *e) {
  const tet_points *p = &r->points;
  for (uint32_t i = 0; i < g->n_fans; i++)
    for (uint32_t k = 0; k < 2 * g->fan[i].n_new; k++) {
      uint64_t h = g->fan[i].inner[k / 2][k & 1];
      const uint32_t *v = g->fan[i].made[k / 2];
      if (!h) continue;
      e->row[(h & ~TET_HOLE_ROW) >> 2].beyond[h & 3] = UINT64_MAX;
      if (tet_in_diametric_ball3(p, v[0], v[1], v[2], e->row[(h & ~TET_HOLE_ROW) >> 2].v[h & 3]) > 0) return 0;
    }
  for (size_t k = 0; k < e->n_row; k++) {
    const uint32_t *v = e->row[k].v;
    for (uint32_t i = 0; i < 4; i++) {
      uint64_t h = e->row[k].beyond[i];
      uint32_t s = h & TET_HOLE_ROW ? TET_NONE : refine_sub_at(r, (size_t)h);
      if (s != TET_NONE && refine_sub_hit_by(r, s, v[i])) return 0;
      uint32_t d = s == TET_NONE ? beyond_of(r, e, k, i) : TET_NONE;
      if (d != TET_NONE && tet_insphere_sos(p, v[0], v[1], v[2], v[3], d) > 0) return 0;
    }
    for (int i = 0; i < 6 && g->has_segs; i++) {
      uint32_t a = v[refine_edge[i][0]], b = v[refine_edge[i][1]];
      int is_new = g->seg[0] != TET_NONE && ((a == g->end[0] && b == g->end[1]) || (a == g->end[1] && b == g->end[0]));
      if (!is_new && refine_find_seg(r, a, b) == TET_NONE) continue;
      if (tet_dot_sign(p, a, b, v[refine_edge[5 - i][0]]) < 0 || tet_dot_sign(p, a, b, v[refine_edge[5 - i][1]]) < 0)
        return 0;
    }
  }
  return 1;
}

/* Fills all parts. *ret_ok = 0: p stays, and nothing is changed. */
static tet_status plan(refiner *r, removal *g, uint32_t tet, tet_hole *e, int *ret_ok) {
  tet_status status = TET_OK;
  *ret_ok = 0;
  if (!collect_star(r, g, tet) || !collect_subs(r, g) || !find_segs(r, g) || !collect_fans(r, g)) return TET_OK;
  if (r->out->origin[g->p] == TET_ORIGIN_VOLUME ? g->n_subs : !g->n_subs) return TET_OK;
  part_star(r, g);
  e->n_row = 0;
  g->before = g->after = (refine_faults){0, 0, 0};
  for (uint32_t k = 0; k < g->n_tets; k++)
    refine_count_faults(r, r->mesh.v + 4 * (size_t)g->tet[k], r->tet_region[g->tet[k]], &g->before);
  *ret_ok = 1;
  for (uint32_t part = 0; part < g->n_parts && *ret_ok && !status; part++) status = fill_part(r, g, e, part, ret_ok);
  for (uint32_t i = 0; i < g->n_fans && *ret_ok; i++) *ret_ok = tiles(r, g, &g->fan[i]);
  return status;
}

/* The last subsegment takes the place of e. */
static tet_status drop_seg(refiner *r, uint32_t e) {
  uint32_t last = --r->n_segs;
  r->seg_v[2 * (size_t)e] = r->seg_v[2 * (size_t)last];
  r->seg_v[2 * (size_t)e + 1] = r->seg_v[2 * (size_t)last + 1];
  r->seg_v[2 * (size_t)last] = r->seg_v[2 * (size_t)last + 1] = TET_NONE; /* found no more */
  if (e == last) return TET_OK;
  r->seg_of[e] = r->seg_of[last];
  r->seg_tet[e] = r->seg_tet[last];
  r->seg_waiting[e] = r->seg_waiting[last];
  uint32_t first = r->seg_sub[e] = r->seg_sub[last], h = first;
  if (first != TET_NONE) do {
    r->sub_seg[h] = e;
    h = r->ring[h];
  } while (h != first);
  return refine_enter_seg(r, e);
}

/* Subsegments end[0] p and p end[1] become the first, seg[0]. */
static tet_status join_segs(refiner *r, removal *g) {
  uint32_t keep = g->seg[0] < g->seg[1] ? 0 : 1, e = g->seg[keep], *v = r->seg_v + 2 * (size_t)e;
  v[v[0] == g->p ? 0 : 1] = g->end[1 - keep];
  r->seg_sub[e] = TET_NONE;
  tet_status status = refine_enter_seg(r, e);
  if (!status) status = drop_seg(r, g->seg[1 - keep]);
  g->seg[0] = e;
  return status;
}

/* The new subfaces of fan f: their edges join the rings of those that stay, or each other. */
static tet_status span_fan(refiner *r, const removal *g, fan *f) {
  tet_status status = TET_OK;
  for (uint32_t k = 0; k < f->n_new && !status; k++) {
    status = refine_new_sub(r, &f->sub[k]);
    if (status) return status;
    memcpy(r->sub_v + 3 * (size_t)f->sub[k], f->made[k], sizeof f->made[k]);
    r->sub_patch[f->sub[k]] = f->patch;
  }
  for (uint32_t k = 0; k < 3 * f->n_new; k++) {
    uint32_t a = f->made[k / 3][k % 3], b = f->made[k / 3][(k % 3 + 1) % 3], h = 3 * f->sub[k / 3] + k % 3, i = 0;
    while (i < f->n_sides && (r->sub_v[f->side[i]] != a ||
                              r->sub_v[f->side[i] - f->side[i] % 3 + (f->side[i] + 1) % 3] != b)) i++;
    if (i < f->n_sides) {
      refine_replace_edge(r, f->side[i], h);
      continue;
    }
    uint32_t j = 0;
    while (j < 3 * f->n_new && (f->made[j / 3][j % 3] != b || f->made[j / 3][(j % 3 + 1) % 3] != a)) j++;
    if (j < k) refine_link(r, h, 3 * f->sub[j / 3] + j % 3);
    else if (j == 3 * f->n_new) refine_on_segment_edge(r, h, g->seg[0]);
  }
  return TET_OK;
}

static uint32_t handle_of(const uint32_t *made, uint64_t row) {
  return 4 * made[(row & ~TET_HOLE_ROW) >> 2] + (uint32_t)(row & 3);
}

/* Gives row k, tetrahedron made[k], its neighbours, and what the faces beyond have. */
static void join_row(refiner *r, const tet_hole *e, size_t k, const uint32_t *made) {
  tet_complex *m = &r->mesh;
  for (uint32_t i = 0; i < 4; i++) {
    uint64_t beyond = e->row[k].beyond[i];
    uint32_t h = 4 * made[k] + i;
    if (beyond == UINT64_MAX) continue;
    if (beyond & TET_HOLE_ROW) {
      m->adj[h] = handle_of(made, beyond);
      continue;
    }
    uint32_t inner = (uint32_t)beyond, outer = m->adj[inner], s = refine_sub_at(r, inner);
    m->adj[h] = outer;
    if (outer != TET_NONE) m->adj[outer] = h;
    if (s != TET_NONE) refine_take_sub(r, s, inner, h);
  }
}

/* Tetrahedron t is new: what could not be removed may be now, of its corners and what is next to it. */
void refine_note_change(refiner *r, uint32_t t) {
  for (size_t h = 4 * (size_t)t; h < 4 * (size_t)t + 4 && r->stays; h++) {
    uint32_t beyond = r->mesh.adj[h], v[2] = {r->mesh.v[h], beyond == TET_NONE ? TET_NONE : r->mesh.v[beyond]};
    for (int i = 0; i < 2; i++)
      if (v[i] < r->n_stays) r->stays[v[i]] = 0;
  }
}

/* The rows take the place of the star. */
static tet_status replace(refiner *r, removal *g, const tet_hole *e) {
  uint32_t made[2 * MOST_TETS];
  tet_status status = g->seg[0] == TET_NONE ? TET_OK : join_segs(r, g);
  for (uint32_t i = 0; i < g->n_fans && !status; i++) status = span_fan(r, g, &g->fan[i]);
  for (size_t k = 0; k < e->n_row && !status; k++) {
    status = refine_new_tet(r, &made[k]);
    if (status) return status;
    memcpy(r->mesh.v + 4 * (size_t)made[k], e->row[k].v, sizeof e->row[k].v);
    r->mesh.flag[made[k]] = 0;
    r->tet_region[made[k]] = r->tet_region[g->tet[place_of(g->part, g->n_tets, g->row_part[k])]];
    for (int i = 0; i < 6 && g->has_segs; i++)
      if (refine_find_seg(r, e->row[k].v[refine_edge[i][0]], e->row[k].v[refine_edge[i][1]]) != TET_NONE)
        r->tet_edges[made[k]] |= (uint8_t)(1 << i);
  }
  if (status) return status;
  for (size_t k = 0; k < e->n_row; k++) join_row(r, e, k, made);
  for (uint32_t i = 0; i < g->n_fans; i++)
    for (uint32_t k = 0; k < g->fan[i].n_new; k++) {
      const uint64_t *inner = g->fan[i].inner[k];
      uint32_t h = handle_of(made, inner[0]);
      refine_hang(r, g->fan[i].sub[k], h);
      if (!inner[1]) continue;
      uint32_t other = handle_of(made, inner[1]);
      refine_hang(r, g->fan[i].sub[k], other);
      tet_link(&r->mesh, h, other);
    }
  for (uint32_t k = 0; k < g->n_tets; k++) tet_complex_delete(&r->mesh, g->tet[k]);
  for (uint32_t k = 0; k < g->n_subs; k++) refine_free_sub(r, g->sub[k]);
  for (size_t k = 0; k < e->n_row && !status; k++) {
    status = refine_look_at(r, made[k]);
    refine_note_change(r, made[k]);
    for (int j = 0; j < 4 && r->some_tet; j++) r->some_tet[e->row[k].v[j]] = made[k];
  }
  return status;
}

/* Removes Steiner point p, of tetrahedron tet, if fewer tetrahedra are over a bound then, or as many, and fewer in
 * all. *ret_done = 0, nothing changed: it stays, and is not tried again where `stays` says so. */
tet_status refine_remove(refiner *r, uint32_t p, uint32_t tet, int *ret_done) {
  removal g;
  tet_hole *e;
  int ok = 0;
  *ret_done = 0;
  if (p < r->n_stays && r->stays[p]) return TET_OK;
  if (p < r->n_stays) r->stays[p] = 1;
  g.p = p;
  tet_status status = tet_hole_of(&r->mesh, &e);
  if (!status) status = plan(r, &g, tet, e, &ok);
  if (status || !ok) return status;
  if (!is_worth(&g.after, &g.before, e->n_row < g.n_tets) || !is_clean(r, &g, e)) return TET_OK;
  *ret_done = 1;
  uint8_t origin = r->out->origin[p];
  uint64_t *n = origin == TET_ORIGIN_VOLUME ? &r->result.volume_points :
                origin == TET_ORIGIN_FACET ? &r->result.facet_points : &r->result.segment_points;
  --*n;
  r->result.removed_points++;
  return replace(r, &g, e);
}

/* Marks the vertices of what is over a bound. 0: there are none. */
static int mark_faults(const refiner *r, uint8_t *marked) {
  int some = 0, unwatched = refine_has_unwatched(r);
  for (uint32_t t = 0; t < r->mesh.n_slots; t++) {
    if (!refine_may_be_bad(r, t, unwatched)) continue;
    refine_faults own = {0, 0, 0};
    refine_count_faults(r, r->mesh.v + 4 * (size_t)t, r->tet_region[t], &own);
    if (!own.over && !own.slivers) continue;
    for (int i = 0; i < 4; i++) marked[r->mesh.v[4 * (size_t)t + i]] = 1;
    some = 1;
  }
  return some;
}

/* Removes what can be of the vertices of something over a bound, the youngest first: elsewhere few go, at a high cost. */
tet_status refine_remove_points(refiner *r) {
  tet_status status = TET_OK;
  uint8_t *marked = tet_calloc(r->ctx, r->points.n, 1);
  r->some_tet = tet_alloc(r->ctx, r->points.n, sizeof *r->some_tet);
  if (!r->some_tet || !marked) status = TET_E_MEMORY;
  if (!status && mark_faults(r, marked)) {
    for (uint32_t t = 0; t < r->mesh.n_slots; t++)
      for (int i = 0; i < 4 && refine_alive(r, t); i++) r->some_tet[r->mesh.v[4 * (size_t)t + i]] = t;
    for (uint32_t p = r->points.n; p-- > r->n_first && !status;) {
      int done;
      if (marked[p]) status = refine_remove(r, p, r->some_tet[p], &done);
      if (!status) status = tet_poll(r->ctx);
    }
  }
  tet_free(r->ctx, marked);
  tet_free(r->ctx, r->some_tet);
  r->some_tet = NULL;
  return status;
}
