/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions of what those tell who follow a device: what it did (measure/switching.h), what its
 * gate pulses were, and what its loss is made of (measure/losses.h). */
#ifndef VS_MEASURE_TOLD_H
#define VS_MEASURE_TOLD_H

#include "measure/reducer.h"

extern const vs_reducer vs_told_rise, vs_told_rise_error, vs_told_off_rate, vs_told_on_rate, vs_told_return_rise,
    vs_told_fall, vs_told_offered, vs_told_misfire, vs_told_unintended, vs_told_commutation_failure,
    vs_told_opens, vs_told_arcs, vs_told_curve, vs_told_open, vs_told_arc, vs_told_clears;
extern const vs_reducer vs_told_gate_least;
extern const vs_reducer vs_told_conduction, vs_told_switching, vs_told_recovery, vs_told_blocking,
    vs_told_e_on, vs_told_e_off, vs_told_e_recovery, vs_told_turned_off;

#endif
