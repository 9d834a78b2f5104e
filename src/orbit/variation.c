/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/variation.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/propagator.h"
#include "parameter_rates.h"
#include "plant/coil.h"

void vs_variation_begin(vs_variation *v, const vs_setup *setup) {
  const vs_model *m = &setup->model;
  bool valve = !setup->timeline.firing.no_valve;
  int rows = 2 * m->dof + 1 + m->coil.rungs, columns = valve && !m->coil.eddies ? rows - 1 : rows;
  size_t size = (size_t)rows * (size_t)columns;
  *v = (vs_variation){.model = m,
                      .valve = valve,
                      .conducting = !valve,
                      .mains_rad_s = setup->timeline.omega_rad_s,
                      .columns = columns,
                      .rows = rows};
  v->touched = vs_stops_touched(&m->stops, vs_mechanics_travel(m, setup->start.x));
  v->s = vs_alloc(size, sizeof *v->s);
  v->stepper = vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size));
  for (int j = 0; j < columns; j++) v->s[j * rows + j] = 1;
}

/* Adds a column that begins with these numbers. */
static void add_variation_column(vs_variation *v, const double *y) {
  size_t rows = (size_t)v->rows, size = rows * (size_t)(v->columns + 1);
  double *s = vs_alloc(size, sizeof *s);
  memcpy(s, v->s, (size - rows) * sizeof *s);
  memcpy(s + size - rows, y, rows * sizeof *s);
  free(v->s);
  gsl_odeiv2_step_free(v->stepper);
  v->s = s;
  v->stepper = vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size));
}

void vs_variation_add(vs_variation *v, vs_parameter *parameter, const double *y) {
  add_variation_column(v, y);
  v->parameter = parameter;
  if (!v->valve) vs_parameter_connects(parameter, 0);
}

void vs_variation_add_delay(vs_variation *v) {
  const double unmoved[VS_VARIATION_MOST] = {0};
  add_variation_column(v, unmoved);
  v->delays = true;
}

void vs_variation_begin_alone(vs_variation *v, const vs_setup *setup, vs_parameter *parameter,
                              const double *y) {
  vs_variation_begin(v, setup);
  v->columns = 0;
  vs_variation_add(v, parameter, y);
}

/* The columns of S and the one behind them. */
static int all_columns(const vs_variation *v) {
  return v->columns + (v->parameter || v->delays ? 1 : 0);
}

void vs_variation_end(vs_variation *v) {
  if (v->stepper) gsl_odeiv2_step_free(v->stepper);
  free(v->s);
  v->stepper = NULL;
  v->s = NULL;
}

/* ---- free: the propagator ---- */

static void swing_freely(vs_variation *v) {
  size_t states = 2 * (size_t)v->model->dof;
  double x[VS_MOST_STATES + VS_ROWS] = {0}, y[VS_MOST_STATES + VS_ROWS];
  vs_propagator p;
  if (!(v->free_s > 0)) return;
  vs_propagator_make(&p, v->model, false, v->free_s);
  p.loaded = false; /* constant forces move all states alike */
  for (int j = 0; j < all_columns(v); j++) {
    memcpy(x, v->s + j * v->rows, states * sizeof *x);
    vs_propagator_step(&p, x, y);
    memcpy(v->s + j * v->rows, y, states * sizeof *y);
  }
  v->free_s = 0;
}

/* ---- driven, or in a stop: the linearised equations ---- */

/* The partial derivatives along the path. With di = i_flux dlambda + i_gap dg and
 * dF = f_flux dlambda + f_gap dg + f_rate dg', the forces of stops among them,
 *   dq" = M^-1 (-K dq - B dq' - c dF),   dlambda' = -R_c di. */
typedef struct partials {
  double i_flux, i_gap, f_flux, f_gap, f_rate;
} partials;

