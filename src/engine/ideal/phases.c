/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/phases.h"

#include <assert.h>
#include <complex.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/firing.h"
#include "engine/gate.h"
#include "engine/propagator.h"
#include "engine/sim.h"
#include "ideal/runge_kutta.h"
#include "ideal/taylor.h"
#include "plant/coil.h"

/* ---- what ends a stretch of motion ----
 *
 * A quantity that falls through zero ends it: the flux linkage of a conduction, or how far the
 * armature is from a stop or inside it. */

/* A step that was just taken, before its end is shown to the observers. All is borrowed. */
typedef struct vs_taken {
  const vs_driven *driven; /* what drives the machine; since_s is that of `from` */
  const vs_taylor *series; /* from `from` on */
  const vs_knot *from, *to;
  bool valve;     /* a thyristor stands between mains and coil */
  bool disturbed; /* the scene has events */
} vs_taken;

typedef struct vs_crossing {
  enum { VS_GOES_ON, VS_FLUX_ENDS, VS_CONTACT_BEGINS, VS_CONTACT_ENDS } kind;
  int stop; /* of a contact, which of the model's */
} vs_crossing;

/* The rounding of lambda's series, relative to what is large. */
static const double NOTHING = 1e-14;

/* Returns an instant in the step at which the armature is in this stop, which it was not: the
 * step's end, or the deepest travel on the way where that turns inside it. NaN: none. */
static double first_contact(const vs_taken *t, const vs_stop *stop) {
  const vs_model *m = t->driven->frame->model;
  const vs_knot *from = t->from, *to = t->to;
  int dof = m->dof, side = stop->side;
  if (vs_stop_depth(stop, vs_mechanics_travel(m, to->x)) > 0) return to->t_s;
  if (side * vs_mechanics_travel(m, from->x + dof) >= 0 ||
      side * vs_mechanics_travel(m, to->x + dof) <= 0)
    return NAN;
  const vs_step step = {.frame = t->driven->frame, .from = from, .to = to};
  double lo = from->t_s, hi = to->t_s, y[VS_CH_MOST];
  for (int n = 0; n < 50; n++) {
    double mid = (lo + hi) / 2;
    vs_step_groups_at(&step, mid, VS_GROUP_VELOCITIES, y);
    if (side * vs_mechanics_travel(m, y + vs_channel_rates(m)) < 0)
      lo = mid;
    else
      hi = mid;
  }
  vs_step_groups_at(&step, hi, 0, y);
  return vs_stop_depth(stop, y[VS_CH_TRAVEL]) > 0 ? hi : NAN;
}

/* Returns true if the armature meets a stop in the step. It does not read the series and since_s,
 * so that the step may be one that the propagator took. */
static bool crossing_meets(const vs_taken *t) {
  const vs_stops *stops = &t->driven->frame->model->stops;
  for (int k = 0; k < stops->count && !t->driven->held; k++)
    if (!(t->driven->touched >> k & 1) && !isnan(first_contact(t, &stops->item[k]))) return true;
  return false;
}

static double falling_quantity(const vs_taken *t, vs_crossing e, double at_s, double *rate) {
  if (e.kind == VS_FLUX_ENDS) return vs_taylor_flux(t->series, at_s, rate);
  const vs_stop *stop = &t->driven->frame->model->stops.item[e.stop];
  int sign = e.kind == VS_CONTACT_BEGINS ? stop->side : -stop->side;
  double way = vs_taylor_travel(t->series, at_s, rate) - stop->at_m;
  *rate *= sign;
  return sign * way;
}

/* Returns when the quantity falls through zero, in seconds from the step's beginning. It does so
 * between `lower` and `upper`. Newton's iteration on the series. */
