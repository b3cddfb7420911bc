// SPDX-License-Identifier: Apache-2.0
/* jobs.h: the life of jobs. One function (in jobs.c) changes a state, and everything
 * that follows from it happens there. */
#ifndef TETRAD_DAEMON_JOBS_H
#define TETRAD_DAEMON_JOBS_H

#include "server/daemon/job.h"

const char *job_state_name(job_state state);
bool job_ended(const job *job);

/* A job as the store frees it, or one that was not accepted. */
void job_free(job *job);

/* Stores and queues a job, whose id is given here. Starts it if a worker is idle. */
void jobs_accept(server *server, job *job);

/* A worker has it. Its input is no longer the job's. */
void jobs_start(server *server, job *job, worker *worker);

/* The worker's news; `params` is borrowed. */
void jobs_progress(server *server, job *job, const json_t *params);

/* The worker has said all: done as soon as the spool is. `arrays` and `report` are
 * borrowed. false: the table does not fit the chunks. */
bool jobs_complete(server *server, job *job, const json_t *arrays, const json_t *report);

/* Ends it as failed or cancelled. An earlier reason (job->ending) wins over `error`.
 * `error` is an error object and taken; `report` is borrowed, may be NULL. */
void jobs_fail(server *server, job *job, json_t *error, const json_t *report);

/* The same with an error made here; `data` is taken. */
__attribute__((format(printf, 5, 6))) void jobs_fail_with(server *server, job *job, tp_code code,
                                                          json_t *data, const char *format, ...);

/* Asks for the end of a queued or running job, for that reason (cancelled, deadline,
 * spool); it comes within CANCEL_GRACE_MS. */
void jobs_end(server *server, job *job, tp_code reason);

/* Drops a finished job and its result. */
void jobs_delete(server *server, job *job);

/* Its lifetime begins anew: a fetch is complete. */
void jobs_touch(server *server, job *job);

/* Deletes the expired ones. */
void jobs_expire(server *server, double now);

/* The upload is no longer held for it. */
void jobs_release_upload(server *server, job *job);

/* Where its chunks go: made for the first one. NULL: no memory. */
result *jobs_result(server *server, job *job);

/* PROTOCOL.md's job object; `brief` leaves out arrays and report. NULL: no memory. */
json_t *jobs_object(server *server, const job *job, bool brief);

#endif
