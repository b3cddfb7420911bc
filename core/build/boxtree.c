// SPDX-License-Identifier: Apache-2.0
/* boxtree.c: a balanced binary tree over boxes, split at the median of their middles
 * along the longest side, stored in order: node k over items [from, to) has its left
 * half next to it. Where far more pairs of boxes meet than there are boxes, as around long thin
 * triangles aslant, each node gets a tilted box as well, and these are asked too. See boxtree.h. */
#include "build/boxtree.h"

#include <math.h>

#include "build/tilted.h"

enum { LEAF = 4, MAX_DEPTH = 64, MANY = 32 }; /* MANY: pairs a box before boxes are tilted */

typedef struct node {
  tet_box box;
  uint32_t from, to; /* items order[from .. to) */
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
  uint32_t *order;
  node *nodes;
  uint32_t n_nodes;
  size_t cap_nodes, cap_stack;
  node_pair *stack;
  uint32_t n_stack;
} tree;

/* Twice the middle, halved first: coordinates stay in range. */
static double middle(const tree *t, uint32_t item, int axis) {
  const tet_box *b = &t->box[item];
  return 0.5 * b->lo[axis] + 0.5 * b->hi[axis];
}

static int before(const tree *t, uint32_t i, uint32_t j, int axis) {
  double x = middle(t, i, axis), y = middle(t, j, axis);
  return x < y || (x == y && i < j);
}

/* Hoare's selection: order[k] is then the k-th of [from, to) along the axis. */
static void select_median(tree *t, uint32_t from, uint32_t to, uint32_t k, int axis) {
  uint32_t *o = t->order;
  int64_t lo = from, hi = (int64_t)to - 1;
  while (lo < hi) {
    uint32_t pivot = o[lo + (hi - lo) / 2];
    int64_t i = lo, j = hi;
    while (i <= j) {
      while (before(t, o[i], pivot, axis)) i++;
      while (before(t, pivot, o[j], axis)) j--;
      if (i > j) break;
      uint32_t swap = o[i];
      o[i++] = o[j];
      o[j--] = swap;
    }
    if ((int64_t)k <= j) hi = j;
    else if ((int64_t)k >= i) lo = i;
    else return;
  }
}

static tet_box bound(const tree *t, uint32_t from, uint32_t to) {
  tet_box b = t->box[t->order[from]];
  for (uint32_t i = from + 1; i < to; i++) {
    const tet_box *c = &t->box[t->order[i]];
    for (int k = 0; k < 3; k++) {
      if (c->lo[k] < b.lo[k]) b.lo[k] = c->lo[k];
      if (c->hi[k] > b.hi[k]) b.hi[k] = c->hi[k];
    }
  }
  return b;
}

static int longest_axis(const tree *t, uint32_t from, uint32_t to) {
  double lo[3], hi[3];
  int axis = 0;
  for (int k = 0; k < 3; k++) {
    lo[k] = hi[k] = middle(t, t->order[from], k);
    for (uint32_t i = from + 1; i < to; i++) {
      double m = middle(t, t->order[i], k);
      if (m < lo[k]) lo[k] = m;
      if (m > hi[k]) hi[k] = m;
    }
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  }
  return axis;
}

static tet_status build(tree *t, uint32_t n) {
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
    t->nodes[me] = (node){bound(t, a, b), a, b, 0};
    if (up != UINT32_MAX) t->nodes[up].right = me;
    if (b - a <= LEAF) continue;
    uint32_t mid = a + (b - a) / 2;
    select_median(t, a, b, mid, longest_axis(t, a, b));
    from[depth] = mid; /* the right half waits; the left one comes next */
    to[depth] = b;
    parent[depth++] = me;
    from[depth] = a;
    to[depth] = mid;
    parent[depth++] = UINT32_MAX;
  }
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
    t->corners(t->user, t->order[i], x + 3 * (size_t)i);
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
      uint32_t x = t->order[i], y = t->order[j];
      if (!tet_boxes_meet(&t->box[x], &t->box[y])) continue;
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
  tet_status st = TET_OK;
  if (n < 2) return TET_OK;
  t.order = tet_alloc(ctx, n, sizeof *t.order);
  if (!t.order) return tet_ctx_error(ctx)->status;
  for (uint32_t i = 0; i < n; i++) t.order[i] = i;
  st = build(&t, n);
  if (st == TET_OK) st = push(&t, 0, 0);
  for (uint64_t steps = 0; t.n_stack > 0 && st == TET_OK; steps++) {
    if (steps % 1024 == 0) st = tet_poll(ctx);
    if (st == TET_OK && !t.tilted && t.n_pairs > MANY * (uint64_t)n) st = tilt(&t);
    if (st == TET_OK) st = step(&t);
  }
  tet_free(ctx, t.order);
  tet_free(ctx, t.nodes);
  tet_free(ctx, t.tilted);
  tet_free(ctx, t.stack);
  return st;
}
