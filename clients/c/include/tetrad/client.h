// SPDX-License-Identifier: Apache-2.0
/* client.h: the C client of the meshing daemon tetrad.
 *
 *   tetrad_client *client;  tetrad_mesh *mesh;  tetrad_error error;  char job[TETRAD_JOB_SIZE];
 *   char *outcome;
 *   tetrad_connect(NULL, NULL, &client, &error);              // starts a private daemon
 *   tetrad_submit(client, arrays, n_arrays, NULL, job, &error);
 *   tetrad_wait(client, job, NULL, NULL, &outcome, &error);   // a job object, JSON
 *   tetrad_fetch(client, job, NULL, 0, &mesh, &error);
 *   const tetrad_array *points = tetrad_mesh_find(mesh, "points");
 *   tetrad_mesh_free(mesh);  free(outcome);  tetrad_close(client);
 *
 * Calls block; each is one request (fetch: two) over one connection. A client is used
 * by one thread at a time; only tetrad_interrupt may come from another thread or a
 * signal handler. Memory is that of the arrays plus about 2 MiB. Nothing is printed.
 *
 * Arrays, job objects and error names are those of protocol/PROTOCOL.md. Every function
 * that fails fills *error (if not NULL) and leaves its outputs untouched. */
#ifndef TETRAD_CLIENT_H
#define TETRAD_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tetrad_status {
    TETRAD_OK = 0,
    TETRAD_E_ARGUMENT,    /* an argument makes no sense; nothing was sent */
    TETRAD_E_MEMORY,      /* this process's memory */
    TETRAD_E_CONNECT,     /* nobody listens there, or no daemon could be started */
    TETRAD_E_CONNECTION,  /* lost in the middle of a call: close the client */
    TETRAD_E_PROTOCOL,    /* the peer broke the protocol (or a CRC): close the client */
    TETRAD_E_REFUSED,     /* the server answered with an error: `code`, `name` */
    TETRAD_E_INTERRUPTED  /* by tetrad_interrupt */
} tetrad_status;

typedef struct tetrad_error {
    tetrad_status status;
    int64_t code;       /* TETRAD_E_REFUSED: the protocol's code; else 0 */
    char name[32];      /* TETRAD_E_REFUSED: its stable name, as "busy"; else "" */
    char where[64];     /* the argument or param meant; "" if none */
    int64_t retry_ms;   /* "busy": when to try again; else 0 */
    char message[512];  /* one sentence for people */
} tetrad_error;

typedef enum tetrad_dtype {
    TETRAD_F8 = 0,
    TETRAD_F4,
    TETRAD_U4,
    TETRAD_I4,
    TETRAD_U8,
    TETRAD_U1
} tetrad_dtype;

/* A named array, row-major: shape[0] rows of shape[1] elements (1 if ndim is 1). */
typedef struct tetrad_array {
    const char *name;
    tetrad_dtype dtype;
    unsigned ndim; /* 1 or 2 */
    uint64_t shape[2];
    const void *data;
} tetrad_array;

/* What to make. Zero (NULL) in a member means the server's default. */
typedef struct tetrad_options {
    const char *stage;          /* "delaunay", "cdt", "refine" (default) */
    double radius_edge;         /* >= 1; below 1.414 without a guarantee */
    double max_volume;          /* > 0 */
    double min_dihedral;        /* degrees, up to 30: below it are slivers, which are removed */
    int bound_only;             /* slivers stay; not with min_dihedral */
    const char *order;          /* of insertion: "O2_O1" (default), "O1" to "O5", "relatively_short" */
    int keep_hull;              /* keep the convex hull */
    double planarity_tolerance; /* length */
    double merge_angle;         /* degrees, up to 45: sides this flat are creases, no sharp segments */
    int break_points;           /* add points until no facet's triangles are cocircular; not with "delaunay" */
    int neighbours;             /* deliver the array `neighbours` */
    const char *voronoi;        /* "factors", "diagram"; NULL: no Voronoi cells */
    const char *point_order;    /* "hilbert" (default), "input_first" */
    uint64_t seed;
    uint64_t threads;           /* that meshing may use */
    uint64_t memory_bytes;
    uint64_t max_vertices;
    const char *codec;          /* of the result: "raw", "zlib", "mesh"; default: "raw" on
                                   Unix sockets and private daemons, else "mesh" */
    int priority;
    uint64_t deadline_ms;       /* from acceptance */
    const char *key;            /* names the job; repeating a submission is then safe */
} tetrad_options;