static double locate_crossing(const vs_taken *t, vs_crossing e, double lower, double upper) {
  double nothing = 1e-15 * (e.kind == VS_FLUX_ENDS ? t->driven->flux_wb
                                                   : t->driven->frame->model->actuator.gap_m);
  double at = upper;
  for (int n = 0; n < 60; n++) {
    double rate, value = falling_quantity(t, e, at, &rate);
    if (fabs(value) <= nothing || upper - lower <= 1e-15 * (t->driven->since_s + at)) break;
    if (value > 0)
      lower = at;
    else
      upper = at;
    double next = at - value / rate;
    at = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return at;
}

/* Does a conduction end in the step, and between which two instants, in seconds from its beginning?
 * Undisturbed u > 0 until its next zero, and so lambda > 0 there: the zero of lambda lies behind
 * it. Disturbed, the series itself is asked for its first fall. */
static bool flux_ends(const vs_taken *t, double full_s, double *lower_s, double *upper_s) {
  double turn;
  if (!t->driven->conducting || !t->valve) return false;
  if (t->disturbed || t->driven->frame->model->coil.eddies)
    return vs_taylor_flux_falls(t->series, full_s, NOTHING * t->driven->flux_wb, lower_s, upper_s);
  turn = vs_driven_mains_turn(t->driven, false, INFINITY) - t->driven->since_s;
  *lower_s = fmax(turn, 0);
  *upper_s = full_s;
  return t->to->flux_wb <= 0 && full_s >= turn;
}

/* Returns which one comes first in a step along the series, which is *length_s long. *length_s
 * becomes the time from the step's beginning to it. */
static vs_crossing find_crossing(const vs_taken *t, double *length) {
  double full = *length, lower, upper;
  const vs_knot *from = t->from, *to = t->to;
  const vs_model *m = t->driven->frame->model;
  vs_crossing found = {VS_GOES_ON, 0};
  if (flux_ends(t, full, &lower, &upper)) {
    found.kind = VS_FLUX_ENDS;
    *length = locate_crossing(t, found, lower, upper);
  }
  for (int k = 0; k < m->stops.count && !t->driven->held; k++) {
    const vs_stop *stop = &m->stops.item[k];
    bool inside = t->driven->touched >> k & 1;
    bool leaves = inside && !(vs_stop_depth(stop, vs_mechanics_travel(m, to->x)) > 0);
    double contact = inside ? NAN : first_contact(t, stop);
    if (!leaves && isnan(contact)) continue;
    vs_crossing change = {leaves ? VS_CONTACT_ENDS : VS_CONTACT_BEGINS, k};
    double at = locate_crossing(t, change, 0, leaves ? full : contact - from->t_s);
    if (found.kind != VS_GOES_ON && *length < at) continue;
    *length = at;
    found = change;
  }
  return found;
}

/* ---- glide ---- */

/* The machine's free motion in closed form, as the sum of its modes: how far each coordinate can
 * still go, and what damping takes. The motion itself comes from the propagator, so that the books
 * of energy hold two computations against each other that share nothing but M, B and K. */

/* q(t) = middle + sum over k of share[k] exp(s[k] t), t being the time since the knot. */
typedef struct free_motion {
  const vs_model *model; /* borrowed */
  double began_s;        /* the knot's time */
  double middle[VS_MOST_DOF];
  double complex s[VS_MOST_STATES], share[VS_MOST_STATES][VS_MOST_DOF];
} free_motion;

/* What the sum of the modes may miss of the knot's state, relative to the sum of their sizes. */
static const double MISSED = 1e-9;
/* By which factor the bounds are larger than the sums of the modes' sizes. It covers MISSED and
 * what the dense output of the steps that are left out may be off by (phases.c). */
static const double WIDER = 1 + 1e-6;

/* Where constant forces and springs hold the balance: K middle = f0. False: nowhere. */
static bool find_middle(const vs_model *m, double middle[VS_MOST_DOF]) {
  double k[VS_MOST_DOF * VS_MOST_DOF], scale = 0;
  size_t n = (size_t)m->dof;
  memset(middle, 0, VS_MOST_DOF * sizeof *middle);
  if (!m->loaded) return true;
  for (int i = 0; i < m->dof; i++) {
    middle[i] = m->constant[i];
    scale = fmax(scale, fabs(m->constant[i]));
    for (int j = 0; j < m->dof; j++) k[i * m->dof + j] = m->stiffness[i][j];
  }
  gsl_matrix_view kv = gsl_matrix_view_array(k, n, n);
  gsl_vector_view v = gsl_vector_view_array(middle, n);
  if (gsl_linalg_HH_svx(&kv.matrix, &v.vector)) return false;
  for (int i = 0; i < m->dof; i++) {
    double left = m->constant[i];
    for (int j = 0; j < m->dof; j++) left -= m->stiffness[i][j] * middle[j];
    if (!(fabs(left) <= MISSED * scale)) return false;
  }
  return true;
}

/* With symmetric M, B and K each mode's shape f is also the left one, and
 *   share = f (f.(s M + B) q0 + f.M v0)/(f.(2 s M + B) f) */
static void find_share(free_motion *g, int mode, const double *q0, const double *v0) {
  const vs_model *m = g->model;
  const vs_mode *of = &m->mode[mode];
  const double complex s = of->re_1_s + of->im_rad_s * I;
  double complex f[VS_MOST_DOF], sum = 0, norm = 0;
  for (int i = 0; i < m->dof; i++) f[i] = of->shape_re[i] + of->shape_im[i] * I;
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++) {
      const double complex both = s * m->mass[i][j] + m->damping[i][j];
      sum += f[i] * (both * q0[j] + m->mass[i][j] * v0[j]);
      norm += f[i] * (both + s * m->mass[i][j]) * f[j];
    }
  g->s[mode] = s;
  for (int i = 0; i < m->dof; i++) g->share[mode][i] = f[i] * (sum / norm);
}

/* Does the sum give the state back? */
static bool gives_back(const free_motion *g, const double *q0, const double *v0) {
  const vs_model *m = g->model;
  for (int i = 0; i < m->dof; i++) {
    double complex q = -q0[i], v = -v0[i];
    double most_q = 0, most_v = 0;
    for (int k = 0; k < 2 * m->dof; k++) {
      const double complex rate = g->s[k] * g->share[k][i];
      q += g->share[k][i];
      v += rate;
      most_q += cabs(g->share[k][i]);
      most_v += cabs(rate);
    }
    if (!(cabs(q) <= MISSED * most_q) || !(cabs(v) <= MISSED * most_v)) return false;
  }
  return true;
}

