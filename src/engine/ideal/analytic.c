/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "analytic": the paper's own simulation, Eqs. 89-93 and 54. The coil keeps L(0), and the
 * force k_i i^2 drives the mechanics, which do not act back. With theta = atan(w L/R_c), tau =
 * L/R_c (Eq. 93), w t counted from the rising zero crossing of the mains and a pulse that fires at
 * t_f, i = U sqrt2/sqrt(R_c^2 + (w L)^2) [sin(w t - theta) - exp(-(t - t_f)/tau) sin(w t_f -
 * theta)] (Eq. 91) is the solution of dlambda/dt = u - R_c i with lambda = L(0) i, for which k_i
 * i^2 (Eq. 89) is lambda^2/(4a): the switched tier's equations with the gap at rest. */
#include "engine/sim.h"

#include "ideal/phases.h"

static vs_status run_analytic(const vs_setup *setup, const vs_run_order *order,
                              const vs_observer *observer, vs_error *err) {
  const vs_frame frame = vs_sim_frame(&vs_analytic_tier, setup);
  return vs_phases_run(setup, order, &frame, observer, err);
}

const vs_tier vs_analytic_tier = {
    .name = vs_setup_tier_words[VS_TIER_ANALYTIC],
    .text = "Eq. 91 with L(0), F = k_i i^2: the paper's own simulation; mechanics only",
    .finest = 1e-10,
    .gap_at_rest = true,
    .keys = vs_phases_keys,
    .run = run_analytic};
