// SPDX-License-Identifier: Apache-2.0
/* meshpls.c: meshes a file with the engine alone, in this process.
 *
 *   meshpls INPUT(.node .poly .smesh .off) [PREFIX] [--stage delaunay|cdt|refine]
 *     [--radius-edge R] [--max-volume V] [--min-dihedral D] [--memory BYTES]
 *     [--deadline SECONDS] [--vertices N] [--tolerance T] [--merge-angle D]
 *     [--break-points] [--keep-hull] [--hilbert] [--order O2_O1|O1|O2|O3|O4|O5|relatively_short]
 *
 * Writes PREFIX.node, .ele, .face and .edge, and PREFIX.over: a row for each listed exception, its
 * tetrahedron, its radius-edge ratio and the subsegment to blame or -1; .sliver likewise, with
 * the cosine. And one line of JSON on the standard output. A developer's tool: files are believed, and people use tetractl. Exit status:
 * 0 done and the audit passed, 1 the engine refused, 2 usage or file, 3 audit failed. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tet/engine.h>

/* The numbers of a text file, by lines that have any. */
typedef struct rows {
  double *number;
  size_t *start; /* [n + 1] */
  size_t n, n_numbers;
} rows;

typedef struct job {
  const char *input, *prefix;
  tet_options options;
  tet_limits limits;
  tet_pls pls;
} job;

static void die(const char *what, const char *which) {
  fprintf(stderr, "meshpls: %s %s\n", what, which);
  exit(2);
}

static void *grown(void *array, size_t n, size_t size) {
  if (n & (n - 1)) return array; /* doubled at powers of two */
  void *moved = realloc(array, (n ? 2 * n : 1) * size);
  if (!moved) die("no memory for", "the input");
  return moved;
}

static void *zeroed(size_t n, size_t size) {
  void *block = calloc(n ? n : 1, size);
  if (!block) die("no memory for", "the input");
  return block;
}

static rows read_rows(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) die("cannot open", path);
  rows r = {0};
  char *line = NULL;
  size_t size = 0;
  while (getline(&line, &size, file) >= 0) {
    char *hash = strchr(line, '#'), *at = line, *end;
    if (hash) *hash = 0;
    if (strncmp(line, "OFF", 3) == 0) at += 3;
    size_t before = r.n_numbers;
    for (;;) {
      double x = strtod(at, &end);
      if (end == at) break;
      at = end;
      r.number = grown(r.number, r.n_numbers, sizeof *r.number);
      r.number[r.n_numbers++] = x;
    }
    if (r.n_numbers == before) continue;
    r.start = grown(r.start, r.n, sizeof *r.start);
    r.start[r.n++] = before;
  }
  r.start = grown(r.start, r.n, sizeof *r.start);
  r.start[r.n] = r.n_numbers;
  free(line);
  fclose(file);
  return r;
}

static void rows_free(rows *r) {
  free(r->number);
  free(r->start);
}

static const double *row(const rows *r, size_t i, size_t *ret_n) {
  if (i >= r->n) die("the input ends", "early");
  *ret_n = r->start[i + 1] - r->start[i];
  return r->number + r->start[i];
}

/* Vertices from row `at` on; returns the row after them. */
static size_t read_points(const rows *r, size_t at, tet_pls *p, uint32_t *ret_base) {
  size_t k;
  const double *head = row(r, at++, &k);
  uint32_t n = (uint32_t)head[0], attributes = k > 2 ? (uint32_t)head[2] : 0;
  double *points = zeroed(n, 3 * sizeof *points), *values = zeroed((size_t)n * attributes, sizeof *values);
  int32_t *markers = zeroed(n, sizeof *markers);
  for (uint32_t v = 0; v < n; v++) {
    const double *x = row(r, at++, &k);
    if (v == 0) *ret_base = (uint32_t)x[0];
    memcpy(points + 3 * (size_t)v, x + 1, 3 * sizeof *points);
    for (uint32_t a = 0; a < attributes && 4 + a < k; a++) values[v * (size_t)attributes + a] = x[4 + a];
    if (k > 4 + attributes) markers[v] = (int32_t)x[4 + attributes];
  }
  *p = (tet_pls){.n_points = n, .points = points, .n_attributes = attributes, .point_attributes = values,
                 .point_markers = markers, .n_loose_points = TET_LOOSE_ALL_UNUSED};
  return at;
}

