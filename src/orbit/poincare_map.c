/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "poincare_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plant/coil.h"
#include "run/session.h"

static int states_of(const vs_scene *s) {
  const vs_model *m = &s->setup.model;
  return 2 * m->dof + (s->setup.timeline.firing.no_valve || m->coil.eddies ? 1 : 0) + m->coil.rungs;
}

vs_setup vs_poincare_map_setup(const vs_scene *scene, const vs_run_values *run, const double *x) {
  const vs_model *m = &scene->setup.model;
  double start[VS_MOST_STATES] = {0};
  memcpy(start, x, 2 * (size_t)m->dof * sizeof *x);
  vs_setup setup = vs_setup_varied(&scene->setup, run, start);
  setup.timeline.supply.phase_rad = 0;
  setup.timeline.first_zero_s = 0;
  setup.timeline.firing.first_cycle = 1 - setup.timeline.firing.every;
  if (states_of(scene) == 2 * m->dof) return setup;
  const double idle_wb = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, x));
  setup.start.flux_wb = x[2 * m->dof] - idle_wb;
  for (int n = 0; n < m->coil.rungs; n++)
    setup.start.psi_wb[n] = x[2 * m->dof + 1 + n] - m->coil.rung[n].share * idle_wb;
  return setup;
}

void vs_poincare_map_begin(vs_poincare_map *f, const vs_scene *scene) {
  const vs_timeline *line = &scene->setup.timeline;
  *f = (vs_poincare_map){.given = scene, .budget = scene->order.budget, .states = states_of(scene)};
  f->cycle_s = (line->firing.no_valve ? 1 : line->firing.every) * line->period_s;
  f->scene = vs_alloc(1, sizeof *f->scene);
}

/* Forgets the last run. */
static void forget_flight(vs_poincare_map *f) {
  if (f->derives) vs_variation_end(&f->variation);
  free(f->passed);
  free(f->slope);
  f->passed = f->slope = NULL;
  f->derives = false;
}

void vs_poincare_map_end(vs_poincare_map *f) {
  forget_flight(f);
  free(f->scene);
  f->scene = NULL;
}

/* ---- what is seen ---- */

static void take_state(const vs_model *m, const vs_knot *k, double x[VS_VARIATION_MOST]) {
  memcpy(x, k->x, 2 * (size_t)m->dof * sizeof *x);
  x[2 * m->dof] = k->flux_wb;
  memcpy(x + 2 * m->dof + 1, k->psi_wb, sizeof k->psi_wb);
}

/* The state at an instant in the step. */
static void take_at(const vs_step *step, double t_s, double x[VS_VARIATION_MOST]) {
  const vs_model *m = step->frame->model;
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES, y);
  memcpy(x, y + VS_CH_Q, 2 * (size_t)m->dof * sizeof *x);
  x[2 * m->dof] = y[VS_CH_LAMBDA];
  vs_step_psi_at(step, t_s, x + 2 * m->dof + 1);
}

/* Where the travel turns in the step it is least between the knots, at the zero of its rate. */
static void look_deep(vs_poincare_map *f, const vs_step *step) {
  const vs_model *m = step->frame->model;
  double x[VS_VARIATION_MOST], lo = step->from->t_s, hi = step->to->t_s;
  bool turns = vs_mechanics_travel(m, step->from->x + m->dof) < 0 &&
               vs_mechanics_travel(m, step->to->x + m->dof) > 0;
  take_state(m, step->to, x);
  for (int n = 0; n < 50 && turns; n++) {
    double mid = (lo + hi) / 2;
    take_at(step, mid, x);
    if (vs_mechanics_travel(m, x + m->dof) < 0)
      lo = mid;
    else
      hi = mid;
  }
  double g = vs_mechanics_travel(m, x);
  if (isnan(f->beyond_s) && vs_mechanics_closed(m, g)) f->beyond_s = hi;
  if (g >= f->deepest_m) return;
  f->deepest_m = g;
  f->deepest_s = hi;
}

/* Notes where the coil's law does not hold. */
static void look_for_law(vs_poincare_map *f, const vs_knot *k) {
  const vs_coil *c = &f->given->setup.model.coil;
  double z = vs_mechanics_gap(&f->given->setup.model, k->x);
  if (f->left[0] || !c->law->beyond) return;
  if (!c->law->beyond(c, k->flux_wb, z, f->left, sizeof f->left)) f->left[0] = 0;
  f->left_s = k->t_s;
}

