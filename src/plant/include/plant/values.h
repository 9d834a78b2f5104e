/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the scene's section actuator says, in SI. Each member's meaning stands in the texts of
 * vs_actuator_section (plant/actuator.h). */
#pragma once

#include "base/field.h"
#include "plant/stops.h"

typedef struct vs_stop_values {
  int present;                    /* 0: there is no stop, and behind a list's last one */
  double stiffness, damping_ns_m; /* stiffness: N/m or N/m2, by kind */
  int kind;                       /* index into vs_stop_kinds */
  double at_m;                    /* the gap z at which it is met; NaN: the pole cover */
} vs_stop_values;
/* Saturation of the iron (docs/theory.md). */
typedef struct vs_saturation_values {
  int present;
  int law; /* 0: series, 1: multiplicative */
  double flux_wb, exponent;
  double current_a; /* 0 where the law is multiplicative */
} vs_saturation_values;
/* One shorted secondary, as which eddy currents act (plant/coil.h). */
enum { VS_MOST_RUNGS = 3 };
typedef struct vs_rung_values {
  int present; /* 0: behind the last */
  double inductance_h, resistance_ohm, coupling;
} vs_rung_values;
/* The winding's warmth (plant/coil.h). Of a pair the first is between winding and core, or the
 * winding's, the second between core and ambient, or the core's. */
typedef struct vs_winding_values {
  int present;
  double temperature_degc, coefficient_1_k, r_th[2], c_th[2], ambient_degc;
} vs_winding_values;
typedef struct vs_actuator_values {
  char law[VS_NAME_SIZE]; /* a law's name, or a table's file */
  double gap_m, pole_cover_m, inductance_h, resistance_ohm, leakage_h;
  vs_saturation_values saturation;
  double linear_to_wb; /* NaN: the scene does not say */
  double emf_constant_vs_m, force_constant_n_a; /* the latter NaN: equal to the former */
  vs_stop_values stop[VS_MOST_STOPS];           /* in the scene's order */
  vs_rung_values eddy[VS_MOST_RUNGS];
  vs_winding_values winding;
} vs_actuator_values;
