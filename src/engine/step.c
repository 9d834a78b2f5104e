/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/step.h"

#include <string.h>

#include "plant/coil.h"

/* Weights of value, slope, curvature and third derivative at the two ends of a step, by which a
 * Hermite polynomial is their sum. */
typedef struct weights {
  double y[2], d[2], e[2], f[2];
} weights;

/* An instant as each end of the step sees it: its distance s from that end and r to the other one,
 * both relative to the step's length, and the length h, which is negative at the far end, as time
 * runs backwards from there. */
typedef struct views {
  double s[2], r[2], h[2];
} views;
static inline views views_of(double s, double h) {
  return (views){{s, 1 - s}, {1 - s, s}, {h, -h}};
}

/* The polynomial of degree seven through value and three derivatives at either end. */
static inline weights septic(views v) {
  weights w;
  for (int k = 0; k < 2; k++) {
    double s = v.s[k], r2 = v.r[k] * v.r[k], c = 1 + s * (4 + 10 * s), d = v.h[k] * r2 * r2 * s;
    w.y[k] = r2 * r2 * (c + 20 * s * s * s);
    w.d[k] = d * c;
    w.e[k] = d * v.h[k] * s * (0.5 + 2 * s);
    w.f[k] = d * v.h[k] * v.h[k] * (s * s * (1.0 / 6));
  }
  return w;
}

/* Its slope; h must not be 0. */
static inline weights septic_rate(views v) {
  weights w;
  for (int k = 0; k < 2; k++) {
    double s = v.s[k], r3 = v.r[k] * v.r[k] * v.r[k], hrs = v.h[k] * r3 * s;
    w.y[k] = -140 * r3 * s * s * s / v.h[k];
    w.d[k] = r3 * (1 + s * (3 + s * (6 - 70 * s)));
    w.e[k] = hrs * (1 + s * (3 - 14 * s));
    w.f[k] = hrs * v.h[k] * s * (0.5 - (7.0 / 6) * s);
  }
  return w;
}

/* The cubic through value and slope at either end, which is as much as a solver of second order
 * knows. */
static inline weights cubic(views v) {
  weights w = {.e = {0}};
  for (int k = 0; k < 2; k++) {
    w.y[k] = v.r[k] * v.r[k] * (1 + 2 * v.s[k]);
    w.d[k] = v.h[k] * v.r[k] * v.r[k] * v.s[k];
  }
  return w;
}
static inline weights cubic_rate(views v) {
  weights w = {.e = {0}};
  for (int k = 0; k < 2; k++) {
    w.y[k] = -6 * v.r[k] * v.s[k] / v.h[k];
    w.d[k] = v.r[k] * (1 - 3 * v.s[k]);
  }
  return w;
}

/* Some quantities at one end of the step, side by side, and their first three derivatives. */
typedef struct ends {
  const double *y, *d, *e, *f;
} ends;

static inline __attribute__((always_inline)) void apply(const weights *w, ends a, ends b, int n,
                                                        double *restrict y) {
  for (int i = 0; i < n; i++)
    y[i] = (w->y[0] * a.y[i] + w->y[1] * b.y[i]) + (w->d[0] * a.d[i] + w->d[1] * b.d[i]) +
           ((w->e[0] * a.e[i] + w->e[1] * b.e[i]) + (w->f[0] * a.f[i] + w->f[1] * b.f[i]));
}

static inline ends coordinates_of(const vs_knot *k, int dof) {
  return (ends){k->x, k->x + dof, k->a, k->j};
}

static inline ends flux_of(const vs_knot *k) {
  return (ends){&k->flux_wb, &k->flux_rate_v, &k->flux_rate2_v_s, &k->flux_rate3_v_s2};
}

bool vs_step_is_quiet(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  return a->flux_wb == 0 && b->flux_wb == 0 && a->flux_rate_v == 0 && b->flux_rate_v == 0;
}

/* q, and q' where `rate` is there; a step of no length has the velocities of its end. */
static inline __attribute__((always_inline)) void put_coordinates(const vs_step *step,
                                                                  const weights *w,
                                                                  const weights *rate, int dof,
                                                                  double *restrict q) {
  const ends from = coordinates_of(step->from, dof), to = coordinates_of(step->to, dof);
  apply(w, from, to, dof, q);
  if (rate && step->to->t_s > step->from->t_s)
    apply(rate, from, to, dof, q + dof);
  else
    for (int i = 0; rate && i < dof; i++) q[dof + i] = step->to->x[dof + i];
}

/* `septic` are the weights of the step's slopes. */
static inline __attribute__((always_inline)) double flux_rate(const vs_step *step, views at,
                                                              const weights *septic) {
  if (at.h[0] <= 0) return step->to->flux_rate_v;
  double rate;
  if (step->cubic_flux) {
    const weights own = cubic_rate(at);
    apply(&own, flux_of(step->from), flux_of(step->to), 1, &rate);
  } else {
    apply(septic, flux_of(step->from), flux_of(step->to), 1, &rate);
  }
  return rate;
}

static double line(double from, double to, double s) {
  return from + s * (to - from);
}

/* lambda, i and the force; z is there already. `septic` are the weights of the step's values. */
static inline __attribute__((always_inline)) void put_flux(const vs_step *step, views at,
                                                           const weights *septic, double *y) {
  const vs_frame *frame = step->frame;
  const vs_model *m = frame->model;
  y[VS_CH_LAMBDA] = y[VS_CH_I] = y[VS_CH_FORCE] = 0;
  if (vs_step_is_quiet(step)) return;
  if (step->cubic_flux) {
    const weights own = cubic(at);
    apply(&own, flux_of(step->from), flux_of(step->to), 1, y + VS_CH_LAMBDA);
  } else {
    apply(septic, flux_of(step->from), flux_of(step->to), 1, y + VS_CH_LAMBDA);
  }
  double z = frame->gap_at_rest ? m->coil.gap_rest_m : y[VS_CH_Z];
  y[VS_CH_I] = vs_coil_current(&m->coil, y[VS_CH_LAMBDA], z);
  y[VS_CH_FORCE] = vs_coil_force(&m->coil, y[VS_CH_LAMBDA], z);
}

