/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/trajectory.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <string.h>

#include "plant/coil.h"
#include "plant/mechanics.h"

/* ---- the machine over one step of the circuit ----
 *
 * The machine between two of the circuit's knots: Eq. 54 under a flux linkage that is a cubic in
 * time. Where the force follows from that alone and the armature is free, q is a Taylor series;
 * else it is integrated by GSL's rkf45. The instant at which the armature meets or leaves its stop
 * is located. */

static inline void rates_of(const vs_model *model, unsigned touched, bool jammed, double g,
                            double flux_wb, const double *x, double *rate) {
  const double *q = x, *v = x + model->dof;
  double a[VS_MOST_DOF];
  double force = vs_coil_force(&model->coil, flux_wb, vs_coil_gap(&model->coil, g));
  if (touched) force += vs_stops_force(&model->stops, touched, g, vs_mechanics_travel(model, v));
  vs_mechanics_accelerations(model, q, v, force, a);
  if (jammed) vs_mechanics_hold(model, a);
  for (int i = 0; i < model->dof; i++) {
    rate[i] = v[i];
    rate[model->dof + i] = a[i];
  }
}

static int machine_rhs(double s, const double x[], double rate[], void *user) {
  const vs_motion *m = user;
  const double flux = m->flux[0] + s * (m->flux[1] + s * (m->flux[2] + s * m->flux[3]));
  rates_of(m->model, m->touched, m->jammed, vs_mechanics_travel(m->model, x), flux, x, rate);
  return GSL_SUCCESS;
}

/* ---- a free swing as a series ---- */

/* F = lambda^2/(4a) and its first four derivatives, at_s into the flux linkage's polynomial. */
static void force_rates(const vs_motion *m, double at_s, double f[5]) {
  const double *c = m->flux, a4 = 4 * m->model->coil.a_hm;
  double l0 = c[0] + at_s * (c[1] + at_s * (c[2] + at_s * c[3]));
  double l1 = c[1] + at_s * (2 * c[2] + at_s * 3 * c[3]);
  double l2 = 2 * c[2] + at_s * 6 * c[3], l3 = 6 * c[3];
  f[0] = l0 * l0 / a4;
  f[1] = 2 * l0 * l1 / a4;
  f[2] = 2 * (l0 * l2 + l1 * l1) / a4;
  f[3] = (2 * l0 * l3 + 6 * l1 * l2) / a4;
  f[4] = (8 * l1 * l3 + 6 * l2 * l2) / a4;
}

/* The Taylor series of q up to its sixth derivative, which follows from Eq. 54, and of q' as far.
 * Over the longest substep of 0.02 rad the rest is (0.02)^7/7! = 3e-16 of the amplitude of q and
 * (0.02)^6/6! = 9e-14 of that of q'. */
static inline __attribute__((always_inline)) void step_free_swing(const vs_motion *m, double at_s,
                                                                  double h, int dof, double *x) {
  enum { ORDER = 6 };
  const vs_model *model = m->model;
  double d[ORDER + 1][VS_MOST_DOF], f[ORDER - 1];
  force_rates(m, at_s, f);
  memcpy(d[0], x, (size_t)dof * sizeof *x);
  memcpy(d[1], x + dof, (size_t)dof * sizeof *x);
  vs_mechanics_accelerations(model, d[0], d[1], f[0], d[2]);
  for (int n = 1; n + 2 <= ORDER; n++) vs_mechanics_jerks(model, d[n], d[n + 1], f[n], d[n + 2]);
  double h2 = h / 2, h3 = h / 3, h4 = h / 4, h5 = h / 5, h6 = h / 6;
  for (int i = 0; i < dof; i++) {
    x[i] = d[0][i] +
           h * (d[1][i] +
                h2 * (d[2][i] + h3 * (d[3][i] + h4 * (d[4][i] + h5 * (d[5][i] + h6 * d[6][i])))));
    x[dof + i] =
        d[1][i] + h * (d[2][i] + h2 * (d[3][i] + h3 * (d[4][i] + h4 * (d[5][i] + h5 * d[6][i]))));
  }
}

/* ---- substeps ---- */

