/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a device that a gate's pulse fires and that then stays on: a thyristor,
 * and a triac in each of its directions. */
#pragma once

#include "test_circuit.h"

/* Anode, cathode and gate of the device in a trial's circuit. */
#define VS_LATCHING_WIRING "Xdut t 0 g %s"

/* How long after what might fire a device it is looked whether that fires late, s. */
#define VS_LATCHING_WAIT_S 2e-3

/* What the circuits are made for, SI: what is asked, or where nothing is asked what is usual. */
typedef struct vs_latching_plan {
  const char *wiring, *way;            /* of the trials; the direction, in words, or "" */
  const char *gate_param, *gate_limit; /* where I_GT is asked; NULL: nowhere */
  double gate_a, latching_a;           /* I_GT, I_L */
  double block_v;                      /* V_DRM */
  double test_a, test_a_s;             /* of t_q and Q_rr */
  double slope_v_s, turn_off_s;        /* dv/dt, t_q: first guesses */
  double back_v_s;                     /* of t_q: how fast the forward voltage comes back */
  double wait_s;                       /* how much longer it is looked whether it fires; mostly 0 */

  /* What vs_latching_fire has seen, on which the other tests build. */
  double fires_a, fires_v; /* I_GT, V_GT; NaN: `why` tells */
  vs_error why;            /* it does not fire, or conducts before */
  bool conducts;           /* with its gate open */
  double leak_s;           /* current over voltage at 12 V with the gate open; NaN: not known */
  double ramp_a, rise_s;   /* what the gate's current rises to in `seen`, and within which time */
  vs_stand_record seen;    /* owned */
} vs_latching_plan;

/* The plan of a thyristor, by what the part's file asks. */
vs_latching_plan vs_latching_plan_of(const vs_stand *stand);

/* Finds what fires the device, before all other tests. Where that is more than the file's I_GT, the
 * other tests drive the gate with it, too: their figures do not hang on that limit. End with
 * vs_stand_free(&plan->seen). */
void vs_latching_fire(const vs_stand *stand, vs_latching_plan *plan);

/* Each adds rows of one figure: V_T at two currents, I_GT and V_GT, I_L, I_H, dv/dt. */
void vs_latching_on_state(const vs_stand *stand, const vs_latching_plan *plan, vs_figures *figures);
void vs_latching_gate(const vs_stand *stand, const vs_latching_plan *plan, vs_figures *figures);
void vs_latching_current(const vs_stand *stand, const vs_latching_plan *plan, vs_figures *figures);
void vs_latching_holding(const vs_stand *stand, const vs_latching_plan *plan, vs_figures *figures);
void vs_latching_rise(const vs_stand *stand, const vs_latching_plan *plan, vs_figures *figures);
/* Where a figure is held because the device does not fire: runs the figure's test once more at what
 * is asked. The plan in ctx has VS_LATCHING_WAIT_S for wait_s; the test's answer is `fires` if the
 * device has fired. A model that fires late could not be judged. */
void vs_latching_late(const vs_stand *stand, vs_figures_test test, const void *ctx, bool fires,
                      vs_figure *row);
/* Adds the on-state's curve. */
void vs_latching_draw_on_state(const vs_stand *stand, const vs_latching_plan *plan,
                               vs_figures *figures);

/* The error of a device that was never on, so that nothing is to be said of it. */
vs_status vs_latching_not_on(vs_error *err);
