/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/junction.h"

#include <math.h>
#include <string.h>

#include "deck/parts.h"

/* On an orbit the rise at the period's beginning is that at its end. A run that is repeated (the
 * keys times and every of an event) begins with what the runs before it have left. Both are known
 * at the run's end. So the power over the run is kept: each step's mean and its end. Where there
 * are more steps than that, each two neighbours become one. */
enum { KEPT = 32768 };
typedef struct heating {
  double end_s, power_w;
} heating;

/* The Foster network of the device's part, and the rise of each of its terms. */
typedef struct network {
  double tau_s[VS_PART_ZTH];
  double gain[VS_PART_ZTH]; /* rise in the long run, K over the unit of the course */
  double rise_k[VS_PART_ZTH];
  size_t count;
  double begun_s;
  size_t n_kept;
  heating kept[]; /* [KEPT] where the run comes again, else [0] */
} network;

/* Takes the part's lines zth. The course is this many W to its unit. */
static void take_network(const vs_watched *w, vs_reduced *r, double scale_w) {
  const vs_deck *deck = w->deck;
  network *n = r->state;
  const char *file = w->device->part < 0 ? "" : deck->parts[w->device->part].file;
  for (size_t k = 0; k < deck->n_zth; k++) {
    if (strcmp(deck->zth[k].where.file, file)) continue;
    n->tau_s[n->count] = deck->zth[k].tau_s;
    n->gain[n->count++] = scale_w * deck->zth[k].k_per_w;
    r->assumed = r->assumed || deck->zth[k].assumed;
  }
}

static void prepare_junction(vs_watched *w, vs_reduced *r) {
  take_network(w, r, 1);
}

/* What a capacitor stores and gives back is no heat; ESR i^2 is, by the part's limit esr. */
static void prepare_core(vs_watched *w, vs_reduced *r) {
  const char *file = w->device->part < 0 ? NULL : w->deck->parts[w->device->part].file;
  const vs_limit *esr = file ? vs_parts_find_limit(w->deck, file, "esr") : NULL;
  if (!esr || !isfinite(esr->value)) return;
  r->assumed = esr->assumed;
  take_network(w, r, esr->value);
}

static bool has_network(const vs_watched *w, const vs_reduced *r) {
  const network *n = r->state;
  (void)w;
  return n->count;
}

static void begin_junction(const vs_watched *w, vs_reduced *r, double t_s) {
  network *n = r->state;
  n->begun_s = t_s;
  vs_reducer_begin_at_zero(w, r, t_s);
}

static double rise_of(const network *n) {
  double rise_k = 0;
  for (size_t k = 0; k < n->count; k++) rise_k += n->rise_k[k];
  return rise_k;
}

/* Each term moves on its own, under a power that is constant for h_s. Returns the rise of all. */
static double heat_up(network *n, double power_w, double h_s) {
  for (size_t k = 0; k < n->count; k++) {
    double less = -expm1(-h_s / n->tau_s[k]);
    n->rise_k[k] += less * (n->gain[k] * power_w - n->rise_k[k]);
  }
  return rise_of(n);
}

static void halve(network *n) {
  double from_s = n->begun_s;
  for (size_t k = 0; k < KEPT / 2; k++) {
    const heating *a = &n->kept[2 * k], *b = a + 1;
    double joule = a->power_w * (a->end_s - from_s) + b->power_w * (b->end_s - a->end_s);
    const heating both = {b->end_s, joule / (b->end_s - from_s)};
    from_s = b->end_s;
    n->kept[k] = both;
  }
  n->n_kept = KEPT / 2;
}

static void follow_junction(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  network *n = r->state;
  double before = rise_of(n), power_w = c->more[r->measure->of] / c->h_s;
  double after = heat_up(n, power_w, c->h_s);
  if (!w->again) {
    vs_reducer_take_largest(r, c, before, after);
    return;
  }
  if (n->n_kept == KEPT) halve(n);
  n->kept[n->n_kept++] = (heating){c->t1_s, power_w};
}

/* From 0 a term comes to b in the period T, and from s to s e^(-T/tau) + b. On an orbit that is s
 * again: s = b/(1 - e^(-T/tau)). */
static double of_orbit(double period_s, double tau_s) {
  return 1 / -expm1(-period_s / tau_s);
}

/* What b at the end of a run becomes until the run that comes n-th begins, T behind the one before
 * it, with that of all runs before it: b e^(-(T-D)/tau) (1 - q^(n-1))/(1 - q), q = e^(-T/tau); D is
 * how long the run is. */
static double of_times(const vs_occurrence *e, double length_s, double tau_s) {
  double q_to_n = (e->v.times - 1) * e->v.every_s / tau_s;
  return exp(-(e->v.every_s - length_s) / tau_s) * expm1(-q_to_n) / expm1(-e->v.every_s / tau_s);
}

/* From what the run begins with it is gone through once more. */
static void finish_junction(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  network *n = r->state;
  vs_course_step c = {.t1_s = n->begun_s};
  if (!w->again || !n->count) return;
  const vs_occurrence *e = vs_occurrence_repeated(&w->timeline->events);
  const double length_s = end->now_s - n->begun_s;
  for (size_t k = 0; k < n->count; k++)
    n->rise_k[k] *=
        w->at_work ? of_orbit(length_s, n->tau_s[k]) : of_times(e, length_s, n->tau_s[k]);
  r->value = (vs_value){true, rise_of(n), n->begun_s};
  for (size_t k = 0; k < n->n_kept; k++) {
    double before = rise_of(n);
    c.t0_s = c.t1_s;
    c.t1_s = n->kept[k].end_s;
    c.h_s = c.t1_s - c.t0_s;
    vs_reducer_take_largest(r, &c, before, heat_up(n, n->kept[k].power_w, c.h_s));
  }
}

const vs_reducer vs_junction_of_power = {.state_size = sizeof(network),
                                         .again_size = KEPT * sizeof(heating),
                                         .prepare = prepare_junction,
                                         .is_busy = has_network,
                                         .begin = begin_junction,
                                         .follow = follow_junction,
                                         .finish = finish_junction},
                 vs_junction_of_current = {.state_size = sizeof(network),
                                           .again_size = KEPT * sizeof(heating),
                                           .prepare = prepare_core,
                                           .is_busy = has_network,
                                           .begin = begin_junction,
                                           .follow = follow_junction,
                                           .finish = finish_junction};
