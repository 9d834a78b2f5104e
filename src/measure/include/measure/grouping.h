/* SPDX-License-Identifier: GPL-3.0-or-later
 * The harmonics of a current that takes several cycles of the mains to repeat, as an instrument by
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
#ifndef VS_MEASURE_GROUPING_H
#define VS_MEASURE_GROUPING_H

#include <stdbool.h>

/* The harmonics go from 0, the direct part, to the last one that IEC 61000-3-2 has a limit for. */
enum { VS_GROUPING_LAST = 40, VS_GROUPING_COUNT };

/* Start from {0}: groups are not told. Else begin with vs_grouping_begin, end with vs_grouping_end.
 * The stretch that is looked at is cut into sets of cycles. A set holds whole periods of the
 * current. Its windows follow each other; where the set ends within one of them, the window goes on
 * at the set's beginning, as the current repeats. */
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

/* A stretch of `cycles` cycles of the mains, from from_s on, of a current that repeats after
 * `period` of them. Groups are told where that is more than one. */
void vs_grouping_begin(vs_grouping *grouping, double cycle_s, double from_s, int cycles,
                       int period);
void vs_grouping_end(vs_grouping *grouping);

/* The end of the cycle that begins at t_s or in which t_s lies. Whoever adds points over a piece of
 * time ends the piece there. INFINITY: groups are not told. */
double vs_grouping_cut(const vs_grouping *grouping, double t_s);
/* Adds a point of the current, A; weight_s is its share of the time. Points come in the order of
 * their cycles. */
void vs_grouping_add(vs_grouping *grouping, double t_s, double weight_s, double current);

/* How many windows the groups are the mean of. */
int vs_grouping_windows(const vs_grouping *grouping);
/* Group n, from 1 to VS_GROUPING_LAST, A rms, once the whole stretch was taken in. NaN: the stretch
 * is no whole number of periods. */
double vs_grouping_at(const vs_grouping *grouping, int n);

#endif
