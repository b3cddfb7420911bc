// SPDX-License-Identifier: Apache-2.0
/* main.c: tetrad, the daemon: its options, and what it expects of its process.
 * server.h is the map of the rest. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>

#include "server/daemon/server.h"

/* Missing standard descriptors would be taken by sockets and logged into. */
static void open_standard_descriptors(void) {
  for (int fd = 0; fd <= 2; fd++)
    if (fcntl(fd, F_GETFD) < 0) (void)!open("/dev/null", O_RDWR);
}

/* Connections and fetches need descriptors; the usual soft limit is for select(2). */
static void raise_descriptor_limit(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit)) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

int main(int argc, char **argv) {
  enum { USAGE = 2 };
  config cfg;
  char error[CONFIG_ERROR];
  int status = 0;
  open_standard_descriptors();
  raise_descriptor_limit();
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN); /* a full quota is an error of write */
  config_init(&cfg);
  if (!config_read_options(&cfg, argc, argv, error) ||
      (!cfg.help && !cfg.version && !config_finish(&cfg, error))) {
    fprintf(stderr, "tetrad: %s\n", error);
    status = USAGE;
  } else if (cfg.help) {
    fputs(config_usage(), stdout);
  } else if (cfg.version) {
    puts("tetrad " TETRAD_VERSION);
  } else {
    status = server_run(&cfg);
  }
  config_free(&cfg);
  return status;
}
