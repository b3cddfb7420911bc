// SPDX-License-Identifier: Apache-2.0
/* options.c: reading and writing of the `options` object. */
#include "protocol/options.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

static const char *const stage_names[] = {"delaunay", "cdt", "refine"};
static const char *const order_names[] = {"input_first", "hilbert"};
static const char *const insertion_names[] = {"O2_O1", "O1", "O2", "O3", "O4", "O5", "relatively_short"};
static const char *const voronoi_names[] = {NULL, "factors", "diagram"}; /* none: absent */

const char *tp_stage_name(tp_stage stage) { return stage_names[stage]; }

/* The place of `name` in a list, or -1. */
static int place_of(const char *const *names, int count, const char *name) {
  for (int i = 0; i < count; i++) {
    if (strcmp(names[i], name) == 0) return i;
  }
  return -1;
}

bool tp_stage_of(const char *name, tp_stage *ret_stage) {
  const int place = place_of(stage_names, 3, name);
  if (place < 0) return false;
  *ret_stage = (tp_stage)place;
  return true;
}

void tp_options_default(tp_options *ret_options) {
  *ret_options = (tp_options){
      .stage = TP_STAGE_REFINE, .radius_edge = 2.0, .min_dihedral = 5.0, .order = TP_INSERT_O2_O1,
      .point_order = TP_ORDER_HILBERT, .threads = 1};
}

static tp_code refuse(tp_error *error, const char *name, const char *wanted) {
  char where[TP_ERROR_WHERE];
  snprintf(where, sizeof where, "options.%.50s", name);
  return tp_fail(error, TP_E_PARAMS, where, "%s %s", where, wanted);
}

static tp_code read_bool(const json_t *value, const char *name, bool *ret, tp_error *error) {
  if (!json_is_boolean(value)) return refuse(error, name, "is no boolean");
  *ret = json_is_true(value);
  return TP_OK;
}

static tp_code read_integer(const json_t *value, const char *name, uint64_t least, uint64_t *ret,
                            tp_error *error) {
  const json_int_t number = json_integer_value(value);
  if (!json_is_integer(value) || number < (json_int_t)least || number > TP_MAX_INTEGER)
    return refuse(error, name, least == 0 ? "is no integer from 0 to 2^53"
                                          : "is no integer from 1 to 2^53");
  *ret = (uint64_t)number;
  return TP_OK;
}

static tp_code read_number(const json_t *value, const char *name, double least, double most,
                           const char *wanted, double *ret, tp_error *error) {
  const double number = json_number_value(value);
  if (!json_is_number(value) || !(number >= least && number <= most)) return refuse(error, name, wanted);
  *ret = number;
  return TP_OK;
}

/* One member into *options. */
static tp_code read_option(const char *name, const json_t *value, tp_options *options,
                           tp_error *error) {
  const char *text = json_is_string(value) ? json_string_value(value) : "";
  if (strcmp(name, "stage") == 0) {
    return tp_stage_of(text, &options->stage)
               ? TP_OK
               : refuse(error, name, "is none of delaunay, cdt, refine");
  }
  if (strcmp(name, "point_order") == 0) {
    const int place = place_of(order_names, 2, text);
    if (place < 0) return refuse(error, name, "is none of hilbert, input_first");
    options->point_order = (tp_point_order)place;
    return TP_OK;
  }
  if (strcmp(name, "order") == 0) {
    const int place = place_of(insertion_names, 7, text);
    if (place < 0) return refuse(error, name, "is none of O2_O1, O1, O2, O3, O4, O5, relatively_short");
    options->order = (tp_insertion)place;
    return TP_OK;
  }
  if (strcmp(name, "voronoi") == 0) {
    const int place = place_of(voronoi_names + 1, 2, text);
    if (place < 0) return refuse(error, name, "is none of factors, diagram");
    options->voronoi = (tp_voronoi)(place + 1);
    return TP_OK;
  }
  if (strcmp(name, "radius_edge") == 0)
    return read_number(value, name, 1.0, DBL_MAX, "is no number from 1", &options->radius_edge,
                       error);
  if (strcmp(name, "max_volume") == 0)
    return read_number(value, name, DBL_TRUE_MIN, DBL_MAX, "is no number over 0",
                       &options->max_volume, error);
  if (strcmp(name, "min_dihedral") == 0)
    return read_number(value, name, 0.0, TP_MOST_DIHEDRAL, "is no number from 0 to 30",
                       &options->min_dihedral, error);
  if (strcmp(name, "planarity_tolerance") == 0)
    return read_number(value, name, 0.0, DBL_MAX, "is no number from 0",
                       &options->planarity_tolerance, error);
  if (strcmp(name, "merge_angle") == 0)
    return read_number(value, name, 0.0, TP_MOST_MERGE_ANGLE, "is no number from 0 to 45",
                       &options->merge_angle, error);
  if (strcmp(name, "keep_hull") == 0) return read_bool(value, name, &options->keep_hull, error);
  if (strcmp(name, "break_points") == 0) return read_bool(value, name, &options->break_points, error);
  if (strcmp(name, "neighbours") == 0) return read_bool(value, name, &options->neighbours, error);
  if (strcmp(name, "seed") == 0) return read_integer(value, name, 0, &options->seed, error);
  if (strcmp(name, "threads") == 0) {
    const tp_code code = read_integer(value, name, 1, &options->threads, error);
    return code == TP_OK && options->threads > TP_MAX_THREADS ? refuse(error, name, "is above 31") : code;
  }
  if (strcmp(name, "memory_bytes") == 0)
    return read_integer(value, name, 1, &options->memory_bytes, error);
  if (strcmp(name, "max_vertices") == 0)
    return read_integer(value, name, 1, &options->max_vertices, error);
  return refuse(error, name, "is no option");
}

