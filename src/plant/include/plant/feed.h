/* SPDX-License-Identifier: GPL-3.0-or-later
 * The actuator's supply and firing: the keys of the sections supply and firing, of a scene and of a
 * machine's file. engine/timeline.h makes voltages and pulses of them. */
#pragma once

#include "base/field.h"

typedef struct vs_supply_values {
  int direct; /* 1: direct voltage, voltage_v, instead of a sine */
  double voltage_v, frequency_hz, phase_rad, resistance_ohm, inductance_h;
  double decoupling_h; /* of a coupling/decoupling network, between the source and the line */
} vs_supply_values;
typedef struct vs_firing_values {
  int no_valve; /* 1: the coil is on the mains from t = 0 on; what follows here does not count */
  vs_field_profile angle; /* rad */
  double pulse_width_s;
  int every; /* fires in every n-th cycle; 0: once */
  int first_cycle;
  double burst_hz,
      burst_duty; /* of the sub-pulses that fill a gate pulse; the duty is a fraction */
} vs_firing_values;

/* Their defaults are those of the paper (Table 1); a machine's file has its own. */
extern const vs_section vs_feed_supply, vs_feed_firing;
