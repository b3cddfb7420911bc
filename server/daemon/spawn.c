// SPDX-License-Identifier: Apache-2.0
/* spawn.c: see spawn.h. */
#include "server/daemon/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

/* In the child: async-signal-safe calls only, for the daemon has threads. */
static void child(char *const *argv, int fd, uint64_t data_limit) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  for (int s = 1; s < NSIG; s++)
    if (s != SIGKILL && s != SIGSTOP) signal(s, SIG_DFL);
  setpgid(0, 0);
  int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0 && write(score, "1000", 4) < 0) close(score); /* not vital */
  if (dup2(fd, 0) < 0 || dup2(fd, 1) < 0) _exit(126);
  close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  if (data_limit && !SANITIZED) {
    struct rlimit limit = {data_limit, data_limit};
    setrlimit(RLIMIT_DATA, &limit);
  }
  execvp(argv[0], argv);
  _exit(127);
}

bool spawn_worker(const char *program, char *const *prefix, uint64_t data_limit,
                  spawned *ret_spawned) {
  size_t n = 0;
  while (prefix && prefix[n]) n++;
  char **argv = calloc(n + 2, sizeof *argv);
  if (!argv) return false;
  for (size_t i = 0; i < n; i++) argv[i] = prefix[i];
  char *copy = strdup(program);
  argv[n] = copy;
  int pair[2] = {-1, -1};
  pid_t pid = -1;
  if (copy && !socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair)) {
    pid = fork();
    if (pid == 0) child(argv, pair[1], data_limit);
  }
  int saved = errno;
  free(copy);
  free(argv);
  if (pair[1] >= 0) close(pair[1]);
  if (pid < 0) {
    if (pair[0] >= 0) close(pair[0]);
    errno = saved;
    return false;
  }
  setpgid(pid, pid); /* both do it: whoever comes first */
  int pidfd = pidfd_open(pid, 0);
  if (pidfd < 0 || fcntl(pair[0], F_SETFL, O_NONBLOCK) < 0) {
    saved = errno;
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
    if (pidfd >= 0) close(pidfd);
    close(pair[0]);
    errno = saved;
    return false;
  }
  *ret_spawned = (spawned){pid, pidfd, pair[0]};
  return true;
}

void spawn_kill(const spawned *process) { kill(-process->pid, SIGKILL); }

ended spawn_reap(const spawned *process) {
  siginfo_t info = {0};
  /* Not reaped yet, the number is still its own: only its group can be hit. */
  spawn_kill(process);
  if (waitid(P_PIDFD, (id_t)process->pidfd, &info, WEXITED)) return (ended){-1, 0};
  if (info.si_code == CLD_EXITED) return (ended){info.si_status, 0};
  return (ended){0, info.si_status};
}

static char *join_if_runs(const char *folder, size_t size, const char *name) {
  char *path = malloc(size + strlen(name) + 2);
  if (!path) return NULL;
  sprintf(path, "%.*s/%s", (int)size, folder, name);
  if (!access(path, X_OK)) return path;
  free(path);
  return NULL;
}

char *spawn_find(const char *name, const char *libexec) {
  const char *folders = getenv("TETRAD_EXEC_PATH");
  char *found = NULL;
  while (folders && *folders && !found) {
    size_t size = strcspn(folders, ":");
    if (size) found = join_if_runs(folders, size, name);
    folders += size + (folders[size] == ':');
  }
  char self[PATH_MAX];
  ssize_t n = found ? -1 : readlink("/proc/self/exe", self, sizeof self - 1);
  if (n > 0) {
    self[n] = '\0';
    char *slash = strrchr(self, '/');
    if (slash) found = join_if_runs(self, (size_t)(slash - self), name);
  }
  return found ? found : join_if_runs(libexec, strlen(libexec), name);
}
