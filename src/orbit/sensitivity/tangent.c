/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/tangent.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "engine/driven.h"
#include "orbit/grazing.h"
#include "orbit/sensitivity_problem.h"
#include "run/session.h"

enum { RUNS = VS_STENCIL_RUNS, ROWS = VS_VARIATION_MOST };

/* An instant of the run, and by how much p moves it. */
typedef struct instant {
  double t_s, moved_s;
} instant;

/* One run along with Y. The first finds the instants, the second how far p may go, the third shows
 * the kin. */
typedef struct pass {
  const vs_sensitivity_problem *subject;
  bool again; /* the other attempt */
  vs_parameter *parameter;
  vs_scene *scene; /* that is run */
  vs_variation variation;
  double start[ROWS]; /* Y at t = 0 */
  instant *instants;  /* the first is t = 0, the last the end; owned */
  size_t count, room;
  size_t now;         /* the last one that was passed */
  double scale[ROWS]; /* the largest magnitude of each state */
  vs_grazing grazing;
  double ratio; /* how large Y is beside the state, at most */
  vs_stencil *fan;
  vs_driven driven[RUNS]; /* what drives each of the neighbours */
  vs_knot knot[RUNS][2];  /* the last one is knot[k][last] */
  int last;
  void (*take)(struct pass *pass, const vs_step *step);
} pass;

static void add_moved_instant(pass *p, double t_s, double moved_s) {
  if (p->count == p->room) {
    p->room = p->room ? 2 * p->room : 64;
    p->instants = vs_resize(p->instants, p->room, sizeof *p->instants);
  }
  p->instants[p->count++] = (instant){t_s, moved_s};
}

/* The rows of y, and of its rates, at a knot. */
static void state_of(const vs_model *m, const vs_knot *k, double y[ROWS], double f[ROWS]) {
  size_t bytes = (size_t)m->dof * sizeof *y;
  memcpy(y, k->x, 2 * bytes);
  y[2 * m->dof] = k->flux_wb;
  memcpy(f, k->x + m->dof, bytes);
  memcpy(f + m->dof, k->a, bytes);
  f[2 * m->dof] = k->flux_rate_v;
}

/* ---- the first: the instants ---- */

static void take_instants(pass *p, const vs_step *step) {
  double y[ROWS], f[ROWS];
  const vs_jump *jump = &p->variation.jump;
  state_of(step->frame->model, step->to, y, f);
  for (int i = 0; i < p->variation.rows; i++) p->scale[i] = fmax(p->scale[i], fabs(y[i]));
  if (jump->count + 1 > (long)p->count) add_moved_instant(p, jump->t_s, jump->moved_s);
}

/* A state smaller than this part of the largest of its kind need not be known as well as that. */
static const double SMALL = 1e-3;

static void find_scales(pass *p) {
  int dof = p->variation.model->dof;
  for (int kind = 0; kind < 2; kind++) {
    double largest = 0;
    for (int i = kind * dof; i < (kind + 1) * dof; i++) largest = fmax(largest, p->scale[i]);
    for (int i = kind * dof; i < (kind + 1) * dof; i++)
      p->scale[i] = fmax(p->scale[i], SMALL * largest);
  }
}

/* ---- the second: how far p may go ---- */

/* By how much p moves an instant between two of those that are known. */
static double moved_at(const pass *p, double t_s) {
  const instant *from = &p->instants[p->now], *to = from + 1;
  if (p->now + 1 >= p->count || !(to->t_s > from->t_s)) return from->moved_s;
  return from->moved_s +
         (to->moved_s - from->moved_s) * ((t_s - from->t_s) / (to->t_s - from->t_s));
}

/* Y where the knot moves along. */
static void follow_derivative(const pass *p, const vs_knot *knot, double moved_s, double y[ROWS],
                              double way[ROWS]) {
  double f[ROWS];
  state_of(p->variation.model, knot, y, f);
  for (int i = 0; i < p->variation.rows; i++)
    way[i] = vs_variation_get((vs_variation *)(size_t)&p->variation, i, 0) + f[i] * moved_s;
}

static void take_sizes(pass *p, const vs_step *step) {
  double y[ROWS], way[ROWS];
  vs_grazing_accept(&p->grazing, &p->variation, step);
  follow_derivative(p, step->to, moved_at(p, step->to->t_s), y, way);
  for (int i = 0; i < p->variation.rows; i++)
    if (p->scale[i] > 0) p->ratio = fmax(p->ratio, fabs(way[i]) / p->scale[i]);
}

