/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the outside does at which time: mains voltage, zero crossings, gate pulses. */
#ifndef VS_DRIVE_TIMELINE_H
#define VS_DRIVE_TIMELINE_H

#include <stdbool.h>

#include "base/error.h"
#include "base/field.h"
#include "drive/events.h"

typedef struct vs_supply_values {
  double voltage_v, frequency_hz, phase_rad, resistance_ohm, inductance_h;
} vs_supply_values;
typedef struct vs_firing_values {
  double angle_rad, pulse_width_s;
  int every; /* fires in every n-th cycle; 0: once */
  int first_cycle;
  double burst_hz, burst_duty; /* of the sub-pulses that fill a gate pulse */
} vs_firing_values;

extern const vs_section vs_timeline_supply_section, vs_timeline_firing_section;

typedef struct vs_timeline {
  vs_supply_values supply;
  vs_firing_values firing;
  double peak_v, omega_rad_s, period_s;
  double first_zero_s; /* first rising zero crossing at or after t = 0 */
  vs_events events;    /* none, unless vs_events_read filled it */
} vs_timeline;

/* From the scene's sections supply and firing. Errors: what vs_field_section_read refuses; pulses
 * that overlap. */
vs_status vs_timeline_build(const vs_node *scene, vs_timeline *timeline, vs_error *err);

double vs_mains_voltage(const vs_timeline *timeline,
                        double t_s); /* u = sqrt(2) U sin(wt + phase), V (Eq. 90) */
double vs_mains_phase(const vs_timeline *timeline,
                      double t_s); /* angle since the last rising zero, 0..2 pi */
/* What the events of a stage make together of the mains at t, but for harmonics: an angle to add,
 * rad, or a factor. */
double vs_mains_stage_at(const vs_timeline *timeline, vs_mains_stage stage, double t_s);

/* Gate pulse present? shift_rad delays the train (a second thyristor fires 180 degrees later). On
 * after its leading edge and up to its trailing edge, so that a step that ends on an edge still
 * sees what was before it. */
bool vs_gate_is_on(const vs_timeline *timeline, double shift_rad, double t_s);
/* "gate", "gate+180deg": the delay of a port's pulses; false: it is no such name. */
bool vs_gate_named(const char *name, double *shift_rad);
/* Its voltage, which events may change: 1 V. */
double vs_gate_voltage(const vs_timeline *timeline, double shift_rad, double t_s);
/* How well the end of a step meets an edge, s. */
double vs_timeline_rounding(double t_s);
/* First gate edge after t; INFINITY: none. */
double vs_gate_edge(const vs_timeline *timeline, double shift_rad, double t_s);
/* The first stretch of time with a gate pulse that ends after t and begins before `until`: one of
 * the train, as events leave it, or one they add. From its beginning or from t on. false: there is
 * none. */
bool vs_gate_stretch(const vs_timeline *timeline, double shift_rad, double t_s, double until_s,
                     double *from_s, double *to_s);
/* The first burst_duty of each period 1/burst_hz of a gate pulse: what a pulse transformer is
 * driven with. */
bool vs_gate_burst(const vs_timeline *timeline, double shift_rad, double t_s);
double vs_gate_burst_edge(const vs_timeline *timeline, double shift_rad, double t_s);

/* What a source of the circuit is driven with. */
enum { VS_DRIVE_MAINS, VS_DRIVE_GATE, VS_DRIVE_BURST, VS_DRIVE_EVENT, VS_DRIVES };
typedef struct vs_signal {
  int drive;
  double shift_rad; /* a gate's delay */
  size_t event;     /* an event's number */
} vs_signal;
typedef struct vs_drive {
  const char *name; /* of the port in a deck; NULL: no deck has it */
  bool shifts;      /* can be delayed by an angle */
  double (*voltage)(const vs_timeline *timeline, const vs_signal *signal, double t_s); /* V */
  /* the next one; INFINITY: none */
  double (*edge)(const vs_timeline *timeline, const vs_signal *signal, double t_s);
} vs_drive;
extern const vs_drive vs_drives[VS_DRIVES];

/* First instant at or after t at which gate and forward mains voltage are both there; INFINITY:
 * never. */
double vs_gate_next_conduction(const vs_timeline *timeline, double t_s);

#endif
