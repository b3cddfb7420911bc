// SPDX-License-Identifier: Apache-2.0
/* spawn.h: starting a worker process, and finding its program.
 *
 * A worker shares nothing with the daemon but fd 0 and 1 (one end of a socketpair)
 * and standard error. It leads a process group of its own, is the kernel's first
 * choice when memory runs out, and has RLIMIT_DATA (not in sanitized builds). */
#ifndef TETRAD_DAEMON_SPAWN_H
#define TETRAD_DAEMON_SPAWN_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct spawned {
  pid_t pid;
  int pidfd;  /* readable when it has ended */
  int socket; /* non-blocking; the other end is its fd 0 and 1 */
} spawned;

/* Starts `program` with the command `prefix` (NULL-terminated; NULL: none) before it.
 * `data_limit`: RLIMIT_DATA in bytes, 0: none. Errors: false, errno. */
bool spawn_worker(const char *program, char *const *prefix, uint64_t data_limit,
                  spawned *ret_spawned);

/* How a process ended. */
typedef struct ended {
  int status; /* exit status, if signal is 0 */
  int signal;
} ended;

/* Kills what is there of its group, and reaps it. Waits for its end, which is then near. */
ended spawn_reap(const spawned *process);

/* Kills the process group. */
void spawn_kill(const spawned *process);

/* Looks for an installed program: in $TETRAD_EXEC_PATH, beside the running
 * executable, in `libexec`. The caller frees; NULL if there is none. */
char *spawn_find(const char *name, const char *libexec);

#endif
