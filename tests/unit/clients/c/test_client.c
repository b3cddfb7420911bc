// SPDX-License-Identifier: Apache-2.0
// The C client against a server of a few lines that keeps, or breaks, the protocol.
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <cmocka.h>

#include "protocol/message.h"
#include "tetrad/client.h"

typedef struct server {
    char folder[40], path[64];
    int listener;
    pthread_t thread;
    void (*serve)(FILE *in, FILE *out); // after the hello
} server;

// The id of the next request and the size of its body, which comes. 0 at the end of file.
static long long next_line(FILE *in, const char *method, long long *ret_body) {
    char *line = NULL;
    size_t room = 0;
    if (getline(&line, &room, in) <= 0) {
        free(line);
        return 0;
    }
    json_t *json = json_loads(line, 0, NULL);
    free(line);
    assert_string_equal(json_string_value(json_object_get(json, "method")), method);
    const long long id = json_integer_value(json_object_get(json, "id"));
    *ret_body = json_integer_value(json_object_get(json, "body"));
    json_decref(json);
    return id;
}

static void drop(FILE *in, long long body) {
    while (body-- > 0 && fgetc(in) != EOF) {
    }
}

// The same, its body dropped.
static long long next_request(FILE *in, const char *method) {
    long long body = 0;
    const long long id = next_line(in, method, &body);
    drop(in, body);
    return id;
}

static void reply(FILE *out, long long id, const char *result) {
    fprintf(out, "{\"jsonrpc\":\"2.0\",\"id\":%lld,\"result\":%s}\n", id, result);
    fflush(out);
}

static void *serve_one(void *user) {
    server *s = user;
    const int fd = accept(s->listener, NULL, NULL);
    FILE *in = fdopen(fd, "r"), *out = fdopen(dup(fd), "w");
    reply(out, next_request(in, "server.hello"), "{\"protocol\":1}");
    s->serve(in, out);
    fclose(out);
    fclose(in);
    return NULL;
}

static tetrad_client *start(server *s, void (*serve)(FILE *in, FILE *out)) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    strcpy(s->folder, "/tmp/tetrad-client-XXXXXX");
    assert_non_null(mkdtemp(s->folder));
    snprintf(s->path, sizeof s->path, "%s/socket", s->folder);
    snprintf(address.sun_path, sizeof address.sun_path, "%s", s->path);
    s->serve = serve;
    s->listener = socket(AF_UNIX, SOCK_STREAM, 0);
    assert_int_equal(bind(s->listener, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(s->listener, 1), 0);
    assert_int_equal(pthread_create(&s->thread, NULL, serve_one, s), 0);
    char name[80];
    tetrad_client *client;
    tetrad_error error;
    snprintf(name, sizeof name, "unix:%s", s->path);
    if (tetrad_connect(name, NULL, &client, &error) != TETRAD_OK) {
        fail_msg("%s", error.message);
    }
    return client;
}

static void stop(server *s, tetrad_client *client) {
    tetrad_close(client);
    pthread_join(s->thread, NULL);
    close(s->listener);
    unlink(s->path);
    rmdir(s->folder);
}

// ---- submitting -----------------------------------------------------------

enum { MANY = 200000 };

// Talks a lot before it reads the upload: who does not read meanwhile never ends.
static void talk_then_read(FILE *in, FILE *out) {
    for (int i = 0; i < 40000; i++) {
        fprintf(out, "{\"jsonrpc\":\"2.0\",\"method\":\"job.progress\",\"body\":20,"
                     "\"params\":{\"of\":77}}\n01234567890123456789");
    }
    fflush(out);
    reply(out, next_request(in, "mesh.submit"), "{\"job\":\"a.1\",\"state\":\"queued\"}");
}

static tetrad_status submit_many(tetrad_client *client, const tetrad_options *options,
                                 char job[TETRAD_JOB_SIZE], tetrad_error *error) {
    double *points = calloc(3 * MANY, sizeof *points);
    const tetrad_array pls[1] = {{"points", TETRAD_F8, 2, {MANY, 3}, points}};
    const tetrad_status status = tetrad_submit(client, pls, 1, options, job, error);
    free(points);
    return status;
}

static void reads_while_it_writes(void **state) {
    (void)state;
    server s;
    char job[TETRAD_JOB_SIZE];
    tetrad_error error;
    tetrad_client *client = start(&s, talk_then_read);
    assert_int_equal(submit_many(client, NULL, job, &error), TETRAD_OK);
    assert_string_equal(job, "a.1");
    stop(&s, client);
}

// Refuses the upload before it reads it, then drops it; the next request is fine.
static void refuse_then_read(FILE *in, FILE *out) {
    long long body;
    fprintf(out,
            "{\"jsonrpc\":\"2.0\",\"id\":%lld,\"error\":{\"code\":4,\"message\":\"no room\",\"data\":"
            "{\"name\":\"busy\",\"retry_ms\":250,\"where\":\"body\"}}}\n",
            next_line(in, "mesh.submit", &body));
    fflush(out);
    drop(in, body);
    reply(out, next_request(in, "server.stats"), "{\"jobs\":3}");
}

