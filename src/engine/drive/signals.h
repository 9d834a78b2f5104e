/* SPDX-License-Identifier: GPL-3.0-or-later
 * The signals that drive the circuit's sources (netlist/port.h), over time. */
#ifndef VS_ENGINE_SIGNALS_H
#define VS_ENGINE_SIGNALS_H

#include "netlist/port.h"
#include "engine/timeline.h"

/* The signal's voltage at t, V. */
double vs_signals_voltage(const vs_timeline *timeline, const vs_signal *signal, double t_s);

/* The signal's first edge after t; INFINITY: none. Edges of events are left out: vs_events_edge has
 * those of all events together. */
double vs_signals_edge(const vs_timeline *timeline, const vs_signal *signal, double t_s);

/* True if the voltage stays as it is from one edge to the next, edges of events included. */
bool vs_signals_holds(const vs_signal *signal);

#endif
