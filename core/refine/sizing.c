// SPDX-License-Identifier: Apache-2.0
/* sizing.c: the sizing function H_1 of (4.5) and the point accepting rule (4.1.4).
 *
 * lfs at the vertices of the CDT, by a tree of boxes over subfaces, whose subsegments come with
 * them, and loose subsegments, polytopes through the vertex excluded; Shepard's interpolation of
 * the neighbours at new ones; never an exact lfs there. */
#include "base/hilbert.h"
#include "base/sort.h"
#include "base/triangle.h"
#include "base/vector.h"
#include "refine/refiner.h"

#include <math.h>
#include <string.h>

/* Boxes in an implicit binary tree over elements in Hilbert order: node k has
 * children 2k+1 and 2k+2; leaf i holds element i, whose distance costs many of a box's. */
typedef struct box_tree {
  tet_keyed *element; /* value: subface, or n_subs + subsegment */
  double (*box)[6];
  size_t n, first_leaf;
} box_tree;

/* 0: a subsegment of some facet. */
static int is_element(const refiner *r, uint32_t id) {
  return id < r->n_subs ? r->sub_v[3 * (size_t)id] != TET_NONE : r->seg_sub[id - r->n_subs] == TET_NONE;
}

static void element_corners(const refiner *r, uint64_t id, uint32_t v[3]) {
  if (id < r->n_subs) {
    memcpy(v, r->sub_v + 3 * id, 3 * sizeof *v);
  } else {
    const uint32_t *s = r->seg_v + 2 * (id - r->n_subs);
    v[0] = s[0];
    v[1] = v[2] = s[1];
  }
}

static void widen(double box[6], const double *low, const double *high) {
  for (int i = 0; i < 3; i++) {
    if (low[i] < box[i]) box[i] = low[i];
    if (high[i] > box[3 + i]) box[3 + i] = high[i];
  }
}

/* The elements with their places on the Hilbert curve, found for many at once. */
static void list_elements(const refiner *r, box_tree *tree) {
  enum { MANY = 64 };
  double centre[3 * MANY];
  uint64_t key[MANY];
  uint32_t all = r->n_subs + r->n_segs, n = 0, done = 0;
  tet_hilbert_box bound = tet_hilbert_bound(r->points.x, NULL, r->n_first);
  for (uint32_t i = 0; i < all; i++) {
    if (is_element(r, i)) {
      uint32_t v[3];
      element_corners(r, i, v);
      double *c = centre + 3 * (size_t)(n - done);
      for (int k = 0; k < 3; k++) c[k] = (refine_x(r, v[0])[k] + refine_x(r, v[1])[k] + refine_x(r, v[2])[k]) / 3;
      tree->element[n++].value = i;
    }
    if (n - done < MANY && (i + 1 < all || n == done)) continue;
    tet_hilbert_keys(&bound, centre, NULL, n - done, key);
    for (uint32_t k = 0; done < n; k++) tree->element[done++].key = key[k];
  }
}

static tet_status build_tree(refiner *r, box_tree *tree) {
  uint32_t all = r->n_subs + r->n_segs;
  size_t n = 0, leaves = 1;
  for (uint32_t i = 0; i < all; i++) n += (size_t)is_element(r, i);
  while (leaves < n) leaves *= 2;
  tree->n = n;
  tree->first_leaf = leaves - 1;
  tree->element = tet_alloc(r->ctx, n, sizeof *tree->element);
  tree->box = tet_alloc(r->ctx, 2 * leaves, sizeof *tree->box);
  if (!tree->element || !tree->box) return TET_E_MEMORY;
  list_elements(r, tree);
  tet_sort_keyed(tree->element, n);
  for (size_t k = 0; k < 2 * leaves; k++)
    for (int i = 0; i < 3; i++) tree->box[k][i] = INFINITY, tree->box[k][3 + i] = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    uint32_t v[3];
    element_corners(r, tree->element[i].value, v);
    for (int j = 0; j < 3; j++)
      widen(tree->box[tree->first_leaf + i], refine_x(r, v[j]), refine_x(r, v[j]));
  }
  for (size_t k = tree->first_leaf; k-- > 0;)
    for (size_t c = 2 * k + 1; c <= 2 * k + 2; c++) widen(tree->box[k], tree->box[c], tree->box[c] + 3);
  return TET_OK;
}

