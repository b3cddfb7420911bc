// SPDX-License-Identifier: Apache-2.0
/* main.c: tetractl, the daemon's client and operator's tool: the connection, signals,
 * and the command that was asked for. */
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "clients/cli/cli.h"

// The client that signals interrupt; the one thing that a handler can reach.
static tetrad_client *volatile signalled_client;

static void on_signal(int number) {
    (void)number;
    if (signalled_client == NULL) {
        _exit(STATUS_INTERRUPTED);
    }
    tetrad_interrupt(signalled_client);
    // Cancelling waits for the server; whoever cannot wait asks again.
    signalled_client = NULL;
}

static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

void complain(const char *format, ...) {
    va_list list;
    fputs("tetractl: ", stderr);
    va_start(list, format);
    vfprintf(stderr, format, list);
    va_end(list);
    fputc('\n', stderr);
}

int cli_connect(const arguments *args, bool private, tetrad_client **ret_client) {
    const char *address = args->connect != NULL ? args->connect : getenv("TETRAD_CONNECT");
    tetrad_error error;
    tetrad_client *client;
    if (address != NULL && address[0] == '\0') {
        address = NULL;
    }
    if (address == NULL && !private) {
        complain("no server is named: --connect ADDRESS or $TETRAD_CONNECT is needed here");
        return STATUS_USAGE;
    }
    if (tetrad_connect(address, getenv("TETRAD_TOKEN"), &client, &error) != TETRAD_OK) {
        return show_failure(&error);
    }
    signalled_client = client;
    *ret_client = client;
    return STATUS_DONE;
}

void cli_close(tetrad_client *client) {
    signalled_client = NULL;
    tetrad_close(client);
}

int main(int argc, char **argv) {
    arguments args;
    const command *which;
    int status = read_arguments(argc, argv, &args, &which);
    if (status < 0) {
        catch_signals();
        status = which->run(&args);
    }
    if (fclose(stdout) != 0 && status == STATUS_DONE) {
        complain("standard output: cannot be written");
        status = STATUS_OUTPUT;
    }
    return status;
}
