// SPDX-License-Identifier: Apache-2.0
/* insertion.c: location by walking and Bowyer-Watson insertion of one vertex.
 *
 * The in-sphere test is perturbed symbolically and orientation is not (Devillers,
 * Teillaud 2011): the result is the unique regular tetrahedralization of the
 * perturbed lifting, free of flat tetrahedra, whatever the order of insertion.
 * Constraints are not looked at; facet recovery does its own cutting. */
#include "exact/predicates.h"
#include "mesh/complex.h"

tet_status tet_complex_first(tet_complex *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e) {
  uint32_t v[4] = {a, b, d, e}, t, ghost[4];
  tet_status status = tet_complex_new(c, &t);
  for (int i = 0; i < 4 && status == TET_OK; i++) status = tet_complex_new(c, &ghost[i]);
  if (status != TET_OK) return status;
  for (int i = 0; i < 4; i++) {
    c->v[4 * (size_t)t + i] = v[i];
    c->at[v[i]] = t;
    for (int j = 0; j < 3; j++) c->v[4 * (size_t)ghost[i] + j] = v[tet_face[i][j]];
    c->v[4 * (size_t)ghost[i] + 3] = TET_GHOST;
    tet_link(c, 4 * t + (uint32_t)i, 4 * ghost[i] + 3);
  }
  /* ghosts i and k meet at the edge that faces i and k share: in ghost i that is
     the face opposite vertex k of the tetrahedron */
  for (int i = 0; i < 4; i++)
    for (int k = i + 1; k < 4; k++)
      tet_link(c, 4 * ghost[i] + (uint32_t)tet_index_of(c, ghost[i], v[k]),
               4 * ghost[k] + (uint32_t)tet_index_of(c, ghost[k], v[i]));
  c->last = t;
  return TET_OK;
}

int tet_complex_conflict(const tet_complex *c, uint32_t t, uint32_t p) {
  const uint32_t *v = c->v + 4 * (size_t)t;
  if (v[3] == TET_GHOST) {
    int side = tet_orient3d(c->points, v[0], v[1], v[2], p);
    if (side) return side > 0;
    /* in the hull face's plane: the circumcircle, through the sphere inside */
    v = c->v + 4 * (size_t)(c->adj[4 * (size_t)t + 3] >> 2);
  }
  return tet_insphere_sos(c->points, v[0], v[1], v[2], v[3], p) > 0;
}

/* Which face of t the walk leaves through, or 4 when p is in the closure. The
 * first face looked at is random: a visibility walk may cycle once facets are
 * in, a random one ends. */
static int leave_through(tet_complex *c, uint32_t t, uint32_t p, int entered) {
  c->random ^= c->random << 13;
  c->random ^= c->random >> 17;
  c->random ^= c->random << 5;
  const uint32_t *v = c->v + 4 * (size_t)t;
  for (uint32_t k = 0; k < 4; k++) {
    int i = (int)((c->random + k) & 3);
    if (i == entered) continue;
    const uint8_t *f = tet_face[i];
    if (tet_orient3d(c->points, v[f[0]], v[f[1]], v[f[2]], p) > 0) return i;
  }
  return 4;
}

tet_status tet_complex_locate(tet_complex *c, uint32_t from, uint32_t p, uint32_t *ret_t) {
  uint32_t t = from != TET_NONE ? from : c->last;
  if (tet_is_ghost(c, t)) t = c->adj[4 * (size_t)t + 3] >> 2;
  int entered = 4;
  for (uint64_t steps = 0; steps < (uint64_t)1 << 34; steps++) {
    int i = leave_through(c, t, p, entered);
    if (i == 4) break;
    uint32_t h = c->adj[4 * (size_t)t + i];
    t = h >> 2;
    entered = (int)(h & 3);
    if (tet_is_ghost(c, t)) break;
    if ((steps & 1023) == 1023) {
      tet_status status = tet_poll(c->ctx);
      if (status != TET_OK) return status;
    }
  }
  c->last = t;
  *ret_t = t;
  return TET_OK;
}

/* Collects the tetrahedra in conflict with p, connected to t, and the handles of
 * their border faces, which get their flag. */
