/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "switched": ideal thyristor, coil resistance, flux linkage as state, exact events. */
#include "machine/actuator.h"
#include "sim/phases.h"

/* dlambda/dt = u - R_c i,  i = lambda z/(2a) (Eqs. 80, 81);  d2lambda/dt2 = du/dt - R_c di/dt */
static double flux_rate(const vs_conduction *c, double since_s, double flux_wb,
                        const double x[VS_STATES], double *rate2) {
  const vs_model *m = c->frame->model;
  double z = vs_gap(m, x[P]), r = m->actuator.resistance_ohm;
  double rate = vs_conduction_mains(c, since_s) - r * vs_current(m, flux_wb, z);
  if (rate2)
    *rate2 = vs_conduction_mains_rate(c, since_s) -
             r * vs_current_rate(m, flux_wb, rate, z, x[VS_DOF + P]);
  return rate;
}

static vs_frame frame(const vs_setup *setup) {
  return (vs_frame){.model = &setup->model, .timeline = &setup->timeline, .source_is_coil = true};
}

static vs_status run(const vs_setup *setup, const vs_observer *observer, vs_error *err) {
  vs_frame f = frame(setup);
  vs_conduction conduction = {.frame = &f, .flux_rate = flux_rate};
  return vs_phases_run(setup, &conduction, observer, err);
}

const vs_tier vs_tier_switched = {
    "switched", "ideal thyristor, L(z), F = lambda^2/(4a): mechanics, energy, big sweeps", 1e-10,
    frame, run};
