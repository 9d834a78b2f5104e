/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/stops.h"

#include <math.h>

/* F = k delta + c delta', which may pull where the armature leaves fast. */
static double linear_force(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  return s->stiffness * depth_m + s->damping_ns_m * depth_rate_m_s;
}
static double linear_rate(const vs_stop *s, double depth_m, double depth_rate_m_s,
                          double depth_rate2_m_s2) {
  (void)depth_m;
  return s->stiffness * depth_rate_m_s + s->damping_ns_m * depth_rate2_m_s2;
}
static void linear_slopes(const vs_stop *s, double depth_m, double depth_rate_m_s,
                          double slope[2]) {
  (void)depth_m, (void)depth_rate_m_s;
  slope[0] = s->stiffness;
  slope[1] = s->damping_ns_m;
}
static double linear_energy(const vs_stop *s, double depth_m) {
  return s->stiffness * depth_m * depth_m / 2;
}
static double linear_loss(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  (void)depth_m;
  return s->damping_ns_m * depth_rate_m_s * depth_rate_m_s;
}
static double linear_steepest(const vs_stop *s) {
  return s->stiffness;
}
static void linear_netlist(const char *const of[4], vs_text *force) {
  vs_text_add(force, "%s*%s+%s*%s", of[0], of[2], of[1], of[3]);
}
static const vs_stop_kind LINEAR = {.name = "linear",
                                    .text = "k delta + c delta', which may pull",
                                    .force = linear_force,
                                    .force_rate = linear_rate,
                                    .slopes = linear_slopes,
                                    .energy = linear_energy,
                                    .loss = linear_loss,
                                    .netlist = linear_netlist,
                                    .steepest = linear_steepest,
                                    .linear = true};

/* F = k delta^2 + clip(c delta', +-k delta^2): it never pulls, and never more than doubles. Its
 * energy is k delta^3/3. (Modelica Standard Library, Magnetic.FluxTubes.Examples.SolenoidActuator;
 * the numbers of a published solenoid have this stop.) */
static double clipped(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  double most = s->stiffness * depth_m * depth_m;
  return fmax(-most, fmin(s->damping_ns_m * depth_rate_m_s, most));
}
static double quadratic_force(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  return s->stiffness * depth_m * depth_m + clipped(s, depth_m, depth_rate_m_s);
}
static double quadratic_rate(const vs_stop *s, double depth_m, double depth_rate_m_s,
                             double depth_rate2_m_s2) {
  double elastic = 2 * s->stiffness * depth_m * depth_rate_m_s;
  double damped = s->damping_ns_m * depth_rate_m_s;
  if (fabs(damped) < s->stiffness * depth_m * depth_m)
    return elastic + s->damping_ns_m * depth_rate2_m_s2;
  return elastic + (damped < 0 ? -elastic : elastic);
}
static void quadratic_slopes(const vs_stop *s, double depth_m, double depth_rate_m_s,
                             double slope[2]) {
  double elastic = 2 * s->stiffness * depth_m, damped = s->damping_ns_m * depth_rate_m_s;
  bool clips = !(fabs(damped) < s->stiffness * depth_m * depth_m);
  slope[0] = elastic + (clips ? copysign(elastic, damped) : 0);
  slope[1] = clips ? 0 : s->damping_ns_m;
}
static double quadratic_energy(const vs_stop *s, double depth_m) {
  return s->stiffness * depth_m * depth_m * depth_m / 3;
}
static double quadratic_loss(const vs_stop *s, double depth_m, double depth_rate_m_s) {
  return clipped(s, depth_m, depth_rate_m_s) * depth_rate_m_s;
}
static double quadratic_steepest(const vs_stop *s) {
  return 4 * s->stiffness * s->deepest_m; /* 2 k delta, and as much of the clipped part */
}
static void quadratic_netlist(const char *const of[4], vs_text *force) {
  const char *k = of[0], *c = of[1], *depth = of[2], *rate = of[3];
  vs_text_add(force, "%s*%s*%s+max(-%s*%s*%s,min(%s*%s,%s*%s*%s))", k, depth, depth, k, depth,
              depth, c, rate, k, depth, depth);
}
static const vs_stop_kind QUADRATIC = {
    .name = "quadratic_clipped",
    .text = "k delta^2 + c delta', the latter clipped to +-k delta^2, so that it never pulls",
    .force = quadratic_force,
    .force_rate = quadratic_rate,
    .slopes = quadratic_slopes,
    .energy = quadratic_energy,
    .loss = quadratic_loss,
    .netlist = quadratic_netlist,
    .steepest = quadratic_steepest};

/* To add a kind of stop: its vs_stop_kind with a row here, its word in VS_STOP_WORDS in the same
 * order, and the unit of its stiffness as a form of STOP (actuator.c). test_laws_on_ideal and
 * test_stop run it; the energy books do not close where force, energy and loss disagree. */
const vs_stop_kind *const vs_stop_kinds[] = {&LINEAR, &QUADRATIC};

double vs_stops_nearness(const vs_stops *stops, double g_m) {
  double nearest = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    double way = s->at_m != 0 ? g_m / s->at_m : 1 + vs_stop_depth(s, g_m) / s->scale_m;
    if (way > nearest) nearest = way;
  }
  return nearest;
}

int vs_stops_closing(const vs_stops *stops) {
  int first = -1;
  for (int k = 0; k < stops->count; k++)
    if (stops->item[k].side > 0 && (first < 0 || stops->item[k].at_m > stops->item[first].at_m))
      first = k;
  return first;
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

/* The force is -side F(depth, depth') with depth = side (at - g): both slopes get side^2. */
void vs_stops_slopes(const vs_stops *stops, unsigned touched, double g_m, double g_rate_m_s,
                     double slope[2]) {
  slope[0] = slope[1] = 0;
  for (int k = 0; k < stops->count; k++) {
    const vs_stop *s = &stops->item[k];
    double own[2];
    if (!(touched >> k & 1)) continue;
    s->kind->slopes(s, vs_stop_depth(s, g_m), -s->side * g_rate_m_s, own);
    slope[0] += own[0];
    slope[1] += own[1];
  }
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
