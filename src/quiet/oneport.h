/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law that stands in for the circuit, as the EVA sees it, while the thyristor blocks and the
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
 * on without it: lambda' = v - R_c i, i = lambda z/(2a), and Eq. 54. The other signals follow: each
 * is a linear combination of three harmonics, a mean, v, dv/dt and i, and one that is an integral
 * may drift besides. */
#ifndef VS_QUIET_ONEPORT_H
#define VS_QUIET_ONEPORT_H

#include "deck/memory.h"
#include "sim/sim.h"

/* Signals are numbered: the deck's terms (V or A), then the mains current (A), then what else the
 * circuit remembers (V or A, memory.h). An array of signals has this much room. */
enum { VS_SIGNALS = VS_DECK_MOST + 1 + VS_MEMORIES };

/* How many knots of a cycle are needed for a fit: 26 for a period of the third harmonic, the
 * highest. The most that a fit is given: two cycles hold 400 at the pace of record.c. */
enum { VS_LEAST_SEEN = 80, VS_MOST_SEEN = 640 };

/* A knot of the solver's. The integrals of i and v up to it, C and Wb, may begin anywhere. memory
 * points to what the circuit remembered then, V or A; somebody else owns it. */
typedef struct vs_seen {
  vs_knot knot;
  double charge_c, flux_in_wb;
  const double *memory;
} vs_seen;

/* The law's state: q and q' (VS_STATES numbers), lambda, Wb, and v, V. */
enum { VS_ONEPORT_FLUX = VS_STATES, VS_ONEPORT_VOLTAGE, VS_ONEPORT_STATES };

/* What the law says of the coil at one instant: current, flux linkage and voltage, each with its
 * rate. The static law does not know v_rate_v_s and leaves it 0. */
typedef struct vs_coil {
  double i_a, i_rate_a_s, flux_wb, flux_rate_v, v_v, v_rate_v_s;
} vs_coil;

typedef struct vs_oneport vs_oneport;

/* Makes one without a law, for a circuit that remembers so many values. The caller owns it and
 * frees it; setup and frame must outlive it. */
vs_oneport *vs_oneport_new(const vs_setup *setup, const vs_frame *frame, size_t memories);
void vs_oneport_free(vs_oneport *o); /* NULL is fine */

/* Fits the dynamic or the static law to `count` knots in order of time. Returns false where there
 * is no fit, where the source drifts, or where the law is unstable or too stiff to be worth it,
 * with more than 2000 steps a cycle. Functions below that take a vs_oneport need a law. */
bool vs_oneport_fit(vs_oneport *o, const vs_seen *const *seen, size_t count, bool dynamic);

/* Then fits every signal to these knots. Returns false where GSL finds no fit. */
bool vs_oneport_fit_signals(vs_oneport *o, const vs_seen *const *seen, size_t count);

/* Copies the law's state out of a knot. */
void vs_oneport_state(const vs_knot *knot, double y[VS_ONEPORT_STATES]);

/* Integrates the state from from_s to to_s, s. Returns false where GSL cannot; y is then void. */
bool vs_oneport_advance(vs_oneport *o, double from_s, double to_s, double y[VS_ONEPORT_STATES]);

/* The coil at t_s in that state. */
vs_coil vs_oneport_coil(const vs_oneport *o, double t_s, const double y[VS_ONEPORT_STATES]);

/* All signals at t_s beside that coil, V or A; needs vs_oneport_fit_signals. */
void vs_oneport_signals(const vs_oneport *o, double t_s, const vs_coil *coil,
                        double signal[VS_SIGNALS]);

/* Fits the source anew to a cycle that the law was not fitted to, and keeps G, C and tau. *sine_a
 * and *mean_a are what the coil's current, A, would change by with that source, the coil at rest:
 * its sine and its mean. Both are INFINITY where GSL finds no fit. The law itself stays. */
void vs_oneport_walked(const vs_oneport *o, const vs_seen *const *seen, size_t count,
                       double *sine_a, double *mean_a);

/* Error amplification where the law is used beyond the knots it was fitted to: a misfit that is at
 * most e over those knots becomes at most (return value) times e in the current at t_s. */
double vs_oneport_reach(const vs_oneport *o, double t_s, const vs_coil *coil);

/* True if signal n depends on the coil, and not on the time alone. */
bool vs_oneport_hangs(const vs_oneport *o, size_t n);

/* How fast signal n drifts, V/s or A/s; 0 for one that does not. */
double vs_oneport_drift(const vs_oneport *o, size_t n);

double vs_oneport_capacitance(const vs_oneport *o); /* C, F; 0 for the static law */
double vs_oneport_lag(const vs_oneport *o);         /* |tau|, s; 0 for the static law */

/* The coil's current at a knot, A, its rate there, A/s, and signal n of a knot seen, V or A. */
double vs_oneport_knot_current(const vs_model *model, const vs_knot *knot);
double vs_oneport_knot_current_rate(const vs_model *model, const vs_knot *knot);
double vs_oneport_seen_signal(const vs_frame *frame, const vs_seen *seen, size_t n);

#endif
