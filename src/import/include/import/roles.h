/* SPDX-License-Identifier: GPL-3.0-or-later
 * The roles of a netlist's elements: which source is the mains, which ones fire thyristors, which
 * branch is the coil of the EVA (the electromagnetic vibratory actuator). */
#pragma once

#include "import/courses.h"

enum { VS_ROLES_GATES = 8 };

/* What the command line says of each role; NULL: nothing. */
typedef struct vs_roles_asked {
  const char *mains; /* "V1", "none" */
  const char *gate;  /* "V3", "V3,V4", "none" */
  const char *coil;  /* "L1", "L1+R4" */
} vs_roles_asked;

/* A source that fires a thyristor. */
typedef struct vs_roles_gate {
  const vs_element *source;
  vs_course_pulse pulse;
  int each;         /* pulses in a cycle of the mains: 1 or 2 */
  double shift_deg; /* how much later than firing.angle it fires */
  bool turned;      /* the source rests at the firing level, so `pulse` is the time between its own
                       pulses */
  double early_s;   /* the source also fires from t = 0 to here; the deck's does not; 0: no */
} vs_roles_gate;

typedef struct vs_roles {
  const vs_element *mains; /* NULL: none */
  double rms_v, hz, phase_deg;
  vs_roles_gate gates[VS_ROLES_GATES];
  size_t n_gates;
  const vs_element *coil, *coil_r; /* the inductor, and the resistor in series (NULL: none) */
  int coil_plus, coil_minus;       /* indices of nodes */
  double inductance_h, resistance_ohm;
  bool found_mains, found_gate, found_coil; /* found, and not told by the user */
  /* The netlist's firing, for a scene's section `firing`. NaN: the netlist does not say. */
  double angle_deg, width_s;
  int every;       /* 0: once */
  int first_cycle; /* 0: the cycle under way at t = 0 */
  bool delayed;    /* the netlist's mains begin after t = 0; the program's begin there */
  bool at_zero; /* it fires at the mains' zero, which firing.angle excludes; a little more is taken
                 */
  bool begins_with_current; /* the coil has an initial current, IC=, in the netlist */
  const vs_element *heats;  /* which of the coil's two has a temperature coefficient; NULL: none */
  const vs_element *modelled; /* which of the coil's two has a .model; NULL: none */
} vs_roles;

/* Finds the roles in a netlist: the mains, the gates, the coil. What the user says decides; without
 * it, only an element that is the sole candidate is taken. Errors, each with its place and the
 * option that would decide: several elements could have the role, or the element that the user
 * named does not exist or is of the wrong kind. */
vs_status vs_roles_find(const vs_elements *wiring, const vs_values *values,
                        const vs_roles_asked *asked, vs_roles *roles, vs_error *err);

/* The index of the gate that this source is; -1: it is no gate. */
int vs_roles_gate_of(const vs_roles *roles, const vs_element *source);
