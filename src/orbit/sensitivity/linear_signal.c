/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/linear_signal.h"

#include <math.h>
#include <string.h>

#include "measure/chebyshev.h"

/* ---- which channels are linear ---- */

/* A probe of the machine is tried out: with y(e) its value where one term is 1 and all others are
 * 0, it is linear if y(h e) - y(0) = h (y(e) - y(0)) with h = 2 and h = -1 for each term, and if
 * all terms together make the sum of these. *k: its coefficients of the terms from VS_CH_Q on. */
static bool is_linear_probe(const vs_model *m, const vs_formula *of, double k[VS_SEEN_TERMS]) {
  double y[VS_CH_MOST] = {0}, sum = 0, size = 0;
  if (vs_formula_uses(of, VS_MACHINE_TERM_LAMBDA) || vs_formula_uses(of, VS_MACHINE_TERM_I) ||
      vs_formula_uses(of, VS_MACHINE_TERM_FORCE) || vs_formula_uses(of, VS_MACHINE_TERM_Z))
    return false;
  double rest = vs_formula_value(of, y);
  for (int i = 0; i < 3 * m->dof; i++) {
    double *term = &y[VS_CH_Q + i];
    *term = 1;
    k[i] = vs_formula_value(of, y) - rest;
    for (int n = 0; n < 2; n++) {
      *term = n ? -1 : 2;
      double off = vs_formula_value(of, y) - rest - *term * k[i];
      if (!(fabs(off) <= 1e-9 * (fabs(rest) + fabs(k[i])))) return false;
    }
    *term = 0;
    sum += k[i];
    size += fabs(k[i]);
  }
  for (int i = 0; i < 3 * m->dof; i++) y[VS_CH_Q + i] = 1;
  return fabs(vs_formula_value(of, y) - rest - sum) <= 1e-9 * (fabs(rest) + size);
}

static bool is_linear(const vs_frame *frame, int channel, double k[VS_SEEN_TERMS]) {
  const vs_model *m = frame->model;
  if (channel == VS_CH_TRAVEL || channel == VS_CH_Z) {
    memcpy(k, m->along, (size_t)m->dof * sizeof *k);
    return true;
  }
  if (channel < VS_CH_Q || channel >= vs_channel_deck(m)) return false;
  if (channel < vs_channel_probes(m)) {
    k[channel - VS_CH_Q] = 1;
    return true;
  }
  return is_linear_probe(m, &m->machine->probes[channel - vs_channel_probes(m)].of, k);
}

static const vs_linear_signal_extreme NONE = {NAN, NAN};

static void forget_extremes(vs_linear_signal *s) {
  for (int k = 0; k < 2; k++) s->best[k] = s->next[k] = NONE;
}

vs_status vs_linear_signal_begin(vs_linear_signal *s, const vs_frame *frame,
                                 const vs_linear_signal_order *order, vs_error *err) {
  const vs_channel channel = vs_channel_at(frame, order->channel);
  *s = (vs_linear_signal){.order = *order, .unit = channel.unit};
  forget_extremes(s);
  if (!is_linear(frame, order->channel, s->k))
    return vs_fail(err, VS_INPUT,
                   "%s is not linear in the motion, and has no row of a linear model; coordinates, "
                   "their rates and their second rates have",
                   channel.name);
  s->lowpass = vs_lowpass_make(order->bandwidth_hz, order->order, order->damping);
  s->states = s->lowpass.rate > 0 ? order->order : 0;
  return VS_OK;
}

/* ---- along the orbit ---- */

/* The angle that the fastest of the motion turns in one part of a step. A polynomial of degree six
 * leaves out some 1e-13 of it. */
static const double TURN = 0.2;

int vs_linear_signal_parts(const vs_step *step) {
  const vs_model *m = step->frame->model;
  double h = step->to->t_s - step->from->t_s;
  double middle = vs_step_channel(step, step->from->t_s + h / 2, VS_CH_TRAVEL);
  double fastest = fmax(vs_stops_touched(&m->stops, middle) ? m->contact_rad_s : m->fastest_rad_s,
                        step->frame->timeline->omega_rad_s);
  return (int)fmin(fmax(ceil(h * fastest / TURN), 1), 1e6);
}

/* The signal in one part of a step, at s from 0 to 1. */
typedef struct part {
  vs_lowpass lowpass; /* at s = 0 */
  double h_s, u[VS_LOWPASS_TERMS];
} part;

