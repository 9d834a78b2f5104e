/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/driven.h"

#include <math.h>

#include "engine/firing.h"
#include "plant/coil.h"

static void complete_driven_knot(const vs_driven *d, vs_knot *k) {
  if (d->held)
    vs_step_hold_knot(d->frame, k);
  else
    vs_step_complete_knot(d->frame, k, d->touched);
}

/* The last two derivatives of lambda where i = lambda z/(2a). */
static void square_rates(const vs_model *m, const double u[3], const double z[3], vs_knot *k) {
  double r = m->actuator.resistance_ohm / (2 * m->coil.a_hm);
  k->flux_rate2_v_s = u[1] - r * (k->flux_rate_v * z[0] + k->flux_wb * z[1]);
  k->flux_rate3_v_s2 =
      u[2] - r * (k->flux_rate2_v_s * z[0] + 2 * k->flux_rate_v * z[1] + k->flux_wb * z[2]);
}

/* The same for any law. The second derivative of i needs the second of lambda, which needs the
 * first of i. */
static void law_rates(const vs_model *m, const double u[3], const double z[3], vs_knot *k) {
  double i[3], force[3], flux[3] = {k->flux_wb, k->flux_rate_v, 0};
  m->coil.law->along(&m->coil, flux, z, i, force);
  k->flux_rate2_v_s = flux[2] = u[1] - m->actuator.resistance_ohm * i[1];
  m->coil.law->along(&m->coil, flux, z, i, force);
  k->flux_rate3_v_s2 = u[2] - m->actuator.resistance_ohm * i[2];
}

/* dlambda/dt = u - R_c i and two derivatives more, where z' and z" are the travel's, or 0 on the
 * tier that keeps the inductance. */
void vs_driven_fill(const vs_driven *d, double since_s, vs_knot *k) {
  const vs_model *m = d->frame->model;
  k->flux_rate_v = k->flux_rate2_v_s = k->flux_rate3_v_s2 = 0;
  if (!d->conducting) {
    complete_driven_knot(d, k);
    return;
  }
  double u[3], moves = d->frame->gap_at_rest ? 0 : 1, z[3];
  z[0] = vs_coil_gap(&m->coil, moves * vs_mechanics_travel(m, k->x));
  z[1] = moves * vs_mechanics_travel(m, k->x + m->dof);
  vs_wave_at(&d->mains, since_s, u);
  if (m->coil.square) {
    double r = m->actuator.resistance_ohm / (2 * m->coil.a_hm);
    k->flux_rate_v = u[0] - r * k->flux_wb * z[0];
  } else {
    k->flux_rate_v =
        u[0] - m->actuator.resistance_ohm * vs_coil_current(&m->coil, k->flux_wb, z[0]);
  }
  complete_driven_knot(d, k);
  z[2] = moves * vs_mechanics_travel(m, k->a);
  if (m->coil.square)
    square_rates(m, u, z, k);
  else
    law_rates(m, u, z, k);
}

void vs_driven_find_coordinates(vs_driven *d) {
  const vs_model *m = d->frame->model;
  double w = m->working_rad_s > 0 ? m->working_rad_s : m->fastest_rad_s;
  double force = fabs(vs_coil_force(&m->coil, d->flux_wb, m->coil.gap_rest_m));
  double per_newton = fabs(m->per_newton_m_s2), closes = m->coil.gap_rest_m / per_newton;
  bool held = m->plain || force / (w * w) < closes;
  for (int i = 0; i < m->dof; i++) {
    double own = fmax(fabs(m->mf[i]), 1e-6 * per_newton);
    d->coordinate[i] = held ? own * force / (w * w) : own * closes;
  }
}

/* A flux linkage below this, relative to that of the mains, is none: it comes from a voltage that
 * was as good as none. */
static const double FAINT = 1e-9;

double vs_driven_built_up(const vs_driven *d, double t_s) {
  const vs_timeline *line = d->frame->timeline;
  const vs_wave *wave = &d->mains;
  double most = fmin(vs_wave_edge(line, t_s) - t_s, line->period_s), flux = 0;
  double half = fmin(vs_wave_turns(wave, -1, 0, most), most) / 2;
  for (size_t k = 0; k < wave->count; k++) { /* its integral: cosines' difference */
    const vs_sine *s = &wave->sine[k];
    double turned = s->omega_rad_s * half;
    flux += 2 * s->peak_v / s->omega_rad_s * sin(s->phase_rad + turned) * sin(turned);
  }
  return fmax(flux, FAINT * line->peak_v / line->omega_rad_s);
}

void vs_driven_find_large(vs_driven *d, bool valve) {
  const vs_timeline *line = d->frame->timeline;
  double range[2] = {0, 0};
  if (valve) vs_firing_range(line, range);
  d->flux_wb = line->peak_v / line->omega_rad_s * (1 + cos(range[0]));
  if (line->supply.direct) {
    const vs_coil *coil = &d->frame->model->coil;
    d->flux_wb = line->peak_v * fmin(coil->rest_h / coil->resistance_ohm, line->period_s);
  }
  vs_driven_find_coordinates(d);
}

double vs_driven_mains_turn(const vs_driven *d, bool disturbed, double most_s) {
  const vs_wave *u = &d->mains;
  if (!u->count) return INFINITY;
  if (!disturbed) return (M_PI - u->sine[0].phase_rad) / u->sine[0].omega_rad_s;
  return fmin(vs_wave_turns(u, -1, d->since_s, most_s), most_s); /* NaN: it does not */
}