static tet_status collect_cavity(tet_complex *c, uint32_t t, uint32_t p) {
  c->n_cavity = c->n_border = 0;
  c->flag[t] |= TET_FLAG_CAVITY;
  tet_status status = tet_push(c->ctx, &c->cavity, &c->n_cavity, &c->cap_cavity, t);
  for (size_t k = 0; k < c->n_cavity && status == TET_OK; k++) {
    uint32_t u = c->cavity[k];
    for (uint32_t i = 0; i < 4 && status == TET_OK; i++) {
      uint32_t o = c->adj[4 * (size_t)u + i] >> 2;
      if (c->flag[o] & TET_FLAG_CAVITY) continue;
      if (tet_complex_conflict(c, o, p)) {
        c->flag[o] |= TET_FLAG_CAVITY;
        status = tet_push(c->ctx, &c->cavity, &c->n_cavity, &c->cap_cavity, o);
      } else {
        c->flag[u] |= (uint8_t)(TET_FLAG_BORDER << i);
        status = tet_push(c->ctx, &c->border, &c->n_border, &c->cap_border, 4 * u + i);
      }
    }
  }
  return status;
}

/* From border face h and the vertex place j beside it: the border face that
 * shares the edge opposite both, found by turning around that edge inside the
 * cavity. Returns its handle and in *ret_j the like place there. */
static uint32_t next_border(const tet_complex *c, uint32_t h, uint32_t j, uint32_t *ret_j) {
  uint32_t t = h >> 2;
  uint32_t out = j;    /* the face to leave through */
  uint32_t in = h & 3; /* the face come from */
  while (!(c->flag[t] & (TET_FLAG_BORDER << out))) {
    uint32_t kept = c->v[4 * (size_t)t + in]; /* on the face crossed, off the edge */
    uint32_t g = c->adj[4 * (size_t)t + out];
    t = g >> 2;
    in = g & 3;
    out = (uint32_t)tet_index_of(c, t, kept);
  }
  *ret_j = in;
  return 4 * t + out;
}

/* Replaces the cavity by the cone of p over its border. */
static tet_status fill_cavity(tet_complex *c, uint32_t p) {
  tet_status status = tet_grow(c->ctx, &c->made, &c->cap_made, c->n_border, sizeof *c->made);
  c->n_made = 0;
  for (size_t k = 0; k < c->n_border && status == TET_OK; k++) {
    status = tet_complex_new(c, &c->made[k]);
    if (status == TET_OK) c->n_made++;
  }
  if (status != TET_OK) {
    while (c->n_made) tet_complex_delete(c, c->made[--c->n_made]);
    return status;
  }
  for (size_t k = 0; k < c->n_border; k++) {
    uint32_t h = c->border[k], t = h >> 2, i = h & 3, n = c->made[k];
    for (uint32_t j = 0; j < 4; j++) c->v[4 * (size_t)n + j] = c->v[4 * (size_t)t + j];
    c->v[4 * (size_t)n + i] = p;
    uint32_t outside = c->adj[h];
    c->adj[4 * (size_t)n + i] = outside;
    c->adj[outside] = 4 * n + i;
    c->adj[h] = n; /* so that neighbours along the border find it */
  }
  for (size_t k = 0; k < c->n_border; k++) {
    uint32_t h = c->border[k], n = c->made[k];
    for (uint32_t j = 0; j < 4; j++) {
      if (j == (h & 3)) continue;
      uint32_t oj, o = next_border(c, h, j, &oj);
      c->adj[4 * (size_t)n + j] = 4 * c->adj[o] + oj;
      uint32_t v = c->v[4 * (size_t)n + j];
      if (v != TET_GHOST) c->at[v] = n;
    }
    c->at[p] = n;
  }
  for (size_t k = 0; k < c->n_cavity; k++) tet_complex_delete(c, c->cavity[k]);
  c->last = c->made[0];
  return TET_OK;
}

tet_status tet_complex_insert(tet_complex *c, uint32_t p, uint32_t from) {
  uint32_t t;
  tet_status status = tet_complex_locate(c, from, p, &t);
  if (status != TET_OK) return status;
  if (!tet_complex_conflict(c, t, p)) return tet_internal(c->ctx, "a located vertex without conflict");
  status = collect_cavity(c, t, p);
  if (status == TET_OK) status = fill_cavity(c, p);
  if (status != TET_OK)
    for (size_t k = 0; k < c->n_cavity; k++) c->flag[c->cavity[k]] = 0;
  return status;
}
