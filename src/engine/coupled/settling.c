/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/settling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static vs_orbit_search *orbit_search_of(const vs_settling *p) {
  return p->order->pilot;
}

static vs_status watch_settling(void *ctx, const vs_step *step, vs_error *err) {
  const vs_settling *p = ctx;
  if (p->order->stop && *p->order->stop)
    return vs_fail(err, VS_SIGNAL, "stopped by a signal on the way to the orbit");
  vs_status status = vs_sim_check(step, err);
  if (!status) orbit_search_of(p)->accept(orbit_search_of(p)->self, step);
  return status;
}

/* An instant, s, that no run comes to. The events of the settling begin there. */
static const double NEVER_S = 1e12;

static vs_setup *calm_of(const vs_setup *setup, const vs_orbit_search *pilot) {
  vs_setup *calm = vs_alloc(1, sizeof *calm);
  *calm = *setup;
  vs_events *events = &calm->timeline.events;
  for (size_t k = 0; k < events->count; k++)
    events->item[k].start_s = events->item[k].end_s = NEVER_S;
  events->count = 0;             /* their sources in the deck still ask for the items */
  calm->timeline.program = NULL; /* a control begins with the run */
  calm->loads = (vs_loads){0};
  calm->model.reloaded = false;
  memcpy(calm->start.x, pilot->x, sizeof calm->start.x);
  return calm;
}

void vs_settling_begin(vs_settling *p, const vs_setup *setup, const vs_run_order *order,
                       const vs_observer *observer) {
  vs_orbit_search *pilot = order->pilot;
  *p = (vs_settling){.order = order, .setup = setup, .observer = observer, .on = pilot != NULL};
  if (!pilot) return;
  pilot->begin(pilot->self, setup);
  p->calm = calm_of(setup, pilot);
  p->watcher = (vs_observer){p, watch_settling};
}

const vs_setup *vs_settling_setup(const vs_settling *p) {
  return p->on ? p->calm : p->setup;
}

const vs_observer *vs_settling_observer(const vs_settling *p) {
  return p->on ? &p->watcher : p->observer;
}

double vs_settling_until(const vs_settling *p) {
  double until_s = p->setup->run.until_s;
  const vs_orbit_search *pilot = orbit_search_of(p);
  return pilot ? (pilot->most + 1) * pilot->period_s + until_s : until_s;
}

double vs_settling_extra_voltage(const vs_settling *p, double t_s) {
  return p->on ? orbit_search_of(p)->push(orbit_search_of(p)->self, t_s) : 0;
}

double vs_settling_edge(vs_settling *p, double now_s, double next_s) {
  const vs_orbit_search *pilot = orbit_search_of(p);
  p->edge_s = next_s;
  if (!pilot) return next_s;
  double parts = floor((now_s + vs_scene_event_rounding(now_s)) / pilot->period_s) + 1;
  return p->edge_s = fmin(next_s, parts * pilot->period_s);
}

double vs_settling_time(const vs_settling *p, double solver_s, double shift_s) {
  double t_s = solver_s + shift_s;
  if (!orbit_search_of(p)) return t_s;
  return fabs(t_s - p->edge_s) <= vs_scene_event_rounding(solver_s) ? p->edge_s : t_s;
}

vs_status vs_settling_follow(vs_settling *p, vs_trajectory *trajectory, double *shift_s,
                             vs_error *err) {
  vs_orbit_search *pilot = orbit_search_of(p);
  bool begins = false;
  if (vs_trajectory_last(trajectory)->t_s < pilot->period_s) return VS_OK;
  vs_status status = pilot->turn(pilot->self, vs_trajectory_last(trajectory), &begins, err);
  p->refused = status == VS_INPUT;
  if (status) return p->refused ? VS_RUN : status; /* what only a search finds is no bad input */
  p->calm->timeline.firing.angle.first = p->setup->timeline.firing.angle.first + pilot->late_rad;
  *shift_s = -(double)++p->parts * pilot->period_s;
  p->on = !begins;
  vs_trajectory_turn(trajectory, pilot->period_s, vs_settling_setup(p), vs_settling_observer(p),
                     pilot->x);
  return VS_OK;
}

vs_status vs_settling_end(vs_settling *p, vs_status status, vs_error *err) {
  if (!orbit_search_of(p)) return status;
  bool gave_up = status && err->gave_up;
  const bool searches = p->on && !p->refused && !orbit_search_of(p)->found;
  if (searches && (status == VS_RUN || status == VS_BUDGET)) {
    const vs_error why = *err;
    vs_fail(err, status, "no periodic orbit is found: in cycle %ld of the search, %s", p->parts + 1,
            why.text);
    err->gave_up = gave_up;
  }
  orbit_search_of(p)->end(orbit_search_of(p)->self);
  free(p->calm);
  return status;
}
