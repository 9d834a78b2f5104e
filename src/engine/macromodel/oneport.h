/* SPDX-License-Identifier: GPL-3.0-or-later
 * A macromodel of the circuit, as the EVA sees it, while the thyristor blocks and the
 * varistors hardly conduct. It is a linear one-port with a periodic source:
 *
 *   i + tau di/dt = i_N(t) - G v - C dv/dt
 *
 * i is the coil's current, A, and v the voltage across the EVA, V. The source i_N is a mean and one
 * sine of the mains' frequency. C, F, and G, S, stand for the snubbers; tau, s, for their lag. This
 * law is called dynamic. Where the snubbers' share is too small for G, C and tau to mean anything,
 * the static law i = i_N(t) holds in its place.
 *
 * The numbers are fitted by least squares to knots that the solver showed. Machine and coil then go
 * on by lambda' = v - R_c i, i = lambda z/(2a), and Eq. 54, without the solver. The other signals
 * follow from the coil and the time (signals.h). */
#pragma once

#include "engine/setup.h"
#include "macromodel/responses.h"

/* The state that the law integrates: lambda, Wb, v, V, and then q and q' of the machine. */
enum {
  VS_ONEPORT_FLUX,
  VS_ONEPORT_VOLTAGE,
  VS_ONEPORT_Q,
  VS_ONEPORT_STATES = VS_ONEPORT_Q + VS_MOST_STATES
};

typedef struct vs_oneport vs_oneport;

/* Makes a one-port that has no law yet, for a circuit that remembers this many values. The caller
 * owns it and frees it; setup and frame must outlive it. */
vs_oneport *vs_oneport_new(const vs_setup *setup, const vs_frame *frame, size_t memories);
void vs_oneport_free(vs_oneport *o); /* NULL is fine */

/* Fits the dynamic or the static law to `count` knots in order of time. Returns false where there
 * is no fit, where the source drifts, or where the law is unstable or so stiff that it would take
 * more than 2000 steps a cycle. All functions below that take a vs_oneport need a law. */
bool vs_oneport_fit(vs_oneport *o, const vs_observation *const *seen, size_t count, bool dynamic);

/* Then fits every signal to these knots, which may be others than the law's. Returns false where
 * GSL finds no fit. */
bool vs_oneport_fit_signals(vs_oneport *o, const vs_observation *const *seen, size_t count);

/* Copies the law's state out of a knot. */
void vs_oneport_state(const vs_knot *knot, double y[VS_ONEPORT_STATES]);

/* Integrates the state from from_s to to_s, s. Returns false where GSL cannot; y then has no
 * meaning. */
bool vs_oneport_advance(vs_oneport *o, double from_s, double to_s, double y[VS_ONEPORT_STATES]);

/* Returns the coil at t_s for a state of the law. */
vs_coil_state vs_oneport_coil(const vs_oneport *o, double t_s, const double y[VS_ONEPORT_STATES]);

/* The signals that vs_oneport_fit_signals found; owned by the one-port. */
const vs_responses *vs_oneport_responses(const vs_oneport *o);

/* Fits the source alone anew, with the law's G, C and tau, to a cycle that the law was not fitted
 * to. With that source the current, A, of a coil at rest would be another: *sine_a is the amplitude
 * of the sine by which it would change, *mean_a the size of the mean. Both are INFINITY where GSL
 * finds no fit. The law stays as it is. */
void vs_oneport_drifted(const vs_oneport *o, const vs_observation *const *seen, size_t count,
                        double *sine_a, double *mean_a);

/* Error amplification where the law is used beyond the knots it was fitted to: a fit error of e at
 * most over those knots becomes at most (return value) times e in the current at t_s. 1 for the
 * static law. */
double vs_oneport_reach(const vs_oneport *o, double t_s, const vs_coil_state *coil);

double vs_oneport_capacitance(const vs_oneport *o); /* C, F; 0 for the static law */
double vs_oneport_lag(const vs_oneport *o);         /* |tau|, s; 0 for the static law */

/* Of knots, without a law: the coil's current, A, and its rate, A/s. */
double vs_oneport_knot_current(const vs_model *model, const vs_knot *knot);
double vs_oneport_knot_current_rate(const vs_model *model, const vs_knot *knot);
