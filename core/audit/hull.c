// SPDX-License-Identifier: Apache-2.0
/* hull.c: convexity, edge by edge: no boundary face may see the apex of the next. */
#include "audit/hull.h"

#include "audit/faces.h"
#include "base/sort.h"
#include "exact/predicates.h"

/* The vertices of boundary face `handle`, outward, from vertex `first` on. */
static void corners(const tet_mesh *mesh, uint32_t handle, uint32_t first, const double *ret_x[3], uint32_t ret_v[3]) {
  const uint32_t *v = mesh->tetrahedra + 4 * (size_t)(handle / 4);
  for (uint32_t k = 0; k < 3; k++) {
    ret_v[k] = v[tet_audit_face[handle % 4][(first + k) % 3]];
    ret_x[k] = mesh->points + 3 * (size_t)ret_v[k];
  }
}

tet_status tet_audit_hull(tet_ctx *ctx, const tet_mesh *mesh, const uint32_t *boundary, uint32_t n,
                          uint64_t *ret_reflex) {
  tet_keyed *edge = tet_alloc(ctx, 3 * (size_t)n, sizeof *edge); /* value: place in boundary, times 3, and edge */
  if (!edge) return tet_ctx_error(ctx)->status;
  const double *x[3], *y[3];
  uint32_t v[3];
  uint64_t reflex = 0;
  for (uint64_t i = 0; i < 3 * (uint64_t)n; i++) {
    corners(mesh, boundary[i / 3], (uint32_t)(i % 3), x, v);
    uint32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
    edge[i] = (tet_keyed){(uint64_t)low << 32 | high, i};
  }
  tet_sort_keyed(edge, 3 * (size_t)n);
  tet_status status = tet_poll(ctx);
  for (uint64_t i = 0, run; status == TET_OK && i < 3 * (uint64_t)n; i += run) {
    for (run = 1; i + run < 3 * (uint64_t)n && edge[i + run].key == edge[i].key;) run++;
    if (run == 2) {
      corners(mesh, boundary[edge[i].value / 3], (uint32_t)(edge[i].value % 3), x, v);
      corners(mesh, boundary[edge[i + 1].value / 3], (uint32_t)(edge[i + 1].value % 3), y, v);
      /* what a face sees has positive orientation to it */
      reflex += tet_orient3d_xyz(x[0], x[1], x[2], y[2]) > 0;
    } else {
      reflex++;
    }
    if ((i & 1023) == 0) status = tet_poll(ctx);
  }
  tet_free(ctx, edge);
  if (status == TET_OK) *ret_reflex = reflex;
  return status;
}
