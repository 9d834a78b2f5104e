/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/phases.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "ideal/series.h"
#include "machine/actuator.h"

typedef struct phases {
  const vs_setup *setup;
  const vs_observer *observer;
  vs_knot knots[2]; /* the last accepted one is knots[now] */
  int now;
  double largest_wb; /* |lambda| at any knot so far */
  vs_driven driven;  /* from that knot on */
  bool disturbed;    /* the scene has events */
  double jams_s;     /* INFINITY: it does not */
  double began_s;    /* where local time began, and with it the mains' wave */
  double since_s;    /* local time of the last knot; as fine after hours as at first */
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
                  .held = p->driven.held,
                  .event = {event},
                  .event_s = {to->t_s}};
  p->now = 1 - p->now;
  return p->observer->accept(p->observer->ctx, &step, err);
}

/* When u falls through zero, in local time, or near `most` where that comes first. */
static double mains_turn(const phases *p, double most_s) {
  const vs_wave *u = &p->driven.mains;
  if (!p->disturbed) return (M_PI - u->sine[0].phase_rad) / u->sine[0].omega_rad_s;
  return fmin(vs_wave_turns(u, -1, p->since_s, most_s), most_s); /* of a NaN the other */
}

/* How far the force of what is a large flux linkage moves each coordinate at the working mode. */
static void find_coordinates(phases *p) {
  const vs_model *m = &p->setup->model;
  double w = m->working_rad_s > 0 ? m->working_rad_s : m->fastest_rad_s;
  double force = vs_actuator_force(m, p->driven.flux_wb);
  for (int i = 0; i < VS_DOF; i++)
    p->driven.coordinate[i] = fmax(fabs(m->mf[i]), 1e-6 * fabs(m->mf[P])) * force / (w * w);
}

/* Less is no flux linkage, in parts of what the mains have: it is of a voltage that was as good as
 * none. */
static const double FAINT = 1e-9;

/* A conduction begins: what is large for it is the flux linkage that u builds up until it falls or
 * changes, or what there was before. */
static void rescale(phases *p, double t_s) {
  const vs_timeline *line = p->driven.frame->timeline;
  const vs_wave *wave = &p->driven.mains;
  double most = fmin(vs_wave_edge(line, t_s) - t_s, line->period_s), flux = 0;
  double half = fmin(vs_wave_turns(wave, -1, 0, most), most) / 2;
  for (size_t k = 0; k < wave->count; k++) { /* its integral: cosines' difference */
    const vs_sine *s = &wave->sine[k];
    double turned = s->omega_rad_s * half;
    flux += 2 * s->peak_v / s->omega_rad_s * sin(s->phase_rad + turned) * sin(turned);
  }
  flux = fmax(flux, FAINT * line->peak_v / line->omega_rad_s);
  p->driven.flux_wb = fmax(flux, p->largest_wb);
  find_coordinates(p);
}

static void complete(const phases *p, vs_knot *k) {
  if (p->driven.held)
    vs_knot_hold(p->driven.frame, k);
  else
    vs_knot_complete(p->driven.frame, k, p->driven.touching);
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
    complete(p, k);
    return;
  }
  double u[3], r = m->actuator.resistance_ohm / (2 * m->a_hm), moves = frame->gap_at_rest ? 0 : 1;
  double z = vs_actuator_gap(m, moves * k->x[P]), z1 = moves * k->x[VS_DOF + P];
  vs_wave_at(&p->driven.mains, since_s, u);
  k->flux_rate_v = u[0] - r * k->flux_wb * z;
  complete(p, k);
  double z2 = moves * k->a[P];
  k->flux_rate2_v_s = u[1] - r * (k->flux_rate_v * z + k->flux_wb * z1);
  k->flux_rate3_v_s2 =
      u[2] - r * (k->flux_rate2_v_s * z + 2 * k->flux_rate_v * z1 + k->flux_wb * z2);
}

