/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/phases.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "machine/actuator.h"
#include "sim/series.h"

typedef struct phases {
  const vs_setup *setup;
  const vs_observer *observer;
  vs_knot knots[2]; /* the last accepted one is knots[now] */
  int now;
  vs_driven driven;                /* from that knot on */
  double began_s, began_phase_rad; /* where local time began, and the mains' phase then, -pi..pi */
  double since_s; /* local time of the last knot; as fine after hours as at first */
  double longest_s, longest_driven_s, longest_touching_s; /* step: free, conducting, in the stop */
  double rough; /* part of what is large that dense output may be off by */
  double propagator_column[VS_STATES][VS_STATES]; /* exp(A longest_s); [j][i] is row i, column j */
  double negligible; /* part of what is large that a series may leave out */
  vs_series series;
} phases;

/* The polynomial of degree seven between knots is off by (w h)^8/10321920 at most, or by the
 * series' eighth term/256. That much is allowed of it; never more than the second, with which the
 * books of energy, kept on the dense output, close to 1e-9 of the work. */
static const double DENSE = 10321920, ROUGH = 0.05, ROUGHEST = 5e-11;

static double longest_step(const phases *p, double radians, double fastest_rad_s) {
  const vs_run_values *run = &p->setup->run;
  double h = radians / fastest_rad_s;
  if (run->max_step_s > 0) h = fmin(h, run->max_step_s);
  return fmin(h, run->until_s / 4);
}

static vs_status show(phases *p, vs_event event, vs_error *err) {
  const vs_knot *to = &p->knots[1 - p->now];
  vs_step step = {.frame = p->driven.frame,
                  .from = &p->knots[p->now],
                  .to = to,
                  .event = {event},
                  .event_s = {to->t_s}};
  p->now = 1 - p->now;
  return p->observer->accept(p->observer->ctx, &step, err);
}

/* u and its rate */
static void mains(const phases *p, double since_s, double *voltage_v, double *rate_v_s) {
  const vs_timeline *line = p->driven.frame->timeline;
  double phase = p->began_phase_rad + line->omega_rad_s * since_s;
  *voltage_v = line->peak_v * sin(phase);
  *rate_v_s = line->peak_v * line->omega_rad_s * cos(phase);
}

/* When u falls through zero, in local time. */
static double mains_turn(const phases *p) {
  return (M_PI - p->began_phase_rad) / p->driven.frame->timeline->omega_rad_s;
}

/* Fills the knot to come, `since_s` of local time on, from y:
 *   dlambda/dt = u - R_c i and two derivatives more, with i = lambda z/(2a) and z' = p' or 0. */
static void fill(phases *p, double since_s, const double y[VS_CONDUCTING]) {
  const vs_frame *frame = p->driven.frame;
  const vs_model *m = frame->model;
  vs_knot *k = &p->knots[1 - p->now];
  k->t_s = p->began_s + since_s;
  memcpy(k->x, y, sizeof k->x);
  k->flux_wb = y[VS_FLUX];
  k->flux_rate_v = k->flux_rate2_v_s = k->flux_rate3_v_s2 = 0;
  if (!p->driven.conducting) {
    vs_knot_complete(frame, k, p->driven.touching);
    return;
  }
  double u, u1, r = m->actuator.resistance_ohm / (2 * m->a_hm), moves = frame->gap_at_rest ? 0 : 1;
  double z = vs_gap(m, moves * k->x[P]), z1 = moves * k->x[VS_DOF + P];
  mains(p, since_s, &u, &u1);
  k->flux_rate_v = u - r * k->flux_wb * z;
  vs_knot_complete(frame, k, p->driven.touching);
  double z2 = moves * k->a[P],
         u2 = -u * frame->timeline->omega_rad_s * frame->timeline->omega_rad_s;
  k->flux_rate2_v_s = u1 - r * (k->flux_rate_v * z + k->flux_wb * z1);
  k->flux_rate3_v_s2 = u2 - r * (k->flux_rate2_v_s * z + 2 * k->flux_rate_v * z1 + k->flux_wb * z2);
}

/* Something changed at the last knot: it is shown from its other side too, as a step of no length.
 * Local time begins anew unless a conduction goes on. */
static vs_status turn_over(phases *p, bool conducting, bool touching, vs_event event,
                           vs_error *err) {
  double y[VS_CONDUCTING];
  const vs_knot *k = &p->knots[p->now];
  memcpy(y, k->x, sizeof k->x);
  y[VS_FLUX] = conducting ? k->flux_wb : 0;
  if (!p->driven.conducting || !conducting) {
    p->began_s = k->t_s;
    p->since_s = 0;
    p->began_phase_rad = remainder(vs_phase(p->driven.frame->timeline, k->t_s), 2 * M_PI);
  }
  p->driven.conducting = conducting;
  p->driven.touching = touching;
  fill(p, p->since_s, y);
  return show(p, event, err);
}

/* ---- what may end a stretch of motion: a quantity that falls through zero ---- */

typedef enum ending { GOES_ON, FLUX_ENDS, CONTACT_BEGINS, CONTACT_ENDS } ending;

