/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/reducer.h"

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

bool vs_reducer_has_limit(const vs_watched *w, const vs_reduced *r) {
  (void)w;
  return r->limit;
}

/* ---- a window ---- */

void vs_reducer_window_begin(vs_window *w, double width_s, double t_s) {
  *w = (vs_window){.part_s = width_s / VS_WINDOW_PARTS, .starts_s = t_s};
}

static void next_part(vs_window *w) {
  enum { RING = VS_WINDOW_PARTS + 1 };
  w->now = (w->now + 1) % RING;
  w->part[w->now] = w->whole = 0;
  for (size_t k = 2; k <= VS_WINDOW_PARTS; k++) w->whole += w->part[(w->now + k) % RING];
  w->starts_s += w->part_s;
}

double vs_reducer_window_add(vs_window *w, const vs_course_step *c, double more) {
  double from_s = c->t0_s;
  double skipped = floor((c->t1_s - w->starts_s) / w->part_s) - VS_WINDOW_PARTS - 1;
  if (skipped > 0) w->starts_s += skipped * w->part_s; /* a step longer than all of it */
  from_s = fmax(from_s, w->starts_s);
  while (c->t1_s > w->starts_s + w->part_s) {
    double end_s = fmax(w->starts_s + w->part_s, from_s);
    w->part[w->now] += more * (end_s - from_s) / c->h_s;
    from_s = end_s;
    next_part(w);
  }
  w->part[w->now] += more * (c->t1_s - from_s) / c->h_s;
  double oldest = w->part[(w->now + 1) % (VS_WINDOW_PARTS + 1)];
  double still_in = fmax(1 - (c->t1_s - w->starts_s) / w->part_s, 0);
  return w->sum = w->whole + w->part[w->now] + still_in * oldest;
}