static void stays_usable_after_a_refused_upload(void **state) {
    (void)state;
    server s;
    char job[TETRAD_JOB_SIZE] = "untouched", *text;
    tetrad_error error;
    tetrad_client *client = start(&s, refuse_then_read);
    assert_int_equal(submit_many(client, NULL, job, &error), TETRAD_E_REFUSED);
    assert_int_equal(error.code, 4);
    assert_string_equal(error.name, "busy");
    assert_string_equal(error.where, "body");
    assert_int_equal(error.retry_ms, 250);
    assert_string_equal(error.message, "no room");
    assert_string_equal(job, "untouched");
    assert_int_equal(tetrad_server_stats(client, &text, &error), TETRAD_OK);
    assert_string_equal(text, "{\"jobs\":3}");
    free(text);
    stop(&s, client);
}

static void serve_nothing(FILE *in, FILE *out) {
    (void)out;
    fgetc(in);
}

static void refuses_arguments_before_sending(void **state) {
    (void)state;
    server s;
    char job[TETRAD_JOB_SIZE];
    tetrad_error error;
    tetrad_client *client = start(&s, serve_nothing);
    const tetrad_options wrong[] = {{.stage = "best"},   {.radius_edge = 0.5},
                                    {.max_volume = -1},  {.point_order = "random"},
                                    {.codec = "gzip"},   {.stage = "cdt", .radius_edge = 2},
                                    {.planarity_tolerance = -1},
                                    {.merge_angle = -1},
                                    {.merge_angle = 46},
                                    {.stage = "cdt", .merge_angle = 5},
                                    {.stage = "delaunay", .break_points = 1},
                                    {.min_dihedral = 40},
                                    {.order = "O6"},
                                    {.stage = "cdt", .order = "O1"},
                                    {.min_dihedral = -1},
                                    {.bound_only = 1, .min_dihedral = 5},
                                    {.stage = "cdt", .bound_only = 1}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_equal(submit_many(client, &wrong[i], job, &error), TETRAD_E_ARGUMENT);
        assert_string_not_equal(error.message, "");
    }
    const tetrad_array pls[1] = {{"triangles", TETRAD_U4, 2, {0, 3}, NULL}};
    assert_int_equal(tetrad_submit(client, pls, 1, NULL, job, &error), TETRAD_E_ARGUMENT);
    stop(&s, client);
    assert_int_equal(tetrad_connect("tcp:nowhere", NULL, &client, &error), TETRAD_E_ARGUMENT);
    assert_int_equal(tetrad_connect("http://x", NULL, &client, &error), TETRAD_E_ARGUMENT);
    assert_int_equal(tetrad_connect("unix:/nonexistent/socket", NULL, &client, &error),
                     TETRAD_E_CONNECT);
}

// ---- waiting --------------------------------------------------------------

static void lose(FILE *in, FILE *out) {
    next_request(in, "job.wait");
    fputs("{\"jsonrpc\":\"2.0\",\"id\":2,\"res", out);
}

static void tells_a_lost_connection(void **state) {
    (void)state;
    server s;
    char *text;
    tetrad_error error;
    tetrad_client *client = start(&s, lose);
    assert_int_equal(tetrad_wait(client, "a.1", NULL, NULL, &text, &error), TETRAD_E_CONNECTION);
    assert_int_equal(tetrad_wait(client, "a.1", NULL, NULL, &text, &error), TETRAD_E_CONNECTION);
    stop(&s, client);
}

static void keep_waiting(FILE *in, FILE *out) {
    const long long waiting = next_request(in, "job.wait");
    fprintf(out,
            "{\"jsonrpc\":\"2.0\",\"method\":\"job.progress\",\"params\":{\"of\":%lld,\"job\":\"a.1\","
            "\"state\":\"running\",\"stage\":\"refine\",\"fraction\":0.5,\"vertices\":7,"
            "\"tetrahedra\":9,\"done\":3}}\n",
            waiting);
    fflush(out);
    next_request(in, "request.cancel");
    const long long cancelling = next_request(in, "job.cancel");
    reply(out, waiting, "{\"late\":true}");
    reply(out, cancelling, "{\"job\":\"a.1\",\"state\":\"cancelled\"}");
}

static void interrupt_it(void *user, const tetrad_progress *progress) {
    assert_string_equal(progress->stage, "refine");
    assert_int_equal(progress->vertices, 7);
    assert_int_equal(progress->tetrahedra, 9);
    assert_true(progress->fraction == 0.5);
    tetrad_interrupt(user);
}

