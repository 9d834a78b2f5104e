/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions to the largest rise of a temperature, by the transient thermal impedance of the
 * device's part (its lines zth): that of a junction, under the device's power; that of a
 * capacitor's core, under ESR i^2. Without such lines, or without a limit esr, no value is known.
 */
#ifndef VS_STRESS_JUNCTION_H
#define VS_STRESS_JUNCTION_H

#include "stress/reducer.h"

extern const vs_reducer vs_junction_of_power, vs_junction_of_current;

#endif
