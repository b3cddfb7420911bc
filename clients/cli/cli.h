// SPDX-License-Identifier: Apache-2.0
/* cli.h: the parts of tetractl: arguments, commands, what is shown, the report. */
#ifndef TETRACTL_CLI_H
#define TETRACTL_CLI_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "clients/formats/format.h"
#include "tetrad/client.h"

/* The program's exit statuses. */
enum {
    STATUS_DONE = 0,
    STATUS_REFUSED = 1,     /* the input: missing, malformed, or no valid PLS */
    STATUS_USAGE = 2,
    STATUS_CONNECTION = 3,  /* no server, or it refused the request */
    STATUS_JOB = 4,         /* the job failed, was cancelled, or hit a limit */
    STATUS_OUTPUT = 5,      /* a file cannot be written */
    STATUS_INTERRUPTED = 130
};

typedef struct arguments {
    const char *command;
    const char *subject; /* INPUT or JOB; NULL if the command takes none */
    const char *output, *report, *connect;
    tetrad_options options;
    int first_index;
    bool quiet, json;
} arguments;

typedef int (*command_fn)(const arguments *args);

typedef struct command {
    const char *name;
    const char *subject; /* "INPUT", "JOB" or NULL */
    unsigned groups;     /* of options that it takes */
    command_fn run;
    const char *summary;
} command;

/* The table of commands, which ends with a name of NULL. */
extern const command commands[];

/* Reads the command line. Prints and returns the exit status where that is all
 * (--help, --version, a mistake), else fills the outputs and returns -1. */
int read_arguments(int argc, char **argv, arguments *ret_args, const command **ret_command);

/* The option groups of the table. */
enum {
    GROUP_JOB = 1,       /* --stage ... : what to make */
    GROUP_OUTPUT = 2,    /* -o, --report */
    GROUP_FIRST = 4,     /* --first-index */
    GROUP_QUIET = 8
};

int command_mesh(const arguments *args);
int command_submit(const arguments *args);
int command_jobs(const arguments *args);
int command_status(const arguments *args);
int command_watch(const arguments *args);
int command_cancel(const arguments *args);
int command_delete(const arguments *args);
int command_fetch(const arguments *args);
int command_stats(const arguments *args);

/* Connects to --connect or $TETRAD_CONNECT; without either, to a private daemon if
 * `private`, else it says what is missing. From then on SIGINT and SIGTERM interrupt the
 * client. Returns STATUS_DONE, or what to exit with (it has said why). */
int cli_connect(const arguments *args, bool private, tetrad_client **ret_client);

/* Closes; signals end the program again. */
void cli_close(tetrad_client *client);

/* Waits for a job with progress on a terminal. Gives the job object on STATUS_DONE;
 * failures have been shown. */
int cli_wait(tetrad_client *client, const char *job, const arguments *args, json_t **ret_job);

/* Fetches a finished job's mesh and writes output and report. */
int cli_deliver(tetrad_client *client, const char *job, const json_t *object,
                const arguments *args);

/* Prints "tetractl: ..." on standard error. */
__attribute__((format(printf, 1, 2))) void complain(const char *format, ...);

/* Says why a call failed and gives the exit status that belongs to it. */
int show_failure(const tetrad_error *error);

/* Says why a job ended without a mesh, naming the input's elements to blame (from 0);
 * gives the exit status. */
int show_job_failure(const json_t *job, const char *subject, int first_index);

/* A line that is drawn over itself on a terminal. */
typedef struct progress_line {
    bool terminal, drawn;
} progress_line;

void progress_show(void *line, const tetrad_progress *progress);
void progress_clear(progress_line *line);

/* A few lines on standard output about a finished mesh. */
void show_summary(const json_t *report, const char *output);

/* The job's report with the list of exceptions, in the output's numbering; a new
 * reference, NULL: no memory. */
json_t *make_report(const json_t *job, const tetrad_mesh *mesh, int first_index);

#endif
