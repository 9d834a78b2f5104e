/* SPDX-License-Identifier: GPL-3.0-or-later
 * A formula as ngspice's B sources write it. */
#pragma once

#include "base/formula.h"
#include "base/text.h"

/* Adds a number that ngspice reads as this one to the last bit or two; in brackets where it has a
 * sign or is a sum. */
void vs_b_source_number(vs_text *text, double value);

/* Adds the formula, its names bound, in brackets where its last operation is an operator. terms[k]
 * is what stands for term k: a node's voltage, or an expression in brackets. */
void vs_b_source_formula(vs_text *text, const vs_formula *formula, const char *const *terms);