/* Of any law, exactly: its rates where only lambda moves, by 1 Wb/s, and where only z does. */
static void add_law(const vs_frame *frame, const double *channels, partials *d) {
  const vs_coil *c = &frame->model->coil;
  double flux = channels[VS_CH_LAMBDA], z = frame->gap_at_rest ? c->gap_rest_m : channels[VS_CH_Z];
  vs_law_rates by_flux = vs_coil_rates(c, flux, 1, z, 0);
  d->i_flux = by_flux.i_rate_a_s;
  d->f_flux = by_flux.force_rate_n_s;
  if (frame->gap_at_rest) return;
  vs_law_rates by_gap = vs_coil_rates(c, flux, 0, z, 1);
  d->i_gap = by_gap.i_rate_a_s;
  d->f_gap += by_gap.force_rate_n_s;
}

static partials partials_at(const vs_variation *v, const vs_step *step, double t_s) {
  const vs_model *m = v->model;
  double y[VS_CH_MOST], slope[2];
  partials d = {0};
  vs_step_groups_at(step, t_s, v->touched ? VS_GROUP_VELOCITIES : 0, y);
  if (v->conducting || v->fades) add_law(step->frame, y, &d);
  if (!v->touched) return d;
  vs_stops_slopes(&m->stops, v->touched, y[VS_CH_TRAVEL],
                  vs_mechanics_travel(m, y + vs_channel_rates(m)), slope);
  d.f_gap += slope[0];
  d.f_rate = slope[1];
  return d;
}

typedef struct part {
  const vs_variation *variation;
  const vs_step *step;
} part;

/* Adds df/dp to the rates of the parameter's column. */
static void add_parameter_rates(const part *of, double t_s, double *rate) {
  const vs_variation *v = of->variation;
  const vs_model *m = v->model;
  double y[VS_CH_MOST], own[VS_VARIATION_MOST];
  vs_step_groups_at(of->step, t_s, VS_GROUP_VELOCITIES, y);
  const vs_parameter_rates_place place = {.frame = of->step->frame,
                                          .t_s = t_s,
                                          .q = y + VS_CH_Q,
                                          .rate = y + vs_channel_rates(m),
                                          .flux_wb = y[VS_CH_LAMBDA],
                                          .conducting = v->conducting,
                                          .touched = v->touched};
  vs_parameter_rates_find(v->parameter, &place, own);
  for (int i = 0; i < v->rows; i++) rate[i] += own[i];
}

/* What the state's change s makes of the current, without secondaries that have no leakage. */
static double current_change(const vs_variation *v, const partials *d, const double *s) {
  const vs_model *m = v->model;
  return d->i_flux * s[2 * m->dof] + d->i_gap * vs_mechanics_travel(m, s) +
         vs_coil_rungs_current(&m->coil, s[2 * m->dof], s + 2 * m->dof + 1);
}

/* The change of lambda where it follows from that of psi, as nothing flows: i = 0. */
static double faded_change(const vs_variation *v, const partials *d, const double *s) {
  const vs_model *m = v->model;
  if (!v->fades || m->coil.core_s > 0) return s[2 * m->dof];
  return s[2 * m->dof] - current_change(v, d, s) / (d->i_flux + m->coil.leak_1_h);
}

static int variation_equations(double t_s, const double *s, double *rate, void *params) {
  const part *of = params;
  const vs_variation *v = of->variation;
  const vs_model *m = v->model;
  const partials d = partials_at(v, of->step, t_s);
  size_t bytes = (size_t)m->dof * sizeof *s;
  double q[VS_MOST_DOF] = {0}, q1[VS_MOST_DOF] = {0}, q2[VS_MOST_DOF];
  const double r = m->coil.resistance_ohm, core_s = m->coil.core_s;
  for (int j = 0; j < all_columns(v); j++, s += v->rows, rate += v->rows) {
    memcpy(q, s, bytes);
    memcpy(q1, s + m->dof, bytes);
    double flux = faded_change(v, &d, s), g = vs_mechanics_travel(m, q),
           g1 = vs_mechanics_travel(m, q1);
    vs_mechanics_jerks(m, q, q1, d.f_flux * flux + d.f_gap * g + d.f_rate * g1, q2);
    memcpy(rate, q1, bytes);
    memcpy(rate + m->dof, q2, bytes);
    double i = current_change(v, &d, s);
    rate[2 * m->dof] = v->conducting            ? -r * i / (1 + r * core_s)
                       : v->fades && core_s > 0 ? -i / core_s
                                                : 0;
    for (int n = 0; n < m->coil.rungs; n++)
      rate[2 * m->dof + 1 + n] = vs_coil_rung_rate(&m->coil, n, flux, s + 2 * m->dof + 1);
    if (j == v->columns && v->parameter) add_parameter_rates(of, t_s, rate);
  }
  return GSL_SUCCESS;
}

