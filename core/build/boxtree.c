// SPDX-License-Identifier: Apache-2.0
/* boxtree.c: a balanced binary tree over boxes, halves of halves of their order along a Hilbert curve
 * through their middles; where the curve's cells are too large to part them, split at the median
 * along the longest side. Stored in order: node k over items [from, to) has its left half next to
 * it. Where far more pairs of boxes meet than there are boxes, as around long thin triangles
 * aslant, each node gets a tilted box as well, and these are asked too. See boxtree.h. */
#include "build/boxtree.h"

#include <math.h>

#include "base/hilbert.h"
#include "base/sort.h"
#include "base/vector.h"
#include "build/tilted.h"

enum { LEAF = 4, MAX_DEPTH = 64, MANY = 32 }; /* MANY: pairs a box before boxes are tilted */

typedef struct node {
  tet_box box;
  uint32_t from, to; /* items [from .. to) */
  uint32_t right;    /* right child; the left one is the next node; 0: a leaf */
} node;

typedef struct node_pair {
  uint32_t a, b;
} node_pair;

typedef struct tree {
  tet_ctx *ctx;
  const tet_box *box;
  uint32_t n;
  tet_box_corners_fn corners;
  tet_box_pair_fn pair;
  void *user;
  uint64_t n_pairs;   /* asked so far */
  tet_tilted *tilted; /* [n_nodes], or NULL */
  double most;        /* largest coordinate */
  tet_keyed *item;    /* [n] in the tree's order: the middle's place on the curve; which box */
  tet_box *sorted;    /* [n] the boxes in that order */
  node *nodes;
  uint32_t n_nodes;
  size_t cap_nodes, cap_stack;
  node_pair *stack;
  uint32_t n_stack;
} tree;

static uint32_t which(const tree *t, size_t i) { return (uint32_t)t->item[i].value; }

/* Halved first: coordinates stay in range. */
static double middle(const tet_box *b, int axis) { return 0.5 * b->lo[axis] + 0.5 * b->hi[axis]; }

static tet_status order_boxes(tree *t) {
  size_t n = t->n;
  double *x = tet_alloc(t->ctx, 3 * n, sizeof *x);
  uint64_t *key = tet_alloc(t->ctx, n, sizeof *key);
  tet_keyed *scratch = tet_alloc(t->ctx, n, sizeof *scratch);
  t->item = tet_alloc(t->ctx, n, sizeof *t->item);
  tet_status st = x && key && scratch && t->item ? tet_poll(t->ctx) : tet_ctx_error(t->ctx)->status;
  if (st == TET_OK) {
    for (size_t i = 0; i < 3 * n; i++) x[i] = middle(&t->box[i / 3], (int)(i % 3));
    tet_hilbert_box cube = tet_hilbert_bound(x, NULL, t->n);
    tet_hilbert_keys(&cube, x, NULL, t->n, key);
    for (size_t i = 0; i < n; i++) t->item[i] = (tet_keyed){key[i], i};
    tet_sort_radix(t->item, scratch, n, 1);
  }
  tet_free(t->ctx, x);
  tet_free(t->ctx, key);
  tet_free(t->ctx, scratch);
  return st == TET_OK ? tet_poll(t->ctx) : st;
}

static int before(const tree *t, const tet_keyed *i, const tet_keyed *j, int axis) {
  double x = middle(&t->box[i->value], axis), y = middle(&t->box[j->value], axis);
  return x < y || (x == y && i->value < j->value);
}

/* Hoare's selection: item[k] is then the k-th of [from, to) along the axis. */
static void select_median(tree *t, uint32_t from, uint32_t to, uint32_t k, int axis) {
  tet_keyed *o = t->item;
  int64_t lo = from, hi = (int64_t)to - 1;
  while (lo < hi) {
    tet_keyed pivot = o[lo + (hi - lo) / 2];
    int64_t i = lo, j = hi;
    while (i <= j) {
      while (before(t, &o[i], &pivot, axis)) i++;
      while (before(t, &pivot, &o[j], axis)) j--;
      if (i > j) break;
      tet_keyed swap = o[i];
      o[i++] = o[j];
      o[j--] = swap;
    }
    if ((int64_t)k <= j) hi = j;
    else if ((int64_t)k >= i) lo = i;
    else return;
  }
}

