/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/pull_in.h"

#include <math.h>
#include <stdio.h>

#include "engine/timeline.h"

/* ---- the drive ---- */

/* The deck's first port pwm; NULL: there is none, and the supply alone drives. */
static const vs_signal *modulated(const vs_frame *frame) {
  for (size_t k = 0; frame->deck && k < frame->deck->n_ports; k++)
    if (frame->deck->ports[k].signal.drive == VS_PORT_PWM) return &frame->deck->ports[k].signal;
  return NULL;
}

static bool is_driven(const vs_frame *frame, double t_s) {
  const vs_signal *pwm = modulated(frame);
  if (vs_timeline_voltage(frame->timeline, t_s) == 0) return false;
  return !pwm || vs_pwm_is_on(&frame->timeline->pwm, (vs_pwm_switch){pwm->shift_rad, false}, t_s);
}

/* A step ends where the drive changes, so that its middle tells what holds from its beginning on.
 */
static void follow_drive(vs_pull_in *p, const vs_step *step) {
  const double from_s = step->from->t_s;
  const bool on = is_driven(step->frame, (from_s + step->to->t_s) / 2);
  if (on && isnan(p->on_s)) p->on_s = from_s;
  if (p->on && !on) {
    p->off_s = from_s;
    p->settled = p->settled || p->still;
  }
  p->on = on;
  p->over = on && !isnan(p->gone_s);
  if (on && p->away && isnan(p->gone_s) && isnan(p->dropped_s)) p->dropped_s = p->left_s;
}

/* ---- the contacts ---- */

static double travel_rate_at(const vs_step *step, double t_s) {
  const vs_model *m = step->frame->model;
  double v[VS_MOST_DOF], sum = 0;
  if (step->to->t_s == step->from->t_s) return vs_mechanics_travel(m, step->to->x + m->dof);
  vs_step_velocities_at(step, t_s, v);
  for (int i = 0; i < m->dof; i++) sum += m->along[i] * v[i];
  return sum;
}

/* True where the event's contact is that of the stop: the one that is nearest then. */
static bool is_at_stop(const vs_pull_in *p, const vs_stops *stops, double g_m) {
  const double own_m = fabs(vs_stop_depth(&stops->item[p->stop], g_m));
  for (int k = 0; k < stops->count; k++)
    if (fabs(vs_stop_depth(&stops->item[k], g_m)) < own_m) return false;
  return true;
}

static void meet(vs_pull_in *p, double t_s, double rate_m_s) {
  const bool bounced = !p->lay && p->dropped_s == p->left_s;
  p->touches = true;
  p->away = p->lay = false;
  p->gone_s = NAN;
  p->last_s = t_s;
  if (bounced) p->dropped_s = NAN;
  if (!p->settled) p->bounced_s = t_s;
  if (isnan(p->met_s)) {
    p->met_s = t_s;
    p->speed_m_s = fabs(rate_m_s);
    return;
  }
  if (!p->settled) p->bounces++;
  p->flight_s = t_s - p->left_s;
}

static void follow_contacts(vs_pull_in *p, const vs_step *step) {
  const vs_model *m = step->frame->model;
  for (int k = 0; k < 2; k++) {
    const double t_s = step->event_s[k];
    const bool meets = step->event[k] == VS_EV_MEETS_STOP;
    if (!meets && step->event[k] != VS_EV_LEAVES_STOP) continue;
    const double *x = t_s < step->to->t_s ? step->from->x : step->to->x;
    if (!is_at_stop(p, &m->stops, vs_mechanics_travel(m, x))) continue;
    if (meets)
      meet(p, t_s, travel_rate_at(step, t_s));
    else
      p->touches = false, p->left_s = t_s;
  }
}

/* The armature lies still where it is slower than this part of its impact, and has been on the stop
 * for longer than it last was away from it, as bounces become shorter, and than half a swing on the
 * stop, as it is slow where it is deepest. */
static const double STILL = 0.01;

static void look_where_it_is(vs_pull_in *p, const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_knot *to = step->to;
  p->now_s = to->t_s;
  p->nearest_m = fmin(p->nearest_m, vs_mechanics_travel(m, to->x));
  p->still = p->touches && to->t_s - p->last_s > fmax(p->flight_s, M_PI / m->contact_rad_s) &&
             fabs(vs_mechanics_travel(m, to->x + m->dof)) < STILL * p->speed_m_s;
  p->lay = p->lay || p->still;
  const double half_m = (m->stops.item[p->stop].at_m + p->from_m) / 2;
  if (p->touches || isnan(p->left_s) || vs_mechanics_travel(m, to->x) < half_m) return;
  p->away = true;
  p->settled = p->settled || p->lay;
  if (p->off_s <= p->left_s) p->gone_s = p->left_s;
}

