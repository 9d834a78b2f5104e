/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "event/occurrence.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* ngspice ends a step at a breakpoint or 1e-11 of the largest step before it. A larger slack would
 * put the jump behind the breakpoint, where ngspice does not expect one. */
double vs_occurrence_rounding(double t_s) {
  return 1e-15 + 8 * DBL_EPSILON * t_s;
}

bool vs_occurrence_is_on(const vs_occurrence *e, double t_s) {
  double slack = vs_occurrence_rounding(t_s);
  return t_s > e->start_s + slack && t_s <= e->end_s + slack;
}

double vs_occurrence_edge(const vs_occurrence *e, double t_s) {
  return t_s < e->start_s ? e->start_s : t_s < e->end_s ? e->end_s : INFINITY;
}

/* The instant is finite, as the armature of a scene with a jam may never be stood in for, however
 * late it jams (quiet/quiet.c). */
static const double NEVER_S = 1e30;

void vs_occurrence_put_off(vs_occurrence *e, size_t number) {
  e->start_s = e->end_s = NEVER_S * (1 + (double)number);
  e->v.cycle = INT_MIN; /* by which events at the gate know their pulse */
}

/* Angles of ports are read from text in degrees; two that mean the same differ by rounding alone.
 */
bool vs_occurrence_at_gate(const vs_occurrence *e, double shift_rad) {
  return isnan(e->gate_rad) || fabs(e->gate_rad - shift_rad) < 1e-9;
}
