/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the armature meets. A stop pushes the armature back by how deep this is in it, and by how
 * fast that changes. */
#ifndef VS_ACTUATOR_STOP_H
#define VS_ACTUATOR_STOP_H

#include "base/text.h"

typedef struct vs_stop vs_stop;

/* Each kind is a constant. depth_m > 0 is how deep the armature is in the stop. */
typedef struct vs_stop_kind {
  const char *name, *text;
  /* The force with which the stop pushes the armature back, N. */
  double (*force)(const vs_stop *stop, double depth_m, double depth_rate_m_s);
  /* Its rate, N/s; the second rate is that of depth_rate_m_s, m/s2. */
  double (*force_rate)(const vs_stop *stop, double depth_m, double depth_rate_m_s,
                       double depth_rate2_m_s2);
  double (*energy)(const vs_stop *stop, double depth_m);                      /* stored, J */
  double (*loss)(const vs_stop *stop, double depth_m, double depth_rate_m_s); /* W */
  /* Writes `force` for ngspice, of texts that stand in brackets: the stiffness, the damping, the
   * depth and its rate. */
  void (*netlist)(const char *const of[4], vs_text *force);
} vs_stop_kind;
extern const vs_stop_kind vs_stop_linear;

struct vs_stop {
  const vs_stop_kind *kind;
  int side;         /* +1: it ends the closing of the gap, touched while g < at_m; -1: the opening,
                       touched while g > at_m */
  double at_m;      /* the travel g = c.q at which it is met */
  double stiffness; /* linear: k, N/m; quadratic_clipped: c, N/m2 */
  double damping_ns_m;
};

enum { VS_MOST_STOPS = 4 };
typedef struct vs_stops {
  vs_stop item[VS_MOST_STOPS];
  int count;
} vs_stops;

/* How deep the armature is in the stop, m; negative: it does not touch it. */
static inline double vs_stop_depth(const vs_stop *stop, double g_m) {
  return stop->side * (stop->at_m - g_m);
}

/* The stops that are touched at a travel g, as bits: bit k is item[k]. */
static inline unsigned vs_stops_touched(const vs_stops *stops, double g_m) {
  unsigned touched = 0;
  for (int k = 0; k < stops->count; k++)
    if (vs_stop_depth(&stops->item[k], g_m) > 0) touched |= 1u << k;
  return touched;
}

/* How near the armature is to a stop at a travel g, as a part of the way from rest: 1 and more: it
 * touches one. 0 where there is none. */
double vs_stops_nearness(const vs_stops *stops, double g_m);

/* What the stops of these bits add to the force F that closes the gap, N: negative where they push
 * the gap open. g_rate_m_s is the travel's rate. */
double vs_stops_force(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s);
/* Its rate, N/s. */
double vs_stops_force_rate(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s,
                           double g_rate2_m_s2);
/* The power that they take away, W: what they push back with besides the slope of their energy. */
double vs_stops_loss(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s);
/* What they store, J. */
double vs_stops_energy(const vs_stops *stops, unsigned touched, double g_m);

#endif