static int longest_axis(const tree *t, uint32_t from, uint32_t to) {
  double side[3];
  for (int k = 0; k < 3; k++) {
    double lo = middle(&t->box[which(t, from)], k), hi = lo;
    for (uint32_t i = from + 1; i < to; i++) {
      double m = middle(&t->box[which(t, i)], k);
      if (m < lo) lo = m;
      if (m > hi) hi = m;
    }
    side[k] = hi - lo;
  }
  return tet_longest_axis(side);
}

/* The nodes, without their boxes. */
static tet_status split(tree *t, uint32_t n) {
  uint32_t from[MAX_DEPTH], to[MAX_DEPTH], parent[MAX_DEPTH], depth = 0;
  from[0] = 0;
  to[0] = n;
  parent[depth++] = UINT32_MAX;
  while (depth > 0) {
    uint32_t a = from[--depth], b = to[depth], up = parent[depth];
    tet_status st = tet_grow(t->ctx, &t->nodes, &t->cap_nodes, (size_t)t->n_nodes + 1, sizeof *t->nodes);
    if (st == TET_OK && b - a > 1024) st = tet_poll(t->ctx);
    if (st != TET_OK) return st;
    uint32_t me = t->n_nodes++;
    t->nodes[me].from = a;
    t->nodes[me].to = b;
    t->nodes[me].right = 0;
    if (up != UINT32_MAX) t->nodes[up].right = me;
    if (b - a <= LEAF) continue;
    uint32_t mid = a + (b - a) / 2;
    if (t->item[a].key == t->item[b - 1].key) select_median(t, a, b, mid, longest_axis(t, a, b));
    from[depth] = mid; /* the right half waits; the left one comes next */
    to[depth] = b;
    parent[depth++] = me;
    from[depth] = a;
    to[depth] = mid;
    parent[depth++] = UINT32_MAX;
  }
  return TET_OK;
}

static void extend(tet_box *b, const tet_box *c) {
  for (int k = 0; k < 3; k++) {
    b->lo[k] = c->lo[k] < b->lo[k] ? c->lo[k] : b->lo[k];
    b->hi[k] = c->hi[k] > b->hi[k] ? c->hi[k] : b->hi[k];
  }
}

/* The nodes' boxes; children come after their parents. */
static void bound(tree *t) {
  for (uint32_t k = t->n_nodes; k-- > 0;) {
    node *a = &t->nodes[k];
    a->box = a->right ? t->nodes[k + 1].box : t->sorted[a->from];
    if (a->right) extend(&a->box, &t->nodes[a->right].box);
    for (uint32_t i = a->from + 1; i < a->to && !a->right; i++) extend(&a->box, &t->sorted[i]);
  }
}

static tet_status build(tree *t) {
  tet_status st = order_boxes(t);
  if (st == TET_OK) st = split(t, t->n);
  if (st != TET_OK) return st;
  t->sorted = tet_alloc(t->ctx, t->n, sizeof *t->sorted);
  if (!t->sorted) return tet_ctx_error(t->ctx)->status;
  for (size_t i = 0; i < t->n; i++) t->sorted[i] = t->box[which(t, i)];
  bound(t);
  return TET_OK;
}

static tet_status push(tree *t, uint32_t a, uint32_t b) {
  if (a != b && !tet_boxes_meet(&t->nodes[a].box, &t->nodes[b].box)) return TET_OK;
  if (a != b && t->tilted && tet_tilted_apart(&t->tilted[a], &t->tilted[b], t->most)) return TET_OK;
  tet_status st = tet_grow(t->ctx, &t->stack, &t->cap_stack, (size_t)t->n_stack + 1, sizeof *t->stack);
  if (st == TET_OK) t->stack[t->n_stack++] = (node_pair){a, b};
  return st;
}

