/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a change of the state at a run's beginning, or a delay of its firing, makes of the state and
 * of signals on the way: the columns of orbit/variation.h, and beside them the states of low-passes
 * through which signals are seen.
 *
 * The columns of x are the machine's, q then q', and behind them those of each low-pass, whose
 * signals' number and order are the caller's. A low-pass goes along exact polynomials of each
 * column's signal. */
#ifndef VS_ORBIT_COLUMNS_H
#define VS_ORBIT_COLUMNS_H

#include "orbit/seen.h"
#include "orbit/variation.h"

enum {
  VS_COLUMNS_FILTERED = 4, /* signals with a low-pass, at most */
  VS_COLUMNS_STATES = VS_MOST_STATES + 2 * VS_COLUMNS_FILTERED
};

/* What becomes of one low-pass: by the machine's columns, the delay's, then its own states. */
typedef struct vs_column_filter {
  const vs_seen *seen; /* borrowed */
  int first;           /* of its states in x */
  vs_lowpass column[VS_VARIATION_MOST + 1 + 2];
  double nodes[VS_VARIATION_MOST]
              [VS_LOWPASS_TERMS]; /* the columns' signals in one part of a step */
} vs_column_filter;

/* Begin with vs_columns_begin, end with vs_columns_end. */
typedef struct vs_columns {
  int n;       /* states in x */
  int machine; /* of these the machine's own */
  vs_variation variation;
  double rates[VS_VARIATION_MOST * (VS_VARIATION_MOST + 1)]; /* of its columns */
  vs_column_filter filter[VS_COLUMNS_FILTERED];
  int filters;
  double t_s; /* how far they have come */
} vs_columns;

/* The run begins at the start of the setup, which must outlive this; it has a valve. */
void vs_columns_begin(vs_columns *columns, const vs_setup *setup);
void vs_columns_end(vs_columns *columns);
/* Adds the states of a signal's low-pass. Returns the first one's place in x, -1 where the signal
 * has none. To be called before the first step. The signal must outlive this. */
int vs_columns_add(vs_columns *columns, const vs_seen *seen);

/* Goes on to an instant within the step that is to be accepted next, not further than a part of it
 * (vs_seen_parts). Errors: as of vs_variation_accept. */
vs_status vs_columns_to(vs_columns *columns, const vs_step *step, double t_s, vs_error *err);
/* Accepts the step, to whose end they have come. */
vs_status vs_columns_accept(vs_columns *columns, const vs_step *step, vs_error *err);

/* What column j makes of state i at the instant that was come to; j = n: what a delay of the firing
 * does, per second. */
double vs_columns_state(vs_columns *columns, int i, int j);
/* The same of a signal that is not seen through a low-pass, at an instant of this step. */
double vs_columns_signal(vs_columns *columns, const vs_step *step, const vs_seen *seen, int j);

#endif
