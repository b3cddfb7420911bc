// SPDX-License-Identifier: Apache-2.0
/* threads.c: see the header. Threads live as long as their piece of work: what they are used for
 * takes far longer than to start them. */
#include "base/threads.h"

#include <pthread.h>

typedef struct task {
  void (*work)(void *arg, uint32_t i);
  void *arg;
  uint32_t i;
  int started;
  pthread_t thread;
} task;

static void *start(void *arg) {
  task *t = arg;
  t->work(t->arg, t->i);
  return NULL;
}

enum { MOST = 256 };

void tet_run_threads(uint32_t n, void (*work)(void *arg, uint32_t i), void *arg) {
  task tasks[MOST];
  for (uint32_t i = 1; i < n && i < MOST; i++) {
    tasks[i] = (task){.work = work, .arg = arg, .i = i};
    tasks[i].started = pthread_create(&tasks[i].thread, NULL, start, &tasks[i]) == 0;
  }
  if (n) work(arg, 0);
  for (uint32_t i = 1; i < n; i++) {
    if (i < MOST && tasks[i].started) pthread_join(tasks[i].thread, NULL);
    else work(arg, i);
  }
}
