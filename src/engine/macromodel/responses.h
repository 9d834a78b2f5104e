/* SPDX-License-Identifier: GPL-3.0-or-later
 * What else the circuit's solver shows than the coil, while the circuit is quiet: its signals, and
 * how they follow from the coil and the time. Each signal is a linear combination of the mains'
 * harmonics, a mean, v, dv/dt and i, to which a drift may be added for a signal that is an
 * integral.
 *
 * Signals are numbered: the deck's terms (V or A), then the mains current (A), then what else the
 * circuit remembers (V or A, circuit_states.h). */
#pragma once

#include "engine/step.h"
#include "macromodel/circuit_states.h"

/* Room for all signals. */
enum { VS_SIGNALS = VS_DECK_MOST + 1 + VS_CIRCUIT_STATES_MOST };

/* The mains' harmonics that a signal is made of: the first three. */
enum { VS_HARMONICS = 3 };

/* What a signal is combined of: cosines and sines of the harmonics, a mean, the coil, a drift. */
enum {
  VS_TERM_OF_COSINES,
  VS_TERM_OF_SINES = VS_TERM_OF_COSINES + VS_HARMONICS,
  VS_TERM_OF_MEAN = VS_TERM_OF_SINES + VS_HARMONICS,
  VS_TERM_OF_V,
  VS_TERM_OF_I,
  VS_TERM_OF_V_RATE,
  VS_TERM_OF_DRIFT,
  VS_SIGNAL_COLUMNS
};

/* The fewest knots of a cycle that a fit needs, which are 26 for a period of the third harmonic,
 * and the most that a fit is given: two cycles hold 400 at the pace of record.c. */
enum { VS_LEAST_SEEN = 80, VS_MOST_SEEN = 640 };

/* A knot that the solver showed. The integrals of i and v up to it, C and Wb, may begin anywhere.
 * `memory` points to what the circuit remembered there, V or A; the record (record.h) owns it. */
typedef struct vs_observation {
  vs_knot knot;
  double charge_c, flux_in_wb;
  const double *memory;
} vs_observation;

/* The coil at one instant: current, flux linkage and the EVA's voltage, each with its rate. The
 * static law (oneport.h) does not know v_rate_v_s and leaves it 0. */
typedef struct vs_coil_state {
  double i_a, i_rate_a_s, flux_wb, flux_rate_v, v_v, v_rate_v_s;
} vs_coil_state;

/* Begins with vs_responses_begin, and needs vs_responses_fit before it is asked for anything. */
typedef struct vs_responses {
  size_t count;
  double omega_rad_s; /* of the mains */
  double from_s;      /* where the time of a drift begins */
  double weight[VS_SIGNALS][VS_SIGNAL_COLUMNS];
} vs_responses;

void vs_responses_begin(vs_responses *signals, double omega_rad_s, size_t count);

/* Fits every signal to `knots` knots in order of time, coil[k] being the coil at the k-th. Returns
 * false where GSL finds no fit. */
bool vs_responses_fit(vs_responses *signals, const vs_frame *frame,
                      const vs_observation *const *seen, const vs_coil_state *coil, size_t knots);

/* Gives all signals at t_s for that coil, V or A. */
void vs_responses_at(const vs_responses *signals, double t_s, const vs_coil_state *coil,
                     double signal[VS_SIGNALS]);

/* True if signal n hangs on the coil, and not on the time alone. */
bool vs_responses_hangs(const vs_responses *signals, size_t n);

/* How fast signal n drifts, V/s or A/s; 0 for a signal that does not. */
double vs_responses_drift(const vs_responses *signals, size_t n);

/* Signal n as the solver showed it at a knot, V or A. */
double vs_responses_seen(const vs_frame *frame, const vs_observation *seen, size_t n);
