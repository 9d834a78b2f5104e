/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that takes the current drawn from the mains apart into harmonics of the mains. The
 * integrals are taken on the dense output of each step, so that no sampling limits them. */
#pragma once

#include <gsl/gsl_integration.h>

#include "engine/step.h"

/* ---- groups of lines ---- */

/* The harmonics of a current that takes several cycles of the mains to repeat, as an instrument by
 * IEC 61000-4-7 has them: what lies between two harmonics is added to its neighbours. The
 * instrument looks through windows of 10 cycles of mains of 50 Hz, or 12 of 60 Hz, which is 0.2 s.
 * A window's discrete Fourier transform has a line at each N-th of the mains' frequency, N being
 * the window's cycles. Group n is the root of the sum of the squares of the lines nearest to
 * harmonic n; the lines half way to the next harmonic count by half:
 *
 *   G_n^2 = C_{nN-N/2}^2 / 2 + sum of C_{nN+k}^2 over |k| < N/2 + C_{nN+N/2}^2 / 2
 *
 * One window need not hold whole periods of the current. So the groups are the root mean square
 * over as many windows, one behind the other, as together hold whole periods. */
enum { VS_GROUPING_LAST = 40, VS_GROUPING_COUNT };

/* {0}: groups are not told. Else vs_spectrum_begin_groups begins them. The stretch that is looked
 * at is cut into sets of cycles. A set holds whole periods of the current. Its windows follow each
 * other; where the set ends within one of them, the window goes on at the set's beginning, as the
 * current repeats. */
typedef struct vs_grouping {
  bool told;         /* the current takes several cycles to repeat */
  int each;          /* N: cycles of a window, and lines from harmonic to harmonic */
  int set;           /* cycles of a set; 0: the stretch is no whole number of periods */
  int windows;       /* of a set */
  long sets;         /* in the stretch */
  double from_s;     /* when the first set begins */
  double cycle_s;    /* a cycle of the mains */
  double (*line)[2]; /* of each cycle of the set at hand, count_of_lines of them: the
                        integrals of i cos and i sin of the line's angle, which is 0 at the
                        cycle's beginning, A s; owned */
  long number;       /* of the set at hand, from 0 */
  double squares[VS_GROUPING_COUNT]; /* the sum of G_n^2 over the sets before it, A^2 */
} vs_grouping;

/* ---- the watcher ---- */

/* The harmonics go from 0, the direct part, to the last one that IEC 61000-3-2 has a limit for. */
enum { VS_SPECTRUM_LAST = VS_GROUPING_LAST, VS_SPECTRUM_LINES };

/* Begin with vs_spectrum_begin, end with vs_spectrum_end. */
typedef struct vs_spectrum {
  double omega_rad_s;                                        /* of the mains */
  double span_s;                                             /* what was taken in so far */
  double cosine[VS_SPECTRUM_LINES], sine[VS_SPECTRUM_LINES]; /* int i cos(n w t) dt, A s */
  double squared;                                            /* int i^2 dt, A^2 s */
  vs_grouping grouping;                   /* of a current that takes several cycles to repeat */
  gsl_integration_glfixed_table *rule[2]; /* owned; the other for what is short */
} vs_spectrum;

void vs_spectrum_begin(vs_spectrum *spectrum, double omega_rad_s);
void vs_spectrum_end(vs_spectrum *spectrum);
/* Has it tell groups as well: what will be taken in are `cycles` cycles of the mains, from from_s
 * on, of a current that repeats after `period` of them. After one cycle: groups are the lines. */
void vs_spectrum_begin_groups(vs_spectrum *spectrum, double from_s, int cycles, int period);

/* Adds a point of a current, A, to the integrals: weight_s is its share of the time. Whoever adds
 * points adds their time to span_s, too. */
void vs_spectrum_add(vs_spectrum *spectrum, double t_s, double weight_s, double current);

/* In how many pieces a stretch of that length is to be integrated, within one step, and by which
 * rule each of them. */
int vs_spectrum_pieces(const vs_spectrum *s, double length_s, gsl_integration_glfixed_table **rule);

/* Takes one accepted step. */
void vs_spectrum_accept(vs_spectrum *spectrum, const vs_step *step);

/* The root mean square of the harmonic n, A; of harmonic 0, the size of the mean. What was taken in
 * must be whole cycles of the mains. */
double vs_spectrum_harmonic(const vs_spectrum *spectrum, int n);
/* What is held against the limit of harmonic n, from 1 on, A rms: its group by IEC 61000-4-7 where
 * the current takes several cycles of the mains to repeat, else the harmonic
 * itself. NaN: what was taken in does not hold whole periods of the current. */
double vs_spectrum_judged(const vs_spectrum *spectrum, int n);
/* The mean of the current with its sign, and the root mean square of all of it, A. */
double vs_spectrum_mean(const vs_spectrum *spectrum);
double vs_spectrum_rms(const vs_spectrum *spectrum);

/* The largest harmonic current n that IEC 61000-3-2:2018, table 1, allows an apparatus of class A,
 * A rms; NaN: it states none, as of the harmonics 0 and 1. */
double vs_spectrum_limit(int n);

/* The end of the cycle that begins at t_s or in which t_s lies. Whoever adds points over a piece of
 * time ends the piece there. INFINITY: groups are not told. */
double vs_spectrum_cut(const vs_spectrum *spectrum, double t_s);
/* How many windows the groups are the mean of. */
int vs_spectrum_windows(const vs_spectrum *spectrum);