static bool step_machine(vs_motion *m, double at_s, double h, double *x) {
  double error[VS_MOST_STATES];
  if (m->model->coil.square && !m->touched && !m->jammed) {
    if (m->model->dof == VS_ROWS)
      step_free_swing(m, at_s, h, VS_ROWS, x);
    else
      step_free_swing(m, at_s, h, m->model->dof, x);
    return true;
  }
  return !gsl_odeiv2_step_apply(m->step, at_s, h, x, error, NULL, NULL, &m->system);
}

/* The armature meets or leaves a stop in the substep of h from x. Takes x to that instant, by
 * Newton's iteration on the substep's length, and returns that length. */
static double to_contact(vs_motion *m, const vs_stop *stop, bool leaves, double at_s, double h,
                         double *x) {
  const vs_model *model = m->model;
  double from[VS_MOST_STATES], lower = 0, upper = h, sign = leaves ? 1 : -1;
  memcpy(from, x, m->size);
  for (int n = 0; n < 40; n++) {
    memcpy(x, from, m->size);
    if (!step_machine(m, at_s, h, x)) return NAN;
    double left =
        sign * vs_stop_depth(stop, vs_mechanics_travel(model, x)); /* falls through zero */
    double rate = -sign * stop->side * vs_mechanics_travel(model, x + model->dof);
    if (fabs(left) < 1e-15 * fabs(stop->at_m) || upper - lower < 1e-17) break;
    if (left > 0)
      lower = h;
    else
      upper = h;
    double next = h - left / rate;
    h = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return h;
}

/* Goes to the first of the contacts of these stops in the substep from x, says in m->changed which
 * that is, and returns how far into the substep it is. */
static double to_first_contact(vs_motion *m, unsigned stops, double at_s, double h, double *x) {
  double from[VS_MOST_STATES], there[VS_MOST_STATES], first = INFINITY;
  memcpy(from, x, m->size);
  for (int k = 0; k < m->model->stops.count; k++) {
    if (!(stops >> k & 1)) continue;
    memcpy(there, from, m->size);
    double at = to_contact(m, &m->model->stops.item[k], m->touched >> k & 1, at_s, h, there);
    if (isnan(at)) return NAN;
    if (at >= first) continue;
    first = at;
    m->changed = 1u << k;
    memcpy(x, there, m->size);
  }
  return first;
}

/* Takes x = (q, q') on from `at_s` seconds into the flux linkage's polynomial, to h seconds or to
 * where the armature meets or leaves its stop. Returns how far it has come, s; NaN where GSL cannot
 * step on. */
static double motion_advance(vs_motion *m, double at_s, double h, double *x) {
  const vs_model *model = m->model;
  double longest = m->touched ? m->substep_touching_s : m->substep_s, before[VS_MOST_STATES];
  double n = fmax(ceil((h - at_s) / longest), 1), sub = (h - at_s) / n;
  for (double k = 0; k < n; k++) {
    memcpy(before, x, m->size);
    if (!step_machine(m, at_s + k * sub, sub, x)) return NAN;
    unsigned changed = vs_stops_touched(&model->stops, vs_mechanics_travel(model, x)) ^ m->touched;
    if (!changed) continue;
    memcpy(x, before, m->size);
    return at_s + k * sub + to_first_contact(m, changed, at_s + k * sub, sub, x);
  }
  return h;
}

/* How fast the armature may swing with its stops free, rad/s: the fastest mode, and what the
 * force's slope over the gap makes of it where the flux linkage is held, without a current at
 * first. */
static double motion_fastest(const vs_model *model) {
  const vs_coil *c = &model->coil;
  if (c->square) return model->fastest_rad_s; /* the force hangs on the flux linkage alone */
  double z = c->gap_rest_m, i[3], force[3];
  const double flux[3] = {0}, moving[3] = {z, 1, 0};
  c->law->along(c, flux, moving, i, force); /* the force's rate is then dF/dz */
  return model->fastest_rad_s + sqrt(fabs(force[1] * model->per_newton_m_s2));
}

/* Goes on with another model of as many coordinates, which must outlive the motion. */
static void motion_take(vs_motion *m, const vs_model *model) {
  double fastest = motion_fastest(model);
  m->model = model;
  m->substep_s = 0.02 / fastest;
  m->substep_touching_s = 0.02 / fmax(model->contact_rad_s, fastest);
}

/* The motion must stay where it is made, as its system points to it. The model must outlive it. */
static void motion_begin(vs_motion *m, const vs_model *model) {
  *m = (vs_motion){
      .size = 2 * (size_t)model->dof * sizeof(double),
      .system = {machine_rhs, NULL, 2 * (size_t)model->dof, m},
      .step = vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, 2 * (size_t)model->dof))};
  motion_take(m, model);
}

