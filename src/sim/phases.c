/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/phases.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <string.h>

#include "machine/actuator.h"

enum { FLUX = VS_STATES, CONDUCTING_STATES }; /* y = (q, q', lambda) */

typedef struct phases {
  const vs_setup *setup;
  vs_conduction conduction;
  const vs_observer *observer;
  vs_knot knots[2]; /* the last accepted one is knots[now] */
  int now;
  bool conducting, touching;            /* the thyristor; the armature its stop */
  double since_s;                       /* local time of the last knot */
  double longest_s, longest_touching_s; /* step, for the dense output's sake: free, in the stop */
  double longest_driven_s;              /* and conducting */
  double propagator_column[VS_STATES][VS_STATES]; /* exp(A h); [j][i] is row i, column j */
  double propagated_s;                            /* its h; 0: none yet */
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
  gsl_odeiv2_control *control;
  gsl_odeiv2_evolve *evolve;
} phases;

/* The quintic polynomial between knots is off by (w h)^6/46080 at most; a fiftieth of the tolerance
 * is left to it. At most 0.3 rad, and half of that while the thyristor conducts: with that the
 * books of energy, which the watcher integrates on the dense output, close to 1e-9 of the work. */
static double longest_step(const vs_setup *s, double fastest_rad_s) {
  double fastest = fmax(fastest_rad_s, 2 * s->timeline.omega_rad_s);
  double h = fmin(0.3, pow(46080 * 0.02 * s->run.tolerance, 1.0 / 6)) / fastest;
  if (s->run.max_step_s > 0) h = fmin(h, s->run.max_step_s);
  return fmin(h, s->run.until_s / 4);
}

static vs_status show(phases *p, vs_event event, vs_error *err) {
  const vs_knot *to = &p->knots[1 - p->now];
  vs_step step = {.frame = p->conduction.frame,
                  .from = &p->knots[p->now],
                  .to = to,
                  .event = {event},
                  .event_s = {to->t_s}};
  p->now = 1 - p->now;
  return p->observer->accept(p->observer->ctx, &step, err);
}

/* Fills the knot to come, `since_s` of local time on, from y. */
static void fill(phases *p, double since_s, const double y[CONDUCTING_STATES]) {
  const vs_conduction *c = &p->conduction;
  vs_knot *k = &p->knots[1 - p->now];
  k->t_s = c->fired_s + since_s;
  memcpy(k->x, y, sizeof k->x);
  k->flux_wb = y[FLUX];
  k->flux_rate_v = k->flux_rate2_v_s = 0;
  if (p->conducting)
    k->flux_rate_v = c->flux_rate(c, since_s, k->flux_wb, k->x, &k->flux_rate2_v_s);
  vs_knot_complete(c->frame, k, p->touching);
}

/* Something changed at the last knot: it is shown from its other side too, as a step of no length.
 * Local time begins anew unless a conduction goes on. */
static vs_status turn_over(phases *p, bool conducting, bool touching, vs_event event,
                           vs_error *err) {
  double y[CONDUCTING_STATES];
  const vs_knot *k = &p->knots[p->now];
  memcpy(y, k->x, sizeof k->x);
  y[FLUX] = conducting ? k->flux_wb : 0;
  if (!p->conducting || !conducting) {
    p->conduction.fired_s = k->t_s;
    p->since_s = 0;
    p->conduction.fired_phase_rad = remainder(vs_phase(&p->setup->timeline, k->t_s), 2 * M_PI);
  }
  p->conducting = conducting;
  p->touching = touching;
  fill(p, p->since_s, y);
  return show(p, event, err);
}

/* First sign in the step to the knot to come that p goes through -D: its end, or the least p on the
 * way where p turns inside it; NaN: none. */
static double first_contact(const phases *p) {
  const vs_model *m = &p->setup->model;
  const vs_knot *from = &p->knots[p->now], *to = &p->knots[1 - p->now];
  if (!m->actuator.stop.present || p->touching) return NAN;
  if (to->x[P] < -m->actuator.gap_m) return to->t_s;
  if (from->x[VS_DOF + P] >= 0 || to->x[VS_DOF + P] <= 0) return NAN;
  const vs_step step = {.frame = p->conduction.frame, .from = from, .to = to};
  double lo = from->t_s, hi = to->t_s;
  for (int n = 0; n < 50; n++) {
    double mid = (lo + hi) / 2;
    if (vs_step_channel(&step, mid, VS_CH_VP) < 0)
      lo = mid;
    else
      hi = mid;
  }
  return vs_in_stop(m, vs_step_channel(&step, hi, VS_CH_P)) ? hi : NAN;
}

