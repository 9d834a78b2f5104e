/* SPDX-License-Identifier: GPL-3.0-or-later
 * The two tiers with an ideal thyristor: it conducts or it does not, and the instants between are
 * located exactly. */
#ifndef VS_IDEAL_PHASES_H
#define VS_IDEAL_PHASES_H

#include "sim/sim.h"

/* Of the two frames the tiers have, gap_at_rest alone makes a difference: conducting, dlambda/dt =
 * u - R_c i; off, lambda = 0 and the machine swings freely. */
vs_status vs_phases_run(const vs_setup *setup, const vs_frame *frame, const vs_observer *observer,
                        vs_error *err);

#endif
