// SPDX-License-Identifier: Apache-2.0
/* facets.c: FACETRECOVERY of thesis 5.4: missing regions, and the tetrahedra that
 * they cross.
 *
 * Facets are exactly flat here, Steiner points being implicit. A missing region
 * Omega is flooded through missing edges of its patch. A tetrahedron crosses Omega
 * if Omega parts its vertices; since the border of Omega consists of edges of the
 * complex, the crossed tetrahedra are those reached from the border's edges
 * through faces with vertices on both sides. Each side is filled by cavity.c. */
#include "build/cavity.h"

#include <string.h>

#include "exact/predicates.h"

typedef struct facet_recovery {
  tet_state *st;
  tet_ctx *ctx;
  tet_cavity cavity;
  uint32_t *stack;       /* triangles to look at */
  size_t n_stack, cap_stack;
  uint8_t *in_region;    /* [triangles] 1: in the region being recovered */
  int8_t *side;          /* [vertices] of Omega's plane: -1, 0, 1; UNKNOWN */
  uint32_t *sided;       /* vertices whose side is known */
  size_t n_sided, cap_sided;
} facet_recovery;

enum { UNKNOWN = 2 };

static const uint32_t *corners(const facet_recovery *r, uint32_t tri) {
  return r->st->surface.tri + 3 * (size_t)tri;
}

/* Triangle `tri` is face h, from both sides. */
static void mark_face(facet_recovery *r, uint32_t tri, uint32_t h) {
  r->cavity.face_tri[h] = r->cavity.face_tri[r->st->complex.adj[h]] = tri;
}

/* Looks triangle `tri` up in the complex; marks it if it is there. */
static tet_status match(facet_recovery *r, uint32_t tri, int *ret_found) {
  const uint32_t *v = corners(r, tri);
  uint32_t h;
  tet_status status = tet_complex_find_face(&r->st->complex, v[0], v[1], v[2], &h);
  if (status != TET_OK) return status;
  *ret_found = h != TET_NONE;
  if (*ret_found) mark_face(r, tri, h);
  return TET_OK;
}

/* Marks the triangles that are faces; the others onto the stack. */
static tet_status match_all(facet_recovery *r) {
  uint32_t *face = NULL;
  tet_status status = tet_match_triangles(r->st, &face);
  for (uint32_t tri = r->st->surface.n_tris; tri-- > 0 && status == TET_OK;) {
    if (face[tri] != TET_NONE) mark_face(r, tri, face[tri]);
    else status = tet_push(r->ctx, &r->stack, &r->n_stack, &r->cap_stack, tri);
  }
  tet_free(r->ctx, face);
  return status;
}

/* The missing region of `tri`, into cavity.omega. */
static tet_status form_region(facet_recovery *r, uint32_t tri) {
  const tet_surface *s = &r->st->surface;
  tet_cavity *c = &r->cavity;
  c->n_omega = 0;
  tet_status status = tet_push(r->ctx, &c->omega, &c->n_omega, &c->cap_omega, tri);
  if (status == TET_OK) r->in_region[tri] = 1;
  for (size_t k = 0; k < c->n_omega && status == TET_OK; k++)
    for (uint32_t j = 0; j < 3 && status == TET_OK; j++) {
      size_t e = 3 * (size_t)c->omega[k] + j;
      uint32_t other = s->tri_adj[e] == TET_NONE ? TET_NONE : s->tri_adj[e] / 3, t;
      if (other == TET_NONE || r->in_region[other]) continue;
      status = tet_complex_find_edge(&r->st->complex, s->tri[e], s->tri[e - j + (j + 1) % 3], &t);
      if (status != TET_OK || t != TET_NONE) continue;
      status = tet_push(r->ctx, &c->omega, &c->n_omega, &c->cap_omega, other);
      if (status == TET_OK) r->in_region[other] = 1;
    }
  for (size_t k = 0; k < c->n_omega; k++) r->in_region[c->omega[k]] = 0;
  return status;
}

/* The side of Omega's plane on which vertex v lies. */
static tet_status side_of(facet_recovery *r, uint32_t v, int *ret_side) {
  if (r->side[v] == UNKNOWN) {
    const uint32_t *o = corners(r, r->cavity.omega[0]);
    tet_status status = tet_push(r->ctx, &r->sided, &r->n_sided, &r->cap_sided, v);
    if (status != TET_OK) return status;
    r->side[v] = (int8_t)tet_orient3d(&r->st->points, o[0], o[1], o[2], v);
  }
  *ret_side = r->side[v];
  return TET_OK;
}

