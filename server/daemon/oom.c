// SPDX-License-Identifier: Apache-2.0
/* oom.c: how often the system has killed for want of memory: in our cgroup where
 * there is one, else in the whole machine. Both are kernel counters, not files. */
#include <stdio.h>
#include <string.h>

#include "server/daemon/pool.h"

/* The number after `name` and a blank at the begin of a line. */
static bool read_counter(const char *path, const char *name, uint64_t *ret_count) {
  FILE *file = fopen(path, "re");
  char line[256];
  bool found = false;
  size_t size = strlen(name);
  while (file && !found && fgets(line, sizeof line, file)) {
    unsigned long long count;
    found = !strncmp(line, name, size) && sscanf(line + size, " %llu", &count) == 1;
    if (found) *ret_count = count;
  }
  if (file) fclose(file);
  return found;
}

static bool cgroup_counter(uint64_t *ret_count) {
  FILE *file = fopen("/proc/self/cgroup", "re");
  char line[1024], path[1280];
  bool found = false;
  while (file && !found && fgets(line, sizeof line, file)) {
    if (strncmp(line, "0::", 3)) continue;
    line[strcspn(line, "\n")] = '\0';
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.events", line + 3);
    found = read_counter(path, "oom_kill ", ret_count);
  }
  if (file) fclose(file);
  return found;
}

uint64_t oom_kill_count(void) {
  uint64_t count = 0;
  if (!cgroup_counter(&count)) read_counter("/proc/vmstat", "oom_kill ", &count);
  return count;
}
