// SPDX-License-Identifier: Apache-2.0
/* main.c: tetrad-worker, the program that meshes: one job at a time, told on fd 0 and
 * answered on fd 1. Started by the daemon; of no use by hand. */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/log.h"
#include "server/worker/channel.h"
#include "server/worker/run.h"

int main(int argc, char **argv) {
  if (argc == 2 && !strcmp(argv[1], "--version")) {
    puts("tetrad-worker " TETRAD_VERSION);
    return 0;
  }
  if (argc > 1) {
    fputs("Usage: tetrad-worker\nStarted by tetrad; speaks the worker protocol on fd 0 and 1.\n",
          stderr);
    return 2;
  }
  signal(SIGPIPE, SIG_IGN);
  channel *ch = channel_create();
  if (!ch) {
    LOG(LOG_ERROR, "worker not started", log_text("error", "no memory or no thread"));
    return 1;
  }
  channel_send(ch, "worker.ready",
               json_pack("{s:i, s:s, s:i}", "protocol", 1, "version", TETRAD_VERSION, "pid",
                         (int)getpid()),
               NULL, 0);
  for (;;) { /* until fd 0 ends */
    task *t = channel_next(ch);
    answer a = run_task(ch, t);
    channel_done(ch, a.method, a.params);
  }
}
