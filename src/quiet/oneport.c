/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quiet/oneport.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine/actuator.h"

/* The source is one sine: harmonics would take for their own what the mains' beat with the machine
 * makes, as a cycle cannot tell the two apart. */
enum { LAW_COLUMNS = 7, HARMONICS = 3, TERM_COLUMNS = 2 * HARMONICS + 5 };

/* A column of a fit of which less than this is its own counts as none. */
static const double RANK = 1e-9;

struct vs_oneport {
  const vs_setup *setup;
  const vs_frame *frame;
  size_t signals;
  bool dynamic;                /* false: i = i_N(t) */
  double cosine, sine, mean_a; /* of i_N; dynamic: of its integral, but the mean */
  double g_s, c_f, tau_s;
  double signal[VS_SIGNALS][TERM_COLUMNS];
  double from_s;                                              /* where the time of a drift begins */
  double shape[LAW_COLUMNS][LAW_COLUMNS], scale[LAW_COLUMNS]; /* of the fit: R, and its columns' */
  size_t column[LAW_COLUMNS], rank;
  double reach_seen;
  double substep_s;
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
};

double vs_oneport_knot_current(const vs_model *m, const vs_knot *k) {
  return vs_actuator_current(m, k->flux_wb, vs_actuator_gap(m, k->x[P]));
}

double vs_oneport_knot_current_rate(const vs_model *m, const vs_knot *k) {
  return vs_actuator_current_rate(m, k->flux_wb, k->flux_rate_v, vs_actuator_gap(m, k->x[P]),
                                  k->x[VS_DOF + P]);
}

double vs_oneport_seen_signal(const vs_frame *frame, const vs_seen *s, size_t n) {
  size_t terms = frame->deck->n_terms;
  return n < terms ? s->knot.terms[n] : n == terms ? s->knot.i_mains_a : s->memory[n - terms - 1];
}

/* i_N and its rate (dynamic: i_N alone) */
static double source(const vs_oneport *o, double t_s, double *rate) {
  double w = o->setup->timeline.omega_rad_s, c = cos(w * t_s), s = sin(w * t_s);
  *rate = w * (o->sine * c - o->cosine * s);
  return o->mean_a + (o->dynamic ? *rate : o->cosine * c + o->sine * s);
}

vs_coil vs_oneport_coil(const vs_oneport *o, double t_s, const double y[VS_ONEPORT_STATES]) {
  const vs_model *m = &o->setup->model;
  double z = vs_actuator_gap(m, y[P]), z_rate = y[VS_DOF + P], rate, i_n = source(o, t_s, &rate);
  vs_coil c;
  if (o->dynamic) {
    c.flux_wb = y[VS_ONEPORT_FLUX];
    c.v_v = y[VS_ONEPORT_VOLTAGE];
    c.i_a = vs_actuator_current(m, c.flux_wb, z);
    c.flux_rate_v = c.v_v - m->actuator.resistance_ohm * c.i_a;
    c.i_rate_a_s = vs_actuator_current_rate(m, c.flux_wb, c.flux_rate_v, z, z_rate);
    c.v_rate_v_s = (i_n - o->g_s * c.v_v - c.i_a - o->tau_s * c.i_rate_a_s) / o->c_f;
    return c;
  }
  c.i_a = i_n;
  c.i_rate_a_s = rate;
  c.flux_wb = 2 * m->a_hm * i_n / z;
  c.flux_rate_v = (2 * m->a_hm * rate - c.flux_wb * z_rate) / z;
  c.v_v = c.flux_rate_v + m->actuator.resistance_ohm * i_n;
  c.v_rate_v_s = 0;
  return c;
}

static int rhs(double t_s, const double y[], double rate[], void *user) {
  const vs_oneport *o = user;
  vs_coil c = vs_oneport_coil(o, t_s, y);
  memcpy(rate, y + VS_DOF, sizeof(double[VS_DOF]));
  vs_mechanics_accelerations(&o->setup->model, y, vs_actuator_force(&o->setup->model, c.flux_wb),
                             rate + VS_DOF);
  rate[VS_ONEPORT_FLUX] = o->dynamic ? c.flux_rate_v : 0;
  rate[VS_ONEPORT_VOLTAGE] = o->dynamic ? c.v_rate_v_s : 0;
  return GSL_SUCCESS;
}

