/* SPDX-License-Identifier: GPL-3.0-or-later
 * The anode current of a deck's thyristor: when it fires and goes out (conduction.h), and where a
 * step of the circuit's solver should end for it. */
#ifndef VS_SIM_ANODE_H
#define VS_SIM_ANODE_H

#include "sim/conduction.h"

/* Start with vs_anode_begin. A deck without a probe i_thyristor has no such current: then nothing
 * ever fires here. */
typedef struct vs_anode {
  const vs_probe *current; /* the deck's probe; NULL: it has none */
  int voltage;             /* the deck's term, of the same thyristor; -1: not known */
  const vs_timeline *timeline;
  double gate_rad; /* delay of its gate pulses; NaN: not known */
  vs_conduction conduction;
  bool nearing;     /* the current has still to pass its zero, or has not yet been seen to fall */
  double crosses_s; /* the end of the step that is to pass it; INFINITY: none yet */
  bool crossed;     /* that step was the last one: there is a kink at its end */
} vs_anode;

/* Finds the probe of the anode current, and the voltage of the thyristor that has this current for
 * its own. Both must outlive *a. */
void vs_anode_begin(vs_anode *a, const vs_deck *deck, const vs_timeline *timeline);

/* Returns what the anode current did in the step just taken, and sets *event_s to when, s. */
vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s);

/* Takes in where the solver's step has ended. conducted: before that step. */
void vs_anode_take(vs_anode *a, const vs_knot *last, bool conducted);

/* The longest step, s, from the last knot towards the current's zero, told from the last two knots.
 * INFINITY: it is not near. max_step_s: the longest step there is. */
double vs_anode_longest(vs_anode *a, const vs_knot *before, const vs_knot *last, double max_step_s);

#endif
