/* SPDX-License-Identifier: GPL-3.0-or-later
 * The energy that a device turns into heat in one pulse, told from the voltage and current at its
 * terminals, between which there may be a capacitance too.
 *
 * A pulse begins when |i| reaches 1 mA. It ends when |i| has stayed below that for a quarter of a
 * mains cycle, 5 ms at 50 Hz. A maker's rating is for one pulse of 2 ms. A disc's heat needs tens
 * of milliseconds to get from its middle to its electrodes, so that what a ring or a burst brings
 * within a few milliseconds adds up as if it had come at once. Yet pulses that come back with every
 * half cycle of the mains stay single ones, for which there is the mean power.
 *
 * The integral of v i is heat and what the capacitance stores. The latter depends on |v| alone, so
 * between two instants of the same |v| the integral is heat alone; and if |v| is less at the
 * second one it is less than the heat. A pulse's heat is the largest such integral in it. So it
 * counts nothing that is only stored, and it is never above the integral over the run. It is known
 * when the voltage has come back: of a pulse in which the current still flows as the run ends all
 * of the integral is taken for heat, which is too much by what is stored then. */
#ifndef VS_WATCH_PULSE_H
#define VS_WATCH_PULSE_H

#include <stdbool.h>

#include "watch/switching.h"

/* Levels of |v| whose first passing is noted: 0 V, then 16 to an octave from 1 V to 131 kV. What
 * heats a varistor below a level, within 4.4 % of the voltage, is left out if its own level is
 * never come back to. */
enum { VS_PULSE_OCTAVES = 17, VS_PULSE_IN_OCTAVE = 16, VS_PULSE_LEVELS = 2 + 17 * 16 };

/* Start with {.rest_s = }. Energies count from the pulse's beginning, J. */
typedef struct vs_pulse {
  double rest_s; /* a pulse ends when its current has stayed away that long */
  bool lasts;
  double current_s;                 /* when it last had a current */
  double energy_j, heat_j;          /* the integral of v i; the most that was found to be heat */
  double begin_v;                   /* |v| at its beginning */
  double passed_j[VS_PULSE_LEVELS]; /* the integral when |v| first was at each level */
  int top;                          /* the highest level passed */
} vs_pulse;

/* Takes the next step of the device's course. Returns the heat of the present pulse; 0 where there
 * is none. */
double vs_pulse_follow(vs_pulse *pulse, const vs_course_step *c);

/* Once the run is over at now_s: the heat of the present pulse, if it still has its current, taken
 * for all of its energy; else 0. */
double vs_pulse_unfinished(const vs_pulse *pulse, double now_s);

#endif
