// SPDX-License-Identifier: Apache-2.0
/* config_parts.h: what config.c and options.c share. */
#ifndef TETRAD_DAEMON_CONFIG_PARTS_H
#define TETRAD_DAEMON_CONFIG_PARTS_H

#include "server/daemon/config.h"

enum { CONFIG_WORKERS_MAX = 1024 };

/* Writes a sentence into `error`; always false. */
__attribute__((format(printf, 2, 3))) bool config_fail(char error[CONFIG_ERROR],
                                                       const char *format, ...);

bool string_list_add(string_list *list, const char *item);
bool config_set_text(char **member, const char *value);
bool config_set_mode(config *cfg, const char *octal);
bool config_add_token(config *cfg, const char *name, const char *secret);

/* A file of lines "NAME SECRET"; empty lines and those that begin with # are skipped. */
bool config_read_tokens(config *cfg, const char *path);

#endif
