/* SPDX-License-Identifier: GPL-3.0-or-later
 * From a line of LTspice's, PSpice's or a data sheet's to what ngspice reads as the same. */
#pragma once

#include "dialect/rewriting.h"

/* Rewrites a line; r->text must be empty, and is then what ngspice is to be given, before the lines
 * in r->more. What was changed is in r->tally. Errors with their place: what ngspice would misread
 * or leave out, with what to write instead. */
vs_status vs_translate(vs_rewriting *r);

/* Rewrites what only all lines together tell. Subcircuits with parameters, of which the names have
 * other characters than letters, digits and '_', get names that ngspice 39 finds: A-1 becomes A_1.
 * Nodes behind OPTIONAL: become nodes; parameters that all instances give and the head lacks stand
 * in it. */
void vs_translate_whole(vs_line *lines, size_t count, vs_tally *tally);

/* Writes Ix(U1:A), LTspice's current into a pin of an instance outside of subcircuits, as that of a
 * source of 0 V before the pin, and adds the lines of such sources to `more`. Error, with its
 * place: there is no such instance or pin. */
vs_status vs_translate_currents(vs_line *lines, size_t count, vs_text *more, vs_error *err);
