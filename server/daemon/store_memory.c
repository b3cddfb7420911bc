// SPDX-License-Identifier: Apache-2.0
/* store_memory.c: the job store in memory: two chained hash tables and a list.
 * Nothing of it outlives the daemon. */
#include "server/daemon/store.h"

#include <stdlib.h>
#include <string.h>

typedef struct table {
  job **heads;
  size_t size; /* a power of two */
} table;

struct store {
  store_free_fn free_job;
  table ids, keys;
  job *first, *last;
  size_t count;
};

enum { FIRST_SIZE = 256 };

static uint64_t hash_text(uint64_t hash, const char *text) {
  for (; *text; text++) hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
  return (hash ^ 0xff) * UINT64_C(0x100000001b3); /* ends the text: "ab","c" is not "a","bc" */
}

static const uint64_t seed = UINT64_C(0xcbf29ce484222325);

static uint64_t hash_id(const char *id) { return hash_text(seed, id); }
static uint64_t hash_key(const char *principal, const char *key) {
  return hash_text(hash_text(seed, principal), key);
}

static job **head_of(const table *t, uint64_t hash) {
  return &t->heads[(hash ^ hash >> 32) & (t->size - 1)];
}

static void link_id(const table *ids, job *j) {
  job **head = head_of(ids, hash_id(j->id));
  j->next_by_id = *head;
  *head = j;
}

static void link_key(const table *keys, job *j) {
  if (!j->key) return;
  job **head = head_of(keys, hash_key(j->principal, j->key));
  j->next_by_key = *head;
  *head = j;
}

/* Rebuilds both tables at `size`; false leaves them as they are. */
static bool resize(store *s, size_t size) {
  job **ids = calloc(size, sizeof *ids), **keys = calloc(size, sizeof *keys);
  if (!ids || !keys) {
    free(ids);
    free(keys);
    return false;
  }
  free(s->ids.heads);
  free(s->keys.heads);
  s->ids = (table){ids, size};
  s->keys = (table){keys, size};
  for (job *j = s->first; j; j = j->after) {
    link_id(&s->ids, j);
    link_key(&s->keys, j);
  }
  return true;
}

store *store_create(store_free_fn free_job) {
  store *s = calloc(1, sizeof *s);
  if (!s) return NULL;
  s->free_job = free_job;
  if (resize(s, FIRST_SIZE)) return s;
  free(s);
  return NULL;
}

void store_free(store *s) {
  if (!s) return;
  while (s->first) store_remove(s, s->first);
  free(s->ids.heads);
  free(s->keys.heads);
  free(s);
}

void store_insert(store *s, job *j) {
  /* Tables that cannot grow still work, slower. */
  if (s->count >= s->ids.size) (void)resize(s, s->ids.size * 2);
  j->before = s->last;
  j->after = NULL;
  if (s->last) s->last->after = j;
  else s->first = j;
  s->last = j;
  s->count++;
  link_id(&s->ids, j);
  link_key(&s->keys, j);
}

job *store_find(const store *s, const char *id) {
  job *j = *head_of(&s->ids, hash_id(id));
  while (j && strcmp(j->id, id)) j = j->next_by_id;
  return j;
}

job *store_find_key(const store *s, const char *principal, const char *key) {
  job *j = *head_of(&s->keys, hash_key(principal, key));
  while (j && (strcmp(j->key, key) || strcmp(j->principal, principal))) j = j->next_by_key;
  return j;
}

job *store_first(const store *s) { return s->first; }
job *store_next(const job *j) { return j->after; }
size_t store_count(const store *s) { return s->count; }

void store_remove(store *s, job *j) {
  job **at = head_of(&s->ids, hash_id(j->id));
  while (*at != j) at = &(*at)->next_by_id;
  *at = j->next_by_id;
  if (j->key) {
    at = head_of(&s->keys, hash_key(j->principal, j->key));
    while (*at != j) at = &(*at)->next_by_key;
    *at = j->next_by_key;
  }
  if (j->before) j->before->after = j->after;
  else s->first = j->after;
  if (j->after) j->after->before = j->before;
  else s->last = j->before;
  s->count--;
  s->free_job(j);
}