static tet_status add_crossed(facet_recovery *r, uint32_t t) {
  tet_complex *c = &r->st->complex;
  if (c->flag[t] & TET_FLAG_CAVITY) return TET_OK;
  c->flag[t] |= TET_FLAG_CAVITY;
  return tet_push(r->ctx, &r->cavity.crossed, &r->cavity.n_crossed, &r->cavity.cap_crossed, t);
}

/* Turns around border edge ab of Omega for the tetrahedron that Omega, on the
 * left of ab as seen from above, enters. */
static tet_status seed_crossed(facet_recovery *r, uint32_t a, uint32_t b) {
  tet_complex *c = &r->st->complex;
  uint32_t first, t;
  tet_status status = tet_complex_find_edge(c, a, b, &first);
  if (status != TET_OK) return status;
  if (first == TET_NONE) return tet_internal(r->ctx, "a missing region's border edge is missing");
  t = first;
  uint32_t left = TET_NONE; /* the vertex of t shared with the tetrahedron before */
  for (int i = 0; i < 4 && left == TET_NONE; i++)
    if (c->v[4 * (size_t)t + i] != a && c->v[4 * (size_t)t + i] != b) left = c->v[4 * (size_t)t + i];
  do {
    const uint32_t *v = c->v + 4 * (size_t)t;
    int i = 0, s[2];
    while (v[i] == a || v[i] == b || v[i] == left) i++;
    uint32_t pair[2] = {left, v[i]};
    if (left != TET_GHOST && v[i] != TET_GHOST) {
      for (int k = 0; k < 2 && status == TET_OK; k++) status = side_of(r, pair[k], &s[k]);
      if (status != TET_OK) return status;
      if (s[0] * s[1] < 0) {
        uint32_t above = pair[s[0] < 0], below = pair[s[0] > 0];
        const uint8_t *f = tet_face[tet_index_of(c, t, above)];
        for (int k = 0; k < 3; k++) /* (a, b, below, above) positive: b, a, below is outward */
          if (v[f[k]] == b && v[f[(k + 1) % 3]] == a && v[f[(k + 2) % 3]] == below) status = add_crossed(r, t);
      }
    }
    uint32_t g = c->adj[4 * (size_t)t + (size_t)tet_index_of(c, t, left)];
    left = pair[1];
    t = g >> 2;
  } while (t != first && status == TET_OK);
  return status;
}

/* All tetrahedra that cross Omega, into cavity.crossed. */
static tet_status collect_crossed(facet_recovery *r) {
  tet_complex *c = &r->st->complex;
  const tet_surface *s = &r->st->surface;
  tet_cavity *cav = &r->cavity;
  tet_status status = TET_OK;
  cav->n_crossed = 0;
  for (size_t k = 0; k < cav->n_omega; k++) r->in_region[cav->omega[k]] = 1;
  for (size_t k = 0; k < cav->n_omega && status == TET_OK; k++)
    for (uint32_t j = 0; j < 3 && status == TET_OK; j++) {
      size_t e = 3 * (size_t)cav->omega[k] + j;
      if (s->tri_adj[e] != TET_NONE && r->in_region[s->tri_adj[e] / 3]) continue;
      status = seed_crossed(r, s->tri[e], s->tri[e - j + (j + 1) % 3]);
    }
  for (size_t k = 0; k < cav->n_omega; k++) r->in_region[cav->omega[k]] = 0;
  for (size_t k = 0; k < cav->n_crossed && status == TET_OK; k++) {
    size_t t = cav->crossed[k];
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      int lo = 0, hi = 0, sign;
      for (int j = 0; j < 3 && status == TET_OK; j++) {
        status = side_of(r, c->v[4 * t + tet_face[i][j]], &sign);
        if (status != TET_OK) break;
        lo |= sign < 0;
        hi |= sign > 0;
      }
      if (status != TET_OK || !lo || !hi) continue;
      if (cav->face_tri[4 * t + i] != TET_NONE) return tet_internal(r->ctx, "a missing region crosses a subface");
      status = add_crossed(r, c->adj[4 * t + i] >> 2);
    }
  }
  if (status == TET_OK && !cav->n_crossed) return tet_internal(r->ctx, "a missing region crosses nothing");
  return status;
}

/* Sorts the border faces of the crossed tetrahedra to the two sides. A subface that only
 * touches Omega's plane may lie between two of them: it is a slit, border from both sides. */