/* The angle that the fastest of the equations turns in one part of a step. With half of it the
 * monodromy of the conveyor changes by less than 1e-13. */
static const double TURN = 0.2;

/* From one instant of the step to another, in equal parts. */
static vs_status integrate_variation(vs_variation *v, const vs_step *step, double from_s,
                                     double to_s, vs_error *err) {
  const vs_model *m = v->model;
  size_t size = (size_t)v->rows * (size_t)all_columns(v);
  part of = {v, step};
  gsl_odeiv2_system system = {variation_equations, NULL, size, &of};
  double error[VS_VARIATION_MOST * (VS_VARIATION_MOST + 1)];
  double fastest = fmax(v->touched ? m->contact_rad_s : m->fastest_rad_s, v->mains_rad_s);
  double i_flux = partials_at(v, step, from_s).i_flux, coil = m->coil.resistance_ohm * i_flux;
  if (m->coil.core_s > 0) coil = fmax(coil, i_flux / m->coil.core_s);
  for (int n = 0; n < m->coil.rungs; n++) coil = fmax(coil, m->coil.rung[n].rate_1_s);
  int parts = (int)fmin(ceil((to_s - from_s) * fmax(fastest, fabs(coil)) / TURN), 1e6);
  for (int k = 0; k < parts; k++) {
    double h = (to_s - from_s) / parts;
    if (gsl_odeiv2_step_apply(v->stepper, from_s + k * h, h, v->s, error, NULL, NULL, &system))
      return vs_fail(err, VS_RUN, "t = %.9g s: the equations have no derivative", from_s);
  }
  const partials d = partials_at(v, step, to_s);
  for (int j = 0; j < all_columns(v) && v->fades; j++) {
    double *s = v->s + j * v->rows;
    s[2 * m->dof] = faded_change(v, &d, s);
  }
  return VS_OK;
}

/* Returns the first instant in the step at which a stop's damping begins or ceases to be felt,
 * which is a kink of its force, as seen from before; *behind_s is the next instant, which lies
 * behind it. Where there is none, both are the step's end. */
static double first_kink(const vs_variation *v, const vs_step *step, double from_s,
                         double *behind_s) {
  enum { LOOKS = 8, HALVINGS = 50 };
  double to_s = step->to->t_s, was = partials_at(v, step, from_s).f_rate, lo = from_s;
  for (int k = 1; k <= LOOKS; k++) {
    double hi = k < LOOKS ? from_s + k * (to_s - from_s) / LOOKS : to_s;
    if (partials_at(v, step, hi).f_rate == was) {
      lo = hi;
      continue;
    }
    for (int n = 0; n < HALVINGS; n++) {
      double mid = (lo + hi) / 2;
      if (partials_at(v, step, mid).f_rate == was)
        lo = mid;
      else
        hi = mid;
    }
    *behind_s = hi;
    return lo;
  }
  return *behind_s = to_s;
}

/* ---- the instants that move ---- */

/* Which stop is met or left at this knot: the one whose surface is nearest among those that the
 * armature is not, or is, in. */
static int stop_at(const vs_variation *v, const vs_knot *k, bool inside) {
  const vs_stops *stops = &v->model->stops;
  double g = vs_mechanics_travel(v->model, k->x), nearest = INFINITY;
  int found = 0;
  for (int n = 0; n < stops->count; n++) {
    double off = fabs(vs_stop_depth(&stops->item[n], g));
    if ((v->touched >> n & 1) != inside || off >= nearest) continue;
    nearest = off;
    found = n;
  }
  return found;
}