void vs_oneport_state(const vs_knot *k, double y[VS_ONEPORT_STATES]) {
  memcpy(y, k->x, sizeof k->x);
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

/* What the terms are combined of; the last one for those that drift. */
static void columns(const vs_oneport *o, double t_s, const vs_coil *c, double out[TERM_COLUMNS]) {
  double angle = o->setup->timeline.omega_rad_s * t_s, cosine = cos(angle), sine = sin(angle);
  out[0] = cosine;
  out[HARMONICS] = sine;
  for (int h = 1; h < HARMONICS; h++) {
    out[h] = out[h - 1] * cosine - out[HARMONICS + h - 1] * sine;
    out[HARMONICS + h] = out[HARMONICS + h - 1] * cosine + out[h - 1] * sine;
  }
  double *rest = out + 2 * HARMONICS;
  rest[0] = 1;
  rest[1] = c->v_v;
  rest[2] = c->i_a;
  rest[3] = c->v_rate_v_s;
  rest[4] = t_s - o->from_s;
}

void vs_oneport_signals(const vs_oneport *o, double t_s, const vs_coil *c,
                        double signal[VS_SIGNALS]) {
  double column[TERM_COLUMNS];
  columns(o, t_s, c, column);
  for (size_t n = 0; n < o->signals; n++) {
    signal[n] = 0;
    for (size_t j = 0; j < TERM_COLUMNS; j++) signal[n] += o->signal[n][j] * column[j];
  }
}

/* ---- its numbers ---- */

/* What it is found from. */
typedef struct sight {
  const vs_seen *const *seen;
  size_t count;
} sight;

/* Least squares on the samples: one matrix, many right sides. Columns are scaled to one another. */
typedef struct fit {
  gsl_matrix *a;
  gsl_vector *tau, *norm, *b, *x, *residual;
  gsl_permutation *p;
  double scale[TERM_COLUMNS]; /* room for either kind */
  size_t rank;
} fit;

static fit fit_new(size_t rows, size_t count) {
  return (fit){.a = gsl_matrix_alloc(rows, count),
               .tau = gsl_vector_alloc(count),
               .norm = gsl_vector_alloc(count),
               .b = gsl_vector_alloc(rows),
               .x = gsl_vector_alloc(count),
               .residual = gsl_vector_alloc(rows),
               .p = gsl_permutation_alloc(count)};
}
static void fit_free(fit *f) {
  gsl_matrix_free(f->a);
  gsl_vector_free(f->tau);
  gsl_vector_free(f->norm);
  gsl_vector_free(f->b);
  gsl_vector_free(f->x);
  gsl_vector_free(f->residual);
  gsl_permutation_free(f->p);
}
static bool fit_decompose(fit *f) {
  int sign;
  for (size_t j = 0; j < f->a->size2; j++) {
    gsl_vector_view column = gsl_matrix_column(f->a, j);
    f->scale[j] = fmax(gsl_vector_max(&column.vector), -gsl_vector_min(&column.vector));
    if (f->scale[j] > 0) gsl_vector_scale(&column.vector, 1 / f->scale[j]);
  }
  if (gsl_linalg_QRPT_decomp(f->a, f->tau, f->p, &sign, f->norm)) return false;
  f->rank = gsl_linalg_QRPT_rank(f->a, RANK * fabs(gsl_matrix_get(f->a, 0, 0)));
  return f->rank > 0;
}
static bool fit_solve(fit *f, double *x) {
  if (gsl_linalg_QRPT_lssolve2(f->a, f->tau, f->p, f->b, f->rank, f->x, f->residual)) return false;
  for (size_t j = 0; j < f->a->size2; j++)
    x[j] = f->scale[j] > 0 ? gsl_vector_get(f->x, j) / f->scale[j] : 0;
  return true;
}

static void keep_shape(vs_oneport *o, const fit *f) {
  o->rank = f->rank;
  for (size_t j = 0; j < f->rank; j++) {
    o->column[j] = gsl_permutation_get(f->p, j);
    o->scale[j] = f->scale[o->column[j]];
    for (size_t k = 0; k <= j; k++) o->shape[k][j] = gsl_matrix_get(f->a, k, j);
  }
}

/* Least squares for the right side at hand. Gives what is left over, the root of its sum of
 * squares.
 */
static double fit_left(fit *f, double *x) {
  return fit_solve(f, x) ? gsl_blas_dnrm2(f->residual) : INFINITY;
}

/* The law in its integral form, which needs no derivative of what the solver showed:
 * q + tau i + G int v + C v = a sine + mean t + constant (+ drift t^2/2). */
static void law_row(const vs_oneport *o, const vs_seen *s, const vs_seen *first,
                    double row[LAW_COLUMNS + 1]) {
  double angle = o->setup->timeline.omega_rad_s * s->knot.t_s, t = s->knot.t_s - first->knot.t_s;
  const double columns[LAW_COLUMNS + 1] = {cos(angle),
                                           sin(angle),
                                           t,
                                           1,
                                           -(s->flux_in_wb - first->flux_in_wb),
                                           -s->knot.v_eva_v,
                                           -vs_oneport_knot_current(&o->setup->model, &s->knot),
                                           t * t / 2};
  memcpy(row, columns, sizeof columns);
}

/* i = i_N(t): a sine + mean (+ drift t) */
enum { STATIC_COLUMNS = 3 };
static void static_row(const vs_oneport *o, const vs_seen *s, const vs_seen *first,
                       double row[LAW_COLUMNS + 1]) {
  double angle = o->setup->timeline.omega_rad_s * s->knot.t_s;
  row[0] = cos(angle);
  row[1] = sin(angle);
  row[2] = 1;
  row[3] = s->knot.t_s - first->knot.t_s;
}

/* The first `count` columns of the law; what is left over. */
static double fit_law(vs_oneport *o, const sight *in, size_t count, double x[LAW_COLUMNS + 1]) {
  fit f = fit_new(in->count, count);
  for (size_t k = 0; k < in->count; k++) {
    const vs_seen *s = in->seen[k];
    double row[LAW_COLUMNS + 1];
    (o->dynamic ? law_row : static_row)(o, s, in->seen[0], row);
    for (size_t j = 0; j < count; j++) gsl_matrix_set(f.a, k, j, row[j]);
    gsl_vector_set(f.b, k,
                   o->dynamic ? s->charge_c - in->seen[0]->charge_c
                              : vs_oneport_knot_current(&o->setup->model, &s->knot));
  }
  double left = fit_decompose(&f) ? fit_left(&f, x) : INFINITY;
  if (count == LAW_COLUMNS) keep_shape(o, &f);
  fit_free(&f);
  return left;
}

/* With a drift so much less is left over: then the source does drift, as from a store that empties
 * slowly, and is no periodic one. */
static const double LAW_DRIFTS = 0.5;

static bool find_law(vs_oneport *o, const sight *in) {
  double x[LAW_COLUMNS + 1], drifting[LAW_COLUMNS + 1];
  size_t count = o->dynamic ? LAW_COLUMNS : STATIC_COLUMNS;
  double without = fit_law(o, in, count, x), with = fit_law(o, in, count + 1, drifting);
  if (!isfinite(without) || with < LAW_DRIFTS * without) return false;
  o->cosine = x[0];
  o->sine = x[1];
  o->mean_a = x[2];
  o->g_s = o->dynamic ? x[4] : 0;
  o->c_f = o->dynamic ? x[5] : 0;
  o->tau_s = o->dynamic ? x[6] : 0;
  return true;
}

/* Columns of the source, first in either law. */
static size_t source_columns(const vs_oneport *o) {
  return o->dynamic ? 4 : STATIC_COLUMNS;
}

/* What part of a source's sine flows through the coil. */
static double through_coil(const vs_oneport *o) {
  const vs_model *m = &o->setup->model;
  double w = o->setup->timeline.omega_rad_s, r = m->actuator.resistance_ohm,
         x = w * 2 * m->a_hm / m->gap_rest_m, coil2 = r * r + x * x;
  if (!o->dynamic) return 1;
  return 1 / (hypot(o->g_s + r / coil2, w * o->c_f - x / coil2) * sqrt(coil2));
}

void vs_oneport_walked(const vs_oneport *o, const vs_seen *const *seen, size_t count,
                       double *sine_a, double *mean_a) {
  fit f = fit_new(count, source_columns(o));
  double x[LAW_COLUMNS], rate = o->dynamic ? o->setup->timeline.omega_rad_s : 1;
  const double found[LAW_COLUMNS] = {o->cosine, o->sine, o->mean_a, 0, o->g_s, o->c_f, o->tau_s};
  for (size_t k = 0; k < count; k++) {
    double row[LAW_COLUMNS + 1] = {0}, left;
    (o->dynamic ? law_row : static_row)(o, seen[k], seen[0], row);
    left = o->dynamic ? seen[k]->charge_c - seen[0]->charge_c
                      : vs_oneport_knot_current(&o->setup->model, &seen[k]->knot);
    for (size_t j = 0; j < (o->dynamic ? LAW_COLUMNS : STATIC_COLUMNS); j++)
      left -= found[j] * row[j];
    for (size_t j = 0; j < f.a->size2; j++) gsl_matrix_set(f.a, k, j, row[j]);
    gsl_vector_set(f.b, k, left);
  }
  bool good = fit_decompose(&f) && isfinite(fit_left(&f, x));
  fit_free(&f);
  *sine_a = good ? through_coil(o) * rate * hypot(x[0], x[1]) : INFINITY;
  *mean_a = good ? fabs(x[2]) : INFINITY;
}

double vs_oneport_reach(const vs_oneport *o, double t_s, const vs_coil *c) {
  if (!o->dynamic) return 1;
  double w = o->setup->timeline.omega_rad_s;
  const double row[LAW_COLUMNS] = {-w * sin(w * t_s), w * cos(w * t_s), 1, 0, -c->v_v,
                                   -c->v_rate_v_s,    -c->i_rate_a_s};
  double sum = 0, y[LAW_COLUMNS]; /* R' y = row */
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
    vs_coil c = vs_oneport_coil(o, in->seen[k]->knot.t_s, y);
    most = fmax(most, vs_oneport_reach(o, in->seen[k]->knot.t_s, &c));
  }
  return most;
}