/* First sign in the step to the knot to come that p goes through -D: its end, or the least p on the
 * way where p turns inside it; NaN: none. */
static double first_contact(const phases *p) {
  const vs_model *m = p->driven.frame->model;
  const vs_knot *from = &p->knots[p->now], *to = &p->knots[1 - p->now];
  if (!m->actuator.stop.present || p->driven.touching) return NAN;
  if (to->x[P] < -m->actuator.gap_m) return to->t_s;
  if (from->x[VS_DOF + P] >= 0 || to->x[VS_DOF + P] <= 0) return NAN;
  const vs_step step = {.frame = p->driven.frame, .from = from, .to = to};
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

static double ending_value(const phases *p, ending e, double at_s, double *rate) {
  if (e == FLUX_ENDS) return vs_series_flux(&p->series, at_s, rate);
  double depth = vs_series_p(&p->series, at_s, rate) + p->setup->model.actuator.gap_m;
  if (e == CONTACT_BEGINS) return depth;
  *rate = -*rate;
  return -depth;
}

/* The quantity falls through zero between lower and upper, from the last knot: Newton on the
 * series. */
static double locate(const phases *p, ending e, double lower, double upper) {
  double nothing = 1e-15 * (e == FLUX_ENDS ? p->driven.flux_wb : p->setup->model.actuator.gap_m);
  double at = upper;
  for (int n = 0; n < 60; n++) {
    double rate, value = ending_value(p, e, at, &rate);
    if (fabs(value) <= nothing || upper - lower <= 1e-15 * (p->since_s + at)) break;
    if (value > 0)
      lower = at;
    else
      upper = at;
    double next = at - value / rate;
    at = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return at;
}

static void make_series(phases *p, double span_s) {
  mains(p, p->since_s, &p->driven.mains_v, &p->driven.mains_rate_v_s);
  vs_series_make(&p->driven, &p->knots[p->now], span_s, &p->series);
}

/* Which ending comes first in the step just taken along the series (the knot to come is filled),
 * and where. */
static ending find_ending(const phases *p, double *length) {
  double full = *length, contact = first_contact(p);
  const vs_knot *to = &p->knots[1 - p->now];
  /* u > 0 until its next zero, so lambda > 0 there: the zero of lambda lies behind it */
  double turn = mains_turn(p) - p->since_s;
  ending found = GOES_ON;
  if (p->driven.conducting && to->flux_wb <= 0 && full >= turn) {
    found = FLUX_ENDS;
    *length = locate(p, FLUX_ENDS, fmax(turn, 0), full);
  }
  bool leaves = p->driven.touching && !vs_in_stop(p->driven.frame->model, to->x[P]);
  if (!leaves && isnan(contact)) return found;
  ending change = leaves ? CONTACT_ENDS : CONTACT_BEGINS;
  double at = locate(p, change, 0, leaves ? full : contact - p->knots[p->now].t_s);
  if (found != GOES_ON && *length < at) return found;
  *length = at;
  return change;
}

/* ---- anything at all, by Taylor series ---- */

/* How far the series may be used: its last terms must be negligible there, and that of degree eight
 * within what dense output may be off by. The one before each counts too: one alone may vanish. */
static double reach(const phases *p, const vs_series *s) {
  enum { EIGHTH = 8, LAST = VS_SERIES_ORDER };
  double dense =
      fmax(vs_series_part(&p->driven, s, EIGHTH), vs_series_part(&p->driven, s, EIGHTH + 1));
  double last = fmax(vs_series_part(&p->driven, s, LAST - 1), vs_series_part(&p->driven, s, LAST));
  double r = fmin(pow(256 * p->rough / dense, 1.0 / EIGHTH), pow(p->negligible / last, 1.0 / LAST));
  return fmin(r, 1) * s->span_s;
}

/* Until an instant, or until the thyristor goes out, or the armature meets or leaves the stop. */
static vs_status drive_until(phases *p, double end_s, vs_error *err) {
  static const vs_event EVENT[] = {VS_EV_NONE, VS_EV_EXTINCT, VS_EV_MEETS_STOP, VS_EV_LEAVES_STOP};
  double longest = p->driven.touching     ? p->longest_touching_s
                   : p->driven.conducting ? p->longest_driven_s
                                          : p->longest_s;
  double end = end_s - p->began_s, y[VS_CONDUCTING];
  vs_status status = VS_OK;
  while (!status && p->since_s < end) {
    make_series(p, longest);
    double length = reach(p, &p->series), left = end - p->since_s;
    if (!(length > 1e-15 * end))
      return vs_fail(err, VS_RUN, "t = %.9g s: no step is short enough", p->knots[p->now].t_s);
    /* a knot near the largest flux, however short the conduction */
    if (p->driven.conducting && p->since_s == 0) length = fmin(length, mains_turn(p));
    if (length >= left)
      length = left;
    else if (2 * length > left)
      length = left / 2;
    vs_series_at(&p->series, length, y);
    fill(p, p->since_s + length, y);
    ending e = find_ending(p, &length);
    if (e != GOES_ON) {
      vs_series_at(&p->series, length, y);
      fill(p, p->since_s + length, y);
    }
    bool done = length == left;
    p->since_s += length;
    if (done) p->knots[1 - p->now].t_s = end_s;
    status = show(p, EVENT[e], err);
    if (status || done) return status;
    if (e == GOES_ON) continue;
    bool conducting = p->driven.conducting && e != FLUX_ENDS;
    bool touching = e == FLUX_ENDS ? p->driven.touching : e == CONTACT_BEGINS;
    return turn_over(p, conducting, touching, VS_EV_NONE, err);
  }
  return status;
}

/* ---- free and off: lambda = 0, x' = A x, solved exactly ---- */

/* exp(A h) for x = (q, q'), A = [0 I; -M^-1 K  -M^-1 B]. Taken of (w q, q') with the fastest mode's
 * w, whose matrix is of one order of magnitude throughout: GSL's result is then right to 2e-15 to
 * 5e-15, for 2e-14 to 1e-12 without (h from 50 us to 0.8 ms, Table 1). */
static void make_propagator(phases *p, double h_s) {
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
}

/* By columns, side by side: half the time of a sum for each row. */
static void swing(const phases *p, const double x[VS_STATES], double y[VS_CONDUCTING]) {
  const double(*e)[VS_STATES] = p->propagator_column;
  double sum[VS_STATES];
  for (int i = 0; i < VS_STATES; i++)
    sum[i] = e[0][i] * x[0] + e[1][i] * x[1] + e[2][i] * x[2] + e[3][i] * x[3] + e[4][i] * x[4] +
             e[5][i] * x[5] + e[6][i] * x[6] + e[7][i] * x[7];
  memcpy(y, sum, sizeof sum);
  y[VS_FLUX] = 0;
}

/* In steps of one length, as many as leave one of them and more for the rest; where the armature is
 * about to meet the stop, on to an ending. */
static vs_status swing_until(phases *p, double end_s, vs_error *err) {
  double began = p->since_s, n = floor((end_s - p->knots[p->now].t_s) / p->longest_s) - 1;
  double y[VS_CONDUCTING];
  vs_status status = VS_OK;
  for (double k = 1; k <= n && !status; k++) {
    double since = began + k * p->longest_s;
    swing(p, p->knots[p->now].x, y);
    fill(p, since, y);
    if (!isnan(first_contact(p))) return drive_until(p, end_s, err);
    p->since_s = since;
    status = show(p, VS_EV_NONE, err);
  }
  return status;
}

/* What is large: the flux linkage that the mains can build up from the firing angle on, its force,
 * and how far that moves each coordinate at the working mode. */
static void find_scales(phases *p) {
  const vs_model *m = &p->setup->model;
  const vs_timeline *line = &p->setup->timeline;
  double w = m->working_rad_s > 0 ? m->working_rad_s : m->fastest_rad_s;
  p->driven.flux_wb = line->peak_v / line->omega_rad_s * (1 + cos(line->firing.angle_rad));
  double force = vs_force(m, p->driven.flux_wb);
  for (int i = 0; i < VS_DOF; i++)
    p->driven.coordinate[i] = fmax(fabs(m->mf[i]), 1e-6 * fabs(m->mf[P])) * force / (w * w);
}

vs_status vs_phases_run(const vs_setup *setup, const vs_frame *frame, const vs_observer *observer,
                        vs_error *err) {
  const vs_model *m = &setup->model;
  double until = setup->run.until_s, tolerance = setup->run.tolerance;
  double mains = setup->timeline.omega_rad_s;
  double coil = m->actuator.resistance_ohm * m->gap_rest_m / (2 * m->a_hm);
  phases p = {.setup = setup, .observer = observer, .rough = fmin(ROUGH * tolerance, ROUGHEST)};
  p.negligible = 1e-3 * p.rough;
  p.driven = (vs_driven){.frame = frame};
  p.knots[0] = vs_sim_start(setup, frame);
  p.driven.touching = vs_in_stop(m, p.knots[0].x[P]);
  find_scales(&p);
  p.longest_s = longest_step(&p, pow(DENSE * 6 * p.rough, 1.0 / 8), m->fastest_rad_s);
  p.longest_driven_s = longest_step(&p, 1, fmax(fmax(m->fastest_rad_s, mains), coil / 8));
  p.longest_touching_s = fmin(longest_step(&p, 1, m->contact_rad_s), p.longest_driven_s);
  make_propagator(&p, p.longest_s);
  vs_status status = vs_sim_check_steps(setup, p.longest_touching_s, err);
  while (!status && p.knots[p.now].t_s < until) {
    double t = p.knots[p.now].t_s;
    double fires = p.driven.conducting ? INFINITY : vs_next_conduction(&setup->timeline, t);
    double end = fmin(fires, until);
    if (fires <= t + 1e-10 * setup->timeline.period_s) /* to rounding */
      status = turn_over(&p, true, p.driven.touching, VS_EV_FIRES, err);
    else if (!p.driven.conducting && !p.driven.touching && end - t >= 2 * p.longest_s)
      status = swing_until(&p, end, err);
    else
      status = drive_until(&p, end, err);
  }
  return status;
}
