/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "analytic": the paper's own simulation, Eqs. 89-93 and 54. The current is a formula with
 * L(0); the force k_i i^2 drives the mechanics, which do not act back. */
#include <math.h>

#include "sim/phases.h"

/* Eq. 91 for a pulse that fires at t_f, with L = L(0), tau = L/R, theta = atan(w L/R) (Eq. 93):
 *   i = U sqrt2/sqrt(R^2 + (w L)^2) [sin(w t - theta) - exp(-(t - t_f)/tau) sin(w t_f - theta)],
 * w t counted from the rising zero crossing of the mains. */
static double current(const vs_conduction *c, double since_s) {
  const vs_timeline *line = c->frame->timeline;
  const vs_actuator_values *coil = &c->frame->model->actuator;
  double reactance = line->omega_rad_s * coil->inductance_h;
  double theta = atan2(reactance, coil->resistance_ohm);
  return line->peak_v / hypot(coil->resistance_ohm, reactance) *
         (sin(c->fired_phase_rad + line->omega_rad_s * since_s - theta) -
          exp(-since_s * coil->resistance_ohm / coil->inductance_h) *
              sin(c->fired_phase_rad - theta));
}

/* lambda = L(0) i, for which k_i i^2 (Eq. 89) is lambda^2/(4a); dlambda/dt = u - R_c i */
static double flux_rate(const vs_conduction *c, double since_s, double flux_wb,
                        const double x[VS_STATES], double *rate2) {
  (void)flux_wb, (void)x;
  const vs_actuator_values *coil = &c->frame->model->actuator;
  double rate = vs_conduction_mains(c, since_s) - coil->resistance_ohm * current(c, since_s);
  if (rate2)
    *rate2 =
        vs_conduction_mains_rate(c, since_s) - coil->resistance_ohm * rate / coil->inductance_h;
  return rate;
}

static vs_frame frame(const vs_setup *setup) {
  return (vs_frame){.model = &setup->model,
                    .timeline = &setup->timeline,
                    .source_is_coil = true,
                    .gap_at_rest = true};
}

static vs_status run(const vs_setup *setup, const vs_observer *observer, vs_error *err) {
  vs_frame f = frame(setup);
  vs_conduction conduction = {.frame = &f, .flux_rate = flux_rate};
  return vs_phases_run(setup, &conduction, observer, err);
}

const vs_tier vs_tier_analytic = {
    "analytic", "Eq. 91 with L(0), F = k_i i^2: the paper's own simulation; mechanics only", 1e-10,
    frame, run};
