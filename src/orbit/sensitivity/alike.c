/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "alike.h"

#include <stdlib.h>
#include <string.h>

/* An orbit is closed in so many periods, to this part of the sizes. The last correction of
 * halfwave_snubbed is some 1e-13. */
enum { CLOSES_IN = 4 };
static const double CLOSED = 1e-9;

static void begin_alike(void *self, const vs_setup *setup) {
  vs_alike *a = self;
  a->on = false;
  a->periods = a->parts = 0;
  a->steps.are = VS_STEPS_OWN;
  a->search.begin(a->picard, setup);
}

static void accept_step_alike(void *self, const vs_step *step) {
  vs_alike *a = self;
  if (!a->on) a->search.accept(a->picard, step);
}

static double push_alike(void *self, double t_s) {
  const vs_alike *a = self;
  return a->on ? 0 : a->search.push(a->picard, t_s);
}

static void end_alike(void *self) {
  const vs_alike *a = self;
  a->search.end(a->picard);
}

/* The next period begins where the map has it. */
static void set_out(vs_alike *a) {
  vs_circuit_map *map = a->picard->pilot.map;
  memcpy(a->picard->pilot.x, map->next, (size_t)a->picard->orbit.count * sizeof *map->next);
  a->steps.are = a->neighbour || a->periods ? VS_STEPS_TAKEN : VS_STEPS_NOTED;
  a->steps.next = 0;
  if (a->steps.are == VS_STEPS_NOTED) a->steps.count = 0;
  map->begins = true;
  map->wants_slope = false;
}

/* The circuit can be put on the scene's orbit, as its search has found it. */
static vs_status begin_periods(vs_alike *a, vs_error *err) {
  vs_circuit_map *map = a->picard->pilot.map;
  if (!a->neighbour) a->newton = vs_picard_newton(a->picard);
  if (!map->states || !a->newton || (a->orbit && a->states != map->states))
    return vs_fail(err, VS_RUN,
                   "the orbit is not one that Newton's method finds for machine and circuit "
                   "together, so that the circuit's state cannot be set");
  a->states = map->states;
  if (!a->orbit) a->orbit = vs_alloc((size_t)a->states, sizeof *a->orbit);
  memcpy(a->neighbour ? map->next : a->orbit, a->neighbour ? a->orbit : map->next,
         (size_t)a->states * sizeof *a->orbit);
  a->on = true;
  set_out(a);
  return VS_OK;
}

static vs_status end_period_alike(vs_alike *a, const vs_knot *end, bool *begins, vs_error *err) {
  vs_circuit_map *map = a->picard->pilot.map;
  double size = 0;
  if (++a->parts < a->picard->orbit.n) {
    memcpy(a->picard->pilot.x, end->x, sizeof end->x);
    return VS_OK;
  }
  a->parts = 0;
  if (!vs_full_newton_close(a->newton, map, a->picard->orbit.count, end->x, &size) ||
      (++a->periods == CLOSES_IN && size > CLOSED))
    return vs_fail(err, VS_RUN, "along these steps the orbit closes to %.2g of the motion alone",
                   size);
  *begins = a->periods == CLOSES_IN;
  a->picard->pilot.found = *begins;
  if (*begins && !a->neighbour) memcpy(a->orbit, map->next, (size_t)a->states * sizeof *a->orbit);
  set_out(a);
  return VS_OK;
}

static vs_status turn_alike(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  vs_alike *a = self;
  vs_status status = VS_OK;
  if (a->on) return end_period_alike(a, end, begins, err);
  if (!a->neighbour) status = a->search.turn(a->picard, end, begins, err);
  if (status || !(*begins || a->neighbour)) return status;
  *begins = false;
  return begin_periods(a, err);
}

void vs_alike_take(vs_alike *a, vs_picard *picard) {
  vs_orbit_search *pilot = &picard->pilot;
  a->neighbour = a->orbit != NULL;
  a->picard = picard;
  a->search = *pilot;
  pilot->self = a;
  pilot->most += (CLOSES_IN + 1) * pilot->of_orbit;
  pilot->begin = begin_alike;
  pilot->accept = accept_step_alike;
  pilot->turn = turn_alike;
  pilot->push = push_alike;
  pilot->end = end_alike;
}

void vs_alike_free(vs_alike *a) {
  free(a->steps.step);
  free(a->orbit);
  *a = (vs_alike){0};
}
