// SPDX-License-Identifier: Apache-2.0
/* mesh_command.c: the commands that read a file or write a mesh: mesh, submit, fetch,
 * and what they share with watch. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "clients/cli/cli.h"

static int show_format_error(const tf_error *error) {
    complain("%s", error->message);
    switch (error->status) {
    case TF_E_WRITE: return STATUS_OUTPUT;
    case TF_E_OPEN:
    case TF_E_MALFORMED: return STATUS_REFUSED;
    case TF_E_FORMAT: return STATUS_USAGE;
    default: return STATUS_CONNECTION;
    }
}

static int check_outputs(const arguments *args) {
    tf_error error;
    const unsigned extras = (args->options.neighbours ? TF_WITH_NEIGHBOURS : 0U) |
                            (args->options.voronoi != NULL ? TF_WITH_VORONOI : 0U);
    if (tf_write_check(args->output, extras, &error) != TF_OK ||
        (args->report != NULL && tf_output_check(args->report, &error) != TF_OK)) {
        return show_format_error(&error);
    }
    return STATUS_DONE;
}

static int read_input(const char *path, tf_pls *ret_pls) {
    tf_error error;
    if (tf_read(path, ret_pls, &error) != TF_OK) {
        const int status = show_format_error(&error);
        return error.status == TF_E_FORMAT ? STATUS_REFUSED : status;
    }
    return STATUS_DONE;
}

static int submit(tetrad_client *client, const tf_pls *pls, const tetrad_options *options,
                  char job[TETRAD_JOB_SIZE]) {
    tetrad_error error;
    const size_t n = pls->arrays.count;
    tetrad_array *arrays = calloc(n, sizeof *arrays);
    if (arrays == NULL) {
        complain("out of memory");
        return STATUS_CONNECTION;
    }
    for (size_t i = 0; i < n; i++) {
        const tp_array *a = &pls->arrays.items[i];
        arrays[i] = (tetrad_array){
            a->name, (tetrad_dtype)a->dtype, a->ndim, {a->shape[0], a->shape[1]}, a->data};
    }
    const tetrad_status status = tetrad_submit(client, arrays, n, options, job, &error);
    free(arrays);
    return status == TETRAD_OK ? STATUS_DONE : show_failure(&error);
}


int cli_wait(tetrad_client *client, const char *job, const arguments *args, json_t **ret_job) {
    progress_line line = {.terminal = !args->quiet && isatty(STDERR_FILENO)};
    tetrad_error error;
    char *text;
    const tetrad_status status = tetrad_wait(client, job, line.terminal ? progress_show : NULL,
                                             &line, &text, &error);
    progress_clear(&line);
    if (status != TETRAD_OK) {
        return show_failure(&error);
    }
    json_t *object = json_loads(text, 0, NULL);
    free(text);
    const char *state = json_string_value(json_object_get(object, "state"));
    if (state == NULL) {
        complain("the server broke the protocol: no job object");
        json_decref(object);
        return STATUS_CONNECTION;
    }
    if (state[0] != 'd') { // done; else failed or cancelled
        const int failure = show_job_failure(object, args->subject, args->first_index);
        json_decref(object);
        return failure;
    }
    *ret_job = object;
    return STATUS_DONE;
}

// Arrays of the schema, borrowed from the mesh; later versions may send others too.
static bool borrow_known(const tetrad_mesh *mesh, tp_arrays *set) {
    const tetrad_array *a;
    for (size_t i = 0; (a = tetrad_mesh_array(mesh, i)) != NULL; i++) {
        if (tp_schema_find(tp_schema_mesh(), a->name) != NULL &&
            tp_arrays_borrow(set, a->name, (tp_dtype)a->dtype, a->shape[0],
                             a->ndim == 2 ? a->shape[1] : 0, a->data, NULL) != TP_OK) {
            return false;
        }
    }
    return true;
}

static tf_status write_report(tf_outputs *set, const char *path, const json_t *report,
                              tf_error *error) {
    FILE *file;
    const tf_status status = tf_outputs_add(set, path, &file, error);
    if (status == TF_OK) {
        if (json_dumpf(report, file, JSON_INDENT(2)) != 0) {
            return tf_error_set(error, TF_E_WRITE, "%s: cannot be written", path);
        }
        fputc('\n', file);
    }
    return status;
}

static int write_files(const arguments *args, const tetrad_mesh *mesh, const json_t *report) {
    tp_arrays arrays = TP_ARRAYS_INIT;
    tf_outputs set = TF_OUTPUTS_INIT;
    tf_error error;
    tf_status status = borrow_known(mesh, &arrays)
                           ? TF_OK
                           : tf_error_set(&error, TF_E_MEMORY, "out of memory");
    if (status == TF_OK) {
        status = tf_write_mesh(&set, args->output, &arrays, args->first_index, &error);
    }
    if (status == TF_OK && args->report != NULL) {
        status = write_report(&set, args->report, report, &error);
    }
    if (status == TF_OK) {
        status = tf_outputs_commit(&set, &error);
    }
    tf_outputs_drop(&set);
    tp_arrays_free(&arrays);
    if (status == TF_E_MALFORMED) { // by the server's fault, not the input's
        complain("%s", error.message);
        return STATUS_CONNECTION;
    }
    return status == TF_OK ? STATUS_DONE : show_format_error(&error);
}

int cli_deliver(tetrad_client *client, const char *job, const json_t *object,
                const arguments *args) {
    tetrad_mesh *mesh;
    tetrad_error error;
    const tetrad_status fetched = tetrad_fetch(client, job, NULL, 0, &mesh, &error);
    if (fetched != TETRAD_OK) {
        return show_failure(&error);
    }
    json_t *report = make_report(object, mesh, args->first_index);
    int status = STATUS_CONNECTION;
    if (report == NULL) {
        complain("the job has no report, or there is no memory for it");
    } else {
        status = write_files(args, mesh, report);
    }
    if (status == STATUS_DONE && args->json) {
        json_dumpf(report, stdout, JSON_INDENT(2));
        putchar('\n');
    } else if (status == STATUS_DONE && !args->quiet) {
        show_summary(report, args->output);
    }
    json_decref(report);
    tetrad_mesh_free(mesh);
    return status;
}

// Waits for the job, fetches and writes its mesh.
static int wait_and_deliver(tetrad_client *client, const char *job, const arguments *args) {
    json_t *object;
    int status = cli_wait(client, job, args, &object);
    if (status == STATUS_DONE) {
        status = cli_deliver(client, job, object, args);
        json_decref(object);
    }
    return status;
}

static void cancel(tetrad_client *client, const char *job) {
    tetrad_error error;
    if (tetrad_job_cancel(client, job, NULL, &error) != TETRAD_OK) {
        complain("the job was not cancelled: %s", error.message);
    }
}

int command_mesh(const arguments *given) {
    arguments args = *given;
    tf_pls pls;
    tetrad_client *client;
    char job[TETRAD_JOB_SIZE];
    int status = check_outputs(&args);
    if (status != STATUS_DONE || (status = read_input(args.subject, &pls)) != STATUS_DONE) {
        return status;
    }
    args.first_index = pls.first_index;
    args.options.point_order = "input_first"; // row i of the output is input vertex i
    status = cli_connect(&args, true, &client);
    if (status != STATUS_DONE) {
        tf_pls_free(&pls);
        return status;
    }
    status = submit(client, &pls, &args.options, job);
    tf_pls_free(&pls);
    if (status == STATUS_DONE) {
        status = wait_and_deliver(client, job, &args);
        if (status == STATUS_INTERRUPTED) {
            cancel(client, job);
        }
        // The job was this call's alone, unless it has a key. If it cannot be dropped
        // now, it expires.
        if (args.options.key == NULL) {
            tetrad_job_delete(client, job, NULL);
        }
    }
    cli_close(client);
    return status;
}

int command_submit(const arguments *given) {
    arguments args = *given;
    tf_pls pls;
    tetrad_client *client;
    char job[TETRAD_JOB_SIZE];
    int status = read_input(args.subject, &pls);
    if (status != STATUS_DONE) {
        return status;
    }
    args.options.point_order = "input_first";
    status = cli_connect(&args, false, &client);
    if (status == STATUS_DONE) {
        status = submit(client, &pls, &args.options, job);
        cli_close(client);
    }
    if (status == STATUS_DONE) {
        printf(args.json ? "{\"job\": \"%s\"}\n" : "%s\n", job);
    }
    tf_pls_free(&pls);
    return status;
}

int command_fetch(const arguments *args) {
    tetrad_client *client;
    int status = check_outputs(args);
    if (status == STATUS_DONE && (status = cli_connect(args, false, &client)) == STATUS_DONE) {
        status = wait_and_deliver(client, args->subject, args);
        cli_close(client);
    }
    return status;
}
