/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tells from the course of a device's current, which runs straight from knot to knot, when a device
 * that conducts or blocks fires and goes out.
 *
 * The device fires when its current begins to rise, provided that the rise goes beyond 20 mA plus
 * what 500 ohm would leak and what 1 nF would draw. The rise begins where the current leaves the
 * leakage, or the displacement current of the blocked junction. The device is extinct when its
 * forward current passes zero. Where leakage flows on in the forward direction, that is the instant
 * at which the fall of the current, continued as it was, would have come to zero. */
#ifndef VS_COUPLING_CONDUCTION_H
#define VS_COUPLING_CONDUCTION_H

#include "sim/step.h"

/* One step of the device's course: i its current, v its voltage from anode to cathode, at either
 * end. Both voltages are 0 where they are not known. */
typedef struct vs_conduction_step {
  double t0_s, t1_s; /* t1_s > t0_s */
  double i0_a, i1_a, v0_v, v1_v;
} vs_conduction_step;

/* Begins with vs_conduction_begin. Others read `conducts` alone. */
typedef struct vs_conduction {
  bool conducts;
  double before_s, before_a; /* time and current at the beginning of the last step; NaN: none yet */
  double foot_s, foot_a; /* while it blocks: where the present rise of its current began; NaN: no
                            step was taken yet */
} vs_conduction;
void vs_conduction_begin(vs_conduction *c);

/* Takes the next step, and returns VS_EV_FIRES, VS_EV_EXTINCT or VS_EV_NONE. *event_s becomes the
 * time of the event. A firing may lie many steps back; an extinction lies within the step, or up to
 * 1 us behind it. */
vs_event vs_conduction_follow(vs_conduction *c, const vs_conduction_step *step, double *event_s);

#endif
