/* SPDX-License-Identifier: GPL-3.0-or-later
 * Instruments of a run that a pilot brings to its orbit first (engine/sim.h). An onset stands in
 * the pilot's place, and hands everything on to it. Besides, it takes the low-passes of the
 * instruments along in the prelude. When the run begins it puts each low-pass to where the orbit
 * has it, which is the state that repeats after the prelude's last period. */
#ifndef VS_MEASURE_ONSET_H
#define VS_MEASURE_ONSET_H

#include "measure/meter.h"
#include "engine/sim.h"

typedef struct vs_onset {
  vs_pilot pilot;                     /* for the run's order, in the place of `steers` */
  vs_pilot *steers;                   /* borrowed, as what follows */
  vs_instruments *instruments;        /* their on_orbit and x are set */
  vs_meter *meters;                   /* of these instruments, in their order */
  double from[VS_INSTRUMENT_MOST][2]; /* of the low-passes where the present period
                                                         of the orbit began */
  long parts;                         /* of the prelude that are behind */
} vs_onset;

/* Begins the meters anew, with low-passes at 0. Not to be moved; owns nothing. */
void vs_onset_begin(vs_onset *onset, vs_pilot *steers, vs_instruments *instruments,
                    vs_meter *meters);

#endif