/* Finds the shares of the modes in the motion that begins at the knot, without flux and outside of
 * all stops. Returns false where there is no such sum that gives the knot's state back: two modes
 * are alike, B couples what K does not, or constant forces push where no spring holds. */
static bool make_free_swing(const vs_model *m, const vs_knot *knot, free_motion *g) {
  double q0[VS_MOST_DOF];
  const double *v0 = knot->x + m->dof;
  g->model = m;
  g->began_s = knot->t_s;
  if (!find_middle(m, g->middle)) return false;
  for (int i = 0; i < m->dof; i++) q0[i] = knot->x[i] - g->middle[i];
  for (int k = 0; k < 2 * m->dof; k++) find_share(g, k, q0, v0);
  return gives_back(g, q0, v0);
}

/* Fills what holds of the motion from from_s to to_s. */
static void rest_of_free_swing(const free_motion *g, double from_s, double to_s,
                               vs_swing_rest *rest) {
  const vs_model *m = g->model;
  *rest = (vs_swing_rest){.from_s = from_s, .to_s = to_s};
  rest->travel.middle = vs_mechanics_travel(m, g->middle);
  for (int i = 0; i < m->dof; i++) rest->q[i].middle = g->middle[i];
  for (int k = 0; k < 2 * m->dof; k++) {
    const double rate = creal(g->s[k]), size = cabs(g->s[k]);
    const double left = exp(rate * ((rate > 0 ? to_s : from_s) - g->began_s)) * WIDER;
    double complex travel = 0;
    for (int i = 0; i < m->dof; i++) {
      const double way = left * cabs(g->share[k][i]);
      travel += m->along[i] * g->share[k][i];
      rest->q[i].way += way;
      rest->rate2[i] += size * size * way;
    }
    rest->travel.way += left * cabs(travel);
  }
}

/* Returns true if the rest may be left out as far as the tier goes: the armature cannot come near a
 * stop or the poles, and the coil's law takes any gap. */
static bool free_swing_is_clear(const free_motion *g, const vs_swing_rest *rest) {
  const vs_model *m = g->model;
  const double least = rest->travel.middle - rest->travel.way,
               most = rest->travel.middle + rest->travel.way;
  if (m->coil.law->beyond) return false;
  if (m->coil.law->poles && least <= -m->actuator.gap_m) return false;
  return vs_stops_nearness(&m->stops, least) < 1 && vs_stops_nearness(&m->stops, most) < 1;
}

/* (exp(x) - 1)/x */
static double complex mean_growth(double complex x) {
  if (cabs(x) < 1e-3) return 1 + x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5)));
  return (cexp(x) - 1) / x;
}

/* q' = sum of w exp(s t), w being s share exp(s from), and the integral of each product follows:
 *   int q'.B q' = h sum over k, l of w_k.B w_l (exp(x) - 1)/x,  x = (s_k + s_l) h */
static double free_swing_loss(const free_motion *g, double from_s, double to_s) {
  const vs_model *m = g->model;
  const double h = to_s - from_s;
  double complex w[VS_MOST_STATES][VS_MOST_DOF];
  double lost = 0;
  for (int k = 0; k < 2 * m->dof; k++) {
    const double complex now = g->s[k] * cexp(g->s[k] * (from_s - g->began_s));
    for (int i = 0; i < m->dof; i++) w[k][i] = now * g->share[k][i];
  }
  for (int k = 0; k < 2 * m->dof; k++)
    for (int l = 0; l <= k; l++) {
      double complex form = 0;
      for (int i = 0; i < m->dof; i++)
        for (int j = 0; j < m->dof; j++)
          if (m->damping[i][j] != 0) form += w[k][i] * m->damping[i][j] * w[l][j];
      lost += (l < k ? 2 : 1) * h * creal(form * mean_growth((g->s[k] + g->s[l]) * h));
    }
  return lost;
}

/* ---- stretches of motion ---- */

/* Time is kept relative to an instant at which local time began, so that it is as fine after hours
 * as at first. "What is large" is the size of each quantity in vs_driven, to which errors are
 * relative. */