/* rkf45's error over 0.1 rad of the machine's swing is 1e-9 of it, over 0.2 rad of the coil's with
 * its capacitances, which dies, 1e-7. 0: the law is none to go by, as it is unstable or too stiff.
 * The electrical half at rest: lambda' = v - R k lambda, k = z/(2a); C v' = -G v - k lambda -
 * tau k (v - R k lambda). */
static double substep(const vs_oneport *o) {
  const vs_model *m = &o->setup->model;
  double h = 0.1 / fmax(m->fastest_rad_s, o->setup->timeline.omega_rad_s);
  if (o->dynamic) {
    double k = m->gap_rest_m / (2 * m->a_hm), r = m->actuator.resistance_ohm;
    if (!(o->c_f > 0)) return 0;
    double trace = -r * k - (o->g_s + o->tau_s * k) / o->c_f;
    double det = (r * k * o->g_s + k) / o->c_f;
    if (!(trace < 0 && det > 0)) return 0;
    h = fmin(h, 0.2 / fmax(-trace, sqrt(det)));
  }
  return h > 5e-4 * o->setup->timeline.period_s ? h : 0; /* 2000 a cycle */
}

/* Least squares for signal n. Gives what is left over, as the root of its sum of squares. */
static double find_signal(const vs_oneport *o, const sight *in, size_t n, fit *f, double *x) {
  for (size_t k = 0; k < in->count; k++)
    gsl_vector_set(f->b, k, vs_oneport_seen_signal(o->frame, in->seen[k], n));
  return fit_left(f, x);
}

