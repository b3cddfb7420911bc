// SPDX-License-Identifier: Apache-2.0
/* output.c: see output.h. The arrays are those of PROTOCOL.md, section 5.3. */
#include "server/worker/output.h"

#include "protocol/message.h"

/* All arrays that the mesh has, as views. */
static tp_code collect(const tet_mesh *m, tp_arrays *set, tp_error *error) {
  const bool factors = m->edge_factors != NULL, diagram = m->voronoi_face_start != NULL;
  const uint32_t n_faces = m->n_voronoi_faces, n_corners = diagram ? m->voronoi_face_start[n_faces] : 0;
  struct row {
    const char *name;
    tp_dtype dtype;
    uint32_t rows, columns;
    const void *data;
    bool present;
  };
  const struct row rows[] = {
      {"points", TP_F8, m->n_points, 3, m->points, true},
      {"point_attributes", TP_F8, m->n_points, m->n_attributes, m->point_attributes,
       m->n_attributes > 0},
      {"point_markers", TP_I4, m->n_points, 0, m->point_markers, true},
      {"point_origin", TP_U1, m->n_points, 0, m->point_origin, true},
      {"point_same_as", TP_U4, m->n_input_points, 0, m->point_same_as, true},
      {"tetrahedra", TP_U4, m->n_tetrahedra, 4, m->tetrahedra, true},
      {"tetrahedron_regions", TP_U4, m->n_tetrahedra, 0, m->tetrahedron_regions, true},
      {"neighbours", TP_U4, m->n_tetrahedra, 4, m->neighbours, m->neighbours != NULL},
      {"subfaces", TP_U4, m->n_subfaces, 3, m->subfaces, true},
      {"subface_facets", TP_U4, m->n_subfaces, 0, m->subface_facets, true},
      {"subface_markers", TP_I4, m->n_subfaces, 0, m->subface_markers, true},
      {"subsegments", TP_U4, m->n_subsegments, 2, m->subsegments, true},
      {"subsegment_segments", TP_U4, m->n_subsegments, 0, m->subsegment_segments, true},
      {"subsegment_markers", TP_I4, m->n_subsegments, 0, m->subsegment_markers, true},
      {"region_markers", TP_I4, m->n_regions, 0, m->region_markers, true},
      {"region_attributes", TP_F8, m->n_regions, 0, m->region_attributes, true},
      {"exception_tetrahedra", TP_U4, m->n_exceptions, 0, m->exception_tetrahedra, true},
      {"exception_radius_edge", TP_F8, m->n_exceptions, 0, m->exception_radius_edge, true},
      {"exception_segments", TP_U4, m->n_exceptions, 0, m->exception_segments, true},
      {"sliver_tetrahedra", TP_U4, m->n_slivers, 0, m->sliver_tetrahedra, true},
      {"sliver_cosines", TP_F8, m->n_slivers, 0, m->sliver_cosines, true},
      {"sliver_segments", TP_U4, m->n_slivers, 0, m->sliver_segments, true},
      {"cell_vertices", TP_U4, m->n_cells, 0, m->cell_vertices, factors},
      {"cell_regions", TP_U4, m->n_cells, 0, m->cell_regions, factors},
      {"cell_volumes", TP_F8, m->n_cells, 0, m->cell_volumes, factors},
      {"edge_vertices", TP_U4, m->n_edges, 2, m->edge_vertices, factors},
      {"edge_regions", TP_U4, m->n_edges, 0, m->edge_regions, factors},
      {"edge_factors", TP_F8, m->n_edges, 0, m->edge_factors, factors},
      {"subface_shares", TP_F8, m->n_subfaces, 3, m->subface_shares, factors},
      {"voronoi_points", TP_F8, m->n_voronoi_points, 3, m->voronoi_points, diagram},
      {"voronoi_face_start", TP_U4, n_faces + 1, 0, m->voronoi_face_start, diagram},
      {"voronoi_face_points", TP_U4, n_corners, 0, m->voronoi_face_points, diagram},
      {"voronoi_face_cells", TP_U4, n_faces, 2, m->voronoi_face_cells, diagram},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const struct row *r = &rows[i];
    if (!r->present) continue;
    tp_code code = tp_arrays_borrow(set, r->name, r->dtype, r->rows, r->columns, r->data, error);
    if (code != TP_OK) return code;
  }
  return TP_OK;
}

static tp_code send_array(channel *ch, const task *t, const tp_array *array,
                          const tp_array_info *info, tp_bytes *bytes, tp_error *error) {
  size_t row_bytes = tp_dtype_size(array->dtype) * (size_t)array->shape[1];
  for (uint64_t i = 0; i < info->chunks; i++) {
    uint64_t row = i * info->rows_per_chunk, rows = tp_array_info_rows(info, i);
    uint32_t crc;
    if (atomic_load(&t->cancelled))
      return tp_fail(error, TP_E_JOB_CANCELLED, NULL, "cancelled while encoding");
    bytes->size = 0;
    if (tp_encode(info->codec, array->dtype, array->shape[1], rows,
                  (const char *)array->data + row * row_bytes, bytes, &crc) != TP_OK)
      return tp_fail(error, TP_E_JOB_MEMORY, NULL, "no memory to encode %s", array->name);
    json_t *params =
        json_pack("{s:s, s:I, s:I, s:I, s:I}", "array", array->name, "chunk", (json_int_t)i, "row",
                  (json_int_t)row, "rows", (json_int_t)rows, "crc32", (json_int_t)crc);
    channel_send(ch, "job.chunk", params, bytes->data, bytes->size);
  }
  return TP_OK;
}

tp_code output_send(channel *ch, const task *t, const tet_mesh *mesh, tp_codec codec,
                    json_t **ret_table, tp_error *error) {
  tp_arrays set = TP_ARRAYS_INIT;
  tp_bytes bytes = TP_BYTES_INIT;
  json_t *table = json_array();
  tp_code code = table ? collect(mesh, &set, error) : TP_E_INTERNAL;
  if (code != TP_OK) code = tp_fail(error, TP_E_JOB_MEMORY, NULL, "no memory for the array table");
  for (size_t i = 0; i < set.count && code == TP_OK; i++) {
    tp_array_info info;
    tp_array_info_of(&set.items[i], codec, &info);
    code = send_array(ch, t, &set.items[i], &info, &bytes, error);
    if (code == TP_OK && json_array_append_new(table, tp_array_info_json(&info)))
      code = tp_fail(error, TP_E_JOB_MEMORY, NULL, "no memory for the array table");
  }
  tp_bytes_free(&bytes);
  tp_arrays_free(&set);
  if (code == TP_OK) *ret_table = table;
  else json_decref(table);
  return code;
}