typedef struct phases {
  const vs_setup *setup;
  const vs_observer *observer;
  const vs_early_end *early_end; /* NULL: all steps are needed */
  vs_frame frame;                /* its model is the one in effect, as events may change the load */
  size_t loads;                  /* how many of these changes are behind */
  vs_knot knots[2]; /* the last accepted one is knots[now], the one to come the other */
  int now;
  vs_driven driven;          /* what drives the machine from the last knot on */
  bool valve;                /* a thyristor stands between mains and coil */
  bool disturbed;            /* the scene has events */
  double jams_s;             /* when the armature jams; INFINITY: never */
  double began_s;            /* where local time began, and with it the mains' wave */
  double since_s;            /* local time of the last knot */
  double largest_wb;         /* |lambda| at any knot so far; kept where disturbed */
  double longest_s;          /* longest step, free */
  double longest_driven_s;   /* conducting */
  double longest_fading_s;   /* while eddy currents keep a flux */
  double longest_touching_s; /* in the stop */
  double rough;              /* by how much dense output may be off, relative to what is large */
  double negligible;         /* how much a series may leave out, relative to what is large */
  vs_propagator propagator;  /* for steps of longest_s */
  vs_propagator_memo *memo;  /* the order's */
  const vs_warming *warming; /* likewise */
  vs_taylor series;          /* from the last knot on */
  bool by_series;            /* the series is Taylor's; else runge_kutta.c makes it */
  vs_runge_kutta general;
} phases;

/* The polynomial of degree seven between two knots is off by (w h)^8/10321920 at most, w being the
 * fastest mode's, or by a 256th of the series' eighth term: the remainder of Hermite's
 * interpolation, (h/2)^8/8! of the eighth derivative. Relative to what is large it may be off by
 * ROUGH of run.tolerance, and never by more than ROUGHEST, with which the books of energy, which
 * are kept on the dense output, close to 1e-9 of the work. Eddy currents die away within a part of
 * a conduction, and steps would be half as long: there the books close to 1e-7. A series leaves out
 * a thousandth of that or, with eddy currents, whose errors die away with them, a twentieth. */
static const double DENSE = 10321920, ROUGH = 0.05, ROUGHEST = 5e-11, ROUGHEST_EDDY = 2e-8,
                    LEFT_OUT = 1e-3, LEFT_OUT_EDDY = 0.05;

static const vs_model *model_of_run(const phases *p) {
  return p->frame.model;
}

static double longest_ideal_step(const phases *p, double radians, double fastest_rad_s) {
  const vs_run_values *run = &p->setup->run;
  double h = radians / fastest_rad_s;
  if (run->max_step_s > 0) h = fmin(h, run->max_step_s);
  return fmin(h, run->until_s / 4);
}

static vs_step next_ideal_step(const phases *p, vs_event event) {
  const vs_knot *to = &p->knots[1 - p->now];
  return (vs_step){.frame = p->driven.frame,
                   .from = &p->knots[p->now],
                   .to = to,
                   .held = p->driven.held,
                   .open = p->driven.fades,
                   .event = {event},
                   .event_s = {to->t_s}};
}

static vs_status show_ideal_step(phases *p, const vs_step *step, vs_error *err) {
  p->now = 1 - p->now;
  return p->observer->accept(p->observer->ctx, step, err);
}

static vs_status show_next_knot(phases *p, vs_event event, vs_error *err) {
  const vs_step step = next_ideal_step(p, event);
  return show_ideal_step(p, &step, err);
}

/* A conduction begins. What is large for lambda is then what u builds up until it falls or changes,
 * or what lambda was before, if that is more. */
static void rescale_flux(phases *p, double t_s) {
  if (!p->valve) return; /* as vs_driven_find_large has it */
  p->driven.flux_wb = fmax(vs_driven_built_up(&p->driven, t_s), p->largest_wb);
  vs_driven_find_coordinates(&p->driven);
}

/* Fills the knot to come, `since_s` of local time on, from y. */
static void fill_next_knot(phases *p, double since_s, const double y[VS_CONDUCTING]) {
  vs_knot *k = &p->knots[1 - p->now];
  k->t_s = p->began_s + since_s;
  memcpy(k->x, y, 2 * (size_t)p->driven.frame->model->dof * sizeof *y);
  k->flux_wb = y[VS_FLUX];
  for (int n = 0; n < p->driven.frame->model->coil.rungs; n++) k->psi_wb[n] = y[VS_PSI + n];
  vs_driven_fill(&p->driven, since_s, k);
}

/* Relative to what is large: a flux linkage that 0 V would let die away for ever, and one that eddy
 * currents keep no more, which is half of ROUGHEST_EDDY. */
static const double OVER = 1e-9, FADED = 1e-8;

static bool is_faded(const phases *p, const vs_knot *k) {
  double most = fabs(k->flux_wb);
  for (int n = 0; n < VS_MOST_RUNGS; n++) most = fmax(most, fabs(k->psi_wb[n]));
  return most <= FADED * p->driven.flux_wb;
}

/* The flux linkage at which nothing flows in the coil, where it follows from the secondaries': by
 * Newton's iteration on i = 0. With one that has no leakage it is what the knot has. */