/* No stretch of time may shrink or grow by more than the state does, either. */
static void look_at_stretches(pass *p) {
  for (size_t n = 1; n < p->count; n++) {
    const instant *a = &p->instants[n - 1], *b = &p->instants[n];
    if (b->t_s > a->t_s)
      p->ratio = fmax(p->ratio, fabs(b->moved_s - a->moved_s) / (b->t_s - a->t_s));
  }
}

/* What Y itself may be off by, relative to what is large of it. */
static const double UNRESOLVED = 1e-12;

/* The neighbours' p makes this part of the state at most. What a difference of sixth order leaves
 * out is then its sixth power. The least and the largest p: beyond them rounding, or the key's own
 * range, would tell. */
static const double PART = 1e-3, LEAST = 1e-8, LARGEST = 1e-3;

/* ---- the third: the neighbours ---- */

/* By how much a second of the run's time is longer for the k-th of the kin. */
static double stretch_of(const pass *p, int k) {
  const vs_parameter *near = &p->fan->parameter;
  const instant *from = &p->instants[p->now], *to = from + 1;
  bool some = p->now + 1 < p->count && to->t_s > from->t_s;
  double per_s = some ? (to->moved_s - from->moved_s) / (to->t_s - from->t_s) : 0;
  return (1 + near->at[k] * per_s) * near->setup[k].timeline.period_s /
         near->setup->timeline.period_s;
}

/* The knot of the k-th, whose derivatives follow from its state by its own equations. */
static void fill_knot(pass *p, int k, const vs_knot *own, const double y[ROWS],
                      const double way[ROWS]) {
  const vs_variation *v = &p->variation;
  const vs_parameter *near = &p->fan->parameter;
  const vs_setup *setup = &near->setup[k];
  double by = near->at[k], until = p->scene->setup.run.until_s;
  double clock = setup->timeline.period_s / near->setup->timeline.period_s;
  vs_knot *to = &p->knot[k][1 - p->last];
  int states = 2 * v->model->dof;
  *to = (vs_knot){.t_s = own->t_s >= until ? setup->run.until_s
                                           : (own->t_s + by * moved_at(p, own->t_s)) * clock};
  for (int i = 0; i < states; i++) to->x[i] = y[i] + by * way[i];
  to->flux_wb = v->conducting ? y[states] + by * way[states] : 0;
  p->driven[k].conducting = v->conducting;
  p->driven[k].touched = v->touched;
  vs_driven_fill(&p->driven[k], to->t_s - near->origin_s[k], to);
}

/* Where differences of two orders give slopes that are further apart than this part of what they
 * are of, the number has a corner among the kin. */
static const double CORNER = 1e-3;

/* Makes one number of the knots, the order-th derivative of something over time, such that it is
 * linear in p over the run's own time, in which the k-th's runs stretch[k] times as fast. What lies
 * between two knots is then linear in p, too, and no knot differs from those beside it in what is
 * of second order. At a corner, as where some of the neighbours are beyond the end of a table, the
 * numbers stay as they are, so that the measures' own differences tell of it. */
static void straighten(pass *p, size_t offset, int order, const double stretch[RUNS]) {
  const vs_parameter *near = &p->fan->parameter;
  double v[RUNS], coarse = 0;
  for (int k = 0; k < RUNS; k++) {
    const char *knot = (const char *)&p->knot[k][1 - p->last];
    memcpy(&v[k], knot + offset, sizeof *v);
    v[k] *= pow(stretch[k], order);
    coarse += near->coarse[k] * (v[k] - v[0]);
  }
  double slope = vs_parameter_slope(near, v);
  if (fabs(slope - coarse) > CORNER * fmax(fabs(slope), fabs(v[0]))) return;
  for (int k = 1; k < RUNS; k++) {
    double straight = (v[0] + near->at[k] * slope) / pow(stretch[k], order);
    memcpy((char *)&p->knot[k][1 - p->last] + offset, &straight, sizeof straight);
  }
}