static inline double box_distance2(const double box[6], const double *x) {
  double sum = 0;
  for (int i = 0; i < 3; i++) {
    double d = x[i] < box[i] ? box[i] - x[i] : x[i] > box[3 + i] ? x[i] - box[3 + i] : 0;
    sum += d * d;
  }
  return sum;
}

/* The least of `least` and the squared distances of vertex v from what does not meet it: the subface's
 * facet, or if that does the subsegments at it; or the loose subsegment. */
static double element_distance2(const refiner *r, uint64_t id, uint32_t v, double least) {
  const double *x = refine_x(r, v);
  uint32_t w[3];
  element_corners(r, id, w);
  if (id >= r->n_subs) {
    double d = tet_edge_distance2(refine_x(r, w[0]), refine_x(r, w[1]), x);
    return d < least && !refine_on_segment(r, v, r->seg_of[id - r->n_subs]) ? d : least;
  }
  if (v != w[0] && v != w[1] && v != w[2]) {
    double d = tet_triangle_distance2(refine_x(r, w[0]), refine_x(r, w[1]), refine_x(r, w[2]), x);
    if (!(d < least)) return least;
    if (!refine_on_facet(r, v, r->patch[r->sub_patch[id]].facet)) return d;
  }
  for (int j = 0; j < 3; j++) {
    uint32_t e = r->sub_seg[3 * id + (unsigned)j];
    if (e == TET_NONE || v == w[j] || v == w[(j + 1) % 3] || refine_on_segment(r, v, r->seg_of[e])) continue;
    double d = tet_edge_distance2(refine_x(r, w[j]), refine_x(r, w[(j + 1) % 3]), x);
    if (d < least) least = d;
  }
  return least;
}

/* The least squared distance, below `least`, of vertex v from an element that
 * does not meet it. */
static double nearest2(const refiner *r, const box_tree *tree, uint32_t v, double least) {
  struct {
    size_t node;
    double distance2;
  } stack[96];
  uint32_t n = 1;
  const double *x = refine_x(r, v);
  stack[0].node = 0;
  stack[0].distance2 = 0;
  while (n) {
    size_t k = stack[--n].node;
    if (!(stack[n].distance2 < least)) continue;
    if (k < tree->first_leaf) {
      double left = box_distance2(tree->box[2 * k + 1], x), right = box_distance2(tree->box[2 * k + 2], x);
      for (int turn = 0; turn < 2; turn++) { /* the nearer one comes off first */
        int is_right = (left < right) ^ turn;
        stack[n].node = 2 * k + 1 + (size_t)is_right;
        stack[n].distance2 = is_right ? right : left;
        n += stack[n].distance2 < least;
      }
      continue;
    }
    size_t i = k - tree->first_leaf;
    if (i < tree->n) least = element_distance2(r, tree->element[i].value, v, least);
  }
  return least;
}

/* Squared length of the shortest edge at each vertex: the nearest visible vertex. */
static void shortest_edges2(refiner *r) {
  for (uint32_t v = 0; v < r->n_first; v++) r->size[v] = INFINITY;
  for (uint32_t t = 0; t < r->mesh.n_slots; t++)
    for (int e = 0; e < 6; e++) {
      uint32_t a = r->mesh.v[4 * (size_t)t + refine_edge[e][0]], b = r->mesh.v[4 * (size_t)t + refine_edge[e][1]];
      const double *x = refine_x(r, a), *y = refine_x(r, b);
      double d = tet_distance2(x, y);
      if (d < r->size[a]) r->size[a] = d;
      if (d < r->size[b]) r->size[b] = d;
    }
}

