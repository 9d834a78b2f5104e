/* SPDX-License-Identifier: GPL-3.0-or-later
 * Elements as LTspice and PSpice write them: with parasitic parts, with ratings, with hints for the
 * solver, with tables. */
#pragma once

#include "dialect/rewriting.h"

/* Writes an element with its parasitic parts (Rser, Lser, Rpar, Cpar, RLshunt) as elements of their
 * own: those in series behind its second node, those in parallel at its two nodes; leaves out
 * ratings, tolerances and hints for step control; writes a TABLE source with pwl(). Errors with
 * their place: a parameter that ngspice has nothing for, with what to write; a B source without
 * V= or I=. */
vs_status vs_elements_rewrite(vs_rewriting *r);
