/* SPDX-License-Identifier: GPL-3.0-or-later
 * A run with an ideal thyristor, which conducts or does not: what the tiers "analytic" and
 * "switched" have in common. While it conducts dlambda/dt = u - R_c i; while it is off lambda = 0
 * and the machine swings freely. The instants between these phases, and those at which the armature
 * meets or leaves its stop, are located to rounding. */
#pragma once

#include "engine/sim.h"

/* The keys that the ideal tiers alone obey. */
extern const vs_tier_key vs_phases_keys[];

/* Runs the setup from t = 0 to run.until. Of the frame gap_at_rest decides between the two tiers:
 * the coil's current is lambda z(0)/(2a) or lambda z/(2a). Of the order, which may be
 * NULL, the early_end counts. Errors: those of vs_sim_refuse_endless
 * and of the observer; VS_RUN where no step is short enough. */
vs_status vs_phases_run(const vs_setup *setup, const vs_run_order *order, const vs_frame *frame,
                        const vs_observer *observer, vs_error *err);
