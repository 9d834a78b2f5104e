/* SPDX-License-Identifier: GPL-3.0-or-later
 * The law of an actuator: how its current and its force follow from flux linkage and gap. From one
 * energy W(lambda, z) follow the current i = dW/dlambda and the force F = dW/dz, which is positive
 * where it closes the gap. A law gives these three, and writes the first two for the netlist. */
#pragma once

#include <stdbool.h>

#include "base/formula.h"
#include "base/text.h"
#include "base/tree.h"

typedef struct vs_coil vs_coil; /* plant/coil.h */

typedef struct vs_law_rates {
  double i_a, i_rate_a_s, force_n, force_rate_n_s;
} vs_law_rates;

/* What a law is built from besides the scene's section actuator: the formulas of a machine's file,
 * in lambda (term 0) and z (term 1), their names bound. A law copies what it keeps. */
typedef struct vs_law_formulas {
  const vs_formula *current, *energy, *force; /* NULL: the file has none */
  vs_where where[3];                          /* theirs, in this order */
} vs_law_formulas;

struct vs_actuator_values;

/* Each law is a constant in its own file. Lambda is in Wb, z in m. All functions are pure. */
typedef struct vs_law {
  const char *name, *text;
  const char *keys;   /* of the section actuator, those that not all laws use: "leakage|saturation";
                         NULL: it needs none of these */
  const char *ending; /* the law is read from a file, which ends so (".csv"); NULL: the scene names
                         it by its name */
  /* Fills the coil's numbers besides law, resistance_ohm and gap_rest_m, which are there already.
   * Errors with their place in `map`, the scene's section actuator, or in the formulas. */
  vs_status (*build)(const struct vs_actuator_values *values, const vs_node *map,
                     const vs_law_formulas *formulas, vs_coil *coil, vs_error *err);
  void (*end)(vs_coil *coil); /* frees coil->own; NULL: there is nothing to free */
  bool poles; /* the gap lies between poles that may meet: without a stop a run ends there */
  double (*current)(const vs_coil *coil, double flux_wb, double z_m); /* A */
  double (*force)(const vs_coil *coil, double flux_wb, double z_m);   /* N */
  double (*energy)(const vs_coil *coil, double flux_wb, double z_m);  /* J */
  /* Current and force with their first two derivatives in time, on a path on which lambda and z
   * have these values and derivatives: flux[k], z[k], current[k] and force[k] are k-th derivatives,
   * k = 0..2. */
  void (*along)(const vs_coil *coil, const double flux[3], const double z[3], double current[3],
                double force[3]);
  /* The electrical power that the law takes for the motion, less the mechanical power that it
   * gives, W, at a rate of the gap z. NULL: it has one energy, and both are the same. */
  double (*transducer_w)(const vs_coil *coil, double flux_wb, double z_m, double z_rate_m_s);
  /* Flux linkage and current up to which, and gaps within which, the law is known; a run that
   * leaves them ends with an error that says why. NULL: everywhere. Returns NULL where (lambda, z)
   * is within, else what is wrong, in `text`. */
  const char *(*beyond)(const vs_coil *coil, double flux_wb, double z_m, char *text, size_t size);
  /* Writes the current and the force for ngspice, as expressions of a B source in nodes whose
   * voltages are lambda and z ("v(lam)", "v(z)"); `lines` gets netlist lines that these need, in a
   * subcircuit of their own. Numbers are written by vs_b_source_number. NULL: the law cannot be
   * written so, and tier circuit and export refuse it by name. */
  void (*netlist)(const vs_coil *coil, const char *flux, const char *gap, vs_text *lines,
                  vs_text *current, vs_text *force);
  /* The path of the file that this coil was read from. NULL: there is none. */
  const char *(*file)(const vs_coil *coil);
  /* What whoever runs or checks the scene should know of this coil, in `text`. NULL, or returns
   * NULL: nothing. */
  const char *(*note)(const vs_coil *coil, char *text, size_t size);
} vs_law;

/* The laws, each in its own file (reluctance.c, ...); vs_actuator_laws (plant/actuator.h) lists
 * them. */
extern const vs_law vs_reluctance_law, vs_moving_coil_law, vs_formulas_law, vs_table_law;
