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

void vs_knot_complete(const vs_frame *frame, vs_knot *k, bool touching) {
  const vs_model *m = frame->model;
  double va[VS_STATES], force = vs_force(m, k->flux_wb), rate;
  vs_accelerations(m, k->x, force + (touching ? vs_stop_force(m, k->x) : 0), k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  rate = vs_force_rate(m, k->flux_wb, k->flux_rate_v);
  vs_jerks(m, va, rate + (touching ? vs_stop_rate(m, k->x, k->a) : 0), k->j);
}

/* Weights of the quintic Hermite polynomial at s in [0,1] for (y0, h y0', h^2 y0'', y1, h y1', h^2
 * y1''). */
typedef struct weights {
  double y0, d0, e0, y1, d1, e1;
} weights;

static weights quintic(double s) {
  double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
  return (weights){1 - 10 * s3 + 15 * s4 - 6 * s5,  s - 6 * s3 + 8 * s4 - 3 * s5,
                   (s2 - 3 * s3 + 3 * s4 - s5) / 2, 10 * s3 - 15 * s4 + 6 * s5,
                   -4 * s3 + 7 * s4 - 3 * s5,       (s3 - 2 * s4 + s5) / 2};
}

static weights quintic_rate(double s) {
  double s2 = s * s, s3 = s2 * s, s4 = s3 * s;
  return (weights){-30 * s2 + 60 * s3 - 30 * s4,        1 - 18 * s2 + 32 * s3 - 15 * s4,
                   s - (9 * s2 - 12 * s3 + 5 * s4) / 2, 30 * s2 - 60 * s3 + 30 * s4,
                   -12 * s2 + 28 * s3 - 15 * s4,        (3 * s2 - 8 * s3 + 5 * s4) / 2};
}

static weights cubic(double s) {
  double s2 = s * s, s3 = s2 * s;
  return (weights){1 - 3 * s2 + 2 * s3, s - 2 * s2 + s3, 0, 3 * s2 - 2 * s3, s3 - s2, 0};
}

static weights cubic_rate(double s) {
  return (weights){6 * s * (s - 1), 1 - 4 * s + 3 * s * s, 0, 6 * s * (1 - s), s * (3 * s - 2), 0};
}

static double apply(const weights *w, double h, const double from[3], const double to[3]) {
  return w->y0 * from[0] + w->y1 * to[0] + h * (w->d0 * from[1] + w->d1 * to[1]) +
         h * h * (w->e0 * from[2] + w->e1 * to[2]);
}

/* State between the knots, into a knot without derivatives but the flux's. */
static void interpolate(const vs_step *step, double t_s, vs_knot *k) {
  const vs_knot *a = step->from, *b = step->to;
  double h = b->t_s - a->t_s, s = h > 0 ? (t_s - a->t_s) / h : 1;
  weights w = quintic(s);
  for (int i = 0; i < VS_DOF; i++) {
    k->x[i] = apply(&w, h, (double[]){a->x[i], a->x[VS_DOF + i], a->a[i]},
                    (double[]){b->x[i], b->x[VS_DOF + i], b->a[i]});
    k->x[VS_DOF + i] = apply(&w, h, (double[]){a->x[VS_DOF + i], a->a[i], a->j[i]},
                             (double[]){b->x[VS_DOF + i], b->a[i], b->j[i]});
  }
  weights f = step->cubic_flux ? cubic(s) : w;
  weights r = step->cubic_flux ? cubic_rate(s) : quintic_rate(s);
  const double fa[3] = {a->flux_wb, a->flux_rate_v, a->flux_rate2_v_s};
  const double fb[3] = {b->flux_wb, b->flux_rate_v, b->flux_rate2_v_s};
  k->flux_wb = apply(&f, h, fa, fb);
  k->flux_rate_v = h > 0 ? apply(&r, h, fa, fb) / h : b->flux_rate_v;
  k->v_eva_v = a->v_eva_v + s * (b->v_eva_v - a->v_eva_v);
  k->i_mains_a = a->i_mains_a + s * (b->i_mains_a - a->i_mains_a);
  for (size_t n = 0; step->frame->deck && n < step->frame->deck->n_terms; n++)
    k->terms[n] = a->terms[n] + s * (b->terms[n] - a->terms[n]);
}

void vs_step_at(const vs_step *step, double t_s, double *y) {
  const vs_frame *frame = step->frame;
  const vs_model *m = frame->model;
  vs_knot k;
  interpolate(step, t_s, &k);
  memcpy(y + VS_CH_P, k.x, sizeof k.x);
  double z = vs_gap(m, k.x[P]);
  y[VS_CH_Z] = z;
  y[VS_CH_LAMBDA] = k.flux_wb;
  y[VS_CH_I] = vs_current(m, k.flux_wb, frame->gap_at_rest ? m->gap_rest_m : z);
  y[VS_CH_FORCE] = vs_force(m, k.flux_wb);
  y[VS_CH_V_EVA] =
      frame->source_is_coil ? m->actuator.resistance_ohm * y[VS_CH_I] + k.flux_rate_v : k.v_eva_v;
  y[VS_CH_V_MAINS] = vs_mains(frame->timeline, t_s);
  y[VS_CH_I_MAINS] = frame->source_is_coil ? y[VS_CH_I] : k.i_mains_a;
  double stop = vs_in_stop(m, k.x[P]) ? vs_stop_force(m, k.x) : 0;
  vs_accelerations(m, k.x, y[VS_CH_FORCE] + stop, y + VS_CH_AP);
  for (size_t n = 0; frame->deck && n < frame->deck->n_probes; n++)
    y[VS_CH_DECK + n] = frame->deck->probes[n].sign * k.terms[frame->deck->probes[n].term];
}

double vs_step_channel(const vs_step *step, double t_s, int channel) {
  double y[VS_CH_MOST];
  vs_step_at(step, t_s, y);
  return y[channel];
}
