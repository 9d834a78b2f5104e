/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit_flight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "full_newton.h"
#include "orbit/picard.h"
#include "orbit/steady.h"

void vs_circuit_flight_free(vs_circuit_flight *f) {
  free(f->whole);
  free(f->steps.step);
  *f = (vs_circuit_flight){0};
}

/* A run under way: the search for the first orbit, or a flight. */
typedef struct flying {
  vs_circuit_flight *f;
  vs_picard *picard;     /* of the search; NULL: it is a flight */
  vs_poincare_map *seen; /* of the flight, with the next: */
  const double *x;
  int periods;
  bool takes;
  vs_orbit_search pilot;
  vs_circuit_map map;
  const vs_timeline *timeline; /* of the setup that is run */
  int machine;                 /* states of it */
  int passed;                  /* firing periods of the flight; -1: it has not begun */
  bool done;                   /* what was asked is there */
  vs_error why;                /* of an error in a step */
  vs_status status;
} flying;

/* What was asked for is there: the run ends. */
static vs_status end_run(flying *g, vs_error *err) {
  g->done = true;
  return vs_fail(err, VS_SIGNAL, "the flight has ended");
}

/* ---- the first orbit ---- */

static vs_status take_orbit(flying *g, vs_error *err) {
  vs_circuit_flight *f = g->f;
  const vs_circuit_map *map = g->pilot.map;
  const vs_full_newton *newton = vs_picard_newton(g->picard);
  if (!map->states || !newton)
    return vs_fail(err, VS_RUN,
                   "the orbit is not one that Newton's method finds for machine and circuit "
                   "together, so that the circuit's state cannot be set");
  if (newton->parts > VS_FLIGHT_STATES)
    return vs_fail(err, VS_RUN, "machine and circuit have %d states; there is room for %d",
                   newton->parts, (int)VS_FLIGHT_STATES);
  f->states = newton->parts;
  f->all = map->states;
  f->whole = vs_alloc(2 * (size_t)f->all, sizeof *f->whole);
  f->next = f->whole + f->all;
  memcpy(f->next, map->next, (size_t)f->all * sizeof *f->next);
  for (int k = 0; k < f->states; k++) {
    f->of[k] = newton->part[k];
    f->x[k] = map->next[f->of[k]];
    f->size[k] = newton->scale[f->of[k]];
  }
  return end_run(g, err);
}

static vs_status turn_search(flying *g, const vs_knot *end, vs_error *err) {
  bool begins = false;
  vs_status status = g->picard->pilot.turn(g->picard, end, &begins, err);
  memcpy(g->pilot.x, g->picard->pilot.x, sizeof g->pilot.x);
  return status || !begins ? status : take_orbit(g, err);
}

/* ---- a flight ---- */

static vs_status set_out(flying *g, vs_error *err) {
  vs_circuit_flight *f = g->f;
  vs_circuit_map *map = &g->map;
  if (map->states != f->all)
    return vs_fail(err, VS_RUN, "machine and circuit have %d states here, and had %d", map->states,
                   f->all);
  if (g->seen->slope) memcpy(f->whole, f->next, (size_t)f->all * sizeof *f->whole);
  memcpy(map->next, f->whole, (size_t)f->all * sizeof *f->whole);
  for (int k = 0; k < f->states; k++) map->next[f->of[k]] = g->x[k];
  memcpy(g->pilot.x, map->next, (size_t)g->machine * sizeof *map->next);
  map->begins = true;
  map->wants_slope = g->seen->slope != NULL;
  f->steps.are = g->takes ? VS_STEPS_TAKEN : VS_STEPS_NOTED;
  f->steps.next = 0;
  if (!g->takes) f->steps.count = 0;
  g->passed = 0;
  return VS_OK;
}

/* What x has not may make less than this of what it has, in parts of the sizes. As it follows, that
 * slows Newton's iteration down by as little. */
static const double LITTLE = 0.01;

static bool has_state(const vs_circuit_flight *f, int state) {
  for (int k = 0; k < f->states; k++)
    if (f->of[k] == state) return true;
  return false;
}

static bool is_alone(const flying *g) {
  const vs_circuit_flight *f = g->f;
  const double *size = g->map.size;
  for (int j = 0; j < f->all; j++)
    for (int k = 0; k < f->states && !has_state(f, j); k++)
      if (!(fabs(g->map.slope[f->of[k] * f->all + j]) * size[j] < LITTLE * size[f->of[k]]))
        return false;
  return true;
}

/* What x has not is to begin where it comes back to, if it forgets within LASTS periods. */
static const double LASTS = 100;

static void follow_rest(const flying *g) {
  const vs_circuit_map *map = &g->map;
  for (int k = 0; k < g->f->all; k++) {
    const double forgets = 1 - map->slope[k * g->f->all + k];
    if (fabs(forgets) * LASTS > 1)
      g->f->next[k] = map->start[k] + (map->end[k] - map->start[k]) / forgets;
  }
}

static vs_status take_end(flying *g, const vs_knot *end, vs_error *err) {
  const vs_circuit_flight *f = g->f;
  vs_poincare_map *seen = g->seen;
  g->map.tell(g->map.solver);
  memcpy(g->map.end, end->x, (size_t)g->machine * sizeof *g->map.end);
  if (seen->slope && !g->map.knows_slope)
    return vs_fail(err, VS_RUN, "the orbit's derivatives are lost where a device switches");
  for (int k = 0; k < f->states; k++) {
    seen->end[k] = g->map.end[f->of[k]];
    if (k >= g->machine) seen->size[k] = g->map.size[f->of[k]];
    for (int j = 0; j < f->states && seen->slope; j++)
      seen->slope[k * f->states + j] = g->map.slope[f->of[k] * f->all + f->of[j]];
  }
  if (seen->slope) follow_rest(g);
  if (seen->slope && !is_alone(g))
    return vs_fail(err, VS_RUN,
                   "a state of the circuit counts here that did not where the branch begins");
  return end_run(g, err);
}

