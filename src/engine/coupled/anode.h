/* SPDX-License-Identifier: GPL-3.0-or-later
 * The anode current of a deck's thyristors: when it tells that they fire and go out (conduction.h),
 * and where a step of the circuit's solver should end for its sake.
 *
 * It is the deck's probe i_thyristor. Where that is no single thyristor's current and the deck has
 * two or more, it is taken for their sum, and each is followed by its own current and voltage: the
 * sum fires when the first of them does, and is extinct when the last one goes out. A triac counts
 * as two thyristors, one for each direction. */
#pragma once

#include "coupled/swing.h"
#include "engine/conduction.h"

/* One current that is followed. */
typedef struct vs_anode_current {
  const vs_device *device;  /* the thyristor whose current it is; NULL: not known */
  vs_formula_prepared i, v; /* the current, and the device's voltage where that is known */
  double last_a, last_v, before_a, before_v; /* at the last two knots shown */
  double way;                                /* -1: of a triac, its other direction; else +1 */
  double out_s, forward_s; /* when it last went out, and since when its voltage is forward;
                              -INFINITY: never */
  double t_q_s;            /* its turn-off time; 0: it has none */
  double near_s; /* how near to the current's zero the step across it begins and ends, s */
  vs_conduction conduction;
  bool conducted; /* it did before the solver's present step */
  bool nearing;   /* the thyristor has conducted, and its current has not yet passed its zero */
  double
      crosses_s; /* end of the step that is to pass the zero; INFINITY: no such step is under way */
} vs_anode_current;

/* The size of a gate drive's current: at the last knot shown, and its largest so far. */
typedef struct vs_anode_drive {
  vs_formula_prepared i;
  double last_a, most_a;
} vs_anode_drive;

/* Begins with vs_anode_begin. In a deck without the probe nothing ever fires here. */
typedef struct vs_anode {
  const vs_timeline *timeline;
  vs_anode_current item[2 * VS_DECK_DEVICES];
  size_t count;
  vs_anode_drive drive[VS_DECK_DEVICES];
  size_t drives;
  double last_s, before_s; /* instants of the last two knots shown; NaN: there was none */
  double out_s;            /* when one of them last went out; -INFINITY: none has */
  bool crossed; /* the last step was to pass a zero, or a latch fired late in it: a kink at its end
                 */
  bool jumps;   /* a gate's voltage jumps at the edges of its pulses: its drive is a source alone */
  bool
      delays; /* a gate's voltage rises some time behind those edges: its drive is more than that */
  bool cores; /* a gate drive has a core, which may saturate */
  double latching_a;           /* I_L of the thyristors; INFINITY: not known */
  bool *spares;                /* see vs_run_order; NULL: no sub-pulse is left out */
  bool bursts;                 /* gates are driven with sub-pulses */
  double edge_s;               /* the last such edge that was reached; -INFINITY: none was */
  double strained_s;           /* where the cycle began in which voltages were last back too soon */
  int strained, most_strained; /* how often within t_q, in that cycle and in the worst */
} vs_anode;

/* Finds the currents. The setup must outlive *a. */
void vs_anode_begin(vs_anode *a, const vs_setup *setup);

/* The clock is set back by by_s: all instants it remembers move with it. */
void vs_anode_wind(vs_anode *a, double by_s);

/* Returns what the anode current did in the step just shown, and sets *event_s to when, s. */
vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s);

/* True while one of them conducts. */
bool vs_anode_conducts(const vs_anode *a);

/* What the flux linkage may be off by, in parts of run.tolerance, for all the times in the worst
 * cycle that a voltage was back within t_q, so that what charge was left decided what came. */
double vs_anode_strains(const vs_anode *a, const vs_swing *swing);

/* A step of the solver begins, from the last knot shown. */
void vs_anode_leave(vs_anode *a);

/* The solver's step has come to its end, the last knot shown. */
void vs_anode_take(vs_anode *a);

/* Returns the longest step, s, that should be taken from the last knot towards a current's zero,
 * which is foretold from the last two knots, behind an event's edge while a latch conducts, or
 * while a thyristor may let go of its current, with an error of its charge of so much of swing's
 * (vs_swing_charge). INFINITY: no zero is within two steps of max_step_s, and none may let go. */
double vs_anode_longest(vs_anode *a, const vs_swing *swing, double max_step_s);