static void fill_all(pass *p, const vs_knot *own) {
  const int dof = p->variation.model->dof;
  double y[ROWS], way[ROWS], stretch[RUNS];
  follow_derivative(p, own, moved_at(p, own->t_s), y, way);
  for (int k = 0; k < RUNS; k++) {
    stretch[k] = stretch_of(p, k);
    fill_knot(p, k, own, y, way);
  }
  for (int i = 0; i < dof; i++) {
    size_t at = (size_t)i * sizeof(double);
    straighten(p, offsetof(vs_knot, x) + (size_t)dof * sizeof(double) + at, 1, stretch);
    straighten(p, offsetof(vs_knot, a) + at, 2, stretch);
    straighten(p, offsetof(vs_knot, j) + at, 3, stretch);
  }
  straighten(p, offsetof(vs_knot, flux_rate_v), 1, stretch);
  straighten(p, offsetof(vs_knot, flux_rate2_v_s), 2, stretch);
  straighten(p, offsetof(vs_knot, flux_rate3_v_s2), 3, stretch);
}

static void take_waves(pass *p) {
  for (int k = 0; k < RUNS; k++) p->driven[k].mains = p->fan->parameter.mains[k];
}

static void show_neighbours(pass *p, const vs_step *step) {
  fill_all(p, step->to);
  for (int k = 0; k < RUNS; k++) {
    const vs_knot *to = &p->knot[k][1 - p->last];
    const vs_step own = {.frame = &p->fan->scene[k]->frame,
                         .from = &p->knot[k][p->last],
                         .to = to,
                         .event = {step->event[0]},
                         .event_s = {to->t_s}};
    vs_measured_accept(p->fan->measured[k], &own);
    if (p->subject->shown) p->subject->shown(p->subject->ctx, k, &own);
  }
  p->last = 1 - p->last;
}

static void begin_neighbours(pass *p) {
  const vs_knot own = vs_sim_start(&p->scene->setup, &p->scene->frame);
  for (int k = 0; k < RUNS; k++) p->driven[k] = (vs_driven){.frame = &p->fan->scene[k]->frame};
  if (p->scene->setup.timeline.firing.no_valve) {
    vs_parameter_connects(&p->fan->parameter, 0);
    take_waves(p);
  }
  fill_all(p, &own);
  p->last = 1 - p->last;
}

/* The mains of the neighbours change where those of the run do. */
static void renew_waves(pass *p) {
  const vs_jump *jump = &p->variation.jump;
  if (jump->fires) vs_parameter_fires(&p->fan->parameter, jump->asked_s, jump->t_s);
  if (jump->edge) vs_parameter_edge(&p->fan->parameter, jump->asked_s, jump->t_s);
  if (jump->fires || jump->edge) take_waves(p);
}

/* ---- a run ---- */

static vs_status accept_step_of_pass(void *ctx, const vs_step *step, const vs_result *result,
                                     vs_error *err) {
  pass *p = ctx;
  (void)result;
  long jumps = p->variation.jump.count;
  vs_status status = vs_variation_accept(&p->variation, step, err);
  if (status) return status;
  bool jumped = p->variation.jump.count > jumps;
  if (jumped) p->now++;
  if (jumped && p->fan) renew_waves(p);
  p->take(p, step);
  return VS_OK;
}

static vs_status run_pass(pass *p, void (*take)(pass *, const vs_step *), vs_error *err) {
  vs_result *none = vs_alloc(1, sizeof *none);
  const vs_session_listener guest = {.ctx = p, .accept = accept_step_of_pass};
  const vs_session session = {.guest = &guest, .bare = true, .stop = p->subject->stop};
  p->take = take;
  p->now = 0;
  vs_variation_begin_alone(&p->variation, &p->scene->setup, p->parameter, p->start);
  if (p->fan) begin_neighbours(p);
  vs_status status = vs_session_charge_budget(p->scene, err);
  if (!status) status = vs_session_run(&session, p->scene, none, err);
  vs_variation_end(&p->variation);
  vs_result_free(none);
  free(none);
  return status;
}

/* ---- where it begins ---- */

/* The angle that the fastest mode turns in a step at most. The polynomials of degree seven between
 * the knots of the neighbours leave out some 1e-13 of Y then. */
static const double TURN = 0.2;
/* Where an extreme lies so near to a knot that what is of second order in p decides on which side,
 * the other attempt has its knots elsewhere, and smaller p. */
static const double ELSEWHERE = 0.87, SMALLER = 0.1;

static vs_setup make_setup_of_pass(const vs_scene *scene, void *ctx) {
  const pass *p = ctx;
  vs_setup setup = vs_sensitivity_problem_setup(p->subject, scene, p->subject->scene->tier->finest);
  double most =
      TURN * (p->again ? ELSEWHERE : 1) / setup.model.fastest_rad_s; /* INFINITY: nothing swings */
  if (isfinite(most) && !(setup.run.max_step_s > 0 && setup.run.max_step_s < most))
    setup.run.max_step_s = most;
  else if (p->again)
    setup.run.max_step_s *= ELSEWHERE;
  return setup;
}