static void motion_end(vs_motion *m) {
  gsl_odeiv2_step_free(m->step);
}

/* ---- the flux linkage of a step ---- */

/* Sets the polynomial of the flux linkage under which the machine moves on from the last knot, and
 * how the armature stands there. */
static void set_flux_polynomial(vs_trajectory *c, double f0, double f1, double f2, double f3) {
  const double flux[4] = {f0, f1, f2, f3};
  memcpy(c->motion.flux, flux, sizeof flux);
  c->motion.touched = c->touched;
  c->motion.jammed = c->jammed;
}

/* ---- foretold ---- */

/* The state after h seconds by the mechanics' integration, for where the armature is in its stop or
 * may meet it. lambda goes on with the slope it has, and the slope as it last changed. */
static void foretell_by_integration(vs_trajectory *c, double h, double x[VS_MOST_STATES]) {
  const vs_knot *k = &c->knots[c->now];
  memcpy(x, k->x, sizeof k->x);
  set_flux_polynomial(c, k->flux_wb, k->flux_rate_v, k->flux_rate2_v_s / 2, 0);
  for (double at = 0; at < h; c->motion.touched ^= c->motion.changed)
    at = motion_advance(&c->motion, at, h,
                        x); /* a NaN ends this too, and move_machine() will say so */
}

/* The state after h seconds by its Taylor polynomial, with the derivatives up to the third of q. */
static void foretell_by_series(const vs_trajectory *c, double h, double x[VS_MOST_STATES]) {
  const vs_knot *k = &c->knots[c->now];
  int dof = c->frame.model->dof;
  for (int i = 0; i < dof; i++) {
    double v = k->x[dof + i], a = k->a[i], j = k->j[i];
    x[i] = k->x[i] + h * (v + h / 2 * (a + h / 3 * j));
    x[dof + i] = v + h * (a + h / 2 * j);
  }
}

/* The travel follows its Taylor polynomial of third order. The next term is (w h)^4/24 of the
 * amplitude at most, with w of the fastest mode. */
static void foretell_machine(vs_trajectory *c, double t_s) {
  const vs_knot *k = &c->knots[c->now];
  if (t_s == c->candidate_s) return;
  const vs_model *m = c->frame.model;
  double h = t_s - k->t_s, g0 = vs_mechanics_travel(m, k->x),
         g1 = vs_mechanics_travel(m, k->x + m->dof), g2 = vs_mechanics_travel(m, k->a),
         g3 = vs_mechanics_travel(m, k->j), g = g0 + h * (g1 + h / 2 * (g2 + h / 3 * g3));
  if (h > c->series_s || c->touched || vs_stops_touched(&m->stops, g)) {
    foretell_by_integration(c, h, c->candidate_x);
    g = vs_mechanics_travel(m, c->candidate_x);
  } else if (c->setup->deck.n_motions)
    foretell_by_series(c, h, c->candidate_x);
  c->candidate_s = t_s;
  c->candidate_gap_m = vs_coil_gap(&m->coil, g);
}

double vs_trajectory_gap(vs_trajectory *c, double t_s) {
  foretell_machine(c, t_s);
  return c->candidate_gap_m;
}

double vs_trajectory_motion(vs_trajectory *c, int state, double t_s) {
  const vs_model *m = c->frame.model;
  foretell_machine(c, t_s);
  return state < 0 ? vs_mechanics_travel(m, c->candidate_x + m->dof) : c->candidate_x[state];
}

/* What a control decides next is not known, nor when sub-pulses are spared, so that nothing is
 * remembered there. */
double vs_trajectory_edge(vs_trajectory *c, double t_s) {
  if (vs_signals_cache_holds(&c->edge, t_s)) return c->edge.number;
  double edge_s = vs_setup_edge(c->setup, t_s);
  if (!c->setup->timeline.program && !c->setup->timeline.spares)
    c->edge = (vs_signals_cache){t_s, edge_s - vs_signals_near(&c->setup->timeline, t_s), edge_s};
  return edge_s;
}