/* Something changed at the last knot: it is shown from its other side too, as a step of no length.
 * Local time begins anew, and the mains' wave with it, unless a conduction goes on undisturbed. */
static vs_status turn_over(phases *p, bool conducting, bool touching, vs_event event,
                           vs_error *err) {
  double y[VS_CONDUCTING];
  const vs_knot *k = &p->knots[p->now];
  memcpy(y, k->x, sizeof k->x);
  y[VS_FLUX] = conducting ? k->flux_wb : 0;
  if (!p->driven.conducting || !conducting || p->disturbed) {
    p->began_s = k->t_s;
    p->since_s = 0;
    vs_wave_of(p->driven.frame->timeline, k->t_s, &p->driven.mains);
    if (p->disturbed && conducting && !p->driven.conducting) rescale(p, k->t_s);
  }
  p->driven.conducting = conducting;
  p->driven.touching = touching;
  if (event == VS_EV_JAMS) { /* the blow */
    p->driven.held = true;
    vs_mechanics_hold_p(p->driven.frame->model, y + VS_DOF);
  }
  fill(p, p->since_s, y);
  return show(p, event, err);
}

/* In parts of what is large: rounding of lambda's series; and a flux linkage that is over, where
 * 0 V let it die away for ever. */
static const double NOTHING = 1e-14, OVER = 1e-9;

/* ---- what may end a stretch of motion: a quantity that falls through zero ---- */

typedef enum ending { GOES_ON, FLUX_ENDS, CONTACT_BEGINS, CONTACT_ENDS } ending;

/* First sign in the step to the knot to come that p goes through -D: its end, or the least p on the
 * way where p turns inside it; NaN: none. */
static double first_contact(const phases *p) {
  const vs_model *m = p->driven.frame->model;
  const vs_knot *from = &p->knots[p->now], *to = &p->knots[1 - p->now];
  if (!m->actuator.stop.present || p->driven.touching || p->driven.held) return NAN;
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
  return vs_mechanics_in_stop(m, vs_step_channel(&step, hi, VS_CH_P)) ? hi : NAN;
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
  p->driven.since_s = p->since_s;
  vs_series_make(&p->driven, &p->knots[p->now], span_s, &p->series);
}

/* Of a conduction: does lambda end in the step to the knot to come, and between which two instants
 * from the last knot? Undisturbed u > 0 until its next zero, so lambda > 0 there: the zero of
 * lambda lies behind it. Else the series itself is asked for its first one. */
static bool flux_ends(const phases *p, double full_s, double *lower_s, double *upper_s) {
  double turn;
  if (!p->driven.conducting) return false;
  if (p->disturbed)
    return vs_series_flux_falls(&p->series, full_s, NOTHING * p->driven.flux_wb, lower_s, upper_s);
  turn = mains_turn(p, INFINITY) - p->since_s;
  *lower_s = fmax(turn, 0);
  *upper_s = full_s;
  return p->knots[1 - p->now].flux_wb <= 0 && full_s >= turn;
}

/* Which ending comes first in the step just taken along the series (the knot to come is filled),
 * and where. */
static ending find_ending(const phases *p, double *length) {
  double full = *length, contact = first_contact(p), lower, upper;
  const vs_knot *to = &p->knots[1 - p->now];
  ending found = GOES_ON;
  if (flux_ends(p, full, &lower, &upper)) {
    found = FLUX_ENDS;
    *length = locate(p, FLUX_ENDS, lower, upper);
  }
  bool leaves = p->driven.touching && !p->driven.held &&
                !vs_mechanics_in_stop(p->driven.frame->model, to->x[P]);
  if (!leaves && isnan(contact)) return found;
  ending change = leaves ? CONTACT_ENDS : CONTACT_BEGINS;
  double at = locate(p, change, 0, leaves ? full : contact - p->knots[p->now].t_s);
  if (found != GOES_ON && *length < at) return found;
  *length = at;
  return change;
}

/* ---- anything at all, by Taylor series ---- */