static double still_flux(const phases *p, const vs_knot *k) {
  const vs_coil *c = &p->driven.frame->model->coil;
  double z = p->frame.gap_at_rest ? c->gap_rest_m : vs_mechanics_gap(p->driven.frame->model, k->x);
  double flux = k->flux_wb, by = INFINITY;
  for (int n = 0; n < 50 && c->core_s == 0 && fabs(by) > 1e-16 * fabs(flux); n++) {
    vs_law_rates law = vs_coil_rates(c, flux, 1, z, 0);
    by = (law.i_a + vs_coil_rungs_current(c, flux, k->psi_wb)) / (law.i_rate_a_s + c->leak_1_h);
    flux -= by;
  }
  return flux;
}

/* Something changed at the last knot: it is shown from its other side too, as a step of no length.
 * Local time begins anew, and the mains' wave with it, unless a conduction goes on undisturbed. */
static vs_status change_phase(phases *p, bool conducting, unsigned touched, vs_event event,
                              vs_error *err) {
  const vs_model *m = p->driven.frame->model;
  double y[VS_CONDUCTING];
  const vs_knot *k = &p->knots[p->now];
  memcpy(y, k->x, 2 * (size_t)m->dof * sizeof *y);
  const bool fades = m->coil.eddies && !conducting && !is_faded(p, k);
  y[VS_FLUX] = conducting || fades ? k->flux_wb : 0;
  if (p->driven.fades && conducting) y[VS_FLUX] = still_flux(p, k);
  for (int n = 0; n < VS_MOST_RUNGS; n++) y[VS_PSI + n] = conducting || fades ? k->psi_wb[n] : 0;
  if (p->warming && conducting && !p->driven.conducting) {
    vs_coil *coil = &p->warming->model->coil;
    coil->resistance_ohm =
        vs_winding_ohm(&m->actuator.winding, coil->cold_ohm, p->warming->heat->winding_degc);
  }
  if (!p->driven.conducting || !conducting || p->disturbed) {
    p->began_s = k->t_s;
    p->since_s = 0;
    vs_wave_of(p->driven.frame->timeline, k->t_s, &p->driven.mains);
    if (p->disturbed && conducting && !p->driven.conducting) rescale_flux(p, k->t_s);
  }
  p->driven.conducting = conducting;
  p->driven.fades = fades;
  p->driven.touched = touched;
  vs_runge_kutta_restart(&p->general);
  if (event == VS_EV_JAMS) { /* the blow */
    p->driven.held = true;
    vs_mechanics_hold(m, y + m->dof);
  }
  fill_next_knot(p, p->since_s, y);
  return show_next_knot(p, event, err);
}

/* The step to the knot to come. */
static vs_taken step_to_next_knot(const phases *p) {
  return (vs_taken){.driven = &p->driven,
                    .series = &p->series,
                    .from = &p->knots[p->now],
                    .to = &p->knots[1 - p->now],
                    .valve = p->valve,
                    .disturbed = p->disturbed};
}

/* ---- anything at all, by Taylor series or by steps ---- */

static void make_series(phases *p, double span_s) {
  p->driven.since_s = p->since_s;
  vs_taylor_make(&p->driven, &p->knots[p->now], span_s, &p->series);
}

/* By which factor the books of energy ask lambda to be better than `rough` says. The voltage of
 * harmonics, whose product with the current the books take, is larger than their share in lambda,
 * by as much as they are faster than the mains. And a jammed machine does no work, so that the
 * books are held against a hundredth of what is drawn (measure/energy.h). */
static double books_factor(const phases *p) {
  if (!p->disturbed || !p->driven.conducting) return 1;
  double fastest = p->driven.mains.highest_rad_s;
  double slower = fastest > 0 ? p->setup->timeline.omega_rad_s / fastest : 1;
  return slower * (p->driven.held ? 0.01 : 1);
}

/* Returns how far the series may be used, s: its last term must be negligible there, and its term
 * of degree eight within what dense output may be off by. A neighbour of each counts too, as one
 * term alone may vanish. */
static double reach_of_series(const phases *p, const vs_taylor *s) {
  enum { EIGHTH = 8, LAST = VS_SERIES_ORDER };
  _Static_assert(EIGHTH + 1 <= LAST, "the series has the terms that dense output is judged by");
  double rough = p->rough * books_factor(p);
  double dense =
      fmax(vs_taylor_term(&p->driven, s, EIGHTH), vs_taylor_term(&p->driven, s, EIGHTH + 1));
  double last = fmax(vs_taylor_term(&p->driven, s, LAST - 1), vs_taylor_term(&p->driven, s, LAST));
  double r = fmin(pow(256 * rough / dense, 1.0 / EIGHTH), pow(p->negligible / last, 1.0 / LAST));
  return fmin(r, 1) * s->span_s;
}

/* Has lambda died away, and do the mains keep it at 0? */
static bool conduction_is_over(phases *p) {
  double flux = fabs(p->knots[1 - p->now].flux_wb);
  if (!p->disturbed || !p->driven.conducting || !p->valve) return false;
  p->largest_wb = fmax(p->largest_wb, flux);
  return flux <= OVER * p->largest_wb && vs_wave_is_silent(&p->driven.mains);
}

