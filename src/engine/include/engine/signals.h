/* SPDX-License-Identifier: GPL-3.0-or-later
 * The signals that drive the circuit's sources (netlist/port.h), over time. */
#pragma once

#include "engine/timeline.h"
#include "netlist/port.h"

/* The signal's voltage at t, V. */
double vs_signals_voltage(const vs_timeline *timeline, const vs_signal *signal, double t_s);

/* The signal's first edge after t; INFINITY: none. Edges of events are left out: vs_events_edge has
 * those of all events together. */
double vs_signals_edge(const vs_timeline *timeline, const vs_signal *signal, double t_s);

/* For tests: true if the voltage stays as it is from one edge to the next, edges of events
 * included. */
bool vs_signals_holds(const vs_signal *signal);

/* ---- cached ----
 *
 * What stays as it is from one edge to the next, remembered: a circuit's solver asks for it several
 * times a step, while an edge comes once in some hundred steps. */

/* A number that holds from an instant on, and up to another one. {0} holds at no time. */
typedef struct vs_signals_cache {
  double from_s, until_s, number;
} vs_signals_cache;

static inline bool vs_signals_cache_holds(const vs_signals_cache *cache, double t_s) {
  return t_s >= cache->from_s && t_s < cache->until_s;
}

/* How near, s, an instant may be to an edge and count as the edge, or as behind it; with room to
 * spare. */
double vs_signals_near(const vs_timeline *timeline, double t_s);

/* What vs_signals_voltage returns, V, from memory where the signal changes at edges alone. *cache
 * is this signal's own. It is to be set to {0} where events or the timeline have changed. */
double vs_signals_voltage_cached(vs_signals_cache *cache, const vs_timeline *timeline,
                                 const vs_signal *signal, double t_s);