/* ---- off: lambda = 0, x' = A x, solved exactly ---- */

/* exp(A h) for x = (q, q'), A = [0 I; -M^-1 K  -M^-1 B]. Taken of (w q, q') with the fastest mode's
 * w, whose matrix is of one order of magnitude throughout: GSL's result is then right to 2e-15 to
 * 5e-15, for 2e-14 to 1e-12 without (h from 50 us to 0.8 ms, Table 1). */
static void make_propagator(phases *p, double h_s) {
  if (h_s == p->propagated_s) return;
  const vs_model *m = &p->setup->model;
  double w = m->fastest_rad_s;
  gsl_matrix *a = gsl_matrix_calloc(VS_STATES, VS_STATES);
  for (size_t i = 0; i < VS_DOF; i++) {
    gsl_matrix_set(a, i, VS_DOF + i, h_s * w);
    for (size_t j = 0; j < VS_DOF; j++) {
      gsl_matrix_set(a, VS_DOF + i, j, -h_s * m->mk_column[j][i] / w);
      gsl_matrix_set(a, VS_DOF + i, VS_DOF + j, -h_s * m->mb_column[j][i]);
    }
  }
  gsl_matrix_view e = gsl_matrix_view_array(&p->propagator_column[0][0], VS_STATES, VS_STATES);
  gsl_linalg_exponential_ss(a, &e.matrix, GSL_PREC_DOUBLE);
  gsl_matrix_free(a);
  gsl_matrix_transpose(&e.matrix);
  for (int i = 0; i < VS_DOF; i++)
    for (int j = 0; j < VS_DOF; j++) {
      p->propagator_column[VS_DOF + j][i] /= w;
      p->propagator_column[j][VS_DOF + i] *= w;
    }
  p->propagated_s = h_s;
}

/* By columns, side by side: half the time of a sum for each row. */
static void swing(const phases *p, const double x[VS_STATES], double y[CONDUCTING_STATES]) {
  const double(*e)[VS_STATES] = p->propagator_column;
  double sum[VS_STATES];
  for (int i = 0; i < VS_STATES; i++)
    sum[i] = e[0][i] * x[0] + e[1][i] * x[1] + e[2][i] * x[2] + e[3][i] * x[3] + e[4][i] * x[4] +
             e[5][i] * x[5] + e[6][i] * x[6] + e[7][i] * x[7];
  memcpy(y, sum, sizeof sum);
  y[FLUX] = 0;
}

