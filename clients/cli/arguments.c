// SPDX-License-Identifier: Apache-2.0
/* arguments.c: the command line of tetractl. Values are checked here as far as that
 * needs no server; a mistake ends with status 2 before anything is done. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/cli.h"

const command commands[] = {
    {"mesh", "INPUT", GROUP_JOB | GROUP_OUTPUT | GROUP_QUIET, command_mesh,
     "mesh a file; without a server it starts a private one"},
    {"submit", "INPUT", GROUP_JOB, command_submit, "submit a file and print the job's id"},
    {"jobs", NULL, 0, command_jobs, "list your jobs"},
    {"status", "JOB", 0, command_status, "what a job is and does"},
    {"watch", "JOB", GROUP_QUIET, command_watch, "wait for a job's end, showing its progress"},
    {"cancel", "JOB", 0, command_cancel, "cancel a job"},
    {"delete", "JOB", 0, command_delete, "drop a job that has ended, and its mesh"},
    {"fetch", "JOB", GROUP_OUTPUT | GROUP_FIRST | GROUP_QUIET, command_fetch,
     "write a job's mesh, when it has ended"},
    {"stats", NULL, 0, command_stats, "what the server does"},
    {NULL, NULL, 0, NULL, NULL}};

enum {
    OPTION_STAGE = 256,
    OPTION_RADIUS_EDGE,
    OPTION_MAX_VOLUME,
    OPTION_MIN_DIHEDRAL,
    OPTION_BOUND_ONLY,
    OPTION_ORDER,
    OPTION_KEEP_HULL,
    OPTION_PLANARITY,
    OPTION_MERGE_ANGLE,
    OPTION_BREAK_POINTS,
    OPTION_NEIGHBOURS,
    OPTION_VORONOI,
    OPTION_DEADLINE,
    OPTION_MEMORY,
    OPTION_MAX_VERTICES,
    OPTION_CODEC,
    OPTION_PRIORITY,
    OPTION_KEY,
    OPTION_SEED,
    OPTION_THREADS,
    OPTION_REPORT,
    OPTION_FIRST_INDEX,
    OPTION_CONNECT,
    OPTION_JSON,
    OPTION_VERSION
};

static const struct {
    const char *name;
    int has_value;
    int value;
    unsigned group; /* 0: of every command */
    const char *help;
} options[] = {
    {"stage", 1, OPTION_STAGE, GROUP_JOB, "STAGE   delaunay, cdt or refine (default)"},
    {"radius-edge", 1, OPTION_RADIUS_EDGE, GROUP_JOB,
     "R       bound of circumradius to shortest edge, >= 1, guaranteed from 1.414 on (2.0)"},
    {"max-volume", 1, OPTION_MAX_VOLUME, GROUP_JOB, "V       largest volume of a tetrahedron"},
    {"min-dihedral", 1, OPTION_MIN_DIHEDRAL, GROUP_JOB,
     "D       degrees, up to 30: smaller dihedral angles are removed where they can be (5)"},
    {"bound-only", 0, OPTION_BOUND_ONLY, GROUP_JOB,
     "        stop when the other bounds hold: small dihedral angles stay"},
    {"order", 1, OPTION_ORDER, GROUP_JOB,
     "ORDER   of insertion: O2_O1 (default), O1 to O5, or relatively_short"},
    {"keep-hull", 0, OPTION_KEEP_HULL, GROUP_JOB,
     "        keep the convex hull: outside and holes stay"},
    {"planarity-tolerance", 1, OPTION_PLANARITY, GROUP_JOB,
     "D  how far out of plane a polygon may be"},
    {"merge-angle", 1, OPTION_MERGE_ANGLE, GROUP_JOB,
     "D       degrees, up to 45: sides this flat of one marker are no sharp segments"},
    {"break-points", 0, OPTION_BREAK_POINTS, GROUP_JOB,
     "        add points until no neighbouring triangles of a facet are on one circle"},
    {"neighbours", 0, OPTION_NEIGHBOURS, GROUP_JOB, "        write .neigh beside .node"},
    {"voronoi", 0, OPTION_VORONOI, GROUP_JOB,
     "        write the Voronoi cells, their volumes and factors, beside .node or .vtu"},
    {"deadline", 1, OPTION_DEADLINE, GROUP_JOB, "SECONDS the job fails when they have passed"},
    {"memory", 1, OPTION_MEMORY, GROUP_JOB, "BYTES   the engine's budget (K, M or G may follow)"},
    {"max-vertices", 1, OPTION_MAX_VERTICES, GROUP_JOB, "N       of the mesh"},
    {"seed", 1, OPTION_SEED, GROUP_JOB, "N       of the insertion order"},
    {"threads", 1, OPTION_THREADS, GROUP_JOB, "N       that meshing may use (1)"},
    {"codec", 1, OPTION_CODEC, GROUP_JOB, "CODEC   of the transfer: raw, zlib or mesh"},
    {"priority", 1, OPTION_PRIORITY, GROUP_JOB, "N       -100 to 100; higher ones start first"},
    {"key", 1, OPTION_KEY, GROUP_JOB, "KEY     names the job; repeating is then safe"},
    {"output", 1, 'o', GROUP_OUTPUT, "FILE    .node (with .ele .face .edge), .mesh, .vtu or .off"},
    {"report", 1, OPTION_REPORT, GROUP_OUTPUT, "FILE    the report as JSON"},
    {"first-index", 1, OPTION_FIRST_INDEX, GROUP_FIRST, "0|1     of .node and its companions (0)"},
    {"quiet", 0, 'q', GROUP_QUIET, "        nothing but errors"},
    {"connect", 1, OPTION_CONNECT, 0,
     "ADDRESS unix:PATH or tcp:HOST:PORT (default: $TETRAD_CONNECT)"},
    {"json", 0, OPTION_JSON, 0, "        print JSON"},
    {"help", 0, 'h', 0, ""},
    {"version", 0, OPTION_VERSION, 0, ""}};

