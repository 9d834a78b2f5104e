/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/oneport.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "macromodel/fit.h"
#include "plant/coil.h"

/* Columns of the law, one for each of its numbers. The source is one sine: harmonics would take for
 * their own what the mains' beat with the machine makes, as one cycle cannot tell the two apart. */
enum {
  LAW_COSINE,
  LAW_SINE,
  LAW_MEAN,
  LAW_CONSTANT, /* of the integration; here end the columns of the source */
  LAW_G,
  LAW_C,
  LAW_TAU,
  LAW_COLUMNS
};
/* Columns of the static law, all of which are the source's. */
enum { STATIC_COSINE, STATIC_SINE, STATIC_MEAN, STATIC_COLUMNS };
_Static_assert(STATIC_COSINE == (int)LAW_COSINE && STATIC_SINE == (int)LAW_SINE &&
                   STATIC_MEAN == (int)LAW_MEAN,
               "find_law takes the source's numbers from the same places of either law");
/* Behind the columns of either law may stand one more, of a drift. */
enum { LAW_ROOM = LAW_COLUMNS + 1 };

_Static_assert(LAW_ROOM <= (int)VS_FIT_COLUMNS, "a fit has room for every column");

struct vs_oneport {
  const vs_setup *setup;
  const vs_frame *frame;
  bool dynamic;                /* false: the static law, i = i_N(t) */
  double cosine, sine, mean_a; /* of i_N, A; of the dynamic law the first two of its integral, C */
  double g_s, c_f, tau_s;
  vs_responses signals;
  double shape[LAW_COLUMNS][LAW_COLUMNS]; /* R of the dynamic law's fit, in its first `rank` rows
                                             and  columns */
  double scale[LAW_COLUMNS];              /* what each column of R was divided by */
  size_t column[LAW_COLUMNS];             /* which of the law's columns it is */
  size_t rank;
  double reach_seen; /* largest reach at the knots of the fit, to which others are relative */
  double substep_s;  /* longest one of the integration */
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
};

double vs_oneport_knot_current(const vs_model *m, const vs_knot *k) {
  return vs_coil_current(&m->coil, k->flux_wb, vs_mechanics_gap(m, k->x));
}

double vs_oneport_knot_current_rate(const vs_model *m, const vs_knot *k) {
  return vs_coil_rates(&m->coil, k->flux_wb, k->flux_rate_v, vs_mechanics_gap(m, k->x),
                       vs_mechanics_travel(m, k->x + m->dof))
      .i_rate_a_s;
}

/* Returns i_N at t_s, A. *rate is its rate, A/s, of the static law; of the dynamic law it has no
 * meaning to the caller. */
static double source_current(const vs_oneport *o, double t_s, double *rate) {
  double w = o->setup->timeline.omega_rad_s, c = cos(w * t_s), s = sin(w * t_s);
  *rate = w * (o->sine * c - o->cosine * s);
  return o->mean_a + (o->dynamic ? *rate : o->cosine * c + o->sine * s);
}

vs_coil_state vs_oneport_coil(const vs_oneport *o, double t_s, const double y[VS_ONEPORT_STATES]) {
  const vs_model *m = &o->setup->model;
  const double *q = y + VS_ONEPORT_Q;
  double z = vs_mechanics_gap(m, q), z_rate = vs_mechanics_travel(m, q + m->dof);
  double rate, i_n = source_current(o, t_s, &rate);
  vs_coil_state c;
  if (o->dynamic) {
    c.flux_wb = y[VS_ONEPORT_FLUX];
    c.v_v = y[VS_ONEPORT_VOLTAGE];
    c.i_a = vs_coil_current(&m->coil, c.flux_wb, z);
    c.flux_rate_v = c.v_v - m->coil.resistance_ohm * c.i_a;
    c.i_rate_a_s = vs_coil_rates(&m->coil, c.flux_wb, c.flux_rate_v, z, z_rate).i_rate_a_s;
    c.v_rate_v_s = (i_n - o->g_s * c.v_v - c.i_a - o->tau_s * c.i_rate_a_s) / o->c_f;
    return c;
  }
  c.i_a = i_n;
  c.i_rate_a_s = rate;
  c.flux_wb = 2 * m->coil.a_hm * i_n / z;
  c.flux_rate_v = (2 * m->coil.a_hm * rate - c.flux_wb * z_rate) / z;
  c.v_v = c.flux_rate_v + m->coil.resistance_ohm * i_n;
  c.v_rate_v_s = 0;
  return c;
}

