// SPDX-License-Identifier: Apache-2.0
// The regression driver of the fuzz targets: runs one target on every file of the
// given folders (and on no bytes at all), then on a fixed number of mutations of
// each, drawn from a generator whose seed is the file's bytes.  It is what builds without
// libFuzzer run; it does not search for coverage.
//
//   replay [-mutations=N] FOLDER...

#include <dirent.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { GROWTH = 64 };  // a mutation lengthens its input by less than this

static uint64_t next_random(uint64_t *state) {
  uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

// Runs the target on an exact-size copy, so that a read past the end is one past the block.
static void run_once(const uint8_t *data, size_t size) {
  uint8_t *copy = calloc(size > 0 ? size : 1, 1);
  if (copy == NULL) {
    perror("replay");
    exit(2);
  }
  if (size > 0) {
    memcpy(copy, data, size);
  }
  (void)LLVMFuzzerTestOneInput(copy, size);
  free(copy);
}

// Changes a few places of data, which holds size bytes and has room for GROWTH more;
// returns the new size.
static size_t mutate(uint8_t *data, size_t size, uint64_t *state) {
  static const uint8_t telling[] = {0, 1, 0x7f, 0x80, 0xff, ' ', '\n', '-', '0', '9', '"', '{', '['};
  const unsigned changes = 1 + (unsigned)(next_random(state) % 4);
  for (unsigned i = 0; i < changes && size > 0; ++i) {
    const size_t at = (size_t)(next_random(state) % size);
    switch (next_random(state) % 5) {
    case 0: data[at] ^= (uint8_t)(1U << (next_random(state) % 8)); break;
    case 1: data[at] = telling[next_random(state) % sizeof telling]; break;
    case 2: size = at; break;
    case 3: {
      const size_t n = 1 + (size_t)(next_random(state) % (GROWTH / 4 - 1));
      memmove(data + at + n, data + at, size - at);
      size += n;
      break;
    }
    default: {
      const size_t from = (size_t)(next_random(state) % size);
      const size_t longest = size - (from > at ? from : at);
      memmove(data + at, data + from, (size_t)(next_random(state) % (longest + 1)));
      break;
    }
    }
  }
  return size;
}

static uint8_t *read_whole(const char *path, size_t *ret_size) {
  FILE *f = fopen(path, "rb");
  if (f == NULL || fseek(f, 0, SEEK_END) != 0) {
    perror(path);
    exit(2);
  }
  const long size = ftell(f);
  if (size < 0 || fseek(f, 0, SEEK_SET) != 0) {
    perror(path);
    exit(2);
  }
  uint8_t *data = malloc((size_t)size + 1);
  if (data == NULL || fread(data, 1, (size_t)size, f) != (size_t)size) {
    perror(path);
    exit(2);
  }
  fclose(f);
  *ret_size = (size_t)size;
  return data;
}

static void replay_file(const char *path, unsigned long mutations) {
  size_t size = 0;
  uint8_t *data = read_whole(path, &size);
  fprintf(stderr, "%s: %zu bytes\n", path, size);
  run_once(data, size);

  uint64_t state = size;
  for (size_t i = 0; i < size; ++i) {
    state = state * UINT64_C(1099511628211) ^ data[i];
  }
  uint8_t *changed = malloc(size + GROWTH);
  if (changed == NULL) {
    perror("replay");
    exit(2);
  }
  for (unsigned long i = 0; i < mutations; ++i) {
    memcpy(changed, data, size);
    run_once(changed, mutate(changed, size, &state));
  }
  free(changed);
  free(data);
}

static int visible(const struct dirent *entry) {
  return entry->d_name[0] != '.';
}

static unsigned long replay_folder(const char *folder, unsigned long mutations) {
  struct dirent **entries = NULL;
  const int n = scandir(folder, &entries, visible, alphasort);
  if (n < 0) {
    perror(folder);
    exit(2);
  }
  for (int i = 0; i < n; ++i) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
    replay_file(path, mutations);
    free(entries[i]);
  }
  free(entries);
  return (unsigned long)n;
}

int main(int argc, char **argv) {
  unsigned long mutations = 0, files = 0;
  run_once(NULL, 0);
  for (int i = 1; i < argc; ++i) {
    if (strncmp(argv[i], "-mutations=", 11) == 0) {
      mutations = strtoul(argv[i] + 11, NULL, 10);
    } else {
      files += replay_folder(argv[i], mutations);
    }
  }
  if (files == 0) {
    fprintf(stderr, "replay: no seeds\n");
    return 2;
  }
  printf("%lu seeds, %lu mutations of each\n", files, mutations);
  return 0;
}
