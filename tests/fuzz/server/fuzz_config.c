// SPDX-License-Identifier: Apache-2.0
/* The configuration file: any bytes are read or refused by a sentence. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "server/daemon/config.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  config cfg;
  char error[CONFIG_ERROR] = "";
  config_init(&cfg);
  bool ok = config_read_text(&cfg, (const char *)data, size, "fuzz", error);
  if (ok) ok = config_finish(&cfg, error);
  if (!ok && !*error) abort();
  if (ok && (!cfg.workers || !cfg.instance || !cfg.spool || !cfg.limits.memory_bytes)) abort();
  config_free(&cfg);
  return 0;
}
