// SPDX-License-Identifier: Apache-2.0
/* methods.h: what requests do (PROTOCOL.md, section 7), and what happens to open
 * requests later. */
#ifndef TETRAD_DAEMON_METHODS_H
#define TETRAD_DAEMON_METHODS_H

#include "server/daemon/connection.h"
#include "server/daemon/job.h"

typedef void (*method_fn)(connection *c, const tp_message *message, uint64_t body);

/* Handles one message whose line is in order. `body` bytes of it will follow. */
void methods_handle(connection *c, const tp_message *message, uint64_t body, unsigned depth);

/* ---- one function per method ---- */
void method_hello(connection *c, const tp_message *message, uint64_t body);
void method_stats(connection *c, const tp_message *message, uint64_t body);
void method_submit(connection *c, const tp_message *message, uint64_t body);
void method_job_status(connection *c, const tp_message *message, uint64_t body);
void method_job_list(connection *c, const tp_message *message, uint64_t body);
void method_job_wait(connection *c, const tp_message *message, uint64_t body);
void method_job_cancel(connection *c, const tp_message *message, uint64_t body);
void method_job_delete(connection *c, const tp_message *message, uint64_t body);
void method_fetch(connection *c, const tp_message *message, uint64_t body);
void method_request_cancel(connection *c, const tp_message *message);

/* ---- what comes later ---- */

/* The upload of an open REQUEST_SUBMIT goes on, or is complete. */
void submit_body(request *r, const void *data, size_t size);
void submit_complete(request *r);
void submission_free(submission *s);

/* The job that a request waited for has ended; it waits no longer. */
void request_job_ended(request *r, job *job);

/* Something of the job changed that a job.wait may want to tell. */
void wait_job_changed(request *r, const job *job);

/* The job of a fetch has ended: it joins c->fetching, or is refused. */
void fetch_start(request *r, const job *job);

/* Sends the next chunk of a fetch in c->fetching, or ends it. */
void fetch_step(request *r);
void fetch_free(fetch *f);

/* ---- parameters: each answers what is wrong itself and gives false ---- */

bool params_known(connection *c, const tp_message *message, const char *const *names);

/* `least` to `most`; absent: *ret_value as it was. */
bool param_integer(connection *c, const tp_message *message, const char *name, int64_t least,
                   int64_t most, int64_t *ret_value);

/* A string of 1 to `most` bytes, or NULL if absent. */
bool param_string(connection *c, const tp_message *message, const char *name, size_t most,
                  const char **ret_value);

/* The job that "job" or "key" names, if the caller may see it. */
bool param_job(connection *c, const tp_message *message, job **ret_job);

#endif