/* q, q' and the force are there already. */
static void put_accelerations(const vs_step *step, double *y) {
  const vs_model *m = step->frame->model;
  const double *q = y + VS_CH_Q, *v = y + vs_channel_rates(m);
  double a[VS_MOST_DOF], g = vs_mechanics_travel(m, q);
  unsigned touched = vs_stops_touched(&m->stops, g);
  double stop = touched ? vs_stops_force(&m->stops, touched, g, vs_mechanics_travel(m, v)) : 0;
  vs_mechanics_accelerations(m, q, v, y[VS_CH_FORCE] + stop, a);
  if (step->held) vs_mechanics_hold(m, a);
  for (int i = 0; i < m->dof; i++) y[vs_channel_rates2(m) + i] = a[i];
}

/* The machine's own probes. */
static void put_outputs(const vs_model *m, double *y) {
  _Static_assert((int)VS_MACHINE_TERM_Z == VS_CH_Z && (int)VS_MACHINE_TERM_LAMBDA == VS_CH_LAMBDA &&
                     (int)VS_MACHINE_TERM_I == VS_CH_I &&
                     (int)VS_MACHINE_TERM_FORCE == VS_CH_FORCE && (int)VS_MACHINE_TERM_Q == VS_CH_Q,
                 "terms of a machine's formulas are numbers of channels");
  for (int n = 0; n < m->machine->n_probes; n++)
    y[vs_channel_probes(m) + n] = vs_formula_value(&m->machine->probes[n].of, y);
}

static void put_probes(const vs_step *step, double s, double *y) {
  const vs_deck *deck = step->frame->deck;
  size_t first = (size_t)vs_channel_deck(step->frame->model);
  for (size_t n = 0; deck && n < deck->n_probes; n++) {
    const vs_probe *probe = &deck->probes[n];
    double from = step->from->terms[probe->term], to = step->to->terms[probe->term];
    y[first + n] = probe->sign * line(from, to, s);
  }
}

/* vs_step_groups_at for a machine of so many coordinates. */
static inline __attribute__((always_inline)) void groups_at(const vs_step *step, double t_s,
                                                            unsigned groups, int dof, double *y) {
  const vs_knot *a = step->from, *b = step->to;
  const vs_model *m = step->frame->model;
  bool coil = step->frame->source_is_coil;
  double h = b->t_s - a->t_s, s = h > 0 ? (t_s - a->t_s) / h : 1, *q = y + VS_CH_Q;
  const views at = views_of(s, h);
  const weights w = septic(at);
  weights slope;
  if (h > 0 && groups & (VS_GROUP_VELOCITIES | VS_GROUP_V_EVA)) slope = septic_rate(at);
  const weights *rate = groups & VS_GROUP_VELOCITIES ? &slope : NULL;
  put_coordinates(step, &w, rate, dof, q);
  y[VS_CH_TRAVEL] = vs_mechanics_travel(m, q);
  y[VS_CH_Z] = vs_coil_gap(&m->coil, y[VS_CH_TRAVEL]);
  put_flux(step, at, &w, y);
  y[VS_CH_I_MAINS] = coil ? y[VS_CH_I] : line(a->i_mains_a, b->i_mains_a, s);
  if (groups & VS_GROUP_V_EVA)
    y[VS_CH_V_EVA] = coil ? m->actuator.resistance_ohm * y[VS_CH_I] + flux_rate(step, at, &slope)
                          : line(a->v_eva_v, b->v_eva_v, s);
  if (groups & VS_GROUP_V_MAINS) y[VS_CH_V_MAINS] = vs_timeline_voltage(step->frame->timeline, t_s);
  if (groups & VS_GROUP_ACCELERATIONS) put_accelerations(step, y);
  if (groups & VS_GROUP_MACHINE) put_outputs(m, y);
  if (groups & VS_GROUP_DECK) put_probes(step, s, y);
}

void vs_step_groups_at(const vs_step *step, double t_s, unsigned groups, double *y) {
  int dof = step->frame->model->dof;
  if (dof == VS_ROWS)
    groups_at(step, t_s, groups, VS_ROWS, y);
  else
    groups_at(step, t_s, groups, dof, y);
}

static inline __attribute__((always_inline)) void velocities_at(const vs_step *step, double t_s,
                                                                int dof, double *restrict v) {
  const vs_knot *a = step->from, *b = step->to;
  double h = b->t_s - a->t_s;
  if (h > 0) {
    const weights rate = septic_rate(views_of((t_s - a->t_s) / h, h));
    apply(&rate, coordinates_of(a, dof), coordinates_of(b, dof), dof, v);
  } else {
    for (int i = 0; i < dof; i++) v[i] = b->x[dof + i];
  }
}

void vs_step_velocities_at(const vs_step *step, double t_s, double *v) {
  int dof = step->frame->model->dof;
  if (dof == VS_ROWS)
    velocities_at(step, t_s, VS_ROWS, v);
  else
    velocities_at(step, t_s, dof, v);
}

void vs_step_at(const vs_step *step, double t_s, double *y) {
  vs_step_groups_at(step, t_s, VS_GROUP_ALL, y);
}

double vs_step_channel(const vs_step *step, double t_s, int channel) {
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, vs_channel_groups(step->frame->model, &channel, 1), y);
  return y[channel];
}
