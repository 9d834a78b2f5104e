/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/quiet.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine/actuator.h"

enum { PER_CYCLE = 200, LOOKS_PER_CYCLE = 4 };

/* Of run.tolerance, for having left the circuit; how much worse than in the cycle in which it was
 * looked at the one-port may be later; what the integration without the solver may cost; and of
 * run.tolerance, by how much a run that stays differs from itself. */
static const double SHARE = 0.75, SAFETY = 5, INTEGRATION = 1e-7, ITS_OWN = 1e-3;

/* By how many run.tolerance of its peak one of the deck's signals may be wrong, or of 1 V or 0.1 A,
 * which is what the solver tells apart; how many times that it may drift to the end, as a fuse's
 * integral does (a store may not at all: its current would go on changing). */
static const double SIGNAL_SHARE = 3, LEAST_V = 1, LEAST_A = 0.1, MOST_DRIFT = 100;

struct vs_quiet {
  const vs_setup *setup;
  const vs_frame *frame;
  vs_mode modes[VS_STATES];
  gsl_matrix_complex *vectors; /* of the modes, (shape, s shape), decomposed */
  gsl_permutation *order;
  gsl_vector_complex *share;
  vs_seen *kept; /* a ring: first, count */
  size_t first, count;
  const vs_seen *seen[VS_MOST_SEEN]; /* the same in order, while it is looked at them */
  vs_coil coil[VS_MOST_SEEN];        /* what the one-port says of them */
  vs_seen last;                      /* knot taken, also when it is not kept */
  bool any;
  double looked_s, blocks_s; /* when it was last looked, and since when the thyristor blocks */
  double bound_before[2];    /* with either law, when it was last looked; infinite: not yet */
  double carried[VS_STATES], carried_s; /* each mode's error of having left before; as of then */
  double peak_x[VS_DOF], peak_force_n, peak_a, peak_signal[VS_SIGNALS];
  vs_oneport *port;
};

static size_t n_signals(const vs_quiet *q) {
  return q->frame->deck->n_terms + 1;
}

static vs_seen *kept_at(const vs_quiet *q, size_t k) {
  return &q->kept[(q->first + k) % VS_MOST_SEEN];
}

/* ---- what was seen ---- */

static void take_peaks(vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  for (int n = 0; n < VS_DOF; n++) q->peak_x[n] = fmax(q->peak_x[n], fabs(k->x[n]));
  q->peak_force_n = fmax(q->peak_force_n, vs_force(m, k->flux_wb));
  q->peak_a = fmax(q->peak_a, fabs(vs_knot_current(m, k)));
  for (size_t n = 0; n < n_signals(q); n++)
    q->peak_signal[n] = fmax(q->peak_signal[n], fabs(vs_knot_signal(q->frame, k, n)));
}

/* The integral of i by its values and slopes at both ends of a step, and of v = R i + dlambda/dt.
 */
static void integrate_port(vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  const vs_knot *from = &q->last.knot;
  double h = k->t_s - from->t_s,
         charge = h / 2 * (vs_knot_current(m, from) + vs_knot_current(m, k)) -
                  h * h / 12 * (vs_knot_current_rate(m, k) - vs_knot_current_rate(m, from));
  q->last.charge_c += charge;
  q->last.flux_in_wb += m->actuator.resistance_ohm * charge + k->flux_wb - from->flux_wb;
}

void vs_quiet_restart(vs_quiet *q) {
  q->any = false;
  q->count = 0;
  q->bound_before[0] = q->bound_before[1] = INFINITY;
}

void vs_quiet_take(vs_quiet *q, const vs_knot *k, bool blocks) {
  double period = q->setup->timeline.period_s;
  if (q->any) integrate_port(q, k);
  vs_knot_copy(q->frame, k, &q->last.knot);
  q->any = true;
  take_peaks(q, k);
  if (!blocks) {
    vs_quiet_restart(q);
    q->looked_s = q->blocks_s = k->t_s;
    return;
  }
  if (q->count && k->t_s < kept_at(q, q->count - 1)->knot.t_s + period / PER_CYCLE) return;
  while (q->count && (q->count == VS_MOST_SEEN || kept_at(q, 0)->knot.t_s < k->t_s - period)) {
    q->first = (q->first + 1) % VS_MOST_SEEN;
    q->count--;
  }
  *kept_at(q, q->count++) = q->last;
}