/* Facets as they are collected. */
typedef struct facets {
  uint32_t *facet_start, *polygon_start, *vertex, *hole_start;
  int32_t *marker;
  double *hole;
  size_t n_facets, n_polygons, n_vertices, n_holes;
} facets;

static void facet_begin(facets *f, int32_t marker) {
  f->facet_start = grown(f->facet_start, f->n_facets, sizeof *f->facet_start);
  f->hole_start = grown(f->hole_start, f->n_facets, sizeof *f->hole_start);
  f->marker = grown(f->marker, f->n_facets, sizeof *f->marker);
  f->facet_start[f->n_facets] = (uint32_t)f->n_polygons;
  f->hole_start[f->n_facets] = (uint32_t)f->n_holes;
  f->marker[f->n_facets++] = marker;
}

static void facets_end(facets *f, tet_pls *p) {
  facet_begin(f, 0); /* the end of the starts */
  f->polygon_start = grown(f->polygon_start, f->n_polygons, sizeof *f->polygon_start);
  f->polygon_start[f->n_polygons] = (uint32_t)f->n_vertices;
  p->n_facets = (uint32_t)f->n_facets - 1;
  p->facet_start = f->facet_start;
  p->n_polygons = (uint32_t)f->n_polygons;
  p->polygon_start = f->polygon_start;
  p->polygon_vertices = f->vertex;
  p->facet_markers = f->marker;
  p->facet_hole_start = f->hole_start;
  p->n_facet_holes = (uint32_t)f->n_holes;
  p->facet_holes = f->hole;
}

/* One polygon: a count, then vertices, maybe over several rows. The marker that may
 * follow goes to *marker where that is not NULL. Returns the row after it. */
static size_t read_polygon(const rows *r, size_t at, uint32_t base, facets *f, int32_t *marker) {
  size_t k, i = 1;
  const double *x = row(r, at, &k);
  uint32_t n = (uint32_t)x[0];
  f->polygon_start = grown(f->polygon_start, f->n_polygons, sizeof *f->polygon_start);
  f->polygon_start[f->n_polygons++] = (uint32_t)f->n_vertices;
  for (uint32_t c = 0; c < n; c++, i++) {
    if (i == k) {
      x = row(r, ++at, &k);
      i = 0;
    }
    f->vertex = grown(f->vertex, f->n_vertices, sizeof *f->vertex);
    f->vertex[f->n_vertices++] = (uint32_t)x[i] - base;
  }
  if (marker && i < k) *marker = (int32_t)x[i];
  return at + 1;
}

static size_t read_poly_facet(const rows *r, size_t at, uint32_t base, facets *f) {
  size_t k;
  const double *x = row(r, at++, &k);
  uint32_t polygons = (uint32_t)x[0], holes = k > 1 ? (uint32_t)x[1] : 0;
  facet_begin(f, k > 2 ? (int32_t)x[2] : 0);
  for (uint32_t i = 0; i < polygons; i++) at = read_polygon(r, at, base, f, NULL);
  for (uint32_t i = 0; i < holes; i++) {
    x = row(r, at++, &k);
    for (int c = 0; c < 3; c++) {
      f->hole = grown(f->hole, 3 * f->n_holes + (size_t)c, sizeof *f->hole);
      f->hole[3 * f->n_holes + (size_t)c] = x[1 + c];
    }
    f->n_holes++;
  }
  return at;
}

