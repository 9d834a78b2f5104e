/* SPDX-License-Identifier: GPL-3.0-or-later
 * How long a step of the circuit tier may be on the way to the zero of a thyristor's current. */
#ifndef VS_SIM_ZERO_H
#define VS_SIM_ZERO_H

#include <stdbool.h>

typedef struct vs_zero {
  double before_s, before_a; /* the last two knots: the current without leakage */
  double last_s, last_a;
  double leak_s;    /* conductance of the thyristor while it last blocked, S */
  bool nearing;     /* the current has still to pass its zero */
  double crosses_s; /* the end of the step that is to pass it; INFINITY: none yet */
  bool crossed;     /* that step was the last one */
} vs_zero;

vs_zero vs_zero_begin(void);

/* Takes in a knot: anode current and voltage, A and V (0: the voltage is not known), and whether
 * the thyristor conducts there. */
void vs_zero_take(vs_zero *zero, double t_s, double i_a, double v_v, bool conducts);

/* Longest step from the last knot on, s; INFINITY: as long as one likes. max_step_s: the largest of
 * the run. */
double vs_zero_longest(vs_zero *zero, double max_step_s);

#endif