/* ---- the one-port beside the solver ---- */

/* By how much it is wrong over what was seen, from the state at the first. */
typedef struct misfit {
  double force_n, current_a, signal[VS_SIGNALS];
  double mode[VS_STATES]; /* largest share of each mode in the error of q, as vs_mode's shape */
} misfit;

static double electric_bound(const vs_quiet *q, const misfit *wrong) {
  return SAFETY * fmax(wrong->force_n / q->peak_force_n, wrong->current_a / q->peak_a);
}

/* |shares| of the modes in x: V^-1 x, V's columns (shape, s shape). */
static void shares(const vs_quiet *q, const double x[VS_STATES], double share[VS_STATES]) {
  for (size_t n = 0; n < VS_STATES; n++)
    gsl_vector_complex_set(q->share, n, gsl_complex_rect(x[n], 0));
  gsl_linalg_complex_LU_svx(q->vectors, q->order, q->share);
  for (size_t n = 0; n < VS_STATES; n++)
    share[n] = gsl_complex_abs(gsl_vector_complex_get(q->share, n));
}

/* Up to where force or current are wrong by more than that; then false. */
static bool compare(vs_quiet *q, double most, misfit *wrong) {
  const vs_model *m = &q->setup->model;
  double y[VS_ONEPORT_STATES];
  *wrong = (misfit){0};
  vs_oneport_state(&q->seen[0]->knot, y);
  for (size_t k = 0; k < q->count; k++) {
    const vs_knot *seen = &q->seen[k]->knot;
    if (k && !vs_oneport_advance(q->port, q->seen[k - 1]->knot.t_s, seen->t_s, y)) return false;
    const vs_coil c = q->coil[k] = vs_oneport_coil(q->port, seen->t_s, y);
    double error[VS_STATES], share[VS_STATES];
    double force = vs_force(m, c.flux_wb) - vs_force(m, seen->flux_wb);
    wrong->force_n = fmax(wrong->force_n, fabs(force));
    wrong->current_a = fmax(wrong->current_a, fabs(c.i_a - vs_knot_current(m, seen)));
    if (!(electric_bound(q, wrong) <= most)) return false;
    for (int n = 0; n < VS_STATES; n++) error[n] = y[n] - seen->x[n];
    shares(q, error, share);
    for (int n = 0; n < VS_STATES; n++) wrong->mode[n] = fmax(wrong->mode[n], share[n]);
  }
  return true;
}

static void compare_signals(const vs_quiet *q, misfit *wrong) {
  double signal[VS_SIGNALS];
  for (size_t k = 0; k < q->count; k++) {
    const vs_knot *seen = &q->seen[k]->knot;
    vs_oneport_signals(q->port, seen->t_s, &q->coil[k], signal);
    for (size_t n = 0; n < n_signals(q); n++)
      wrong->signal[n] =
          fmax(wrong->signal[n], fabs(signal[n] - vs_knot_signal(q->frame, seen, n)));
  }
}

/* ---- what may come of it ---- */

enum { CYCLES_AHEAD = 10, STEPS_AHEAD = 100 };

/* What the one-port says of the cycles to come: its largest flux linkage in each, relative to what
 * was seen, as an error of the flux linkage makes one of the force in proportion to it; and how far
 * they lie beyond what it was fitted to. Ten cycles of 50 Hz hold the slowest beats of the mains
 * with a machine that is driven near its resonance. */
typedef struct outlook {
  double ratio[CYCLES_AHEAD];
  double reach; /* at least 1 */
} outlook;

/* What signal n may be wrong by. */
static double allowed(const vs_quiet *q, size_t n) {
  bool current = n + 1 == n_signals(q) || *q->frame->deck->terms[n].plus == 'i';
  return q->setup->run.tolerance *
         fmax(SIGNAL_SHARE * q->peak_signal[n], current ? LEAST_A : LEAST_V);
}

