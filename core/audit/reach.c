// SPDX-License-Identifier: Apache-2.0
/* reach.c: which flags and places the tetrahedra hold, by orientations alone. */
#include "audit/reach.h"

#include "audit/faces.h"
#include "base/sort.h"
#include "exact/predicates.h"

#include <math.h>
#include <stdlib.h>

static const double *place(const tet_mesh *mesh, uint32_t v) { return mesh->points + 3 * (size_t)v; }

static int orient(const tet_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  return tet_orient3d_xyz(place(m, a), place(m, b), place(m, c), place(m, d));
}

/* Does the flag enter the tetrahedron with it at corner i? */
static int enters(const tet_mesh *m, const tet_flag_at *f, const uint32_t v[4], int i) {
  uint32_t u = v[i], w[3]; /* u, w[0], w[1], w[2] positive */
  for (int k = 0; k < 3; k++) w[k] = v[tet_audit_face[i][k]];
  if (f->along != TET_NONE) {
    int k = 0;
    while (k < 3 && w[k] != f->along) k++;
    if (k == 3) return 0;
    uint32_t r = w[k], b = w[(k + 1) % 3], c = w[(k + 2) % 3];
    return orient(m, u, r, b, f->x) * f->side >= 0 && orient(m, u, r, f->x, c) * f->side >= 0;
  }
  for (int k = 0; k < 3; k++) {
    int inward = orient(m, u, w[k], w[(k + 1) % 3], f->to);
    if (!inward && f->x != TET_NONE) inward = orient(m, u, w[k], w[(k + 1) % 3], f->x) * f->side;
    if (inward < 0) return 0;
  }
  return 1;
}

static int compare_flags(const void *px, const void *py) {
  const tet_flag_at *x = px, *y = py;
  if (x->at != y->at) return x->at < y->at ? -1 : 1;
  return x->of < y->of ? -1 : x->of > y->of;
}

tet_status tet_hit_flags(tet_ctx *ctx, const tet_mesh *mesh, tet_flag_at *flag, size_t n) {
  if (!n) return TET_OK;
  size_t *start = tet_calloc(ctx, (size_t)mesh->n_points + 1, sizeof *start);
  if (!start) return tet_ctx_error(ctx)->status;
  qsort(flag, n, sizeof *flag, compare_flags);
  for (size_t i = 0; i < n; i++) {
    flag[i].hit = 0;
    start[flag[i].at + 1]++;
  }
  for (uint32_t v = 0; v < mesh->n_points; v++) start[v + 1] += start[v];
  tet_status status = TET_OK;
  for (uint32_t t = 0; t < mesh->n_tetrahedra && status == TET_OK; t++) {
    const uint32_t *v = mesh->tetrahedra + 4 * (size_t)t;
    for (int i = 0; i < 4; i++)
      for (size_t k = start[v[i]]; k < start[v[i] + 1]; k++)
        if (!flag[k].hit) flag[k].hit = enters(mesh, &flag[k], v, i);
    if ((t & 1023) == 0) status = tet_poll(ctx);
  }
  tet_free(ctx, start);
  return status;
}

static int compare_probes(const void *px, const void *py) {
  const tet_probe *x = px, *y = py;
  if (x->x[0] != y->x[0]) return x->x[0] < y->x[0] ? -1 : 1;
  return x->of < y->of ? -1 : x->of > y->of;
}

static int holds(const double *const v[4], const double *x) {
  for (int j = 1; j < 3; j++) {
    double lo = fmin(fmin(v[0][j], v[1][j]), fmin(v[2][j], v[3][j]));
    double hi = fmax(fmax(v[0][j], v[1][j]), fmax(v[2][j], v[3][j]));
    if (x[j] < lo || x[j] > hi) return 0;
  }
  for (int i = 0; i < 4; i++) {
    const uint8_t *f = tet_audit_face[i];
    if (tet_orient3d_xyz(v[f[0]], v[f[1]], v[f[2]], x) > 0) return 0;
  }
  return 1;
}

tet_status tet_find_probes(tet_ctx *ctx, const tet_mesh *mesh, tet_probe *probe, size_t n) {
  if (!n) return TET_OK;
  qsort(probe, n, sizeof *probe, compare_probes);
  for (size_t k = 0; k < n; k++) probe[k].tet = TET_NONE;
  tet_status status = TET_OK;
  for (uint32_t t = 0; t < mesh->n_tetrahedra && status == TET_OK; t++) {
    const double *v[4];
    for (int i = 0; i < 4; i++) v[i] = place(mesh, mesh->tetrahedra[4 * (size_t)t + (size_t)i]);
    double lo = fmin(fmin(v[0][0], v[1][0]), fmin(v[2][0], v[3][0]));
    double hi = fmax(fmax(v[0][0], v[1][0]), fmax(v[2][0], v[3][0]));
    size_t from = 0, to = n;
    while (from < to) {
      size_t mid = from + (to - from) / 2;
      if (probe[mid].x[0] < lo) from = mid + 1;
      else to = mid;
    }
    for (size_t k = from; k < n && probe[k].x[0] <= hi; k++)
      if (probe[k].tet == TET_NONE && holds(v, probe[k].x)) probe[k].tet = t;
    if ((t & 1023) == 0) status = tet_poll(ctx);
  }
  return status;
}