/* A machine that touches the stop from the beginning on does not pull in. */
static void begin(vs_pull_in *p, const vs_step *step) {
  const vs_model *m = step->frame->model;
  p->began = true;
  p->on_s = p->off_s = p->met_s = p->last_s = p->bounced_s = p->left_s = p->gone_s = p->dropped_s =
      NAN;
  p->stop = vs_stops_closing(&m->stops);
  p->from_m = p->nearest_m = vs_mechanics_travel(m, step->from->x);
  p->idle = !m->pulls_in || vs_stop_depth(&m->stops.item[p->stop], p->from_m) >= 0;
}

void vs_pull_in_accept(vs_pull_in *p, const vs_step *step) {
  if (!p->began) begin(p, step);
  if (p->idle || p->over) return;
  if (step->to->t_s > step->from->t_s) follow_drive(p, step);
  follow_contacts(p, step);
  look_where_it_is(p, step);
}

/* ---- what follows ---- */

static vs_value value_if(bool known, double value, double at_s) {
  return known ? (vs_value){true, value, at_s} : (vs_value){.at_s = NAN};
}

static bool has_met(const vs_pull_in *p) {
  return p->began && !p->idle && !isnan(p->met_s);
}

/* Something else than the drive brought it there, where that was not on yet. */
static bool is_pulled_in(const vs_pull_in *p) {
  return has_met(p) && p->met_s >= p->on_s;
}

bool vs_pull_in_lacks(const vs_pull_in *p, const vs_model *m, char *text, size_t size) {
  if (!p->began || p->idle || is_pulled_in(p)) return false;
  if (has_met(p)) {
    snprintf(text, size,
             "pull_in did not occur: the armature met the stop at %.4g ms already, with nothing "
             "switched on",
             1e3 * p->met_s);
    return true;
  }
  const double way_m = p->from_m - m->stops.item[p->stop].at_m;
  const int most = snprintf(text, size, "pull_in did not occur before %.4g ms: ", 1e3 * p->now_s);
  text += most, size -= (size_t)most;
  if (isnan(p->on_s))
    snprintf(text, size, "nothing was switched on");
  else
    snprintf(text, size, "the armature moved %.3g of %.3g mm", 1e3 * (p->from_m - p->nearest_m),
             1e3 * way_m);
  return true;
}

vs_value vs_pull_in_time(const vs_pull_in *p) {
  return value_if(is_pulled_in(p), p->met_s - p->on_s, p->met_s);
}

vs_value vs_pull_in_release(const vs_pull_in *p) {
  return value_if(has_met(p) && !isnan(p->gone_s), p->gone_s - p->off_s, p->gone_s);
}

bool vs_pull_in_drops(const vs_pull_in *p, char *text, size_t size) {
  if (!p->began || isnan(p->dropped_s)) return false;
  snprintf(text, size,
           "the armature let go of the stop at %.4g ms, while the coil was still driven",
           1e3 * p->dropped_s);
  return true;
}

double vs_pull_in_waits_s(const vs_pull_in *p) {
  return p->began && !p->idle && isnan(p->met_s) ? p->now_s - p->on_s : NAN;
}

double vs_pull_in_sticks_s(const vs_pull_in *p) {
  return p->began && p->touches && !p->on ? p->now_s - p->off_s : NAN;
}

/* The armature lies still at the end, or did when the voltage went off. */
static bool has_bounced_out(const vs_pull_in *p) {
  return has_met(p) && (p->still || p->settled);
}

vs_value vs_pull_in_bounces(const vs_pull_in *p) {
  return value_if(has_bounced_out(p), p->bounces, NAN);
}

vs_value vs_pull_in_bounce_time(const vs_pull_in *p) {
  return value_if(has_bounced_out(p), p->bounced_s - p->met_s, p->bounced_s);
}

vs_value vs_pull_in_speed(const vs_pull_in *p) {
  return value_if(has_met(p), p->speed_m_s, p->met_s);
}
