/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions of a pulse that comes more than once, as a generator's does with `times` and `every`
 * (event/generators.c). One of the pulses is simulated. */
#ifndef VS_STRESS_REPEATED_H
#define VS_STRESS_REPEATED_H

#include "stress/reducer.h"

/* The peak current of one pulse, held against what the part's table of pulses (deck/devices.h)
 * allows for the pulse's width and for the number of pulses. A pulse lasts while |i| is 1 mA or
 * more; its width is its charge over its peak. Of several pulses it is the one that comes nearest
 * to what is allowed, or exceeds it most. Not known where the part has no table. */
extern const vs_reducer vs_repeated_derated;

/* The integral over the run, divided by the time from one pulse to the next. Not known where no
 * event repeats the run. */
extern const vs_reducer vs_repeated_mean;

#endif