static tet_status part_border(facet_recovery *r) {
  tet_complex *c = &r->st->complex;
  tet_cavity *cav = &r->cavity;
  tet_status status = TET_OK;
  cav->n_border[0] = cav->n_border[1] = 0;
  for (size_t k = 0; k < cav->n_crossed && status == TET_OK; k++) {
    uint32_t t = cav->crossed[k];
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t h = 4 * t + i;
      if (c->flag[c->adj[h] >> 2] & TET_FLAG_CAVITY && cav->face_tri[h] == TET_NONE) continue;
      int up = 0;
      for (int j = 0; j < 3; j++) up |= r->side[c->v[4 * (size_t)t + tet_face[i][j]]] > 0;
      status = tet_push(r->ctx, &cav->border[up], &cav->n_border[up], &cav->cap_border[up], h);
    }
  }
  return status;
}

/* Recovers the missing region of `tri`. */
static tet_status recover_region(facet_recovery *r, uint32_t tri) {
  tet_cavity *c = &r->cavity;
  tet_status status = form_region(r, tri);
  if (status == TET_OK) status = collect_crossed(r);
  if (status == TET_OK) status = part_border(r);
  if (status == TET_OK) status = tet_cavity_fill(c, r->side);
  for (size_t k = 0; k < r->n_sided; k++) r->side[r->sided[k]] = UNKNOWN;
  r->n_sided = 0;
  r->st->counts.cavities++;
  r->st->counts.missing_subfaces += c->n_omega;
  return status;
}

/* The triangles to look at in an order that has nothing to do with the caller's: one that goes round
 * from the outside in would have each region cross what the ones before left of the same tetrahedra. By
 * chance, only the first few regions across a tetrahedron do (Shewchuk, Brown 2015, on segments in the
 * plane): k layers under n vertices cost n log k, not n k. */
static void shuffle(facet_recovery *r) {
  uint64_t state = r->n_stack;
  for (size_t k = r->n_stack; k > 1; k--) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    size_t other = (size_t)((state >> 32) * k >> 32);
    uint32_t tri = r->stack[k - 1];
    r->stack[k - 1] = r->stack[other];
    r->stack[other] = tri;
  }
}

static tet_status recover_all(facet_recovery *r) {
  tet_status status = match_all(r);
  size_t initial = r->n_stack;
  shuffle(r);
  while (r->n_stack && status == TET_OK) {
    uint32_t tri = r->stack[--r->n_stack];
    int found;
    status = match(r, tri, &found);
    if (status == TET_OK && !found) status = recover_region(r, tri);
    if (status == TET_OK) status = tet_poll(r->ctx);
    double left = initial ? (double)r->n_stack / (double)initial : 0;
    tet_progress_report(r->ctx, left < 1 ? 1 - left : 0, r->st->points.n, r->st->complex.n_live,
                        r->st->counts.cavities);
  }
  return status;
}

/* Every triangle is a face now. */
static tet_status verify(const facet_recovery *r) {
  const tet_complex *c = &r->st->complex;
  uint32_t n = r->st->surface.n_tris, left = n;
  uint8_t *found = tet_calloc(r->ctx, n, 1);
  if (!found) return tet_ctx_error(r->ctx)->status;
  for (size_t h = 0; h < 4 * (size_t)c->n_slots; h++) {
    uint32_t tri = r->cavity.face_tri[h];
    if (tri == TET_NONE || !tet_is_live(c, (uint32_t)(h >> 2)) || found[tri]) continue;
    found[tri] = 1;
    left--;
  }
  tet_free(r->ctx, found);
  return left ? tet_internal(r->ctx, "a recovered facet was lost again") : TET_OK;
}

tet_status tet_recover_facets(tet_state *st, uint32_t **ret_face_tri) {
  facet_recovery r = {.st = st, .ctx = st->ctx};
  tet_status status = tet_cavity_init(&r.cavity, st);
  r.in_region = tet_calloc(st->ctx, st->surface.n_tris, 1);
  r.side = tet_alloc(st->ctx, st->points.n, 1);
  if (status == TET_OK && (!r.in_region || !r.side)) status = tet_ctx_error(st->ctx)->status;
  if (status == TET_OK) memset(r.side, UNKNOWN, st->points.n);
  if (status == TET_OK) status = recover_all(&r);
  if (status == TET_OK) status = verify(&r);
  if (status == TET_OK) {
    *ret_face_tri = r.cavity.face_tri;
    r.cavity.face_tri = NULL;
  }
  tet_cavity_free(&r.cavity);
  tet_free(st->ctx, r.in_region);
  tet_free(st->ctx, r.side);
  tet_free(st->ctx, r.sided);
  tet_free(st->ctx, r.stack);
  return status;
}