tp_code tp_options_parse(const json_t *json, tp_options *ret_options, tp_error *error) {
  tp_options options;
  tp_options_default(&options);
  if (json != NULL && !json_is_object(json))
    return tp_fail(error, TP_E_PARAMS, "options", "options is no object");
  json_t *object = (json_t *)(uintptr_t)json; /* jansson's iterators take no const */
  for (void *at = json_object_iter(object); at != NULL; at = json_object_iter_next(object, at)) {
    const tp_code code =
        read_option(json_object_iter_key(at), json_object_iter_value(at), &options, error);
    if (code != TP_OK) return code;
  }
  static const char *const of_refine[] = {"radius_edge", "max_volume", "min_dihedral", "order", "merge_angle"};
  for (size_t i = 0; i < sizeof of_refine / sizeof *of_refine && options.stage != TP_STAGE_REFINE; i++) {
    if (json_object_get(json, of_refine[i]) != NULL)
      return refuse(error, of_refine[i], "acts only in the stage refine");
  }
  if (options.stage == TP_STAGE_DELAUNAY && json_object_get(json, "break_points") != NULL)
    return refuse(error, "break_points", "are for facets: not with the stage delaunay");
  if (options.voronoi != TP_VORONOI_NONE && (options.stage == TP_STAGE_DELAUNAY || options.keep_hull))
    return refuse(error, "voronoi", "cuts cells to facets: not with the stage delaunay or keep_hull");
  *ret_options = options;
  return TP_OK;
}

json_t *tp_options_json(const tp_options *options) {
  tp_options usual;
  tp_options_default(&usual);
  json_t *json = json_object();
  int failed = json == NULL;
  if (options->stage != usual.stage)
    failed |= json_object_set_new(json, "stage", json_string(stage_names[options->stage]));
  if (options->radius_edge != usual.radius_edge)
    failed |= json_object_set_new(json, "radius_edge", json_real(options->radius_edge));
  if (options->max_volume != 0.0)
    failed |= json_object_set_new(json, "max_volume", json_real(options->max_volume));
  if (options->min_dihedral != usual.min_dihedral)
    failed |= json_object_set_new(json, "min_dihedral", json_real(options->min_dihedral));
  if (options->order != usual.order)
    failed |= json_object_set_new(json, "order", json_string(insertion_names[options->order]));
  if (options->keep_hull) failed |= json_object_set_new(json, "keep_hull", json_true());
  if (options->planarity_tolerance != 0.0)
    failed |= json_object_set_new(json, "planarity_tolerance",
                                  json_real(options->planarity_tolerance));
  if (options->merge_angle != 0.0)
    failed |= json_object_set_new(json, "merge_angle", json_real(options->merge_angle));
  if (options->break_points) failed |= json_object_set_new(json, "break_points", json_true());
  if (options->seed != 0)
    failed |= json_object_set_new(json, "seed", json_integer((json_int_t)options->seed));
  if (options->neighbours) failed |= json_object_set_new(json, "neighbours", json_true());
  if (options->voronoi != usual.voronoi)
    failed |= json_object_set_new(json, "voronoi", json_string(voronoi_names[options->voronoi]));
  if (options->point_order != usual.point_order)
    failed |= json_object_set_new(json, "point_order",
                                  json_string(order_names[options->point_order]));
  if (options->threads != usual.threads)
    failed |= json_object_set_new(json, "threads", json_integer((json_int_t)options->threads));
  if (options->memory_bytes != 0)
    failed |= json_object_set_new(json, "memory_bytes",
                                  json_integer((json_int_t)options->memory_bytes));
  if (options->max_vertices != 0)
    failed |= json_object_set_new(json, "max_vertices",
                                  json_integer((json_int_t)options->max_vertices));
  if (failed == 0) return json;
  json_decref(json);
  return NULL;
}
