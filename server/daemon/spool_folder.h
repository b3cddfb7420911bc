// SPDX-License-Identifier: Apache-2.0
/* spool_folder.h: the daemon's private folder, and what killed daemons left.
 *
 * The folder `tetrad-XXXXXX` holds the file `lock`, which its daemon keeps locked:
 * a folder of ours whose lock is free belongs to nobody and is removed. */
#ifndef TETRAD_DAEMON_SPOOL_FOLDER_H
#define TETRAD_DAEMON_SPOOL_FOLDER_H

#include <stdbool.h>
#include <stdint.h>

enum { SPOOL_NAME = 32 };

typedef struct spool_folder {
  char *path;
  int fd;   /* of the folder */
  int lock; /* of its lock file */
} spool_folder;

/* Removes what is left over in `parent`, then makes a folder. Errors: false, errno. */
bool spool_folder_create(spool_folder *folder, const char *parent);

/* Removes it with everything in it. */
void spool_folder_remove(spool_folder *folder);

/* The name of file `number`. */
void spool_name(uint64_t number, char name[SPOOL_NAME]);

#endif