/* Tilted boxes for all nodes. */
static tet_status tilt(tree *t) {
  const double **x = tet_alloc(t->ctx, 3 * (size_t)t->n, sizeof *x);
  t->tilted = tet_alloc(t->ctx, t->n_nodes, sizeof *t->tilted);
  tet_status st = x && t->tilted ? TET_OK : tet_ctx_error(t->ctx)->status;
  for (uint32_t i = 0; i < t->n && st == TET_OK; i++) {
    t->corners(t->user, which(t, i), x + 3 * (size_t)i);
    for (int k = 0; k < 3; k++)
      t->most = fmax(t->most, fmax(fabs(t->box[i].lo[k]), fabs(t->box[i].hi[k])));
  }
  for (uint32_t k = 0; k < t->n_nodes && st == TET_OK; k++) {
    const node *a = &t->nodes[k];
    tet_tilted_begin(x + 3 * (size_t)a->from, a->to - a->from, &t->tilted[k]);
    for (size_t i = 3 * (size_t)a->from; i < 3 * (size_t)a->to; i++) tet_tilted_add(&t->tilted[k], x[i]);
    if (k % 256 == 0) st = tet_poll(t->ctx);
  }
  tet_free(t->ctx, x);
  return st;
}

static tet_status leaf_pairs(tree *t, const node *a, const node *b) {
  for (uint32_t i = a->from; i < a->to; i++)
    for (uint32_t j = a == b ? i + 1 : b->from; j < b->to; j++) {
      if (!tet_boxes_meet(&t->sorted[i], &t->sorted[j])) continue;
      uint32_t x = which(t, i), y = which(t, j);
      t->n_pairs++;
      tet_status st = t->pair(t->user, x < y ? x : y, x < y ? y : x);
      if (st != TET_OK) return st;
    }
  return TET_OK;
}

static tet_status step(tree *t) {
  node_pair p = t->stack[--t->n_stack];
  const node *a = &t->nodes[p.a], *b = &t->nodes[p.b];
  if (!a->right && !b->right) return leaf_pairs(t, a, b);
  tet_status st;
  if (p.a == p.b) {
    if ((st = push(t, p.a + 1, p.a + 1)) == TET_OK && (st = push(t, a->right, a->right)) == TET_OK)
      st = push(t, p.a + 1, a->right);
    return st;
  }
  if (!b->right || (a->right && a->to - a->from >= b->to - b->from)) {
    if ((st = push(t, p.a + 1, p.b)) == TET_OK) st = push(t, a->right, p.b);
  } else {
    if ((st = push(t, p.a, p.b + 1)) == TET_OK) st = push(t, p.a, b->right);
  }
  return st;
}

tet_status tet_box_pairs(tet_ctx *ctx, const tet_box *box, uint32_t n, tet_box_corners_fn corners,
                         tet_box_pair_fn pair, void *user) {
  tree t = {.ctx = ctx, .box = box, .n = n, .corners = corners, .pair = pair, .user = user};
  if (n < 2) return TET_OK;
  tet_status st = build(&t);
  if (st == TET_OK) st = push(&t, 0, 0);
  for (uint64_t steps = 0; t.n_stack > 0 && st == TET_OK; steps++) {
    if (steps % 1024 == 0) st = tet_poll(ctx);
    if (st == TET_OK && !t.tilted && t.n_pairs > MANY * (uint64_t)n) st = tilt(&t);
    if (st == TET_OK) st = step(&t);
  }
  tet_free(ctx, t.item);
  tet_free(ctx, t.sorted);
  tet_free(ctx, t.nodes);
  tet_free(ctx, t.tilted);
  tet_free(ctx, t.stack);
  return st;
}