static double longest_by_series(const phases *p) {
  double longest = p->driven.touched      ? p->longest_touching_s
                   : p->driven.conducting ? p->longest_driven_s
                   : p->driven.fades      ? p->longest_fading_s
                                          : p->longest_s;
  if (p->disturbed && p->driven.conducting)
    longest = fmin(longest, 1 / p->driven.mains.highest_rad_s); /* INFINITY: direct */
  return longest;
}

/* Makes the series from the last knot for any model. Returns how far it may be used, s; 0: no step
 * is short enough. */
static double make_motion(phases *p, double left_s) {
  if (!p->by_series) {
    p->driven.since_s = p->since_s;
    return vs_runge_kutta_make(&p->general, &p->driven, &p->knots[p->now],
                               fmin(longest_by_series(p), left_s), p->rough * books_factor(p),
                               &p->series);
  }
  make_series(p, longest_by_series(p));
  return reach_of_series(p, &p->series);
}

/* Makes the series from the last knot, and returns the length of the step to go by it, s, where
 * `left_s` remain. Returns 0 where no step is short enough. */
static double choose_length(phases *p, double left_s) {
  double length = make_motion(p, left_s);
  if (!(length > 1e-15 * (p->since_s + left_s))) return 0;
  /* a knot near the largest flux, however short the conduction */
  double turn = p->driven.conducting && p->since_s == 0
                    ? vs_driven_mains_turn(&p->driven, p->disturbed, length)
                    : 0;
  if (turn > 0) length = fmin(length, turn);
  if (length >= left_s) return left_s;
  return 2 * length > left_s ? left_s / 2 : length;
}

/* Fills the knot to come, *length on by the series or where a crossing comes first; *length becomes
 * the time to it. */
static vs_crossing go_by_series(phases *p, double *length) {
  double y[VS_CONDUCTING];
  vs_taylor_at(&p->series, *length, y);
  fill_next_knot(p, p->since_s + *length, y);
  const vs_taken step = step_to_next_knot(p);
  vs_crossing e = find_crossing(&step, length);
  if (e.kind == VS_GOES_ON)
    return (vs_crossing){conduction_is_over(p) ? VS_FLUX_ENDS : VS_GOES_ON, 0};
  vs_taylor_at(&p->series, *length, y);
  fill_next_knot(p, p->since_s + *length, y);
  return e;
}

/* While eddy currents keep a flux the thyristor has u - dlambda/dt. Its firing is looked for where
 * u alone is positive (engine/gate.h), so that a run in which the two differ ends here: where it is
 * to fire at the last knot and has no forward voltage, or had some before, under a gate pulse; and
 * where it has some at a knot on the way. A millionth of the mains' peak moves a firing by a
 * microradian. */
static vs_status look_at_fading(const phases *p, bool fires, vs_error *err) {
  static const double UNSEEN = 1e-6;
  const vs_knot *k = &p->knots[p->now];
  const vs_timeline *line = &p->setup->timeline;
  if (!p->driven.fades || !p->valve) return VS_OK;
  const bool on = vs_gate_is_on(line, 0, k->t_s);
  if (!fires && !on) return VS_OK;
  const double u = vs_timeline_voltage(line, k->t_s), v = k->flux_rate_v,
               more = UNSEEN * line->peak_v;
  const bool forward = on && u > v + more;
  if (fires ? u >= v - more && !(forward && u <= more) : !forward) return VS_OK;
  return vs_fail(err, VS_RUN,
                 "t = %.9g s: eddy currents hold the coil at %.3g V while the mains have %.3g V, "
                 "and the ideal thyristor's firing follows the mains alone; take run.tier: %s",
                 k->t_s, v, u, vs_compiled_tier.name);
}

/* Goes by series until end_s, or until the thyristor goes out, or the armature meets or leaves its
 * stop. */
static vs_status drive_until(phases *p, double end_s, vs_error *err) {
  static const vs_event EVENT[] = {[VS_GOES_ON] = VS_EV_NONE,
                                   [VS_FLUX_ENDS] = VS_EV_EXTINCT,
                                   [VS_CONTACT_BEGINS] = VS_EV_MEETS_STOP,
                                   [VS_CONTACT_ENDS] = VS_EV_LEAVES_STOP};
  double end = end_s - p->began_s;
  while (p->since_s < end) {
    double left = end - p->since_s, length = choose_length(p, left);
    if (!(length > 0))
      return vs_fail(err, VS_RUN, "t = %.9g s: no step is short enough", p->knots[p->now].t_s);
    vs_crossing e = go_by_series(p, &length);
    bool done = length == left;
    p->since_s += length;
    if (done) p->knots[1 - p->now].t_s = end_s;
    vs_status status = show_next_knot(p, EVENT[e.kind], err);
    if (!status && !done && p->driven.fades) status = look_at_fading(p, false, err);
    if (status || (done && e.kind == VS_GOES_ON)) return status;
    if (e.kind == VS_GOES_ON && !(p->driven.fades && is_faded(p, &p->knots[p->now]))) continue;
    bool conducting = p->driven.conducting && e.kind != VS_FLUX_ENDS;
    bool of_flux = e.kind == VS_FLUX_ENDS || e.kind == VS_GOES_ON;
    unsigned touched = p->driven.touched ^ (of_flux ? 0 : 1u << e.stop);
    return change_phase(p, conducting, touched, VS_EV_NONE, err);
  }
  return VS_OK;
}

