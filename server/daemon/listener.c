// SPDX-License-Identifier: Apache-2.0
/* listener.c: see listener.h. */
#include "server/daemon/listener.h"

#include <errno.h>
#include <event2/listener.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/daemon/connection.h"
#include "server/log.h"

struct listener {
  TAILQ_ENTRY(listener) link;
  struct evconnlistener *handle;
  server *server;
  peer_kind peer;
  char *path; /* of a Unix socket */
};

static void on_accept(struct evconnlistener *handle, evutil_socket_t fd, struct sockaddr *address,
                      int size, void *arg) {
  listener *l = arg;
  (void)handle, (void)address, (void)size;
  connection_create(l->server, (int)fd, l->peer);
  listeners_update(l->server);
}

/* No descriptors left, mostly. The connection waits in the kernel, and the listener
 * for the next listeners_update: asking at once would be asking all the time. */
static void on_accept_error(struct evconnlistener *handle, void *arg) {
  (void)arg;
  evconnlistener_disable(handle);
  LOG(LOG_ERROR, "accept failed", log_text("error", strerror(errno)));
}

/* Takes a bound socket, also on failure. */
static bool serve(server *s, int fd, peer_kind peer, const char *path) {
  listener *l = calloc(1, sizeof *l);
  if (l) {
    l->server = s;
    l->peer = peer;
    l->path = path ? strdup(path) : NULL;
    l->handle = evconnlistener_new(s->base, on_accept, l,
                                   LEV_OPT_CLOSE_ON_FREE | LEV_OPT_CLOSE_ON_EXEC, SOMAXCONN, fd);
  }
  if (!l || !l->handle || (path && !l->path)) {
    if (!l || !l->handle) close(fd);
    else evconnlistener_free(l->handle);
    if (l) free(l->path);
    free(l);
    return false;
  }
  evconnlistener_set_error_cb(l->handle, on_accept_error);
  TAILQ_INSERT_TAIL(&s->listeners, l, link);
  return true;
}

/* A socket file that nobody serves is removed; a served one is not touched. */
static bool clear_path(const struct sockaddr_un *address) {
  struct stat info;
  if (lstat(address->sun_path, &info)) return errno == ENOENT;
  if (!S_ISSOCK(info.st_mode)) {
    errno = EEXIST;
    return false;
  }
  int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  bool served = fd < 0 || !connect(fd, (const struct sockaddr *)address, sizeof *address) ||
                errno != ECONNREFUSED;
  if (fd >= 0) close(fd);
  errno = EADDRINUSE;
  return !served && !unlink(address->sun_path);
}

static bool open_unix(server *s, const char *path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  if (strlen(path) >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return false;
  }
  strcpy(address.sun_path, path);
  if (!clear_path(&address)) return false;
  int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return false;
  /* Nobody can connect before listen, so the mode is right from the first moment. */
  if (bind(fd, (const struct sockaddr *)&address, sizeof address) ||
      chmod(path, s->config->unix_mode)) {
    int saved = errno;
    close(fd);
    errno = saved;
    return false;
  }
  if (!serve(s, fd, PEER_UNIX, path)) return false;
  LOG(LOG_INFO, "listening", log_text("unix", path));
  return true;
}

static void log_bound(int fd) {
  struct sockaddr_storage address;
  socklen_t size = sizeof address;
  char host[64], port[16], text[96];
  if (getsockname(fd, (struct sockaddr *)&address, &size) ||
      getnameinfo((struct sockaddr *)&address, size, host, sizeof host, port, sizeof port,
                  NI_NUMERICHOST | NI_NUMERICSERV))
    return;
  snprintf(text, sizeof text, address.ss_family == AF_INET6 ? "[%s]:%s" : "%s:%s", host, port);
  LOG(LOG_INFO, "listening", log_text("tcp", text));
}

static bool open_address(server *s, const struct addrinfo *at) {
  int on = 1;
  int fd = socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at->ai_protocol);
  if (fd < 0) return false;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (at->ai_family == AF_INET6) setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  if (bind(fd, at->ai_addr, at->ai_addrlen)) {
    int saved = errno;
    close(fd);
    errno = saved;
    return false;
  }
  if (!serve(s, fd, PEER_TCP, NULL)) return false;
  log_bound(fd);
  return true;
}

/* "HOST:PORT" or "[HOST]:PORT"; all addresses of the name that can be bound. */
static bool open_tcp(server *s, const char *text) {
  struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE};
  struct addrinfo *found = NULL;
  char host[256];
  const char *colon = strrchr(text, ':');
  size_t size = colon ? (size_t)(colon - text) : 0;
  errno = EINVAL;
  if (!colon || !size || size >= sizeof host) return false;
  bool brackets = text[0] == '[' && text[size - 1] == ']';
  snprintf(host, sizeof host, "%.*s", (int)(brackets ? size - 2 : size), text + brackets);
  int fault = getaddrinfo(host, colon + 1, &hints, &found);
  if (fault) {
    LOG(LOG_ERROR, "address not known", log_text("tcp", text),
        log_text("error", gai_strerror(fault)));
    errno = EINVAL;
    return false;
  }
  unsigned opened = 0;
  for (const struct addrinfo *at = found; at; at = at->ai_next) opened += open_address(s, at);
  int saved = errno;
  freeaddrinfo(found);
  errno = saved;
  return opened > 0;
}

static bool take_inherited(server *s, int fd) {
  int kind;
  socklen_t size = sizeof kind;
  if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &kind, &size)) return false;
  if (kind != SOCK_STREAM) {
    errno = EPROTOTYPE;
    return false;
  }
  if (fcntl(fd, F_SETFD, FD_CLOEXEC) || fcntl(fd, F_SETFL, O_NONBLOCK)) return false;
  return connection_create(s, fd, PEER_INHERITED);
}

bool listeners_open(server *s) {
  const config *cfg = s->config;
  const char *failed = NULL;
  for (size_t i = 0; i < cfg->unix_paths.count && !failed; i++)
    if (!open_unix(s, cfg->unix_paths.items[i])) failed = cfg->unix_paths.items[i];
  for (size_t i = 0; i < cfg->tcp.count && !failed; i++)
    if (!open_tcp(s, cfg->tcp.items[i])) failed = cfg->tcp.items[i];
  if (!failed && cfg->inherit_fd >= 0 && !take_inherited(s, cfg->inherit_fd))
    failed = "the inherited socket";
  if (failed)
    LOG(LOG_ERROR, "cannot listen", log_text("on", failed), log_text("error", strerror(errno)));
  return !failed;
}

void listeners_update(server *s) {
  listener *l;
  bool open = s->n_connections < s->max_connections;
  TAILQ_FOREACH(l, &s->listeners, link) {
    if (open) evconnlistener_enable(l->handle);
    else evconnlistener_disable(l->handle);
  }
}

void listeners_close(server *s) {
  listener *l;
  while ((l = TAILQ_FIRST(&s->listeners))) {
    TAILQ_REMOVE(&s->listeners, l, link);
    evconnlistener_free(l->handle);
    if (l->path) unlink(l->path);
    free(l->path);
    free(l);
  }
}
