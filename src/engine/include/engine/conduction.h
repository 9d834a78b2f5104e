/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tells from the course of a device's current, which runs straight from knot to knot, when a device
 * that conducts or blocks fires and goes out.
 *
 * The current is counted without its leakage, which is told from the voltage while the device
 * blocks. The device fires when that current begins to rise, provided that the rise goes far
 * enough: beyond 20 mA, which is the order of any holding current, plus what 500 ohm would leak and
 * 1 nF would draw, more than any part of spice/parts does; with its gate pulse there and an
 * on-state voltage beyond 10 uA, as nothing else then flows in a switch. A device that recovers,
 * whose part states a turn-off time, is a transistor to its gate up to its latching current, and
 * carries what its circuit has for it, be that a snubber's rest: there it is 1 mA. The rise begins
 * where the current leaves zero, or the displacement current of the blocked junction. The device is
 * extinct when its forward current passes zero. Where some current flows on in the forward
 * direction, that is the instant at which the fall of the current, continued as it was, would have
 * come to zero. As long as the gate of a device that recovers is on and its voltage that of the
 * on-state, it takes up the current again: there it is extinct only if the current is not back
 * within 1 us. A device that conducts both ways may carry its gate's current or a ring's the other
 * way meanwhile: it is extinct once its voltage or its gate pulse has gone and the current is not
 * back.
 *
 * The trapezoidal rule does not damp what a jump leaves of a junction's displacement current: from
 * then on it goes up and down from step to step, about the current that flows. A current that does
 * so is taken as the mean over each step, which the rule has right. Taken at the knots, every other
 * one of them would look like a firing. */
#pragma once

#include "engine/step.h"
#include "netlist/devices.h"

/* One step of the device's course: i its current, v its voltage from anode to cathode, at either
 * end. Both voltages are 0 where they are not known. */
typedef struct vs_conduction_step {
  double t0_s, t1_s; /* t1_s > t0_s */
  double i0_a, i1_a, v0_v, v1_v;
} vs_conduction_step;

/* Begins with vs_conduction_begin. Others read it, and set `gated`, `recovers` and `both_ways`
 * alone. */
typedef struct vs_conduction {
  bool conducts;
  bool gated;    /* set by the owner before each step: a gate pulse is known to be there */
  bool recovers; /* set by the owner, behind vs_conduction_begin: it has a vs_conduction_turn_off */
  bool both_ways;  /* set as `recovers` is: the device conducts both ways */
  double leak_s;   /* conductance of the device while it blocks; NaN: not known yet */
  double peak_a;   /* of the present conduction, or of the last one */
  double low_s;    /* while it conducts: since when the current is so low that it may be over; NaN:
                      it is not */
  double out_s;    /* the end of the conduction, which may go on yet; NaN: it has not ended */
  double tail_s;   /* how long the last conduction's current was as low before its zero */
  double tail_a_s; /* mean rate at which the current fell in that time */
  double before_s, before_a; /* time and current at the beginning of the last step; NaN: none yet */
  int alternations; /* how many steps in a row the current turned back by half of the last change or
                       more */
  double change_a;  /* of the current over the last step */
  double mean_a[2]; /* the current's means over the last step, and over the one before it */
  double recovery_end_s; /* a current that has not been small since the voltage turned may be
                            recovery up to here; NaN: it is none */
  bool has_blocked;      /* since that turn the voltage was above that of the on-state */
  double foot_s, foot_a; /* while it blocks: where the present rise of its current began; NaN: no
                            step was taken yet */
} vs_conduction;
void vs_conduction_begin(vs_conduction *c);
/* The turn-off time, s, that the file of the device's part states; 0: it states none, as an ideal
 * switch has none. device: NULL, it is not known. */
double vs_conduction_turn_off(const vs_deck *deck, const vs_device *device);
/* The same of a device that carries i_a at v_v as its course begins: where that is more than any
 * blocked one does, it conducts already, and will not be told to fire. */
void vs_conduction_resume(vs_conduction *c, double i_a, double v_v);

/* From now on the current of the other direction is followed, of a device that conducts both ways
 * and blocks at present. Current and voltage changed their signs at zero_s; the following steps
 * have them with their signs turned. */
void vs_conduction_turn(vs_conduction *c, double zero_s);

/* The clock is set back by by_s. */
void vs_conduction_wind(vs_conduction *c, double by_s);

/* True: with i_a at its end, the next step's events hang on whether its gate is on. */
bool vs_conduction_asks(const vs_conduction *c, double i_a);

/* The current that the device draws beyond its leakage, A. */
double vs_conduction_current(const vs_conduction *c, double i_a, double v_v);

/* Takes the next step, and returns VS_EV_FIRES, VS_EV_EXTINCT or VS_EV_NONE. *event_s becomes the
 * time of the event. A firing may lie many steps back; an extinction lies within the step, or up to
 * 1 us behind it, or before it, by a gate pulse at most. */
vs_event vs_conduction_follow(vs_conduction *c, const vs_conduction_step *step, double *event_s);
