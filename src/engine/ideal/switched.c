/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "switched": ideal thyristor, coil resistance, flux linkage as state, exact events:
 * dlambda/dt = u - R_c i with i = lambda z/(2a) (Eqs. 80, 81). */
#include "engine/sim.h"

#include "ideal/phases.h"

static vs_status run_switched(const vs_setup *setup, const vs_run_order *order,
                              const vs_observer *observer, vs_error *err) {
  const vs_frame frame = vs_sim_frame(&vs_switched_tier, setup);
  return vs_phases_run(setup, order, &frame, observer, err);
}

const vs_tier vs_switched_tier = {
    .name = vs_setup_tier_words[VS_TIER_SWITCHED],
    .text = "ideal thyristor, L(z), F = lambda^2/(4a): mechanics, energy, big sweeps",
    .finest = 1e-10,
    .automatic = true,
    .keys = vs_phases_keys,
    .run = run_switched};