static void read_seeds(const rows *r, size_t at, tet_pls *p) {
  size_t k;
  if (at >= r->n) return;
  uint32_t n = (uint32_t)row(r, at++, &k)[0];
  double *holes = zeroed(n, 3 * sizeof *holes);
  for (uint32_t i = 0; i < n; i++) memcpy(holes + 3 * (size_t)i, row(r, at++, &k) + 1, 3 * sizeof *holes);
  p->n_holes = n;
  p->holes = holes;
  if (at >= r->n) return;
  n = (uint32_t)row(r, at++, &k)[0];
  double *seeds = zeroed(n, 3 * sizeof *seeds), *attribute = zeroed(n, sizeof *attribute);
  double *volume = zeroed(n, sizeof *volume);
  int32_t *marker = zeroed(n, sizeof *marker);
  for (uint32_t i = 0; i < n; i++) {
    const double *x = row(r, at++, &k);
    memcpy(seeds + 3 * (size_t)i, x + 1, 3 * sizeof *seeds);
    if (k > 4) attribute[i] = x[4];
    if (k > 5) volume[i] = x[5];
    marker[i] = (int32_t)attribute[i];
  }
  p->n_regions = n;
  p->region_seeds = seeds;
  p->region_markers = marker;
  p->region_attributes = attribute;
  p->region_max_volumes = volume;
}

static void read_off(const rows *r, tet_pls *p) {
  size_t k, at = 1;
  const double *x = row(r, 0, &k);
  uint32_t n = (uint32_t)x[0], n_facets = (uint32_t)x[1];
  double *points = zeroed(n, 3 * sizeof *points);
  for (uint32_t v = 0; v < n; v++) memcpy(points + 3 * (size_t)v, row(r, at++, &k), 3 * sizeof *points);
  *p = (tet_pls){.n_points = n, .points = points};
  facets f = {0};
  for (uint32_t i = 0; i < n_facets; i++) {
    facet_begin(&f, 0);
    at = read_polygon(r, at, 0, &f, NULL);
  }
  facets_end(&f, p);
}

static void read_tetgen(const char *path, const rows *r, int smesh, tet_pls *p) {
  size_t k;
  uint32_t base = 0;
  size_t at = 1;
  if (row(r, 0, &k)[0] == 0) { /* the points are in the .node file beside it */
    char *node = zeroed(strlen(path) + 6, 1);
    memcpy(node, path, (size_t)(strrchr(path, '.') - path));
    strcat(node, ".node");
    rows points = read_rows(node);
    read_points(&points, 0, p, &base);
    rows_free(&points);
    free(node);
  } else {
    at = read_points(r, 0, p, &base);
  }
  uint32_t n_facets = (uint32_t)row(r, at++, &k)[0];
  facets f = {0};
  for (uint32_t i = 0; i < n_facets; i++) {
    if (smesh) {
      int32_t marker = 0;
      facet_begin(&f, 0);
      at = read_polygon(r, at, base, &f, &marker);
      f.marker[i] = marker;
    } else {
      at = read_poly_facet(r, at, base, &f);
    }
  }
  facets_end(&f, p);
  read_seeds(r, at, p);
}

static void read_input(const char *path, tet_pls *p) {
  const char *ext = strrchr(path, '.');
  if (!ext) die("unknown format", path);
  rows r = read_rows(path);
  uint32_t base;
  if (strcmp(ext, ".off") == 0)
    read_off(&r, p);
  else if (strcmp(ext, ".node") == 0)
    read_points(&r, 0, p, &base);
  else if (strcmp(ext, ".poly") == 0 || strcmp(ext, ".smesh") == 0)
    read_tetgen(path, &r, ext[1] == 's', p);
  else
    die("unknown format", path);
  rows_free(&r);
}

static void free_input(tet_pls *p) {
  const void *all[] = {p->points, p->point_attributes, p->point_markers, p->facet_start, p->polygon_start,
                       p->polygon_vertices, p->facet_markers, p->facet_hole_start, p->facet_holes, p->holes,
                       p->region_seeds, p->region_markers, p->region_attributes, p->region_max_volumes};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    void *block;
    memcpy(&block, &all[i], sizeof block);
    free(block);
  }
}

static FILE *create(const char *prefix, const char *ext) {
  char path[4096];
  snprintf(path, sizeof path, "%s%s", prefix, ext);
  FILE *file = fopen(path, "w");
  if (!file) die("cannot write", path);
  return file;
}