static vs_status turn_flight(flying *g, const vs_knot *end, vs_error *err) {
  if (g->status) return vs_fail(err, g->status, "%s", g->why.text);
  if (g->passed < 0) return set_out(g, err);
  memcpy(g->pilot.x, end->x, sizeof end->x);
  if (g->seen->passed)
    memcpy(g->seen->passed + (size_t)g->passed * VS_VARIATION_MOST, end->x,
           (size_t)g->machine * sizeof *end->x);
  return ++g->passed < g->periods ? VS_OK : take_end(g, end, err);
}

/* A stop's force jumps where it is met, and the solver's derivatives do not go through that. */
static vs_status see_step(flying *g, const vs_step *step, vs_error *err) {
  const vs_model *m = step->frame->model;
  if (vs_stops_touched(&m->stops, vs_mechanics_travel(m, step->to->x)))
    return vs_fail(err, VS_RUN,
                   "the armature meets a stop, through which an orbit with a circuit has no "
                   "derivative; tier switched goes on");
  return vs_poincare_map_see(g->seen, step, err);
}

/* ---- the pilot ---- */

static void begin_flying(void *self, const vs_setup *setup) {
  flying *g = self;
  g->timeline = &setup->timeline;
  if (!g->picard) return;
  g->picard->pilot.begin(g->picard, setup);
  memcpy(g->pilot.x, g->picard->pilot.x, sizeof g->pilot.x);
}

static void accept_step_flying(void *self, const vs_step *step) {
  flying *g = self;
  if (g->picard)
    g->picard->pilot.accept(g->picard, step);
  else if (g->passed >= 0 && !g->status)
    g->status = see_step(g, step, &g->why);
}

static double push_flying(void *self, double t_s) {
  const flying *g = self;
  if (g->picard) return g->picard->pilot.push(g->picard, t_s);
  return g->passed < 0 ? -vs_timeline_voltage(g->timeline, t_s) : 0;
}

static vs_status turn_flying(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  flying *g = self;
  (void)begins;
  return g->picard ? turn_search(g, end, err) : turn_flight(g, end, err);
}

static void end_flying(void *self) {
  const flying *g = self;
  if (g->picard) g->picard->pilot.end(g->picard);
}

/* Runs the scene from near the machine's states x, until the pilot has what was asked for. */
static vs_status fly(flying *g, const vs_scene *scene, const vs_orbit *from, vs_error *err) {
  const vs_session session = {.bare = true, .unguarded = true, .stop = scene->order.stop};
  vs_scene *own = vs_alloc(1, sizeof *own);
  vs_result *none = vs_alloc(1, sizeof *none);
  vs_error why = {0};
  vs_run_values run = scene->setup.run;
  run.until_s = g->pilot.period_s;
  *own = *scene;
  own->setup = vs_steady_setup(scene, &run, from);
  own->setup.steady = false;
  own->setup.at_work = true;
  own->frame = vs_sim_frame(own->tier, &own->setup);
  own->control.regulator = NULL;
  g->pilot.self = g;
  g->pilot.begin = begin_flying;
  g->pilot.accept = accept_step_flying;
  g->pilot.turn = turn_flying;
  g->pilot.push = push_flying;
  g->pilot.end = end_flying;
  own->order.pilot = &g->pilot;
  own->order.steps = &g->f->steps;
  g->f->steps.are = VS_STEPS_OWN;
  vs_status status = vs_session_run(&session, own, none, &why);
  vs_result_free(none);
  free(none);
  free(own);
  if (g->done) return VS_OK;
  *err = why;
  return status;
}

vs_status vs_circuit_flight_seek(vs_circuit_flight *f, const vs_scene *scene, int periods,
                                 vs_error *err) {
  flying g = {.f = f, .machine = 2 * scene->setup.model.dof};
  vs_status status = vs_picard_new(scene, periods, false, &g.picard, err);
  if (status) return status;
  g.pilot = g.picard->pilot;
  status = fly(&g, scene, &g.picard->orbit, err);
  vs_picard_free(g.picard);
  return status;
}

vs_status vs_circuit_flight_go(vs_circuit_flight *f, vs_poincare_map *seen, const double *x,
                               int periods, bool takes, bool derives, vs_error *err) {
  const size_t n = (size_t)seen->states, rows = (size_t)periods * VS_VARIATION_MOST;
  flying g = {.f = f,
              .seen = seen,
              .x = x,
              .periods = periods,
              .takes = takes,
              .machine = 2 * seen->given->setup.model.dof,
              .passed = -1};
  g.pilot = (vs_orbit_search){.period_s = seen->cycle_s,
                              .of_orbit = periods,
                              .most = periods + 1,
                              .found = true,
                              .map = &g.map};
  vs_orbit from = {0};
  memcpy(from.x, x, (size_t)g.machine * sizeof *x);
  vs_status status = vs_poincare_map_anew(seen, periods + 1, err);
  if (status) return status;
  seen->slope = derives ? vs_alloc(n * n, sizeof *seen->slope) : NULL;
  seen->passed = derives ? vs_alloc(rows, sizeof *seen->passed) : NULL;
  return fly(&g, seen->given, &from, err);
}
