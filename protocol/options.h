// SPDX-License-Identifier: Apache-2.0
/* options.h: the `options` object of mesh.submit, typed and checked in one place
 * for daemon (refusal at once), worker (use) and client (building).
 *
 * PROTOCOL.md, "mesh.submit". */
#ifndef TETRAD_PROTOCOL_OPTIONS_H
#define TETRAD_PROTOCOL_OPTIONS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "protocol/error.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tp_stage { TP_STAGE_DELAUNAY = 0, TP_STAGE_CDT, TP_STAGE_REFINE } tp_stage;
typedef enum tp_point_order { TP_ORDER_INPUT_FIRST = 0, TP_ORDER_HILBERT } tp_point_order;

typedef enum tp_voronoi { TP_VORONOI_NONE = 0, TP_VORONOI_FACTORS, TP_VORONOI_DIAGRAM } tp_voronoi;

typedef enum tp_insertion {
  TP_INSERT_O2_O1 = 0,
  TP_INSERT_O1,
  TP_INSERT_O2,
  TP_INSERT_O3,
  TP_INSERT_O4,
  TP_INSERT_O5,
  TP_INSERT_RELATIVELY_SHORT
} tp_insertion;

enum { TP_MAX_THREADS = 31, TP_MOST_DIHEDRAL = 30, TP_MOST_MERGE_ANGLE = 45 };

typedef struct tp_options {
  tp_stage stage;             /* default TP_STAGE_REFINE */
  double radius_edge;         /* >= 1; default 2.0; only of refine */
  double max_volume;          /* 0: none (default); only of refine */
  double min_dihedral;        /* degrees, 0 (slivers stay) to TP_MOST_DIHEDRAL; default 5; only of refine */
  tp_insertion order;         /* default TP_INSERT_O2_O1; only of refine */
  bool keep_hull;
  double planarity_tolerance; /* >= 0; 0: the engine's default */
  double merge_angle;         /* degrees, 0 (default) to TP_MOST_MERGE_ANGLE; only of refine */
  bool break_points;          /* not of delaunay */
  uint64_t seed;              /* up to 2^53 */
  bool neighbours;
  tp_voronoi voronoi;         /* default TP_VORONOI_NONE; not of delaunay or a kept hull */
  tp_point_order point_order; /* default TP_ORDER_HILBERT */
  uint64_t threads;           /* 1 (default) to TP_MAX_THREADS */
  uint64_t memory_bytes;      /* 0: none */
  uint64_t max_vertices;      /* 0: none */
} tp_options;

void tp_options_default(tp_options *ret_options);

/* Reads `json` (NULL: all defaults). Errors: TP_E_PARAMS, `where` as
 * "options.radius_edge": unknown, of the wrong type, out of range, or given where
 * it cannot act; *ret_options untouched. */
tp_code tp_options_parse(const json_t *json, tp_options *ret_options, tp_error *error);

/* The object with the members that differ from the defaults; a new reference,
 * NULL: no memory. */
json_t *tp_options_json(const tp_options *options);

/* "delaunay", "cdt", "refine". */
const char *tp_stage_name(tp_stage stage);

/* The stage of a name; false (*ret_stage untouched) if there is none. */
bool tp_stage_of(const char *name, tp_stage *ret_stage);

#ifdef __cplusplus
}
#endif
#endif
