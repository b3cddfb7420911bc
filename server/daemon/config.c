// SPDX-License-Identifier: Apache-2.0
/* config.c: the configuration file, defaults, and what must fit together.
 * Options of the command line are options.c. */
#include "server/daemon/config.h"

#include <errno.h>
#include <jansson.h>
#include <sched.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "protocol/options.h"
#include "server/daemon/config_parts.h"
#include "server/daemon/limits.h"

static const uint64_t mib = UINT64_C(1) << 20;

typedef struct limit_row {
  const char *name;
  size_t offset;
  uint64_t least, most;
} limit_row;

#define LIMIT(member, least, most) {#member, offsetof(config_limits, member), least, most}
static const limit_row limit_rows[] = {
    LIMIT(max_body, 1024, UINT64_C(1) << 53),
    LIMIT(upload_bytes, 65536, UINT64_C(1) << 53),
    LIMIT(max_decoded_bytes, 1024, UINT64_C(1) << 53),
    LIMIT(max_requests, 1, 10000),
    LIMIT(max_connections, 1, 100000),
    LIMIT(max_jobs, 1, 10000000),
    LIMIT(result_bytes, 1, UINT64_C(1) << 53),
    LIMIT(result_ttl_ms, 1, UINT64_C(1) << 53),
    LIMIT(stall_ms, 100, UINT64_C(1) << 53),
    LIMIT(threads, 1, TP_MAX_THREADS),
    LIMIT(memory_bytes, 1, UINT64_C(1) << 53),
    LIMIT(worker_memory_bytes, 0, UINT64_C(1) << 53),
};

bool config_fail(char error[CONFIG_ERROR], const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(error, CONFIG_ERROR, format, args);
  va_end(args);
  return false;
}

bool string_list_add(string_list *list, const char *item) {
  char **items = realloc(list->items, (list->count + 2) * sizeof *items);
  if (!items) return false;
  list->items = items;
  items[list->count] = strdup(item);
  if (!items[list->count]) return false;
  items[++list->count] = NULL;
  return true;
}

static void string_list_free(string_list *list) {
  for (size_t i = 0; i < list->count; i++) free(list->items[i]);
  free(list->items);
  *list = (string_list){NULL, 0};
}

bool config_set_text(char **member, const char *value) {
  char *copy = strdup(value);
  if (!copy) return false;
  free(*member);
  *member = copy;
  return true;
}

bool config_add_token(config *cfg, const char *name, const char *secret) {
  config_token *tokens = realloc(cfg->tokens, (cfg->n_tokens + 1) * sizeof *tokens);
  if (!tokens) return false;
  cfg->tokens = tokens;
  config_token *token = &tokens[cfg->n_tokens];
  token->name = strdup(name);
  token->secret = strdup(secret);
  if (!token->name || !token->secret) {
    free(token->name);
    free(token->secret);
    return false;
  }
  cfg->n_tokens++;
  return true;
}

void config_init(config *cfg) {
  *cfg = (config){
      .unix_mode = 0600,
      .inherit_fd = -1,
      .limits = {.max_body = 256 * mib,
                 .upload_bytes = 512 * mib,
                 .max_decoded_bytes = 1024 * mib,
                 .max_requests = 64,
                 .max_connections = 1000,
                 .max_jobs = 10000,
                 .result_bytes = 8192 * mib,
                 .result_ttl_ms = 3600000,
                 .stall_ms = 30000,
                 .threads = 0,
                 .memory_bytes = 0,
                 .worker_memory_bytes = UINT64_MAX},
  };
}

void config_free(config *cfg) {
  string_list_free(&cfg->unix_paths);
  string_list_free(&cfg->tcp);
  string_list_free(&cfg->worker_prefix);
  for (size_t i = 0; i < cfg->n_tokens; i++) {
    free(cfg->tokens[i].name);
    free(cfg->tokens[i].secret);
  }
  free(cfg->tokens);
  free(cfg->instance);
  free(cfg->spool);
}

