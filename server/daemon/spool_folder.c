// SPDX-License-Identifier: Apache-2.0
/* spool_folder.c: see spool_folder.h. */
#include "server/daemon/spool_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char prefix[] = "tetrad-";

void spool_name(uint64_t number, char name[SPOOL_NAME]) {
  snprintf(name, SPOOL_NAME, "%" PRIu64, number);
}

/* Removes the files of an open folder (there are no folders in it) and itself.
 * The lock goes last: until then nobody else takes the folder for left over. */
static void empty_and_remove(int fd, const char *path) {
  DIR *folder = fdopendir(dup(fd));
  const struct dirent *entry;
  while (folder && (entry = readdir(folder)))
    if (entry->d_name[0] != '.' && strcmp(entry->d_name, "lock")) unlinkat(fd, entry->d_name, 0);
  if (folder) closedir(folder);
  unlinkat(fd, "lock", 0);
  rmdir(path);
}

static void remove_if_left(const char *parent, const char *name) {
  char path[4096];
  struct stat info;
  if ((size_t)snprintf(path, sizeof path, "%s/%s", parent, name) >= sizeof path) return;
  int fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) return;
  if (!fstat(fd, &info) && info.st_uid == geteuid()) {
    int lock = openat(fd, "lock", O_RDWR | O_NOFOLLOW | O_CLOEXEC);
    if (lock >= 0) {
      if (!flock(lock, LOCK_EX | LOCK_NB)) empty_and_remove(fd, path);
      close(lock);
    }
  }
  close(fd);
}

static void remove_left(const char *parent) {
  DIR *folder = opendir(parent);
  const struct dirent *entry;
  while (folder && (entry = readdir(folder)))
    if (!strncmp(entry->d_name, prefix, sizeof prefix - 1) &&
        strlen(entry->d_name) == sizeof prefix - 1 + 6)
      remove_if_left(parent, entry->d_name);
  if (folder) closedir(folder);
}

bool spool_folder_create(spool_folder *folder, const char *parent) {
  *folder = (spool_folder){NULL, -1, -1};
  remove_left(parent);
  size_t size = strlen(parent) + sizeof prefix + 8;
  folder->path = malloc(size);
  if (!folder->path) return false;
  snprintf(folder->path, size, "%s/%sXXXXXX", parent, prefix);
  if (!mkdtemp(folder->path)) goto fail;
  folder->fd = open(folder->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder->fd < 0) goto fail_made;
  /* Locked before it has its name: a lock file that is seen is a locked one. */
  folder->lock = openat(folder->fd, ".lock", O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (folder->lock < 0 || flock(folder->lock, LOCK_EX | LOCK_NB) ||
      renameat(folder->fd, ".lock", folder->fd, "lock"))
    goto fail_made;
  return true;

fail_made:;
  int saved = errno;
  if (folder->fd >= 0) {
    unlinkat(folder->fd, ".lock", 0);
    close(folder->fd);
  }
  if (folder->lock >= 0) close(folder->lock);
  rmdir(folder->path);
  errno = saved;
fail:
  free(folder->path);
  folder->path = NULL;
  return false;
}

void spool_folder_remove(spool_folder *folder) {
  empty_and_remove(folder->fd, folder->path);
  close(folder->fd);
  close(folder->lock);
  free(folder->path);
}
