/* SPDX-License-Identifier: GPL-3.0-or-later
 * Gate pulses: a train of them as the scene's section firing says, as events leave it, and those
 * that events add. `shift_rad` delays the train: a second thyristor fires 180 degrees later.
 *
 * A pulse is there from behind its leading edge up to its trailing edge, so that a step that ends
 * on an edge still sees what was before it. */
#pragma once

#include "engine/timeline.h"

/* The voltage of the gate pulse at t: 1 V, unless events change it; 0 V where there is none. */
double vs_gate_voltage(const vs_timeline *timeline, double shift_rad, double t_s);

/* True where that voltage is above zero. */
bool vs_gate_is_on(const vs_timeline *timeline, double shift_rad, double t_s);

/* The instant at which a step of the solver from t0 to t1 is asked for its gate: its end, and
 * behind an edge that the step begins on, even where the step is shorter than instants round. There
 * the end is not told from the edge, but the solver, which has tried longer steps before, may have
 * fired. */
double vs_gate_of_step(double t0_s, double t1_s);

/* The first edge of the train's pulses after t; INFINITY: none. Edges of pulses that events add are
 * among those of vs_events_edge. */
double vs_gate_edge(const vs_timeline *timeline, double shift_rad, double t_s);

/* The first stretch of time with a gate pulse that ends after t and begins before `until_s`, from
 * its beginning or from t on, whichever is later. Returns false where there is none. */
bool vs_gate_stretch(const vs_timeline *timeline, double shift_rad, double t_s, double until_s,
                     double *from_s, double *to_s);

/* Sub-pulses are what a pulse transformer is driven with: the first burst_duty of each period
 * 1/burst_hz of a gate pulse. True within one. */
bool vs_gate_burst(const vs_timeline *timeline, double shift_rad, double t_s);
/* The first edge of a sub-pulse after t; INFINITY: none. */
double vs_gate_burst_edge(const vs_timeline *timeline, double shift_rad, double t_s);

/* The first instant at or after t at which a pulse of the train meets forward mains voltage, events
 * left aside; INFINITY: never. With events: vs_wave_conduction. */
double vs_gate_next_conduction(const vs_timeline *timeline, double t_s);

/* The gate pulses of a device. Their edges are ends of steps. */
typedef struct vs_gate_watch {
  const vs_timeline *timeline;
  vs_gates gates; /* whose pulses they are; none: nothing is known of its gate, which then counts
                     as always on */
  bool on;        /* there is a pulse in the step last followed */
  bool begins, ended; /* a pulse began, or ended, at that step's beginning */
  bool bursts;        /* its pulses are filled with sub-pulses, by the deck's port burst */
  double edge_s;      /* instant of the next edge */
  double off_since_s; /* end of the last pulse; -INFINITY: there was none */
} vs_gate_watch;
/* gates: as in the struct, which copies them. */
void vs_gate_watch_begin(vs_gate_watch *gate, const vs_timeline *timeline, const vs_gates *gates);
/* Takes the next step, from t0_s to t1_s. */
void vs_gate_watch_follow(vs_gate_watch *gate, double t0_s, double t1_s);