typedef struct tetrad_client tetrad_client;

enum { TETRAD_JOB_SIZE = 72 };

/* The library's version, as "0.1.0". */
const char *tetrad_version(void);

/* Connects and says hello. address: "unix:PATH", "tcp:HOST:PORT", or NULL: start a
 * private daemon for this client, which ends with it. Its program `tetrad` is sought in
 * the folders of $TETRAD_EXEC_PATH (separated by ':'), beside the calling program, and
 * where it was installed. token: proves a principal to a server that asks; or NULL.
 * Errors: TETRAD_E_ARGUMENT, _MEMORY, _CONNECT, _CONNECTION, _PROTOCOL, _REFUSED. */
tetrad_status tetrad_connect(const char *address, const char *token, tetrad_client **ret_client,
                             tetrad_error *error);

/* Closes; a private daemon has ended when this returns. NULL is fine. */
void tetrad_close(tetrad_client *client);

/* Makes the running call (or the next one, if none runs) end with TETRAD_E_INTERRUPTED.
 * The client stays usable, unless the call was in the middle of sending an upload; an
 * upload that was sent is answered first. Async-signal-safe. */
void tetrad_interrupt(tetrad_client *client);

/* Submits a PLS (PROTOCOL.md, 5.2). The arrays are only read. options may be NULL.
 * ret_job receives the job's id. Errors: all; what the engine has against the input
 * shows in the job, not here. Cost: one pass over the data, encoded. */
tetrad_status tetrad_submit(tetrad_client *client, const tetrad_array *arrays, size_t n_arrays,
                            const tetrad_options *options, char ret_job[TETRAD_JOB_SIZE],
                            tetrad_error *error);

/* What a job does now. stage is "" while it is queued; fraction is negative where it
 * cannot be known. */
typedef struct tetrad_progress {
    const char *state;
    const char *stage;
    double fraction;
    uint64_t vertices, tetrahedra, done;
} tetrad_progress;

typedef void (*tetrad_progress_fn)(void *user, const tetrad_progress *progress);

/* Waits until the job has ended, whichever way; progress (or NULL) is called at most 20
 * times a second. *ret_json is the job object as JSON text, to be freed with free. That
 * a job failed is a result, not an error. */
tetrad_status tetrad_wait(tetrad_client *client, const char *job, tetrad_progress_fn progress,
                          void *user, char **ret_json, tetrad_error *error);

/* The job object, the list of the caller's job objects (an array), the server's
 * statistics: JSON text, to be freed with free. */
tetrad_status tetrad_job_status(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error);
tetrad_status tetrad_job_list(tetrad_client *client, char **ret_json, tetrad_error *error);
tetrad_status tetrad_server_stats(tetrad_client *client, char **ret_json, tetrad_error *error);

/* Cancels; *ret_json (NULL: not wanted) is {"job", "state"}. */
tetrad_status tetrad_job_cancel(tetrad_client *client, const char *job, char **ret_json,
                                tetrad_error *error);

/* Drops a job that has ended, and its result. */
tetrad_status tetrad_job_delete(tetrad_client *client, const char *job, tetrad_error *error);

typedef struct tetrad_mesh tetrad_mesh;

/* Fetches arrays (names NULL: all that the result has) of a job, waiting for its end;
 * decodes them and checks every CRC. Errors: also TETRAD_E_REFUSED with job_failed. */
tetrad_status tetrad_fetch(tetrad_client *client, const char *job, const char *const *names,
                           size_t n_names, tetrad_mesh **ret_mesh, tetrad_error *error);

/* Array i (NULL from the count on), or the one of that name (NULL if there is none).
 * They live as long as the mesh. */
const tetrad_array *tetrad_mesh_array(const tetrad_mesh *mesh, size_t i);
const tetrad_array *tetrad_mesh_find(const tetrad_mesh *mesh, const char *name);
void tetrad_mesh_free(tetrad_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