/* ---- the file ---- */

static bool read_list(string_list *list, const json_t *value) {
  if (!json_is_array(value)) return false;
  for (size_t i = 0; i < json_array_size(value); i++) {
    const char *item = json_string_value(json_array_get(value, i));
    if (!item || !string_list_add(list, item)) return false;
  }
  return true;
}

static bool read_limits(config *cfg, const json_t *value, char error[CONFIG_ERROR]) {
  const char *name;
  json_t *item;
  if (!json_is_object(value)) return config_fail(error, "limits is no object");
  json_object_foreach((json_t *)(uintptr_t)value, name, item) {
    const limit_row *row = NULL;
    for (size_t i = 0; i < sizeof limit_rows / sizeof *limit_rows; i++)
      if (!strcmp(limit_rows[i].name, name)) row = &limit_rows[i];
    if (!row) return config_fail(error, "limits: unknown member \"%s\"", name);
    json_int_t number = json_integer_value(item);
    if (!json_is_integer(item) || number < 0 || (uint64_t)number < row->least ||
        (uint64_t)number > row->most)
      return config_fail(error, "limits.%s is no integer within its range", name);
    uint64_t limit = (uint64_t)number;
    memcpy((char *)&cfg->limits + row->offset, &limit, sizeof limit);
  }
  return true;
}

static bool read_tokens(config *cfg, const json_t *value) {
  const char *name;
  json_t *secret;
  if (!json_is_object(value)) return false;
  json_object_foreach((json_t *)(uintptr_t)value, name, secret) {
    const char *text = json_string_value(secret);
    if (!*name || !text || !*text || !config_add_token(cfg, name, text)) return false;
  }
  return true;
}

/* Sets *ret_ok; returns false if there is no such member. */
static bool read_member(config *cfg, const char *name, const json_t *value, bool *ret_ok) {
  const char *text = json_string_value(value);
  if (!strcmp(name, "unix")) *ret_ok = read_list(&cfg->unix_paths, value);
  else if (!strcmp(name, "tcp")) *ret_ok = read_list(&cfg->tcp, value);
  else if (!strcmp(name, "worker_prefix")) *ret_ok = read_list(&cfg->worker_prefix, value);
  else if (!strcmp(name, "tokens")) *ret_ok = read_tokens(cfg, value);
  else if (!strcmp(name, "token_file")) *ret_ok = text && config_read_tokens(cfg, text);
  else if (!strcmp(name, "instance")) *ret_ok = text && config_set_text(&cfg->instance, text);
  else if (!strcmp(name, "spool")) *ret_ok = text && config_set_text(&cfg->spool, text);
  else if (!strcmp(name, "unix_mode")) *ret_ok = text && config_set_mode(cfg, text);
  else if (!strcmp(name, "workers")) {
    json_int_t n = json_integer_value(value);
    *ret_ok = json_is_integer(value) && n >= 1 && n <= CONFIG_WORKERS_MAX;
    if (*ret_ok) cfg->workers = (unsigned)n;
  } else {
    return false;
  }
  return true;
}

bool config_read_text(config *cfg, const char *text, size_t size, const char *file,
                      char error[CONFIG_ERROR]) {
  json_error_t fault;
  json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &fault);
  if (!root)
    return config_fail(error, "%s:%d:%d: %s", file, fault.line, fault.column, fault.text);
  bool ok = json_is_object(root);
  if (!ok) config_fail(error, "%s: not a JSON object", file);
  const char *name;
  json_t *value;
  if (ok) {
    json_object_foreach(root, name, value) {
      bool good = true;
      if (!strcmp(name, "limits")) {
        ok = read_limits(cfg, value, error);
      } else if (!read_member(cfg, name, value, &good)) {
        ok = config_fail(error, "%s: unknown member \"%s\"", file, name);
      } else if (!good) {
        ok = config_fail(error, "%s: bad value of \"%s\"", file, name);
      }
      if (!ok) break;
    }
  }
  json_decref(root);
  return ok;
}

