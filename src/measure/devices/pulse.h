/* SPDX-License-Identifier: GPL-3.0-or-later
 * The energy that a device turns into heat in one pulse. It is told from the voltage and current at
 * the device's terminals, between which there may be a capacitance too.
 *
 * A pulse begins when |i| reaches 1 mA. It ends when |i| has stayed below that for a quarter of a
 * mains cycle, 5 ms at 50 Hz. A maker's rating is for one pulse of 2 ms. A disc's heat needs tens
 * of milliseconds to get from its middle to its electrodes, so that what a ring or a burst brings
 * within a few milliseconds adds up as if it had come at once. Yet pulses that come back with every
 * half cycle of the mains stay single ones; the mean power is the measure for those.
 *
 * The integral of v i is heat and what the capacitance stores. What is stored depends on |v| alone.
 * So between two instants of the same |v| the integral is heat alone; and where |v| is less at the
 * second instant, the integral is less than the heat. A pulse's heat is the largest such integral
 * in it. Therefore it counts nothing that is only stored, and it is never above the integral over
 * the run. It is known when the voltage has come back. Of a pulse whose current still flows as the
 * run ends, all of the integral is taken for heat, which is too much by what is stored then. */
#ifndef VS_MEASURE_PULSE_H
#define VS_MEASURE_PULSE_H

#include <stdbool.h>

#include "measure/switching.h"

/* Levels of |v| whose first passing is noted: 0 V, then 16 to an octave from 1 V to 131 kV. Heat
 * below a level is left out where the pulse never comes back to that level; levels are 4.4 % apart.
 */
enum {
  VS_PULSE_OCTAVES = 17,
  VS_PULSE_IN_OCTAVE = 16,
  VS_PULSE_LEVELS = 2 + VS_PULSE_OCTAVES * VS_PULSE_IN_OCTAVE
};

/* Start from {.rest_s = }. Energies count from the pulse's beginning, J. */
typedef struct vs_pulse {
  double rest_s; /* a pulse ends when its current has stayed away this long */
  bool lasts;
  double current_s;                 /* when the device last had a current */
  double energy_j;                  /* the integral of v i */
  double heat_j;                    /* the most of it that was found to be heat */
  double begin_v;                   /* |v| at the pulse's beginning */
  double passed_j[VS_PULSE_LEVELS]; /* the integral when |v| was first at each level */
  int top;                          /* the highest level passed */
} vs_pulse;

/* Takes the next step of the device's course. Returns the heat of the present pulse, J; 0 where
 * there is none. */
double vs_pulse_follow(vs_pulse *pulse, const vs_course_step *c);

/* True if there is no pulse, and a step with this current, A, at both ends begins none. */
bool vs_pulse_rests(const vs_pulse *pulse, double i_a);

/* Once the run is over, at now_s: all the energy of a pulse whose current still flows; 0 where
 * there is none. */
double vs_pulse_unfinished(const vs_pulse *pulse, double now_s);

#endif