/* Rows of `width` vertices and a last column (int32_t, or NULL: none). */
static void write_rows(const char *prefix, const char *ext, const char *head, uint32_t n, uint32_t width,
                       const uint32_t *v, const int32_t *last) {
  FILE *file = create(prefix, ext);
  fprintf(file, "%u %s\n", n, head);
  for (uint32_t i = 0; i < n; i++) {
    fprintf(file, "%u", i);
    for (uint32_t k = 0; k < width; k++) fprintf(file, " %u", v[(size_t)width * i + k]);
    if (last) fprintf(file, " %d", last[i]);
    fputc('\n', file);
  }
  fclose(file);
}

static void write_listed(const char *prefix, const char *suffix, uint32_t n, const uint32_t *tet, const double *value,
                         const uint32_t *segment) {
  FILE *file = create(prefix, suffix);
  fprintf(file, "%u\n", n);
  for (uint32_t i = 0; i < n; i++)
    fprintf(file, "%u %.17g %lld\n", tet[i], value[i], segment[i] == TET_NONE ? -1LL : (long long)segment[i]);
  fclose(file);
}

static void write_mesh(const char *prefix, const tet_mesh *m) {
  FILE *file = create(prefix, ".node");
  fprintf(file, "%u 3 %u 1\n", m->n_points, m->n_attributes);
  for (uint32_t v = 0; v < m->n_points; v++) {
    const double *x = m->points + 3 * (size_t)v;
    fprintf(file, "%u %.17g %.17g %.17g", v, x[0], x[1], x[2]);
    for (uint32_t k = 0; k < m->n_attributes; k++)
      fprintf(file, " %.17g", m->point_attributes[v * (size_t)m->n_attributes + k]);
    fprintf(file, " %d\n", m->point_markers[v]);
  }
  fclose(file);
  file = create(prefix, ".ele");
  fprintf(file, "%u 4 1\n", m->n_tetrahedra);
  for (uint32_t t = 0; t < m->n_tetrahedra; t++) {
    const uint32_t *v = m->tetrahedra + 4 * (size_t)t;
    fprintf(file, "%u %u %u %u %u %.17g\n", t, v[0], v[1], v[2], v[3], m->region_attributes[m->tetrahedron_regions[t]]);
  }
  fclose(file);
  write_rows(prefix, ".face", "1", m->n_subfaces, 3, m->subfaces, m->subface_markers);
  write_rows(prefix, ".edge", "1", m->n_subsegments, 2, m->subsegments, m->subsegment_markers);
  write_listed(prefix, ".over", m->n_exceptions, m->exception_tetrahedra, m->exception_radius_edge,
               m->exception_segments);
  write_listed(prefix, ".sliver", m->n_slivers, m->sliver_tetrahedra, m->sliver_cosines, m->sliver_segments);
}