/* What the books of energy ask of lambda beside, as a part of that: of harmonics the voltage, whose
 * product with the current they take, is as much larger than their share in lambda as they are
 * faster than the mains; and a jammed machine does no work, so that they are told in parts of a
 * hundredth of what is drawn (watch/energy.h). */
static double books_part(const phases *p) {
  if (!p->disturbed || !p->driven.conducting) return 1;
  double slower = p->setup->timeline.omega_rad_s / p->driven.mains.highest_rad_s;
  return slower * (p->driven.held ? 0.01 : 1);
}

/* How far the series may be used: its last terms must be negligible there, and that of degree eight
 * within what dense output may be off by. The one before each counts too: one alone may vanish. */
static double reach(const phases *p, const vs_series *s) {
  enum { EIGHTH = 8, LAST = VS_SERIES_ORDER };
  double rough = p->rough * books_part(p);
  double dense =
      fmax(vs_series_part(&p->driven, s, EIGHTH), vs_series_part(&p->driven, s, EIGHTH + 1));
  double last = fmax(vs_series_part(&p->driven, s, LAST - 1), vs_series_part(&p->driven, s, LAST));
  double r = fmin(pow(256 * rough / dense, 1.0 / EIGHTH), pow(p->negligible / last, 1.0 / LAST));
  return fmin(r, 1) * s->span_s;
}

static bool is_over(phases *p) {
  double flux = fabs(p->knots[1 - p->now].flux_wb);
  if (!p->disturbed || !p->driven.conducting) return false;
  p->largest_wb = fmax(p->largest_wb, flux);
  return flux <= OVER * p->largest_wb && vs_wave_is_silent(&p->driven.mains);
}