/* A signal is taken to drift, as an integral does, or to hang on the coil where that leaves hardly
 * anything over: over one cycle the coil's voltage is nearly a sine, and what it shares with the
 * signal beyond that may be chance, which does not last. */
static const double BETTER = 0.1, HANGS = 0.8;

/* The columns that fits may have: with those of the coil or not, with the drift or not. */
enum { FITS = 4, OF_COIL = 1, OF_DRIFT = 2, COIL_AT = 2 * HARMONICS + 1 };

static size_t column_at(int kind, size_t j) {
  if (!(kind & OF_COIL) && j >= COIL_AT) return TERM_COLUMNS - 1;
  return j;
}

static size_t columns_of(int kind) {
  size_t count = kind & OF_COIL ? TERM_COLUMNS - 1 : COIL_AT;
  return kind & OF_DRIFT ? count + 1 : count;
}

static bool begin_signals(const vs_oneport *o, const sight *in, int kind, fit *f) {
  *f = fit_new(in->count, columns_of(kind));
  for (size_t k = 0; k < in->count; k++) {
    const vs_knot *seen = &in->seen[k]->knot;
    double y[VS_ONEPORT_STATES], column[TERM_COLUMNS];
    vs_oneport_state(seen, y);
    vs_coil c = vs_oneport_coil(o, seen->t_s, y);
    columns(o, seen->t_s, &c, column);
    for (size_t j = 0; j < f->a->size2; j++) gsl_matrix_set(f->a, k, j, column[column_at(kind, j)]);
  }
  return fit_decompose(f);
}

