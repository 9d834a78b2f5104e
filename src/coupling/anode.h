/* SPDX-License-Identifier: GPL-3.0-or-later
 * The anode current of a deck's thyristor: when it tells that the thyristor fires and goes out
 * (conduction.h), and where a step of the circuit's solver should end for its sake. */
#ifndef VS_COUPLING_ANODE_H
#define VS_COUPLING_ANODE_H

#include "coupling/conduction.h"

/* Begins with vs_anode_begin. The anode current is the deck's probe i_thyristor. In a deck without
 * that probe nothing ever fires here. */
typedef struct vs_anode {
  const vs_probe *current; /* the deck's probe; NULL: it has none */
  int voltage; /* number of the deck's term for the same thyristor's voltage; -1: none */
  const vs_timeline *timeline;
  double gate_rad; /* delay of the thyristor's gate pulses; NaN: not known */
  vs_conduction conduction;
  bool nearing; /* the thyristor has conducted, and its current has not yet passed its zero */
  double
      crosses_s; /* end of the step that is to pass the zero; INFINITY: no such step is under way */
  bool crossed;  /* that step was the last one, so that there is a kink at its end */
} vs_anode;

/* Finds the probe of the anode current, and the voltage of the thyristor whose current that is. The
 * deck and the timeline must outlive *a. */
void vs_anode_begin(vs_anode *a, const vs_deck *deck, const vs_timeline *timeline);

/* Returns what the anode current did in the step just taken, and sets *event_s to when, s. */
vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s);

/* Takes in the knot at the end of the solver's step. `conducted`: the thyristor did before it. */
void vs_anode_take(vs_anode *a, const vs_knot *last, bool conducted);

/* Returns the longest step, s, that should be taken from the last knot towards the current's zero,
 * which is foretold from the last two knots. INFINITY: the zero is not within two steps of
 * max_step_s. */
double vs_anode_longest(vs_anode *a, const vs_knot *before, const vs_knot *last, double max_step_s);

#endif
