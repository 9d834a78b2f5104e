/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/prelude.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static vs_pilot *pilot_of(const vs_prelude *p) {
  return p->order->pilot;
}

static vs_status watch_settling(void *ctx, const vs_step *step, vs_error *err) {
  const vs_prelude *p = ctx;
  if (p->order->stop && *p->order->stop)
    return vs_fail(err, VS_SIGNAL, "stopped by a signal on the way to the orbit");
  vs_status status = vs_sim_check(step, err);
  if (!status) pilot_of(p)->accept(pilot_of(p)->self, step);
  return status;
}

/* An instant, s, that no run comes to. The events of the prelude begin there. */
static const double NEVER_S = 1e12;

static vs_setup *calm_of(const vs_setup *setup, const vs_pilot *pilot) {
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

void vs_prelude_begin(vs_prelude *p, const vs_setup *setup, const vs_run_order *order,
                      const vs_observer *observer) {
  vs_pilot *pilot = order->pilot;
  *p = (vs_prelude){.order = order, .setup = setup, .observer = observer, .on = pilot != NULL};
  if (!pilot) return;
  pilot->begin(pilot->self, setup);
  p->calm = calm_of(setup, pilot);
  p->watcher = (vs_observer){p, watch_settling};
}

const vs_setup *vs_prelude_setup(const vs_prelude *p) {
  return p->on ? p->calm : p->setup;
}

const vs_observer *vs_prelude_observer(const vs_prelude *p) {
  return p->on ? &p->watcher : p->observer;
}

double vs_prelude_until(const vs_prelude *p) {
  double until_s = p->setup->run.until_s;
  const vs_pilot *pilot = pilot_of(p);
  return pilot ? (pilot->most + 1) * pilot->period_s + until_s : until_s;
}

double vs_prelude_push(const vs_prelude *p, double t_s) {
  return p->on ? pilot_of(p)->push(pilot_of(p)->self, t_s) : 0;
}

double vs_prelude_edge(vs_prelude *p, double now_s, double next_s) {
  const vs_pilot *pilot = pilot_of(p);
  p->edge_s = next_s;
  if (!pilot) return next_s;
  double parts = floor((now_s + vs_occurrence_rounding(now_s)) / pilot->period_s) + 1;
  return p->edge_s = fmin(next_s, parts * pilot->period_s);
}

double vs_prelude_time(const vs_prelude *p, double solver_s, double shift_s) {
  double t_s = solver_s + shift_s;
  if (!pilot_of(p)) return t_s;
  return fabs(t_s - p->edge_s) <= vs_occurrence_rounding(solver_s) ? p->edge_s : t_s;
}

vs_status vs_prelude_follow(vs_prelude *p, vs_trajectory *trajectory, double *shift_s,
                            vs_error *err) {
  vs_pilot *pilot = pilot_of(p);
  bool begins = false;
  if (vs_trajectory_last(trajectory)->t_s < pilot->period_s) return VS_OK;
  vs_status status = pilot->turn(pilot->self, vs_trajectory_last(trajectory), &begins, err);
  p->refused = status == VS_INPUT;
  if (status) return p->refused ? VS_RUN : status; /* what only a search finds is no bad input */
  *shift_s = -(double)++p->parts * pilot->period_s;
  p->on = !begins;
  vs_trajectory_turn(trajectory, pilot->period_s, vs_prelude_setup(p), vs_prelude_observer(p),
                     pilot->x);
  return VS_OK;
}

vs_status vs_prelude_end(vs_prelude *p, vs_status status, vs_error *err) {
  if (!pilot_of(p)) return status;
  bool gave_up = status && err->gave_up;
  if (p->on && (status == VS_RUN || status == VS_BUDGET) && !p->refused) {
    const vs_error why = *err;
    vs_fail(err, status, "no periodic orbit is found: in cycle %ld of the search, %s", p->parts + 1,
            why.text);
    err->gave_up = gave_up;
  }
  pilot_of(p)->end(pilot_of(p)->self);
  free(p->calm);
  return status;
}
