// SPDX-License-Identifier: Apache-2.0
/* job_commands.c: the operator's commands: jobs, status, watch, cancel, delete, stats. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clients/cli/cli.h"

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text != NULL ? text : "";
}

static void print_json(const json_t *value) {
    json_dumpf(value, stdout, JSON_INDENT(2));
    putchar('\n');
}

// One request whose answer is JSON text; NULL (and *ret_status) if it failed.
typedef tetrad_status (*asking)(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error);

static json_t *ask(const arguments *args, asking method, int *ret_status) {
    tetrad_client *client;
    tetrad_error error;
    char *text;
    json_t *result = NULL;
    *ret_status = cli_connect(args, false, &client);
    if (*ret_status != STATUS_DONE) {
        return NULL;
    }
    if (method(client, args->subject, &text, &error) == TETRAD_OK) {
        result = json_loads(text, 0, NULL);
        free(text);
        *ret_status = result != NULL ? STATUS_DONE : STATUS_CONNECTION;
    } else {
        *ret_status = show_failure(&error);
    }
    cli_close(client);
    return result;
}

static tetrad_status ask_list(tetrad_client *client, const char *job, char **ret_json,
                              tetrad_error *error) {
    (void)job;
    return tetrad_job_list(client, ret_json, error);
}

static tetrad_status ask_stats(tetrad_client *client, const char *job, char **ret_json,
                               tetrad_error *error) {
    (void)job;
    return tetrad_server_stats(client, ret_json, error);
}

static tetrad_status ask_delete(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error) {
    const tetrad_status status = tetrad_job_delete(client, job, error);
    if (status == TETRAD_OK) {
        json_t *object = json_pack("{s:s, s:b}", "job", job, "deleted", 1);
        *ret_json = json_dumps(object, 0);
        json_decref(object);
        if (*ret_json == NULL) {
            *error = (tetrad_error){.status = TETRAD_E_MEMORY, .message = "out of memory"};
            return TETRAD_E_MEMORY;
        }
    }
    return status;
}

// Local time of seconds since 1970.
static void print_time(const json_t *value) {
    char text[32] = "-";
    if (json_is_number(value)) {
        const time_t seconds = (time_t)json_number_value(value);
        struct tm local;
        localtime_r(&seconds, &local);
        strftime(text, sizeof text, "%F %T", &local);
    }
    printf("%-19s", text);
}

int command_jobs(const arguments *args) {
    int status;
    size_t i;
    json_t *job, *jobs = ask(args, ask_list, &status);
    if (jobs != NULL && args->json) {
        print_json(jobs);
    } else if (jobs != NULL) {
        printf("%-20s %-9s %-8s %-19s %s\n", "JOB", "STATE", "STAGE", "CREATED", "NOTE");
        json_array_foreach(jobs, i, job) {
            printf("%-20s %-9s %-8s ", text_of(job, "job"), text_of(job, "state"),
                   text_of(job, "stage"));
            print_time(json_object_get(job, "created"));
            printf(" %s\n", text_of(json_object_get(job, "error"), "message"));
        }
    }
    json_decref(jobs);
    return status;
}

static void print_member(const char *name, json_t *value, int indent) {
    const char *key;
    json_t *member;
    if (json_is_object(value)) {
        printf("%*s%s\n", indent, "", name);
        json_object_foreach(value, key, member) {
            print_member(key, member, indent + 2);
        }
        return;
    }
    char *text = json_is_string(value) ? strdup(json_string_value(value))
                                       : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT);
    printf("%*s%-*s %s\n", indent, "", 24 - indent, name, text != NULL ? text : "");
    free(text);
}

// An object's members, one a line; long tables are left to --json.
static void print_object(json_t *object) {
    static const char *const long_ones[] = {"arrays", "report"};
    const char *key;
    json_t *member;
    json_object_foreach(object, key, member) {
        bool is_long = false;
        for (size_t i = 0; i < sizeof long_ones / sizeof long_ones[0]; i++) {
            is_long = is_long || strcmp(key, long_ones[i]) == 0;
        }
        if (!is_long) {
            print_member(key, member, 0);
        }
    }
}

// The answer to a question, as JSON or as lines.
static int ask_and_print(const arguments *args, asking method) {
    int status;
    json_t *result = ask(args, method, &status);
    if (result != NULL && args->json) {
        print_json(result);
    } else if (result != NULL) {
        print_object(result);
    }
    json_decref(result);
    return status;
}

int command_status(const arguments *args) {
    return ask_and_print(args, tetrad_job_status);
}

int command_cancel(const arguments *args) {
    return ask_and_print(args, tetrad_job_cancel);
}

int command_delete(const arguments *args) {
    return ask_and_print(args, ask_delete);
}

int command_stats(const arguments *args) {
    return ask_and_print(args, ask_stats);
}

int command_watch(const arguments *args) {
    tetrad_client *client;
    json_t *object;
    int status = cli_connect(args, false, &client);
    if (status != STATUS_DONE) {
        return status;
    }
    status = cli_wait(client, args->subject, args, &object);
    if (status == STATUS_DONE) {
        if (args->json) {
            print_json(object);
        } else if (!args->quiet) {
            printf("%s: done\n", args->subject);
        }
        json_decref(object);
    }
    cli_close(client);
    return status;
}
