/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a diode, tried; also of one that stands inside another part. */
#pragma once

#include "test_circuit.h"

/* What the circuits are made for, SI, and by which words the part's file asks. */
typedef struct vs_diode_plan {
  const char *wiring, *way; /* of the trials; which diode, in words, or "" */
  const char *v_param, *r_param, *q_param;
  double test_a, test_a_s; /* current, and its fall, for which Q_rr is given */
  double least_v;          /* of the clamp while it recovers, and of the diode in front of it */
} vs_diode_plan;

/* Each adds rows: V_F; Q_rr, t_rr and I_RM. */
void vs_diode_forward(const vs_stand *stand, const vs_diode_plan *plan, vs_figures *figures);
void vs_diode_recovery(const vs_stand *stand, const vs_diode_plan *plan, vs_figures *figures);
/* Adds the row of a breakdown voltage at 1 mA: at least the limit, or the parameter
 * blocking_voltage. `up` is the source's sign. */
void vs_diode_breakdown(const vs_stand *stand, const char *wiring, const char *const name_limit[2],
                        int up, vs_figures *figures);
