/* SPDX-License-Identifier: GPL-3.0-or-later
 * What differs between versions of ngspice: lines of a netlist that mean one thing in one version
 * and another in the next, and the steps in which a run comes to its end. What is shown of a run is
 * the same for all of them.
 *
 * Pulses: one without a width lasts, and one without a period comes once, up to ngspice 44. In 46 a
 * pulse without a width has none, and one without a period comes again as soon as it is over. Both
 * are written out.
 *
 * Powers of negative numbers: pow(x, y), x**y and x^y are |x|^y up to ngspice 46. In 47 they are x
 * to the y where y is whole, and 0 where it is not. They are told. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Gives each pulse of the netlist the width and the period that ngspice 44 takes where they are not
 * there or are the number 0: until_s, the length of the run, in s. lines[0] is the title; each line
 * is whole. `lines` is a copy of `netlist`, whose elements become text of this function's where
 * they are rewritten. vs_versions_free frees that text. */
void vs_versions_complete(char **lines, size_t count, double until_s);
void vs_versions_free(char **lines, char *const *netlist, size_t count);

/* True if the line is of a source whose expression has a power that may be another number in
 * ngspice 47 than before: neither its base is abs(...) or max(...), nor is its exponent 2 or 4.
 * What stands in braces is a number already. `pspice`: pwr() and pwrs() are made of pow() there. */
bool vs_versions_differ(const char *line, bool pspice);

/* Start from {0} with each run. */
typedef struct vs_last_steps {
  int halves; /* how many steps in turn were to go half of what was left to the end */
} vs_last_steps;

/* True once so little is left of the run, in s, that it has come to its end. ngspice up to 43 ends
 * there by itself, and stops 1.1e-11 of a largest step short. From 44 on it goes on in steps down
 * to 1e-20 s, shorter than the rounding of the time. What an inductance or a capacitance makes of
 * such a step is rounding, too: a surge of 1 kV ended with 6.4 kV. These steps are not shown. */
bool vs_versions_at_end(double left_s, double max_step_s);

/* The step, in s, to take in the place of the one that ngspice is about to take. From 46 on ngspice
 * goes half of what is left where that is more than one step and less than two. As it also holds
 * each step back from the end by the least bit, it goes half of the way again and again, 37 times.
 * The second half in turn is made a whole. Any other step is left as it is. */
double vs_versions_step(vs_last_steps *ending, double left_s, double step_s);
