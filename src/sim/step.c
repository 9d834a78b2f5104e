/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/step.h"

#include <string.h>

#include "machine/actuator.h"

const vs_channel vs_channel_standard[VS_CH_DECK] = {
#define VS_CHANNEL_ROW(id, name, unit, text) {name, unit, text, id != VS_CH_I_MAINS},
    VS_CHANNEL_LIST(VS_CHANNEL_ROW)
#undef VS_CHANNEL_ROW
};

int vs_channel_count(const vs_frame *frame) {
  return VS_CH_DECK + (frame->deck ? (int)frame->deck->n_probes : 0);
}

vs_channel vs_channel_at(const vs_frame *frame, int index) {
  if (index < VS_CH_DECK) return vs_channel_standard[index];
  const vs_probe *probe = &frame->deck->probes[index - VS_CH_DECK];
  return (vs_channel){probe->name, probe->unit, probe->text, true};
}

int vs_channel_find(const vs_frame *frame, const char *name) {
  for (int k = 0; k < vs_channel_count(frame); k++) {
    vs_channel c = vs_channel_at(frame, k);
    if (c.listed && !strcmp(c.name, name)) return k;
  }
  return -1;
}

void vs_knot_copy(const vs_frame *frame, const vs_knot *from, vs_knot *to) {
  size_t terms = frame->deck ? frame->deck->n_terms : 0;
  memcpy(to, from, offsetof(vs_knot, terms) + terms * sizeof *from->terms);
}

