/* SPDX-License-Identifier: GPL-3.0-or-later
 * When a device that conducts or blocks fires and goes out, told from the course of its current,
 * which runs straight from knot to knot.
 *
 * Its current is counted without its leakage, which is told from the voltage while it blocks. It
 * fires when that current begins: where it leaves zero, or the displacement current of the blocked
 * junction, for a rise that goes beyond 20 mA, what 500 ohm would leak, and what 1 nF would draw;
 * beyond 10 uA if its gate pulse is there and the voltage is an on-state one. It is extinct when
 * the current passes zero. Where some flows on in the forward direction, that is where the fall of
 * the current, taken on as it was, would have come to zero. */
#ifndef VS_SIM_CONDUCTION_H
#define VS_SIM_CONDUCTION_H

#include "sim/step.h"

/* One step of the device's course. Voltages are anode to cathode; both 0 where they are not known.
 */
typedef struct vs_conduction_step {
  double t0_s, t1_s; /* t1_s > t0_s */
  double i0_a, i1_a, v0_v, v1_v;
} vs_conduction_step;

/* Start with vs_conduction_begin; then it is the follower's own, but for `conducts` and
 * `gated`. */
typedef struct vs_conduction {
  bool conducts;
  bool gated;      /* set by its owner before each step: a gate pulse is known to be there */
  double leak_s;   /* conductance of the device while it blocks; NaN: not known yet */
  double peak_a;   /* of the present conduction, or the last one */
  double zero_a_s; /* rate at which the current came to its last zero; 0: there was none yet */
  double before_s, before_a; /* the knot before the last step's beginning; NaN: none yet */
  double foot_s, foot_a;     /* while it blocks: where the present rise of its current began */
} vs_conduction;
void vs_conduction_begin(vs_conduction *c);

/* What the device draws beyond its leakage. */
double vs_conduction_current(const vs_conduction *c, double i_a, double v_v);

/* Takes the next step. Returns VS_EV_FIRES, VS_EV_EXTINCT or VS_EV_NONE. *event_s is when: a
 * firing may lie many steps back, an extinction lies in the step or at most a step behind it. */
vs_event vs_conduction_follow(vs_conduction *c, const vs_conduction_step *step, double *event_s);

#endif