/* Until an instant, or until the thyristor goes out, or the armature meets or leaves the stop. */
static vs_status drive_until(phases *p, double end_s, vs_error *err) {
  static const vs_event EVENT[] = {VS_EV_NONE, VS_EV_EXTINCT, VS_EV_MEETS_STOP, VS_EV_LEAVES_STOP};
  double longest = p->driven.touching     ? p->longest_touching_s
                   : p->driven.conducting ? p->longest_driven_s
                                          : p->longest_s;
  if (p->disturbed && p->driven.conducting)
    longest = fmin(longest, 1 / p->driven.mains.highest_rad_s);
  double end = end_s - p->began_s, y[VS_CONDUCTING];
  vs_status status = VS_OK;
  while (!status && p->since_s < end) {
    make_series(p, longest);
    double length = reach(p, &p->series), left = end - p->since_s;
    if (!(length > 1e-15 * end))
      return vs_fail(err, VS_RUN, "t = %.9g s: no step is short enough", p->knots[p->now].t_s);
    /* a knot near the largest flux, however short the conduction */
    double turn = p->driven.conducting && p->since_s == 0 ? mains_turn(p, length) : 0;
    if (turn > 0) length = fmin(length, turn);
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
    if (e == GOES_ON && is_over(p)) e = FLUX_ENDS;
    bool done = length == left;
    p->since_s += length;
    if (done) p->knots[1 - p->now].t_s = end_s;
    status = show(p, EVENT[e], err);
    if (status || (done && e == GOES_ON)) return status;
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
  double w = m->fastest_rad_s, k[VS_DOF], b[VS_DOF];
  gsl_matrix *a = gsl_matrix_calloc(VS_STATES, VS_STATES);
  for (size_t j = 0; j < VS_DOF; j++) {
    gsl_matrix_set(a, j, VS_DOF + j, h_s * w);
    memcpy(k, m->mk_column[j], sizeof k);
    memcpy(b, m->mb_column[j], sizeof b);
    if (p->driven.held) {
      vs_mechanics_hold_p(m, k);
      vs_mechanics_hold_p(m, b);
    }
    for (size_t i = 0; i < VS_DOF; i++) {
      gsl_matrix_set(a, VS_DOF + i, j, -h_s * k[i] / w);
      gsl_matrix_set(a, VS_DOF + i, VS_DOF + j, -h_s * b[i]);
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

/* Free and off in long steps, else by series; may come back before the end. */
static vs_status go(phases *p, double end_s, vs_error *err) {
  bool swings = !p->driven.conducting && !p->driven.touching;
  if (swings && end_s - p->knots[p->now].t_s >= 2 * p->longest_s) return swing_until(p, end_s, err);
  return drive_until(p, end_s, err);
}

/* What is large: the flux linkage that the mains can build up from the firing angle on, and what it
 * moves. */
static void find_scales(phases *p) {
  const vs_timeline *line = &p->setup->timeline;
  p->driven.flux_wb = line->peak_v / line->omega_rad_s * (1 + cos(line->firing.angle_rad));
  find_coordinates(p);
}

/* ---- all of it ---- */

/* Up to the end, and where the mains' next sines begin while current flows, on with them; or the
 * armature jams. */
static vs_status go_disturbed(phases *p, double end_s, vs_error *err) {
  const vs_timeline *line = &p->setup->timeline;
  double t = p->knots[p->now].t_s, edge = INFINITY;
  if (!p->driven.held && t >= p->jams_s) {
    vs_status status = turn_over(p, p->driven.conducting, p->driven.touching, VS_EV_JAMS, err);
    make_propagator(p, p->longest_s);
    return status;
  }
  if (p->driven.conducting) edge = vs_wave_edge(line, t);
  double jams = p->driven.held ? INFINITY : p->jams_s;
  vs_status status = go(p, fmin(fmin(end_s, edge), jams), err);
  if (status || !p->driven.conducting || p->knots[p->now].t_s < edge) return status;
  return turn_over(p, true, p->driven.touching, VS_EV_NONE, err);
}

static double next_firing(const phases *p, double t_s) {
  const vs_timeline *line = &p->setup->timeline;
  if (p->driven.conducting) return INFINITY;
  return p->disturbed ? vs_wave_conduction(line, t_s, p->setup->run.until_s)
                      : vs_gate_next_conduction(line, t_s);
}

vs_status vs_phases_run(const vs_setup *setup, const vs_frame *frame, const vs_observer *observer,
                        vs_error *err) {
  const vs_model *m = &setup->model;
  double until = setup->run.until_s, tolerance = setup->run.tolerance;
  double mains = setup->timeline.omega_rad_s;
  double coil = m->actuator.resistance_ohm * m->gap_rest_m / (2 * m->a_hm);
  phases p = {.setup = setup, .observer = observer, .rough = fmin(ROUGH * tolerance, ROUGHEST)};
  p.negligible = 1e-3 * p.rough;
  p.disturbed = setup->timeline.events.count > 0;
  p.jams_s = vs_setup_jams(setup);
  p.driven = (vs_driven){.frame = frame};
  p.knots[0] = vs_sim_start(setup, frame);
  p.driven.touching = vs_mechanics_in_stop(m, p.knots[0].x[P]);
  find_scales(&p);
  p.longest_s = longest_step(&p, pow(DENSE * 6 * p.rough, 1.0 / 8), m->fastest_rad_s);
  p.longest_driven_s = longest_step(&p, 1, fmax(fmax(m->fastest_rad_s, mains), coil / 8));
  p.longest_touching_s = fmin(longest_step(&p, 1, m->contact_rad_s), p.longest_driven_s);
  make_propagator(&p, p.longest_s);
  vs_status status = vs_sim_check_steps(setup, p.longest_touching_s, err);
  while (!status && p.knots[p.now].t_s < until) {
    double t = p.knots[p.now].t_s, fires = next_firing(&p, t), end = fmin(fires, until);
    /* to rounding; of what is disturbed to the bit, as the mains may be others just before */
    if (fires <= t + (p.disturbed ? 0 : 1e-10 * setup->timeline.period_s))
      status = turn_over(&p, true, p.driven.touching, VS_EV_FIRES, err);
    else
      status = p.disturbed ? go_disturbed(&p, end, err) : go(&p, end, err);
  }
  return status;
}
