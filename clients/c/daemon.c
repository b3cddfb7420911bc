// SPDX-License-Identifier: Apache-2.0
/* daemon.c: a private daemon on a socketpair: found, started, ended. The daemon ends at
 * the end of file on its socket, so also when this process is killed. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/c/client_internal.h"

extern char **environ;

enum { CHILD_FD = 3, END_MS = 5000, LOG_BYTES = 1 << 20, PATH_BYTES = 4096 };

static bool is_program(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && access(path, X_OK) == 0;
}

// Looks for FOLDER/tetrad; the folder need not end with 0.
static bool look_in(const char *folder, size_t length, char path[PATH_BYTES]) {
    const int n = snprintf(path, PATH_BYTES, "%.*s/tetrad", (int)length, folder);
    return length > 0 && n > 0 && n < PATH_BYTES && is_program(path);
}

static bool find_program(char path[PATH_BYTES]) {
    const char *folders = getenv("TETRAD_EXEC_PATH");
    while (folders != NULL && *folders != '\0') {
        const size_t length = strcspn(folders, ":");
        if (look_in(folders, length, path)) {
            return true;
        }
        folders += length + (folders[length] == ':');
    }
    char self[PATH_BYTES];
    const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    if (n > 0) {
        self[n] = '\0';
        const char *slash = strrchr(self, '/');
        if (slash != NULL && look_in(self, (size_t)(slash - self), path)) {
            return true;
        }
    }
    return look_in(TETRAD_BINDIR, strlen(TETRAD_BINDIR), path) ||
           look_in(TETRAD_LIBEXECDIR, strlen(TETRAD_LIBEXECDIR), path);
}

// In its own process group, so that a terminal's interrupt is this process's to handle.
static int spawn(const char *program, int fd, int log, pid_t *ret_pid) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    char number[16];
    snprintf(number, sizeof number, "%d", CHILD_FD);
    char name[] = "tetrad", option[] = "--inherit";
    char *const argv[] = {name, option, number, NULL};
    static const char null[] = "/dev/null";
    sigset_t none;
    sigemptyset(&none);
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed != 0) {
        return failed;
    }
    if ((failed = posix_spawnattr_init(&attributes)) != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return failed;
    }
    // The log first: where it is number 3, the socket's place, it has its own by then.
    failed = posix_spawn_file_actions_adddup2(&actions, log, STDERR_FILENO) != 0 ||
             posix_spawn_file_actions_adddup2(&actions, fd, CHILD_FD) != 0 ||
             posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, null, O_RDONLY, 0) != 0 ||
             posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, null, O_WRONLY, 0) != 0 ||
             posix_spawnattr_setpgroup(&attributes, 0) != 0 ||
             posix_spawnattr_setsigmask(&attributes, &none) != 0 ||
             posix_spawnattr_setflags(&attributes,
                                      POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK) != 0
                 ? ENOMEM
                 : posix_spawn(ret_pid, program, &actions, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

tetrad_status tc_daemon_start(tc_daemon *ret_daemon, int *ret_fd, tetrad_error *error) {
    char program[PATH_BYTES];
    int ends[2];
    pid_t pid;
    if (!find_program(program)) {
        return tc_fail(error, TETRAD_E_CONNECT,
                       "no daemon was named, and the program tetrad to start one is neither in "
                       "$TETRAD_EXEC_PATH nor beside this program nor in " TETRAD_BINDIR);
    }
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return tc_fail(error, TETRAD_E_CONNECT, "no socket: %s", strerror(errno));
    }
    const int log = memfd_create("tetrad log", MFD_CLOEXEC);
    if (log < 0 || fcntl(log, F_SETFL, O_APPEND) != 0) {
        const int reason = errno;
        close(ends[0]);
        close(ends[1]);
        if (log >= 0) {
            close(log);
        }
        return tc_fail(error, TETRAD_E_CONNECT, "no log: %s", strerror(reason));
    }
    const int failed = spawn(program, ends[1], log, &pid);
    close(ends[1]);
    const int pidfd = failed == 0 ? pidfd_open(pid, 0) : -1;
    if (failed != 0 || pidfd < 0) {
        const int reason = failed != 0 ? failed : errno;
        close(ends[0]);
        close(log);
        if (failed == 0) {
            kill(pid, SIGKILL);
            waitpid(pid, NULL, 0);
        }
        return tc_fail(error, TETRAD_E_CONNECT, "%s cannot be started: %s", program,
                       strerror(reason));
    }
    *ret_daemon = (tc_daemon){pidfd, log, pid};
    *ret_fd = ends[0];
    return TETRAD_OK;
}

void tc_daemon_end(tc_daemon *daemon) {
    if (daemon->pidfd < 0) {
        return;
    }
    struct pollfd end = {daemon->pidfd, POLLIN, 0};
    int ready;
    do {
        ready = poll(&end, 1, END_MS);
    } while (ready < 0 && errno == EINTR);
    if (ready <= 0) {
        pidfd_send_signal(daemon->pidfd, SIGKILL, NULL, 0);
    }
    siginfo_t info;
    while (waitid(P_PIDFD, (id_t)daemon->pidfd, &info, WEXITED) != 0 && errno == EINTR) {
    }
    close(daemon->pidfd);
    close(daemon->log);
    daemon->pidfd = -1;
}

void tc_daemon_trim_log(const tc_daemon *daemon) {
    struct stat status;
    if (daemon->pidfd >= 0 && fstat(daemon->log, &status) == 0 && status.st_size > LOG_BYTES) {
        // What it writes next goes to the new end. If this fails the log is only longer.
        (void)!ftruncate(daemon->log, 0);
    }
}

void tc_daemon_last_words(const tc_daemon *daemon, char *line, size_t size) {
    char tail[1024];
    struct stat status;
    line[0] = '\0';
    if (daemon->pidfd < 0 || fstat(daemon->log, &status) != 0) {
        return;
    }
    const off_t from = status.st_size > (off_t)sizeof tail - 1
                           ? status.st_size - (off_t)sizeof tail + 1
                           : 0;
    ssize_t n = pread(daemon->log, tail, sizeof tail - 1, from);
    while (n > 0 && tail[n - 1] == '\n') {
        n--;
    }
    if (n <= 0) {
        return;
    }
    tail[n] = '\0';
    const char *newline = strrchr(tail, '\n');
    snprintf(line, size, "%s", newline != NULL ? newline + 1 : tail);
}