/* ---- free and off ---- */

/* So many steps of a free swing lie between two offers to leave out its rest. */
enum { OFFERS = 16 };

/* Does the observer leave the rest of the swing out? glide: the swing by its modes; NULL: there is
 * nothing to offer. */
static bool rest_is_not_needed(const phases *p, const free_motion *glide, double end_s) {
  vs_swing_rest rest;
  if (!glide) return false;
  rest_of_free_swing(glide, p->knots[p->now].t_s, end_s, &rest);
  return free_swing_is_clear(glide, &rest) && p->early_end->leaves(p->early_end->ctx, &rest);
}

static vs_status show_free_swing(phases *p, const free_motion *glide, vs_error *err) {
  vs_step step = next_ideal_step(p, VS_EV_NONE);
  step.glides = true;
  step.lost_j = free_swing_loss(glide, step.from->t_s, step.to->t_s);
  return show_ideal_step(p, &step, err);
}

/* Goes by the propagator, in steps of longest_s, of which one or more are left over at the end.
 * Where the armature is about to meet its stop, goes on by series. A swing that lasts to the run's
 * end is offered to the observer, who may leave out its rest. */
static vs_status swing_until(phases *p, double end_s, vs_error *err) {
  double began = p->since_s, n = floor((end_s - p->knots[p->now].t_s) / p->longest_s) - 1;
  double y[VS_CONDUCTING] = {0}, steps;
  vs_status status = VS_OK;
  free_motion modes, *glide = p->early_end && end_s == p->setup->run.until_s ? &modes : NULL;
  if (glide && (p->disturbed || !make_free_swing(model_of_run(p), &p->knots[p->now], glide)))
    glide = NULL;
  for (double k = 0; k < n && !status; k += steps) {
    const bool left = fmod(k, OFFERS) == 0 && n > k + 1 && rest_is_not_needed(p, glide, end_s);
    steps = left ? n - k : 1;
    double since = began + (k + steps) * p->longest_s;
    vs_propagator_leap(&p->propagator, steps, p->knots[p->now].x, y);
    fill_next_knot(p, since, y);
    const vs_taken step = step_to_next_knot(p);
    if (!left && crossing_meets(&step)) return drive_until(p, end_s, err);
    p->since_s = since;
    status = left ? show_free_swing(p, glide, err) : show_next_knot(p, VS_EV_NONE, err);
  }
  return status;
}

/* Goes on to end_s, by the propagator or by series, and may come back before it. */
static vs_status run_until(phases *p, double end_s, vs_error *err) {
  bool swings = !p->driven.conducting && !p->driven.fades && !p->driven.touched;
  if (swings && end_s - p->knots[p->now].t_s >= 2 * p->longest_s) return swing_until(p, end_s, err);
  return drive_until(p, end_s, err);
}

/* Sets what follows from the model in effect: how long steps may be, and the propagator. */
static void find_steps(phases *p) {
  const vs_model *m = model_of_run(p);
  double mains = p->setup->timeline.omega_rad_s;
  double coil = m->coil.square ? m->coil.resistance_ohm * m->coil.gap_rest_m / (2 * m->coil.a_hm)
                               : m->coil.resistance_ohm / m->coil.rest_h;
  p->longest_s = longest_ideal_step(p, pow(DENSE * 6 * p->rough, 1.0 / 8), m->fastest_rad_s);
  const double slower = fmax(fmax(m->fastest_rad_s, mains), coil / 8);
  p->longest_fading_s = longest_ideal_step(p, 1, slower);
  for (int n = 0; n < m->coil.rungs; n++) coil = fmax(coil, m->coil.rung[n].rate_1_s);
  p->longest_driven_s = longest_ideal_step(p, 1, fmax(slower, coil / 8));
  if (!p->by_series || m->coil.rungs + (m->coil.core_s > 0) > 1)
    p->longest_fading_s = p->longest_driven_s;
  /* runge_kutta.c finds its own, and a stop of any kind has no one bound that is worth much */
  p->longest_touching_s =
      p->by_series ? fmin(longest_ideal_step(p, 1, m->contact_rad_s), p->longest_driven_s)
                   : p->longest_driven_s;
  vs_propagator_recall(&p->propagator, p->memo, m, p->driven.held, p->longest_s);
}

/* ---- all of it ---- */

/* The load changes at the last knot: q, q' and lambda go on as they are, with another M. */
static vs_status change_load_of_phase(phases *p, vs_error *err) {
  p->frame.model = &p->setup->loads.item[p->loads++].model;
  vs_driven_find_coordinates(&p->driven);
  find_steps(p);
  return change_phase(p, p->driven.conducting, p->driven.touched, VS_EV_LOADS, err);
}

