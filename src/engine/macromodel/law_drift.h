/* SPDX-License-Identifier: GPL-3.0-or-later
 * How fast a one-port's law (oneport.h) goes wrong, found on cycles that it was not fitted to.
 *
 * A law is fitted to the last cycle, where it may look right by chance. Here it is compared with a
 * cycle one to three periods earlier, which the solver showed too. How much more the law is wrong
 * there, divided by the cycles in between, is called its drift. The drift is then extrapolated: the
 * law is taken to go wrong by as much more in every cycle to come, always in the same sense. What
 * dies away in the circuit counts as well, as if it came up.
 *
 * Where there is no answer, the functions return false or INFINITY, and the solver is not left. */
#pragma once

#include "macromodel/modal.h"
#include "macromodel/record.h"

/* An error over one cycle is split into shares: a mean, and a cosine and a sine of each of the
 * mains' first harmonics. An error that is the same in another cycle has the same shares there,
 * though the knots lie elsewhere, so that two cycles can be compared. */
enum { VS_LAW_DRIFT_SHARES = 1 + 2 * VS_HARMONICS };

/* The shares of every signal's error, V or A. */
typedef struct vs_law_drift_shares {
  double of[VS_SIGNALS][VS_LAW_DRIFT_SHARES];
} vs_law_drift_shares;

/* By how much errors grow from one cycle to the next. */
typedef struct vs_law_drift {
  double current_a, force_n;   /* of the coil */
  double mode[VS_MOST_STATES]; /* of each of the machine's modes, in units of its shape */
  double signal[VS_SIGNALS];   /* V or A */
} vs_law_drift;

/* Gives the shares of the signals' errors over the cycle in view (record.h). The coil is taken as
 * the solver has it, so that only the signals' own law is tested. */
void vs_law_drift_shares_of(const vs_record *record, const vs_oneport *port,
                            vs_law_drift_shares *out);

/* Takes the cycle that ended `ago` cycles before the last knot into view, and finds the drift from
 * there. `fitted` are the shares over the last cycle. Returns false where the record does not hold
 * that cycle. */
bool vs_law_drift_find(vs_record *record, const vs_oneport *port, const vs_modal *modal,
                       const vs_law_drift_shares *fitted, int ago, vs_law_drift *out);

/* The error that the drift makes of the coil's force or current in this many cycles, with a safety
 * margin; the worse of the two, relative to its peak. */
double vs_law_drift_electric(const vs_record *record, const vs_law_drift *drift, double cycles);

/* The error of the signals after this many cycles; the worst, relative to its peak. `misfit_now` is
 * each signal's error in the last cycle, V or A. INFINITY where something that the circuit
 * remembers drifts further than vs_record_allowed. */
double vs_law_drift_signals(const vs_record *record, const vs_oneport *port, const vs_modal *modal,
                            const double misfit_now[VS_SIGNALS], const vs_law_drift *drift,
                            double cycles);