static int oneport_rhs(double t_s, const double y[], double rate[], void *user) {
  const vs_oneport *o = user;
  vs_coil_state c = vs_oneport_coil(o, t_s, y);
  const vs_model *m = &o->setup->model;
  const double *q = y + VS_ONEPORT_Q, *v = q + m->dof;
  double a[VS_MOST_DOF], force = vs_coil_force(&m->coil, c.flux_wb, vs_mechanics_gap(m, q));
  vs_mechanics_accelerations(m, q, v, force, a);
  memcpy(rate + VS_ONEPORT_Q, v, (size_t)m->dof * sizeof *rate);
  memcpy(rate + VS_ONEPORT_Q + m->dof, a, (size_t)m->dof * sizeof *rate);
  rate[VS_ONEPORT_FLUX] = o->dynamic ? c.flux_rate_v : 0;
  rate[VS_ONEPORT_VOLTAGE] = o->dynamic ? c.v_rate_v_s : 0;
  return GSL_SUCCESS;
}

void vs_oneport_state(const vs_knot *k, double y[VS_ONEPORT_STATES]) {
  memcpy(y + VS_ONEPORT_Q, k->x, sizeof k->x);
  y[VS_ONEPORT_FLUX] = k->flux_wb;
  y[VS_ONEPORT_VOLTAGE] = k->v_eva_v;
}

bool vs_oneport_advance(vs_oneport *o, double from_s, double to_s, double y[VS_ONEPORT_STATES]) {
  double error[VS_ONEPORT_STATES], n = ceil((to_s - from_s) / o->substep_s),
                                   h = (to_s - from_s) / n;
  for (double k = 0; k < n; k++)
    if (gsl_odeiv2_step_apply(o->step, from_s + k * h, h, y, error, NULL, NULL, &o->system))
      return false;
  return true;
}

/* ---- its numbers ---- */

/* The knots from which the numbers are found, in order of time. */
typedef struct sight {
  const vs_observation *const *seen;
  size_t count;
} sight;

/* Keeps of the fit what vs_oneport_reach needs. */
static void keep_shape(vs_oneport *o, const vs_fit *f) {
  o->rank = f->rank;
  for (size_t j = 0; j < f->rank; j++) {
    o->column[j] = gsl_permutation_get(f->p, j);
    o->scale[j] = f->scale[o->column[j]];
    for (size_t k = 0; k <= j; k++) o->shape[k][j] = gsl_matrix_get(f->a, k, j);
  }
}

/* A row of the law in its integral form, which needs no derivative of what the solver showed:
 * q + tau i + G int v + C v = a sine + mean t + constant (+ drift t^2/2), q being the charge. */
static void law_row(const vs_oneport *o, const vs_observation *s, const vs_observation *first,
                    double row[LAW_ROOM]) {
  double angle = o->setup->timeline.omega_rad_s * s->knot.t_s, t = s->knot.t_s - first->knot.t_s;
  row[LAW_COSINE] = cos(angle);
  row[LAW_SINE] = sin(angle);
  row[LAW_MEAN] = t;
  row[LAW_CONSTANT] = 1;
  row[LAW_G] = -(s->flux_in_wb - first->flux_in_wb);
  row[LAW_C] = -s->knot.v_eva_v;
  row[LAW_TAU] = -vs_oneport_knot_current(&o->setup->model, &s->knot);
  row[LAW_COLUMNS] = t * t / 2;
}

/* A row of the static law: i = a sine + mean (+ drift t). */
static void static_row(const vs_oneport *o, const vs_observation *s, const vs_observation *first,
                       double row[LAW_ROOM]) {
  double angle = o->setup->timeline.omega_rad_s * s->knot.t_s;
  row[STATIC_COSINE] = cos(angle);
  row[STATIC_SINE] = sin(angle);
  row[STATIC_MEAN] = 1;
  row[STATIC_COLUMNS] = s->knot.t_s - first->knot.t_s;
}

/* A row of either law, and its right side: the charge, C, or the current, A. */
static double row_of(const vs_oneport *o, const vs_observation *s, const vs_observation *first,
                     double row[LAW_ROOM]) {
  (o->dynamic ? law_row : static_row)(o, s, first, row);
  return o->dynamic ? s->charge_c - first->charge_c
                    : vs_oneport_knot_current(&o->setup->model, &s->knot);
}

