// SPDX-License-Identifier: Apache-2.0
/* jobs.c: submitting, waiting, looking, cancelling (PROTOCOL.md, 7). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/c/client_internal.h"
#include "protocol/message.h"
#include "protocol/options.h"

static tetrad_status from_protocol(tetrad_error *error, const tp_error *why) {
    if (why->code == TP_E_INTERNAL) {
        return tc_no_memory(error);
    }
    const char *text = why->message[0] != '\0' ? why->message : "an argument makes no sense";
    tc_fail(error, TETRAD_E_ARGUMENT, "%s", text);
    if (error != NULL) {
        memcpy(error->where, why->where, sizeof error->where);
    }
    return TETRAD_E_ARGUMENT;
}

// A view of the caller's arrays, checked against the schema.
static tetrad_status gather(const tetrad_array *arrays, size_t n, tp_arrays *set,
                            tetrad_error *error) {
    tp_error why = {TP_OK, "", ""};
    tp_code code = TP_OK;
    for (size_t i = 0; i < n && code == TP_OK; i++) {
        const tetrad_array *a = &arrays[i];
        code = tp_arrays_borrow(set, a->name, (tp_dtype)a->dtype, a->shape[0],
                                a->ndim == 2 ? a->shape[1] : 0, a->data, &why);
    }
    if (code == TP_OK) {
        code = tp_arrays_validate(set, tp_schema_pls(), &why);
    }
    return code == TP_OK ? TETRAD_OK : from_protocol(error, &why);
}

static int set_new(json_t *object, const char *name, json_t *value) {
    return json_object_set_new(object, name, value);
}

// The members that the caller gave; what they mean is checked as the server does it.
static tetrad_status options_json(const tetrad_options *o, json_t **ret_json,
                                  tetrad_error *error) {
    if (o->bound_only && o->min_dihedral != 0) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "bound_only and min_dihedral exclude each other");
    }
    json_t *json = json_object();
    int failed = json == NULL;
    if (o->stage != NULL) {
        failed |= set_new(json, "stage", json_string(o->stage));
    }
    if (o->radius_edge != 0) {
        failed |= set_new(json, "radius_edge", json_real(o->radius_edge));
    }
    if (o->max_volume != 0) {
        failed |= set_new(json, "max_volume", json_real(o->max_volume));
    }
    if (o->bound_only || o->min_dihedral != 0) {
        failed |= set_new(json, "min_dihedral", json_real(o->min_dihedral));
    }
    if (o->order != NULL) {
        failed |= set_new(json, "order", json_string(o->order));
    }
    if (o->keep_hull) {
        failed |= set_new(json, "keep_hull", json_true());
    }
    if (o->planarity_tolerance != 0) {
        failed |= set_new(json, "planarity_tolerance", json_real(o->planarity_tolerance));
    }
    if (o->merge_angle != 0) {
        failed |= set_new(json, "merge_angle", json_real(o->merge_angle));
    }
    if (o->break_points) {
        failed |= set_new(json, "break_points", json_true());
    }
    if (o->neighbours) {
        failed |= set_new(json, "neighbours", json_true());
    }
    if (o->voronoi != NULL) {
        failed |= set_new(json, "voronoi", json_string(o->voronoi));
    }
    if (o->point_order != NULL) {
        failed |= set_new(json, "point_order", json_string(o->point_order));
    }
    if (o->seed != 0) {
        failed |= set_new(json, "seed", json_integer((json_int_t)o->seed));
    }
    if (o->threads != 0) {
        failed |= set_new(json, "threads", json_integer((json_int_t)o->threads));
    }
    if (o->memory_bytes != 0) {
        failed |= set_new(json, "memory_bytes", json_integer((json_int_t)o->memory_bytes));
    }
    if (o->max_vertices != 0) {
        failed |= set_new(json, "max_vertices", json_integer((json_int_t)o->max_vertices));
    }
    tp_options parsed;
    tp_error why = {TP_OK, "", ""};
    if (!failed && tp_options_parse(json, &parsed, &why) != TP_OK) {
        json_decref(json);
        return from_protocol(error, &why);
    }
    if (failed) {
        // A number that JSON cannot hold (not finite) or a text that is no UTF-8.
        json_decref(json);
        return tc_fail(error, TETRAD_E_ARGUMENT, "an option is not finite, or not UTF-8");
    }
    *ret_json = json;
    return TETRAD_OK;
}

static tetrad_status submit_params(const tetrad_client *client, const tetrad_options *o,
                                   json_t *pls, json_t **ret_params, tetrad_error *error) {
    tp_codec codec = client->local ? TP_RAW : TP_MESH;
    json_t *options = NULL;
    if (o->codec != NULL && !tp_codec_of(o->codec, &codec)) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "codec: '%s' is neither raw, zlib nor mesh",
                       o->codec);
    }
    const tetrad_status status = options_json(o, &options, error);
    if (status != TETRAD_OK) {
        return status;
    }
    json_t *params = json_pack("{s:O, s:o, s:s, s:s*}", "pls", pls, "options", options, "codec",
                               tp_codec_name(codec), "key", o->key);
    int failed = params == NULL;
    if (!failed && o->priority != 0) {
        failed |= set_new(params, "priority", json_integer(o->priority));
    }
    if (!failed && o->deadline_ms != 0) {
        failed |= set_new(params, "deadline_ms", json_integer((json_int_t)o->deadline_ms));
    }
    if (failed) {
        json_decref(params);
        return tc_no_memory(error);
    }
    *ret_params = params;
    return TETRAD_OK;
}

// The job's id in a reply.
static tetrad_status take_job(tetrad_client *client, const json_t *result,
                              char ret_job[TETRAD_JOB_SIZE], tetrad_error *error) {
    const char *job = json_string_value(json_object_get(result, "job"));
    if (job == NULL || strlen(job) >= TETRAD_JOB_SIZE) {
        client->broken = true;
        return tc_fail(error, TETRAD_E_PROTOCOL, "the server broke the protocol: no job id");
    }
    strcpy(ret_job, job);
    return TETRAD_OK;
}

tetrad_status tetrad_submit(tetrad_client *client, const tetrad_array *arrays, size_t n_arrays,
                            const tetrad_options *options, char ret_job[TETRAD_JOB_SIZE],
                            tetrad_error *error) {
    static const tetrad_options defaults = {0};
    tp_arrays set = TP_ARRAYS_INIT;
    tp_bytes body = TP_BYTES_INIT;
    json_t *pls = NULL, *params = NULL, *result = NULL;
    tp_error why = {TP_OK, "", ""};
    tetrad_status status = gather(arrays, n_arrays, &set, error);
    if (status == TETRAD_OK &&
        tp_pack(&set, client->local ? TP_RAW : TP_MESH, &body, &pls, &why) != TP_OK) {
        status = from_protocol(error, &why);
    }
    if (status == TETRAD_OK) {
        status =
            submit_params(client, options != NULL ? options : &defaults, pls, &params, error);
    }
    if (status == TETRAD_OK) {
        status = tc_call(client, "mesh.submit", params, &body, NULL, &result, error);
    }
    if (status == TETRAD_OK) {
        status = take_job(client, result, ret_job, error);
    }
    json_decref(result);
    json_decref(params);
    json_decref(pls);
    tp_bytes_free(&body);
    tp_arrays_free(&set);
    return status;
}

// Turns a result into text.
static tetrad_status give_text(json_t *result, char **ret_json, tetrad_error *error) {
    char *text = json_dumps(result, JSON_COMPACT | JSON_ENCODE_ANY);
    json_decref(result);
    if (text == NULL) {
        return tc_no_memory(error);
    }
    *ret_json = text;
    return TETRAD_OK;
}

// A method about one job (or none), and its result as text.
static tetrad_status ask(tetrad_client *client, const char *method, const char *job,
                         char **ret_json, tetrad_error *error) {
    json_t *result, *params = json_pack("{s:s*}", "job", job);
    if (params == NULL) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "the job's id is no UTF-8");
    }
    const tetrad_status status = tc_call(client, method, params, NULL, NULL, &result, error);
    json_decref(params);
    if (status == TETRAD_OK && ret_json != NULL) {
        return give_text(result, ret_json, error);
    }
    if (status == TETRAD_OK) {
        json_decref(result);
    }
    return status;
}

tetrad_status tetrad_job_status(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error) {
    return ask(client, "job.status", job, ret_json, error);
}

tetrad_status tetrad_server_stats(tetrad_client *client, char **ret_json, tetrad_error *error) {
    return ask(client, "server.stats", NULL, ret_json, error);
}

tetrad_status tetrad_job_cancel(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error) {
    return ask(client, "job.cancel", job, ret_json, error);
}

tetrad_status tetrad_job_delete(tetrad_client *client, const char *job, tetrad_error *error) {
    return ask(client, "job.delete", job, NULL, error);
}

tetrad_status tetrad_job_list(tetrad_client *client, char **ret_json, tetrad_error *error) {
    json_t *all = json_array(), *after = NULL;
    tetrad_status status = all != NULL ? TETRAD_OK : tc_no_memory(error);
    // The server gives the list in parts.
    while (status == TETRAD_OK) {
        json_t *result, *params = json_pack("{s:O*}", "after", after);
        json_decref(after);
        after = NULL;
        if (params == NULL) {
            status = tc_no_memory(error);
            break;
        }
        status = tc_call(client, "job.list", params, NULL, NULL, &result, error);
        json_decref(params);
        if (status != TETRAD_OK) {
            break;
        }
        json_t *jobs = json_object_get(result, "jobs");
        after = json_incref(json_object_get(result, "next"));
        const bool more = after != NULL && json_array_size(jobs) > 0;
        if (!json_is_array(jobs) || json_array_extend(all, jobs) != 0) {
            status = tc_fail(error, TETRAD_E_PROTOCOL, "the server broke the protocol: no jobs");
        }
        json_decref(result);
        if (!more) {
            break;
        }
    }
    json_decref(after);
    if (status != TETRAD_OK) {
        json_decref(all);
        return status;
    }
    return give_text(all, ret_json, error);
}

typedef struct waiting {
    tetrad_progress_fn progress;
    void *user;
} waiting;

static uint64_t count_of(const json_t *params, const char *name) {
    const json_int_t value = json_integer_value(json_object_get(params, name));
    return value > 0 ? (uint64_t)value : 0;
}

static tetrad_status take_progress(void *user, const tp_message *message, uint64_t *ret_limit,
                                   tetrad_error *error) {
    const waiting *w = user;
    (void)ret_limit;
    (void)error;
    const char *state = json_string_value(json_object_get(message->params, "state"));
    const char *stage = json_string_value(json_object_get(message->params, "stage"));
    const json_t *fraction = json_object_get(message->params, "fraction");
    if (strcmp(message->method, "job.progress") == 0 && w->progress != NULL) {
        const tetrad_progress progress = {
            state != NULL ? state : "",
            stage != NULL ? stage : "",
            json_is_number(fraction) ? json_number_value(fraction) : -1,
            count_of(message->params, "vertices"),
            count_of(message->params, "tetrahedra"),
            count_of(message->params, "done")};
        w->progress(w->user, &progress);
    }
    return TETRAD_OK;
}

tetrad_status tetrad_wait(tetrad_client *client, const char *job, tetrad_progress_fn progress,
                          void *user, char **ret_json, tetrad_error *error) {
    waiting w = {progress, user};
    const tc_listener listener = {take_progress, NULL, &w};
    json_t *result, *params = json_pack("{s:s}", "job", job);
    if (params != NULL && progress != NULL &&
        set_new(params, "progress_ms", json_integer(TC_PROGRESS_MS)) != 0) {
        json_decref(params);
        params = NULL;
    }
    if (params == NULL) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "the job's id is no UTF-8");
    }
    const tetrad_status status =
        tc_call(client, "job.wait", params, NULL, &listener, &result, error);
    json_decref(params);
    return status == TETRAD_OK ? give_text(result, ret_json, error) : status;
}
