/* SPDX-License-Identifier: GPL-3.0-or-later
 * From a line of LTspice's, PSpice's or a data sheet's to what ngspice reads as the same. */
#ifndef VS_DIALECT_TRANSLATE_H
#define VS_DIALECT_TRANSLATE_H

#include "dialect/rewriting.h"

/* Rewrites a line; r->text must be empty, and is then what ngspice is to be given, before the lines
 * in r->more. What was changed is in r->tally. Errors with their place: what ngspice would misread
 * or leave out, with what to write instead. */
vs_status vs_translate(vs_rewriting *r);

#endif