enum { N_OPTIONS = sizeof options / sizeof options[0] };

static bool applies(const command *which, int i) {
    return options[i].group == 0 || (options[i].group & which->groups) != 0;
}

static void print_usage(FILE *file) {
    fputs("Usage: tetractl COMMAND [ARGUMENT] [OPTION]...\n"
          "Tetrahedral meshes by the daemon tetrad.\n\n",
          file);
    for (const command *c = commands; c->name != NULL; c++) {
        fprintf(file, "  %-7s %-6s %s\n", c->name, c->subject != NULL ? c->subject : "",
                c->summary);
    }
    fputs("\ntetractl COMMAND --help tells a command's options; --version, the version.\n"
          "Reads .poly .smesh .node .off .stl .ply .obj .mesh; writes .node .mesh .vtu .off.\n"
          "$TETRAD_CONNECT names the server, $TETRAD_TOKEN proves who asks.\n\n"
          "Exit status: 0 done, 1 input refused, 2 usage, 3 server or connection, 4 job failed\n"
          "or limit hit, 5 output not writable, 130 interrupted (the job is cancelled).\n",
          file);
}

static void print_command_usage(const command *which) {
    printf("Usage: tetractl %s%s%s%s [OPTION]...\n%s\n\n", which->name,
           which->subject != NULL ? " " : "", which->subject != NULL ? which->subject : "",
           which->groups & GROUP_OUTPUT ? " -o OUTPUT" : "", which->summary);
    for (int i = 0; i < N_OPTIONS; i++) {
        if (applies(which, i) && options[i].help[0] != '\0') {
            printf("  %s --%-12s %s\n",
                   options[i].value == 'o'   ? "-o,"
                   : options[i].value == 'q' ? "-q,"
                                             : "   ",
                   options[i].name, options[i].help);
        }
    }
}

__attribute__((format(printf, 2, 3))) static int usage_error(const command *which,
                                                             const char *format, ...) {
    va_list list;
    fprintf(stderr, "tetractl%s%s: ", which != NULL ? " " : "", which != NULL ? which->name : "");
    va_start(list, format);
    vfprintf(stderr, format, list);
    va_end(list);
    fprintf(stderr, "; see tetractl%s%s --help\n", which != NULL ? " " : "",
            which != NULL ? which->name : "");
    return STATUS_USAGE;
}

static bool read_real(const char *text, double low, double *ret_value) {
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(value) || value < low) {
        return false;
    }
    *ret_value = value;
    return true;
}

