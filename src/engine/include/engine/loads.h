/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine of a scene over time: events may change its load, and with it its masses. What is
 * added arrives with the trough's velocity, and what is taken away leaves with it, so that q and q'
 * go on as they are while M jumps. */
#ifndef VS_ENGINE_LOADS_H
#define VS_ENGINE_LOADS_H

#include "engine/timeline.h"
#include "plant/model.h"

/* The machine from an instant on. */
typedef struct vs_loaded {
  double at_s;
  vs_model model; /* borrows what the coil of the scene's own model owns */
} vs_loaded;

/* Start from {0}; free with vs_loads_free. */
typedef struct vs_loads {
  size_t count;
  vs_loaded *item; /* in order of time; owned */
} vs_loads;

/* Builds the machine that each event leaves behind from the scene's own, `model`, whose member
 * `reloaded` it sets. What an event does not name stays as it was before it. What `loads` had is
 * freed. Errors: the machine has no load; an event names neither of its keys; two events at one
 * instant; what vs_build_loaded refuses. */
vs_status vs_loads_make(const vs_events *events, vs_machine *machine, vs_model *model,
                        vs_loads *loads, vs_error *err);
void vs_loads_free(vs_loads *loads);

/* The event that changes the load at that instant; NULL: there is none. */
const vs_occurrence *vs_loads_event(const vs_events *events, double at_s);

/* When the change number k takes place, s; INFINITY: there are not so many. */
double vs_loads_at(const vs_loads *loads, size_t k);

#endif
