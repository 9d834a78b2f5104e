/* SPDX-License-Identifier: GPL-3.0-or-later
 * The circuit as the EVA sees it while the thyristor blocks and varistors hardly conduct: a linear
 * one-port with a periodic source,
 *
 *   i + tau di/dt = i_N(t) - G v - C dv/dt,
 *
 * i_N: a mean and a sine of the mains' frequency. Or, where G, C and tau mean nothing,
 * i = i_N(t). Each of the deck's terms is a linear combination of some harmonics, v, dv/dt and i;
 * one that is an integral may drift besides. The numbers are fitted to what a solver showed. With
 * them machine and coil go on without it: lambda' = v - R_c i, i = lambda z/(2a), Eq. 54. */
#ifndef VS_SIM_ONEPORT_H
#define VS_SIM_ONEPORT_H

#include "circuit/memory.h"
#include "sim/sim.h"

/* The deck's terms, then the mains current, then what else the circuit remembers. */
enum { VS_SIGNALS = VS_DECK_MOST + 1 + VS_MEMORIES };
enum { VS_LEAST_SEEN = 80, VS_MOST_SEEN = 640 };

/* A knot of the solver's, with the integrals of i and v up to it, C and Wb, from anywhere; and what
 * the circuit remembered then, V or A. */
typedef struct vs_seen {
  vs_knot knot;
  double charge_c, flux_in_wb;
  const double *memory;
} vs_seen;

/* q, q', lambda, v; begin with vs_oneport_state. */
enum { VS_ONEPORT_FLUX = VS_STATES, VS_ONEPORT_VOLTAGE, VS_ONEPORT_STATES };

/* What it says of an instant. */
typedef struct vs_coil {
  double i_a, i_rate_a_s, flux_wb, flux_rate_v, v_v, v_rate_v_s;
} vs_coil;

typedef struct vs_oneport vs_oneport;

vs_oneport *vs_oneport_new(const vs_setup *setup, const vs_frame *frame, size_t memories);
void vs_oneport_free(vs_oneport *o); /* NULL is fine */

/* Finds its numbers; dynamic: with G, C, tau. false: there are none, or what they make is unstable
 * or too stiff to be worth it. */
bool vs_oneport_fit(vs_oneport *o, const vs_seen *const *seen, size_t count, bool dynamic);
/* With that, what the deck's signals are made of. */
bool vs_oneport_fit_signals(vs_oneport *o, const vs_seen *const *seen, size_t count);

void vs_oneport_state(const vs_knot *knot, double y[VS_ONEPORT_STATES]);
/* Takes the state on; false: GSL cannot. */
bool vs_oneport_advance(vs_oneport *o, double from_s, double to_s, double y[VS_ONEPORT_STATES]);
vs_coil vs_oneport_coil(const vs_oneport *o, double t_s, const double y[VS_ONEPORT_STATES]);
void vs_oneport_signals(const vs_oneport *o, double t_s, const vs_coil *coil,
                        double signal[VS_SIGNALS]);

/* By how much the coil's current would be another if the source were what fits a cycle that it was
 * not fitted to, with the coil at rest: its sine and its mean, A; INFINITY: GSL finds none. */
void vs_oneport_walked(const vs_oneport *o, const vs_seen *const *seen, size_t count,
                       double *sine_a, double *mean_a);

/* How far an instant lies beyond those the law was fitted to: an error of its numbers that does
 * not show there by more than e may make the current wrong by this times e here. */
double vs_oneport_reach(const vs_oneport *o, double t_s, const vs_coil *coil);
/* Is signal n combined of the coil's as well? */
bool vs_oneport_hangs(const vs_oneport *o, size_t n);
/* By how much signal n, V or A, drifts in a second; 0: it does not. */
double vs_oneport_drift(const vs_oneport *o, size_t n);
double vs_oneport_capacitance(const vs_oneport *o); /* C, F; 0 without */
double vs_oneport_lag(const vs_oneport *o);         /* |tau|, s; 0 without */

/* Of a knot: its coil current, A, and that current's rate, A/s; and of what was seen, signal n. */
double vs_knot_current(const vs_model *model, const vs_knot *knot);
double vs_knot_current_rate(const vs_model *model, const vs_knot *knot);
double vs_seen_signal(const vs_frame *frame, const vs_seen *seen, size_t n);

#endif
