/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/occurrence.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>

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

bool vs_occurrence_network(const vs_occurrence *e, char *text, size_t size) {
  char own[64];
  if (!e->kind->network) return false;
  e->kind->network(e, own, sizeof own);
  snprintf(text, size, "%s, line to %s", own, e->v.earth ? "earth" : "line");
  return true;
}

double vs_occurrence_on_line(const vs_occurrence *e, double t_s) {
  return t_s > e->on_line_s + vs_occurrence_rounding(t_s) ? 1 : 0;
}

const vs_occurrence *vs_occurrence_repeated(const vs_events *events) {
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].v.times > 1) return &events->item[k];
  return NULL;
}

/* The instant is finite, as the armature of a scene with a jam may never be stood in for, however
 * late it jams (engine/macromodel/quiet.c). */
static const double NEVER_S = 1e30;

void vs_occurrence_put_off(vs_occurrence *e, size_t number) {
  bool strikes = e->on_line_s > 0 && e->on_line_s == e->start_s;
  e->start_s = e->end_s = NEVER_S * (1 + (double)number);
  if (strikes) e->on_line_s = e->start_s;
  e->v.cycle = INT_MIN; /* by which events at the gate know their pulse */
}

/* Angles of ports are read from text in degrees; two that mean the same differ by rounding alone.
 */
bool vs_occurrence_at_gate(const vs_occurrence *e, double shift_rad) {
  return isnan(e->gate_rad) || fabs(e->gate_rad - shift_rad) < 1e-9;
}
