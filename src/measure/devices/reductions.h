/* SPDX-License-Identifier: GPL-3.0-or-later
 * All reductions: one plug for each vs_reduction that the deck's kinds name (netlist/kinds.h). A
 * new one is a constant struct in the file that fits it, a line here and a row of
 * VS_REDUCTION_LIST. */
#pragma once

#include "measure/reducer.h"

/* The plugs, by vs_reduction. */
extern const vs_reducer *const vs_reductions_all[VS_REDUCTIONS];

/* Those that stand in files of their own. */
extern const vs_reducer vs_switching_reductions_rise, vs_switching_reductions_rise_error,
    vs_switching_reductions_off_rate, vs_switching_reductions_on_rate,
    vs_switching_reductions_return_rise, vs_switching_reductions_fall,
    vs_switching_reductions_offered, vs_switching_reductions_misfire,
    vs_switching_reductions_unintended, vs_switching_reductions_commutation_failure;
extern const vs_reducer vs_switching_reductions_gate_least;
extern const vs_reducer vs_switching_reductions_conduction, vs_switching_reductions_switching,
    vs_switching_reductions_recovery, vs_switching_reductions_blocking,
    vs_switching_reductions_e_on, vs_switching_reductions_e_off, vs_switching_reductions_e_recovery,
    vs_switching_reductions_turned_off,
    vs_switching_reductions_avalanche;
extern const vs_reducer vs_fuse_reduction_opens, vs_fuse_reduction_arcs, vs_fuse_reduction_curve,
    vs_fuse_reduction_open, vs_fuse_reduction_arc, vs_fuse_reduction_clears;
extern const vs_reducer vs_pulse_heat;
extern const vs_reducer vs_surge_within, vs_surge_let_through, vs_surge_melting, vs_surge_peak,
    vs_surge_pulses, vs_surge_rows, vs_surge_short;
extern const vs_reducer vs_junction_of_power, vs_junction_of_current, vs_junction_case,
    vs_junction_hottest;
