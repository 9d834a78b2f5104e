/* SPDX-License-Identifier: GPL-3.0-or-later
 * Pulse-width modulation, as the scene's section `pwm` says it. A reference m(t) between 0 and 1 is
 * compared with a triangular carrier c(t), which rises from 0 to 1 and falls back again in each of
 * its periods, and is 0 at t = 0:
 *
 *   m(t) = duty(t) + depth/2 sin(2 pi frequency t + phase - shift)
 *
 * The reference is compared at every instant (natural sampling). While m is above c the upper
 * switch is to conduct, else the lower one. Each is driven `dead_time` later than that, and ends at
 * once; a pulse no longer than the dead time is left out.
 *
 * With `on` or `off` there is no carrier: the upper switch is on from the one to the other, once.
 *
 * A flank of the carrier is half of its period. Flank k, a whole number, lasts from k/(2 f) to
 * (k + 1)/(2 f), with f the carrier's frequency; the carrier rises on even flanks. As the reference
 * changes more slowly than the carrier, they meet exactly once on each flank. */
#pragma once

#include "base/error.h"
#include "base/field.h"

typedef struct vs_pwm_values {
  double carrier_hz;
  vs_field_profile duty;
  double depth;                   /* of the sine, from its least to its largest value */
  double frequency_hz, phase_rad; /* of the sine */
  double dead_s;
  double on_s, off_s; /* one pulse; both 0: the carrier's; off_s 0 or INFINITY: it has no end */
} vs_pwm_values;

/* One switch of a leg. */
typedef struct vs_pwm_switch {
  double shift_rad; /* how much later than `phase` says the leg's sine comes */
  bool low;         /* the lower switch, which is on while the upper one is off */
} vs_pwm_switch;

extern const vs_section vs_pwm_section;

/* Is there one pulse alone, without a carrier? */
bool vs_pwm_is_single(const vs_pwm_values *pwm);

/* Errors, at the key's place: the reference leaves 0..1, or changes faster than the carrier; the
 * dead time is longer than a flank; one pulse that ends before it begins, or beside a carrier.
 * `section` may be NULL; where it has `on: 0 ms` alone, off_s becomes INFINITY. */
vs_status vs_pwm_check(const vs_node *section, vs_pwm_values *pwm, vs_error *err);

/* True while the switch is driven at t: from behind the edge that begins a pulse up to the one that
 * ends it, so that a step that ends on an edge sees what was before it. */
bool vs_pwm_is_on(const vs_pwm_values *pwm, vs_pwm_switch of, double t_s);

/* The switch's first edge after t. Where none comes within two periods of the carrier, it is an
 * instant not later than the next one at which the carrier turns, with no change there; INFINITY
 * behind a single pulse. */
double vs_pwm_edge(const vs_pwm_values *pwm, vs_pwm_switch of, double t_s);

/* When the reference meets the carrier on flank k, s: found to rounding; for tests. */
double vs_pwm_crossing(const vs_pwm_values *pwm, double shift_rad, double k);

/* Writes what is to be said where the dead time leaves out pulses of the upper switch, or of the
 * lower one. False: it leaves out none. */
bool vs_pwm_drops(const vs_pwm_values *pwm, bool low, char *text, size_t size);