/* Shortens the step to the knot to come to where p = -D, by Newton on its length. */
static void swing_to_contact(phases *p, double upper_s) {
  const vs_knot *from = &p->knots[p->now];
  double y[CONDUCTING_STATES], lower = 0, upper = upper_s, h = upper;
  for (int n = 0; n < 60 && upper - lower > 1e-16; n++) {
    make_propagator(p, h);
    swing(p, from->x, y);
    double depth = y[P] + p->setup->model.actuator.gap_m;
    if (fabs(depth) < 1e-16) break;
    if (depth > 0)
      lower = h;
    else
      upper = h;
    double next = h - depth / y[VS_DOF + P];
    h = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  fill(p, p->since_s + h, y);
}

/* Free and off until an instant, or until the armature meets the stop. */
static vs_status swing_until(phases *p, double end_s, vs_error *err) {
  double start = p->knots[p->now].t_s, length = end_s - start;
  double n = ceil(length / p->longest_s * (1 - 1e-12)), y[CONDUCTING_STATES];
  vs_status status = VS_OK;
  for (double k = 1; k <= n && !status; k++) {
    make_propagator(p, length / n);
    swing(p, p->knots[p->now].x, y);
    double local = p->since_s;
    p->since_s = start - p->conduction.fired_s + k * length / n;
    fill(p, p->since_s, y);
    if (k == n) p->knots[1 - p->now].t_s = end_s;
    double contact = first_contact(p);
    if (!isnan(contact)) {
      p->since_s = local;
      swing_to_contact(p, contact - p->knots[p->now].t_s);
      p->since_s = p->knots[1 - p->now].t_s - p->conduction.fired_s;
      status = show(p, VS_EV_MEETS_STOP, err);
      return status ? status : turn_over(p, false, true, VS_EV_NONE, err);
    }
    status = show(p, VS_EV_NONE, err);
  }
  return status;
}

/* ---- conducting, or in the stop, or both: (q, q', lambda) by GSL's rk8pd ---- */

double vs_conduction_mains(const vs_conduction *c, double since_s) {
  const vs_timeline *l = c->frame->timeline;
  return l->peak_v * sin(c->fired_phase_rad + l->omega_rad_s * since_s);
}

double vs_conduction_mains_rate(const vs_conduction *c, double since_s) {
  const vs_timeline *l = c->frame->timeline;
  return l->peak_v * l->omega_rad_s * cos(c->fired_phase_rad + l->omega_rad_s * since_s);
}

static int driven_rhs(double since_s, const double y[], double rate[], void *user) {
  const phases *p = user;
  const vs_conduction *c = &p->conduction;
  const vs_model *m = c->frame->model;
  double stop = p->touching ? vs_stop_force(m, y) : 0;
  memcpy(rate, y + VS_DOF, sizeof(double[VS_DOF]));
  vs_accelerations(m, y, vs_force(m, y[FLUX]) + stop, rate + VS_DOF);
  rate[FLUX] = p->conducting ? c->flux_rate(c, since_s, y[FLUX], y, NULL) : 0;
  return GSL_SUCCESS;
}

/* What ends a stretch of driven motion: a quantity that falls through zero. */
typedef enum ending { GOES_ON, FLUX_ENDS, CONTACT_BEGINS, CONTACT_ENDS } ending;

static double ending_value(const phases *p, ending e, const double y[CONDUCTING_STATES]) {
  double depth = y[P] + p->setup->model.actuator.gap_m;
  return e == FLUX_ENDS ? y[FLUX] : e == CONTACT_BEGINS ? depth : -depth;
}

/* The quantity falls through zero less than `length` after the last knot: Newton on the length of
 * one step from there, so that the state at the zero has the integrator's accuracy and not the
 * dense output's. Gives that length, and y there; NaN: it cannot be located. */
static double locate(phases *p, ending e, double length, double y[CONDUCTING_STATES]) {
  const vs_knot *from = &p->knots[p->now];
  double lower = 0, upper = length, h = length, error[CONDUCTING_STATES], rate[CONDUCTING_STATES];
  double flux = p->setup->timeline.peak_v / p->setup->timeline.omega_rad_s;
  double nothing = 1e-15 * (e == FLUX_ENDS ? flux : p->setup->model.actuator.gap_m);
  for (int n = 0; n < 60; n++) {
    memcpy(y, from->x, sizeof from->x);
    y[FLUX] = from->flux_wb;
    gsl_odeiv2_step_reset(p->step);
    if (gsl_odeiv2_step_apply(p->step, p->since_s, h, y, error, NULL, NULL, &p->system)) return NAN;
    double value = ending_value(p, e, y);
    if (fabs(value) <= nothing || upper - lower <= 1e-15 * (p->since_s + h)) return h;
    if (value > 0)
      lower = h;
    else
      upper = h;
    driven_rhs(p->since_s + h, y, rate, p);
    double slope = e == FLUX_ENDS ? rate[FLUX] : e == CONTACT_BEGINS ? rate[P] : -rate[P];
    double next = h - value / slope;
    h = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return NAN;
}

/* Which ending comes first in the step just taken to y (the knot to come is filled), and where. */
static ending find_ending(phases *p, double turn_s, double *length, double y[CONDUCTING_STATES]) {
  double full = *length, contact = first_contact(p), other[CONDUCTING_STATES];
  ending found = GOES_ON;
  if (p->conducting && y[FLUX] <= 0 && p->since_s >= turn_s) {
    found = FLUX_ENDS;
    *length = locate(p, FLUX_ENDS, full, y);
  }
  ending change = p->touching ? CONTACT_ENDS : CONTACT_BEGINS;
  bool changes =
      p->touching ? !vs_in_stop(&p->setup->model, p->knots[1 - p->now].x[P]) : !isnan(contact);
  if (!changes) return found;
  double until = p->touching ? full : contact - p->knots[p->now].t_s;
  double at = locate(p, change, until, other);
  if (found != GOES_ON && *length < at) return found;
  *length = at;
  memcpy(y, other, sizeof other);
  return change;
}

/* Until an instant, or until the thyristor goes out, or the armature meets or leaves the stop. */
static vs_status drive_until(phases *p, double end_s, vs_error *err) {
  static const vs_event EVENT[] = {VS_EV_NONE, VS_EV_EXTINCT, VS_EV_MEETS_STOP, VS_EV_LEAVES_STOP};
  const vs_conduction *c = &p->conduction;
  double y[CONDUCTING_STATES], longest = p->touching ? p->longest_touching_s : p->longest_driven_s,
                               h = longest;
  memcpy(y, p->knots[p->now].x, sizeof p->knots->x);
  y[FLUX] = p->knots[p->now].flux_wb;
  gsl_odeiv2_step_reset(p->step);
  gsl_odeiv2_evolve_reset(p->evolve);
  /* u > 0 until its next zero, so lambda > 0 there: the zero of lambda lies behind it */
  double turn = (M_PI - c->fired_phase_rad) / p->setup->timeline.omega_rad_s;
  double end = end_s - c->fired_s;
  vs_status status = VS_OK;
  while (!status && p->since_s < end) {
    double since = p->since_s, limit = fmin(since + longest, end);
    if (p->conducting && since < turn) limit = fmin(limit, turn);
    h = fmin(h, limit - since);
    if (gsl_odeiv2_evolve_apply(p->evolve, p->control, p->step, &p->system, &since, limit, &h, y))
      return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", p->knots[p->now].t_s);
    fill(p, since, y);
    double length = since - p->since_s;
    ending e = find_ending(p, turn, &length, y);
    if (isnan(length))
      return vs_fail(err, VS_RUN, "t = %.9g s: an event cannot be located", p->knots[p->now].t_s);
    if (e != GOES_ON) {
      since = p->since_s + length;
      fill(p, since, y);
    }
    p->since_s = since;
    status = show(p, EVENT[e], err);
    if (status || e == GOES_ON) continue;
    bool conducting = p->conducting && e != FLUX_ENDS;
    bool touching = e == FLUX_ENDS ? p->touching : e == CONTACT_BEGINS;
    return turn_over(p, conducting, touching, VS_EV_NONE, err);
  }
  return status;
}

/* Scales of (q, q', lambda), so that one tolerance serves all: the flux linkage the mains can build
 * up, its force, and how far that force moves each coordinate at the working mode. */
static void find_scales(const vs_setup *s, double scale[CONDUCTING_STATES]) {
  const vs_model *m = &s->model;
  double flux = s->timeline.peak_v / s->timeline.omega_rad_s, force = vs_force(m, flux);
  double w = m->working_rad_s > 0 ? m->working_rad_s : m->fastest_rad_s;
  for (int i = 0; i < VS_DOF; i++) {
    double push = fmax(fabs(m->mf[i]), 1e-6 * fabs(m->mf[P]));
    scale[i] = push * force / (w * w);
    scale[VS_DOF + i] = push * force / w;
  }
  scale[FLUX] = flux;
}

vs_status vs_phases_run(const vs_setup *setup, const vs_conduction *conduction,
                        const vs_observer *observer, vs_error *err) {
  phases p = {.setup = setup, .conduction = *conduction, .observer = observer};
  double scale[CONDUCTING_STATES], until = setup->run.until_s;
  p.knots[0] = vs_sim_start(setup, conduction->frame);
  p.touching = vs_in_stop(&setup->model, p.knots[0].x[P]);
  find_scales(setup, scale);
  p.longest_s = longest_step(setup, setup->model.fastest_rad_s);
  p.longest_touching_s = longest_step(setup, setup->model.contact_rad_s);
  p.longest_driven_s = 0.5 * p.longest_s;
  p.system = (gsl_odeiv2_system){driven_rhs, NULL, CONDUCTING_STATES, &p};
  p.step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, CONDUCTING_STATES);
  p.control =
      gsl_odeiv2_control_scaled_new(0.01 * setup->run.tolerance, 0, 1, 0, scale, CONDUCTING_STATES);
  p.evolve = gsl_odeiv2_evolve_alloc(CONDUCTING_STATES);
  vs_status status = vs_sim_check_steps(setup, p.longest_touching_s, err);
  while (!status && p.knots[p.now].t_s < until) {
    double t = p.knots[p.now].t_s;
    double fires = p.conducting ? INFINITY : vs_next_conduction(&setup->timeline, t);
    if (fires <= t + 1e-10 * setup->timeline.period_s) /* to rounding */
      status = turn_over(&p, true, p.touching, VS_EV_FIRES, err);
    else if (p.conducting || p.touching)
      status = drive_until(&p, fmin(fires, until), err);
    else
      status = swing_until(&p, fmin(fires, until), err);
  }
  gsl_odeiv2_evolve_free(p.evolve);
  gsl_odeiv2_control_free(p.control);
  gsl_odeiv2_step_free(p.step);
  return status;
}
