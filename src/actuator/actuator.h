/* SPDX-License-Identifier: GPL-3.0-or-later
 * The scene's section actuator: coil, gap and stops, and the laws that a coil may have. */
#ifndef VS_ACTUATOR_ACTUATOR_H
#define VS_ACTUATOR_ACTUATOR_H

#include "actuator/coil.h"
#include "actuator/stop.h"
#include "syntax/field.h"

/* What the scene says, in SI. Each member's meaning stands in the texts of vs_actuator_section. */
typedef struct vs_stop_values {
  int present;                    /* 0: there is no stop, and behind a list's last one */
  double stiffness, damping_ns_m; /* stiffness: N/m or N/m2, by kind */
  int kind;                       /* index into vs_stop_kinds */
  double at_m;                    /* the gap z at which it is met; NaN: the pole cover */
} vs_stop_values;
/* Saturation of the iron (docs/machines.md). */
typedef struct vs_saturation_values {
  int present;
  int law; /* 0: series, 1: multiplicative */
  double flux_wb, exponent;
  double current_a; /* 0 where the law is multiplicative */
} vs_saturation_values;
typedef struct vs_actuator_values {
  char law[VS_NAME_SIZE]; /* a law's name, or a table's file */
  double gap_m, pole_cover_m, inductance_h, resistance_ohm, leakage_h;
  vs_saturation_values saturation;
  double emf_constant_vs_m, force_constant_n_a; /* the latter NaN: equal to the former */
  vs_stop_values stop[VS_MOST_STOPS];           /* in the scene's order */
} vs_actuator_values;

extern const vs_section vs_actuator_section;

/* The laws, in the order of lists; NULL behind the last. */
extern const vs_law *const vs_actuator_laws[];

/* Makes the coil and the stops of these values. map: the section they were read from, for the
 * places of errors; NULL where the scene has none. Errors: a law that there is not, a key that the
 * law does not use, and the law's own. The caller frees the coil with vs_actuator_end, also after
 * an error. */
vs_status vs_actuator_build(const vs_actuator_values *values, const vs_node *map,
                            const vs_law_formulas *formulas, vs_coil *coil, vs_stops *stops,
                            vs_error *err);
void vs_actuator_end(vs_coil *coil);

#endif
