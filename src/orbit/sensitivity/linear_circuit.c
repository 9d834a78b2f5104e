/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linear_circuit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "full_newton.h"
#include "orbit/picard.h"
#include "run/session.h"

/* What one pass through the period showed. */
typedef struct seen_pass {
  double *end; /* z; owned by the passes */
  double amplitude[VS_LINEAR_OUTPUTS];
} seen_pass;

/* The passes: the orbit's own as number 0, then for each column one with it moved up and one with
 * it moved down. The columns are what the period does not forget of z and, last, the angle. */
typedef struct passes {
  vs_orbit_search pilot; /* in the place of the search's */
  vs_picard *picard;
  vs_circuit_steps steps;
  vs_linear *out;
  vs_linear at; /* whose outputs see the present pass */
  bool on;      /* the orbit is found */
  int now;      /* the pass under way */
  double push;
  int states, firings;
  int *column, columns; /* which state of z each is, the angle's left out; owned */
  double *orbit, *size; /* z on the orbit, and about how large each is; owned, with all ends */
  seen_pass *pass;      /* owned */
} passes;

/* A column is moved by this part of its size, the angle by as many rad. What is not linear makes
 * the square of it, what the iteration behind a jump leaves over 1e-14 divided by it. A smaller one
 * and a part of run.tolerance are tried where a branch or a switch needs other steps. */
static const struct {
  double push, of_tolerance;
} TRIES[] = {{1e-5, 1}, {1e-6, 1}, {1e-5, 0.3}, {1e-6, 0.3}, {1e-5, 0.1}, {1e-6, 0.1}};
enum { N_TRIES = sizeof TRIES / sizeof *TRIES };

/* More than a circuit has. */
enum { MOST_STATES = 1000 };

static int count_passes(const passes *p) {
  return 1 + 2 * (p->columns + 1);
}

/* ---- the matrices ---- */

/* What a column makes of a state, or of an output, by half of the difference. */
static double slope_of(const passes *p, int column, int row, bool output) {
  const seen_pass *up = &p->pass[1 + 2 * column], *down = up + 1;
  const double push = p->push * (column < p->columns ? p->size[p->column[column]] : 1);
  return output ? (up->amplitude[row] - down->amplitude[row]) / (2 * push)
                : (up->end[row] - down->end[row]) / (2 * push);
}

/* A state of the circuit that makes less than this of any other, or is made as little of by all,
 * in parts of the sizes, has been forgotten. Differences tell less. */
static const double FORGOTTEN = 1e-7;

static void find_columns(passes *p) {
  const vs_full_newton *newton = vs_picard_newton(p->picard);
  p->column = vs_alloc((size_t)p->states, sizeof *p->column);
  for (int k = 0; k < p->states; k++)
    if (k < p->out->machine || (newton && vs_full_newton_kept(newton, k) > FORGOTTEN))
      p->column[p->columns++] = k;
}

static bool is_made(const passes *p, int state) {
  double made = fabs(slope_of(p, p->columns, state, false)) / p->size[state];
  for (int k = 0; k < p->columns; k++)
    made = fmax(made, fabs(slope_of(p, k, state, false)) * p->size[p->column[k]] / p->size[state]);
  return made > FORGOTTEN;
}

/* The states in x: fills which columns they are. */
static vs_status choose_states(const passes *p, int of[VS_LINEAR_STATES], vs_error *err) {
  vs_linear *l = p->out;
  const vs_circuit_map *map = p->pilot.map;
  for (int k = 0; k < l->machine; k++) of[k] = k;
  for (int k = l->machine; k < p->columns; k++) {
    if (!is_made(p, p->column[k])) continue;
    if (l->n == VS_LINEAR_STATES)
      return vs_fail(err, VS_RUN, "the circuit remembers more than the %d states there is room for",
                     (int)VS_LINEAR_STATES - l->machine);
    vs_linear_name *name = &l->state[l->n];
    char text[VS_STATE_NAME];
    const char *unit;
    map->name(map->solver, p->column[k], text, &unit);
    snprintf(name->name, sizeof name->name, "%s", text);
    snprintf(name->unit, sizeof name->unit, "%s", unit);
    of[l->n++] = k;
  }
  return VS_OK;
}

