// SPDX-License-Identifier: Apache-2.0
/* report.h: the engine's report and errors as JSON (PROTOCOL.md, sections 9 and 10). */
#ifndef TETRAD_WORKER_REPORT_H
#define TETRAD_WORKER_REPORT_H

#include <jansson.h>
#include <tet/mesh.h>

/* `encode` is the worker's own stage, the last in the list. A new reference. */
json_t *report_json(const tet_mesh *mesh, const tet_stage_report *encode);

/* The error object of a job that the engine refused or gave up. A new reference. */
json_t *report_error(const tet_error *error);

#endif
