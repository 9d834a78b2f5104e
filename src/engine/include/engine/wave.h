/* SPDX-License-Identifier: GPL-3.0-or-later
 * The mains between two edges of the events, as a sum of few sines, or direct voltage: what
 * vs_timeline_voltage gives for one instant, for those who need derivatives and zeros. */
#pragma once

#include "engine/timeline.h"

enum { VS_WAVE_MOST = 1 + VS_EVENTS_MOST }; /* the fundamental, and a harmonic for each event */

typedef struct vs_sine {
  double peak_v, omega_rad_s, phase_rad; /* the phase at the wave's origin */
} vs_sine;
typedef struct vs_wave {
  double direct_v;      /* where the mains are direct voltage; there are no sines then */
  size_t count;         /* of the sines: the fundamental comes first */
  double highest_rad_s; /* the largest omega of the sines; 0: there are none */
  vs_sine sine[VS_WAVE_MOST];
} vs_wave;

/* Fills the wave whose origin is t_s. It holds up to the next edge (vs_wave_edge), with the events
 * that are on right behind t_s. */
void vs_wave_of(const vs_timeline *timeline, double t_s, vs_wave *wave);

/* u [V], u' [V/s] and u'' [V/s2], `since_s` behind the origin. */
void vs_wave_at(const vs_wave *wave, double since_s, double u[3]);

/* True where the wave is 0 V throughout. */
bool vs_wave_is_silent(const vs_wave *wave);

/* The first instant in [since_s, until_s), counted from the origin, from which on sense*u > 0; NaN:
 * there is none. It is found to rounding, and no zero is passed over. */
double vs_wave_turns(const vs_wave *wave, int sense, double since_s, double until_s);

/* The first instant after t at which an event changes the mains; INFINITY: none. */
double vs_wave_edge(const vs_timeline *timeline, double t_s);

/* As vs_gate_next_conduction, with events: the first instant at or after t, and before until_s, at
 * which the first gate's pulse, as events leave or add it, meets forward voltage; INFINITY: never.
 */
double vs_wave_conduction(const vs_timeline *timeline, double t_s, double until_s);

/* The first instant before until_s at which a pulse of the gate that is delayed by shift_rad meets
 * mains of more than above_v; INFINITY: never. Which way is forward is known of the gate without a
 * delay only: at another gate mains of either sign count. */
double vs_wave_chance(const vs_timeline *timeline, double shift_rad, double above_v,
                      double until_s);
