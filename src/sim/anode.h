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
  vs_conduction conduction;
  double expected_s; /* the end of a step that was last told for an extinction */
} vs_anode;

/* Finds the probe of the anode current, and the voltage of the thyristor that has this current for
 * its own. The deck must outlive *a. */
void vs_anode_begin(vs_anode *a, const vs_deck *deck);

/* Returns what the anode current did in the step just taken, and sets *event_s to when, s. */
vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s);

/* Where the next step should end as the anode current then has passed zero, s, told from the last
 * two knots. INFINITY: not within the next step, which at most doubles the last one's step_s and is
 * never longer than max_step_s. */
double vs_anode_extinction(vs_anode *a, const vs_knot *before, const vs_knot *last, double step_s,
                           double max_step_s);

#endif
