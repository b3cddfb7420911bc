// SPDX-License-Identifier: Apache-2.0
/* report.c: see report.h. Every member of tet_report appears; numbers that JSON
 * cannot hold (the open end of a histogram) are null. */
#include "server/worker/report.h"

#include <math.h>

#include "protocol/frame.h"

static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }
static json_t *count(uint64_t value) { return json_integer((json_int_t)value); }

static void set_count(json_t *object, const char *name, uint64_t value) {
  json_object_set_new(object, name, count(value));
}

static json_t *stage_json(const tet_stage_report *s) {
  return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o}", "name", s->name, "seconds", number(s->seconds),
                   "cpu_seconds", number(s->cpu_seconds), "peak_bytes", count(s->peak_bytes),
                   "vertices", count(s->vertices), "tetrahedra", count(s->tetrahedra));
}

static json_t *stages_json(const tet_report *r, const tet_stage_report *encode) {
  json_t *list = json_array();
  for (uint32_t i = 0; i < r->n_stages; i++) json_array_append_new(list, stage_json(&r->stages[i]));
  json_array_append_new(list, stage_json(encode));
  return list;
}

static json_t *counts_json(const tet_mesh *m) {
  const tet_counts *c = &m->report.counts;
  json_t *o = json_object();
  set_count(o, "vertices", m->n_points);
  set_count(o, "tetrahedra", m->n_tetrahedra);
  set_count(o, "subfaces", m->n_subfaces);
  set_count(o, "subsegments", m->n_subsegments);
  set_count(o, "regions", m->n_regions);
  set_count(o, "input_vertices", c->input_vertices);
  set_count(o, "duplicate_vertices", c->duplicate_vertices);
  set_count(o, "unused_vertices", c->unused_vertices);
  set_count(o, "facets", c->facets);
  set_count(o, "repeated_facets", c->repeated_facets);
  set_count(o, "segments", c->segments);
  set_count(o, "missing_segments", c->missing_segments);
  set_count(o, "segment_steiner_points", c->segment_steiner_points);
  set_count(o, "break_points", c->break_points);
  set_count(o, "degeneracies_left", c->degeneracies_left);
  set_count(o, "missing_subfaces", c->missing_subfaces);
  set_count(o, "cavities", c->cavities);
  set_count(o, "rounding_flips", c->rounding_flips);
  set_count(o, "rounding_moves", c->rounding_moves);
  set_count(o, "squeezed_points", c->squeezed_points);
  set_count(o, "refine_segment_points", c->refine_segment_points);
  set_count(o, "refine_facet_points", c->refine_facet_points);
  set_count(o, "refine_volume_points", c->refine_volume_points);
  set_count(o, "first_slivers", c->first_slivers);
  set_count(o, "sliver_points", c->sliver_points);
  set_count(o, "sliver_budget", c->sliver_budget);
  set_count(o, "thin_points", c->thin_points);
  set_count(o, "thin_budget", c->thin_budget);
  set_count(o, "outside_tetrahedra", c->outside_tetrahedra);
  return o;
}

static json_t *histogram_json(const tet_histogram *h) {
  json_t *edges = json_array(), *bins = json_array();
  for (uint32_t i = 0; i < h->n_bins; i++) {
    json_array_append_new(edges, number(h->edges[i]));
    json_array_append_new(bins, count(h->bins[i]));
  }
  if (h->n_bins) json_array_append_new(edges, number(h->edges[h->n_bins]));
  return json_pack("{s:o, s:o, s:o, s:o}", "min", number(h->min), "max", number(h->max), "edges",
                   edges, "bins", bins);
}

static json_t *quality_json(const tet_quality *q) {
  return json_pack("{s:o, s:o, s:o, s:o, s:o}", "radius_edge", histogram_json(&q->radius_edge),
                   "dihedral_min", histogram_json(&q->dihedral_min), "dihedral_max",
                   histogram_json(&q->dihedral_max), "aspect", histogram_json(&q->aspect), "volume",
                   number(q->volume));
}

static json_t *promised_json(const tet_promise *p) {
  json_t *o = json_pack("{s:b, s:b, s:b, s:b, s:b, s:b, s:o}", "delaunay", p->delaunay, "constrained_delaunay",
                        p->constrained_delaunay, "gabriel", p->gabriel, "covered", p->covered, "convex", p->convex,
                        "region_volumes", p->region_volumes, "planarity", number(p->planarity));
  if (p->radius_edge > 0.0) {
    json_object_set_new(o, "radius_edge", number(p->radius_edge));
    json_object_set_new(o, "radius_edge_proven", json_boolean(p->radius_edge_proven));
  }
  if (p->max_volume > 0.0) json_object_set_new(o, "max_volume", number(p->max_volume));
  if (p->merge_angle > 0.0) {
    json_object_set_new(o, "merge_angle", number(p->merge_angle));
    json_object_set_new(o, "merged_angle", number(p->merged_angle));
    json_object_set_new(o, "merged_distance", number(p->merged_distance));
  }
  if (p->min_dihedral > 0.0) json_object_set_new(o, "min_dihedral", number(p->min_dihedral));
  return o;
}

