// SPDX-License-Identifier: Apache-2.0
/* chain.c: adds the links of a 1-chain up: first those between the same two vertices,
 * then, along each line in the order of its points, those that overlap in part. */
#include "audit/chain.h"

#include "base/sort.h"
#include "exact/predicates.h"

#include <string.h>

tet_status tet_chain_add(tet_ctx *ctx, tet_chain *chain, uint32_t facet, uint32_t from, uint32_t to, int32_t n) {
  tet_status status = tet_grow(ctx, &chain->link, &chain->cap, chain->n + 1, sizeof *chain->link);
  if (status == TET_OK) chain->link[chain->n++] = (tet_link){facet, from, to, n};
  return status;
}

void tet_chain_free(tet_ctx *ctx, tet_chain *chain) {
  tet_free(ctx, chain->link);
  *chain = (tet_chain){0};
}

int tet_same_direction(const double *a, const double *b, const double *c) {
  for (int k = 0; k < 3; k++)
    if ((b[k] > a[k]) - (b[k] < a[k]) != (c[k] > a[k]) - (c[k] < a[k])) return 0;
  return tet_collinear_xyz(a, b, c);
}

uint64_t tet_ordered_bits(double x) {
  uint64_t bits;
  x += 0.0; /* -0 becomes 0 */
  memcpy(&bits, &x, sizeof bits);
  return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

/* Sorts vertices (in .value) by x, y, z from coordinate `axis` on. */
static void sort_places(const double *points, tet_keyed *item, size_t n, int axis) {
  for (size_t i = 0; i < n; i++) item[i].key = tet_ordered_bits(points[3 * item[i].value + (size_t)axis]);
  tet_sort_keyed(item, n);
  for (size_t i = 0, run; i < n && axis < 2; i += run) {
    uint64_t key = item[i].key;
    for (run = 1; i + run < n && item[i + run].key == key;) run++;
    if (run > 1) sort_places(points, item + i, run, axis + 1);
  }
}

/* Links of one facet on their way along their lines: from the lower to the higher rank. */
typedef struct sweep {
  const double *points;
  size_t n_ranks;
  tet_keyed *at;       /* [ranks] value: the vertex; by place */
  uint32_t *head;      /* [ranks] first link that starts there, or TET_NONE */
  uint32_t *next;      /* [links] */
  uint32_t *low, *high; /* [links] ranks */
  int32_t *n;          /* [links] low to high */
  size_t cap_at, cap_head, cap_next, cap_low, cap_high, cap_n;
} sweep;

static void sweep_free(tet_ctx *ctx, sweep *s) {
  tet_free(ctx, s->at);
  tet_free(ctx, s->head);
  tet_free(ctx, s->next);
  tet_free(ctx, s->low);
  tet_free(ctx, s->high);
  tet_free(ctx, s->n);
}

static const double *place(const sweep *s, uint32_t rank) { return s->points + 3 * s->at[rank].value; }

/* Ranks the vertices of links[0 .. m) by place; fills low, high, n and the lists. */
static tet_status sweep_begin(tet_ctx *ctx, sweep *s, const tet_link *link, size_t m) {
  tet_status status = tet_grow(ctx, &s->at, &s->cap_at, 2 * m, sizeof *s->at);
  if (status == TET_OK) status = tet_grow(ctx, &s->head, &s->cap_head, 2 * m, sizeof *s->head);
  if (status == TET_OK) status = tet_grow(ctx, &s->next, &s->cap_next, m, sizeof *s->next);
  if (status == TET_OK) status = tet_grow(ctx, &s->low, &s->cap_low, m, sizeof *s->low);
  if (status == TET_OK) status = tet_grow(ctx, &s->high, &s->cap_high, m, sizeof *s->high);
  if (status == TET_OK) status = tet_grow(ctx, &s->n, &s->cap_n, m, sizeof *s->n);
  if (status != TET_OK) return status;
  for (size_t i = 0; i < m; i++) {
    s->at[2 * i].key = s->at[2 * i].value = link[i].from;
    s->at[2 * i + 1].key = s->at[2 * i + 1].value = link[i].to;
  }
  tet_sort_keyed(s->at, 2 * m);
  size_t n = 0;
  for (size_t i = 0; i < 2 * m; i++)
    if (i == 0 || s->at[i].value != s->at[n - 1].value) s->at[n++] = s->at[i];
  sort_places(s->points, s->at, n, 0);
  s->n_ranks = n;
  memset(s->head, 0xff, n * sizeof *s->head);
  return TET_OK;
}

static void put(sweep *s, uint32_t i) {
  s->next[i] = s->head[s->low[i]];
  s->head[s->low[i]] = i;
}

/* From vertices to ranks: by sorting the vertices again, once for all links. */
static tet_status enter_links(tet_ctx *ctx, sweep *s, const tet_link *link, size_t m) {
  tet_keyed *rank = tet_alloc(ctx, s->n_ranks, sizeof *rank); /* key: vertex, value: rank */
  if (!rank) return tet_ctx_error(ctx)->status;
  for (size_t i = 0; i < s->n_ranks; i++) rank[i] = (tet_keyed){s->at[i].value, i};
  tet_sort_keyed(rank, s->n_ranks);
  for (size_t i = 0; i < m; i++) {
    uint32_t end[2] = {link[i].from, link[i].to}, at[2];
    for (int k = 0; k < 2; k++) {
      size_t lo = 0, hi = s->n_ranks;
      while (hi - lo > 1) {
        size_t mid = lo + (hi - lo) / 2;
        if (rank[mid].key <= end[k]) lo = mid;
        else hi = mid;
      }
      at[k] = (uint32_t)rank[lo].value;
    }
    int up = at[0] < at[1];
    s->low[i] = at[!up];
    s->high[i] = at[up];
    s->n[i] = up ? link[i].n : -link[i].n;
    put(s, (uint32_t)i);
  }
  tet_free(ctx, rank);
  return TET_OK;
}

/* Takes the links that leave rank r in one direction as far as the first of them ends. */
static tet_status advance(tet_ctx *ctx, sweep *s, uint32_t r, uint32_t facet, tet_chain *out) {
  uint32_t first = s->head[r], same = TET_NONE, other = TET_NONE, nearest = UINT32_MAX;
  int32_t sum = 0;
  for (uint32_t i = first, next; i != TET_NONE; i = next) {
    next = s->next[i];
    int with = i == first || tet_same_direction(place(s, r), place(s, s->high[first]), place(s, s->high[i]));
    s->next[i] = with ? same : other;
    if (!with) {
      other = i;
      continue;
    }
    same = i;
    sum += s->n[i];
    if (s->high[i] < nearest) nearest = s->high[i];
  }
  s->head[r] = other;
  /* what is left ends where other links begin; where nothing is left nothing does */
  for (uint32_t c = r + 1, end = nearest; sum && c < end && nearest == end; c++)
    if (tet_same_direction(place(s, r), place(s, end), place(s, c))) nearest = c;
  for (uint32_t i = same, next; i != TET_NONE; i = next) {
    next = s->next[i];
    if (s->high[i] == nearest) continue;
    s->low[i] = nearest;
    put(s, i);
  }
  if (!sum) return TET_OK;
  return tet_chain_add(ctx, out, facet, (uint32_t)s->at[r].value, (uint32_t)s->at[nearest].value, sum);
}

/* Adds up links[0 .. *n) between the same two vertices; *n then counts what is left. */
static void add_equal(tet_link *link, size_t *n, tet_keyed *item) {
  size_t kept = 0;
  for (size_t i = 0; i < *n; i++) {
    uint32_t a = link[i].from, b = link[i].to;
    if (a > b) link[i] = (tet_link){link[i].facet, b, a, -link[i].n};
    item[i] = (tet_keyed){(uint64_t)link[i].from << 32 | link[i].to, (uint64_t)(int64_t)link[i].n};
  }
  tet_sort_keyed(item, *n);
  uint32_t facet = *n ? link[0].facet : 0;
  for (size_t i = 0, run; i < *n; i += run) {
    int64_t sum = 0;
    for (run = 0; i + run < *n && item[i + run].key == item[i].key; run++) sum += (int64_t)item[i + run].value;
    if (sum) link[kept++] = (tet_link){facet, (uint32_t)(item[i].key >> 32), (uint32_t)item[i].key, (int32_t)sum};
  }
  *n = kept;
}

tet_status tet_chain_reduce(tet_ctx *ctx, const double *points, uint32_t n_facets, tet_chain *chain) {
  tet_chain out = {0};
  sweep s = {.points = points};
  size_t *start = tet_calloc(ctx, (size_t)n_facets + 2, sizeof *start);
  tet_link *sorted = tet_alloc(ctx, chain->n, sizeof *sorted);
  tet_keyed *item = tet_alloc(ctx, chain->n, sizeof *item);
  tet_status status = start && sorted && item ? TET_OK : tet_ctx_error(ctx)->status;
  if (status == TET_OK) {
    for (size_t i = 0; i < chain->n; i++) start[chain->link[i].facet + 2]++;
    for (uint32_t f = 0; f < n_facets; f++) start[f + 2] += start[f + 1];
    for (size_t i = 0; i < chain->n; i++) sorted[start[chain->link[i].facet + 1]++] = chain->link[i];
  }
  for (uint32_t f = 0; f < n_facets && status == TET_OK; f++) {
    size_t m = start[f + 1] - start[f];
    tet_link *link = sorted + start[f];
    if ((f & 255) == 0) status = tet_poll(ctx);
    add_equal(link, &m, item);
    if (!m || status != TET_OK) continue;
    status = sweep_begin(ctx, &s, link, m);
    if (status == TET_OK) status = enter_links(ctx, &s, link, m);
    for (uint32_t r = 0; status == TET_OK && r < s.n_ranks; r++)
      while (status == TET_OK && s.head[r] != TET_NONE) status = advance(ctx, &s, r, f, &out);
  }
  sweep_free(ctx, &s);
  tet_free(ctx, start);
  tet_free(ctx, sorted);
  tet_free(ctx, item);
  if (status != TET_OK) {
    tet_chain_free(ctx, &out);
    return status;
  }
  tet_chain_free(ctx, chain);
  *chain = out;
  return TET_OK;
}
