/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/crossing.h"

#include <math.h>

/* The rounding of lambda's series, relative to what is large. */
static const double NOTHING = 1e-14;

/* Returns an instant in the step at which the armature is in this stop, which it was not: the
 * step's end, or the deepest travel on the way where that turns inside it. NaN: none. */
static double first_contact(const vs_taken *t, const vs_stop *stop) {
  const vs_model *m = t->driven->frame->model;
  const vs_knot *from = t->from, *to = t->to;
  int dof = m->dof, side = stop->side;
  if (vs_stop_depth(stop, vs_mechanics_travel(m, to->x)) > 0) return to->t_s;
  if (side * vs_mechanics_travel(m, from->x + dof) >= 0 ||
      side * vs_mechanics_travel(m, to->x + dof) <= 0)
    return NAN;
  const vs_step step = {.frame = t->driven->frame, .from = from, .to = to};
  double lo = from->t_s, hi = to->t_s, y[VS_CH_MOST];
  for (int n = 0; n < 50; n++) {
    double mid = (lo + hi) / 2;
    vs_step_groups_at(&step, mid, VS_GROUP_VELOCITIES, y);
    if (side * vs_mechanics_travel(m, y + vs_channel_rates(m)) < 0)
      lo = mid;
    else
      hi = mid;
  }
  vs_step_groups_at(&step, hi, 0, y);
  return vs_stop_depth(stop, y[VS_CH_TRAVEL]) > 0 ? hi : NAN;
}

bool vs_crossing_meets(const vs_taken *t) {
  const vs_stops *stops = &t->driven->frame->model->stops;
  for (int k = 0; k < stops->count && !t->driven->held; k++)
    if (!(t->driven->touched >> k & 1) && !isnan(first_contact(t, &stops->item[k]))) return true;
  return false;
}

static double value_of(const vs_taken *t, vs_crossing e, double at_s, double *rate) {
  if (e.kind == VS_FLUX_ENDS) return vs_series_flux(t->series, at_s, rate);
  const vs_stop *stop = &t->driven->frame->model->stops.item[e.stop];
  int sign = e.kind == VS_CONTACT_BEGINS ? stop->side : -stop->side;
  double way = vs_series_travel(t->series, at_s, rate) - stop->at_m;
  *rate *= sign;
  return sign * way;
}

/* Returns when the quantity falls through zero, in seconds from the step's beginning. It does so
 * between `lower` and `upper`. Newton's iteration on the series. */
static double locate(const vs_taken *t, vs_crossing e, double lower, double upper) {
  double nothing = 1e-15 * (e.kind == VS_FLUX_ENDS ? t->driven->flux_wb
                                                   : t->driven->frame->model->actuator.gap_m);
  double at = upper;
  for (int n = 0; n < 60; n++) {
    double rate, value = value_of(t, e, at, &rate);
    if (fabs(value) <= nothing || upper - lower <= 1e-15 * (t->driven->since_s + at)) break;
    if (value > 0)
      lower = at;
    else
      upper = at;
    double next = at - value / rate;
    at = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return at;
}

/* Does a conduction end in the step, and between which two instants, in seconds from its beginning?
 * Undisturbed u > 0 until its next zero, and so lambda > 0 there: the zero of lambda lies behind
 * it. Disturbed, the series itself is asked for its first fall. */
static bool flux_ends(const vs_taken *t, double full_s, double *lower_s, double *upper_s) {
  double turn;
  if (!t->driven->conducting || !t->valve) return false;
  if (t->disturbed)
    return vs_series_flux_falls(t->series, full_s, NOTHING * t->driven->flux_wb, lower_s, upper_s);
  turn = vs_driven_mains_turn(t->driven, false, INFINITY) - t->driven->since_s;
  *lower_s = fmax(turn, 0);
  *upper_s = full_s;
  return t->to->flux_wb <= 0 && full_s >= turn;
}

vs_crossing vs_crossing_find(const vs_taken *t, double *length) {
  double full = *length, lower, upper;
  const vs_knot *from = t->from, *to = t->to;
  const vs_model *m = t->driven->frame->model;
  vs_crossing found = {VS_GOES_ON, 0};
  if (flux_ends(t, full, &lower, &upper)) {
    found.kind = VS_FLUX_ENDS;
    *length = locate(t, found, lower, upper);
  }
  for (int k = 0; k < m->stops.count && !t->driven->held; k++) {
    const vs_stop *stop = &m->stops.item[k];
    bool inside = t->driven->touched >> k & 1;
    bool leaves = inside && !(vs_stop_depth(stop, vs_mechanics_travel(m, to->x)) > 0);
    double contact = inside ? NAN : first_contact(t, stop);
    if (!leaves && isnan(contact)) continue;
    vs_crossing change = {leaves ? VS_CONTACT_ENDS : VS_CONTACT_BEGINS, k};
    double at = locate(t, change, 0, leaves ? full : contact - from->t_s);
    if (found.kind != VS_GOES_ON && *length < at) continue;
    *length = at;
    found = change;
  }
  return found;
}