/* Where the signals and the EVA's voltage were. A law found in there says nothing of what lies
 * outside: there a diode may conduct that did not, or block. */
typedef struct range {
  double least[VS_SIGNALS + 1], most[VS_SIGNALS + 1]; /* the last one: of the EVA */
} range;

static void see_range(const vs_quiet *q, range *r) {
  size_t count = n_signals(q);
  for (size_t n = 0; n <= count; n++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t k = 0; k < q->count; k++) {
      const vs_knot *seen = &q->seen[k]->knot;
      double value = n < count ? vs_knot_signal(q->frame, seen, n) : seen->v_eva_v;
      least = fmin(least, value);
      most = fmax(most, value);
    }
    double slack = (most - least) / 2 + (n < count ? allowed(q, n) : 0); /* for the beat */
    bool drifts = n < count && vs_oneport_drift(q->port, n) != 0;
    r->least[n] = drifts ? -INFINITY : least - slack;
    r->most[n] = drifts ? INFINITY : most + slack;
  }
}

static bool in_range(const vs_quiet *q, const range *r, double t_s, const vs_coil *c) {
  double signal[VS_SIGNALS];
  size_t count = n_signals(q);
  vs_oneport_signals(q->port, t_s, c, signal);
  for (size_t n = 0; n < count; n++)
    if (!(signal[n] >= r->least[n] && signal[n] <= r->most[n])) return false;
  return c->v_v >= r->least[count] && c->v_v <= r->most[count];
}

/* Not beyond the end. */
static bool look_ahead(vs_quiet *q, double until_s, outlook *o) {
  double y[VS_ONEPORT_STATES], t = q->last.knot.t_s, now = 0;
  double h = q->setup->timeline.period_s / STEPS_AHEAD;
  for (size_t k = 0; k < q->count; k++) now = fmax(now, fabs(q->seen[k]->knot.flux_wb));
  range seen;
  see_range(q, &seen);
  vs_oneport_state(&q->last.knot, y);
  *o = (outlook){.reach = 1};
  for (int cycle = 0; cycle < CYCLES_AHEAD && t < until_s; cycle++)
    for (int n = 0; n < STEPS_AHEAD; n++, t += h) {
      if (!vs_oneport_advance(q->port, t, t + h, y)) return false;
      vs_coil c = vs_oneport_coil(q->port, t + h, y);
      if (!in_range(q, &seen, t + h, &c)) return false;
      o->ratio[cycle] = fmax(o->ratio[cycle], fabs(c.flux_wb) / now);
      o->reach = fmax(o->reach, vs_oneport_reach(q->port, t + h, &c));
    }
  return true;
}

/* How often the error a mode took in one cycle may be added up in so many. */
static double times_added(const outlook *o, const vs_mode *m, double cycles, double period_s) {
  double sum = 0, rest = cycles - CYCLES_AHEAD;
  for (int n = 0; n < CYCLES_AHEAD && n < cycles; n++) sum += o->ratio[n];
  if (isfinite(m->time_constant_s)) rest = fmin(rest, -1 / expm1(-period_s / m->time_constant_s));
  return o->reach * (sum + fmax(rest, 0) * o->ratio[CYCLES_AHEAD - 1]);
}

/* Each mode's error until_s: what it still has of having left before, and what it takes in a cycle,
 * added up in the same sense; ahead NULL: once. */
static void mode_errors(const vs_quiet *q, const misfit *wrong, const outlook *ahead,
                        double until_s, double error[VS_STATES]) {
  double period = q->setup->timeline.period_s, now = q->last.knot.t_s;
  for (size_t k = 0; k < VS_STATES; k++) {
    const vs_mode *m = &q->modes[k];
    double times = ahead ? times_added(ahead, m, (until_s - now) / period, period) : 1;
    error[k] =
        q->carried[k] * exp(m->re_1_s * (now - q->carried_s)) + SAFETY * wrong->mode[k] * times;
  }
}

