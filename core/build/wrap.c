// SPDX-License-Identifier: Apache-2.0
/* wrap.c: gift wrapping of a cavity, for those whose faces are not all Delaunay among
 * the cavity's vertices because some of these do not see each other.
 *
 * The apex of a face is the first vertex met by the spheres through the face whose
 * tetrahedron stays inside: any earlier one is hidden. Staying inside is decided by
 * exact contact with every face of the front (Diazzi, Panozzo, Vaxman, Attene 2023
 * wrap cavities so, too). */
#include "build/wrap.h"

#include <string.h>

#include "exact/predicates.h"
#include "mesh/contact.h"
#include "mesh/pieces.h"

void tet_wrap_free(tet_wrap *w) {
  tet_free(w->ctx, w->front);
  tet_free(w->ctx, w->made);
  tet_free(w->ctx, w->link);
  tet_free(w->ctx, w->tried);
}

static int has(const uint32_t *f, uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; }

/* 1: the boxes of t and f, as rounded and a little larger, are apart. */
static int boxes_apart(const tet_points *p, const uint32_t t[4], const uint32_t f[3]) {
  double slack = p->max_abs * 0x1p-48;
  for (size_t j = 0; j < 3; j++) {
    double lo = p->x[3 * (size_t)t[0] + j], hi = lo, fl = p->x[3 * (size_t)f[0] + j], fh = fl;
    for (int i = 1; i < 4; i++) {
      double x = p->x[3 * (size_t)t[i] + j];
      if (x < lo) lo = x;
      if (x > hi) hi = x;
    }
    for (int i = 1; i < 3; i++) {
      double x = p->x[3 * (size_t)f[i] + j];
      if (x < fl) fl = x;
      if (x > fh) fh = x;
    }
    if (fl > hi + slack || fh < lo - slack) return 1;
  }
  return 0;
}

/* 1: the positive tetrahedron t fits into what is empty. */
static int fits(const tet_wrap *w, const uint32_t t[4]) {
  int behind = 0, before = 0; /* bit i: face i is front, seen from its back or its front */
  for (size_t k = 0; k < w->n_front; k++) {
    const uint32_t *f = w->front[k].v;
    int common = has(f, t[0]) + has(f, t[1]) + has(f, t[2]) + has(f, t[3]);
    if (common == 3) {
      int i = 0;
      while (has(f, t[i])) i++;
      *(tet_orient3d(w->points, f[0], f[1], f[2], t[i]) > 0 ? &before : &behind) |= 1 << i;
    } else if (!boxes_apart(w->points, t, f) && !tet_meets_in_common_face(w->points, t, f)) {
      return 0;
    }
  }
  return !(behind & ~before); /* a slit is front from both sides */
}

/* The apex of front face f, or TET_NONE. */
static uint32_t apex_of(tet_wrap *w, const uint32_t f[3]) {
  const tet_points *p = w->points;
  for (size_t i = 0; i < w->n_vertex; i++)
    w->tried[i] = has(f, w->vertex[i]) || tet_orient3d(p, f[0], f[1], f[2], w->vertex[i]) <= 0;
  for (;;) {
    size_t best = w->n_vertex;
    for (size_t i = 0; i < w->n_vertex; i++) {
      if (w->tried[i]) continue;
      if (best == w->n_vertex || tet_insphere_sos(p, f[0], f[1], f[2], w->vertex[best], w->vertex[i]) > 0) best = i;
    }
    if (best == w->n_vertex) return TET_NONE;
    uint32_t t[4] = {f[0], f[1], f[2], w->vertex[best]};
    if ((!w->may_be_made || w->may_be_made(w->user, t)) && fits(w, t)) return w->vertex[best];
    w->tried[best] = 1;
  }
}

/* 1: f and g are one triangle seen from its two sides. */
static int are_back_to_back(const uint32_t *f, const uint32_t *g) {
  for (int i = 0; i < 3; i++)
    if (f[i] == g[0]) return f[(i + 1) % 3] == g[2] && f[(i + 2) % 3] == g[1];
  return 0;
}

/* Joins face `face` of tetrahedron k, whose outside sees it as v: to the front face
 * that it is, which then is no longer front; else it becomes front. */
static tet_status close_or_open(tet_wrap *w, uint32_t k, uint32_t face, const uint32_t v[3]) {
  for (size_t i = 0; i < w->n_front; i++) {
    tet_front *g = &w->front[i];
    if (!are_back_to_back(g->v, v)) continue;
    w->link[k][face] = g->made ? g->tag : g->tag | TET_WRAP_TAG;
    if (g->made) w->link[g->tag >> 2][g->tag & 3] = 4 * k + face;
    *g = w->front[--w->n_front];
    return TET_OK;
  }
  tet_status status = tet_grow(w->ctx, &w->front, &w->cap_front, w->n_front + 1, sizeof *w->front);
  if (status == TET_OK) w->front[w->n_front++] = (tet_front){{v[0], v[1], v[2]}, 4 * k + face, 1};
  return status;
}

tet_status tet_wrap_fill(tet_wrap *w, int *ret_filled) {
  tet_status status = tet_grow(w->ctx, &w->tried, &w->cap_tried, w->n_vertex, 1);
  size_t n = w->n_vertex, most = 8 * (w->n_front + n) + n * n; /* a tetrahedralization has fewer */
  w->n_made = 0;
  *ret_filled = 0;
  while (w->n_front && status == TET_OK) {
    uint32_t f[3], k = (uint32_t)w->n_made;
    memcpy(f, w->front[w->n_front - 1].v, sizeof f);
    uint32_t apex = apex_of(w, f);
    if (apex == TET_NONE || w->n_made >= most) return TET_OK;
    status = tet_grow(w->ctx, &w->made, &w->cap_made, w->n_made + 1, sizeof *w->made);
    if (status == TET_OK) status = tet_grow(w->ctx, &w->link, &w->cap_link, w->n_made + 1, sizeof *w->link);
    if (status != TET_OK) break;
    w->n_made++;
    uint32_t v[4] = {f[0], f[1], f[2], apex};
    memcpy(w->made[k], v, sizeof v);
    /* seen from outside a face is positive away from the tetrahedron */
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t o[3] = {v[tet_face[i][0]], v[tet_face[i][1]], v[tet_face[i][2]]};
      status = close_or_open(w, k, i, o);
    }
    if (status == TET_OK && (k & 15) == 0) status = tet_poll(w->ctx);
  }
  *ret_filled = status == TET_OK;
  return status;
}
