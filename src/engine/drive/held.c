/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/held.h"

#include <math.h>

#include "engine/events.h"

/* Edges are told from one another by vs_occurrence_rounding, or by 1e-9 of the time between two of
 * them (engine/drive/generators.c, engine/drive/disturbances.c), which is a period of the mains at most. */
static const double ROUNDINGS = 8, OF_PERIOD = 2e-9;

double vs_held_near(const vs_timeline *t, double t_s) {
  return fmax(ROUNDINGS * vs_occurrence_rounding(fabs(t_s)), OF_PERIOD * t->period_s);
}

/* What a control decides next is not known, so that with one nothing is remembered. On an edge the
 * voltage still is what it was before it. */
double vs_held_voltage(vs_held *h, const vs_timeline *t, const vs_signal *s, double t_s) {
  if (vs_held_at(h, t_s)) return h->number;
  double v = vs_signals_voltage(t, s, t_s);
  if (!vs_signals_holds(s) || t->program) return v;
  double near_s = vs_held_near(t, t_s), before_s = t_s - near_s;
  double edge_s = fmin(vs_signals_edge(t, s, before_s), vs_events_edge(&t->events, before_s));
  *h = (vs_held){t_s, edge_s - near_s, v};
  return v;
}