/* Largest part of its peak by which p, u, w or phi is wrong with these errors. */
static double motion_bound(const vs_quiet *q, const double error[VS_STATES]) {
  double worst = 0;
  for (int n = 0; n < VS_DOF; n++) {
    double sum = 0;
    for (size_t k = 0; k < VS_STATES; k++)
      sum += hypot(q->modes[k].shape_re[n], q->modes[k].shape_im[n]) * error[k];
    worst = fmax(worst, sum / q->peak_x[n]);
  }
  return worst;
}

static bool in_a_store(const vs_quiet *q, size_t term) {
  const vs_accounts *stores = &q->frame->deck->stores;
  for (size_t k = 0; k < stores->count; k++)
    if (vs_formula_uses(&stores->item[k].formula, (int)term)) return true;
  return false;
}

/* Do the deck's signals do as they did, to the end? */
static bool signals_hold(const vs_quiet *q, const misfit *wrong, double until_s) {
  for (size_t n = 0; n < n_signals(q); n++) {
    double most = allowed(q, n);
    double drift = fabs(vs_oneport_drift(q->port, n)) * (until_s - q->last.knot.t_s);
    double times = n < q->frame->deck->n_terms && in_a_store(q, n) ? 1 : MOST_DRIFT;
    if (!(wrong->signal[n] <= most) || !(drift <= times * most)) return false;
  }
  return true;
}

/* The bound with that law, and each mode's error until_s; INFINITY: it is not to be gone by. What
 * costs most, the signals and the look ahead, comes last. */
static double bound_of(vs_quiet *q, bool dynamic, double until_s, double error[VS_STATES]) {
  double most = SHARE * q->setup->run.tolerance;
  misfit wrong;
  outlook ahead;
  if (!vs_oneport_fit(q->port, q->seen, q->count, dynamic)) return INFINITY;
  if (!compare(q, most, &wrong)) return INFINITY;
  mode_errors(q, &wrong, NULL, until_s, error);
  if (!(motion_bound(q, error) <= most)) return INFINITY;
  if (!vs_oneport_fit_signals(q->port, q->seen, q->count)) return INFINITY;
  compare_signals(q, &wrong);
  if (!signals_hold(q, &wrong, until_s) || !look_ahead(q, until_s, &ahead)) return INFINITY;
  mode_errors(q, &wrong, &ahead, until_s, error);
  return fmax(ahead.reach * electric_bound(q, &wrong), motion_bound(q, error));
}

/* Can the armature come to its stop, or to the pole cover, with the energy that is in the machine?
 * |p| <= sqrt(2 E (K^-1)_pp); a tenth more for what the force may do. */
static bool may_touch(const vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  double energy = vs_kinetic_energy(m, k->x) + vs_elastic_energy(m, k->x);
  double compliance = 1 / m->stiffness[P][P]; /* p is coupled to the others by mass alone */
  return 1.1 * sqrt(2 * energy * compliance) > m->actuator.gap_m;
}

bool vs_quiet_may_leave(vs_quiet *q, double until_s, double most_lag_s, double *bound) {
  double period = q->setup->timeline.period_s, now = q->last.knot.t_s;
  if (q->count < VS_LEAST_SEEN || kept_at(q, 0)->knot.t_s > now - 0.98 * period) return false;
  /* the less often, the longer it was in vain: a look may cost as much as some steps of the solver
   */
  double wait_s = fmax(period / LOOKS_PER_CYCLE, (now - q->blocks_s) / 16);
  if (now < q->looked_s + wait_s || until_s < now + period) return false;
  if (may_touch(q, &q->last.knot)) return false;
  q->looked_s = now;
  for (size_t k = 0; k < q->count; k++) q->seen[k] = kept_at(q, k);
  double error[VS_STATES];
  for (int dynamic = 1; dynamic >= 0; dynamic--) {
    double before = q->bound_before[dynamic], most = SHARE * q->setup->run.tolerance;
    q->bound_before[dynamic] = bound_of(q, dynamic, until_s, error);
    *bound =
        INTEGRATION + ITS_OWN * q->setup->run.tolerance + fmax(before, q->bound_before[dynamic]);
    if (vs_oneport_lag(q->port) > most_lag_s) continue;
    if (q->bound_before[dynamic] <= most && !(*bound <= most)) return false; /* at the next look */
    if (!(*bound <= most)) continue;
    memcpy(q->carried, error, sizeof error);
    q->carried_s = until_s;
    return true;
  }
  return false;
}

