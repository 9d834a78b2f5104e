/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/reducer.h"

#include <math.h>

void vs_reducer_watch(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (!r->limit || !isnan(r->failed_s) || !(after > r->limit->value)) return;
  double part = (r->limit->value - before) / (after - before);
  r->failed_s = c->t0_s + fmin(fmax(part, 0), 1) * c->h_s;
}

void vs_reducer_take_largest(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (after > r->value.value) r->value = (vs_value){true, after, c->t1_s};
  vs_reducer_watch(r, c, before, after);
}

void vs_reducer_offer(vs_reduced *r, vs_value v, bool least) {
  if (!v.known) return;
  if (!r->value.known || (least ? v.value < r->value.value : v.value > r->value.value))
    r->value = v;
  if (!r->limit || !isnan(r->failed_s)) return;
  if (r->measure->held == VS_AT_LEAST ? v.value < r->limit->value : v.value > r->limit->value)
    r->failed_s = v.at_s;
}

bool vs_reducer_is_held_from_below(const vs_reduced *r) {
  return r->measure->held == VS_AT_LEAST;
}

void vs_reducer_count(vs_reduced *r, double at_s) {
  if (r->value.value++ == 0) r->value.at_s = at_s;
}

char *vs_reducer_happens(vs_reduced *r, double at_s) {
  vs_happening *h = r->state;
  if (h->times++) return NULL;
  h->at_s = at_s;
  return h->cause;
}

const vs_happening *vs_reducer_happening(const vs_reduced *r) {
  return r->measure->held == VS_NEVER ? r->state : NULL;
}

const vs_reduced *vs_reducer_of(const vs_watched *w, vs_reduction how) {
  for (size_t k = 0; k < w->count; k++)
    if (w->reduced[k].measure->how == how) return &w->reduced[k];
  return NULL;
}

void vs_reducer_begin_at_zero(const vs_watched *w, vs_reduced *r, double t_s) {
  (void)w, (void)t_s;
  r->value = (vs_value){true, 0, NAN};
}