/* Goes on to end_s in a scene with events. Stops where the armature jams, where the load changes,
 * and, while current flows, where other sines of the mains begin; goes on with these. */
static vs_status run_disturbed_until(phases *p, double end_s, vs_error *err) {
  const vs_timeline *line = &p->setup->timeline;
  double t = p->knots[p->now].t_s, edge = INFINITY,
         loads = vs_setup_load_at(&p->setup->loads, p->loads);
  if (!p->driven.held && t >= p->jams_s) {
    vs_status status = change_phase(p, p->driven.conducting, p->driven.touched, VS_EV_JAMS, err);
    vs_propagator_make(&p->propagator, model_of_run(p), true, p->longest_s);
    return status;
  }
  if (t >= loads) return change_load_of_phase(p, err);
  if (p->driven.conducting) edge = vs_wave_edge(line, t);
  double jams = p->driven.held ? INFINITY : p->jams_s;
  vs_status status = run_until(p, fmin(fmin(fmin(end_s, edge), jams), loads), err);
  if (status || !p->driven.conducting || p->knots[p->now].t_s < edge) return status;
  return change_phase(p, true, p->driven.touched, VS_EV_NONE, err);
}

/* A run that begins on an orbit may begin with a flux that eddy currents keep. */
static void begin_fading(phases *p) {
  vs_knot *k = &p->knots[0];
  const vs_coil *c = &model_of_run(p)->coil;
  p->driven.fades = p->valve && c->eddies && !is_faded(p, k);
  if (!p->driven.fades) return;
  k->flux_wb = still_flux(p, k);
  vs_driven_fill(&p->driven, 0, k);
}

static double next_firing(const phases *p, double t_s) {
  const vs_timeline *line = &p->setup->timeline;
  if (p->driven.conducting) return INFINITY;
  if (!p->valve) return 0; /* it conducts from the beginning */
  return p->disturbed ? vs_wave_conduction(line, t_s, p->setup->run.until_s)
                      : vs_gate_next_conduction(line, t_s);
}

const vs_tier_key vs_phases_keys[] = {
    {"supply", "kind", "step"}, {"firing", "valve", "none"}, {NULL, NULL, NULL}};

vs_status vs_phases_run(const vs_setup *setup, const vs_run_order *order, const vs_frame *frame,
                        const vs_observer *observer, vs_error *err) {
  const vs_model *m = &setup->model;
  double until = setup->run.until_s, tolerance = setup->run.tolerance, fired_s = -INFINITY;
  phases p = {.setup = setup,
              .observer = observer,
              .early_end = order ? order->early_end : NULL,
              .memo = order ? order->memo : NULL,
              .warming = order ? order->warming : NULL,
              .frame = *frame,
              .rough = fmin(ROUGH * tolerance, m->coil.eddies ? ROUGHEST_EDDY : ROUGHEST)};
  p.negligible = (m->coil.eddies ? LEFT_OUT_EDDY : LEFT_OUT) * p.rough;
  p.valve = !setup->timeline.firing.no_valve;
  p.by_series = m->plain && !setup->timeline.supply.direct;
  p.disturbed = setup->timeline.events.count > 0;
  p.jams_s = vs_setup_jams(setup);
  if (p.warming) p.frame.model = p.warming->model;
  p.driven = (vs_driven){.frame = &p.frame};
  p.knots[0] = vs_sim_start(setup, &p.frame);
  p.driven.touched = vs_stops_touched(&m->stops, vs_mechanics_travel(m, p.knots[0].x));
  vs_driven_find_large(&p.driven, p.valve);
  find_steps(&p);
  vs_runge_kutta_begin(&p.general, m);
  begin_fading(&p);
  vs_status status = vs_sim_refuse_endless(setup, p.longest_touching_s, err);
  while (!status && p.knots[p.now].t_s < until) {
    double t = p.knots[p.now].t_s, fires = next_firing(&p, t), end = fmin(fires, until);
    double known = p.valve ? vs_firing_known_s(&setup->timeline) : INFINITY;
    assert(known > t); /* whoever decides was shown the step that ends here */
    end = fmin(end, known);
    /* A firing is met to rounding. In a scene with events it is met to the bit, as the mains may be
     * others just before. */
    if (fires <= t + (p.disturbed ? 0 : 1e-10 * setup->timeline.period_s)) {
      status = look_at_fading(&p, true, err);
      if (!status && m->coil.eddies && t - fired_s <= 1e-12 * setup->timeline.period_s)
        status =
            vs_fail(err, VS_RUN, "t = %.9g s: eddy currents put the thyristor out as it fires", t);
      fired_s = t;
      if (!status)
        status = change_phase(&p, true, p.driven.touched, p.valve ? VS_EV_FIRES : VS_EV_NONE, err);
    } else
      status = p.disturbed ? run_disturbed_until(&p, end, err) : run_until(&p, end, err);
  }
  vs_runge_kutta_end(&p.general);
  return status;
}