void vs_trajectory_rates(const vs_trajectory *c, const double *x, double flux_wb, double *rate) {
  const vs_model *m = c->motion.model;
  const double g = vs_mechanics_travel(m, x);
  rates_of(m, vs_stops_touched(&m->stops, g), c->jammed, g, flux_wb, x, rate);
}

/* ---- shown ---- */

static void complete_knot(const vs_trajectory *c, vs_knot *k) {
  if (c->jammed)
    vs_step_hold_knot(&c->frame, k);
  else
    vs_step_complete_knot(&c->frame, k, c->touched);
}

/* Takes the secondaries' flux linkages on, d psi/dt = r (k lambda - psi), along the cubic that
 * lambda is in a step: by the rule of Gauss, or where r h is large by the solution's closed form,
 * of which short steps would leave rounding. */
static void carry_psi(const vs_coil *c, const vs_knot *from, vs_knot *to) {
  static const double AT[] = {0.04691007703066800, 0.23076534494715845, 0.5, 0.76923465505284155,
                              0.95308992296933200},
                      WEIGHT[] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                  0.23931433524968324, 0.11846344252809454};
  const double h = to->t_s - from->t_s, rise = to->flux_wb - from->flux_wb;
  const double f[4] = {from->flux_wb, h * from->flux_rate_v,
                       3 * rise - h * (2 * from->flux_rate_v + to->flux_rate_v),
                       h * (from->flux_rate_v + to->flux_rate_v) - 2 * rise};
  for (int n = 0; n < c->rungs; n++) {
    const vs_rung *r = &c->rung[n];
    const double x = r->rate_1_s * h, left = exp(-x);
    double sum = 0;
    for (int k = 0; k < 5 && x <= 1; k++)
      sum += x * WEIGHT[k] * exp(-x * (1 - AT[k])) *
             (f[0] + AT[k] * (f[1] + AT[k] * (f[2] + AT[k] * f[3])));
    if (x > 1) {
      const double end[4] = {f[0] + f[1] + f[2] + f[3], f[1] + 2 * f[2] + 3 * f[3],
                             2 * f[2] + 6 * f[3], 6 * f[3]},
                   begin[4] = {f[0], f[1], 2 * f[2], 6 * f[3]};
      for (int k = 3; k >= 0; k--) sum = end[k] - left * begin[k] - sum / x;
    }
    to->psi_wb[n] = left * from->psi_wb[n] + r->share * sum;
  }
}

vs_knot *vs_trajectory_part(vs_trajectory *c) {
  const bool ends = c->blank || c->jammed || c->frame.model->stops.count;
  return ends || c->parts == VS_STEP_PARTS ? NULL : &c->part[c->parts];
}

/* The last instant that the thyristors were followed to. */
static const vs_knot *last_part(const vs_trajectory *c) {
  return c->parts ? &c->part[c->parts - 1] : &c->knots[c->now];
}

bool vs_trajectory_pass(vs_trajectory *c) {
  vs_anode_leave(&c->anode);
  c->event = vs_anode_follow(&c->anode, last_part(c), &c->part[c->parts], &c->event_s);
  c->followed = c->event != VS_EV_NONE;
  if (c->followed) return false;
  vs_anode_take(&c->anode);
  c->parts++;
  return true;
}

vs_status vs_trajectory_show(vs_trajectory *c, const vs_knot *k, vs_event what, vs_error *err) {
  vs_knot *from = &c->knots[c->now], *to = &c->knots[1 - c->now];
  vs_step step = {.frame = &c->frame,
                  .from = from,
                  .to = to,
                  .cubic_flux = true,
                  .periodic = c->without,
                  .held = c->jammed};
  step.event[0] =
      c->followed ? c->event : vs_anode_follow(&c->anode, last_part(c), k, &step.event_s[0]);
  if (c->followed) step.event_s[0] = c->event_s;
  step.part = c->part;
  step.parts = c->parts;
  c->parts = 0;
  c->followed = false;
  if (k != to) vs_step_copy_knot(&c->frame, k, to);
  if (c->frame.model->coil.rungs) carry_psi(&c->frame.model->coil, from, to);
  step.event[1] = what;
  step.event_s[1] = to->t_s;
  step.bound = c->bound;
  step.strays = c->strays;
  c->now = 1 - c->now;
  return c->observer->accept(c->observer->ctx, &step, err);
}

