// SPDX-License-Identifier: Apache-2.0
/* schema.c: the tables of PLS and mesh arrays (PROTOCOL.md, "The PLS" and "The
 * mesh") and the checks of sets against them. */
#include <inttypes.h>
#include <string.h>

#include "protocol/array.h"

static const tp_field pls_fields[] = {
    {"points", TP_F8, 3, true, NULL},
    {"point_attributes", TP_F8, TP_ANY_COLUMNS, false, "points"},
    {"point_markers", TP_I4, 1, false, "points"},
    {"polygon_vertices", TP_U4, 1, false, NULL},
    {"polygon_start", TP_U4, 1, false, NULL},
    {"facet_start", TP_U4, 1, false, NULL},
    {"triangles", TP_U4, 3, false, NULL},
    {"facet_markers", TP_I4, 1, false, NULL},
    {"facet_holes", TP_F8, 3, false, NULL},
    {"facet_hole_start", TP_U4, 1, false, NULL},
    {"segments", TP_U4, 2, false, NULL},
    {"segment_markers", TP_I4, 1, false, "segments"},
    {"loose_points", TP_U4, 1, false, NULL},
    {"holes", TP_F8, 3, false, NULL},
    {"region_seeds", TP_F8, 3, false, NULL},
    {"region_markers", TP_I4, 1, false, "region_seeds"},
    {"region_attributes", TP_F8, 1, false, "region_seeds"},
    {"region_max_volumes", TP_F8, 1, false, "region_seeds"},
};

static const tp_field mesh_fields[] = {
    {"points", TP_F8, 3, true, NULL},
    {"point_attributes", TP_F8, TP_ANY_COLUMNS, false, "points"},
    {"point_markers", TP_I4, 1, false, "points"},
    {"point_origin", TP_U1, 1, false, "points"},
    {"point_same_as", TP_U4, 1, false, NULL},
    {"tetrahedra", TP_U4, 4, true, NULL},
    {"tetrahedron_regions", TP_U4, 1, false, "tetrahedra"},
    {"neighbours", TP_U4, 4, false, "tetrahedra"},
    {"subfaces", TP_U4, 3, false, NULL},
    {"subface_facets", TP_U4, 1, false, "subfaces"},
    {"subface_markers", TP_I4, 1, false, "subfaces"},
    {"subsegments", TP_U4, 2, false, NULL},
    {"subsegment_segments", TP_U4, 1, false, "subsegments"},
    {"subsegment_markers", TP_I4, 1, false, "subsegments"},
    {"region_markers", TP_I4, 1, false, NULL},
    {"region_attributes", TP_F8, 1, false, "region_markers"},
    {"exception_tetrahedra", TP_U4, 1, false, NULL},
    {"exception_radius_edge", TP_F8, 1, false, "exception_tetrahedra"},
    {"exception_segments", TP_U4, 1, false, "exception_tetrahedra"},
    {"sliver_tetrahedra", TP_U4, 1, false, NULL},
    {"sliver_cosines", TP_F8, 1, false, "sliver_tetrahedra"},
    {"sliver_segments", TP_U4, 1, false, "sliver_tetrahedra"},
    {"cell_vertices", TP_U4, 1, false, NULL},
    {"cell_regions", TP_U4, 1, false, "cell_vertices"},
    {"cell_volumes", TP_F8, 1, false, "cell_vertices"},
    {"edge_vertices", TP_U4, 2, false, NULL},
    {"edge_regions", TP_U4, 1, false, "edge_vertices"},
    {"edge_factors", TP_F8, 1, false, "edge_vertices"},
    {"subface_shares", TP_F8, 3, false, "subfaces"},
    {"voronoi_points", TP_F8, 3, false, NULL},
    {"voronoi_face_start", TP_U4, 1, false, NULL},
    {"voronoi_face_points", TP_U4, 1, false, NULL},
    {"voronoi_face_cells", TP_U4, 2, false, NULL},
};

static const tp_schema pls_schema = {"pls", pls_fields, sizeof pls_fields / sizeof *pls_fields};
static const tp_schema mesh_schema = {"mesh", mesh_fields, sizeof mesh_fields / sizeof *mesh_fields};

const tp_schema *tp_schema_pls(void) { return &pls_schema; }

const tp_schema *tp_schema_mesh(void) { return &mesh_schema; }

const tp_field *tp_schema_find(const tp_schema *schema, const char *name) {
  for (size_t i = 0; i < schema->count; i++) {
    if (strcmp(schema->fields[i].name, name) == 0) return &schema->fields[i];
  }
  return NULL;
}

tp_code tp_field_check(const tp_schema *schema, const char *name, tp_dtype dtype, unsigned ndim,
                       const uint64_t shape[2], tp_error *error) {
  const tp_field *field = tp_schema_find(schema, name);
  uint64_t bytes = 0;
  if (field == NULL)
    return tp_fail(error, TP_E_PARAMS, name, "a %s has no array \"%.40s\"", schema->name, name);
  if (dtype != field->dtype)
    return tp_fail(error, TP_E_PARAMS, name, "%s has the dtype %s, not %s", name,
                   tp_dtype_name(field->dtype), tp_dtype_name(dtype));
  if (ndim != (field->columns == 1 ? 1u : 2u))
    return tp_fail(error, TP_E_PARAMS, name, "%s has %s, not %u", name,
                   field->columns == 1 ? "1 dimension" : "2 dimensions", ndim);
  if (field->columns != TP_ANY_COLUMNS && shape[1] != field->columns)
    return tp_fail(error, TP_E_PARAMS, name, "%s has %u columns, not %" PRIu64, name,
                   field->columns, shape[1]);
  if (shape[1] == 0) return tp_fail(error, TP_E_PARAMS, name, "%s has no columns", name);
  if (shape[0] > UINT32_MAX || shape[1] > UINT32_MAX ||
      tp_shape_bytes(dtype, shape, &bytes) != TP_OK)
    return tp_fail(error, TP_E_PARAMS, name, "the shape of %s is too large", name);
  return TP_OK;
}

