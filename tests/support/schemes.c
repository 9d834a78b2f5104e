/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plant/coil.h"
#include "base/text.h"
#include "engine/gate.h"

/* Of an iteration: the largest change that counts as none, as a part of what the mains can build
 * up, and how many solutions it may take. */
static const double SETTLED = 1e-10;
enum { MOST_ITERATIONS = 100 };

/* ---- the classical Runge-Kutta rule ---- */

enum { MOST_STATES = VS_STATES + 1 };
typedef void (*rates)(const void *of, double s, const double y[], double rate[]);

static void rk4(rates f, const void *of, double s, double h, double y[], int n) {
  double k[4][MOST_STATES], at[MOST_STATES];
  f(of, s, y, k[0]);
  for (int stage = 1; stage < 4; stage++) {
    double part = stage < 3 ? h / 2 : h;
    for (int i = 0; i < n; i++) at[i] = y[i] + part * k[stage - 1][i];
    f(of, s + part, at, k[stage]);
  }
  for (int i = 0; i < n; i++) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* ---- the circuit ---- */

/* What holds for one macro step. */
typedef struct coil {
  const cosim *c;
  course z;
  double l_h, l_rate_ohm; /* COIL_7C */
} coil;

enum { Y, TAKEN, COPPER, COIL_STATES };

static void coil_rates(const void *of, double s, const double y[], double rate[]) {
  const coil *k = of;
  const vs_model *m = k->c->model;
  double u = vs_timeline_voltage(k->c->timeline, k->c->t_s + s), r = m->actuator.resistance_ohm;
  bool flux = k->c->scheme->form == COIL_FLUX;
  double i = flux ? vs_coil_current(&m->coil, y[Y], k->z.at + s * k->z.rate) : y[Y];
  rate[Y] = flux ? u - r * i : (u - (r + k->l_rate_ohm) * i) / k->l_h;
  rate[TAKEN] = u * i;
  rate[COPPER] = r * i * i;
}

static coil coil_of(const cosim *c, course z) {
  coil k = {.c = c, .z = z};
  if (c->scheme->form == COIL_FLUX) return k;
  k.l_h = 2 * c->model->coil.a_hm / c->z_m;
  if (c->scheme->form == COIL_7C) k.l_rate_ohm = -k.l_h / c->z_m * c->now.x[VS_DOF + P];
  return k;
}

/* One substep while it conducts, from s on for h or to where y falls through zero: Newton on its
 * length. Gives the length. */
static double conduct(const coil *k, double s, double h, double y[COIL_STATES]) {
  double from[COIL_STATES], lower = 0, upper = h, length = h, rate[COIL_STATES];
  memcpy(from, y, sizeof from);
  rk4(coil_rates, k, s, h, y, COIL_STATES);
  if (y[Y] > 0) return h;
  for (int n = 0; n < 60 && upper - lower > 1e-16; n++) {
    coil_rates(k, s + length, y, rate);
    double next = length - y[Y] / rate[Y];
    if (y[Y] > 0)
      lower = length;
    else
      upper = length;
    if (next == length) break;
    length = next > lower && next < upper ? next : (lower + upper) / 2;
    memcpy(y, from, sizeof from);
    rk4(coil_rates, k, s, length, y, COIL_STATES);
  }
  y[Y] = 0;
  return length;
}

/* The circuit over one macro step with the gap as told. */
static void solve_circuit(cosim *c, course z, cosim_state *to) {
  coil k = coil_of(c, z);
  double y[COIL_STATES] = {c->now.y}, sub = c->step_s / (double)c->substeps, rate[COIL_STATES];
  to->on = c->now.on;
  to->fires_s = c->now.fires_s;
  c->y[0] = y[Y];
  c->conducts[0] = to->on;
  for (long n = 0; n < c->substeps; n++) {
    double at = (double)n * sub, end = (double)(n + 1) * sub;
    c->conducts[n + 1] = to->on;
    while (at < end) {
      if (!to->on) {
        if (to->fires_s >= c->t_s + end) break;
        at = fmax(at, to->fires_s - c->t_s);
        to->on = c->conducts[n + 1] = true;
      }
      double length = conduct(&k, at, end - at, y);
      at = y[Y] > 0 ? end : at + length;
      if (y[Y] > 0) continue;
      to->on = false;
      to->fires_s =
          vs_gate_next_conduction(c->timeline, c->t_s + at + 1e-6 * c->timeline->period_s);
    }
    coil_rates(&k, end, y, rate);
    c->y[n + 1] = y[Y];
    c->y_rate[n + 1] = to->on ? rate[Y] : 0;
  }
  to->y = y[Y];
  to->book_j[BOOK_TAKEN] = c->now.book_j[BOOK_TAKEN] + y[TAKEN];
  to->book_j[BOOK_COPPER] = c->now.book_j[BOOK_COPPER] + y[COPPER];
}

/* What the circuit tells at the end of a step. */
static double told_by(const cosim *c, course z, const cosim_state *to) {
  const vs_model *m = c->model;
  double z_end = z.at + c->step_s * z.rate;
  bool flux = c->scheme->form == COIL_FLUX;
  switch (c->scheme->tells) {
  case TELLS_I:
    return flux ? vs_coil_current(&m->coil, to->y, z_end) : to->y;
  case TELLS_FLUX:
    return to->y;
  case TELLS_FORCE:
    break;
  }
  return flux ? vs_coil_force(&m->coil, to->y, NAN)
              : m->coil.a_hm * to->y * to->y / (z_end * z_end);
}

/* ---- the machine ---- */

typedef struct push {
  const cosim *c;
  course told;
} push;

enum { WORK = VS_STATES };

static void machine_rates(const void *of, double s, const double x[], double rate[]) {
  const push *p = of;
  const vs_model *m = p->c->model;
  double w = p->told.at + s * p->told.rate, z = conveyor_gap(m, x[P]), force = w;
  if (p->c->scheme->tells == TELLS_I) force = m->coil.a_hm * w * w / (z * z);
  if (p->c->scheme->tells == TELLS_FLUX) force = vs_coil_force(&m->coil, w, NAN);
  memcpy(rate, x + VS_DOF, sizeof(double[VS_DOF]));
  double a[VS_MOST_DOF];
  vs_mechanics_accelerations(m, x, x + VS_DOF, force, a);
  memcpy(rate + VS_DOF, a, sizeof(double[VS_DOF]));
  rate[WORK] = -force * x[VS_DOF + P];
}

/* The machine over one macro step, told this. Gives when z <= 0, counted from its beginning;
 * INFINITY: it is not. */
static double solve_machine(cosim *c, course told, cosim_state *to) {
  push p = {c, told};
  double x[MOST_STATES] = {0}, sub = c->step_s / (double)c->substeps;
  memcpy(x, c->now.x, sizeof c->now.x);
  memcpy(c->x[0], x, sizeof c->x[0]);
  for (long n = 0; n < c->substeps; n++) {
    rk4(machine_rates, &p, (double)n * sub, sub, x, VS_STATES + 1);
    memcpy(c->x[n + 1], x, sizeof c->x[0]);
    memcpy(to->x, x, sizeof to->x);
    if (!(conveyor_gap(c->model, x[P]) > 0)) return (double)(n + 1) * sub;
  }
  to->book_j[BOOK_WORK] = c->now.book_j[BOOK_WORK] + x[WORK];
  return INFINITY;
}

/* ---- macro steps ---- */

static void show(const cosim *c) {
  const vs_model *m = c->model;
  const vs_frame frame = {.model = m, .timeline = c->timeline};
  double sub = c->step_s / (double)c->substeps;
  for (long n = 0; n <= c->substeps; n++) {
    vs_knot *k = &c->knots[n % 2];
    double z = conveyor_gap(m, c->x[n][P]), y = c->y[n], rate = c->y_rate[n];
    bool flux = c->scheme->form == COIL_FLUX;
    memcpy(k->x, c->x[n], sizeof c->x[n]);
    k->t_s = n < c->substeps ? c->t_s + (double)n * sub : (double)(c->n + 1) * c->step_s;
    k->flux_wb = flux ? y : 2 * m->coil.a_hm * y / z;
    k->flux_rate_v = flux ? rate : 2 * m->coil.a_hm * (rate - y * k->x[VS_DOF + P] / z) / z;
    k->i_mains_a = flux ? vs_coil_current(&m->coil, y, z) : y;
    k->v_eva_v = c->conducts[n] ? vs_timeline_voltage(c->timeline, k->t_s) : 0;
    vs_step_complete_knot(&frame, k, false);
    if (n > 0) c->show(c->ctx, &c->knots[1 - n % 2], k);
  }
}

/* Takes a solved step over. */
static bool accept(cosim *c, const cosim_state *to, double told, double collapses_s) {
  if (collapses_s < INFINITY) {
    c->collapsed_s = c->t_s + collapses_s;
    return false;
  }
  for (long n = 1; n <= c->substeps; n++) {
    c->p_min_m = fmin(c->p_min_m, c->x[n][P]);
    c->p_max_m = fmax(c->p_max_m, c->x[n][P]);
  }
  if (c->show) show(c);
  c->now = *to;
  c->y_rate[0] = c->y_rate[c->substeps];
  c->z_before_m = c->z_m;
  c->z_m = conveyor_gap(c->model, to->x[P]);
  c->told_before = c->told;
  c->told = told;
  c->t_s = (double)++c->n * c->step_s;
  return true;
}

/* Held, or on the line through the last two values. */
static course onward(const cosim *c, double now, double before) {
  return (course){now, c->scheme->linear ? (now - before) / c->step_s : 0};
}

/* Both from what is known at the beginning. */
static bool step_jacobi(cosim *c) {
  cosim_state to;
  course z = onward(c, c->z_m, c->z_before_m);
  solve_circuit(c, z, &to);
  double collapses = solve_machine(c, onward(c, c->told, c->told_before), &to);
  c->iterations++;
  return accept(c, &to, told_by(c, z, &to), collapses);
}

/* The circuit first; the machine knows what it found: held, its end, or the line to it. */
static bool step_seidel(cosim *c) {
  cosim_state to;
  course z = onward(c, c->z_m, c->z_before_m);
  solve_circuit(c, z, &to);
  double told = told_by(c, z, &to);
  course line = {c->told, (told - c->told) / c->step_s}, held = {told, 0};
  double collapses = solve_machine(c, c->scheme->linear ? line : held, &to);
  c->iterations++;
  return accept(c, &to, told, collapses);
}

/* What the mains can make of what is told. */
static double told_scale(const cosim *c) {
  const vs_model *m = c->model;
  double flux = c->timeline->peak_v / c->timeline->omega_rad_s;
  switch (c->scheme->tells) {
  case TELLS_I:
    return vs_coil_current(&m->coil, flux, m->coil.gap_rest_m);
  case TELLS_FLUX:
    return flux;
  case TELLS_FORCE:
    break;
  }
  return vs_coil_force(&m->coil, flux, NAN);
}

/* Both again and again, z and what is told on straight lines to their ends, until told = told anew.
 * Condensed: corrected by what the last two solutions say of d(told anew)/d(told). */
static bool iterate(cosim *c, bool condensed) {
  cosim_state to;
  double told = 2 * c->told - c->told_before, error = 0, before = 0, error_before = 0;
  for (int n = 0; n < MOST_ITERATIONS; n++) {
    double collapses = solve_machine(c, (course){c->told, (told - c->told) / c->step_s}, &to);
    course z = {c->z_m, (conveyor_gap(c->model, to.x[P]) - c->z_m) / c->step_s};
    solve_circuit(c, z, &to);
    c->iterations++;
    error = told_by(c, z, &to) - told;
    if (fabs(error) <= SETTLED * told_scale(c)) return accept(c, &to, told, collapses);
    if (!isfinite(error)) break;
    if (condensed && n > 0) c->slope = 1 + (error - error_before) / (told - before);
    if (!(c->slope < 0.9)) c->slope = 0;
    before = told;
    error_before = error;
    told += c->scheme->relaxation * error / (1 - c->slope);
  }
  c->diverged_s = c->t_s;
  return false;
}
static bool step_iterated(cosim *c) {
  return iterate(c, false);
}
static bool step_condensed(cosim *c) {
  return iterate(c, true);
}

const scheme schemes[] = {
    {"i_jacobi", "i exchanged, flux as state, z held, Jacobi", -3, COIL_FLUX, TELLS_I, false, 0,
     step_jacobi},
    {"i_jacobi_extrapolated", "the same, i and z extrapolated", 0, COIL_FLUX, TELLS_I, true, 0,
     step_jacobi},
    {"i_seidel", "i exchanged, flux as state, z held, Gauss-Seidel", -1, COIL_FLUX, TELLS_I, false,
     0, step_seidel},
    {"i_seidel_extrapolated", "the same, z extrapolated, i on its line", 0, COIL_FLUX, TELLS_I,
     true, 0, step_seidel},
    {"7c_jacobi", "i exchanged, L and back-EMF held (the paper's Fig. 7c), Jacobi", -2, COIL_7C,
     TELLS_I, false, 0, step_jacobi},
    {"7c_seidel", "i exchanged, L and back-EMF held, Gauss-Seidel", 0, COIL_7C, TELLS_I, false, 0,
     step_seidel},
    {"7c_force", "F exchanged, L and back-EMF held, Jacobi", 1, COIL_7C, TELLS_FORCE, false, 0,
     step_jacobi},
    {"7c_no_emf", "i exchanged, L held, back-EMF left out, Gauss-Seidel: wrong at any step", NAN,
     COIL_NO_EMF, TELLS_I, false, 0, step_seidel},
    {"flux_jacobi", "lambda exchanged, z held, Jacobi", 0, COIL_FLUX, TELLS_FLUX, false, 0,
     step_jacobi},
    {"flux_jacobi_extrapolated", "the same, lambda and z extrapolated", 0, COIL_FLUX, TELLS_FLUX,
     true, 0, step_jacobi},
    {"flux_seidel", "lambda exchanged, z held, Gauss-Seidel: no energy lost at any step", 0,
     COIL_FLUX, TELLS_FLUX, false, 0, step_seidel},
    {"flux_seidel_extrapolated", "the same, z extrapolated, lambda on its line", 0, COIL_FLUX,
     TELLS_FLUX, true, 0, step_seidel},
    {"i_iterated", "i exchanged, z and i on lines, iterated", 0, COIL_FLUX, TELLS_I, true, 1,
     step_iterated},
    {"i_relaxed", "the same, half of each correction taken", 0, COIL_FLUX, TELLS_I, true, 0.5,
     step_iterated},
    {"i_condensed", "the same, by Newton's (secant) corrections", 0, COIL_FLUX, TELLS_I, true, 1,
     step_condensed},
    {"flux_iterated", "lambda exchanged, z and lambda on lines, iterated", 0, COIL_FLUX, TELLS_FLUX,
     true, 1, step_iterated},
    {"flux_condensed", "the same, by Newton's (secant) corrections", 0, COIL_FLUX, TELLS_FLUX, true,
     1, step_condensed},
};
const size_t n_schemes = sizeof schemes / sizeof *schemes;

const scheme *scheme_find(const char *name) {
  for (size_t k = 0; k < n_schemes; k++)
    if (!strcmp(schemes[k].name, name)) return &schemes[k];
  return NULL;
}

/* ---- runs ---- */

void cosim_begin(cosim *c, const scheme *s, const vs_model *model, const vs_timeline *timeline,
                 double step_s) {
  double longest = 0.02 / fmax(model->fastest_rad_s, timeline->omega_rad_s);
  *c = (cosim){.scheme = s,
               .model = model,
               .timeline = timeline,
               .step_s = step_s,
               .z_m = model->coil.gap_rest_m,
               .z_before_m = model->coil.gap_rest_m,
               .collapsed_s = NAN,
               .diverged_s = NAN,
               .substeps = (long)ceil(step_s / longest * (1 - 1e-12))};
  c->now.fires_s = vs_gate_next_conduction(timeline, 0);
  size_t n = (size_t)c->substeps + 1;
  c->x = vs_alloc(n, sizeof *c->x);
  c->y = vs_alloc(n, sizeof *c->y);
  c->y_rate = vs_alloc(n, sizeof *c->y_rate);
  c->conducts = vs_alloc(n, sizeof *c->conducts);
  c->knots = vs_alloc(2, sizeof *c->knots);
}

void cosim_place(cosim *c, const double x[VS_STATES]) {
  memcpy(c->now.x, x, sizeof c->now.x);
  c->z_m = c->z_before_m = conveyor_gap(c->model, x[P]);
}

bool cosim_step(cosim *c) {
  return isnan(c->collapsed_s) && isnan(c->diverged_s) && c->scheme->step(c);
}

bool cosim_run(cosim *c, double until_s) {
  while (c->t_s < until_s - 1e-9 * c->step_s)
    if (!cosim_step(c)) return false;
  return true;
}

void cosim_end(cosim *c) {
  free(c->x);
  free(c->y);
  free(c->y_rate);
  free(c->conducts);
  free(c->knots);
}

double cosim_flux(const cosim *c) {
  return c->scheme->form == COIL_FLUX ? c->now.y : 2 * c->model->coil.a_hm * c->now.y / c->z_m;
}

double cosim_left(const cosim *c) {
  const double *b = c->now.book_j;
  return b[BOOK_TAKEN] - b[BOOK_COPPER] - b[BOOK_WORK] -
         vs_coil_energy(&c->model->coil, cosim_flux(c), c->z_m);
}