/* f of a knot: (q', q", lambda'). */
static void rates_of(const vs_model *m, const vs_knot *k, double f[VS_VARIATION_MOST]) {
  memcpy(f, k->x + m->dof, (size_t)m->dof * sizeof *f);
  memcpy(f + m->dof, k->a, (size_t)m->dof * sizeof *f);
  f[2 * m->dof] = k->flux_rate_v;
  for (int n = 0; n < m->coil.rungs; n++)
    f[2 * m->dof + 1 + n] = vs_coil_rung_rate(&m->coil, n, k->flux_wb, k->psi_wb);
}

/* No flux is left: neither lambda nor psi hangs on the beginning any more. */
static void forget_flux(vs_variation *v) {
  const int dof = v->model->dof;
  for (int j = 0; j < all_columns(v); j++)
    for (int i = 2 * dof; i < v->rows; i++) v->s[j * v->rows + i] = 0;
}

/* The step shows an instant that the state moves from its two sides. */
static vs_status jump_at_instant(vs_variation *v, const vs_step *step, vs_error *err) {
  const vs_model *m = v->model;
  double before[VS_VARIATION_MOST], after[VS_VARIATION_MOST];
  bool flux = v->ending == VS_EV_EXTINCT;
  int stop = flux ? 0 : stop_at(v, step->from, v->ending == VS_EV_LEAVES_STOP);
  rates_of(m, step->from, before);
  rates_of(m, step->to, after);
  double rate = flux ? before[2 * m->dof] : vs_mechanics_travel(m, before), moved_s = 0;
  const bool of_current = flux && m->coil.eddies;
  const partials d = partials_at(v, step, step->from->t_s);
  const double share = 1 + m->coil.resistance_ohm * m->coil.core_s;
  if (of_current) rate = vs_step_coil_rates(step->frame, step->from).i_rate_a_s * share;
  if (flux)
    v->conducting = false;
  else
    v->touched ^= 1u << stop;
  for (int j = 0; j < all_columns(v); j++) {
    double *s = v->s + j * v->rows, way = flux ? s[2 * m->dof] : vs_mechanics_travel(m, s);
    if (of_current) way = current_change(v, &d, s);
    if (j == v->columns && v->parameter && !flux)
      way += vs_parameter_rates_surface(v->parameter, stop, step->from->x);
    for (int i = 0; i < v->rows; i++) s[i] += (after[i] - before[i]) * (way / rate);
    moved_s = -way / rate; /* the last column's stays */
  }
  if (flux && !step->open) forget_flux(v);
  v->ending = VS_EV_NONE;
  v->jump = (vs_jump){.count = v->jump.count + 1, .t_s = step->to->t_s, .moved_s = moved_s};
  return rate != 0
             ? VS_OK
             : vs_fail(err, VS_RUN, "t = %.9g s: %s without a rate: there is no derivative",
                       step->to->t_s, flux ? "the current ends" : "the armature touches its stop");
}

/* The step shows one that the parameter alone moves: a firing, or an edge of an event on the mains.
 * Another, at which the rates do not jump, is none of these. */
static vs_status jump_by_parameter(vs_variation *v, const vs_step *step, bool fires,
                                   vs_error *err) {
  vs_parameter *p = v->parameter;
  double before[VS_VARIATION_MOST], after[VS_VARIATION_MOST], t = step->to->t_s;
  double last = v->jump.t_s, asked = fires ? last : last + (t - last) / 2;
  double *s = v->s + v->columns * v->rows;
  if (!fires && vs_wave_edge(step->frame->timeline, asked) != t) return VS_OK;
  double moved = fires ? vs_parameter_fires(p, asked, t) : vs_parameter_edge(p, asked, t);
  if (isnan(moved))
    return vs_fail(err, VS_RUN, "t = %.9g s: %s where %s is a little else: there is no derivative",
                   t,
                   fires ? "the thyristor fires in another cycle, or on the other side of an event,"
                         : "the mains change elsewhere",
                   p->key.name);
  v->jump = (vs_jump){.count = v->jump.count + 1,
                      .fires = fires,
                      .edge = !fires,
                      .t_s = t,
                      .asked_s = asked,
                      .moved_s = moved};
  rates_of(v->model, step->from, before);
  rates_of(v->model, step->to, after);
  for (int i = 0; i < v->rows; i++) s[i] += (before[i] - after[i]) * moved;
  return VS_OK;
}

