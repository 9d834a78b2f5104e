/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene_event.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>

/* ngspice ends a step at a breakpoint or 1e-11 of the largest step before it. A larger slack would
 * put the jump behind the breakpoint, where ngspice does not expect one. */
double vs_scene_event_rounding(double t_s) {
  return 1e-15 + 8 * DBL_EPSILON * t_s;
}

bool vs_scene_event_is_on(const vs_scene_event *e, double t_s) {
  double slack = vs_scene_event_rounding(t_s);
  return t_s > e->start_s + slack && t_s <= e->end_s + slack;
}

double vs_scene_event_edge(const vs_scene_event *e, double t_s) {
  return t_s < e->start_s ? e->start_s : t_s < e->end_s ? e->end_s : INFINITY;
}

bool vs_scene_event_network(const vs_scene_event *e, char *text, size_t size) {
  char own[64];
  if (!e->kind->network) return false;
  e->kind->network(e, own, sizeof own);
  snprintf(text, size, "%s, line to %s", own, e->v.earth ? "earth" : "line");
  return true;
}

double vs_scene_event_on_line(const vs_scene_event *e, double t_s) {
  return t_s > e->on_line_s + vs_scene_event_rounding(t_s) ? 1 : 0;
}

const vs_scene_event *vs_scene_event_repeated(const vs_events *events) {
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].v.times > 1) return &events->item[k];
  return NULL;
}

/* The instant is finite, as the armature of a scene with a jam may never be stood in for, however
 * late it jams (engine/macromodel/oneport_macromodel.c). */
static const double NEVER_S = 1e30;

void vs_scene_event_put_off(vs_scene_event *e, size_t number) {
  bool strikes = e->on_line_s > 0 && e->on_line_s == e->start_s;
  e->start_s = e->end_s = NEVER_S * (1 + (double)number);
  if (strikes) e->on_line_s = e->start_s;
  e->v.cycle = INT_MIN; /* by which events at the gate know their pulse */
}

/* Angles of ports are read from text in degrees; two that mean the same differ by rounding alone.
 */
bool vs_scene_event_at_gate(const vs_scene_event *e, double shift_rad) {
  return isnan(e->gate_rad) || fabs(e->gate_rad - shift_rad) < 1e-9;
}
