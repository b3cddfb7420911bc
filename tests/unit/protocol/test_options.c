// SPDX-License-Identifier: Apache-2.0
/* The options: defaults, ranges, names of what is refused, and the way back. */
#include "support.h"

#include "protocol/options.h"

static tp_code parse(const char *text, tp_options *ret_options, tp_error *error) {
  json_t *json = text != NULL ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
  const tp_code code = tp_options_parse(json, ret_options, error);
  json_decref(json);
  return code;
}

static void defaults_are_the_text_s(void **state) {
  (void)state;
  static const char *const empty[] = {NULL, "{}"};
  for (int i = 0; i < 2; i++) {
    tp_options options;
    tp_error error;
    memset(&options, 0xff, sizeof options);
    assert_int_equal(parse(empty[i], &options, &error), TP_OK);
    assert_int_equal(options.stage, TP_STAGE_REFINE);
    assert_true(options.radius_edge == 2.0);
    assert_true(options.max_volume == 0.0);
    assert_true(options.min_dihedral == 5.0);
    assert_int_equal(options.order, TP_INSERT_O2_O1);
    assert_false(options.keep_hull);
    assert_true(options.merge_angle == 0.0);
    assert_false(options.break_points);
    assert_int_equal(options.voronoi, TP_VORONOI_NONE);
    assert_int_equal(options.point_order, TP_ORDER_HILBERT);
    assert_true(options.memory_bytes == 0 && options.max_vertices == 0 && options.seed == 0);
  }
}

static void refusals_name_the_option(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"{\"stage\":\"mesh\"}", "options.stage"},
      {"{\"stage\":2}", "options.stage"},
      {"{\"radius_edge\":0.99}", "options.radius_edge"},
      {"{\"radius_edge\":\"2\"}", "options.radius_edge"},
      {"{\"radius_edge\":true}", "options.radius_edge"},
      {"{\"max_volume\":0}", "options.max_volume"},
      {"{\"max_volume\":-1.0}", "options.max_volume"},
      {"{\"min_dihedral\":-0.1}", "options.min_dihedral"},
      {"{\"min_dihedral\":30.01}", "options.min_dihedral"},
      {"{\"min_dihedral\":\"5\"}", "options.min_dihedral"},
      {"{\"min_dihedral\":false}", "options.min_dihedral"},
      {"{\"merge_angle\":-1}", "options.merge_angle"},
      {"{\"merge_angle\":46}", "options.merge_angle"},
      {"{\"merge_angle\":\"5\"}", "options.merge_angle"},
      {"{\"stage\":\"cdt\",\"merge_angle\":5}", "options.merge_angle"},
      {"{\"order\":\"O6\"}", "options.order"},
      {"{\"order\":\"o2\"}", "options.order"},
      {"{\"order\":2}", "options.order"},
      {"{\"stage\":\"cdt\",\"order\":\"O2\"}", "options.order"},
      {"{\"keep_hull\":1}", "options.keep_hull"},
      {"{\"break_points\":1}", "options.break_points"},
      {"{\"stage\":\"delaunay\",\"break_points\":true}", "options.break_points"},
      {"{\"planarity_tolerance\":-1e-9}", "options.planarity_tolerance"},
      {"{\"seed\":-1}", "options.seed"},
      {"{\"seed\":1.0}", "options.seed"},
      {"{\"threads\":0}", "options.threads"},
      {"{\"threads\":32}", "options.threads"},
      {"{\"memory_bytes\":0}", "options.memory_bytes"},
      {"{\"max_vertices\":9007199254740993}", "options.max_vertices"},
      {"{\"point_order\":\"random\"}", "options.point_order"},
      {"{\"neighbors\":true}", "options.neighbors"},
      {"{\"voronoi\":true}", "options.voronoi"},
      {"{\"voronoi\":\"cells\"}", "options.voronoi"},
      {"{\"stage\":\"delaunay\",\"voronoi\":\"factors\"}", "options.voronoi"},
      {"{\"stage\":\"cdt\",\"keep_hull\":true,\"voronoi\":\"diagram\"}", "options.voronoi"},
      {"{\"stage\":\"cdt\",\"radius_edge\":2}", "options.radius_edge"},
      {"{\"stage\":\"delaunay\",\"max_volume\":2}", "options.max_volume"},
      {"{\"stage\":\"cdt\",\"min_dihedral\":0}", "options.min_dihedral"},
      {"[]", "options"},
      {"null", "options"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    tp_options options = {.seed = 77};
    tp_error error;
    assert_int_equal(parse(cases[i][0], &options, &error), TP_E_PARAMS);
    assert_string_equal(error.where, cases[i][1]);
    assert_true(options.seed == 77);
  }
}