/* The thyristor fires, and the delay's column takes what a second of delay makes of the state. */
static void jump_of_delay(vs_variation *v, const vs_step *step) {
  double before[VS_VARIATION_MOST], after[VS_VARIATION_MOST], *s = v->s + v->columns * v->rows;
  rates_of(v->model, step->from, before);
  rates_of(v->model, step->to, after);
  for (int i = 0; i < v->rows; i++) s[i] += before[i] - after[i];
}

/* ---- all of it ---- */

static bool is_free(const vs_variation *v) {
  return !v->conducting && !v->fades && !v->touched && !v->parameter;
}

/* From one instant of the step to another, on one side of every jump. */
static vs_status go_along(vs_variation *v, const vs_step *step, double from, double to,
                          vs_error *err) {
  vs_status status = VS_OK;
  if (is_free(v)) {
    v->free_s += to - from;
    return VS_OK;
  }
  swing_freely(v);
  while (from < to && !status) {
    double behind = to, end = v->touched ? first_kink(v, step, from, &behind) : to;
    status = integrate_variation(v, step, from, fmin(end, to), err);
    from = behind;
  }
  return status;
}

vs_status vs_variation_to(vs_variation *v, const vs_step *step, double t_s, vs_error *err) {
  double from = fmax(step->from->t_s, v->at_s);
  v->fades = step->open;
  if (v->ending != VS_EV_NONE || !(t_s > from)) return VS_OK;
  v->at_s = t_s;
  return go_along(v, step, from, t_s, err);
}

vs_status vs_variation_accept(vs_variation *v, const vs_step *step, vs_error *err) {
  double to = step->to->t_s;
  vs_event event = step->event[0];
  v->fades = step->open;
  bool was_free = is_free(v);
  if (v->parameter && v->model->coil.eddies)
    return vs_fail(err, VS_RUN,
                   "with eddy currents no derivative with respect to a key is taken along the run");
  if (v->model->coil.eddies && !v->conducting && !v->fades && event != VS_EV_FIRES) forget_flux(v);
  if (v->ending != VS_EV_NONE) return jump_at_instant(v, step, err);
  vs_status status = go_along(v, step, fmax(step->from->t_s, v->at_s), to, err);
  if (event == VS_EV_NONE && was_free) return VS_OK;
  swing_freely(v);
  bool edge = v->conducting && step->from->t_s == to && step->frame->timeline->events.count;
  if (event == VS_EV_LOADS && v->parameter)
    return vs_fail(err, VS_RUN,
                   "t = %.9g s: the load changes, through which no derivative is taken", to);
  if (event == VS_EV_LOADS) v->model = step->frame->model; /* q and q' go on, and so does S */
  if (v->parameter && (event == VS_EV_FIRES || edge) && !status)
    status = jump_by_parameter(v, step, event == VS_EV_FIRES, err);
  if (event == VS_EV_FIRES && v->delays) jump_of_delay(v, step);
  if (event == VS_EV_FIRES) v->conducting = true;
  if (event == VS_EV_EXTINCT || event == VS_EV_MEETS_STOP || event == VS_EV_LEAVES_STOP)
    v->ending = event;
  return status;
}

void vs_variation_rates(vs_variation *v, const vs_step *step, double *rate) {
  const part of = {v, step};
  swing_freely(v);
  variation_equations(v->at_s, v->s, rate, (void *)(size_t)&of);
}

double vs_variation_get(vs_variation *v, int i, int j) {
  swing_freely(v);
  return v->s[j * v->rows + i];
}
