/* SPDX-License-Identifier: GPL-3.0-or-later
 * The scene's section actuator: coil, gap and stops. */
#ifndef VS_ACTUATOR_ACTUATOR_H
#define VS_ACTUATOR_ACTUATOR_H

#include "actuator/coil.h"
#include "actuator/stop.h"
#include "syntax/field.h"

/* What the scene says, in SI. Each member's meaning stands in the texts of vs_actuator_section. */
typedef struct vs_stop_values {
  int present; /* 0: there is no stop */
  double stiffness_n_m, damping_ns_m;
} vs_stop_values;
typedef struct vs_actuator_values {
  double gap_m, pole_cover_m, inductance_h, resistance_ohm;
  vs_stop_values stop; /* it stands at p = -gap_m */
} vs_actuator_values;

extern const vs_section vs_actuator_section;

/* Makes the coil and the stops of these values. */
vs_status vs_actuator_build(const vs_actuator_values *values, vs_coil *coil, vs_stops *stops,
                            vs_error *err);

#endif
