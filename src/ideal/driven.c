/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/driven.h"

#include "actuator/coil.h"

static void complete(const vs_driven *d, vs_knot *k) {
  if (d->held)
    vs_knot_hold(d->frame, k);
  else
    vs_knot_complete(d->frame, k, d->touched);
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
    complete(d, k);
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
  complete(d, k);
  z[2] = moves * vs_mechanics_travel(m, k->a);
  if (m->coil.square)
    square_rates(m, u, z, k);
  else
    law_rates(m, u, z, k);
}
