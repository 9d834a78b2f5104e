/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the circuit's solver showed of late: a ring of its knots over the last four cycles of the
 * mains, which begins anew whenever the thyristor conducts, and the peaks of the whole run so far.
 * The test whether the solver may be left (oneport_macromodel.c) reads one stretch of the ring at a
 * time, the view.
 *
 * Signals are numbered as in oneport.h: the deck's terms (V or A), the mains current (A), then what
 * else the circuit remembers (V or A). */
#pragma once

#include "macromodel/oneport.h"

/* Four cycles: the law is fitted to the last one and its signals to the last two, and the three
 * before the last tell whether the law drifts away (law_drift.h). */
enum { VS_CYCLES_KEPT = 4 };

/* Others read it freely, and change it by the functions below alone. */
typedef struct vs_record {
  const vs_setup *setup;
  const vs_frame *frame;
  const vs_circuit_states *memories;
  vs_observation *kept; /* the ring; owned */
  double *memory;       /* VS_CIRCUIT_STATES_MOST values for each of its knots; owned */
  size_t first, count;  /* where the ring's oldest knot stands, and how many there are */
  vs_observation last;  /* the last knot taken, also where the ring does not keep it */
  bool any;             /* false: there is no last knot yet */
  bool blind;           /* the solver did not show all that the circuit remembers */

  const vs_observation
      *seen[VS_MOST_SEEN]; /* the view, in order of time; it points into the ring */
  size_t n_seen;

  /* Largest sizes so far: of q, m and rad; of the force; of the coil's current; of each signal, V
   * or A, where for what the circuit remembers it is half of the range it went over. */
  double peak_x[VS_MOST_DOF], peak_force_n, peak_a;
  double peak_signal[VS_SIGNALS];
  double least[VS_CIRCUIT_STATES_MOST], most[VS_CIRCUIT_STATES_MOST]; /* that range, V or A */
} vs_record;

/* Begins without a knot. Setup, frame and memories must outlive the record. */
void vs_record_begin(vs_record *r, const vs_setup *setup, const vs_frame *frame,
                     const vs_circuit_states *memories);
void vs_record_end(vs_record *r); /* fine for one that is all zero */

/* Takes in the next knot, and what the circuit remembers there. `keep` is false for a knot that no
 * law holds for: it counts for the peaks alone, and the ring begins anew behind it. */
void vs_record_take(vs_record *r, const vs_knot *knot, const double *memory, bool keep);

/* Empties the ring; the peaks stay. */
void vs_record_clear(vs_record *r);

/* True if the ring holds the last two cycles. */
bool vs_record_two_cycles(const vs_record *r);

/* Puts a number of cycles, `some`, into view, which ended `ago` cycles before the last knot.
 * Returns false where the ring does not hold all of them, or holds too few knots of them for a fit.
 */
bool vs_record_view(vs_record *r, int some, int ago);

size_t vs_record_terms(const vs_record *r);   /* how many of the signals are the deck's */
size_t vs_record_signals(const vs_record *r); /* how many signals there are */

/* True for a signal that is watched for a threshold alone. What it is made of is remembered
 * besides, so that how well the law meets it does not count. */
bool vs_record_is_control(const vs_record *r, size_t n);

/* Largest error of a signal that is allowed, relative to its peak. */
double vs_record_share(const vs_record *r);
/* Largest error of signal n that is allowed, V or A: vs_record_share of its peak, or, for a small
 * signal, run.tolerance of 1 V or 0.1 A, as the solver's own tolerances end there. */
double vs_record_allowed(const vs_record *r, size_t n);