// A positive real; 0 would mean "the default" further on.
static bool read_positive(const char *text, double *ret_value) {
    double value;
    if (!read_real(text, 0, &value) || value == 0) {
        return false;
    }
    *ret_value = value;
    return true;
}

// An integer in [low, 2^53], with a unit where that is allowed.
static bool read_count(const char *text, bool units, uint64_t low, uint64_t *ret_value) {
    char *end;
    errno = 0;
    if (*text < '0' || *text > '9') {
        return false;
    }
    unsigned long long value = strtoull(text, &end, 10);
    const char *unit = units && *end != '\0' ? strchr("KMG", *end) : NULL;
    for (int i = 0; unit != NULL && i <= (*unit == 'K' ? 0 : *unit == 'M' ? 1 : 2); i++) {
        value = value > UINT64_MAX / 1024 ? UINT64_MAX : value * 1024;
    }
    if (errno != 0 || end[unit != NULL] != '\0' || value < low || value > UINT64_C(1) << 53) {
        return false;
    }
    *ret_value = value;
    return true;
}

// One of the names, which NULL ends.
static bool read_name(const char *text, const char *const *names, const char **ret_name) {
    for (int i = 0; names[i] != NULL; i++) {
        if (strcmp(text, names[i]) == 0) {
            *ret_name = names[i];
            return true;
        }
    }
    return false;
}

// What to make. False: the value makes no sense.
static bool apply_job_option(arguments *args, int option, const char *value) {
    static const char *const stages[] = {"delaunay", "cdt", "refine", NULL};
    static const char *const codecs[] = {"raw", "zlib", "mesh", NULL};
    static const char *const orders[] = {"O2_O1", "O1", "O2", "O3", "O4", "O5",
                                         "relatively_short", NULL};
    tetrad_options *o = &args->options;
    double real;
    char *end;
    switch (option) {
    case OPTION_STAGE: return read_name(value, stages, &o->stage);
    case OPTION_CODEC: return read_name(value, codecs, &o->codec);
    case OPTION_RADIUS_EDGE: return read_real(value, 1, &o->radius_edge);
    case OPTION_MAX_VOLUME: return read_positive(value, &o->max_volume);
    case OPTION_MIN_DIHEDRAL: return read_positive(value, &o->min_dihedral);
    case OPTION_ORDER: return read_name(value, orders, &o->order);
    case OPTION_BOUND_ONLY: o->bound_only = 1; return true;
    case OPTION_PLANARITY: return read_real(value, 0, &o->planarity_tolerance);
    case OPTION_MERGE_ANGLE: return read_positive(value, &o->merge_angle);
    case OPTION_MEMORY: return read_count(value, true, 1, &o->memory_bytes);
    case OPTION_MAX_VERTICES: return read_count(value, false, 1, &o->max_vertices);
    case OPTION_SEED: return read_count(value, false, 0, &o->seed);
    case OPTION_THREADS: return read_count(value, false, 1, &o->threads);
    case OPTION_KEEP_HULL: o->keep_hull = 1; return true;
    case OPTION_BREAK_POINTS: o->break_points = 1; return true;
    case OPTION_NEIGHBOURS: o->neighbours = 1; return true;
    case OPTION_VORONOI: o->voronoi = "diagram"; return true;
    case OPTION_DEADLINE:
        if (!read_positive(value, &real) || real > 1e9) {
            return false;
        }
        o->deadline_ms = (uint64_t)ceil(real * 1000);
        return true;
    case OPTION_PRIORITY: {
        const long priority = strtol(value, &end, 10);
        o->priority = (int)priority;
        return end != value && *end == '\0' && priority >= -100 && priority <= 100;
    }
    default:
        o->key = value;
        return *value != '\0' && strlen(value) <= 128;
    }
}

static bool apply_option(arguments *args, int option, const char *value) {
    uint64_t number;
    switch (option) {
    case 'o': args->output = value; return *value != '\0';
    case 'q': args->quiet = true; return true;
    case OPTION_REPORT: args->report = value; return *value != '\0';
    case OPTION_CONNECT: args->connect = value; return *value != '\0';
    case OPTION_JSON: args->json = true; return true;
    case OPTION_FIRST_INDEX:
        if (!read_count(value, false, 0, &number) || number > 1) {
            return false;
        }
        args->first_index = (int)number;
        return true;
    default: return apply_job_option(args, option, value);
    }
}