/* Sets H_1 at the vertices of the CDT: lfs. */
tet_status refine_lfs(refiner *r) {
  box_tree tree = {0};
  tet_status status = build_tree(r, &tree);
  shortest_edges2(r);
  for (uint32_t v = 0; v < r->n_first && !status; v++) {
    if (r->size[v] < INFINITY) r->size[v] = sqrt(nearest2(r, &tree, v, r->size[v]));
    else r->size[v] = 0;
    if ((v & 63) == 0) status = tet_poll(r->ctx);
  }
  for (uint32_t e = 0; e < r->n_segs; e++)
    if (r->segment_sharp[r->seg_of[e]] & SHARP_DIHEDRAL)
      for (int i = 0; i < 2; i++) {
        uint32_t v = r->seg_v[2 * (size_t)e + i];
        r->sharp_size[v] = r->size[v];
      }
  tet_free(r->ctx, tree.element);
  tet_free(r->ctx, tree.box);
  return status;
}

/* H_1 at the new vertex p (4.5), by Shepard's interpolation. */
void refine_shepard(const refiner *r, uint32_t p, const refine_list *neighbours, double *ret_size,
                    double *ret_sharp) {
  double sum = 0, size = 0, sharp = 0;
  const double *x = refine_x(r, p);
  for (uint32_t i = 0; i < neighbours->n; i++) {
    uint32_t v = neighbours->at[i];
    const double *y = refine_x(r, v);
    double d = tet_distance2(x, y);
    sum += 1 / d;
    size += r->size[v] / d;
    sharp += r->sharp_size[v] / d;
  }
  *ret_size = sum > 0 ? size / sum : 0;
  *ret_sharp = sum > 0 ? sharp / sum : 0;
}

/* 1 if the segment is in a thin facet. */
static int segment_is_thin(const refiner *r, uint32_t segment) {
  for (uint32_t i = r->segment_facet_start[segment]; i < r->segment_facet_start[segment + 1]; i++)
    if (r->facet_thin[r->segment_facet[i]]) return 1;
  return 0;
}

/* 1 if Steiner point p is in a thin facet. */
int refine_is_thin(const refiner *r, uint32_t p) {
  uint32_t carrier = r->out->carrier[p];
  return r->out->origin[p] == TET_ORIGIN_FACET ? r->facet_thin[carrier] : segment_is_thin(r, carrier);
}

/* 1 if v is on a segment that is sharp to another or between facets: only there is H_s of (4.3) not 0. */
static int on_sharp(const refiner *r, uint32_t v) {
  if (r->out->origin[v] == TET_ORIGIN_SEGMENT)
    return r->segment_sharp[r->out->carrier[v]] & (SHARP_PLANE | SHARP_DIHEDRAL);
  return v < r->n_first && r->segment_end[v] & END_SHARP;
}

/* The radius of the ball about v in which no segment or facet is split for a circumcentre's sake. Where a segment stands
 * low on a facet, that is the length of its first subsegment, at most H_1: neither then encroaches upon the other but by
 * what existing vertices force. */
static double protects(const refiner *r, uint32_t v, double alpha) {
  if (alpha > 0 && v < r->n_first && r->low[v] > 0) return fmin(r->low[v], r->size[v]);
  return on_sharp(r, v) ? alpha * r->size[v] : 0;
}

/* 0 where nothing is rejected, as nothing need be (3.3.1): without a sharp segment, at a bound with that
 * guarantee, while points lie where they ought to. The floor guards the other cases. */
int refine_needs_sizes(const refiner *r) {
  return !r->exact || r->n_sharp || r->picking || !tet_refine_is_proven(r->o.radius_edge);
}

/* The accepting rule (4.1.4): 1 if p is outside the protecting balls of `vertices`, of alpha times their size where
 * these are on sharp segments, or as `protects` says. What existing vertices force (R1* (2), 3.4.1) is protected from near
 * sharp dihedral angles alone, but more there, for it has no end; elsewhere by the floor. Sheets that all but touch have
 * a budget on top: lfs bounds their points, but by no number that can be waited for. */
