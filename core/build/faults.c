// SPDX-License-Identifier: Apache-2.0
/* faults.c: what is wrong with a PLS, collected and then told at once: every
 * offending element or pair with markers and a place (design section 2). */
#include <stdlib.h>

#include "build/soup.h"

tet_status tet_soup_fault(tet_soup *s, const tet_fault *fault) {
  tet_status st = tet_grow(s->ctx, &s->fault, &s->cap_fault, (size_t)s->n_faults + 1, sizeof *s->fault);
  if (st == TET_OK) s->fault[s->n_faults++] = *fault;
  return st;
}

/* Degenerate and out of plane facets first, then bad seeds, then crossings: those of
 * a facet that is none would be noise. */
static int rank(tet_status status) {
  static const tet_status order[] = {TET_E_DEGENERATE, TET_E_NOT_PLANAR, TET_E_SEED, TET_E_INTERSECTION};
  int i = 0;
  while (i < 3 && order[i] != status) i++;
  return i;
}

static int compare_faults(const void *px, const void *py) {
  const tet_fault *x = px, *y = py;
  const tet_offence *a = &x->offence, *b = &y->offence;
  if (rank(x->status) != rank(y->status)) return rank(x->status) - rank(y->status);
  for (int k = 0; k < 2; k++) {
    if (a->kind[k] != b->kind[k]) return a->kind[k] == TET_OFFENDER_FACET ? -1 : 1;
    if (a->index[k] != b->index[k]) return a->index[k] < b->index[k] ? -1 : 1;
  }
  for (int k = 0; k < 3; k++)
    if (a->place[k] != b->place[k]) return a->place[k] < b->place[k] ? -1 : 1;
  return 0;
}

static int same_pair(const tet_fault *x, const tet_fault *y) {
  const tet_offence *a = &x->offence, *b = &y->offence;
  return x->status == y->status && a->kind[0] == b->kind[0] && a->kind[1] == b->kind[1] &&
         a->index[0] == b->index[0] && a->index[1] == b->index[1];
}

/* The lower of two facets first; facets before segments. */
static void normalize(tet_offence *o) {
  if (o->index[1] == TET_NONE) return;
  int swap = o->kind[0] == o->kind[1] ? o->index[0] > o->index[1] : o->kind[1] == TET_OFFENDER_FACET;
  if (!swap) return;
  tet_offence was = *o;
  for (int k = 0; k < 2; k++) {
    o->kind[k] = was.kind[1 - k];
    o->index[k] = was.index[1 - k];
  }
}

static int32_t marker_of(const tet_pls *pls, tet_offender_kind kind, uint32_t index) {
  if (index == TET_NONE) return 0;
  if (kind == TET_OFFENDER_FACET) return tet_facet_marker(pls, index);
  return pls->segment_markers ? pls->segment_markers[index] : 0;
}

static const char *kind_name(tet_offender_kind kind) {
  return kind == TET_OFFENDER_FACET ? "facet" : "segment";
}

static void tell(const tet_soup *s, const tet_fault *f, uint32_t n) {
  const tet_offence *o = &f->offence;
  const double *x = o->place;
  const char *k0 = kind_name(o->kind[0]), *k1 = kind_name(o->kind[1]);
  if (f->status == TET_E_NOT_PLANAR && f->amount > s->tolerance)
    tet_fail(s->ctx, f->status,
             "facet %u (marker %d) is out of plane by %.3g, the tolerance is %.3g; %u such facets in all",
             o->index[0], o->marker[0], f->amount, s->tolerance, n);
  else if (o->index[1] == TET_NONE)
    tet_fail(s->ctx, f->status, "%s %u (marker %d) %s near (%.9g, %.9g, %.9g); %u such in all", k0,
             o->index[0], o->marker[0], f->what, x[0], x[1], x[2], n);
  else if (o->kind[0] == o->kind[1] && o->index[0] == o->index[1])
    tet_fail(s->ctx, f->status, "%s %u (marker %d) crosses itself near (%.9g, %.9g, %.9g); %u pairs in all",
             k0, o->index[0], o->marker[0], x[0], x[1], x[2], n);
  else
    tet_fail(s->ctx, f->status,
             "%s %u (marker %d) and %s %u (marker %d) %s near (%.9g, %.9g, %.9g); %u pairs in all", k0,
             o->index[0], o->marker[0], k1, o->index[1], o->marker[1], f->what ? f->what : "cross", x[0], x[1],
             x[2], n);
}

tet_status tet_soup_fail(tet_soup *s) {
  if (s->n_faults == 0) return TET_OK;
  for (uint32_t i = 0; i < s->n_faults; i++) {
    tet_offence *o = &s->fault[i].offence;
    normalize(o);
    for (int k = 0; k < 2; k++) o->marker[k] = marker_of(s->pls, o->kind[k], o->index[k]);
  }
  qsort(s->fault, s->n_faults, sizeof *s->fault, compare_faults);
  uint32_t n = 0;
  for (uint32_t i = 0; i < s->n_faults; i++)
    if (s->fault[i].status == s->fault[0].status && (i == 0 || !same_pair(&s->fault[i], &s->fault[i - 1]))) n++;
  tet_status status = s->fault[0].status;
  tell(s, &s->fault[0], n);
  for (uint32_t i = 0; i < s->n_faults; i++)
    if (s->fault[i].status == status && (i == 0 || !same_pair(&s->fault[i], &s->fault[i - 1])))
      tet_offend(s->ctx, &s->fault[i].offence);
  return status;
}