static void print_report(const job *j, const tet_mesh *m) {
  const tet_report *r = &m->report;
  const tet_audit *a = &r->audit;
  const tet_counts *c = &r->counts;
  printf("{\"input\":\"%s\",\"points\":%u,\"tets\":%u,\"subfaces\":%u,\"subsegments\":%u,\"regions\":%u,\"exceptions\":%u",
         j->input, m->n_points, m->n_tetrahedra, m->n_subfaces, m->n_subsegments, m->n_regions, m->n_exceptions);
  printf(",\"volume\":%.15g,\"rho\":%.4g,\"dihedral\":[%.4g,%.4g],\"peak\":%llu", r->quality.volume,
         r->quality.radius_edge.max, r->quality.dihedral_min.min, r->quality.dihedral_max.max,
         (unsigned long long)r->peak_bytes);
  if (j->options.break_points)
    printf(",\"break_points\":%llu,\"degeneracies_left\":%llu", (unsigned long long)c->break_points,
           (unsigned long long)c->degeneracies_left);
  printf(",\"squeezed\":%llu", (unsigned long long)c->squeezed_points);
  printf(",\"steiner\":%llu,\"cavities\":%llu,\"flips\":%llu,\"moves\":%llu", (unsigned long long)c->segment_steiner_points,
         (unsigned long long)c->cavities, (unsigned long long)c->rounding_flips, (unsigned long long)c->rounding_moves);
  printf(",\"refined\":[%llu,%llu,%llu]", (unsigned long long)c->refine_segment_points,
         (unsigned long long)c->refine_facet_points, (unsigned long long)c->refine_volume_points);
  printf(",\"slivers\":%u,\"first_slivers\":%llu,\"sliver_points\":%llu,\"sliver_budget\":%llu", m->n_slivers,
         (unsigned long long)c->first_slivers, (unsigned long long)c->sliver_points, (unsigned long long)c->sliver_budget);
  printf(",\"thin_points\":%llu,\"thin_budget\":%llu", (unsigned long long)c->thin_points,
         (unsigned long long)c->thin_budget);
  printf(",\"rejected\":{\"ball\":%llu,\"outside\":%llu,\"subface\":%llu,\"short\":%llu,\"given_up\":%llu}",
         (unsigned long long)r->rejected.protected_ball, (unsigned long long)r->rejected.outside,
         (unsigned long long)r->rejected.lost_subface, (unsigned long long)r->rejected.too_short,
         (unsigned long long)r->rejected.given_up);
  printf(",\"traced\":{\"traced\":%llu,\"slivers\":%llu,\"followed\":%llu,\"within\":%llu,\"farthest\":%.4g}",
         (unsigned long long)r->trace.traced, (unsigned long long)r->trace.slivers,
         (unsigned long long)r->trace.followed, (unsigned long long)r->trace.within, r->trace.farthest);
  printf(",\"promised\":{\"delaunay\":%d,\"cdt\":%d,\"gabriel\":%d,\"covered\":%d,\"planarity\":%.3g,\"merged\":[%.4g,%.3g]}", r->promised.delaunay,
         r->promised.constrained_delaunay, r->promised.gabriel, r->promised.covered, r->promised.planarity,
         r->promised.merged_angle, r->promised.merged_distance);
  printf(",\"audit\":{\"passed\":%s", a->passed ? "true" : "false");
  const struct { const char *name; uint64_t n; } fault[] = {
      {"bad_indices", a->bad_indices}, {"flat", a->flat_or_inverted}, {"adjacency", a->adjacency},
      {"not_delaunay", a->not_delaunay}, {"not_cdt", a->not_constrained_delaunay},
      {"subfaces_missing", a->subfaces_missing}, {"subsegments_missing", a->subsegments_missing},
      {"uncovered", a->uncovered}, {"reflex", a->reflex}, {"broken_segments", a->broken_segments},
      {"facet_slivers", a->facet_slivers},
      {"subfaces_encroached", a->subfaces_encroached}, {"subsegments_encroached", a->subsegments_encroached},
      {"over_radius_edge", a->over_radius_edge}, {"over_volume", a->over_volume},
      {"under_dihedral", a->under_dihedral}, {"region_leaks", a->region_leaks},
      {"wrong_regions", a->wrong_regions}, {"wrong_markers", a->wrong_markers}, {"lost_vertices", a->lost_vertices},
      {"bad_segments", a->bad_segments}, {"bad_facets", a->bad_facets}, {"folded_subfaces", a->folded_subfaces}};
  for (size_t i = 0; i < sizeof fault / sizeof *fault; i++)
    if (fault[i].n) printf(",\"%s\":%llu", fault[i].name, (unsigned long long)fault[i].n);
  if (a->bad_facets) printf(",\"facet\":%u", a->facet);
  printf("},\"stages\":{");
  for (uint32_t i = 0; i < r->n_stages; i++) printf("%s\"%s\":%.4f", i ? "," : "", r->stages[i].name, r->stages[i].seconds);
  printf("},\"cpu\":{");
  for (uint32_t i = 0; i < r->n_stages; i++) printf("%s\"%s\":%.4f", i ? "," : "", r->stages[i].name, r->stages[i].cpu_seconds);
  printf("}}\n");
}

static tet_stage stage_of(const char *name) {
  if (strcmp(name, "delaunay") == 0) return TET_STAGE_DELAUNAY;
  if (strcmp(name, "cdt") == 0) return TET_STAGE_CDT;
  if (strcmp(name, "refine") != 0) die("no such stage:", name);
  return TET_STAGE_REFINE;
}

