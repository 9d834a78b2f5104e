/* SPDX-License-Identifier: GPL-3.0-or-later
 * Lines of a netlist that mean one thing in one version of ngspice and another in the next.
 *
 * Pulses: one without a width lasts, and one without a period comes once, up to ngspice 44. In 46 a
 * pulse without a width has none, and one without a period comes again as soon as it is over. Both
 * are written out.
 *
 * Powers of negative numbers: pow(x, y), x**y and x^y are |x|^y up to ngspice 46. In 47 they are x
 * to the y where y is whole, and 0 where it is not. They are told. */
#ifndef VS_NGSPICE_VERSIONS_H
#define VS_NGSPICE_VERSIONS_H

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

#endif
