/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a source's line leaves out, written out, as versions of ngspice take different things for
 * it. A pulse without a width lasts, and one without a period comes once, up to ngspice 44. In 46 a
 * pulse without a width has none, and one without a period comes again as soon as it is over. */
#ifndef VS_SOLVER_DEFAULTS_H
#define VS_SOLVER_DEFAULTS_H

#include <stddef.h>

/* Gives each pulse of the netlist the width and the period that ngspice 44 takes where they are not
 * there or are the number 0: until_s, the length of the run, in s. lines[0] is the title; each line
 * is whole. `lines` is a copy of `netlist`, whose elements become text of this function's where
 * they are rewritten. vs_defaults_free frees that text. */
void vs_defaults_write(char **lines, size_t count, double until_s);
void vs_defaults_free(char **lines, char *const *netlist, size_t count);

#endif