static tet_insertion order_of(const char *name) {
  static const char *const names[] = {"O2_O1", "O1", "O2", "O3", "O4", "O5", "relatively_short"};
  for (int i = 0; i < 7; i++)
    if (strcmp(name, names[i]) == 0) return (tet_insertion)i;
  die("no such order:", name);
  return TET_INSERT_O2_O1;
}

/* Takes one option that needs a value; 0 if `name` is none. */
static int take_value(job *j, const char *name, const char *value) {
  if (strcmp(name, "--stage") == 0) j->options.stage = stage_of(value);
  else if (strcmp(name, "--radius-edge") == 0) j->options.radius_edge = atof(value);
  else if (strcmp(name, "--max-volume") == 0) j->options.max_volume = atof(value);
  else if (strcmp(name, "--min-dihedral") == 0) j->options.min_dihedral = atof(value);
  else if (strcmp(name, "--order") == 0) j->options.order = order_of(value);
  else if (strcmp(name, "--tolerance") == 0) j->options.planarity_tolerance = atof(value);
  else if (strcmp(name, "--merge-angle") == 0) j->options.merge_angle = atof(value);
  else if (strcmp(name, "--memory") == 0) j->limits.memory_bytes = strtoull(value, NULL, 10);
  else if (strcmp(name, "--vertices") == 0) j->limits.max_vertices = strtoull(value, NULL, 10);
  else if (strcmp(name, "--deadline") == 0) j->limits.deadline_seconds = atof(value);
  else return 0;
  return 1;
}

static void read_arguments(int argc, char **argv, job *j) {
  tet_options_default(&j->options);
  for (int i = 1; i < argc; i++) {
    if (argv[i][0] != '-') {
      if (!j->input) j->input = argv[i];
      else j->prefix = argv[i];
    } else if (strcmp(argv[i], "--keep-hull") == 0) {
      j->options.keep_hull = 1;
    } else if (strcmp(argv[i], "--break-points") == 0) {
      j->options.break_points = 1;
    } else if (strcmp(argv[i], "--hilbert") == 0) {
      j->options.point_order = TET_ORDER_HILBERT;
    } else if (i + 1 < argc && take_value(j, argv[i], argv[i + 1])) {
      i++;
    } else {
      die("no such option, or without its value:", argv[i]);
    }
  }
  if (!j->input) die("usage:", "meshpls INPUT [PREFIX] [options]");
}

static void print_error(const job *j, const tet_error *e) {
  fprintf(stderr, "meshpls: %s: %s: %s\n", j->input, tet_status_name(e->status), e->message);
  for (uint32_t i = 0; i < e->n_listed && i < 8; i++)
    fprintf(stderr, "  kind %d number %u, kind %d number %u, near (%g, %g, %g)\n", (int)e->offences[i].kind[0],
            e->offences[i].index[0], (int)e->offences[i].kind[1], e->offences[i].index[1], e->offences[i].place[0],
            e->offences[i].place[1], e->offences[i].place[2]);
}

int main(int argc, char **argv) {
  job j = {0};
  read_arguments(argc, argv, &j);
  read_input(j.input, &j.pls);
  tet_ctx *ctx;
  tet_mesh *mesh = NULL;
  if (tet_ctx_create(&j.limits, &ctx) != TET_OK) die("no memory for", "a context");
  int result = 0;
  if (tet_mesh_pls(ctx, &j.pls, &j.options, &mesh) != TET_OK) {
    print_error(&j, tet_ctx_error(ctx));
    result = 1;
  } else {
    print_report(&j, mesh);
    if (j.prefix) write_mesh(j.prefix, mesh);
    result = mesh->report.audit.passed ? 0 : 3;
  }
  tet_mesh_free(mesh);
  if (tet_ctx_bytes(ctx)) {
    fprintf(stderr, "meshpls: %llu bytes leaked\n", (unsigned long long)tet_ctx_bytes(ctx));
    result = 4;
  }
  tet_ctx_free(ctx);
  free_input(&j.pls);
  return result;
}
