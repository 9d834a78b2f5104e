/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the armature meets. A stop pushes the armature back by how deep this is in it, and by how
 * fast that changes. */
#pragma once

#include <stdbool.h>

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
  /* Its slopes over the depth, N/m, and over the depth's rate, N s/m. */
  void (*slopes)(const vs_stop *stop, double depth_m, double depth_rate_m_s, double slope[2]);
  double (*energy)(const vs_stop *stop, double depth_m);                      /* stored, J */
  double (*loss)(const vs_stop *stop, double depth_m, double depth_rate_m_s); /* W */
  /* Writes `force` for ngspice, of texts that stand in brackets: the stiffness, the damping, the
   * depth and its rate. NULL: the kind cannot be written so, and export refuses it by name. */
  void (*netlist)(const char *const of[4], vs_text *force);
  /* A bound of the force's slope over the depth, N/m, down to stop->deepest_m: for the length of
   * steps. */
  double (*steepest)(const vs_stop *stop);
  bool linear; /* the force is k depth + c depth' exactly, so that polynomials hold */
} vs_stop_kind;

/* The kinds: VS_STOP_WORDS has their names in this order, as the scene's key takes them. */
#define VS_STOP_WORDS "linear|quadratic_clipped"
extern const vs_stop_kind *const vs_stop_kinds[];

struct vs_stop {
  const vs_stop_kind *kind;
  int side;         /* +1: it ends the closing of the gap, touched while g < at_m; -1: the opening,
                       touched while g > at_m */
  double at_m;      /* the travel g = c.q at which it is met */
  double stiffness; /* linear: k, N/m; quadratic_clipped: c, N/m2 */
  double damping_ns_m;
  double scale_m;   /* the way from rest to it, > 0; the gap at rest where it is met at rest */
  double deepest_m; /* how deep it is entered at most: the gap that is left where it is met, as then
                       iron meets iron; the gap at rest for one that ends the opening (assumed) */
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
 * touches one. Of a stop that is met at rest it is 1 there and falls to 0 where the gap is closed.
 * 0 where there is no stop, or all lie the other way. */
double vs_stops_nearness(const vs_stops *stops, double g_m);

/* The stop that a closing gap meets first; -1: there is none. */
int vs_stops_closing(const vs_stops *stops);

/* What the stops of these bits add to the force F that closes the gap, N: negative where they push
 * the gap open. g_rate_m_s is the travel's rate. */
double vs_stops_force(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s);
/* Its rate, N/s. */
double vs_stops_force_rate(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s,
                           double g_rate2_m_s2);
/* The slopes of vs_stops_force over g, N/m, and over g_rate_m_s, N s/m. */
void vs_stops_slopes(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s,
                     double slope[2]);
/* The power that they take away, W: what they push back with besides the slope of their energy. */
double vs_stops_loss(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s);
/* What they store, J. */
double vs_stops_energy(const vs_stops *stops, unsigned touched, double g_m);
