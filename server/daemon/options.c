// SPDX-License-Identifier: Apache-2.0
/* options.c: the command line, as config.h has it. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/daemon/config.h"
#include "server/daemon/config_parts.h"

const char *config_usage(void) {
  return "Usage: tetrad [OPTION]...\n"
         "The tetrahedral meshing daemon.\n\n"
         "  --unix PATH          listen on a Unix socket (repeatable)\n"
         "  --tcp HOST:PORT      listen on TCP (repeatable); beyond the loopback only with tokens\n"
         "  --inherit FD         serve this connected socket alone; its end ends the daemon\n"
         "  --workers N          worker processes (default: one per processor; 1 with --inherit)\n"
         "  --config FILE        JSON; options given here come after it\n"
         "  --spool DIR          parent folder of the results' spool (default: $TMPDIR or /tmp)\n"
         "  --instance NAME      first part of job ids (default: a random name)\n"
         "  --token-file FILE    lines NAME SECRET; a TCP client proves itself with a SECRET\n"
         "  --unix-mode OCTAL    mode of the Unix sockets (default: 0600)\n"
         "  --worker-prefix CMD  run each worker by this command (repeatable: its arguments)\n"
         "  --version, --help\n\n"
         "SIGTERM or SIGINT drains: accepted jobs end first; a second one ends at once.\n";
}

bool config_set_mode(config *cfg, const char *octal) {
  char *end;
  unsigned long mode = strtoul(octal, &end, 8);
  if (!*octal || *end || mode > 0777) return false;
  cfg->unix_mode = (mode_t)mode;
  return true;
}

bool config_read_tokens(config *cfg, const char *path) {
  FILE *file = fopen(path, "re");
  if (!file) return false;
  char line[1024];
  bool ok = true;
  while (ok && fgets(line, sizeof line, file)) {
    char *rest, *name = strtok_r(line, " \t\r\n", &rest);
    if (!name || *name == '#') continue;
    char *secret = strtok_r(NULL, " \t\r\n", &rest);
    ok = secret && !strtok_r(NULL, " \t\r\n", &rest) && config_add_token(cfg, name, secret);
  }
  ok = ok && !ferror(file);
  fclose(file);
  return ok;
}

static bool read_number(const char *text, long least, long most, long *ret_number) {
  char *end;
  long number = strtol(text, &end, 10);
  if (!*text || *end || number < least || number > most) return false;
  *ret_number = number;
  return true;
}

static const struct option long_options[] = {
    {"unix", required_argument, NULL, 'u'},       {"tcp", required_argument, NULL, 't'},
    {"inherit", required_argument, NULL, 'i'},    {"workers", required_argument, NULL, 'w'},
    {"config", required_argument, NULL, 'c'},     {"spool", required_argument, NULL, 's'},
    {"instance", required_argument, NULL, 'n'},   {"token-file", required_argument, NULL, 'k'},
    {"unix-mode", required_argument, NULL, 'm'},  {"worker-prefix", required_argument, NULL, 'p'},
    {"version", no_argument, NULL, 'V'},          {"help", no_argument, NULL, 'h'},
    {NULL, 0, NULL, 0}};

static bool apply_option(config *cfg, int option, const char *value) {
  long number = 0;
  switch (option) {
  case 'u': return string_list_add(&cfg->unix_paths, value);
  case 't': return string_list_add(&cfg->tcp, value);
  case 'p': return string_list_add(&cfg->worker_prefix, value);
  case 's': return *value && config_set_text(&cfg->spool, value);
  case 'n': return config_set_text(&cfg->instance, value);
  case 'k': return config_read_tokens(cfg, value);
  case 'm': return config_set_mode(cfg, value);
  case 'i':
    if (!read_number(value, 0, 1 << 20, &number)) return false;
    cfg->inherit_fd = (int)number;
    return true;
  case 'w':
    if (!read_number(value, 1, CONFIG_WORKERS_MAX, &number)) return false;
    cfg->workers = (unsigned)number;
    return true;
  default: return true; /* config, version, help: done in the first pass */
  }
}

static const char *option_name(int option) {
  for (const struct option *o = long_options; o->name; o++)
    if (o->val == option) return o->name;
  return "";
}

bool config_read_options(config *cfg, int argc, char **argv, char error[CONFIG_ERROR]) {
  int option;
  opterr = 0;
  /* First pass: --config, and what needs nothing else. */
  optind = 0;
  while ((option = getopt_long(argc, argv, ":", long_options, NULL)) != -1) {
    if (option == '?')
      return config_fail(error, "unknown option \"%s\"", argv[optind - 1]);
    if (option == ':')
      return config_fail(error, "option \"%s\" needs a value", argv[optind - 1]);
    if (option == 'h') cfg->help = true;
    if (option == 'V') cfg->version = true;
    if (option == 'c' && !config_read_file(cfg, optarg, error)) return false;
  }
  if (optind < argc) return config_fail(error, "unexpected argument \"%s\"", argv[optind]);
  if (cfg->help || cfg->version) return true;
  optind = 0;
  while ((option = getopt_long(argc, argv, ":", long_options, NULL)) != -1)
    if (!apply_option(cfg, option, optarg))
      return config_fail(error, "bad value \"%s\" of --%s", optarg, option_name(option));
  return true;
}
