/* SPDX-License-Identifier: GPL-3.0-or-later
 * Conditions, .if to .endif. */
#ifndef VS_SLIPS_CONDITIONS_H
#define VS_SLIPS_CONDITIONS_H

#include "dialect/line.h"

/* Error: one of the lines is an .else, .elseif or .endif, and no .if is open there. ngspice gives
 * no reason for what it does with it. */
vs_status vs_conditions_check(const vs_line *lines, size_t count, vs_error *err);

#endif