int refine_accepts(refiner *r, uint32_t p, const uint32_t *vertices, uint32_t n, double alpha, refine_cause cause) {
  const double *x = refine_x(r, p);
  if (r->forcing) return 1;
  int rejected = !r->thin_points && r->out->origin[p] != TET_ORIGIN_VOLUME && refine_is_thin(r, p);
  if (rejected && !r->tracing) return 0;
  for (uint32_t i = 0; i < n; i++) {
    uint32_t v = vertices[i];
    const double *y = refine_x(r, v);
    double d = tet_distance2(x, y);
    double ball = (r->n_wedges ? r->o.wedge_floor : r->o.floor) * r->size[v];
    double sharp = cause == CAUSE_VERTEX ? alpha * r->o.wedge * r->sharp_size[v] : protects(r, v, alpha);
    if (sharp > ball) ball = sharp;
    if (d > ball * ball) continue;
    rejected = 1;
    if (!r->tracing) return 0;
    refine_note_blame(r, v);
  }
  return !rejected;
}

static int reject(refiner *r, const uint32_t *vertices, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) refine_note_blame(r, vertices[i]);
  return 1;
}

/* 1 if Steiner point p is not on the facet, but on a segment or a facet that meets it. */
static int is_neighbour(const refiner *r, uint32_t p, uint32_t facet) {
  if (refine_on_facet(r, p, facet)) return 0;
  uint32_t carrier = r->out->carrier[p];
  if (r->out->origin[p] == TET_ORIGIN_FACET) return refine_facets_meet(r, carrier, facet);
  return refine_on_facet(r, r->out->segment[carrier].a, facet) || refine_on_facet(r, r->out->segment[carrier].b, facet);
}

/* 1 if p, the grown cavity's point, is closer to another segment than `crowd` times its distance
 * from `vertices`, or to another facet than that or `crowd_facets` times: inserted there, it would have its image in
 * that one split as well, and leave an edge as short as the gap. Only those that meet its
 * own segment or facet count: the gap to others is bounded by lfs. Without a sharp segment
 * that is the bound's price. */
int refine_crowded(refiner *r, const uint32_t *vertices, uint32_t n) {
  const refine_cavity *c = &r->cavity;
  const double *x = refine_x(r, c->p);
  if (r->forcing || !r->n_crowds) return 0;
  double room = INFINITY;
  for (uint32_t i = 0; i < n; i++) {
    const double *y = refine_x(r, vertices[i]);
    room = fmin(room, tet_distance2(x, y));
  }
  int wedged = 0; /* near a sharp dihedral angle */
  for (uint32_t i = 0; i < n; i++) wedged |= r->sharp_size[vertices[i]] > 0.5 * r->size[vertices[i]];
  double share = wedged ? r->o.crowd_facets : r->o.crowd, wide = room * share * share;
  room *= r->o.crowd * r->o.crowd;
  uint32_t own = c->segment == TET_NONE ? TET_NONE : r->seg_of[c->segment];
  for (uint32_t k = 0; k < r->mesh.n_cavity; k++) {
    uint32_t t = r->mesh.cavity[k];
    const uint32_t *v = r->mesh.v + 4 * (size_t)t;
    for (int e = 0; e < 6 && r->tet_edges[t] & EDGES; e++) {
      if (!(r->tet_edges[t] >> e & 1)) continue;
      uint32_t a = v[refine_edge[e][0]], b = v[refine_edge[e][1]];
      if (!(tet_edge_distance2(refine_x(r, a), refine_x(r, b), x) < room)) continue;
      uint32_t other = r->seg_of[refine_find_seg(r, a, b)];
      if (own == TET_NONE || (other != own && refine_segments_meet(r, own, other))) return reject(r, vertices, n);
    }
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t s = refine_sub_at(r, 4 * (size_t)t + i);
      if (s == TET_NONE) continue;
      const uint32_t *w = r->sub_v + 3 * (size_t)s;
      if (tet_triangle_distance2(refine_x(r, w[0]), refine_x(r, w[1]), refine_x(r, w[2]), x) < wide &&
          is_neighbour(r, c->p, r->patch[r->sub_patch[s]].facet))
        return reject(r, vertices, n);
    }
  }
  return 0;
}