static size_t law_columns(const vs_oneport *o) {
  return o->dynamic ? (size_t)LAW_COLUMNS : (size_t)STATIC_COLUMNS;
}

/* Fits the first `count` columns of the law, and returns what is left over. */
static double fit_law(vs_oneport *o, const sight *in, size_t count, double x[LAW_ROOM]) {
  vs_fit f = vs_fit_new(in->count, count);
  for (size_t k = 0; k < in->count; k++) {
    double row[LAW_ROOM];
    gsl_vector_set(f.b, k, row_of(o, in->seen[k], in->seen[0], row));
    for (size_t j = 0; j < count; j++) gsl_matrix_set(f.a, k, j, row[j]);
  }
  double left = vs_fit_decompose(&f) ? vs_fit_solve(&f, x) : INFINITY;
  if (count == LAW_COLUMNS) keep_shape(o, &f);
  vs_fit_free(&f);
  return left;
}

/* Where a drift leaves less than this share over of what is left over without one, the source does
 * drift, as from a store that empties slowly, and is not periodic. */
static const double LAW_DRIFTS = 0.5;

static bool fit_oneport_law(vs_oneport *o, const sight *in) {
  double x[LAW_ROOM], drifting[LAW_ROOM];
  size_t count = law_columns(o);
  double without = fit_law(o, in, count, x), with = fit_law(o, in, count + 1, drifting);
  if (!isfinite(without) || with < LAW_DRIFTS * without) return false;
  o->cosine = x[LAW_COSINE];
  o->sine = x[LAW_SINE];
  o->mean_a = x[LAW_MEAN];
  o->g_s = o->dynamic ? x[LAW_G] : 0;
  o->c_f = o->dynamic ? x[LAW_C] : 0;
  o->tau_s = o->dynamic ? x[LAW_TAU] : 0;
  return true;
}

/* The share of a source's sine that flows through the coil, which is at rest. */
static double through_coil(const vs_oneport *o) {
  const vs_model *m = &o->setup->model;
  double w = o->setup->timeline.omega_rad_s, r = m->coil.resistance_ohm,
         x = w * 2 * m->coil.a_hm / m->coil.gap_rest_m, coil2 = r * r + x * x;
  if (!o->dynamic) return 1;
  return 1 / (hypot(o->g_s + r / coil2, w * o->c_f - x / coil2) * sqrt(coil2));
}

void vs_oneport_drifted(const vs_oneport *o, const vs_observation *const *seen, size_t count,
                        double *sine_a, double *mean_a) {
  const size_t of_source = o->dynamic ? (size_t)LAW_CONSTANT + 1 : (size_t)STATIC_COLUMNS;
  vs_fit f = vs_fit_new(count, of_source);
  double x[LAW_COLUMNS], rate = o->dynamic ? o->setup->timeline.omega_rad_s : 1;
  const double found[LAW_COLUMNS] = {
      [LAW_COSINE] = o->cosine, [LAW_SINE] = o->sine, [LAW_MEAN] = o->mean_a,
      [LAW_G] = o->g_s,         [LAW_C] = o->c_f,     [LAW_TAU] = o->tau_s};
  for (size_t k = 0; k < count; k++) {
    double row[LAW_ROOM], left = row_of(o, seen[k], seen[0], row);
    for (size_t j = 0; j < law_columns(o); j++) left -= found[j] * row[j];
    for (size_t j = 0; j < of_source; j++) gsl_matrix_set(f.a, k, j, row[j]);
    gsl_vector_set(f.b, k, left);
  }
  bool good = vs_fit_decompose(&f) && isfinite(vs_fit_solve(&f, x));
  vs_fit_free(&f);
  *sine_a = good ? through_coil(o) * rate * hypot(x[LAW_COSINE], x[LAW_SINE]) : INFINITY;
  *mean_a = good ? fabs(x[LAW_MEAN]) : INFINITY;
}

/* With A = QR of the fit, the current at t_s hangs on the law's numbers by the row below (the law's
 * integral form, differentiated), and its error on the misfit by |R^-T row|. */
