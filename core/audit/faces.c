// SPDX-License-Identifier: Apache-2.0
/* faces.c: the face table: counting sort by smallest vertex, then each vertex's
 * few faces by the other two. */
#include "audit/faces.h"

#include "base/sort.h"

static void order_two(uint32_t *a, uint32_t *b, int *odd) {
  if (*a <= *b) return;
  uint32_t t = *a;
  *a = *b;
  *b = t;
  *odd ^= 1;
}

const uint8_t tet_audit_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

int tet_face_vertices(const tet_mesh *mesh, uint32_t handle, uint32_t ret_v[3]) {
  const uint32_t *v = mesh->tetrahedra + 4 * (size_t)(handle / 4);
  int odd = 0;
  for (int k = 0; k < 3; k++) ret_v[k] = v[tet_audit_face[handle % 4][k]];
  order_two(&ret_v[0], &ret_v[1], &odd);
  order_two(&ret_v[1], &ret_v[2], &odd);
  order_two(&ret_v[0], &ret_v[1], &odd);
  return odd;
}

/* What orders the faces of one smallest vertex. */
static uint64_t key_of(const tet_mesh *mesh, uint32_t handle) {
  uint32_t v[3];
  tet_face_vertices(mesh, handle, v);
  return (uint64_t)v[1] << 32 | v[2];
}

static void fill(tet_face_table *table) {
  const tet_mesh *mesh = table->mesh;
  uint32_t *start = table->start, v[3], n = 4 * mesh->n_tetrahedra;
  for (uint32_t h = 0; h < n; h++) {
    tet_face_vertices(mesh, h, v);
    start[v[0] + 1]++;
  }
  for (uint32_t i = 0; i < mesh->n_points; i++) start[i + 1] += start[i];
  /* Filling moves each start to the next one; they are moved back after. */
  for (uint32_t h = 0; h < n; h++) {
    tet_face_vertices(mesh, h, v);
    table->handle[start[v[0]]++] = h;
  }
  for (uint32_t i = mesh->n_points; i > 0; i--) start[i] = start[i - 1];
  start[0] = 0;
}

static tet_status sort_faces(tet_ctx *ctx, tet_face_table *table) {
  tet_keyed *items = NULL;
  size_t capacity = 0;
  tet_status status = TET_OK;
  for (uint32_t v = 0; v < table->mesh->n_points && status == TET_OK; v++) {
    uint32_t *handle = table->handle + table->start[v];
    uint32_t n = table->start[v + 1] - table->start[v];
    status = (v & 1023) == 0 ? tet_poll(ctx) : TET_OK;
    if (status == TET_OK) status = tet_grow(ctx, &items, &capacity, n, sizeof *items);
    if (status != TET_OK) break;
    for (uint32_t i = 0; i < n; i++) items[i] = (tet_keyed){key_of(table->mesh, handle[i]), handle[i]};
    tet_sort_keyed(items, n);
    for (uint32_t i = 0; i < n; i++) handle[i] = (uint32_t)items[i].value;
  }
  tet_free(ctx, items);
  return status;
}

tet_status tet_face_table_build(tet_ctx *ctx, const tet_mesh *mesh, tet_face_table *ret_table) {
  tet_face_table table = {.mesh = mesh};
  table.start = tet_calloc(ctx, (size_t)mesh->n_points + 1, sizeof *table.start);
  table.handle = tet_alloc(ctx, 4 * (size_t)mesh->n_tetrahedra, sizeof *table.handle);
  tet_status status;
  if (table.start && table.handle) {
    fill(&table);
    status = sort_faces(ctx, &table);
  } else {
    status = tet_ctx_error(ctx)->status;
  }
  if (status == TET_OK)
    *ret_table = table;
  else
    tet_face_table_free(ctx, &table);
  return status;
}

uint32_t tet_face_table_run(const tet_face_table *table, uint32_t i) {
  uint32_t v[3];
  tet_face_vertices(table->mesh, table->handle[i], v);
  uint64_t key = (uint64_t)v[1] << 32 | v[2];
  uint32_t end = table->start[v[0] + 1], j = i + 1;
  while (j < end && key_of(table->mesh, table->handle[j]) == key) j++;
  return j - i;
}

uint32_t tet_face_table_find(const tet_face_table *table, const uint32_t v[3], uint32_t *ret_n) {
  uint32_t w[3] = {v[0], v[1], v[2]};
  int odd = 0;
  order_two(&w[0], &w[1], &odd);
  order_two(&w[1], &w[2], &odd);
  order_two(&w[0], &w[1], &odd);
  uint64_t key = (uint64_t)w[1] << 32 | w[2];
  uint32_t low = table->start[w[0]], end = table->start[w[0] + 1], high = end;
  while (low < high) {
    uint32_t mid = low + (high - low) / 2;
    if (key_of(table->mesh, table->handle[mid]) < key)
      low = mid + 1;
    else
      high = mid;
  }
  *ret_n = low < end && key_of(table->mesh, table->handle[low]) == key ? tet_face_table_run(table, low) : 0;
  return low;
}

void tet_face_table_free(tet_ctx *ctx, tet_face_table *table) {
  tet_free(ctx, table->start);
  tet_free(ctx, table->handle);
  *table = (tet_face_table){0};
}
