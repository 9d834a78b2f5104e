/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the circuit's solver showed of late: a ring of its knots over the last four mains cycles,
 * without gaps since the thyristor last conducted, and the peaks of the whole run so far. The test
 * whether the solver may be left (quiet.h) reads one stretch of the ring at a time, the view.
 *
 * A signal, below, is numbered as in oneport.h: the deck's terms (V or A), the mains current (A),
 * then what else the circuit remembers (V or A, memory.h). */
#ifndef VS_QUIET_RECORD_H
#define VS_QUIET_RECORD_H

#include "quiet/oneport.h"

/* The law is fitted to the last cycle and its signals to the last two; three earlier cycles tell
 * whether the law walks away (walk.h). */
enum { VS_CYCLES_KEPT = 4 };

/* Read it freely, but change it by the functions below alone. */
typedef struct vs_record {
  const vs_setup *setup;
  const vs_frame *frame;
  const vs_memories *memories;
  vs_seen *kept;       /* the ring; owned */
  double *memory;      /* VS_MEMORIES for each of them; owned */
  size_t first, count; /* of the ring */
  vs_seen last;        /* the last knot taken, also when the ring does not keep it */
  bool any;            /* false: there is no last knot */
  bool blind;          /* the solver did not show all that the circuit remembers */

  const vs_seen *seen[VS_MOST_SEEN]; /* the view, in order of time; it points into the ring */
  size_t n_seen;

  double peak_x[VS_DOF], peak_force_n, peak_a; /* sizes: m and rad, N, A of the coil */
  double peak_signal[VS_SIGNALS];              /* size; of a memory half of how far it went */
  double least[VS_MEMORIES], most[VS_MEMORIES];
} vs_record;

/* The three must outlive the record. */
void vs_record_begin(vs_record *r, const vs_setup *setup, const vs_frame *frame,
                     const vs_memories *memories);
void vs_record_end(vs_record *r); /* fine for one that is all zero */

/* Takes in the next knot, and what the circuit remembers then. `keep` is false for one that no law
 * holds for: it only counts for the peaks, and the ring begins anew behind it. */
void vs_record_take(vs_record *r, const vs_knot *knot, const double *memory, bool keep);

/* Empties the ring; the peaks stay. */
void vs_record_clear(vs_record *r);

/* Does the ring hold the last two cycles? */
bool vs_record_two_cycles(const vs_record *r);

/* Puts `some` cycles into view, which ended `ago` cycles before the last knot. Returns false where
 * the ring does not hold all of them, or too few knots. */
bool vs_record_view(vs_record *r, int some, int ago);

size_t vs_record_terms(const vs_record *r);   /* how many of the signals are the deck's */
size_t vs_record_signals(const vs_record *r); /* how many signals there are */

/* Largest error of any signal, relative to its peak, that is allowed. */
double vs_record_share(const vs_record *r);
/* Largest error of signal n, V or A, that is allowed. A small signal is allowed more of its peak,
 * as the solver does not tell less than a volt or a tenth of an ampere apart any better. */
double vs_record_allowed(const vs_record *r, size_t n);

#endif
