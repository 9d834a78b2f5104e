/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/step.h"

#include <string.h>

#include "machine/actuator.h"

const vs_channel vs_channels[VS_CH_DECK] = {
#define VS_CHANNEL_ROW(id, name, unit, text) {name, unit, text, id != VS_CH_I_MAINS},
    VS_CHANNEL_LIST(VS_CHANNEL_ROW)
#undef VS_CHANNEL_ROW
};

int vs_channel_count(const vs_frame *frame) {
  return VS_CH_DECK + (frame->deck ? (int)frame->deck->n_probes : 0);
}

vs_channel vs_channel_at(const vs_frame *frame, int index) {
  if (index < VS_CH_DECK) return vs_channels[index];
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
  double va[VS_STATES], force = vs_force(m, k->flux_wb), rate;
  vs_accelerations(m, k->x, force + (touching ? vs_stop_force(m, k->x) : 0), k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  rate = vs_force_rate(m, k->flux_wb, k->flux_rate_v);
  vs_jerks(m, va, rate + (touching ? vs_stop_rate(m, k->x, k->a) : 0), k->j);
}

/* Weights at s in [0,1] of a step of h for values, slopes and curvatures (y, y', y'') at its two
 * ends. */
typedef struct weights {
  double h, y0, d0, e0, y1, d1, e1;
} weights;

/* Quintic Hermite polynomial. */
static weights quintic(double s, double h) {
  double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
  return (weights){h,
                   1 - 10 * s3 + 15 * s4 - 6 * s5,
                   s - 6 * s3 + 8 * s4 - 3 * s5,
                   (s2 - 3 * s3 + 3 * s4 - s5) / 2,
                   10 * s3 - 15 * s4 + 6 * s5,
                   -4 * s3 + 7 * s4 - 3 * s5,
                   (s3 - 2 * s4 + s5) / 2};
}

static weights quintic_rate(double s, double h) {
  double s2 = s * s, s3 = s2 * s, s4 = s3 * s;
  return (weights){h,
                   -30 * s2 + 60 * s3 - 30 * s4,
                   1 - 18 * s2 + 32 * s3 - 15 * s4,
                   s - (9 * s2 - 12 * s3 + 5 * s4) / 2,
                   30 * s2 - 60 * s3 + 30 * s4,
                   -12 * s2 + 28 * s3 - 15 * s4,
                   (3 * s2 - 8 * s3 + 5 * s4) / 2};
}

static weights cubic(double s, double h) {
  double s2 = s * s, s3 = s2 * s;
  return (weights){h, 1 - 3 * s2 + 2 * s3, s - 2 * s2 + s3, 0, 3 * s2 - 2 * s3, s3 - s2, 0};
}

static weights cubic_rate(double s, double h) {
  return (weights){h, 6 * s * (s - 1), 1 - 4 * s + 3 * s * s, 0, 6 * s * (1 - s), s * (3 * s - 2),
                   0};
}

/* At one end: some quantities side by side, their slopes, their curvatures. */
typedef struct ends {
  const double *y, *d, *e;
} ends;

static inline void apply(const weights *w, ends from, ends to, int n, double *restrict y) {
  for (int i = 0; i < n; i++)
    y[i] = w->y0 * from.y[i] + w->y1 * to.y[i] + w->h * (w->d0 * from.d[i] + w->d1 * to.d[i]) +
           w->h * w->h * (w->e0 * from.e[i] + w->e1 * to.e[i]);
}

static ends flux_of(const vs_knot *k) {
  return (ends){&k->flux_wb, &k->flux_rate_v, &k->flux_rate2_v_s};
}

static double flux_rate(const vs_step *step, double s, double h) {
  weights w = step->cubic_flux ? cubic_rate(s, h) : quintic_rate(s, h);
  double rate;
  apply(&w, flux_of(step->from), flux_of(step->to), 1, &rate);
  return h > 0 ? rate / h : step->to->flux_rate_v;
}

static double line(double from, double to, double s) {
  return from + s * (to - from);
}

unsigned vs_parts_of(const int *channels, int count) {
  unsigned parts = 0;
  for (int k = 0; k < count; k++) {
    int c = channels[k];
    if (c >= VS_CH_DECK)
      parts |= VS_PART_DECK;
    else if (c == VS_CH_V_MAINS)
      parts |= VS_PART_V_MAINS;
    else if (c == VS_CH_V_EVA)
      parts |= VS_PART_V_EVA;
    else if (c >= VS_CH_AP && c <= VS_CH_APHI)
      parts |= VS_PART_ACCELERATIONS | VS_PART_VELOCITIES;
    else if (c >= VS_CH_VP && c <= VS_CH_VPHI)
      parts |= VS_PART_VELOCITIES;
  }
  return parts;
}

void vs_step_parts_at(const vs_step *step, double t_s, unsigned parts, double *y) {
  const vs_knot *a = step->from, *b = step->to;
  const vs_frame *frame = step->frame;
  const vs_model *m = frame->model;
  double h = b->t_s - a->t_s, s = h > 0 ? (t_s - a->t_s) / h : 1, *x = y + VS_CH_P;
  weights w = quintic(s, h), flux = step->cubic_flux ? cubic(s, h) : w;
  apply(&w, (ends){a->x, a->x + VS_DOF, a->a}, (ends){b->x, b->x + VS_DOF, b->a}, VS_DOF, x);
  if (parts & VS_PART_VELOCITIES)
    apply(&w, (ends){a->x + VS_DOF, a->a, a->j}, (ends){b->x + VS_DOF, b->a, b->j}, VS_DOF,
          x + VS_DOF);
  y[VS_CH_Z] = vs_gap(m, x[P]);
  apply(&flux, flux_of(a), flux_of(b), 1, y + VS_CH_LAMBDA);
  y[VS_CH_I] = vs_current(m, y[VS_CH_LAMBDA], frame->gap_at_rest ? m->gap_rest_m : y[VS_CH_Z]);
  y[VS_CH_FORCE] = vs_force(m, y[VS_CH_LAMBDA]);
  y[VS_CH_I_MAINS] = frame->source_is_coil ? y[VS_CH_I] : line(a->i_mains_a, b->i_mains_a, s);
  if (parts & VS_PART_V_EVA)
    y[VS_CH_V_EVA] = frame->source_is_coil
                         ? m->actuator.resistance_ohm * y[VS_CH_I] + flux_rate(step, s, h)
                         : line(a->v_eva_v, b->v_eva_v, s);
  if (parts & VS_PART_V_MAINS) y[VS_CH_V_MAINS] = vs_mains(frame->timeline, t_s);
  if (parts & VS_PART_ACCELERATIONS)
    vs_accelerations(m, x, y[VS_CH_FORCE] + (vs_in_stop(m, x[P]) ? vs_stop_force(m, x) : 0),
                     y + VS_CH_AP);
  for (size_t n = 0; parts & VS_PART_DECK && frame->deck && n < frame->deck->n_probes; n++) {
    const vs_probe *probe = &frame->deck->probes[n];
    y[VS_CH_DECK + n] = probe->sign * line(a->terms[probe->term], b->terms[probe->term], s);
  }
}

void vs_step_at(const vs_step *step, double t_s, double *y) {
  vs_step_parts_at(step, t_s, VS_PART_ALL, y);
}

double vs_step_channel(const vs_step *step, double t_s, int channel) {
  double y[VS_CH_MOST];
  vs_step_parts_at(step, t_s, vs_parts_of(&channel, 1), y);
  return y[channel];
}