void vs_knot_complete(const vs_frame *frame, vs_knot *k, bool touching) {
  const vs_model *m = frame->model;
  double va[VS_STATES], force = vs_actuator_force(m, k->flux_wb), rate;
  vs_mechanics_accelerations(m, k->x, force + (touching ? vs_mechanics_stop_force(m, k->x) : 0),
                             k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  rate = vs_actuator_force_rate(m, k->flux_wb, k->flux_rate_v);
  vs_mechanics_jerks(m, va, rate + (touching ? vs_mechanics_stop_rate(m, k->x, k->a) : 0), k->j);
}

void vs_knot_hold(const vs_frame *frame, vs_knot *k) {
  const vs_model *m = frame->model;
  double va[VS_STATES];
  vs_mechanics_accelerations(m, k->x, vs_actuator_force(m, k->flux_wb), k->a);
  vs_mechanics_hold_p(m, k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  vs_mechanics_jerks(m, va, 0, k->j); /* what acts along p is held */
  vs_mechanics_hold_p(m, k->j);
}

/* Weights of value, slope, curvature and third derivative at the two ends of a step. */
typedef struct weights {
  double y[2], d[2], e[2], f[2];
} weights;

/* The distances s from an end and r to the other, in parts of h, and h: seen from the far end time
 * runs backwards. */
typedef struct views {
  double s[2], r[2], h[2];
} views;
static inline views views_of(double s, double h) {
  return (views){{s, 1 - s}, {1 - s, s}, {h, -h}};
}

/* Hermite polynomials of degree seven. */
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

/* Their slopes; none where h = 0. */
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

/* Of degree three: what a solver of second order has. */
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

/* At one end: some quantities side by side and their derivatives. */
typedef struct ends {
  const double *y, *d, *e, *f;
} ends;

static inline void apply(const weights *w, ends a, ends b, int n, double *restrict y) {
  for (int i = 0; i < n; i++)
    y[i] = (w->y[0] * a.y[i] + w->y[1] * b.y[i]) + (w->d[0] * a.d[i] + w->d[1] * b.d[i]) +
           ((w->e[0] * a.e[i] + w->e[1] * b.e[i]) + (w->f[0] * a.f[i] + w->f[1] * b.f[i]));
}

static ends coordinates_of(const vs_knot *k) {
  return (ends){k->x, k->x + VS_DOF, k->a, k->j};
}

static ends flux_of(const vs_knot *k) {
  return (ends){&k->flux_wb, &k->flux_rate_v, &k->flux_rate2_v_s, &k->flux_rate3_v_s2};
}

bool vs_step_is_quiet(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  return a->flux_wb == 0 && b->flux_wb == 0 && a->flux_rate_v == 0 && b->flux_rate_v == 0;
}

static void velocities(const vs_step *step, views at, double v[VS_DOF]) {
  if (at.h[0] <= 0) {
    memcpy(v, step->to->x + VS_DOF, sizeof(double[VS_DOF]));
    return;
  }
  weights w = septic_rate(at);
  apply(&w, coordinates_of(step->from), coordinates_of(step->to), VS_DOF, v);
}

static double flux_rate(const vs_step *step, views at) {
  if (at.h[0] <= 0) return step->to->flux_rate_v;
  weights w = step->cubic_flux ? cubic_rate(at) : septic_rate(at);
  double rate;
  apply(&w, flux_of(step->from), flux_of(step->to), 1, &rate);
  return rate;
}

static double line(double from, double to, double s) {
  return from + s * (to - from);
}

unsigned vs_channel_groups(const int *channels, int count) {
  unsigned parts = 0;
  for (int k = 0; k < count; k++) {
    int c = channels[k];
    if (c >= VS_CH_DECK)
      parts |= VS_GROUP_DECK;
    else if (c == VS_CH_V_MAINS)
      parts |= VS_GROUP_V_MAINS;
    else if (c == VS_CH_V_EVA)
      parts |= VS_GROUP_V_EVA;
    else if (c >= VS_CH_AP && c <= VS_CH_APHI)
      parts |= VS_GROUP_ACCELERATIONS | VS_GROUP_VELOCITIES;
    else if (c >= VS_CH_VP && c <= VS_CH_VPHI)
      parts |= VS_GROUP_VELOCITIES;
  }
  return parts;
}

void vs_step_groups_at(const vs_step *step, double t_s, unsigned parts, double *y) {
  const vs_knot *a = step->from, *b = step->to;
  const vs_frame *frame = step->frame;
  const vs_model *m = frame->model;
  double h = b->t_s - a->t_s, s = h > 0 ? (t_s - a->t_s) / h : 1, *x = y + VS_CH_P;
  const views at = views_of(s, h);
  weights w = septic(at);
  apply(&w, coordinates_of(a), coordinates_of(b), VS_DOF, x);
  if (parts & VS_GROUP_VELOCITIES) velocities(step, at, x + VS_DOF);
  y[VS_CH_Z] = vs_actuator_gap(m, x[P]);
  y[VS_CH_LAMBDA] = y[VS_CH_I] = y[VS_CH_FORCE] = 0;
  if (!vs_step_is_quiet(step)) {
    if (step->cubic_flux) w = cubic(at);
    apply(&w, flux_of(a), flux_of(b), 1, y + VS_CH_LAMBDA);
    y[VS_CH_I] =
        vs_actuator_current(m, y[VS_CH_LAMBDA], frame->gap_at_rest ? m->gap_rest_m : y[VS_CH_Z]);
    y[VS_CH_FORCE] = vs_actuator_force(m, y[VS_CH_LAMBDA]);
  }
  y[VS_CH_I_MAINS] = frame->source_is_coil ? y[VS_CH_I] : line(a->i_mains_a, b->i_mains_a, s);
  if (parts & VS_GROUP_V_EVA)
    y[VS_CH_V_EVA] = frame->source_is_coil
                         ? m->actuator.resistance_ohm * y[VS_CH_I] + flux_rate(step, at)
                         : line(a->v_eva_v, b->v_eva_v, s);
  if (parts & VS_GROUP_V_MAINS) y[VS_CH_V_MAINS] = vs_timeline_voltage(frame->timeline, t_s);
  if (parts & VS_GROUP_ACCELERATIONS) {
    vs_mechanics_accelerations(
        m, x, y[VS_CH_FORCE] + (vs_mechanics_in_stop(m, x[P]) ? vs_mechanics_stop_force(m, x) : 0),
        y + VS_CH_AP);
    if (step->held) vs_mechanics_hold_p(m, y + VS_CH_AP);
  }
  for (size_t n = 0; parts & VS_GROUP_DECK && frame->deck && n < frame->deck->n_probes; n++) {
    const vs_probe *probe = &frame->deck->probes[n];
    y[VS_CH_DECK + n] = probe->sign * line(a->terms[probe->term], b->terms[probe->term], s);
  }
}

void vs_step_at(const vs_step *step, double t_s, double *y) {
  vs_step_groups_at(step, t_s, VS_GROUP_ALL, y);
}

double vs_step_channel(const vs_step *step, double t_s, int channel) {
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, vs_channel_groups(&channel, 1), y);
  return y[channel];
}