static json_t *audit_json(const tet_audit *a) {
  json_t *o = json_object();
  set_count(o, "bad_indices", a->bad_indices);
  set_count(o, "flat_or_inverted", a->flat_or_inverted);
  set_count(o, "adjacency", a->adjacency);
  set_count(o, "not_delaunay", a->not_delaunay);
  set_count(o, "not_constrained_delaunay", a->not_constrained_delaunay);
  set_count(o, "subfaces_missing", a->subfaces_missing);
  set_count(o, "subsegments_missing", a->subsegments_missing);
  set_count(o, "uncovered", a->uncovered);
  set_count(o, "reflex", a->reflex);
  set_count(o, "broken_segments", a->broken_segments);
  set_count(o, "facet_slivers", a->facet_slivers);
  set_count(o, "subfaces_encroached", a->subfaces_encroached);
  set_count(o, "subsegments_encroached", a->subsegments_encroached);
  set_count(o, "over_radius_edge", a->over_radius_edge);
  set_count(o, "over_volume", a->over_volume);
  set_count(o, "under_dihedral", a->under_dihedral);
  set_count(o, "region_leaks", a->region_leaks);
  set_count(o, "wrong_regions", a->wrong_regions);
  set_count(o, "wrong_markers", a->wrong_markers);
  set_count(o, "lost_vertices", a->lost_vertices);
  set_count(o, "bad_segments", a->bad_segments);
  set_count(o, "bad_facets", a->bad_facets);
  set_count(o, "folded_subfaces", a->folded_subfaces);
  if (a->bad_facets) set_count(o, "facet", a->facet);
  json_object_set_new(o, "passed", json_boolean(a->passed));
  return o;
}

static json_t *rejected_json(const tet_rejections *r) {
  json_t *o = json_object();
  set_count(o, "protected_ball", r->protected_ball);
  set_count(o, "outside", r->outside);
  set_count(o, "lost_subface", r->lost_subface);
  set_count(o, "too_short", r->too_short);
  set_count(o, "given_up", r->given_up);
  return o;
}

static json_t *voronoi_json(const tet_mesh *m) {
  const tet_voronoi_report *v = &m->report.voronoi;
  json_t *o = json_object();
  set_count(o, "cells", m->n_cells);
  set_count(o, "edges", m->n_edges);
  set_count(o, "negative_factors", v->negative_factors);
  if (v->negative_factors)
    json_object_set_new(o, "worst", json_pack("{s:o, s:[o,o], s:o}", "factor", number(v->worst_factor), "vertices",
                                              count(v->worst_edge[0]), count(v->worst_edge[1]), "region",
                                              count(v->worst_region)));
  return o;
}

static json_t *traced_json(const tet_trace *t) {
  json_t *o = json_object();
  json_object_set_new(o, "reach", json_integer(TET_TRACE_REACH));
  set_count(o, "traced", t->traced);
  set_count(o, "slivers", t->slivers);
  set_count(o, "followed", t->followed);
  set_count(o, "within", t->within);
  json_object_set_new(o, "farthest", number(t->farthest));
  return o;
}

json_t *report_json(const tet_mesh *m, const tet_stage_report *encode) {
  const tet_report *r = &m->report;
  json_t *o = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:{s:I}, s:{s:I}, s:o}", "stages", stages_json(r, encode),
                   "counts", counts_json(m), "quality", quality_json(&r->quality), "promised",
                   promised_json(&r->promised), "audit", audit_json(&r->audit), "rejected",
                   rejected_json(&r->rejected), "exceptions", "count", (json_int_t)m->n_exceptions,
                   "slivers", "count", (json_int_t)m->n_slivers, "peak_bytes", count(r->peak_bytes));
  if (m->n_exceptions + m->n_slivers) json_object_set_new(o, "traced", traced_json(&r->trace));
  if (r->voronoi.made) json_object_set_new(o, "voronoi", voronoi_json(m));
  return o;
}

static json_t *offence_json(const tet_offence *f) {
  static const char *const kinds[] = {[TET_OFFENDER_VERTEX] = "vertex",
                                      [TET_OFFENDER_SEGMENT] = "segment",
                                      [TET_OFFENDER_FACET] = "facet",
                                      [TET_OFFENDER_HOLE] = "hole",
                                      [TET_OFFENDER_REGION] = "region"};
  json_t *kind = json_array(), *index = json_array(), *marker = json_array();
  for (int i = 0; i < 2 && (i == 0 || f->index[i] != UINT32_MAX); i++) {
    json_array_append_new(kind, json_string(kinds[f->kind[i]]));
    json_array_append_new(index, count(f->index[i]));
    json_array_append_new(marker, json_integer(f->marker[i]));
  }
  return json_pack("{s:o, s:o, s:o, s:[o,o,o]}", "kind", kind, "index", index, "marker", marker,
                   "place", number(f->place[0]), number(f->place[1]), number(f->place[2]));
}

json_t *report_error(const tet_error *e) {
  tp_error error;
  json_t *data = json_object();
  tp_fail(&error, (tp_code)(TP_JOB_CODE_BASE + (int)e->status), NULL, "%s",
          e->message[0] ? e->message : tet_status_text(e->status));
  if (e->n_offences) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < e->n_listed; i++)
      json_array_append_new(list, offence_json(&e->offences[i]));
    json_object_set_new(data, "offences",
                        json_pack("{s:I, s:o}", "count", (json_int_t)e->n_offences, "list", list));
  }
  if (e->file) {
    json_object_set_new(data, "file", json_string(e->file));
    json_object_set_new(data, "line", json_integer(e->line));
  }
  json_t *object = tp_error_json(&error, data);
  json_decref(data);
  return object;
}