static void fill_matrices(const passes *p, const int of[VS_LINEAR_STATES]) {
  vs_linear *l = p->out;
  for (int i = 0; i < l->n; i++) {
    const int state = p->column[of[i]];
    for (int j = 0; j < l->n; j++) l->a[i][j] = slope_of(p, of[j], state, false);
    l->b[i] = slope_of(p, p->columns, state, false);
    l->x[i] = p->orbit[state];
    l->scale[i] = p->size[state];
  }
  for (int i = 0; i < l->outputs; i++) {
    for (int j = 0; j < l->n; j++) l->c[i][j] = slope_of(p, of[j], i, true);
    l->d[i] = slope_of(p, p->columns, i, true);
  }
}

static vs_status fill_model(const passes *p, vs_error *err) {
  int of[VS_LINEAR_STATES];
  vs_status status = choose_states(p, of, err);
  if (!status) fill_matrices(p, of);
  return status;
}

/* ---- the pilot ---- */

static void begin_passes(void *self, const vs_setup *setup) {
  passes *p = self;
  p->picard->pilot.begin(p->picard, setup);
  memcpy(p->pilot.x, p->picard->pilot.x, sizeof p->pilot.x);
}

static void accept_step_of_pass(void *self, const vs_step *step) {
  passes *p = self;
  if (p->on)
    vs_linear_look(&p->at, step, &p->firings);
  else
    p->picard->pilot.accept(p->picard, step);
}

static double push_in_pass(void *self, double t_s) {
  const passes *p = self;
  return p->on ? 0 : p->picard->pilot.push(p->picard, t_s);
}

static void end_passes(void *self) {
  const passes *p = self;
  p->picard->pilot.end(p->picard);
}

/* Sets where the pass under way begins. */
static void set_out(passes *p) {
  vs_circuit_map *map = p->pilot.map;
  const int column = (p->now - 1) / 2;
  const double push = p->now == 0 ? 0 : p->now % 2 ? p->push : -p->push;
  memcpy(map->next, p->orbit, (size_t)p->states * sizeof *p->orbit);
  if (column < p->columns) map->next[p->column[column]] += push * p->size[p->column[column]];
  memcpy(p->pilot.x, map->next, (size_t)p->out->machine * sizeof *p->orbit);
  p->pilot.late_rad = column == p->columns ? push : 0;
  p->steps.are = p->now ? VS_STEPS_TAKEN : VS_STEPS_NOTED;
  p->steps.next = 0;
  p->at = *p->out;
  for (int k = 0; k < p->at.outputs; k++)
    vs_linear_signal_close(&p->at.output[k].seen, p->at.period_s);
  p->at.contacts = p->firings = 0;
  map->begins = true;
  map->wants_slope = false;
}

/* The search has found the orbit, and says where the next period begins. */
static vs_status take_orbit(passes *p, vs_error *err) {
  const vs_circuit_map *map = p->pilot.map;
  if (!map->states || !map->begins)
    return vs_fail(err, VS_RUN,
                   "the orbit is not one that Newton's method finds for machine and circuit "
                   "together, so that the circuit's state cannot be moved");
  const size_t n = (size_t)map->states, count = 1 + 2 * (n + 1);
  p->on = p->pilot.found = true;
  p->states = map->states;
  p->orbit = vs_alloc((2 + count) * n, sizeof *p->orbit);
  p->size = p->orbit + n;
  p->pass = vs_alloc(count, sizeof *p->pass);
  for (size_t k = 0; k < count; k++) p->pass[k].end = p->orbit + (2 + k) * n;
  memcpy(p->orbit, map->next, n * sizeof *p->orbit);
  memcpy(p->size, map->size, n * sizeof *p->size);
  find_columns(p);
  set_out(p);
  return VS_OK;
}

