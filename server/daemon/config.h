// SPDX-License-Identifier: Apache-2.0
/* config.h: what the daemon was told, by options and a JSON file.
 *
 * The file's members are called as the options are; an option comes after the file
 * and replaces (lists: adds to) what it said. Unknown members and options are refused
 * by name. No defaults are looked up anywhere else. server/README.md tabulates all. */
#ifndef TETRAD_DAEMON_CONFIG_H
#define TETRAD_DAEMON_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct string_list {
  char **items; /* NULL-terminated, so that it serves as an argv */
  size_t count;
} string_list;

typedef struct config_token {
  char *name;
  char *secret;
} config_token;

typedef struct config_limits {
  uint64_t max_body;            /* bytes of one request's body */
  uint64_t upload_bytes;        /* bodies and parameters of all jobs not yet handed on */
  uint64_t max_decoded_bytes;   /* arrays of one upload, decoded */
  uint64_t max_requests;        /* open, per connection */
  uint64_t max_connections;
  uint64_t max_jobs;            /* in the store, finished ones included */
  uint64_t result_bytes;        /* in the spool */
  uint64_t result_ttl_ms;
  uint64_t stall_ms;
  uint64_t threads;             /* of one job, at most */
  uint64_t memory_bytes;        /* the engine's budget for one job */
  uint64_t worker_memory_bytes; /* RLIMIT_DATA of a worker; 0: none */
} config_limits;

typedef struct config {
  string_list unix_paths;
  string_list tcp;              /* "HOST:PORT" */
  string_list worker_prefix;    /* command that runs the worker program */
  config_token *tokens;
  size_t n_tokens;
  char *instance;               /* [a-z0-9-]{1,32} */
  char *spool;                  /* parent folder of the spool */
  mode_t unix_mode;
  int inherit_fd;               /* -1: none */
  unsigned workers;
  config_limits limits;
  bool help, version;           /* asked for; nothing else was looked at */
} config;

enum { CONFIG_ERROR = 256 };

/* Everything at its default: no listeners, 0 workers (chosen by config_finish). */
void config_init(config *cfg);
void config_free(config *cfg);

/* Reads a JSON file. On failure: false, a sentence in `error`. */
bool config_read_file(config *cfg, const char *path, char error[CONFIG_ERROR]);

/* The same on a text; `name` stands in messages. */
bool config_read_text(config *cfg, const char *text, size_t size, const char *name,
                      char error[CONFIG_ERROR]);

/* Reads argv, the file of --config first. */
bool config_read_options(config *cfg, int argc, char **argv, char error[CONFIG_ERROR]);

/* Fills what was left open and checks what belongs together. */
bool config_finish(config *cfg, char error[CONFIG_ERROR]);

/* Text for --help. */
const char *config_usage(void);

#endif