/* ---- moved ---- */

/* The knot `at_s` seconds behind a, on the way to b, under the present polynomial of the flux. */
static vs_knot knot_between(const vs_trajectory *c, const vs_knot *a, const vs_knot *b,
                            double at_s) {
  const double *f = c->motion.flux, ratio = at_s / (b->t_s - a->t_s);
  vs_knot k = *b;
  k.t_s = a->t_s + at_s;
  k.flux_wb = f[0] + at_s * (f[1] + at_s * (f[2] + at_s * f[3]));
  k.flux_rate_v = f[1] + at_s * (2 * f[2] + at_s * 3 * f[3]);
  k.v_eva_v = a->v_eva_v + ratio * (b->v_eva_v - a->v_eva_v);
  k.i_mains_a = a->i_mains_a + ratio * (b->i_mains_a - a->i_mains_a);
  for (size_t n = 0; n < c->setup->deck.n_terms; n++)
    k.terms[n] = a->terms[n] + ratio * (b->terms[n] - a->terms[n]);
  return k;
}

/* Shows a knot at which the armature meets or leaves its stop, from both sides. */
static vs_status show_contact(vs_trajectory *c, vs_knot *cut, vs_error *err) {
  vs_status status = vs_trajectory_show(
      c, cut, c->touched & c->motion.changed ? VS_EV_LEAVES_STOP : VS_EV_MEETS_STOP, err);
  c->touched = c->motion.touched = c->touched ^ c->motion.changed;
  complete_knot(c, cut);
  return status ? status : vs_trajectory_show(c, cut, VS_EV_NONE, err);
}

/* The last knot is the instant at which the armature jams; it is shown from behind that too. */
static vs_status jam_armature(vs_trajectory *c, vs_error *err) {
  vs_knot *k = vs_trajectory_next(c);
  vs_step_copy_knot(&c->frame, vs_trajectory_last(c), k);
  c->jammed = c->motion.jammed = true;
  vs_mechanics_hold(c->frame.model, k->x + c->frame.model->dof);
  complete_knot(c, k);
  return vs_trajectory_show(c, k, VS_EV_JAMS, err);
}

/* A cubic's error over 0.1 rad of the fastest swing is (0.1)^4/24 = 4e-6 of the amplitude. */
static const double SERIES_RAD = 0.1;

static void use_model(vs_trajectory *c, const vs_model *m) {
  c->frame.model = m;
  c->series_s = SERIES_RAD / motion_fastest(m);
}

/* The load changes at the last knot: q and q' go on as they are, with another M. */
static vs_status change_load_at_knot(vs_trajectory *c, vs_error *err) {
  vs_knot *k = vs_trajectory_next(c);
  vs_step_copy_knot(&c->frame, vs_trajectory_last(c), k);
  use_model(c, &c->setup->loads.item[c->loads++].model);
  motion_take(&c->motion, c->frame.model);
  complete_knot(c, k);
  return vs_trajectory_show(c, k, VS_EV_LOADS, err);
}

/* An event's instant counts as reached from here on, s: rounding. */
static const double REACHED_S = 1e-12;

/* What is due at the end of a step, which was shown. */
static vs_status end_step(vs_trajectory *c, vs_error *err) {
  double now_s = vs_trajectory_last(c)->t_s;
  vs_status status = VS_OK;
  if (now_s >= vs_setup_load_at(&c->setup->loads, c->loads) - REACHED_S)
    status = change_load_at_knot(c, err);
  if (status || c->jammed || now_s < c->jams_s - REACHED_S) return status;
  return jam_armature(c, err);
}

/* From `at` seconds behind the last knot, where the armature meets or leaves a stop in the state x,
 * to vs_trajectory_next, or to the next such instant. */
static vs_status move_in_parts(vs_trajectory *c, double at, double x[VS_MOST_STATES],
                               vs_error *err) {
  const vs_knot start = *vs_trajectory_last(c);
  vs_knot end = *vs_trajectory_next(c), cut; /* as the trajectory's own are overwritten */
  double h = end.t_s - start.t_s;
  while (at < h) {
    cut = knot_between(c, &start, &end, at);
    memcpy(cut.x, x, sizeof cut.x);
    complete_knot(c, &cut);
    vs_status status = show_contact(c, &cut, err);
    if (status) return status;
    at = motion_advance(&c->motion, at, h, x);
    if (isnan(at)) return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", end.t_s);
  }
  memcpy(end.x, x, sizeof end.x);
  complete_knot(c, &end);
  return vs_trajectory_show(c, &end, VS_EV_NONE, err);
}