/* ---- going by it ---- */

vs_status vs_quiet_step(vs_quiet *q, vs_knot *k, double t_s, vs_error *err) {
  double y[VS_ONEPORT_STATES], signal[VS_SIGNALS];
  vs_oneport_state(k, y);
  if (!vs_oneport_advance(q->port, k->t_s, t_s, y))
    return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", t_s);
  vs_coil c = vs_oneport_coil(q->port, t_s, y);
  vs_oneport_signals(q->port, t_s, &c, signal);
  k->t_s = t_s;
  memcpy(k->x, y, sizeof k->x);
  k->flux_wb = c.flux_wb;
  k->flux_rate_v = c.flux_rate_v;
  k->flux_rate2_v_s = c.v_rate_v_s - q->setup->model.actuator.resistance_ohm * c.i_rate_a_s;
  k->v_eva_v = c.v_v;
  memcpy(k->terms, signal, (n_signals(q) - 1) * sizeof *signal);
  k->i_mains_a = signal[n_signals(q) - 1];
  vs_knot_complete(q->frame, k, false);
  return VS_OK;
}

double vs_quiet_capacitance(const vs_quiet *q) {
  return vs_oneport_capacitance(q->port);
}

double vs_quiet_missed(const vs_quiet *q, const vs_knot *one_port, const vs_knot *solver) {
  double worst = 0;
  for (size_t n = 0; n < n_signals(q); n++) {
    double off = vs_knot_signal(q->frame, solver, n) - vs_knot_signal(q->frame, one_port, n);
    if (vs_oneport_drift(q->port, n) != 0) continue; /* an integral: the solver's stood still */
    worst = fmax(worst, fabs(off) / allowed(q, n));
  }
  return worst;
}

/* (w h)^2/8 is what a straight line leaves of a sine. */
double vs_quiet_longest(const vs_quiet *q) {
  double h = sqrt(8 * q->setup->run.tolerance) / q->setup->timeline.omega_rad_s;
  return fmin(h, 0.15 / q->setup->model.fastest_rad_s);
}

static bool find_vectors(vs_quiet *q) {
  int sign;
  q->vectors = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  q->order = gsl_permutation_alloc(VS_STATES);
  q->share = gsl_vector_complex_alloc(VS_STATES);
  if (!vs_modes(&q->setup->model, q->modes)) return false;
  for (size_t k = 0; k < VS_STATES; k++)
    for (size_t n = 0; n < VS_DOF; n++) {
      const vs_mode *m = &q->modes[k];
      gsl_complex shape = gsl_complex_rect(m->shape_re[n], m->shape_im[n]);
      gsl_matrix_complex_set(q->vectors, n, k, shape);
      gsl_matrix_complex_set(q->vectors, VS_DOF + n, k,
                             gsl_complex_mul(gsl_complex_rect(m->re_1_s, m->im_rad_s), shape));
    }
  gsl_linalg_complex_LU_decomp(q->vectors, q->order, &sign);
  return gsl_complex_abs(gsl_linalg_complex_LU_det(q->vectors, sign)) > 0;
}

vs_quiet *vs_quiet_new(const vs_setup *setup, const vs_frame *frame) {
  vs_quiet *q = vs_alloc(1, sizeof *q);
  *q = (vs_quiet){.setup = setup, .frame = frame};
  q->kept = vs_alloc(VS_MOST_SEEN, sizeof *q->kept);
  q->port = vs_oneport_new(setup, frame);
  vs_quiet_restart(q);
  if (find_vectors(q)) return q;
  vs_quiet_free(q);
  return NULL;
}

void vs_quiet_free(vs_quiet *q) {
  if (!q) return;
  gsl_matrix_complex_free(q->vectors);
  gsl_permutation_free(q->order);
  gsl_vector_complex_free(q->share);
  vs_oneport_free(q->port);
  free(q->kept);
  free(q);
}
