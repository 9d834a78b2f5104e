/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the outside does at which time: the scene's sections supply, firing and pwm, the events, and
 * the mains' voltage that comes of them. The gate's pulses are in engine/gate.h, those of
 * pulse-width modulation in engine/pwm.h.
 *
 * Events act on the mains in fixed stages, whatever the order of their lines. First, jumps of phase
 * are added to the angle of the undisturbed sine. Then harmonics, at the phase of that sine, are
 * added to its voltage. Then the sum is multiplied by each factor, those of sags, swells,
 * interruptions and notches. So there is no voltage within an interruption. */
#pragma once

#include "base/error.h"
#include "base/section_cache.h"
#include "engine/pwm.h"
#include "engine/scene_event.h"
#include "plant/feed.h"
#include "plant/machine.h"

/* The angles that a control decides while a run goes on, one for each firing, in order. */
typedef struct vs_program {
  double *angle_rad; /* NaN: no firing. Owned by whoever decides */
  long count, size;  /* how many are decided; how many there is room for */
  double range[2];   /* rad; they lie in it */
} vs_program;

typedef struct vs_timeline {
  vs_supply_values supply;
  vs_firing_values firing;
  vs_pwm_values pwm;
  double peak_v, omega_rad_s, period_s; /* of the undisturbed mains; a direct voltage is its own
                                           peak */
  double first_zero_s;                  /* their first rising zero crossing at or after t = 0 */
  vs_events events;                     /* none, unless vs_events_read filled it */
  const vs_program
      *program;       /* of the run under way, borrowed; NULL: angles are those of `firing` */
  const bool *spares; /* of the run under way, borrowed: true while it leaves the gates' sub-pulses
                         out (vs_run_order.spares); NULL: it never does */
} vs_timeline;

/* Fills the timeline from the scene's sections supply, firing and pwm, without events. What the
 * scene leaves out is the machine's; NULL: there is none, and it is the paper's. memo: what
 * they were read from the last time; NULL: nothing is known of it. Errors: what
 * vs_field_section_read and vs_pwm_check refuse; a pulse that reaches into the next one. */
vs_status vs_timeline_build(const vs_node *scene, const vs_machine *machine, vs_timeline *timeline,
                            vs_section_cache *memo, vs_error *err);

/* Looks whether there is a gate to be fired: where the deck has ports pwm and no gate there is
 * none, which then counts as firing.valve: none. Errors: neither scene nor machine says what the
 * coil is fed from and how it is fired; a key of the section firing where nothing
 * fires; a thyristor on direct voltage. */
vs_status vs_timeline_settle(const vs_node *scene, const vs_machine *machine, vs_timeline *timeline,
                             const vs_deck *deck, vs_error *err);

/* The mains' voltage with events, V; without, u = sqrt(2) U sin(wt + phase) (Eq. 90), or U where it
 * is direct. */
double vs_timeline_voltage(const vs_timeline *timeline, double t_s);

/* The angle since the last rising zero of the undisturbed mains, from 0 to 2 pi. */
double vs_timeline_phase(const vs_timeline *timeline, double t_s);

/* What all events of the stage VS_MAINS_ANGLE (their sum, rad) or VS_MAINS_FACTOR (their product)
 * make of the mains at t. Harmonics, the stage between, depend on the angle too and are not asked
 * for so. */
double vs_timeline_stage(const vs_timeline *timeline, vs_mains_stage stage, double t_s);