static const char *option_name(int option) {
    for (int i = 0; i < N_OPTIONS; i++) {
        if (options[i].value == option) {
            return options[i].name;
        }
    }
    return "";
}

// The options of one command in getopt's form.
static void long_options(const command *which, struct option table[N_OPTIONS + 1]) {
    int n = 0;
    for (int i = 0; i < N_OPTIONS; i++) {
        if (applies(which, i)) {
            table[n++] = (struct option){options[i].name, options[i].has_value, NULL,
                                         options[i].value};
        }
    }
    table[n] = (struct option){NULL, 0, NULL, 0};
}

static int check_together(const command *which, const arguments *args) {
    const tetrad_options *o = &args->options;
    const char *stage = o->stage;
    if (which->subject != NULL && args->subject == NULL) {
        return usage_error(which, "%s is missing", which->subject);
    }
    if ((which->groups & GROUP_OUTPUT) != 0 && args->output == NULL) {
        return usage_error(which, "-o OUTPUT is missing");
    }
    if (stage != NULL && strcmp(stage, "refine") != 0 &&
        (o->radius_edge != 0 || o->max_volume != 0 || o->min_dihedral != 0 || o->bound_only ||
         o->merge_angle != 0 || o->order != NULL)) {
        return usage_error(which, "--radius-edge, --max-volume, --min-dihedral, --bound-only, --merge-angle "
                                  "and --order belong to --stage refine");
    }
    if (o->break_points && stage != NULL && strcmp(stage, "delaunay") == 0) {
        return usage_error(which, "--break-points are for facets: not with --stage delaunay");
    }
    if (o->bound_only && o->min_dihedral != 0) {
        return usage_error(which, "--bound-only lets slivers stay: not with --min-dihedral");
    }
    if (o->voronoi != NULL &&
        (o->keep_hull || (stage != NULL && strcmp(stage, "delaunay") == 0))) {
        return usage_error(which, "--voronoi cuts cells to facets: not with --stage delaunay or "
                                  "--keep-hull");
    }
    return -1;
}

static int read_command(const command *which, int argc, char **argv, arguments *args) {
    struct option table[N_OPTIONS + 1];
    long_options(which, table);
    const char *letters = which->groups & GROUP_OUTPUT  ? ":o:qh"
                          : which->groups & GROUP_QUIET ? ":qh"
                                                        : ":h";
    int option;
    opterr = 0;
    optind = 1;
    while ((option = getopt_long(argc, argv, letters, table, NULL)) != -1) {
        if (option == 'h') {
            print_command_usage(which);
            return STATUS_DONE;
        }
        if (option == OPTION_VERSION) {
            printf("tetractl %s\n", tetrad_version());
            return STATUS_DONE;
        }
        if (option == '?') {
            return usage_error(which, "unknown option '%s'", argv[optind - 1]);
        }
        if (option == ':') {
            return usage_error(which, "option '%s' needs a value", argv[optind - 1]);
        }
        if (!apply_option(args, option, optarg)) {
            return usage_error(which, "'%s' is no value of --%s", optarg, option_name(option));
        }
    }
    if (optind < argc && which->subject != NULL) {
        args->subject = argv[optind++];
    }
    if (optind < argc) {
        return usage_error(which, "unexpected argument '%s'", argv[optind]);
    }
    return check_together(which, args);
}

int read_arguments(int argc, char **argv, arguments *ret_args, const command **ret_command) {
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        print_usage(stdout);
        return STATUS_DONE;
    }
    if (strcmp(name, "--version") == 0) {
        printf("tetractl %s\n", tetrad_version());
        return STATUS_DONE;
    }
    for (const command *c = commands; c->name != NULL; c++) {
        if (strcmp(name, c->name) == 0) {
            *ret_args = (arguments){.command = c->name};
            *ret_command = c;
            return read_command(c, argc - 1, argv + 1, ret_args);
        }
    }
    if (argc < 2) {
        print_usage(stderr);
        return STATUS_USAGE;
    }
    return usage_error(NULL, "unknown command '%s'", name);
}
