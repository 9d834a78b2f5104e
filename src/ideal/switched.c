/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "switched": ideal thyristor, coil resistance, flux linkage as state, exact events:
 * dlambda/dt = u - R_c i with i = lambda z/(2a) (Eqs. 80, 81). */
#include "ideal/phases.h"

static vs_frame frame(const vs_setup *setup) {
  return (vs_frame){.model = &setup->model,
                    .timeline = &setup->timeline,
                    .means = setup->means,
                    .tolerance = setup->run.tolerance,
                    .source_is_coil = true};
}

static vs_status run(const vs_setup *setup, const vs_observer *observer, vs_error *err) {
  const vs_frame f = frame(setup);
  return vs_phases_run(setup, &f, observer, err);
}

const vs_tier vs_switched_tier = {
    "switched", "ideal thyristor, L(z), F = lambda^2/(4a): mechanics, energy, big sweeps", 1e-10,
    frame, run};
