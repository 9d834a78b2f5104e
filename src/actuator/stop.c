/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "actuator/stop.h"

/* F = k delta + c delta', which may pull where the armature leaves fast. */
static double linear_force(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  return s->stiffness * depth_m + s->damping_ns_m * depth_rate_m_s;
}
static double linear_rate(const vs_stop *s, double depth_m, double depth_rate_m_s,
                          double depth_rate2_m_s2) {
  (void)depth_m;
  return s->stiffness * depth_rate_m_s + s->damping_ns_m * depth_rate2_m_s2;
}
static double linear_energy(const vs_stop *s, double depth_m) {
  return s->stiffness * depth_m * depth_m / 2;
}
static double linear_loss(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  (void)depth_m;
  return s->damping_ns_m * depth_rate_m_s * depth_rate_m_s;
}
static void linear_netlist(const char *const of[4], vs_text *force) {
  vs_text_add(force, "%s*%s+%s*%s", of[0], of[2], of[1], of[3]);
}
const vs_stop_kind vs_stop_linear = {"linear",      "k delta + c delta'", linear_force,
                                     linear_rate,   linear_energy,        linear_loss,
                                     linear_netlist};

double vs_stops_nearness(const vs_stops *stops, double g_m) {
  double nearest = 0;
  for (int k = 0; k < stops->count; k++) {
    double way = g_m / stops->item[k].at_m;
    if (way > nearest) nearest = way;
  }
  return nearest;
}

double vs_stops_force(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s) {
  double sum = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    if (touched >> k & 1)
      sum -= s->side * s->kind->force(s, vs_stop_depth(s, g_m), -s->side * g_rate_m_s);
  }
  return sum;
}

double vs_stops_force_rate(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s,
                           double g_rate2_m_s2) {
  double sum = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    if (touched >> k & 1)
      sum -= s->side * s->kind->force_rate(s, vs_stop_depth(s, g_m), -s->side * g_rate_m_s,
                                           -s->side * g_rate2_m_s2);
  }
  return sum;
}

double vs_stops_loss(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s) {
  double sum = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    if (touched >> k & 1) sum += s->kind->loss(s, vs_stop_depth(s, g_m), -s->side * g_rate_m_s);
  }
  return sum;
}

double vs_stops_energy(const vs_stops *stops, unsigned touched, double g_m) {
  double sum = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    if (touched >> k & 1) sum += s->kind->energy(s, vs_stop_depth(s, g_m));
  }
  return sum;
}