double vs_oneport_reach(const vs_oneport *o, double t_s, const vs_coil_state *c) {
  if (!o->dynamic) return 1;
  double w = o->setup->timeline.omega_rad_s;
  const double row[LAW_COLUMNS] = {[LAW_COSINE] = -w * sin(w * t_s),
                                   [LAW_SINE] = w * cos(w * t_s),
                                   [LAW_MEAN] = 1,
                                   [LAW_G] = -c->v_v,
                                   [LAW_C] = -c->v_rate_v_s,
                                   [LAW_TAU] = -c->i_rate_a_s};
  double sum = 0, y[LAW_COLUMNS]; /* R^T y = row */
  for (size_t j = 0; j < o->rank; j++) {
    y[j] = row[o->column[j]] / o->scale[j];
    for (size_t k = 0; k < j; k++) y[j] -= o->shape[k][j] * y[k];
    y[j] /= o->shape[j][j];
    sum += y[j] * y[j];
  }
  return sqrt(sum) / o->reach_seen;
}

static double reach_of(vs_oneport *o, const sight *in) {
  double most = 0, y[VS_ONEPORT_STATES];
  o->reach_seen = 1;
  for (size_t k = 0; k < in->count; k++) {
    vs_oneport_state(&in->seen[k]->knot, y);
    vs_coil_state c = vs_oneport_coil(o, in->seen[k]->knot.t_s, y);
    most = fmax(most, vs_oneport_reach(o, in->seen[k]->knot.t_s, &c));
  }
  return most;
}

/* Returns the longest substep of the integration, s, or 0 where the law is unstable or too stiff.
 * rkf45's error over 0.1 rad of the machine's swing is 1e-9 of it; over 0.2 rad of the swing of the
 * coil with its capacitances, which dies away, it is 1e-7. The electrical half at rest is
 * lambda' = v - R k lambda, C v' = -G v - k lambda - tau k (v - R k lambda) with k = z/(2a). */
static double longest_substep(const vs_oneport *o) {
  const vs_model *m = &o->setup->model;
  double h = 0.1 / fmax(m->fastest_rad_s, o->setup->timeline.omega_rad_s);
  if (o->dynamic) {
    double k = m->coil.gap_rest_m / (2 * m->coil.a_hm), r = m->coil.resistance_ohm;
    if (!(o->c_f > 0)) return 0;
    double trace = -r * k - (o->g_s + o->tau_s * k) / o->c_f;
    double det = (r * k * o->g_s + k) / o->c_f;
    if (!(trace < 0 && det > 0)) return 0;
    h = fmin(h, 0.2 / fmax(-trace, sqrt(det)));
  }
  return h > 5e-4 * o->setup->timeline.period_s ? h : 0; /* 2000 a cycle */
}

bool vs_oneport_fit(vs_oneport *o, const vs_observation *const *seen, size_t count, bool dynamic) {
  const sight in = {seen, count};
  o->dynamic = dynamic;
  if (!fit_oneport_law(o, &in)) return false;
  o->substep_s = longest_substep(o);
  if (dynamic) o->reach_seen = reach_of(o, &in);
  return o->substep_s > 0;
}

bool vs_oneport_fit_signals(vs_oneport *o, const vs_observation *const *seen, size_t count) {
  vs_coil_state coil[VS_MOST_SEEN];
  double y[VS_ONEPORT_STATES];
  for (size_t k = 0; k < count; k++) {
    vs_oneport_state(&seen[k]->knot, y);
    coil[k] = vs_oneport_coil(o, seen[k]->knot.t_s, y);
  }
  return vs_responses_fit(&o->signals, o->frame, seen, coil, count);
}

const vs_responses *vs_oneport_responses(const vs_oneport *o) {
  return &o->signals;
}

double vs_oneport_capacitance(const vs_oneport *o) {
  return o->dynamic ? o->c_f : 0;
}

double vs_oneport_lag(const vs_oneport *o) {
  return o->dynamic ? fabs(o->tau_s) : 0;
}

vs_oneport *vs_oneport_new(const vs_setup *setup, const vs_frame *frame, size_t memories) {
  vs_oneport *o = vs_alloc(1, sizeof *o);
  o->setup = setup;
  o->frame = frame;
  vs_responses_begin(&o->signals, setup->timeline.omega_rad_s, frame->deck->n_terms + 1 + memories);
  /* only the states that the machine has: the others' rates are not set */
  o->system =
      (gsl_odeiv2_system){oneport_rhs, NULL, VS_ONEPORT_Q + 2 * (size_t)setup->model.dof, o};
  o->step = vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, o->system.dimension));
  return o;
}

void vs_oneport_free(vs_oneport *o) {
  if (!o) return;
  gsl_odeiv2_step_free(o->step);
  free(o);
}