static void what_is_written_is_read(void **state) {
  (void)state;
  const tp_options wanted = {.stage = TP_STAGE_REFINE,
                             .radius_edge = 1.414,
                             .max_volume = 0.1,
                             .min_dihedral = 0.0,
                             .order = TP_INSERT_O3,
                             .keep_hull = true,
                             .planarity_tolerance = 1e-6,
                             .merge_angle = 12.5,
                             .break_points = true,
                             .seed = UINT64_C(1) << 53,
                             .neighbours = true,
                             .point_order = TP_ORDER_INPUT_FIRST,
                             .threads = 31,
                             .memory_bytes = 1,
                             .max_vertices = 3};
  tp_options read;
  tp_options_default(&read);
  json_t *json = tp_options_json(&read);
  assert_int_equal(json_object_size(json), 0);
  json_decref(json);
  json = tp_options_json(&wanted);
  assert_int_equal(json_object_size(json), 14);
  assert_int_equal(tp_options_parse(json, &read, NULL), TP_OK);
  json_decref(json);
  assert_true(read.stage == wanted.stage && read.radius_edge == wanted.radius_edge &&
              read.max_volume == wanted.max_volume && read.min_dihedral == 0.0 && read.order == TP_INSERT_O3 &&
              read.keep_hull && read.neighbours &&
              read.planarity_tolerance == wanted.planarity_tolerance && read.seed == wanted.seed &&
              read.merge_angle == 12.5 && read.break_points && read.point_order == wanted.point_order && read.memory_bytes == 1 &&
              read.max_vertices == 3 && read.threads == 31);
  for (int order = TP_INSERT_O2_O1; order <= TP_INSERT_RELATIVELY_SHORT; order++) {
    tp_options_default(&read);
    read.order = (tp_insertion)order;
    json = tp_options_json(&read);
    assert_int_equal(json_object_size(json), order != TP_INSERT_O2_O1);
    assert_int_equal(tp_options_parse(json, &read, NULL), TP_OK);
    json_decref(json);
    assert_int_equal(read.order, order);
  }
  for (int voronoi = TP_VORONOI_FACTORS; voronoi <= TP_VORONOI_DIAGRAM; voronoi++) {
    tp_options_default(&read);
    read.voronoi = (tp_voronoi)voronoi;
    json = tp_options_json(&read);
    assert_int_equal(tp_options_parse(json, &read, NULL), TP_OK);
    json_decref(json);
    assert_int_equal(read.voronoi, voronoi);
  }
  assert_int_equal(parse("{\"min_dihedral\":30}", &read, NULL), TP_OK);
  assert_true(read.min_dihedral == 30.0);
  assert_int_equal(parse("{\"stage\":\"cdt\"}", &read, NULL), TP_OK);
  assert_int_equal(read.stage, TP_STAGE_CDT);
  assert_string_equal(tp_stage_name(TP_STAGE_DELAUNAY), "delaunay");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(defaults_are_the_text_s),
      cmocka_unit_test(refusals_name_the_option),
      cmocka_unit_test(what_is_written_is_read),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
