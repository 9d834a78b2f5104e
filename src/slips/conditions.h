/* SPDX-License-Identifier: GPL-3.0-or-later
 * Conditions, .if to .endif. */
#ifndef VS_SLIPS_CONDITIONS_H
#define VS_SLIPS_CONDITIONS_H

#include "dialect/line.h"

/* Errors: a line is an .else, .elseif or .endif, and no .if is open there, for which ngspice gives
 * no reason; or an .if that no .endif closes, behind which ngspice silently leaves all out. */
vs_status vs_conditions_check(const vs_line *lines, size_t count, vs_error *err);

#endif