static void can_be_interrupted_and_used_again(void **state) {
    (void)state;
    server s;
    char *text;
    tetrad_error error;
    tetrad_client *client = start(&s, keep_waiting);
    assert_int_equal(tetrad_wait(client, "a.1", interrupt_it, client, &text, &error),
                     TETRAD_E_INTERRUPTED);
    assert_int_equal(tetrad_job_cancel(client, "a.1", &text, &error), TETRAD_OK);
    assert_string_equal(text, "{\"job\":\"a.1\",\"state\":\"cancelled\"}");
    free(text);
    stop(&s, client);
}

// ---- fetching -------------------------------------------------------------

static const uint32_t rows[8] = {0, 1, 2, 3, 1, 4, 2, 3};

typedef enum fault { NONE, CHUNK_CRC, WHOLE_CRC, ORDER, TOO_LONG, MISSING, UNKNOWN } fault;

// Two chunks of one row of `tetrahedra`, with one thing wrong.
static void send_mesh(FILE *in, FILE *out, fault wrong) {
    tp_array array = {"tetrahedra", TP_U4, 2, {2, 4}, (void *)(uintptr_t)rows, false};
    tp_array_info info;
    tp_array_info_of(&array, TP_RAW, &info);
    info.rows_per_chunk = 1;
    info.chunks = 2;
    info.crc32 ^= wrong == WHOLE_CRC;
    json_t *job = json_pack("{s:s, s:[o]}", "state", "done", "arrays", tp_array_info_json(&info));
    char *text = json_dumps(job, 0);
    json_decref(job);
    reply(out, next_request(in, "job.wait"), text);
    free(text);
    const long long id = next_request(in, "mesh.fetch");
    for (int i = 0; i < (wrong == MISSING ? 1 : 2); i++) {
        const uint32_t crc = tp_crc32(0, rows + 4 * i, 16) ^ (wrong == CHUNK_CRC && i == 1);
        fprintf(out,
                "{\"jsonrpc\":\"2.0\",\"method\":\"mesh.chunk\",\"body\":%d,\"params\":{\"of\":%lld,"
                "\"array\":\"%s\",\"chunk\":%d,\"row\":%d,\"rows\":1,\"crc32\":%u}}\n",
                wrong == TOO_LONG ? 5000 : 16, id, wrong == UNKNOWN ? "tets" : "tetrahedra",
                wrong == ORDER ? 1 - i : i, i, crc);
        fwrite(rows + 4 * i, 1, 16, out);
    }
    reply(out, id, "{\"chunks\":2}");
}

#define SENDING(name, wrong)                                                                       \
    static void name(FILE *in, FILE *out) {                                                        \
        send_mesh(in, out, wrong);                                                                 \
    }
SENDING(send_well, NONE)
SENDING(send_chunk_crc, CHUNK_CRC)
SENDING(send_whole_crc, WHOLE_CRC)
SENDING(send_out_of_order, ORDER)
SENDING(send_too_long, TOO_LONG)
SENDING(send_missing, MISSING)
SENDING(send_unknown, UNKNOWN)

static void fetches_chunks(void **state) {
    (void)state;
    server s;
    tetrad_mesh *mesh;
    tetrad_error error;
    tetrad_client *client = start(&s, send_well);
    assert_int_equal(tetrad_fetch(client, "a.1", NULL, 0, &mesh, &error), TETRAD_OK);
    const tetrad_array *array = tetrad_mesh_find(mesh, "tetrahedra");
    assert_non_null(array);
    assert_ptr_equal(array, tetrad_mesh_array(mesh, 0));
    assert_null(tetrad_mesh_array(mesh, 1));
    assert_null(tetrad_mesh_find(mesh, "points"));
    assert_int_equal(array->shape[0], 2);
    assert_int_equal(array->shape[1], 4);
    assert_memory_equal(array->data, rows, sizeof rows);
    tetrad_mesh_free(mesh);
    stop(&s, client);
}

static void refuses_broken_chunks(void **state) {
    (void)state;
    void (*const servers[])(FILE *, FILE *) = {send_chunk_crc, send_whole_crc, send_out_of_order,
                                               send_too_long,  send_missing,   send_unknown};
    for (size_t i = 0; i < sizeof servers / sizeof servers[0]; i++) {
        server s;
        tetrad_mesh *mesh;
        tetrad_error error;
        tetrad_client *client = start(&s, servers[i]);
        assert_int_equal(tetrad_fetch(client, "a.1", NULL, 0, &mesh, &error), TETRAD_E_PROTOCOL);
        stop(&s, client);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_while_it_writes),
        cmocka_unit_test(stays_usable_after_a_refused_upload),
        cmocka_unit_test(refuses_arguments_before_sending),
        cmocka_unit_test(tells_a_lost_connection),
        cmocka_unit_test(can_be_interrupted_and_used_again),
        cmocka_unit_test(fetches_chunks),
        cmocka_unit_test(refuses_broken_chunks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
