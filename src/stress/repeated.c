/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/repeated.h"

#include <math.h>
#include <stdio.h>

#include "deck/devices.h"

/* ---- against a table ---- */

/* Below this a varistor has no pulse but its leakage, A; as in stress/pulse.c. */
static const double LEAST_A = 1e-3;

typedef struct derated {
  double peak_a, charge_c, at_s; /* of the present pulse */
  double part;    /* of what is allowed, the most that a pulse was; 0: there was none */
  vs_limit limit; /* of that pulse */
} derated;

static bool has_table(const vs_watched *w, const vs_reduced *r) {
  (void)r;
  return vs_devices_has_pulses(w->deck, w->device);
}

static void begin_derated(const vs_watched *w, vs_reduced *r, double t_s) {
  derated *d = r->state;
  *d = (derated){.at_s = t_s};
  (void)w;
}

/* What the table says of the present pulse becomes the limit, if it comes nearer to that than the
 * pulses before. */
static void end_pulse(const vs_watched *w, vs_reduced *r) {
  derated *d = r->state;
  const vs_occurrence *e = vs_occurrence_repeated(&w->timeline->events);
  double number = e ? e->v.times : 1, width_s = d->charge_c / d->peak_a;
  bool assumed;
  double allowed_a = vs_devices_bears(w->deck, w->device, width_s, number, &assumed);
  double part = d->peak_a / allowed_a;
  if (isnan(allowed_a) && d->peak_a > r->value.value && !r->limit) {
    r->value = (vs_value){true, d->peak_a, d->at_s};
    r->unjudged = "not judged: the part's table of pulses ends before this width or number";
  }
  if (!(part > d->part)) return;
  d->part = part;
  d->limit = (vs_limit){.name = "pulse", .unit = "A", .value = allowed_a, .assumed = assumed};
  snprintf(d->limit.text, sizeof d->limit.text, "%.4g pulses of %.4g us", number, 1e6 * width_s);
  snprintf(d->limit.written, sizeof d->limit.written, "%.4g A", allowed_a);
  r->value = (vs_value){true, d->peak_a, d->at_s};
  r->limit = &d->limit;
  r->unjudged = NULL;
  if (part > 1 && isnan(r->failed_s)) r->failed_s = d->at_s;
}

static void follow_derated(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  derated *d = r->state;
  double to_a = fabs(c->to[VS_OF_I]);
  if (to_a < LEAST_A) {
    if (d->peak_a > 0) end_pulse(w, r);
    d->peak_a = d->charge_c = 0;
    return;
  }
  d->charge_c += fabs(c->more[VS_OF_I]);
  if (to_a > d->peak_a) d->peak_a = to_a, d->at_s = c->t1_s;
}

static void finish_derated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const derated *d = r->state;
  (void)end;
  if (has_table(w, r) && d->peak_a > 0) end_pulse(w, r);
}

/* ---- mean power ---- */

static void finish_repeated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_occurrence *e = vs_occurrence_repeated(&w->timeline->events);
  (void)end;
  if (e) r->value = (vs_value){true, w->sum[r->measure->of] / e->v.every_s, NAN};
}

const vs_reducer vs_repeated_derated = {.state_size = sizeof(derated),
                                        .is_busy = has_table,
                                        .begin = begin_derated,
                                        .follow = follow_derated,
                                        .finish = finish_derated},
                 vs_repeated_mean = {.finish = finish_repeated};
