/* SPDX-License-Identifier: GPL-3.0-or-later
 * An instrument at work. It is shown the accepted steps of a run and makes a sample at the instants
 * 0, 1/rate, 2/rate, ... Between two of them its value is held, as the A/D of a real one holds it.
 *
 * A sample is made as the hardware makes it, in this order:
 *   1. the sensor cannot follow its channel beyond its range, and shows the range's end instead;
 *   2. its low-pass follows that, all the time and not only at the samples;
 *   3. noise is added: normally distributed, and independent from sample to sample (white);
 *   4. the A/D takes the nearest of its steps, range[0] + code (range[1] - range[0])/2^bits with a
 *      code from 0 to 2^bits - 1. So it never shows the upper end itself. In the middle of two
 * steps it takes the upper one. At t = 0 the low-pass is settled: the channel is taken to have
 * stood still before. A run that begins on an orbit has it as the orbit has it
 * (instrument->on_orbit).
 *
 * A meter is a plain struct, and a copy made by `=` goes on by itself. What it shows follows from
 * the steps, its own keys, its name and the seed alone: neither other instruments nor whoever asks
 * it at which instants change a bit of it. */
#pragma once

#include "engine/sim.h"
#include "engine/step.h"
#include "measure/instruments.h"
#include "measure/lowpass.h"

typedef struct vs_meter {
  const vs_instrument *instrument; /* borrowed */
  double value;                    /* of the last sample, in the channel's unit; NaN before it */
  long samples;                    /* how many were made; the next is due at samples/rate */
  long beyond;                     /* before how many of them the channel was beyond the range */
  double beyond_s;                 /* when the first of these was made; NaN: none was */

  double range[2], noise; /* the instrument's, in the channel's unit */
  bool outside;           /* the channel was beyond the range since the last sample */
  double t_s;             /* up to where the low-pass has come; NaN before the first step */
  vs_lowpass lowpass;
  double random[16]; /* state of GSL's generator ranlxd1 */
} vs_meter;

/* Begins a run. instrument: it must outlive the meter. seed: of all instruments; the name makes
 * noise of its own of it. */
void vs_meter_begin(vs_meter *meter, const vs_instrument *instrument, int seed);

/* Makes the samples that are due up to t_s, an instant within the step, and none that was made
 * before. Afterwards meter->value is what a reader at t_s is shown. May be asked again at later
 * instants of the step. */
void vs_meter_to(vs_meter *meter, const vs_step *step, double t_s);
/* Makes the rest of the step's samples and takes the low-pass to the step's end. Every step is to
 * be shown, in order of time. */
void vs_meter_accept(vs_meter *meter, const vs_step *step);

/* What the sensor behind its low-pass shows at t_s, an instant within the step, in the channel's
 * unit: what a sample would be without noise and A/D. Instants are to be asked for in order of
 * time, and the end of every step among them, with vs_meter_accept or here. */
double vs_meter_shown(vs_meter *meter, const vs_step *step, double t_s);

/* When the next sample is due, s. For tests; a control that is sampled asks it too. */
double vs_meter_next_s(const vs_meter *meter);

/* What an A/D of so many bits over the range makes of y: the nearest of its steps, and in the
 * middle of two the upper one, to the last bit of y. 0 bits: there is none, and y stays. For tests.
 */
double vs_meter_quantised(const double range[2], int bits, double y);

/* ---- on the way to an orbit ---- */

/* Instruments of a run that a pilot brings to its orbit first (engine/sim.h). A metered pilot
 * stands in the pilot's place, and hands everything on to it. Besides, it takes the low-passes of
 * the instruments along while the run settles. When the run begins it puts each low-pass to where
 * the orbit has it, which is the state that repeats after the settling's last period. */
typedef struct vs_meter_pilot {
  vs_orbit_search pilot;              /* for the run's order, in the place of `steers` */
  vs_orbit_search *steers;            /* borrowed, as what follows */
  vs_instruments *instruments;        /* their on_orbit and x are set */
  vs_meter *meters;                   /* of these instruments, in their order */
  double from[VS_INSTRUMENT_MOST][2]; /* of the low-passes where the present period
                                                         of the orbit began */
  long parts;                         /* of the settling that are behind */
} vs_meter_pilot;

/* Begins the meters anew, with low-passes at 0. Not to be moved; owns nothing. */
void vs_meter_pilot_begin(vs_meter_pilot *metered, vs_orbit_search *steers,
                          vs_instruments *instruments, vs_meter *meters);
