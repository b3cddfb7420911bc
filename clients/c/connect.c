// SPDX-License-Identifier: Apache-2.0
/* connect.c: addresses, the hello, closing. */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "clients/c/client_internal.h"

const char *tetrad_version(void) {
    return TETRAD_VERSION;
}

static tetrad_status connect_unix(const char *path, int *ret_fd, tetrad_error *error) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (path[0] == '\0' || strlen(path) >= sizeof address.sun_path) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "unix:%s: a path of 1 to %zu bytes is needed",
                       path, sizeof address.sun_path - 1);
    }
    strcpy(address.sun_path, path);
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0 || connect(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        const int reason = errno;
        if (fd >= 0) {
            close(fd);
        }
        return tc_fail(error, TETRAD_E_CONNECT, "unix:%s: %s", path, strerror(reason));
    }
    *ret_fd = fd;
    return TETRAD_OK;
}

// "HOST:PORT", the host of IPv6 in brackets; splits `text` in place.
static bool split_host(char *text, char **ret_host, char **ret_port) {
    char *colon = strrchr(text, ':');
    if (colon == NULL || colon == text || colon[1] == '\0') {
        return false;
    }
    *colon = '\0';
    *ret_port = colon + 1;
    *ret_host = text;
    if (text[0] == '[' && colon[-1] == ']') {
        colon[-1] = '\0';
        *ret_host = text + 1;
    }
    return (*ret_host)[0] != '\0';
}

static tetrad_status connect_tcp(const char *where, int *ret_fd, tetrad_error *error) {
    char text[512], *host, *port;
    struct addrinfo *found, hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    snprintf(text, sizeof text, "%s", where);
    if (strlen(where) >= sizeof text || !split_host(text, &host, &port)) {
        return tc_fail(error, TETRAD_E_ARGUMENT, "tcp:%s: HOST:PORT is needed", where);
    }
    const int failed = getaddrinfo(host, port, &hints, &found);
    if (failed != 0) {
        return tc_fail(error, TETRAD_E_CONNECT, "tcp:%s: %s", where, gai_strerror(failed));
    }
    int fd = -1, reason = 0;
    for (const struct addrinfo *a = found; a != NULL && fd < 0; a = a->ai_next) {
        fd = socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC, a->ai_protocol);
        if (fd < 0 || connect(fd, a->ai_addr, a->ai_addrlen) != 0) {
            reason = errno;
            if (fd >= 0) {
                close(fd);
            }
            fd = -1;
        }
    }
    freeaddrinfo(found);
    if (fd < 0) {
        return tc_fail(error, TETRAD_E_CONNECT, "tcp:%s: %s", where, strerror(reason));
    }
    // Requests are one write each; they should not wait for one another. If it fails,
    // they do.
    const int on = 1;
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    *ret_fd = fd;
    return TETRAD_OK;
}

static tetrad_status reach(tetrad_client *client, const char *address, tetrad_error *error) {
    client->local = true;
    if (address == NULL) {
        return tc_daemon_start(&client->daemon, &client->fd, error);
    }
    if (strncmp(address, "unix:", 5) == 0) {
        return connect_unix(address + 5, &client->fd, error);
    }
    if (strncmp(address, "tcp:", 4) == 0) {
        client->local = false;
        return connect_tcp(address + 4, &client->fd, error);
    }
    return tc_fail(error, TETRAD_E_ARGUMENT, "%s: an address is unix:PATH or tcp:HOST:PORT",
                   address);
}

static tetrad_status say_hello(tetrad_client *client, const char *token, tetrad_error *error) {
    json_t *result;
    json_t *params = json_pack("{s:i, s:s, s:s*}", "protocol", 1, "client",
                               "libtetrad-client " TETRAD_VERSION, "token", token);
    if (params == NULL) {
        return tc_no_memory(error);
    }
    const tetrad_status status =
        tc_call(client, "server.hello", params, NULL, NULL, &result, error);
    json_decref(params);
    if (status == TETRAD_OK) {
        const json_t *protocol = json_object_get(result, "protocol");
        const bool known = json_is_integer(protocol) && json_integer_value(protocol) == 1;
        json_decref(result);
        if (!known) {
            return tc_fail(error, TETRAD_E_PROTOCOL, "the server does not speak protocol 1");
        }
    }
    return status;
}

tetrad_status tetrad_connect(const char *address, const char *token, tetrad_client **ret_client,
                             tetrad_error *error) {
    tetrad_client *client = calloc(1, sizeof *client);
    if (client == NULL) {
        return tc_no_memory(error);
    }
    client->fd = -1;
    client->daemon.pidfd = -1;
    client->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    client->input = malloc(TC_INPUT);
    tetrad_status status;
    if (client->wake < 0 || client->input == NULL ||
        tp_reader_create(TC_MAX_LINE, &client->reader) != TP_OK) {
        status = tc_no_memory(error);
    } else {
        status = reach(client, address, error);
    }
    if (status == TETRAD_OK) {
        status = say_hello(client, token, error);
    }
    if (status != TETRAD_OK) {
        tetrad_close(client);
        return status;
    }
    *ret_client = client;
    return TETRAD_OK;
}

void tetrad_close(tetrad_client *client) {
    if (client == NULL) {
        return;
    }
    if (client->fd >= 0) {
        close(client->fd);
    }
    tc_daemon_end(&client->daemon);
    if (client->wake >= 0) {
        close(client->wake);
    }
    tp_reader_free(client->reader);
    tp_bytes_free(&client->body);
    free(client->input);
    free(client);
}

void tetrad_interrupt(tetrad_client *client) {
    const uint64_t one = 1;
    const int before = errno;
    atomic_store(&client->interrupted, true);
    (void)!write(client->wake, &one, sizeof one);
    errno = before;
}
