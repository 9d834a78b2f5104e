/* SPDX-License-Identifier: GPL-3.0-or-later
 * Coupled inductors: lines K. ngspice takes any factors and goes on; windings whose factors cannot
 * be together give energy from nothing. */
#pragma once

#include "netlist/cards.h"

/* Error: a K without a factor, with one beyond 1, of an inductor with itself or of what is no
 * inductor, with its place. Other lines are fine. */
vs_status vs_couplings_line(const vs_cards *one, vs_error *err);

/* Looks at all lines of a netlist, each K of two inductors. Error: the factors of a set of
 * inductors that are coupled with each other make a matrix that is not positive definite, with the
 * place of the set's first factor. Sets with a factor that is a formula, or that stands between .if
 * and .endif, are left out. */
vs_status vs_couplings_check(const vs_cards *cards, vs_error *err);
