/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/course.h"

#include <math.h>
#include <string.h>

#include "plant/coil.h"

/* Sets the polynomial of the flux linkage under which the machine moves on from the last knot, and
 * how the armature stands there. */
static void set_flux(vs_course *c, double f0, double f1, double f2, double f3) {
  const double flux[4] = {f0, f1, f2, f3};
  memcpy(c->motion.flux, flux, sizeof flux);
  c->motion.touched = c->touched;
  c->motion.jammed = c->jammed;
}

/* ---- foretold ---- */

/* The state after h seconds by the mechanics' integration, for where the armature is in its stop or
 * may meet it. lambda goes on with the slope it has, and the slope as it last changed. */
static void integrate(vs_course *c, double h, double x[VS_MOST_STATES]) {
  const vs_knot *k = &c->knots[c->now];
  memcpy(x, k->x, sizeof k->x);
  set_flux(c, k->flux_wb, k->flux_rate_v, k->flux_rate2_v_s / 2, 0);
  for (double at = 0; at < h; c->motion.touched ^= c->motion.changed)
    at = vs_motion_advance(&c->motion, at, h, x); /* a NaN ends this too, and move() will say so */
}

/* The state after h seconds by its Taylor polynomial, with the derivatives up to the third of q. */
static void expand(const vs_course *c, double h, double x[VS_MOST_STATES]) {
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
static void foretell(vs_course *c, double t_s) {
  const vs_knot *k = &c->knots[c->now];
  if (t_s == c->candidate_s) return;
  const vs_model *m = c->frame.model;
  double h = t_s - k->t_s, g0 = vs_mechanics_travel(m, k->x),
         g1 = vs_mechanics_travel(m, k->x + m->dof), g2 = vs_mechanics_travel(m, k->a),
         g3 = vs_mechanics_travel(m, k->j), g = g0 + h * (g1 + h / 2 * (g2 + h / 3 * g3));
  if (h > c->series_s || c->touched || vs_stops_touched(&m->stops, g)) {
    integrate(c, h, c->candidate_x);
    g = vs_mechanics_travel(m, c->candidate_x);
  } else if (c->setup->deck.n_motions)
    expand(c, h, c->candidate_x);
  c->candidate_s = t_s;
  c->candidate_gap_m = vs_coil_gap(&m->coil, g);
}

double vs_course_gap(vs_course *c, double t_s) {
  foretell(c, t_s);
  return c->candidate_gap_m;
}

double vs_course_motion(vs_course *c, int state, double t_s) {
  const vs_model *m = c->frame.model;
  foretell(c, t_s);
  return state < 0 ? vs_mechanics_travel(m, c->candidate_x + m->dof) : c->candidate_x[state];
}

/* What a control decides next is not known, so that with one nothing is remembered. */
double vs_course_edge(vs_course *c, double t_s) {
  if (vs_held_at(&c->edge, t_s)) return c->edge.number;
  double edge_s = vs_setup_edge(c->setup, t_s);
  if (!c->setup->timeline.program)
    c->edge = (vs_held){t_s, edge_s - vs_held_near(&c->setup->timeline, t_s), edge_s};
  return edge_s;
}

/* ---- shown ---- */

static void complete(const vs_course *c, vs_knot *k) {
  if (c->jammed)
    vs_knot_hold(&c->frame, k);
  else
    vs_knot_complete(&c->frame, k, c->touched);
}

vs_status vs_course_show(vs_course *c, const vs_knot *k, vs_event what, vs_error *err) {
  vs_knot *from = &c->knots[c->now], *to = &c->knots[1 - c->now];
  if (c->blank) memcpy(from->terms, k->terms, sizeof k->terms);
  c->blank = false;
  vs_step step = {.frame = &c->frame,
                  .from = from,
                  .to = to,
                  .cubic_flux = true,
                  .periodic = c->without,
                  .held = c->jammed};
  step.event[0] = vs_anode_follow(&c->anode, from, k, &step.event_s[0]);
  if (k != to) vs_knot_copy(&c->frame, k, to);
  step.event[1] = what;
  step.event_s[1] = to->t_s;
  step.bound = c->bound;
  step.strays = c->strays;
  c->now = 1 - c->now;
  return c->observer->accept(c->observer->ctx, &step, err);
}

/* ---- moved ---- */

/* The knot `at_s` seconds behind a, on the way to b, under the present polynomial of the flux. */
static vs_knot between(const vs_course *c, const vs_knot *a, const vs_knot *b, double at_s) {
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
static vs_status show_contact(vs_course *c, vs_knot *cut, vs_error *err) {
  vs_status status = vs_course_show(
      c, cut, c->touched & c->motion.changed ? VS_EV_LEAVES_STOP : VS_EV_MEETS_STOP, err);
  c->touched = c->motion.touched = c->touched ^ c->motion.changed;
  complete(c, cut);
  return status ? status : vs_course_show(c, cut, VS_EV_NONE, err);
}

/* The last knot is the instant at which the armature jams; it is shown from behind that too. */
static vs_status jam(vs_course *c, vs_error *err) {
  vs_knot *k = vs_course_next(c);
  vs_knot_copy(&c->frame, vs_course_last(c), k);
  c->jammed = c->motion.jammed = true;
  vs_mechanics_hold(c->frame.model, k->x + c->frame.model->dof);
  complete(c, k);
  return vs_course_show(c, k, VS_EV_JAMS, err);
}

/* A cubic's error over 0.1 rad of the fastest swing is (0.1)^4/24 = 4e-6 of the amplitude. */
static const double SERIES_RAD = 0.1;

static void take_model(vs_course *c, const vs_model *m) {
  c->frame.model = m;
  c->series_s = SERIES_RAD / vs_motion_fastest(m);
}

/* The load changes at the last knot: q and q' go on as they are, with another M. */
static vs_status change_load(vs_course *c, vs_error *err) {
  vs_knot *k = vs_course_next(c);
  vs_knot_copy(&c->frame, vs_course_last(c), k);
  take_model(c, &c->setup->loads.item[c->loads++].model);
  vs_motion_take(&c->motion, c->frame.model);
  complete(c, k);
  return vs_course_show(c, k, VS_EV_LOADS, err);
}

/* An event's instant counts as reached from here on, s: rounding. */
static const double REACHED_S = 1e-12;

/* What is due at the end of a step, which was shown. */
static vs_status end_step(vs_course *c, vs_error *err) {
  double now_s = vs_course_last(c)->t_s;
  vs_status status = VS_OK;
  if (now_s >= vs_loads_at(&c->setup->loads, c->loads) - REACHED_S) status = change_load(c, err);
  if (status || c->jammed || now_s < c->jams_s - REACHED_S) return status;
  return jam(c, err);
}

/* From `at` seconds behind the last knot, where the armature meets or leaves a stop in the state x,
 * to vs_course_next, or to the next such instant. */
static vs_status move_in_parts(vs_course *c, double at, double x[VS_MOST_STATES], vs_error *err) {
  const vs_knot start = *vs_course_last(c);
  vs_knot end = *vs_course_next(c), cut; /* as the course's own are overwritten */
  double h = end.t_s - start.t_s;
  while (at < h) {
    cut = between(c, &start, &end, at);
    memcpy(cut.x, x, sizeof cut.x);
    complete(c, &cut);
    vs_status status = show_contact(c, &cut, err);
    if (status) return status;
    at = vs_motion_advance(&c->motion, at, h, x);
    if (isnan(at)) return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", end.t_s);
  }
  memcpy(end.x, x, sizeof end.x);
  complete(c, &end);
  return vs_course_show(c, &end, VS_EV_NONE, err);
}

static vs_status move(vs_course *c, vs_error *err) {
  const vs_knot *start = vs_course_last(c);
  vs_knot *end = vs_course_next(c);
  double h = end->t_s - start->t_s;
  memcpy(end->x, start->x, c->motion.size);
  double at = vs_motion_advance(&c->motion, 0, h, end->x);
  if (isnan(at)) return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", end->t_s);
  if (at < h) {
    double x[VS_MOST_STATES];
    memcpy(x, end->x, sizeof x);
    return move_in_parts(c, at, x, err);
  }
  complete(c, end);
  return vs_course_show(c, end, VS_EV_NONE, err);
}

vs_status vs_course_move(vs_course *c, vs_error *err) {
  const vs_knot *from = vs_course_last(c), *to = vs_course_next(c);
  /* lambda is the cubic through both ends' values and slopes */
  double h = to->t_s - from->t_s, slope = (to->flux_wb - from->flux_wb) / h;
  set_flux(c, from->flux_wb, from->flux_rate_v,
           (3 * slope - 2 * from->flux_rate_v - to->flux_rate_v) / h,
           (from->flux_rate_v + to->flux_rate_v - 2 * slope) / (h * h));
  c->candidate_s = -1;
  vs_anode_leave(&c->anode);
  vs_status status = move(c, err);
  if (!status) status = end_step(c, err);
  vs_anode_take(&c->anode);
  return status;
}

/* ---- begun and ended ---- */

void vs_course_begin(vs_course *c, const vs_setup *setup, const vs_frame *frame,
                     const vs_observer *observer) {
  const vs_model *m = &setup->model;
  *c = (vs_course){.setup = setup,
                   .frame = *frame,
                   .observer = observer,
                   .candidate_s = -1,
                   .blank = true,
                   .jams_s = vs_setup_jams(setup)};
  take_model(c, m);
  c->knots[0] = vs_sim_start(setup, &c->frame);
  c->touched = vs_stops_touched(&m->stops, vs_mechanics_travel(m, c->knots[0].x));
  vs_anode_begin(&c->anode, &setup->deck, &setup->timeline);
  vs_motion_begin(&c->motion, m);
}

void vs_course_turn(vs_course *c, double by_s, const vs_setup *setup, const vs_observer *observer,
                    const double *x) {
  vs_knot *k = &c->knots[c->now];
  c->setup = setup;
  c->observer = observer;
  c->frame.timeline = &setup->timeline;
  c->anode.timeline = &setup->timeline;
  take_model(c, &setup->model);
  vs_motion_take(&c->motion, &setup->model);
  c->jams_s = vs_setup_jams(setup);
  vs_anode_wind(&c->anode, by_s);
  c->knots[0].t_s -= by_s;
  c->knots[1].t_s -= by_s;
  memcpy(k->x, x, 2 * (size_t)setup->model.dof * sizeof *x);
  c->touched = vs_stops_touched(&setup->model.stops, vs_mechanics_travel(&setup->model, x));
  c->candidate_s = -1;
  complete(c, k);
}

void vs_course_end(vs_course *c) {
  vs_motion_end(&c->motion);
}
