/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions to the largest rise of a temperature, by the transient thermal impedance of the
 * device's part (its lines zth): that of a junction, under the device's power; that of a
 * capacitor's core, under ESR i^2. Without such lines, or without a limit esr, no value is known.
 */
#ifndef VS_MEASURE_JUNCTION_H
#define VS_MEASURE_JUNCTION_H

#include "measure/reducer.h"

/* Of a run that begins on an orbit the first period stands for all that was before it, unless an
 * event comes within it: the rise begins as it is on the orbit. Returns the mean power of that
 * period, W, of a measure by vs_junction_of_power; NaN: there was none, or the part has no lines
 * zth. */
double vs_junction_orbit_w(const vs_reduced *rise);

/* Of a run that began cold and ended at end_s: what its terms lack of where that mean power would
 * take them in the long run, K. */
double vs_junction_lacks_k(const vs_reduced *rise, double end_s, double power_w);

extern const vs_reducer vs_junction_of_power, vs_junction_of_current;

#endif
