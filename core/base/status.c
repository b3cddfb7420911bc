// SPDX-License-Identifier: Apache-2.0
/* status.c: names and sentences of the outcomes. */
#include <tet/status.h>

#include <stddef.h>

typedef struct status_row {
  tet_status status;
  const char *name, *text;
} status_row;

static const status_row rows[] = {
    {TET_OK, "ok", "done"},
    {TET_E_ARGUMENT, "argument", "an option or array makes no sense"},
    {TET_E_NOT_FINITE, "not_finite", "a coordinate is not a finite number in range"},
    {TET_E_INDEX, "index", "an index is out of range"},
    {TET_E_DEGENERATE, "degenerate", "the input has no volume or a facet no area"},
    {TET_E_NOT_PLANAR, "not_planar", "a polygon is out of plane"},
    {TET_E_INTERSECTION, "intersection", "facets or segments cross or overlap"},
    {TET_E_OPEN, "open", "the facets enclose no volume"},
    {TET_E_SEED, "seed", "a hole or region seed lies on a facet or outside"},
    {TET_E_MEMORY, "memory", "out of memory"},
    {TET_E_VERTEX_LIMIT, "vertex_limit", "the vertex limit is reached"},
    {TET_E_DEADLINE, "deadline", "the deadline passed"},
    {TET_E_CANCELLED, "cancelled", "cancelled"},
    {TET_E_TOO_LARGE, "too_large", "more elements than an index can name"},
    {TET_E_ROUNDING, "rounding", "facets are closer than doubles can hold"},
    {TET_E_INTERNAL, "internal", "a bug in tetrad"},
};

static const status_row *row_of(tet_status status) {
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    if (rows[i].status == status) return &rows[i];
  return NULL;
}

const char *tet_status_name(tet_status status) {
  const status_row *row = row_of(status);
  return row ? row->name : "unknown";
}

const char *tet_status_text(tet_status status) {
  const status_row *row = row_of(status);
  return row ? row->text : "an unknown status";
}
