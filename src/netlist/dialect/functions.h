/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions and operators of PSpice's and LTspice's expressions that ngspice does not know. */
#pragma once

#include "dialect/rewriting.h"

/* Writes what ngspice has a like expression for: IF, STP, PWRS, table, buf, inv, hypot, round, idt
 * and sdt (by the voltage of a capacitor of 1 F), & | and ~. Errors with their place and with what
 * to write instead: functions that ngspice cannot have or that are defined nowhere, as dnlim; a
 * call with another number of arguments. */
vs_status vs_functions_rewrite(vs_rewriting *r);

/* Where a line defines a function of one of these names (.func), adds its bit to *own: it is the
 * netlist's then, and not rewritten (r->own). */
void vs_functions_own(const char *line, unsigned long *own);