/* A CSR start array: begins with 0, never falls, ends with `entries`. */
static tp_code check_starts(const tp_array *starts, uint64_t entries, tp_error *error) {
  const uint32_t *value = starts->data;
  const uint64_t rows = starts->shape[0];
  if (rows == 0 || value[0] != 0)
    return tp_fail(error, TP_E_PARAMS, starts->name, "%s does not begin with 0", starts->name);
  for (uint64_t i = 1; i < rows; i++) {
    if (value[i] < value[i - 1])
      return tp_fail(error, TP_E_PARAMS, starts->name, "%s falls at row %" PRIu64, starts->name, i);
  }
  if (value[rows - 1] != entries)
    return tp_fail(error, TP_E_PARAMS, starts->name,
                   "%s ends with %" PRIu32 ", but %" PRIu64 " entries are there", starts->name,
                   value[rows - 1], entries);
  return TP_OK;
}

/* Both or neither of two arrays. */
static tp_code check_pair(const tp_array *a, const char *a_name, const tp_array *b,
                          const char *b_name, tp_error *error) {
  if (a != NULL && b == NULL)
    return tp_fail(error, TP_E_PARAMS, a_name, "%s needs %s", a_name, b_name);
  if (b != NULL && a == NULL)
    return tp_fail(error, TP_E_PARAMS, b_name, "%s needs %s", b_name, a_name);
  return TP_OK;
}

/* The polygons and facets of either form; *ret_facets is their number. */
static tp_code check_facets(const tp_arrays *set, uint64_t *ret_facets, tp_error *error) {
  const tp_array *triangles = tp_arrays_find(set, "triangles");
  const tp_array *vertices = tp_arrays_find(set, "polygon_vertices");
  const tp_array *polygons = tp_arrays_find(set, "polygon_start");
  const tp_array *facets = tp_arrays_find(set, "facet_start");
  tp_code code = check_pair(vertices, "polygon_vertices", polygons, "polygon_start", error);
  if (code != TP_OK) return code;
  if (facets != NULL && polygons == NULL)
    return tp_fail(error, TP_E_PARAMS, "facet_start", "facet_start needs polygon_start");
  if (triangles != NULL && polygons != NULL)
    return tp_fail(error, TP_E_PARAMS, "triangles", "triangles and polygons exclude each other");
  if (polygons == NULL) {
    *ret_facets = triangles != NULL ? triangles->shape[0] : 0;
    return TP_OK;
  }
  code = check_starts(polygons, vertices->shape[0], error);
  if (code != TP_OK) return code;
  *ret_facets = polygons->shape[0] - 1;
  if (facets == NULL) return TP_OK;
  code = check_starts(facets, polygons->shape[0] - 1, error);
  if (code != TP_OK) return code;
  *ret_facets = facets->shape[0] - 1;
  return TP_OK;
}

/* What the PLS's table says beyond rows_of. */
static tp_code check_pls(const tp_arrays *set, tp_error *error) {
  uint64_t facets = 0;
  const tp_array *markers = tp_arrays_find(set, "facet_markers");
  const tp_array *holes = tp_arrays_find(set, "facet_holes");
  const tp_array *starts = tp_arrays_find(set, "facet_hole_start");
  tp_code code = check_facets(set, &facets, error);
  if (code != TP_OK) return code;
  if (markers != NULL && markers->shape[0] != facets)
    return tp_fail(error, TP_E_PARAMS, "facet_markers",
                   "facet_markers has %" PRIu64 " rows for %" PRIu64 " facets", markers->shape[0],
                   facets);
  code = check_pair(holes, "facet_holes", starts, "facet_hole_start", error);
  if (code != TP_OK || starts == NULL) return code;
  if (starts->shape[0] != facets + 1)
    return tp_fail(error, TP_E_PARAMS, "facet_hole_start",
                   "facet_hole_start has %" PRIu64 " rows for %" PRIu64 " facets",
                   starts->shape[0], facets);
  return check_starts(starts, holes->shape[0], error);
}

tp_code tp_arrays_validate(const tp_arrays *set, const tp_schema *schema, tp_error *error) {
  for (size_t i = 0; i < set->count; i++) {
    const tp_array *array = &set->items[i];
    const tp_code code =
        tp_field_check(schema, array->name, array->dtype, array->ndim, array->shape, error);
    if (code != TP_OK) return code;
    const char *other_name = tp_schema_find(schema, array->name)->rows_of;
    if (other_name == NULL) continue;
    const tp_array *other = tp_arrays_find(set, other_name);
    if (other == NULL)
      return tp_fail(error, TP_E_PARAMS, array->name, "%s needs %s", array->name, other_name);
    if (other->shape[0] != array->shape[0])
      return tp_fail(error, TP_E_PARAMS, array->name,
                     "%s has %" PRIu64 " rows, %s has %" PRIu64, array->name, array->shape[0],
                     other_name, other->shape[0]);
  }
  for (size_t i = 0; i < schema->count; i++) {
    const char *name = schema->fields[i].name;
    if (schema->fields[i].required && tp_arrays_find(set, name) == NULL)
      return tp_fail(error, TP_E_PARAMS, name, "%s is missing", name);
  }
  return schema == &pls_schema ? check_pls(set, error) : TP_OK;
}
