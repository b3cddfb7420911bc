// SPDX-License-Identifier: Apache-2.0
/* run.c: see run.h. Opening the upload and encoding the mesh are bounded here; the
 * engine bounds itself through its context. */
#include "server/worker/run.h"

#include <stdlib.h>
#include <time.h>

#include "protocol/frame.h"
#include "protocol/message.h"
#include "server/worker/input.h"
#include "server/worker/output.h"
#include "server/worker/report.h"

static double clock_seconds(clockid_t id) {
  struct timespec t;
  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static answer failed(json_t *error) {
  return (answer){"job.failed", json_pack("{s:o}", "error", error)};
}

/* What is wrong with an upload that the daemon let pass is found in its bytes. */
static answer failed_with(tp_error *error) {
  if (error->code == TP_E_PARAMS) error->code = TP_E_UPLOAD;
  if (error->code == TP_E_INTERNAL) error->code = TP_E_JOB_MEMORY;
  return failed(tp_error_json(error, NULL));
}

static void on_progress(void *user, const tet_progress *p) {
  json_t *params = json_pack("{s:s, s:I, s:I, s:I}", "stage", p->stage, "vertices",
                             (json_int_t)p->vertices, "tetrahedra", (json_int_t)p->tetrahedra,
                             "done", (json_int_t)p->done);
  if (p->fraction >= 0.0 && p->fraction <= 1.0)
    json_object_set_new(params, "fraction", json_real(p->fraction));
  channel_send(user, "job.progress", params, NULL, 0);
}

/* ---- after meshing ---- */

static answer send_mesh(channel *ch, const task *t, const tet_mesh *mesh, tp_codec codec) {
  double wall = clock_seconds(CLOCK_MONOTONIC), cpu = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
  tet_progress progress = {"encode", -1.0, mesh->n_points, mesh->n_tetrahedra, 0};
  json_t *table = NULL;
  tp_error error;
  on_progress(ch, &progress);
  if (output_send(ch, t, mesh, codec, &table, &error) != TP_OK)
    return failed_with(&error);
  tet_stage_report encode = {.name = "encode",
                             .seconds = clock_seconds(CLOCK_MONOTONIC) - wall,
                             .cpu_seconds = clock_seconds(CLOCK_THREAD_CPUTIME_ID) - cpu,
                             .peak_bytes = mesh->report.peak_bytes,
                             .vertices = mesh->n_points,
                             .tetrahedra = mesh->n_tetrahedra};
  return (answer){"job.done", json_pack("{s:o, s:o}", "arrays", table, "report",
                                        report_json(mesh, &encode))};
}

/* ---- meshing ---- */

static answer mesh_pls(channel *ch, const task *t, const tet_pls *pls, const tp_options *options) {
  tet_options engine_options;
  tet_limits limits = {.memory_bytes = options->memory_bytes,
                       .max_vertices = options->max_vertices};
  const json_t *deadline = json_object_get(t->params, "deadline_ms");
  tp_codec codec = TP_MESH;
  tet_ctx *ctx = NULL;
  tet_mesh *mesh = NULL;
  if (deadline) limits.deadline_seconds = (double)json_integer_value(deadline) * 1e-3;
  tp_codec_of(json_string_value(json_object_get(t->params, "codec")), &codec);
  input_options(options, &engine_options);
  if (tet_ctx_create(&limits, &ctx) != TET_OK) {
    tp_error error;
    tp_fail(&error, TP_E_JOB_MEMORY, NULL, "no memory for the engine");
    return failed_with(&error);
  }
  tet_ctx_set_progress(ctx, on_progress, ch);
  channel_set_context(ch, ctx);
  tet_status status = tet_mesh_pls(ctx, pls, &engine_options, &mesh);
  channel_set_context(ch, NULL);
  answer a = status == TET_OK ? send_mesh(ch, t, mesh, codec)
                              : failed(report_error(tet_ctx_error(ctx)));
  tet_mesh_free(mesh);
  tet_ctx_free(ctx);
  return a;
}

static tp_code open_upload(task *t, tp_arrays *ret_set, tp_options *ret_options, tp_error *error) {
  const json_t *most = json_object_get(t->params, "max_decoded_bytes");
  if (t->lost) return tp_fail(error, TP_E_JOB_MEMORY, "body", "no memory for the upload");
  tp_code code = tp_options_parse(json_object_get(t->params, "options"), ret_options, error);
  if (code == TP_OK)
    code = tp_unpack(json_object_get(t->params, "pls"), tp_schema_pls(), t->body, t->body_size,
                     (uint64_t)json_integer_value(most), ret_set, error);
  channel_drop_body(t); /* the set has copies: the engine can have this memory */
  return code;
}

answer run_task(channel *ch, task *t) {
  tp_arrays set = TP_ARRAYS_INIT;
  tp_options options;
  tp_error error;
  tet_pls pls;
  uint32_t *starts = NULL;
  bool ok = open_upload(t, &set, &options, &error) == TP_OK &&
            input_view(&set, &pls, &starts, &error) == TP_OK;
  answer a = ok ? mesh_pls(ch, t, &pls, &options) : failed_with(&error);
  free(starts);
  tp_arrays_free(&set);
  return a;
}