static vs_status begin_pass(pass *p, vs_error *err) {
  const vs_scene *s = p->subject->scene;
  vs_status status = p->subject->calm
                         ? vs_sensitivity_problem_start(p->subject, p->parameter, p->start, err)
                         : VS_OK;
  if (status) return status;
  vs_parameter_take(p->parameter, make_setup_of_pass, p);
  if (!p->subject->calm) vs_parameter_start(p->parameter, s->tier, p->start);
  p->scene = vs_alloc(1, sizeof *p->scene);
  *p->scene = *s;
  p->scene->setup = make_setup_of_pass(s, p);
  p->scene->frame = vs_sim_frame(s->tier, &p->scene->setup);
  add_moved_instant(p, 0, 0);
  return VS_OK;
}

/* By how much p moves the end of the run, in the run's own time. Where the key is the period that
 * is -until dT/dp / T, and where it is run.until that is the key itself. */
static double end_moved(const vs_parameter *parameter) {
  const vs_setup *setup = parameter->setup;
  double v[RUNS];
  for (int k = 0; k < RUNS; k++)
    v[k] = setup[k].run.until_s * setup->timeline.period_s / setup[k].timeline.period_s;
  return vs_parameter_slope(parameter, v);
}

/* ---- all of it ---- */

static vs_status look_for_instants(pass *p, vs_error *err) {
  vs_status status = begin_pass(p, err);
  if (!status) status = run_pass(p, take_instants, err);
  if (status) return status;
  add_moved_instant(p, p->scene->setup.run.until_s, end_moved(p->parameter));
  find_scales(p);
  look_at_stretches(p);
  return run_pass(p, take_sizes, err);
}

/* The steps of the key that derivatives of coefficients are tried with: a shorter one where a
 * firing or an event passes another within the longer. Rounding is larger then. */
static const double STEPS[] = {1e-3, 1e-5, 1e-7};
enum { N_STEPS = sizeof STEPS / sizeof *STEPS };

static vs_status show_to_watchers(pass *p, vs_stencil *fan, vs_where where, vs_error *err) {
  double finest = p->subject->scene->tier->finest;
  double longest = fmin(LARGEST, p->parameter->step);
  double step = fmin(fmax(PART / p->ratio, LEAST), longest) * (p->again ? SMALLER : 1);
  vs_status status = vs_stencil_begin(fan, p->subject, p->parameter->key.name, where, step, finest,
                                      p->parameter, err);
  if (status) return status;
  p->fan = fan;
  fan->unresolved = UNRESOLVED * fmax(p->ratio, STEPS[0] / p->parameter->step);
  fan->grazing = p->grazing;
  status = run_pass(p, show_neighbours, err);
  for (int k = 0; k < RUNS && !status; k++) vs_measured_finish(fan->measured[k]);
  if (status) vs_stencil_end(fan);
  return status;
}

static vs_status find_in_passes(vs_stencil *fan, const vs_sensitivity_problem *subject,
                                const vs_asked *key, const vs_parameter *known, bool again,
                                double step, vs_error *err) {
  pass *p = vs_alloc(1, sizeof *p);
  vs_parameter *parameter = vs_alloc(1, sizeof *parameter);
  p->subject = subject;
  p->parameter = parameter;
  p->again = again;
  p->grazing.by = INFINITY;
  vs_status status =
      vs_parameter_begin(parameter, subject->scene, key->name, key->where, step, known, err);
  if (!status) status = look_for_instants(p, err);
  if (!status) status = show_to_watchers(p, fan, key->where, err);
  vs_parameter_end(parameter);
  free(p->instants);
  free(p->scene);
  free(parameter);
  free(p);
  return status;
}

vs_status vs_tangent_find(vs_stencil *fan, const vs_sensitivity_problem *subject,
                          const vs_asked *key, const vs_parameter *known, bool again,
                          vs_error *err) {
  vs_error why = {0};
  vs_status status = VS_RUN;
  for (int k = 0; k < N_STEPS && status == VS_RUN; k++) {
    why = (vs_error){0};
    status = find_in_passes(fan, subject, key, known, again, STEPS[k], &why);
  }
  if (status) *err = why;
  return status;
}
