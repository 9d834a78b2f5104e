/* SPDX-License-Identifier: GPL-3.0-or-later
 * Can the ngspice that runs be relied on? Users have other versions than the developers, and one
 * version may be right where the next is not. So each library is probed once (vs_self_test_probe),
 * in a child process, and what came of it is remembered in $XDG_CACHE_HOME/vibrospice, or
 * ~/.cache/vibrospice. A library is identified by its file: path, size, time of change. It is
 * probed again where the file is another one, with another version of this program, and each time a
 * process begins where there is no folder to remember it in. */
#pragma once

#include "ngspice/circuit.h"

/* ngspice (ngspice/ngspice.h), probed before it loads the first circuit of a process. */
extern const vs_circuit_kind vs_self_test_kind;

/* Finds whether the library can be relied on, once in a process. Where something is wrong it is
 * told on standard error, too. Errors: VS_RUN, ngspice cannot begin; VS_SIGNAL, a signal that is
 * handled came meanwhile. */
vs_status vs_self_test_find(vs_error *err);

/* What is wrong with the library, or else what in the circuit it loaded last means another thing in
 * this version than before: to be told with every result. Empty: nothing, or it was not asked.
 * Whatever writes results asks this: summary.json and study.csv (run/result.h), sensitivity,
 * check, the bench of parts, fit. It was printed on standard error when it was found. */
const char *vs_self_test_text(void);

enum { VS_SELF_TEST_TEXT = 200 };
/* Lets the solver run the probe's circuit, by the trapezoidal rule. `wrong` becomes the first thing
 * that is wrong with it, a sentence without a full stop; empty: nothing is. A run that fails is
 * wrong, too. For tests, which have solvers that lie. */
void vs_self_test_probe(const vs_circuit_kind *solver, char wrong[VS_SELF_TEST_TEXT]);