bool config_read_file(config *cfg, const char *path, char error[CONFIG_ERROR]) {
  enum { FILE_MAX = 1 << 20 };
  FILE *file = fopen(path, "re");
  if (!file) return config_fail(error, "%s: %s", path, strerror(errno));
  char *text = malloc(FILE_MAX);
  size_t size = text ? fread(text, 1, FILE_MAX, file) : 0;
  bool ok = text && !ferror(file) && size < FILE_MAX;
  fclose(file);
  if (!ok) config_fail(error, "%s: cannot be read, or is over 1 MiB", path);
  else ok = config_read_text(cfg, text, size, path, error);
  free(text);
  return ok;
}

/* ---- what was left open ---- */

static bool valid_instance(const char *name) {
  size_t size = strlen(name);
  return size >= 1 && size <= INSTANCE_MAX &&
         strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-") == size;
}

/* A fresh name, so that ids of an earlier run are known as another's. */
static bool random_instance(char **ret_name) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyz234567";
  unsigned char bytes[8];
  char name[sizeof bytes + 1] = {0};
  if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes) return false;
  for (size_t i = 0; i < sizeof bytes; i++) name[i] = letters[bytes[i] & 31];
  return config_set_text(ret_name, name);
}

static uint64_t physical_memory(void) {
  long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : UINT64_C(4) << 30;
}

static unsigned processors(void) {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set)) return 1;
  int n = CPU_COUNT(&set);
  return n < 1 ? 1 : n > CONFIG_WORKERS_MAX ? CONFIG_WORKERS_MAX : (unsigned)n;
}

/* The loopback names; anything else is open to others. */
static bool loopback(const char *address) {
  return !strncmp(address, "127.", 4) || !strncmp(address, "localhost:", 10) ||
         !strncmp(address, "[::1]:", 6);
}

bool config_finish(config *cfg, char error[CONFIG_ERROR]) {
  config_limits *limits = &cfg->limits;
  size_t n_listeners = cfg->unix_paths.count + cfg->tcp.count;
  if (cfg->inherit_fd >= 0 && n_listeners)
    return config_fail(error, "--inherit serves one connection: no --unix or --tcp with it");
  if (cfg->inherit_fd < 0 && !n_listeners)
    return config_fail(error, "nothing to listen on: give --unix, --tcp or --inherit");
  for (size_t i = 0; i < cfg->tcp.count && !cfg->n_tokens; i++)
    if (!loopback(cfg->tcp.items[i]))
      return config_fail(error, "--tcp %s is beyond the loopback: that needs tokens",
                         cfg->tcp.items[i]);
  if (cfg->instance && !valid_instance(cfg->instance))
    return config_fail(error, "instance \"%s\" is not 1 to 32 of [a-z0-9-]", cfg->instance);
  if (!cfg->instance && !random_instance(&cfg->instance))
    return config_fail(error, "no name for the instance: %s", strerror(errno));
  if (!cfg->spool) {
    const char *folder = getenv("TMPDIR");
    if (!config_set_text(&cfg->spool, folder && *folder ? folder : "/tmp"))
      return config_fail(error, "no memory");
  }
  if (!cfg->workers) cfg->workers = cfg->inherit_fd >= 0 ? 1 : processors();
  if (!limits->threads) {
    limits->threads = processors() / cfg->workers;
    if (limits->threads < 1) limits->threads = 1;
    if (limits->threads > TP_MAX_THREADS) limits->threads = TP_MAX_THREADS;
  }
  uint64_t physical = physical_memory();
  if (limits->worker_memory_bytes == UINT64_MAX) limits->worker_memory_bytes = physical / 8 * 7;
  if (!limits->memory_bytes) {
    uint64_t whole = limits->worker_memory_bytes ? limits->worker_memory_bytes : physical;
    limits->memory_bytes = whole - whole / 4; /* never 0, which is no limit */
  }
  if (limits->max_body > limits->upload_bytes) limits->max_body = limits->upload_bytes;
  return true;
}
