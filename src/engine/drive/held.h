/* SPDX-License-Identifier: GPL-3.0-or-later
 * What stays as it is from one edge to the next, remembered: a circuit's solver asks for it several
 * times a step, while an edge comes once in some hundred steps. */
#ifndef VS_ENGINE_HELD_H
#define VS_ENGINE_HELD_H

#include "drive/signals.h"

/* A number that holds from an instant on, and up to another one. {0} holds at no time. */
typedef struct vs_held {
  double from_s, until_s, number;
} vs_held;

static inline bool vs_held_at(const vs_held *held, double t_s) {
  return t_s >= held->from_s && t_s < held->until_s;
}

/* How near, s, an instant may be to an edge and count as the edge, or as behind it; with room to
 * spare. */
double vs_held_near(const vs_timeline *timeline, double t_s);

/* What vs_signals_voltage returns, V, from memory where the signal changes at edges alone. *held is
 * this signal's own. It is to be set to {0} where events or the timeline have changed. */
double vs_held_voltage(vs_held *held, const vs_timeline *timeline, const vs_signal *signal,
                       double t_s);

#endif
