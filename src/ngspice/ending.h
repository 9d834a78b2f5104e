/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a run of ngspice comes to its end. Each version does it in steps of its own; what is shown of
 * them is the same. */
#ifndef VS_NGSPICE_ENDING_H
#define VS_NGSPICE_ENDING_H

#include <stdbool.h>

/* Start from {0} with each run. */
typedef struct vs_ending {
  int halves; /* how many steps in turn were to go half of what was left to the end */
} vs_ending;

/* True once so little is left of the run, in s, that it has come to its end. ngspice up to 43 ends
 * there by itself, and stops 1.1e-11 of a largest step short. From 44 on it goes on in steps down
 * to 1e-20 s, shorter than the rounding of the time. What an inductance or a capacitance makes of
 * such a step is rounding, too: a surge of 1 kV ended with 6.4 kV. These steps are not shown. */
bool vs_ending_reached(double left_s, double max_step_s);

/* The step, in s, to take in the place of the one that ngspice is about to take. From 46 on ngspice
 * goes half of what is left where that is more than one step and less than two. As it also holds
 * each step back from the end by the least bit, it goes half of the way again and again, 37 times.
 * The second half in turn is made a whole. Any other step is left as it is. */
double vs_ending_step(vs_ending *ending, double left_s, double step_s);

#endif
