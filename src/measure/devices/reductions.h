/* SPDX-License-Identifier: GPL-3.0-or-later
 * All reductions: one plug for each vs_reduction that the deck's kinds name (netlist/kinds.h). A
 * new one is a constant struct in the file that fits it, a line here and a row of
 * VS_REDUCTION_LIST. */
#ifndef VS_MEASURE_REDUCTIONS_H
#define VS_MEASURE_REDUCTIONS_H

#include "measure/reducer.h"

/* The plugs, by vs_reduction. */
extern const vs_reducer *const vs_reductions_all[VS_REDUCTIONS];

/* Those that stand in files of their own. */
extern const vs_reducer vs_told_rise, vs_told_rise_error, vs_told_off_rate, vs_told_on_rate,
    vs_told_return_rise, vs_told_fall, vs_told_offered, vs_told_misfire, vs_told_unintended,
    vs_told_commutation_failure;
extern const vs_reducer vs_told_gate_least;
extern const vs_reducer vs_told_conduction, vs_told_switching, vs_told_recovery, vs_told_blocking,
    vs_told_e_on, vs_told_e_off, vs_told_e_recovery, vs_told_turned_off;
extern const vs_reducer vs_fuse_reduction_opens, vs_fuse_reduction_arcs, vs_fuse_reduction_curve,
    vs_fuse_reduction_open, vs_fuse_reduction_arc, vs_fuse_reduction_clears;
extern const vs_reducer vs_pulse_heat;
extern const vs_reducer vs_surge_within, vs_surge_let_through, vs_surge_melting, vs_surge_peak,
    vs_surge_pulses, vs_surge_rows, vs_surge_short;
extern const vs_reducer vs_junction_of_power, vs_junction_of_current, vs_junction_case,
    vs_junction_hottest;

#endif