/* Value and slope; of the slope only the sign counts. */
static double signal_at(const part *p, double s, double *slope) {
  double value = 0, scaled[VS_LOWPASS_TERMS], power = 1;
  *slope = 0;
  for (int k = VS_LOWPASS_DEGREE; k >= 0; k--) {
    *slope = *slope * s + value;
    value = value * s + p->u[k];
  }
  if (!(p->lowpass.rate > 0)) return value;
  vs_lowpass at = p->lowpass;
  for (int k = 0; k < VS_LOWPASS_TERMS; k++, power *= s) scaled[k] = p->u[k] * power;
  if (s > 0) vs_lowpass_advance(&at, s * p->h_s, scaled);
  *slope = at.works_on ? at.x[1] : value - at.x[0];
  return at.x[0];
}

/* side: 0 of a largest value, 1 of a least one. */
static void keep_signal_extreme(vs_linear_signal *s, int side, double value, double at_s) {
  double sense = side ? -1 : 1;
  vs_linear_signal_extreme *best = &s->best[side], *next = &s->next[side];
  if (isnan(best->value) || sense * value > sense * best->value) {
    *next = *best;
    *best = (vs_linear_signal_extreme){value, at_s};
  } else if (isnan(next->value) || sense * value > sense * next->value) {
    *next = (vs_linear_signal_extreme){value, at_s};
  }
}

/* Takes the turn between two values of s; at the first the signal rises, or falls. */
static void take_signal_turn(vs_linear_signal *s, const part *p, double lo, double hi,
                             double from_s) {
  double slope;
  for (int n = 0; n < 60; n++) {
    double mid = (lo + hi) / 2;
    signal_at(p, mid, &slope);
    if ((slope > 0) == s->rises)
      lo = mid;
    else
      hi = mid;
  }
  keep_signal_extreme(s, s->rises ? 0 : 1, signal_at(p, hi, &slope), from_s + hi * p->h_s);
}

static void take_signal_turns(vs_linear_signal *s, const part *p, double from_s) {
  enum { LOOKS = 4 };
  double slope;
  signal_at(p, 0, &slope);
  if (!s->began) s->rises = slope > 0;
  s->began = true;
  for (int k = 0; k < LOOKS; k++) {
    signal_at(p, (k + 1.0) / LOOKS, &slope);
    if ((slope > 0) == s->rises) continue;
    take_signal_turn(s, p, (double)k / LOOKS, (k + 1.0) / LOOKS, from_s);
    s->rises = slope > 0;
  }
}

void vs_linear_signal_accept(vs_linear_signal *s, const vs_step *step) {
  int parts = vs_linear_signal_parts(step);
  double from_s = step->from->t_s, h_s = (step->to->t_s - from_s) / parts;
  for (int n = 0; n < parts && h_s > 0; n++) {
    part p = {.lowpass = s->lowpass, .h_s = h_s};
    double at_s = from_s + n * h_s;
    const vs_chebyshev c = vs_chebyshev_of(step, s->order.channel, at_s, at_s + h_s);
    vs_chebyshev_powers(&c, p.u);
    take_signal_turns(s, &p, at_s);
    if (s->states) vs_lowpass_advance(&s->lowpass, h_s, p.u);
  }
}

void vs_linear_signal_close(vs_linear_signal *s, double period_s) {
  const double rest[2] = {0, 0};
  if (s->states) vs_lowpass_close(&s->lowpass, rest, period_s);
  memcpy(s->start, s->lowpass.x, sizeof s->start);
  forget_extremes(s);
  s->began = false;
}

double vs_linear_signal_amplitude(const vs_linear_signal *s) {
  return (s->best[0].value - s->best[1].value) / 2;
}

double vs_linear_signal_margin(const vs_linear_signal *s) {
  double least = INFINITY;
  for (int k = 0; k < 2; k++) /* fmin passes over what is NaN */
    least = fmin(least, fabs(s->best[k].value - s->next[k].value));
  return least;
}

double vs_linear_signal_edge(const vs_linear_signal *s, double period_s) {
  double least = INFINITY;
  for (int k = 0; k < 2; k++)
    least = fmin(least, fmin(s->best[k].at_s, period_s - s->best[k].at_s));
  return least;
}
