// SPDX-License-Identifier: Apache-2.0
/* output.c: files that are written beside their place and renamed together. It knows
 * nothing of what is written. */
#include "clients/formats/output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

tf_status tf_error_set(tf_error *error, tf_status status, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
        error->status = status;
        error->line = 0;
    }
    return status;
}

// The name stays in its folder, so that rename never crosses file systems.
static char *temporary_name(const char *path) {
    const size_t room = strlen(path) + 32;
    char *name = malloc(room);
    if (name != NULL) {
        snprintf(name, room, "%s.tmp-%ld", path, (long)getpid());
    }
    return name;
}

static tf_status create(const char *path, char **ret_temporary, int *ret_fd, tf_error *error) {
    struct stat status;
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        return tf_error_set(error, TF_E_WRITE, "%s: is a folder", path);
    }
    char *temporary = temporary_name(path);
    if (temporary == NULL) {
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", path);
    }
    int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == EEXIST) {
        // Left by a process of the same number that was killed.
        unlink(temporary);
        fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    }
    if (fd < 0) {
        tf_error_set(error, TF_E_WRITE, "%s: cannot be written: %s", path, strerror(errno));
        free(temporary);
        return TF_E_WRITE;
    }
    *ret_temporary = temporary;
    *ret_fd = fd;
    return TF_OK;
}

tf_status tf_output_check(const char *path, tf_error *error) {
    char *temporary;
    int fd;
    const tf_status status = create(path, &temporary, &fd, error);
    if (status == TF_OK) {
        close(fd);
        unlink(temporary);
        free(temporary);
    }
    return status;
}

tf_status tf_outputs_add(tf_outputs *set, const char *path, FILE **ret_file, tf_error *error) {
    if (set->count == TF_MAX_OUTPUTS) {
        return tf_error_set(error, TF_E_WRITE, "%s: too many files at once", path);
    }
    tf_output *output = &set->items[set->count];
    int fd;
    const tf_status status = create(path, &output->temporary, &fd, error);
    if (status != TF_OK) {
        return status;
    }
    output->path = strdup(path);
    output->file = output->path == NULL ? NULL : fdopen(fd, "wb");
    if (output->file == NULL) {
        close(fd);
        unlink(output->temporary);
        free(output->temporary);
        free(output->path);
        return tf_error_set(error, TF_E_MEMORY, "%s: no memory", path);
    }
    set->count++;
    *ret_file = output->file;
    return TF_OK;
}

static void forget(tf_output *output) {
    if (output->temporary != NULL) {
        unlink(output->temporary);
    }
    free(output->temporary);
    free(output->path);
    *output = (tf_output){NULL, NULL, NULL};
}

tf_status tf_outputs_commit(tf_outputs *set, tf_error *error) {
    tf_status status = TF_OK;
    for (size_t i = 0; i < set->count; i++) {
        tf_output *output = &set->items[i];
        const int bad = ferror(output->file);
        errno = 0;
        const int closed = fclose(output->file);
        output->file = NULL;
        if ((bad || closed != 0) && status == TF_OK) {
            status = tf_error_set(error, TF_E_WRITE, "%s: cannot be written: %s", output->path,
                                  errno != 0 ? strerror(errno) : "input/output error");
        }
    }
    for (size_t i = 0; i < set->count && status == TF_OK; i++) {
        tf_output *output = &set->items[i];
        if (rename(output->temporary, output->path) != 0) {
            status = tf_error_set(error, TF_E_WRITE, "%s: cannot be written: %s", output->path,
                                  strerror(errno));
        } else {
            free(output->temporary);
            output->temporary = NULL;
        }
    }
    for (size_t i = 0; i < set->count; i++) {
        forget(&set->items[i]);
    }
    set->count = 0;
    return status;
}

void tf_outputs_drop(tf_outputs *set) {
    for (size_t i = 0; i < set->count; i++) {
        fclose(set->items[i].file);
        forget(&set->items[i]);
    }
    set->count = 0;
}