vs_status vs_poincare_map_see(vs_poincare_map *f, const vs_step *step, vs_error *err) {
  const vs_model *m = step->frame->model;
  double from = step->from->t_s, to = step->to->t_s, x[VS_VARIATION_MOST];
  take_state(m, step->to, x);
  const int seen = f->given->tier->has_circuit ? 2 * m->dof : f->states;
  for (int j = 0; j < seen; j++) {
    if (!isfinite(x[j]))
      return vs_fail(err, VS_RUN, "t = %.9g s: the state is not a number any more", to);
    f->size[j] = fmax(f->size[j], fabs(x[j]));
  }
  memcpy(f->end, x, (size_t)seen * sizeof *x);
  f->flux_wb = step->open ? 0 : step->to->flux_wb;
  look_deep(f, step);
  look_for_law(f, step->to);
  for (double k = floor(from / f->cycle_s) + 1; f->derives && k * f->cycle_s <= to; k++)
    take_at(step, k * f->cycle_s, f->passed + (size_t)(k - 1) * VS_VARIATION_MOST);
  vs_status status = f->derives ? vs_variation_accept(&f->variation, step, err) : VS_OK;
  return status || !f->also ? status : f->also->accept(f->also->ctx, step, err);
}

static vs_status accept_step_of_flight(void *ctx, const vs_step *step, const vs_result *result,
                                       vs_error *err) {
  (void)result;
  return vs_poincare_map_see(ctx, step, err);
}

/* ---- the run ---- */

typedef struct beginning {
  const vs_run_values *run;
  const double *x;
  bool events; /* the flight has them, and not only the scene that the parameter is made of */
} beginning;

static vs_setup begin_with(const vs_scene *scene, void *ctx) {
  const beginning *at = ctx;
  vs_setup setup = vs_poincare_map_setup(scene, at->run, at->x);
  if (!at->events) setup.timeline.events.count = 0;
  return setup;
}

static void begin_variation(vs_poincare_map *f, const vs_run_values *run, const double *x) {
  const double unmoved[VS_VARIATION_MOST] = {0};
  beginning at = {run, x, f->scene->setup.timeline.events.count > 0};
  vs_variation_begin(&f->variation, &f->scene->setup);
  if (!f->parameter) return;
  vs_parameter_take(f->parameter, begin_with, &at);
  vs_variation_add(&f->variation, f->parameter, unmoved);
}

vs_status vs_poincare_map_anew(vs_poincare_map *f, int periods, vs_error *err) {
  forget_flight(f);
  memset(f->size, 0, sizeof f->size);
  f->deepest_m = INFINITY;
  f->beyond_s = NAN;
  f->left[0] = 0;
  return vs_budget_take(f->budget, f->given->tier->has_circuit,
                        lround(periods * f->cycle_s / f->given->setup.timeline.period_s), err);
}

double vs_poincare_map_slope(vs_poincare_map *f, int i, int j) {
  return f->slope ? f->slope[i * f->states + j] : vs_variation_get(&f->variation, i, j);
}

vs_status vs_poincare_map_go(vs_poincare_map *f, const double *x, int periods, bool derives,
                             vs_error *err) {
  vs_status within = vs_poincare_map_anew(f, periods, err);
  if (within) return within;
  const vs_session_listener guest = {.ctx = f, .accept = accept_step_of_flight};
  const vs_session session = {.guest = &guest, .bare = true, .unguarded = true};
  vs_run_values run = f->given->setup.run;
  run.until_s = periods * f->cycle_s;
  run.tolerance = f->given->tier->finest;
  *f->scene = *f->given;
  f->scene->setup = vs_poincare_map_setup(f->given, &run, x);
  f->scene->frame = vs_sim_frame(f->given->tier, &f->scene->setup);
  f->derives = derives;
  f->passed = derives ? vs_alloc((size_t)periods, sizeof *f->passed * VS_VARIATION_MOST) : NULL;
  if (derives) begin_variation(f, &run, x);
  vs_result *none = vs_alloc(1, sizeof *none);
  vs_status status = vs_session_run(&session, f->scene, none, err);
  free(none);
  return status;
}