static vs_status move_machine(vs_trajectory *c, vs_error *err) {
  const vs_knot *start = vs_trajectory_last(c);
  vs_knot *end = vs_trajectory_next(c);
  double h = end->t_s - start->t_s;
  memcpy(end->x, start->x, c->motion.size);
  double at = motion_advance(&c->motion, 0, h, end->x);
  if (isnan(at)) return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", end->t_s);
  if (at < h) {
    double x[VS_MOST_STATES];
    memcpy(x, end->x, sizeof x);
    return move_in_parts(c, at, x, err);
  }
  complete_knot(c, end);
  return vs_trajectory_show(c, end, VS_EV_NONE, err);
}

vs_status vs_trajectory_move(vs_trajectory *c, vs_error *err) {
  vs_knot *from = &c->knots[c->now];
  const vs_knot *to = vs_trajectory_next(c);
  /* before a stop may cut the step: what is between is drawn from both ends */
  if (c->blank) memcpy(from->terms, to->terms, sizeof from->terms);
  c->blank = false;
  /* lambda is the cubic through both ends' values and slopes */
  double h = to->t_s - from->t_s, slope = (to->flux_wb - from->flux_wb) / h;
  set_flux_polynomial(c, from->flux_wb, from->flux_rate_v,
                      (3 * slope - 2 * from->flux_rate_v - to->flux_rate_v) / h,
                      (from->flux_rate_v + to->flux_rate_v - 2 * slope) / (h * h));
  c->candidate_s = -1;
  if (!c->followed) vs_anode_leave(&c->anode);
  vs_status status = move_machine(c, err);
  if (!status) status = end_step(c, err);
  vs_anode_take(&c->anode);
  return status;
}

/* ---- begun and ended ---- */

void vs_trajectory_begin(vs_trajectory *c, const vs_setup *setup, const vs_frame *frame,
                         const vs_observer *observer) {
  const vs_model *m = &setup->model;
  *c = (vs_trajectory){.setup = setup,
                       .frame = *frame,
                       .observer = observer,
                       .candidate_s = -1,
                       .blank = true,
                       .jams_s = vs_setup_jams(setup)};
  use_model(c, m);
  c->knots[0] = vs_sim_start(setup, &c->frame);
  c->touched = vs_stops_touched(&m->stops, vs_mechanics_travel(m, c->knots[0].x));
  vs_anode_begin(&c->anode, setup);
  motion_begin(&c->motion, m);
}

void vs_trajectory_stand(vs_trajectory *c) {
  const vs_coil *coil = &c->frame.model->coil;
  vs_knot *k = &c->knots[c->now], *next = vs_trajectory_next(c);
  k->flux_wb = next->flux_wb;
  k->flux_rate_v = next->flux_rate_v;
  k->v_eva_v = next->v_eva_v;
  k->i_mains_a = next->i_mains_a;
  next->flux_rate2_v_s = 0;
  for (int n = 0; n < coil->rungs; n++) k->psi_wb[n] = coil->rung[n].share * k->flux_wb;
  complete_knot(c, k);
}

void vs_trajectory_turn(vs_trajectory *c, double by_s, const vs_setup *setup,
                        const vs_observer *observer, const double *x) {
  vs_knot *k = &c->knots[c->now];
  c->setup = setup;
  c->observer = observer;
  c->frame.timeline = &setup->timeline;
  c->anode.timeline = &setup->timeline;
  use_model(c, &setup->model);
  motion_take(&c->motion, &setup->model);
  c->jams_s = vs_setup_jams(setup);
  vs_anode_wind(&c->anode, by_s);
  c->knots[0].t_s -= by_s;
  c->knots[1].t_s -= by_s;
  memcpy(k->x, x, 2 * (size_t)setup->model.dof * sizeof *x);
  c->touched = vs_stops_touched(&setup->model.stops, vs_mechanics_travel(&setup->model, x));
  c->candidate_s = -1;
  complete_knot(c, k);
}

void vs_trajectory_end(vs_trajectory *c) {
  motion_end(&c->motion);
}