static bool find_signals(vs_oneport *o, const sight *in) {
  fit fits[FITS];
  bool good = true;
  o->from_s = in->seen[0]->knot.t_s;
  for (int kind = 0; kind < FITS; kind++) good = begin_signals(o, in, kind, &fits[kind]) && good;
  for (size_t n = 0; good && n < o->signals; n++) {
    double x[TERM_COLUMNS], *signal = o->signal[n], best = INFINITY;
    for (int kind = 0; kind < FITS; kind++) {
      double left = find_signal(o, in, n, &fits[kind], x);
      if (!(left < (kind & OF_DRIFT ? BETTER : HANGS) * best) && kind) continue;
      best = left;
      memset(signal, 0, sizeof o->signal[n]);
      for (size_t j = 0; j < columns_of(kind); j++) signal[column_at(kind, j)] = x[j];
    }
    good = isfinite(best);
  }
  for (int kind = 0; kind < FITS; kind++) fit_free(&fits[kind]);
  return good;
}

bool vs_oneport_hangs(const vs_oneport *o, size_t n) {
  for (size_t j = COIL_AT; j < TERM_COLUMNS - 1; j++)
    if (o->signal[n][j] != 0) return true;
  return false;
}

double vs_oneport_drift(const vs_oneport *o, size_t n) {
  return o->signal[n][TERM_COLUMNS - 1];
}

bool vs_oneport_fit(vs_oneport *o, const vs_seen *const *seen, size_t count, bool dynamic) {
  const sight in = {seen, count};
  o->dynamic = dynamic;
  if (!find_law(o, &in)) return false;
  o->substep_s = substep(o);
  if (dynamic) o->reach_seen = reach_of(o, &in);
  return o->substep_s > 0;
}

bool vs_oneport_fit_signals(vs_oneport *o, const vs_seen *const *seen, size_t count) {
  const sight in = {seen, count};
  return find_signals(o, &in);
}

double vs_oneport_capacitance(const vs_oneport *o) {
  return o->dynamic ? o->c_f : 0;
}

double vs_oneport_lag(const vs_oneport *o) {
  return o->dynamic ? fabs(o->tau_s) : 0;
}

vs_oneport *vs_oneport_new(const vs_setup *setup, const vs_frame *frame, size_t memories) {
  vs_oneport *o = vs_alloc(1, sizeof *o);
  *o = (vs_oneport){.setup = setup, .frame = frame, .signals = frame->deck->n_terms + 1 + memories};
  o->system = (gsl_odeiv2_system){rhs, NULL, VS_ONEPORT_STATES, o};
  o->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, VS_ONEPORT_STATES);
  return o;
}

void vs_oneport_free(vs_oneport *o) {
  if (!o) return;
  gsl_odeiv2_step_free(o->step);
  free(o);
}