static vs_status end_pass(passes *p, const vs_knot *end, bool *begins, vs_error *err) {
  vs_circuit_map *map = p->pilot.map;
  seen_pass *seen = &p->pass[p->now];
  map->tell(map->solver);
  memcpy(seen->end, map->end, (size_t)p->states * sizeof *seen->end);
  memcpy(seen->end, end->x, (size_t)p->out->machine * sizeof *seen->end);
  for (int k = 0; k < p->out->outputs; k++)
    seen->amplitude[k] = vs_linear_signal_amplitude(&p->at.output[k].seen);
  if (!p->now) *p->out = p->at;
  p->now++;
  *begins = p->now == count_passes(p);
  vs_status status = VS_OK;
  if (*begins) status = fill_model(p, err);
  set_out(p);
  if (*begins) p->steps.are = VS_STEPS_OWN;
  return status;
}

static vs_status turn_passes(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  passes *p = self;
  if (p->on) return end_pass(p, end, begins, err);
  vs_status status = p->picard->pilot.turn(p->picard, end, begins, err);
  memcpy(p->pilot.x, p->picard->pilot.x, sizeof p->pilot.x);
  if (status || !*begins) return status;
  *begins = false;
  return take_orbit(p, err);
}

/* ---- all of it ---- */

static vs_status run_passes(passes *p, const vs_scene *scene, vs_error *err) {
  const vs_session session = {.bare = true, .unguarded = true, .stop = scene->order.stop};
  vs_scene *own = vs_alloc(1, sizeof *own);
  vs_result *none = vs_alloc(1, sizeof *none);
  *own = *scene;
  own->order.pilot = &p->pilot;
  own->order.steps = &p->steps;
  own->control.regulator = NULL;
  vs_status status = vs_session_run(&session, own, none, err);
  p->out->stable = p->picard->multipliers && p->picard->orbit.stable;
  vs_result_free(none);
  free(none);
  free(own);
  return status;
}

/* *found: the orbit was. */
static vs_status find_by_pushes(const vs_scene *scene, double push, vs_linear *l, bool *found,
                                vs_error *err) {
  passes *p = vs_alloc(1, sizeof *p);
  vs_status status = vs_picard_new(scene, 1, true, &p->picard, err);
  if (!status) {
    p->out = l;
    p->push = push;
    p->pilot = p->picard->pilot;
    p->pilot.self = p;
    p->pilot.most += 3 + 2 * MOST_STATES;
    p->pilot.begin = begin_passes;
    p->pilot.accept = accept_step_of_pass;
    p->pilot.turn = turn_passes;
    p->pilot.push = push_in_pass;
    p->pilot.end = end_passes;
    status = run_passes(p, scene, err);
  }
  *found = p->on;
  vs_picard_free(p->picard);
  free(p->steps.step);
  free(p->orbit);
  free(p->column);
  free(p->pass);
  free(p);
  return status;
}

/* A section at the firing would need the circuit's state there. */
static void leave_section_out(vs_linear *l) {
  for (int i = 0; i < l->n; i++) {
    if (i >= l->machine) l->x_firing[i] = NAN;
    l->b_firing[i] = NAN;
    for (int j = 0; j < l->n; j++) l->to_firing[i][j] = l->a_firing[i][j] = NAN;
    for (int k = 0; k < l->outputs; k++) l->c_firing[k][i] = NAN;
  }
}

vs_status vs_linear_circuit_find(const vs_scene *scene, const vs_orbit *orbit, vs_linear *l,
                                 vs_error *err) {
  vs_status status = vs_linear_begin(scene, &scene->setup, orbit, NULL, 0, l, err);
  if (status) return status;
  const vs_linear none = *l;
  vs_error why = {0};
  bool found = true;
  status = VS_RUN;
  vs_scene *own = vs_alloc(1, sizeof *own);
  *own = *scene;
  for (int k = 0; k < N_TRIES && status == VS_RUN && found; k++) {
    why = (vs_error){0};
    *l = none;
    own->setup.run.tolerance =
        fmax(TRIES[k].of_tolerance * scene->setup.run.tolerance, scene->tier->finest);
    status = find_by_pushes(own, TRIES[k].push, l, &found, &why);
  }
  free(own);
  if (status) *err = why;
  leave_section_out(l);
  return status;
}
